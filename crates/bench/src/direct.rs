//! Drags judged: on captures, drawn at random within what locks can reach, made by E4 and solved for, and worn by another
//! hairstyle.

mod draw;
mod effect;
mod hand;
mod live;
mod report;
mod several;
mod wig;

pub use draw::Several;
pub use effect::DragEffect;
pub use hand::HandRow;
pub use live::{LiveRow, live};
pub use report::{DirectBenchReport, DragRow, MethodRow};
pub use several::{KeyRow, SeveralRow};
pub use wig::wig;

use crate::capture::failed;
use crate::{BenchError, CaptureFolder, Cost, Stopwatch};
use draw::{Board, Dice};
use tousle_core::{Groom, NoProgress, Progress, StrandMotion, Vec3};
use tousle_direct::{DirectOptions, Directed, EditMethod, Made, Stage, apply};
use tousle_edit::{EditEffects, EditList, StrandPath, Under, measure};
use tousle_field::{FieldLayer, FieldSequence, LayerKey, Scene};
use tousle_pipeline::{ConvertOptions, Input, Silent, convert};
use tousle_sim::{Method, SimOptions, Simulator};

/// What is drawn, and on how much of which captures.
#[derive(Clone, Debug, PartialEq)]
pub struct DirectBenchOptions {
    /// Names of captures; empty for all.
    pub names: Vec<String>,
    /// Drags a capture with one key.
    pub n_drags: usize,
    /// Drags a capture with several keys, of each kind.
    pub n_several: usize,
    /// Where the dice begin.
    pub seed: u64,
}

impl Default for DirectBenchOptions {
    /// Twenty drags on three captures, and ten of each kind with several keys.
    fn default() -> Self {
        let names = ["gusts_left", "steady_front", "turbulent_dirty"];
        Self { names: names.map(str::to_owned).to_vec(), n_drags: 20, n_several: 10, seed: 7 }
    }
}

/// Draws drags on captures and makes them by both methods; those with several keys are solved for.
///
/// The captured wig itself is dragged ([`wig`]), in the field that the method `physical` measures of it. Progress is in
/// drags.
///
/// # Errors
/// [`BenchError`] with the capture and the stage that failed.
pub fn run(
    captures: &std::path::Path,
    options: &DirectBenchOptions,
    progress: &dyn Progress,
) -> Result<DirectBenchReport, BenchError> {
    let folders = CaptureFolder::named(captures, &options.names)?;
    let total = (folders.len() * (options.n_drags + Several::ALL.len() * options.n_several)) as u64;
    let mut report = DirectBenchReport::default();
    for folder in &folders {
        let world = World::of(folder)?;
        let fail = failed::<Failure>(folder.name(), "directing");
        let live = live(folder.name(), &world.field, &world.scene, &world.groom);
        report.live.extend(live.map_err(|error| fail(error.into()))?);
        let watched = Watched::new(&world).map_err(&fail)?;
        let board = Board { scene: &world.scene, groom: &world.groom, motion: &watched.unedited };
        report.hands.push(hand::follow(folder.name(), &watched, &board, options.seed).map_err(&fail)?);
        let mut dice = Dice::new(options.seed);
        for k in 0..options.n_drags {
            progress.at(report.n_drags(), total);
            let edits = board.drag(&mut dice, k);
            report.rows.push(watched.row(folder.name(), &edits).map_err(&fail)?);
        }
        for kind in Several::ALL {
            let mut dice = Dice::new(options.seed);
            for k in 0..options.n_several {
                progress.at(report.n_drags(), total);
                let edits = board.several(&mut dice, k, kind);
                report.several.push(watched.several(folder.name(), kind, &edits).map_err(&fail)?);
            }
        }
    }
    progress.at(total, total);
    Ok(report)
}

/// A capture's field, its wig, and the other hairstyle.
struct World {
    field: FieldSequence,
    scene: Scene,
    groom: Groom,
    style_b: Groom,
    options: SimOptions,
}

impl World {
    fn of(folder: &CaptureFolder) -> Result<Self, BenchError> {
        let (csv, session) = (folder.csv()?, folder.session_bytes()?);
        let [csv, session] =
            [Input { name: "capture", bytes: &csv }, Input { name: "session", bytes: &session }];
        let converted = convert(csv, session, &ConvertOptions::default(), &Silent)
            .map_err(failed(folder.name(), "converting"))?;
        let style_b = folder.style_b()?;
        let groom = wig(&converted.prepared, &style_b.strands[0]);
        let (field, scene) = (converted.eff.field, converted.eff.scene);
        let options = SimOptions::of(Method::for_quantity(field.quantity));
        Ok(Self { field, scene, groom, style_b, options })
    }
}

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Edits that were made, and what they did to the wig.
struct Done {
    directed: Directed,
    effects: EditEffects,
    cost: Cost,
}

/// A world that stays prepared.
struct Watched<'a> {
    world: &'a World,
    simulator: Simulator<'a>,
    style_b: Simulator<'a>,
    unedited: StrandMotion,
    unedited_b: StrandMotion,
}

impl<'a> Watched<'a> {
    fn new(world: &'a World) -> Result<Self, Failure> {
        let World { field, scene, groom, style_b, options } = world;
        let simulator = Simulator::new(field, scene, groom, options)?;
        let style_b = Simulator::new(field, scene, style_b, options)?;
        let unedited = simulator.simulate(&[], &NoProgress)?.motion;
        let unedited_b = style_b.simulate(&[], &NoProgress)?.motion;
        Ok(Self { world, simulator, style_b, unedited, unedited_b })
    }

    fn row(&self, capture: &str, edits: &EditList) -> Result<DragRow, Failure> {
        Ok(DragRow {
            capture: capture.to_owned(),
            edit: edits.edits[0].name.clone(),
            paper: self.made(edits, EditMethod::Paper)?,
            solved: self.made(edits, EditMethod::Physical)?,
        })
    }

    fn made(&self, edits: &EditList, method: EditMethod) -> Result<MethodRow, Failure> {
        let Done { directed, effects, cost } = self.done(edits, method)?;
        let (first_secs, key) =
            (edits.edits[0].first.secs(None).unwrap_or_default(), &effects.edits[0].keys[0]);
        let outcome = match &directed.report.edits[0] {
            Made::Physical(outcome) => Some(outcome),
            _ => None,
        };
        let effect = DragEffect::new(&effects, first_secs, outcome, cost);
        let row = MethodRow::new(key, first_secs, effect);
        let Some(outcome) = outcome else { return Ok(row) };
        let unreachable = outcome.keys[0].unreachable.as_ref().map(ToString::to_string);
        Ok(MethodRow { unreachable, follows: self.follows(directed.added(), &key.key)?, ..row })
    }

    fn several(&self, capture: &str, kind: Several, edits: &EditList) -> Result<SeveralRow, Failure> {
        let Done { directed, effects, cost } = self.done(edits, EditMethod::Physical)?;
        let Made::Physical(outcome) = &directed.report.edits[0] else {
            return Err("found an edit by E4, expected a solved one".into());
        };
        let effect = DragEffect::new(&effects, outcome.first_secs, Some(outcome), cost);
        Ok(SeveralRow::new(capture, kind, outcome, &effects.edits[0].keys, effect))
    }

    /// Makes edits and runs the wig with them.
    fn done(&self, edits: &EditList, method: EditMethod) -> Result<Done, Failure> {
        let World { field, scene, groom, .. } = self.world;
        let stage = Stage { simulator: &self.simulator, field, scene, groom };
        let options = DirectOptions { method, ..DirectOptions::for_quantity(field.quantity) };
        let watch = Stopwatch::start();
        let directed = apply(&stage, &[], &self.unedited, edits, &options)?;
        let cost = watch.stop();
        let after = self.simulator.simulate(&directed.stack, &NoProgress)?.motion;
        let before = Under { motion: &self.unedited, layers: &[] };
        let effects = measure(before, Under { motion: &after, layers: &directed.stack }, groom)?;
        Ok(Done { directed, effects, cost })
    }

    /// How far the nearest strand of the other hairstyle goes along with an edit: its way as asked, over what was asked
    /// of the dragged strand; `None` if none has a point within a third of the reach of the key's own strand.
    fn follows(&self, layers: &[FieldLayer], key: &LayerKey) -> Result<Option<f64>, Failure> {
        let edited = self.style_b.simulate(layers, &NoProgress)?.motion;
        let strand = self.world.groom.strands.iter().position(|s| s.name == key.strand).unwrap_or_default();
        let from = StrandPath::new(&self.unedited, strand).points_at(key.secs)[key.control_point];
        let asked = key.target_m - from;
        let mut nearest: Option<(f64, Vec3)> = None;
        for s in 0..self.unedited_b.counts.len() {
            let [before, after] =
                [&self.unedited_b, &edited].map(|motion| StrandPath::new(motion, s).points_at(key.secs));
            for (before, after) in before.iter().zip(&after) {
                let distance_m = (before - from).norm();
                if nearest.is_none_or(|(least, _)| distance_m < least) {
                    nearest = Some((distance_m, after - before));
                }
            }
        }
        let near = nearest.filter(|(distance_m, _)| *distance_m < tousle_edit::DEFAULT_REACH_M / 3.0);
        Ok(near.map(|(_, moved)| moved.dot(&asked) / asked.norm_squared()))
    }
}
