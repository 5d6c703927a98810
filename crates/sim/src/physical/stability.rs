//! How long a step the explicit integrators stand.

use super::batch::Batch;
use super::link::Work;
use crate::lane::Lane;

/// The longest step for a run, and the strand that sets it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limit {
    pub dt_secs: f64,
    pub strand_idx: usize,
    /// A strand that bending does not keep from cracking like a whip; for such hair the limit is a hope.
    pub limp_idx: Option<usize>,
}

impl Limit {
    /// The limit of two batches.
    pub fn and(self, other: Self) -> Self {
        let tighter = if other.dt_secs < self.dt_secs { other } else { self };
        Self { limp_idx: self.limp_idx.or(other.limp_idx), ..tighter }
    }
}

/// The share of the limit that is left to what the power method and the rest shape do not see.
const SAFETY: f64 = 0.8;

/// How much stiffer a joint is that is bent by half a turn (`bend_joints`): it may have come that far from rest.
const HALF_TURN_STIFFENS: f64 = 4.0;

/// The longest step for a batch, s, and the strand that sets it. `pull`: the strongest pull on a unit of mass, m/s².
///
/// Semi-implicit Euler stands 2 over the highest frequency; what damps is taken at the step's end. The Runge-Kutta
/// method stands 2.8 over it, and 2.7 over the rate of damping, which is the square of the frequency times the damping's
/// time.
pub(crate) fn limit<L: Lane>(
    batch: &Batch<L>,
    work: &mut [Work<L>],
    damping_is_explicit: bool,
    pull: f64,
) -> Limit {
    let stiffest = batch.stiffest(work);
    let mut limit = Limit { dt_secs: f64::INFINITY, strand_idx: batch.strands[0], limp_idx: None };
    for (lane, strand_idx) in batch.strands.iter().enumerate() {
        let shortest = batch.links.iter().map(|l| l.length.get(lane)).fold(f64::INFINITY, f64::min);
        let lightest =
            batch.links.iter().map(|l| l.mass.get(lane)).filter(|m| *m > 0.0).fold(f64::INFINITY, f64::min);
        let bending2 = HALF_TURN_STIFFENS * stiffest.get(lane) * stiffest.get(lane);
        // A stick under a pull is a pendulum. Folded hair that falls through its whole length cracks like a whip: its
        // shortest stick then swings round with the speed of that fall.
        let reach: f64 = batch.links.iter().map(|l| l.length.get(lane)).sum();
        let whip = pull * (1.0 + 2.0 * reach / shortest);
        let swing = whip / shortest * batch.links.len() as f64;
        // A contact is a spring made for the mean point.
        let touch =
            if batch.touchable.is_empty() { 0.0 } else { batch.contact_stiffness.get(lane) / lightest };
        let frequency = (bending2 + swing + touch).sqrt();
        let dt_secs = if damping_is_explicit {
            let damping = batch.links.iter().map(|l| l.damping_secs.get(lane)).fold(0.0, f64::max);
            let rate = damping * bending2 + 2.0 * touch.sqrt();
            f64::min(2.8 / frequency, 2.7 / rate)
        } else {
            2.0 / frequency
        };
        if SAFETY * dt_secs < limit.dt_secs {
            limit.dt_secs = SAFETY * dt_secs;
            limit.strand_idx = *strand_idx;
        }
        if bending2 < swing {
            limit.limp_idx = limit.limp_idx.or(Some(*strand_idx));
        }
    }
    limit
}
