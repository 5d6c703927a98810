use crate::Integrator;
use core::error::Error;
use serde::Serialize;
use tousle_core::{Assumption, StrandMotion};

/// What a simulation gives.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulation {
    /// Every control point over time.
    pub motion: StrandMotion,
    /// How it came about.
    pub report: SimReport,
}

/// One frame of a simulation, on its way to a [`FrameSink`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<'a> {
    /// Which, from 0.
    pub number: usize,
    /// Its time, s.
    pub secs: f64,
    /// Positions of all control points, head space, m: strand after strand, root first.
    pub positions_m: &'a [[f32; 3]],
}

/// Takes the frames of a simulation, one after the other.
pub type FrameSink<'a> = dyn FnMut(Frame<'_>) -> Result<(), Box<dyn Error + Send + Sync>> + 'a;

/// How a simulation came about.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SimReport {
    /// How the equations were stepped.
    pub integrator: Integrator,
    /// The order with which the error falls as the step shrinks.
    pub order: u32,
    /// The integrator's stability limit for this groom, in words.
    pub limit: String,
    /// The step that was taken, or by [`Integrator::Adaptive`] the longest that may be, s.
    pub dt_secs: f64,
    /// Steps that were taken, those of all strands added up: one strand through one step counts 1.
    pub n_steps: u64,
    /// Iterations that a step took on average.
    pub iterations_per_step: f64,
    /// Share of the steps in which nothing could move and nothing was done.
    pub slept_share: f64,
    /// Steps whose iteration did not settle.
    pub unsettled_steps: u64,
    /// The farthest that a point still moved when such a step ended, m.
    pub unsettled_m: f64,
    /// Every term of E1 and E2: what runs, what was left out and why.
    pub plan: Vec<PlanEntry>,
    /// Largest change of a stick's length in any frame, as a share of it.
    pub max_stretch: f64,
    /// What nobody gave and a default stands for.
    pub assumed: Vec<Assumption>,
}

/// How a run is cut into steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Steps {
    /// Steps a second; the most, where strands have steps of their own.
    pub per_second: f64,
    /// Steps of each strand, from the first frame to the last.
    pub in_all: usize,
    /// Steps a second if no step were too long for the integrator.
    pub unlimited_per_second: f64,
    /// The integrator's stability limit for this groom, in words.
    pub limit: String,
}

/// One term of the equations in this run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlanEntry {
    /// The term: `gravity`, `wind`, `head movement`, `spring`, `collision`, …
    pub term: String,
    /// Whether it runs.
    pub active: bool,
    /// What it does here, or why it was left out.
    pub why: String,
}
