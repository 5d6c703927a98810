//! Stiff and extreme cases: what each integrator makes of what no hair was meant for.
//!
//! The list is that of the project's design: any stiffness, any wind, any head, any strand, any step. What must hold in
//! each: every number finite, no stick stretched by a thousandth, no point faster than anything that could drive it, and
//! what the case itself asks. A step that an explicit integrator does not stand is to be refused before the run.

mod cases;
mod check;

pub use cases::{BadInput, Case, World, bad_inputs, cases};

use crate::way::unless_too_short;
use crate::worlds::nearest_m;
use crate::{Cell, Table, Way};
use check::flaw;
use tousle_core::{NoProgress, Progress};
use tousle_sim::{Integrator, SimError, SimOptions, simulate};

/// The steps at which every case is run, s: from a film's frame down.
pub const STEPS_SECS: [f64; 3] = [1.0 / 24.0, 1.0 / 120.0, 1.0 / 960.0];

/// At its own limit an explicit integrator is given this many steps; where it would need more it is not run.
const MAX_STEPS: f64 = 20_000.0;

/// How deep in the body hair may be without a word, m. Contacts are soft, and a step may be longer than it takes a tip
/// to cross the neck: this is no flaw that the list asks after, but worth knowing.
const DEEP_M: f64 = 5e-3;

/// How deep in the body a point was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depth {
    /// How deep, m.
    pub m: f64,
    /// The step at which it was, s.
    pub dt_secs: f64,
}

/// What became of a case.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// It held at every step.
    Holds {
        /// The deepest that a point was in the body, where that is more than a few millimeters.
        deep: Option<Depth>,
    },
    /// A longer step than the limit was refused before the run.
    Refused {
        /// The limit that was named, s.
        limit_secs: f64,
        /// What became of it at that limit; `None` if that would have been too many steps.
        at_limit: Option<Box<Verdict>>,
    },
    /// It ended with an error that says so, and without a result.
    Stopped {
        /// The step at which it did, s.
        dt_secs: f64,
    },
    /// What went wrong, and at which step.
    Fails(String),
}

impl Verdict {
    /// Whether nothing went wrong.
    pub fn is_sound(&self) -> bool {
        match self {
            Self::Holds { .. } => true,
            Self::Refused { at_limit, .. } => at_limit.as_ref().is_none_or(|verdict| verdict.is_sound()),
            Self::Stopped { .. } | Self::Fails(_) => false,
        }
    }
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Holds { deep: None } => f.write_str("holds"),
            Self::Holds { deep: Some(deep) } => {
                write!(f, "holds; {:.0} mm into the body at {}", 1e3 * deep.m, step_text(deep.dt_secs))
            }
            Self::Refused { limit_secs, at_limit } => {
                write!(f, "refused beyond {limit_secs:.1e} s; there ")?;
                match at_limit {
                    Some(verdict) => verdict.fmt(f),
                    None => f.write_str("not run"),
                }
            }
            Self::Stopped { dt_secs } => write!(f, "stops with an error at {}", step_text(*dt_secs)),
            Self::Fails(what) => write!(f, "FAILS: {what}"),
        }
    }
}

/// Runs a case one way at every step.
pub fn judge(case: &Case, way: Way) -> Verdict {
    let mut limit_secs = f64::INFINITY;
    let mut deepest: Option<Depth> = None;
    // An adaptive integrator chooses its steps itself.
    let n_steps = if way.integrator == Integrator::Adaptive { 1 } else { STEPS_SECS.len() };
    for dt_secs in &STEPS_SECS[..n_steps] {
        match unless_too_short(run(case, way, *dt_secs)) {
            Ok(None) => {}
            Ok(Some(Verdict::Holds { deep })) => {
                deepest = deepest.into_iter().chain(deep).max_by(|a, b| a.m.total_cmp(&b.m));
            }
            Ok(Some(flawed)) => return flawed,
            Err(SimError::Unstable { limit_secs: limit, .. }) => limit_secs = limit_secs.min(limit),
            Err(SimError::BlewUp { .. }) => return Verdict::Stopped { dt_secs: *dt_secs },
            Err(error) => return Verdict::Fails(error.to_string()),
        }
    }
    if limit_secs.is_infinite() {
        return Verdict::Holds { deep: deepest };
    }
    let is_affordable = case.world(limit_secs).duration_secs / limit_secs <= MAX_STEPS;
    let at_limit = is_affordable.then(|| match run(case, way, limit_secs) {
        Ok(verdict) => Box::new(verdict),
        Err(SimError::BlewUp { .. }) => Box::new(Verdict::Stopped { dt_secs: limit_secs }),
        Err(error) => Box::new(Verdict::Fails(error.to_string())),
    });
    Verdict::Refused { limit_secs, at_limit }
}

/// Whether every input that cannot be is refused with the right error.
pub fn judge_refusals(way: Way) -> Verdict {
    for bad in bad_inputs() {
        match simulate(
            &bad.world.field,
            &bad.world.scene,
            &bad.world.groom,
            &(bad.options)(way.options()),
            &NoProgress,
        ) {
            Err(error) if (bad.is_right)(&error) => {}
            Err(error) => return Verdict::Fails(format!("{}: {error}", bad.what)),
            Ok(_) => return Verdict::Fails(format!("{}: not refused", bad.what)),
        }
    }
    Verdict::Holds { deep: None }
}

/// The table: a row a case, a column a way. Progress is in cases.
pub fn table(ways: &[Way], progress: &dyn Progress) -> Table {
    let names: Vec<String> = ways.iter().map(|way| way.name()).collect();
    let columns: Vec<&str> = std::iter::once("case").chain(names.iter().map(String::as_str)).collect();
    let mut table = Table::new("Stiff and extreme", &columns);
    let cases = cases();
    for (k, case) in (0..).zip(&cases) {
        progress.at(k, cases.len() as u64);
        let verdicts = ways.iter().map(|way| Cell::text(judge(case, *way).to_string()));
        table.push(std::iter::once(Cell::text(case.name)).chain(verdicts).collect());
    }
    let refusals = ways.iter().map(|way| Cell::text(judge_refusals(*way).to_string()));
    table.push(
        std::iter::once(Cell::text("NaN, infinite and missing input is refused")).chain(refusals).collect(),
    );
    table
}

/// What becomes of a case at a step.
fn run(case: &Case, way: Way, dt_secs: f64) -> Result<Verdict, SimError> {
    let world = case.world(dt_secs);
    let options = SimOptions {
        rate_hz: world.rate_hz,
        dt_secs: Some(dt_secs),
        duration_secs: Some(world.duration_secs),
        time: world.time,
        ..way.options()
    };
    let simulation = simulate(&world.field, &world.scene, &world.groom, &options, &NoProgress)?;
    if let Some(flaw) = flaw(case, &world, &simulation) {
        return Ok(Verdict::Fails(format!("{flaw} at {}", step_text(dt_secs))));
    }
    let m = -nearest_m(&world.scene, &simulation.motion);
    Ok(Verdict::Holds { deep: (m > DEEP_M).then_some(Depth { m, dt_secs }) })
}

/// A step as people write it: `1/120 s`, or `3.2e-4 s`.
pub(crate) fn step_text(dt_secs: f64) -> String {
    let per_sec = 1.0 / dt_secs;
    if (per_sec - per_sec.round()).abs() < 1e-9 * per_sec {
        format!("1/{per_sec:.0} s")
    } else {
        format!("{dt_secs:.1e} s")
    }
}
