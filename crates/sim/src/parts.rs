//! A groom in parts: each runs to its end before the next begins, so that what is done can be kept.
//!
//! Strands never touch one another, so it makes no difference to a strand which others run beside it.

use crate::SimError;
use crate::frames::Frames;
use std::error::Error;
use std::num::NonZeroUsize;
use tousle_core::{Groom, Progress};

/// Keeps the parts of a run that are done, so that a run that was stopped can go on.
pub trait Keeper {
    /// Strands of a part; `None` for some seconds' work.
    fn strands_per_part(&self) -> Option<NonZeroUsize>;

    /// The part of this number, from 0, if it was kept.
    ///
    /// # Errors
    /// Whatever keeps it from being read.
    fn kept(&self, part: usize) -> Result<Option<Part>, Box<dyn Error + Send + Sync>>;

    /// Keeps a part.
    ///
    /// # Errors
    /// Whatever keeps it from being written.
    fn keep(&self, number: usize, part: &Part) -> Result<(), Box<dyn Error + Send + Sync>>;
}

/// Some strands' motion from the first frame to the last.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Positions, head space, m: frame after frame, strand after strand, root first.
    pub positions_m: Vec<[f32; 3]>,
    /// What it took.
    pub count: Count,
}

/// What steps were taken, and what they took: those of each strand, added up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Count {
    /// Steps.
    pub steps: u64,
    /// Iterations of all steps.
    pub iterations: u64,
    /// Steps in which nothing could move and nothing was done.
    pub slept: u64,
    /// Steps whose iteration did not settle.
    pub unsettled: u64,
    /// The farthest that a point still moved when such a step ended, m.
    pub unsettled_m: f64,
    /// The largest change of any stick's length in any frame, as a share of it.
    pub max_stretch: f64,
}

/// Steps of one stick that a part has unless its keeper says otherwise: some ten seconds of one core.
const STICK_STEPS_PER_PART: usize = 200_000_000;

/// Strands that a part has at least: what the world does in a step is worked out once for all of them.
const LEAST_STRANDS: usize = 64;

/// Strands of a part are a multiple of this, so that every register is full.
const STRANDS_AT_ONCE: usize = 16;

/// Runs a groom's strands, all at once, or part by part if someone keeps them.
///
/// `order` has all strands in the order in which they are cut into parts. `run` moves some of them, in ascending order,
/// from the first frame to the last.
pub(crate) fn run_parts(
    groom: &Groom,
    order: &[usize],
    (n_frames, n_steps): (usize, usize),
    keeper: Option<&dyn Keeper>,
    progress: &dyn Progress,
    mut run: impl FnMut(&[usize], &dyn Progress) -> Result<Part, SimError>,
) -> Result<Part, SimError> {
    let all: Vec<usize> = (0..groom.strands.len()).collect();
    let Some(keeper) = keeper else { return run(&all, progress) };
    let n = keeper.strands_per_part().map_or_else(|| some_seconds(groom, n_steps), NonZeroUsize::get);
    let mut frames = Frames::new(groom, &all, n_frames);
    let mut count = Count::default();
    let mut done = 0;
    for (number, strands) in order.chunks(n.next_multiple_of(STRANDS_AT_ONCE)).enumerate() {
        let mut strands = strands.to_vec();
        strands.sort_unstable();
        let part = match keeper.kept(number).map_err(SimError::Keeper)? {
            Some(part) => part,
            None => {
                let within = Within { progress, done, n: strands.len(), of: order.len(), n_steps };
                let part = run(&strands, &within)?;
                keeper.keep(number, &part).map_err(SimError::Keeper)?;
                part
            }
        };
        frames.put_all(&strands, &part.positions_m).ok_or(SimError::OtherPart { number })?;
        count = count.and(part.count);
        done += strands.len();
    }
    Ok(Part { positions_m: frames.positions_m, count })
}

fn some_seconds(groom: &Groom, n_steps: usize) -> usize {
    let sticks_per_strand = groom.n_points() / groom.strands.len().max(1);
    (STICK_STEPS_PER_PART / (sticks_per_strand * n_steps).max(1)).max(LEAST_STRANDS)
}

/// The progress of a part as that of the whole, in steps of one strand.
struct Within<'a> {
    progress: &'a dyn Progress,
    /// Strands that are done, strands of this part, strands of all.
    done: usize,
    n: usize,
    of: usize,
    n_steps: usize,
}

impl Progress for Within<'_> {
    fn at(&self, done: u64, total: u64) {
        let steps = |strands: usize| (strands * self.n_steps) as u64;
        let here = (done as f64 / total.max(1) as f64 * steps(self.n) as f64) as u64;
        self.progress.at(steps(self.done) + here, steps(self.of));
    }
}

impl Count {
    /// Both together.
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            steps: self.steps + other.steps,
            iterations: self.iterations + other.iterations,
            slept: self.slept + other.slept,
            unsettled: self.unsettled + other.unsettled,
            unsettled_m: f64::max(self.unsettled_m, other.unsettled_m),
            max_stretch: f64::max(self.max_stretch, other.max_stretch),
        }
    }
}
