//! The simulator judged: error against run time of every integrator and step, what it does with stiff and extreme cases,
//! and what each term of its equations costs.
//!
//! Integrators are taken from the simulator's own list. Everything runs on one thread.

mod converged;
mod order;
mod peers;
mod setting;
mod terms;
mod true_wind;

use crate::{BenchError, Report, Section, Way, extremes};
use std::path::PathBuf;
use tousle_core::{Groom, Progress};
use tousle_field::{FieldSequence, Scene};
use tousle_sim::TorsoGrip;

/// A part of the bench.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// How errors fall with the step on one lock, and whether stiff hair needs smaller steps.
    Order,
    /// Error against run time: a hairstyle against the converged solution of the same equations.
    Converged,
    /// Error against run time: another hairstyle in the true wind against where it really went.
    Truth,
    /// Stiff and extreme cases.
    Extremes,
    /// What each term of the equations costs.
    Terms,
}

impl Part {
    /// Every part, in the order in which a page has them.
    pub const ALL: [Self; 5] = [Self::Truth, Self::Converged, Self::Order, Self::Extremes, Self::Terms];

    /// The name used on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Order => "order",
            Self::Converged => "converged",
            Self::Truth => "truth",
            Self::Extremes => "extremes",
            Self::Terms => "terms",
        }
    }

    /// What its files begin with.
    fn stem(self) -> String {
        format!("sim-{}", self.name())
    }

    /// The part of a name that [`Part::name`] gives.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|part| part.name() == name)
    }
}

/// What is judged.
#[derive(Clone, Debug, PartialEq)]
pub struct SimBenchOptions {
    /// The parts.
    pub parts: Vec<Part>,
    /// A folder of captures with their truth; without it there is no [`Part::Truth`].
    pub captures: Option<PathBuf>,
    /// [`Part::Truth`]: the captures by name; empty for all.
    pub names: Vec<String>,
    /// [`Part::Truth`]: what hair on the torso rubs on while the head moves.
    pub torso_grip: TorsoGrip,
}

/// A hairstyle in a wind that everybody has, for [`Part::Converged`].
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// What it is.
    pub name: &'a str,
    /// The wind.
    pub field: &'a FieldSequence,
    /// The scene.
    pub scene: &'a Scene,
    /// The hairstyle.
    pub groom: &'a Groom,
}

/// Runs the parts, one after another, on one thread.
///
/// # Errors
/// [`BenchError`] with what failed, or if a thread cannot be had.
pub fn run(
    sample: Sample<'_>,
    options: &SimBenchOptions,
    progress: &dyn Progress,
) -> Result<Report, BenchError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let section = |part: &Part| match part {
        Part::Order => order::section(progress),
        Part::Converged => converged::section(sample, progress),
        Part::Truth => true_wind::section(options, progress),
        Part::Extremes => Ok(extremes_section(progress)),
        Part::Terms => terms::section(progress),
    };
    let sections = options.parts.iter().map(|part| pool.install(|| section(part)));
    Ok(Report {
        name: "sim",
        title: "The simulator, judged".to_owned(),
        words: "Every integrator that it offers, each by its name; those of the paper's method begin with “paper”."
            .to_owned(),
        sections: sections.collect::<Result<_, _>>()?,
        json: None,
    })
}

fn extremes_section(progress: &dyn Progress) -> Section {
    Section {
        name: Part::Extremes.stem(),
        title: "Stiff and extreme".to_owned(),
        words: format!(
            "Each case is run at steps of {}. It holds if every number is finite, no stick is stretched by 0.1 %, no \
             point goes faster than twice what wind, push, head and weight could drive it together, and what the case \
             itself asks: no jitter in a steady wind once it has settled, rest after a storm, 0.1 mm at rest, no \
             energy from nothing in a vacuum. An explicit integrator has to refuse a step beyond its limit, and to \
             hold at it; single precision refuses steps shorter than 1/480 s. Depths in the body are no failure here: \
             contacts are soft, and a tip can cross the neck in one such step.",
            extremes::STEPS_SECS.map(extremes::step_text).join(", ")
        ),
        tables: vec![(String::new(), extremes::table(&Way::all(), progress))],
        plots: Vec::new(),
    }
}
