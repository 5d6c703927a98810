//! Gauss and Newton's method through the simulator.

mod ground;
mod problem;

pub use ground::Ground;

use crate::basis::{Basis, Times};
use crate::target::aim;
use crate::{DirectError, DirectOptions, KeyOutcome, SolvedOutcome, Stage};
use problem::{Problem, Run};
use std::sync::Arc;
use tousle_core::{StrandMotion, Vec3};
use tousle_edit::{Change, EditError, FoundKey, Unreachable, peak_acceleration, peak_jerk};
use tousle_field::{FieldLayer, LayerKey};

/// A drag whose strands and times were found.
#[derive(Clone, Debug, PartialEq)]
pub struct Drag {
    /// A name for people.
    pub name: String,
    /// The edit's id, unlike those on the field.
    pub edit_id: String,
    /// Whether its layers should do nothing for now.
    pub muted: bool,
    /// Before this time nothing changes, s.
    pub first_secs: f64,
    /// What should be where, in order of time, all after that; at least one.
    pub keys: Vec<FoundKey>,
    /// Distance from a strand's way at which its extra vectors have fallen to 0, m.
    pub reach_m: f64,
}

/// A drag that was solved for.
#[derive(Clone, Debug)]
pub struct Solved {
    /// The layers to be put on top of those it was solved under.
    pub layers: Vec<FieldLayer>,
    /// How near the keys they bring the strands.
    pub outcome: SolvedOutcome,
    vectors: Vec<Vec3>,
    ground: Arc<Ground>,
}

/// Solves for the smallest and smoothest extra vectors with which some strands meet some keys.
///
/// In: what is simulated, the layers that are on its field already, and the drag. Out: more layers, and how near they
/// bring the strands to the keys. They are nothing before the first key, and have gone some tenths of a second after
/// the last. `before`: what was found for nearly the same keys, to begin from.
/// Source: Gauss and Newton's method with Marquardt's damping, the derivatives by finite differences through the
/// simulator (`docs/direct.md`).
///
/// # Errors
/// [`DirectError`] if a strand cannot be simulated or the reach is too small for its way. A key that cannot be met is
/// no error but [`KeyOutcome::unreachable`]: the strand is brought as near as was found.
///
/// # Panics
/// If there is no key, or the groom has no such strand or point.
pub fn solve(
    stage: &Stage<'_>,
    layers: &[FieldLayer],
    drag: &Drag,
    before: Option<&Solved>,
    options: &DirectOptions,
) -> Result<Solved, DirectError> {
    let ground = match before {
        Some(before) if before.ground.is_of(layers, drag) => before.ground.clone(),
        _ => Arc::new(Ground::new(stage, layers, drag)?),
    };
    let keys: Vec<LayerKey> = drag.keys.iter().map(|key| layer_key(stage, key)).collect();
    let aims: Vec<(Vec3, Option<Unreachable>)> =
        drag.keys.iter().map(|key| aim(stage, key, &ground.points_at(key))).collect();
    let mut solver = Solver { stage, ground: &ground, drag, keys: &keys, options, n_runs: 0 };
    let places: Vec<Vec3> = aims.iter().map(|(place, _)| *place).collect();
    let best = solver.best(&places, before.map(|before| &before.vectors[..]))?;
    let n_runs = solver.n_runs;
    let mut outcome = outcome(&best, &ground, drag, &keys, aims, options)?;
    outcome.n_runs = n_runs;
    let mut layers = best.problem.layers(&best.vectors);
    layers.iter_mut().for_each(|layer| layer.muted = drag.muted);
    Ok(Solved { layers, outcome, vectors: best.vectors, ground: ground.clone() })
}

fn layer_key(stage: &Stage<'_>, key: &FoundKey) -> LayerKey {
    LayerKey {
        strand: stage.groom.strands[key.strand_idx].name.clone(),
        control_point: key.control_point,
        secs: key.secs,
        target_m: key.target_m,
    }
}

/// An answer, good or not.
struct Answer<'a> {
    problem: Problem<'a>,
    vectors: Vec<Vec3>,
    run: Run,
}

struct Solver<'a> {
    stage: &'a Stage<'a>,
    ground: &'a Ground,
    drag: &'a Drag,
    keys: &'a [LayerKey],
    options: &'a DirectOptions,
    n_runs: usize,
}

/// Iterations of one attempt. Five are usual; where a strand slips they may not settle.
const MAX_ITERATIONS: usize = 12;

/// Shares of a step that are tried side by side.
const SHARES: [f64; 4] = [1.0, 0.5, 0.25, 0.08];

/// A key counts as met well when it is met to this share of the tolerance.
const WELL_MET: f64 = 0.1;

/// How often smoother than usual an answer may be asked to be.
const SMOOTHER: [f64; 2] = [30.0, 1000.0];

impl<'a> Solver<'a> {
    /// Attempts until one meets its keys, then smoother ones until one moves no more violently than it may.
    fn best(&mut self, aims: &[Vec3], start: Option<&[Vec3]>) -> Result<Answer<'a>, DirectError> {
        let mut best = self.attempt(aims, 0, None, start, 1.0)?;
        for finer in [0, 1] {
            if self.is_met(&best) {
                break;
            }
            // The strand goes another way than was guessed: handles along the way it takes.
            let start = (finer == 0).then(|| best.vectors.clone());
            let next = self.attempt(aims, finer, Some(&best.run), start.as_deref(), 1.0)?;
            if next.run.miss_m() < best.run.miss_m() {
                best = next;
            }
        }
        for smoother in SMOOTHER {
            let ratios = best.problem.ratios(&best.vectors)?;
            if ratios.into_iter().fold(0.0, f64::max) <= self.options.peak_ratio {
                break;
            }
            let next = self.smoother(&best, smoother)?;
            if self.is_met(&next) || next.run.miss_m() <= best.run.miss_m() {
                best = next;
            }
        }
        Ok(best)
    }

    fn is_met(&self, answer: &Answer<'_>) -> bool {
        answer.run.miss_m() <= self.options.tolerance_m
    }

    /// One attempt, with handles along a guessed way or a known one.
    fn attempt(
        &mut self,
        aims: &[Vec3],
        finer: i32,
        way: Option<&Run>,
        start: Option<&[Vec3]>,
        smoothness: f64,
    ) -> Result<Answer<'a>, DirectError> {
        let secs: Vec<f64> = self.keys.iter().map(|key| key.secs).collect();
        let times = Times::new(self.drag.first_secs, &secs, finer);
        let strands = self.ground.dragged(&times, self.drag, aims, way.map(|run| &run.motions[..]));
        let bad = |problem| EditError::BadEdit { number: 1, name: self.drag.name.clone(), problem };
        let basis = Basis::new(times, &strands, self.drag.reach_m).map_err(bad)?;
        let problem =
            Problem::new(self.stage, self.ground, self.drag, self.keys, aims.to_vec(), basis, self.options)
                .with_smoothness(smoothness);
        let start = start.filter(|start| start.len() == problem.n());
        let start = start.map_or_else(|| vec![Vec3::zeros(); problem.n()], <[Vec3]>::to_vec);
        self.minimize(problem, start)
    }

    /// The same handles, and a smoother way there.
    fn smoother(&mut self, from: &Answer<'a>, smoothness: f64) -> Result<Answer<'a>, DirectError> {
        self.minimize(from.problem.clone().with_smoothness(smoothness), from.vectors.clone())
    }

    fn minimize(&mut self, problem: Problem<'a>, start: Vec<Vec3>) -> Result<Answer<'a>, DirectError> {
        let mut vectors = start;
        let mut run = problem.run(std::slice::from_ref(&vectors))?.remove(0);
        let mut damping = 1e-4;
        self.n_runs += 1;
        for _ in 0..MAX_ITERATIONS {
            let jacobian = problem.jacobian(&vectors, &run)?;
            self.n_runs += 3 * problem.n();
            let mut improved = 0.0;
            for _ in 0..3 {
                let step = crate::normal::step(&jacobian, &run.rows, damping);
                let tried: Vec<Vec<Vec3>> =
                    SHARES.iter().map(|share| problem.moved(&vectors, &step, *share)).collect();
                let runs = problem.run(&tried)?;
                self.n_runs += tried.len();
                let costs = runs.iter().map(Run::cost).enumerate();
                let (k, cost) = costs.min_by(|a, b| a.1.total_cmp(&b.1)).expect("some shares");
                if cost < run.cost() {
                    improved = 1.0 - cost / run.cost();
                    damping *= if k == 0 { 0.1 } else { 3.0 };
                    let mut runs = runs;
                    (vectors, run) = (tried[k].clone(), runs.swap_remove(k));
                    break;
                }
                damping = f64::max(30.0 * damping, 1e-3);
            }
            let is_well_met = run.miss_m() <= WELL_MET * self.options.tolerance_m;
            if improved < 1e-3 || (is_well_met && improved < 0.1) {
                break;
            }
        }
        Ok(Answer { problem, vectors, run })
    }
}

fn outcome(
    best: &Answer<'_>,
    ground: &Ground,
    drag: &Drag,
    keys: &[LayerKey],
    aims: Vec<(Vec3, Option<Unreachable>)>,
    options: &DirectOptions,
) -> Result<SolvedOutcome, DirectError> {
    let strongest = best.vectors.iter().map(Vec3::norm).fold(0.0, f64::max);
    let [acceleration_ratio, jerk_ratio] = best.problem.ratios(&best.vectors)?;
    let outcome = |((found, key), (_, why)): ((&FoundKey, &LayerKey), (Vec3, Option<Unreachable>))| {
        let after = (best.run.place(ground, found) - found.target_m).norm() * 1e3;
        let residual_mm = Change { before: (found.unedited_m - found.target_m).norm() * 1e3, after };
        let is_met = after <= options.tolerance_m * 1e3;
        let by_wind = strongest >= 0.98 * options.limit;
        let found = if by_wind {
            Unreachable::TooWeak { by_mm: after, limit: options.limit }
        } else {
            Unreachable::NotFound { by_mm: after }
        };
        let unreachable = (!is_met).then(|| why.unwrap_or(found));
        KeyOutcome { key: key.clone(), residual_mm, unreachable }
    };
    let layers = best.problem.layers(&best.vectors);
    Ok(SolvedOutcome {
        name: drag.name.clone(),
        edit_id: drag.edit_id.clone(),
        muted: drag.muted,
        first_secs: drag.first_secs,
        last_secs: best.problem.last_secs(),
        keys: drag.keys.iter().zip(keys).zip(aims).map(outcome).collect(),
        strongest,
        acceleration_ratio,
        jerk_ratio,
        peaks_demanded: ground.demands(drag, options.peak_ratio),
        n_runs: 0,
        n_layers: layers.len(),
        n_handles: layers.iter().map(|layer| layer.handles.len()).sum(),
    })
}

/// The peaks of a motion's first strand: acceleration, m/s², and jerk, m/s³.
fn peaks(motion: &StrandMotion) -> [f64; 2] {
    [peak_acceleration(motion, 0), peak_jerk(motion, 0)]
}
