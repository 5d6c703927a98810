//! How stiff the whole wig is, from which stiffness lets it move in its own wind as it was seen to.

use crate::rounds::Loop;
use crate::{Measured, RefineError};
use serde::Serialize;
use tousle_field::GridSpec;
use tousle_fit::{Fit, FitMethod, FitOptions, LIKELY_STIFFNESS_SPREAD, Scales};

/// From one stiffness that is tried to the next, as a logarithm: 1.6 times. The error's logarithm is near to a parabola over
/// three such.
const STEP: f64 = 0.47;

/// How many steps are gone at most from the nearer of the first two: up to 27 times as stiff as is likely, or a 17th.
const MOST_STEPS: usize = 6;

/// Time steps a second, at most, of winds that are only learnt from: as a stiffness is tried, where all that counts is which comes
/// nearest.
pub(crate) const ROUGH_RATE_HZ: f64 = 10.0;

/// The smallest voxels on which it is tried, m.
const EDGE_M: f64 = 0.04;

/// Swirl modes with which it is tried, at most.
const MODES: usize = 30;

/// How stiff a wig was found to be.
#[derive(Default)]
pub(crate) struct Sought {
    /// How stiff all its locks are; `None` where nobody can tell: if nobody knows how they hung at rest, or if nothing was seen
    /// after that.
    pub(crate) stiffness: Option<Stiffness>,
    /// What was found, roughly, with the nearest stiffness that was tried; `None` where nobody can tell that.
    pub(crate) nearest: Option<Fit>,
}

impl Sought {
    /// How stiff all locks are taken for.
    pub(crate) fn likely(&self) -> Stiffness {
        self.stiffness.unwrap_or(Stiffness { times: 1.0, spread: LIKELY_STIFFNESS_SPREAD })
    }
}

/// How stiff all locks of a wig are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stiffness {
    /// Over what is likely of such hair.
    pub times: f64,
    /// Standard deviation of its logarithm.
    pub spread: f64,
}

impl Stiffness {
    /// What it makes of every lock, before any is asked by itself.
    pub(crate) fn scales(self) -> Scales {
        Scales { stiffness: self.times, ..Scales::default() }
    }
}

/// How many times as stiff all locks of the wig are as is likely, judged without those that are held out.
///
/// A lock's motion under wind tells little of its stiffness by itself: twice the wind bends twice the stiffness as far, so a fit
/// finds the wind that goes with the stiffness that it is told. But what inertia, weight and the air's resistance make of the motion
/// does not change with both. So for each stiffness that is tried the wind is measured anew, roughly, and the wig simulated in it;
/// that with which it comes nearest is most likely: a profile likelihood in which every lock counts as one measurement of
/// unknown spread, and what is likely of hair ([`LIKELY_STIFFNESS_SPREAD`]) as another.
pub(crate) fn sought(around: &Loop<'_>, held_out: &[usize]) -> Result<Sought, RefineError> {
    // Where bends count little, a wig that is stiffer hardly moves, in more wind than there was, and so comes nearer.
    if !around.rest_seen() {
        return Ok(Sought::default());
    }
    let options = roughly(around.measured.options);
    let measured = Measured { options: &options, grid: coarse(&around.measured.grid), ..*around.measured };
    let around = Loop { measured: &measured, ..*around };
    let n_locks = around.wig.strand_idxs.len() - held_out.len();
    let mut nearest: Option<(f64, Fit)> = None;
    let cost = |log: f64| -> Result<f64, RefineError> {
        let from = nearest.as_ref().map(|(_, fit)| fit);
        let stiffness = Stiffness { times: libm::exp(log), spread: LIKELY_STIFFNESS_SPREAD };
        let turn = around.with_stiffness(stiffness, from, held_out)?;
        let off_m = around.compare(&turn)?.round(held_out).seen_m;
        let unlikely = log / LIKELY_STIFFNESS_SPREAD;
        let cost = n_locks as f64 * libm::log(off_m) + 0.5 * unlikely * unlikely;
        // Hair that is nowhere is as far off as can be.
        let cost = if cost.is_nan() { f64::INFINITY } else { cost };
        if nearest.as_ref().is_none_or(|(least, _)| cost < *least) {
            nearest = Some((cost, turn.fit));
        }
        Ok(cost)
    };
    let stiffness = least(cost)?.map(|(log, spread)| Stiffness { times: libm::exp(log), spread });
    Ok(Sought { stiffness, nearest: stiffness.and(nearest).map(|(_, fit)| fit) })
}

/// Error of a joint's bend with which it is tried, rad: with half or twice that all but the stiffest hair is found as stiff.
const BEND_ERROR_RAD: f64 = 0.12;

/// The same way to measure, cheaper, with all locks alike.
fn roughly(options: &FitOptions) -> FitOptions {
    let mut roughly = options.clone();
    roughly.rate_hz = roughly.rate_hz.min(ROUGH_RATE_HZ);
    if let FitMethod::Physical(physical) = &mut roughly.method {
        physical.max_modes = physical.max_modes.min(MODES);
        physical.stiffness_known = false;
        physical.bend_error_rad = BEND_ERROR_RAD;
        // Bends that may be off by themselves take a share of what a wig is stiffer by.
        physical.locks_differ = false;
        physical.says_how_sure = false;
    }
    roughly
}

/// A grid of the same place and at least the same extent, of voxels no smaller than [`EDGE_M`].
fn coarse(grid: &GridSpec) -> GridSpec {
    let edge_m = grid.edge_m.max(EDGE_M);
    let n_voxels = |n: usize| (n as f64 * grid.edge_m / edge_m).ceil() as usize;
    GridSpec { edge_m, dims: grid.dims.map(n_voxels), ..*grid }
}

/// Where a cost, minus a logarithm of a likelihood, is least, and the standard deviation of that: walks from 0 on, [`STEP`] by
/// [`STEP`], for as long as it falls, and ends on the parabola through the last three; `None` if it is infinite at 0. A cost is never
/// NaN.
fn least<E>(mut cost: impl FnMut(f64) -> Result<f64, E>) -> Result<Option<(f64, f64)>, E> {
    let here = cost(0.0)?;
    if here == f64::INFINITY {
        return Ok(None);
    }
    let up = cost(STEP)?;
    let is_up = up < here;
    let step = if is_up { STEP } else { -STEP };
    let (mut before, mut best, mut at) = if is_up { (here, up, step) } else { (up, here, 0.0) };
    for _ in 0..MOST_STEPS {
        let after = cost(at + step)?;
        if after >= best {
            let bend = before - 2.0 * best + after;
            let (aside, spread) = if bend.is_finite() && bend > 0.0 {
                (0.5 * (before - after) / bend, STEP / bend.sqrt())
            } else {
                (0.0, STEP)
            };
            return Ok(Some((at + step * aside, spread.min(LIKELY_STIFFNESS_SPREAD))));
        }
        (before, best, at) = (best, after, at + step);
    }
    Ok(Some((at, LIKELY_STIFFNESS_SPREAD)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn least_with_spread(cost: impl Fn(f64) -> f64) -> (f64, f64) {
        least(|log| Ok::<_, core::convert::Infallible>(cost(log)))
            .ok()
            .flatten()
            .unwrap_or((f64::NAN, f64::NAN))
    }

    fn least_of(cost: impl Fn(f64) -> f64) -> f64 {
        least_with_spread(cost).0
    }

    #[test]
    fn the_least_of_a_parabola_is_found_on_either_side() {
        for place in [-2.1, -0.3, 0.0, 0.2, 0.5, 1.9] {
            let found = least_of(|log| 3.0 + (log - place) * (log - place));
            assert!((found - place).abs() < 1e-12, "{found}, not {place}");
        }
    }

    #[test]
    fn a_parabola_tells_how_sure_it_is() {
        for spread in [0.05, 0.3] {
            let of_bell = |log: f64| 0.5 * (log - 0.4) * (log - 0.4) / (spread * spread);
            let (_, found) = least_with_spread(of_bell);
            assert!((found - spread).abs() < 1e-12, "{found}, not {spread}");
        }
        assert!((least_with_spread(|_| 1.0).1 - STEP).abs() < 1e-12, "nothing tells");
    }

    #[test]
    fn hair_that_is_nowhere_is_never_taken() {
        let found = least_of(|log| if log > 0.3 { f64::INFINITY } else { (log + 0.2) * (log + 0.2) });
        assert!((found + 0.2).abs() < 0.5 * STEP, "{found}");
        assert!(least_of(|_| f64::INFINITY).is_nan());
    }

    #[test]
    fn it_stops_somewhere() {
        let most = STEP * (MOST_STEPS + 1) as f64;
        assert!((least_of(|log| -log) - most).abs() < 1e-12);
    }

    #[test]
    fn a_coarse_grid_holds_the_fine_one() {
        let fine = GridSpec { origin_m: tousle_core::Vec3::repeat(-0.3), edge_m: 0.01, dims: [60, 61, 1] };
        assert_eq!(coarse(&fine), GridSpec { edge_m: 0.04, dims: [15, 16, 1], ..fine });
        let rough = GridSpec { edge_m: 0.06, ..fine };
        assert_eq!(coarse(&rough), rough);
    }
}
