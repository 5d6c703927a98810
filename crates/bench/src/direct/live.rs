use crate::{Cost, Stopwatch};
use tousle_core::{Groom, NoProgress};
use tousle_field::{Ease, FieldLayer, FieldSequence, Handle, LayerKey, LayerOrigin, Scene};
use tousle_sim::{Method, SimError, SimOptions, Simulator};

/// What it costs to run a hairstyle again after an edit changed.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveRow {
    /// The capture's name.
    pub capture: String,
    /// The method.
    pub method: &'static str,
    /// Strands and control points of them all.
    pub size: (usize, usize),
    /// Seconds of motion.
    pub simulated_secs: f64,
    /// To prepare it, once.
    pub prepare: Cost,
    /// To run it all again.
    pub again: Cost,
    /// To run it again from the middle on, where the edit begins.
    pub later: Cost,
    /// To run those strands again that feel the edit become stronger.
    pub changed: Cost,
    /// How many these are.
    pub n_felt: usize,
}

/// Strands of the hairstyle by which the paper's method is timed, and of a full one.
const PAPER_STRANDS: usize = 120;
const FULL_STRANDS: usize = 1_000;

/// Times resident simulations of a wig with a layer near one of its locks: by `physical`, by `paper` of 120 locks, and by
/// `physical` of 1,000.
///
/// # Errors
/// [`SimError`] if the wig cannot be simulated.
pub fn live(
    capture: &str,
    field: &FieldSequence,
    scene: &Scene,
    wig: &Groom,
) -> Result<Vec<LiveRow>, SimError> {
    let of =
        |n: usize| Groom { strands: wig.strands.iter().cycle().take(n).cloned().collect(), ..wig.clone() };
    let (many, full) = (of(PAPER_STRANDS), of(FULL_STRANDS));
    [(Method::Physical, wig), (Method::Paper, &many), (Method::Physical, &full)]
        .into_iter()
        .map(|(method, groom)| {
            let options = SimOptions::of(method);
            let watch = Stopwatch::start();
            let simulator = Simulator::new(field, scene, groom, &options)?;
            let prepare = watch.stop();
            let times = simulator.times_secs();
            let (start, end) = (times[0], times[times.len() - 1]);
            let middle = 0.5 * (start + end);
            let layers = [layer(groom, middle, 2.0)];
            simulator.simulate(&layers, &NoProgress)?;
            let watch = Stopwatch::start();
            simulator.simulate(&layers, &NoProgress)?;
            let again = watch.stop();
            let all: Vec<usize> = (0..groom.strands.len()).collect();
            let held = simulator.hold(&[], &all, middle)?;
            let watch = Stopwatch::start();
            simulator.go_on(&held, &layers, end)?;
            let later = watch.stop();
            let pulled = [layer(groom, middle, 2.5)];
            let traced = simulator.trace(&layers, &NoProgress)?;
            let watch = Stopwatch::start();
            simulator.retrace(&traced, &pulled, &NoProgress)?;
            let changed = watch.stop();
            Ok(LiveRow {
                capture: capture.to_owned(),
                method: method.name(),
                size: (groom.strands.len(), groom.n_points()),
                simulated_secs: end - start,
                prepare,
                again,
                later,
                changed,
                n_felt: traced.felt_by(&pulled).len(),
            })
        })
        .collect()
}

/// A second of wind from the side along the first lock, m/s.
fn layer(groom: &Groom, first_secs: f64, strength: f64) -> FieldLayer {
    let strand = &groom.strands[0];
    let extra = tousle_core::Vec3::new(0.0, strength, 0.0);
    let handle = |center_m: &tousle_core::Vec3| Handle { center_m: *center_m, reach_m: 0.06, extra };
    FieldLayer {
        id: "live".into(),
        name: "live".into(),
        muted: false,
        first_secs,
        last_secs: first_secs + 1.0,
        ease: Ease { rise: 0.5, fall: 0.5 },
        handles: strand.rest_curve_m.iter().map(handle).collect(),
        reshape: None,
        origin: LayerOrigin::Keys {
            edit: "live".into(),
            first_secs,
            keys: Vec::<LayerKey>::new(),
            method: "by hand".into(),
        },
    }
}
