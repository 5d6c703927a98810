//! The closed loop: a measured wind is mended until the wig, simulated in it, moves as it was seen to move.
//!
//! [`refine`] first seeks how stiff the wig is (`stiffness`): as stiff as lets it move in the wind that then is found as it was
//! seen to. Then it simulates the wig in that wind. Where the simulated markers differ from the seen ones, three things can be at
//! fault. What the single locks are made of: it is learnt from how the simulated markers answer to it
//! (`learn`). What the balance of moments leaves over of a motion that is known to be in balance: smoothing, splines and
//! contacts, which is taken off the balance of the seen motion ([`tousle_fit::defects`]), as in the defect correction of
//! differential equations (H. J. Stetter, "The defect correction principle", *Numerische Mathematik* 29, 1978). And the wind,
//! which is then measured anew. Locks that are held out say when to stop.

mod compare;
mod learn;
mod report;
mod rounds;
mod stiffness;
mod wig;

pub use report::{RefineReport, Round};
pub use stiffness::Stiffness;

use rounds::Loop;
use std::error::Error;
use std::num::NonZeroUsize;
use tousle_core::{HeadCapture, Progress, Sample, Session};
use tousle_field::{FieldSequence, GridSpec, Scene};
use tousle_fit::{Fit, FitError, FitOptions};
use tousle_sim::SimError;

/// How a wind is refined.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RefineOptions {
    /// The most rounds.
    pub rounds: usize,
    /// Every so many locks one is held out to say how many rounds serve. `None`: all locks are gone round with at once, for as
    /// long as they themselves come nearer to where they were seen; that takes less than half of the time.
    pub held_out: Option<NonZeroUsize>,
}

/// Two rounds with locks held out: what `--refine` asks for.
impl Default for RefineOptions {
    fn default() -> Self {
        Self { rounds: 2, held_out: NonZeroUsize::new(5) }
    }
}

impl RefineOptions {
    /// One round with all locks: quick enough for every conversion, which does so unless told otherwise.
    pub fn quick() -> Self {
        Self { rounds: 1, held_out: None }
    }
}

/// What a wind is measured from.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    /// The capture in head space.
    pub head: &'a HeadCapture,
    /// Where each sample of it comes from, as for [`tousle_fit::fit`].
    pub origins: Option<&'a [Vec<Vec<Sample>>]>,
    /// What the people in the room knew.
    pub session: &'a Session,
    /// How it is measured.
    pub options: &'a FitOptions,
    /// What the wig can touch, and how the head moves.
    pub scene: &'a Scene,
    /// The voxels on which the wind will be.
    pub grid: GridSpec,
}

/// A refined wind, and what happened on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Refined {
    /// The wind; as it was before any round if none made it better.
    pub fit: Fit,
    /// The same on its grid, if it was laid there for the last comparison.
    pub field: Option<FieldSequence>,
    /// What happened.
    pub report: RefineReport,
}

/// What lays a wind on a grid.
pub type Lay<'a> = dyn Fn(&Fit, &GridSpec) -> Result<FieldSequence, Box<dyn Error + Send + Sync>> + Sync + 'a;

/// Why a wind cannot be refined.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RefineError {
    /// The method knows nothing of what the wig is made of.
    #[error(
        "found a wind of the method paper, expected one of the method physical: only that knows the wig's locks"
    )]
    NoWig,
    /// Too few locks to hold one out.
    #[error("found {found} locks, expected at least {expected} so that some can be held out")]
    TooFewLocks {
        /// How many there are.
        found: usize,
        /// How many there must be.
        expected: usize,
    },
    /// Measuring anew.
    #[error("cannot measure the wind anew")]
    Fit(#[from] FitError),
    /// The grid.
    #[error("cannot fill the grid")]
    Lay(#[source] Box<dyn Error + Send + Sync>),
    /// The wig.
    #[error("cannot simulate the captured wig")]
    Sim(#[from] SimError),
}

/// Measures a wind and mends it until the wig, simulated in it, comes no nearer to the seen one.
///
/// In: what it is measured from, and how it is laid on a grid. If some locks are to be held out, the others alone are gone
/// round with first, and after each round the ones held out are simulated and compared with how they were seen. Then as many rounds
/// as served those best, one at least, are gone with all locks, for as long as these come nearer themselves. The result does not
/// depend on the number of threads.
///
/// # Errors
/// [`RefineError`] if the wind is not of the method `physical`, there are too few locks to hold some out, or a stage fails.
pub fn refine(
    measured: &Measured<'_>,
    lay: &Lay<'_>,
    options: &RefineOptions,
    progress: &dyn Progress,
) -> Result<Refined, RefineError> {
    let Measured { head, origins, session, options: how, .. } = *measured;
    let wig = tousle_fit::wig(head, origins, session, how)?.ok_or(RefineError::NoWig)?;
    let around = Loop { measured, wig: &wig, lay };
    // A wig whose shape at rest nobody saw moves otherwise whatever the wind is: nothing is learnt from how far off it is.
    let most_rounds = if around.rest_seen() { options.rounds } else { 0 };
    let once = most_rounds as u64 + 2;
    let total = if options.held_out.is_some() { 2 * once } else { once };
    let at = |step| progress.at(step, total);
    let refined = match options.held_out {
        None => with_all(&around, most_rounds, at),
        Some(every) => with_some_held_out(&around, most_rounds, every, at),
    }?;
    progress.at(total, total);
    Ok(refined)
}

/// Goes round with all locks while they come nearer. `at` is told of every step that begins, from 0 on: one for the stiffness,
/// one for the first wind, one a round.
fn with_all(around: &Loop<'_>, most_rounds: usize, at: impl Fn(u64)) -> Result<Refined, RefineError> {
    at(0);
    let sought = stiffness::sought(around, &[])?;
    at(1);
    let mut turn = around.first(&sought, &[])?;
    let first = around.compare(&turn)?;
    let mut rounds = vec![first.round(&[])];
    let mut compared = Some(first);
    let mut kept = 0;
    while kept < most_rounds
        && let Some(of_turn) = compared.take()
    {
        at(kept as u64 + 2);
        let next = around.again(&turn, of_turn, &[])?;
        let of_next = around.compare(&next)?;
        rounds.push(of_next.round(&[]));
        if report::best(&rounds) > kept {
            (turn, compared, kept) = (next, Some(of_next), kept + 1);
        }
    }
    if kept == 0 {
        // What the first round would learn from is not as fine as the wind shall be.
        turn = around.with_stiffness(sought.likely(), Some(&turn.fit), &[])?;
        let fine = around.compare(&turn)?;
        rounds[0] = fine.round(&[]);
        compared = Some(fine);
    }
    let report = RefineReport { held_out: Vec::new(), stiffness: sought.stiffness, rounds, kept };
    Ok(Refined { fit: turn.fit, field: compared.map(|compared| compared.field), report })
}

/// Goes as many rounds with all locks as serve those best that are held out, but at least one.
///
/// Whether the first serves, all locks tell, as without any held out: it takes off what the balance leaves out, and locks that are
/// held out are few. Whether more do, only locks can tell that were not asked.
fn with_some_held_out(
    around: &Loop<'_>,
    most_rounds: usize,
    every: NonZeroUsize,
    at: impl Fn(u64),
) -> Result<Refined, RefineError> {
    let n_locks = around.wig.strand_idxs.len();
    let expected = every.get().saturating_mul(2);
    if n_locks < expected {
        return Err(RefineError::TooFewLocks { found: n_locks, expected });
    }
    let held_out = wig::every(around.wig, every.get());
    at(0);
    let sought = stiffness::sought(around, &held_out)?;
    at(1);
    let mut turn = around.first(&sought, &held_out)?;
    let mut compared = around.compare(&turn)?;
    let mut rounds = vec![compared.round(&held_out)];
    for round in 0..most_rounds {
        at(round as u64 + 2);
        turn = around.again(&turn, compared, &held_out)?;
        compared = around.compare(&turn)?;
        rounds.push(compared.round(&held_out));
    }
    drop((turn, compared));
    let serve = 1 + report::best(&rounds[1.min(most_rounds)..]);
    let refined = with_all(around, serve.min(most_rounds), |step| at(most_rounds as u64 + 2 + step))?;
    let name = |idx: &usize| around.measured.session.strands[*idx].name.clone();
    let held_out = held_out.iter().map(name).collect();
    Ok(Refined { report: RefineReport { held_out, rounds, ..refined.report }, ..refined })
}
