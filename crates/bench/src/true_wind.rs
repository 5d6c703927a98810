//! The other hairstyle in the true wind: how good the simulator is, whatever the capture told.

use crate::capture::failed;
use crate::{BenchError, CaptureFolder, Cost, MotionScore, Stopwatch, TrueMotion, score_motion};
use tousle_core::{Groom, NoProgress};
use tousle_field::{FieldSequence, Scene};
use tousle_sim::{SimOptions, Simulation, TimeMode};

/// A simulated motion of style B, what it cost, and how far it is from the truth.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The motion and the simulator's report.
    pub simulation: Simulation,
    /// What the simulation alone cost.
    pub cost: Cost,
    /// Seconds of motion.
    pub simulated_secs: f64,
    /// How far it is from the truth.
    pub score: MotionScore,
}

/// Simulates style B of a capture in its true wind, with the true head poses, and scores it.
///
/// `options` are kept but for the span, which is the truth's.
///
/// # Errors
/// [`BenchError`] if a file cannot be used or the simulator refuses the options.
pub fn sim_in_true_wind(capture: &CaptureFolder, options: &SimOptions) -> Result<Judged, BenchError> {
    let wind = capture.truth.wind().map_err(capture.truth_failed())?.to_sequence();
    sim_in_field(capture, &wind, &capture.true_scene()?, options)
}

/// Simulates style B of a capture in any field, over the truth's span, and scores it.
///
/// After the field's last step its wind is held: the truth ends one camera frame later.
///
/// # Errors
/// [`BenchError`] if a file cannot be used or the simulator refuses.
pub fn sim_in_field(
    capture: &CaptureFolder,
    field: &FieldSequence,
    scene: &Scene,
    options: &SimOptions,
) -> Result<Judged, BenchError> {
    let truth = capture.truth.style_b().map_err(capture.truth_failed())?;
    let groom = capture.style_b()?;
    let watch = Stopwatch::start();
    let simulation = sim_to_the_end(capture.name(), field, scene, &groom, &truth, options)?;
    let cost = watch.stop();
    let score =
        score_motion(&simulation.motion, &truth).map_err(failed(capture.name(), "scoring style B"))?;
    Ok(Judged { simulation, cost, simulated_secs: end_secs(&truth), score })
}

/// Simulates a groom in a field over a truth's span.
///
/// # Errors
/// [`BenchError`] if the simulator refuses.
pub(crate) fn sim_to_the_end(
    capture: &str,
    field: &FieldSequence,
    scene: &Scene,
    groom: &Groom,
    truth: &TrueMotion,
    options: &SimOptions,
) -> Result<Simulation, BenchError> {
    let options = SimOptions {
        start_secs: Some(0.0),
        // The truth's times are single-precision: its last frame may lie just short of a whole one of ours.
        duration_secs: Some(end_secs(truth) + 0.5 / options.rate_hz),
        time: TimeMode::Hold,
        ..options.clone()
    };
    tousle_sim::simulate(field, scene, groom, &options, &NoProgress).map_err(failed(capture, "simulating"))
}

fn end_secs(truth: &TrueMotion) -> f64 {
    truth.times_secs.last().copied().unwrap_or(0.0)
}
