//! A field, its scene and a groom give the motion of every strand.
//!
//! [`simulate`] does it once; a [`Simulator`] stays prepared for an editor that changes the field's layers.
//!
//! *Invariant:* this crate has never heard of markers: it sees what a field file holds and nothing else.

mod assumptions;
mod check;
mod error;
mod extent;
mod frames;
mod gap;
mod integrator;
mod joint;
mod lengths;
mod mechanics;
mod options;
mod paper;
mod parts;
mod physical;
mod plan;
mod prepared;
mod ready;
mod report;
mod resident;
mod run;
mod stability;
mod timeline;
mod touchable;
mod trace;
mod wind;

pub use error::SimError;
pub use integrator::Integrator;
pub use lengths::max_stretch;
pub use options::{Method, SimOptions, TimeMode, TorsoGrip};
pub use parts::{Count, Keeper, Part};
pub use report::{Frame, FrameSink, PlanEntry, SimReport, Simulation, Steps};
pub use resident::{Held, Simulator};
pub use tousle_lanes::Precision;
pub use trace::Traced;

use timeline::Timeline;
use tousle_core::{Groom, Progress};
use tousle_field::{FieldSequence, Scene};
use tousle_rod::Surface;

/// Simulates a groom in a wind field.
///
/// In: the field (its grid, its layers and what its vectors are), the scene that came with it, the groom at
/// rest; all in head space, SI. Out: every control point at `start`, `start + 1/rate`, … up to the end, head
/// space, m; the first frame is the groom's rest curves, at rest. The same input gives the same bytes out,
/// whatever the number of threads of the rayon pool this runs in.
///
/// # Errors
/// Before the first step, [`SimError`] if an option, the field, the scene or the groom cannot be used, or if the step is
/// beyond what the integrator stands; after the last, [`SimError::BlewUp`] of integrators that do not stand every step, and
/// [`SimError::Nowhere`] of numbers that are too large to compute with.
pub fn simulate(
    field: &FieldSequence,
    scene: &Scene,
    groom: &Groom,
    options: &SimOptions,
    progress: &dyn Progress,
) -> Result<Simulation, SimError> {
    simulate_kept(field, scene, groom, options, None, progress)
}

/// The body's surfaces at some times of such a simulation, in the body's order, head space.
///
/// # Errors
/// [`SimError`] if the scene or an option cannot be used.
pub fn surfaces_at(
    field: &FieldSequence,
    scene: &Scene,
    options: &SimOptions,
    times_secs: &[f64],
) -> Result<Vec<Vec<Surface>>, SimError> {
    check::check_scene(scene, options)?;
    let timeline = Timeline::new(field, scene, options)?;
    let at = |secs: &f64| Surface::of_body(&scene.body, &timeline.torso_at(*secs));
    Ok(times_secs.iter().map(at).collect())
}

/// [`simulate`] for long runs: strands run part by part, and a keeper hears of each part that is done. A part
/// that it kept before is not run again. The result is the same to the bit.
///
/// # Errors
/// As [`simulate`], and [`SimError::Keeper`], [`SimError::OtherPart`] where the keeper fails.
pub fn simulate_kept(
    field: &FieldSequence,
    scene: &Scene,
    groom: &Groom,
    options: &SimOptions,
    keeper: Option<&dyn Keeper>,
    progress: &dyn Progress,
) -> Result<Simulation, SimError> {
    Simulator::new(field, scene, groom, options)?.simulate_once(&field.layers, keeper, progress)
}
