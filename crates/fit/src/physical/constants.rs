//! What each lock is off by for the whole capture: its stiffness, its drag, and how its natural shape is bent.
//!
//! Errors of a lock that never change look like wind that never changes. Where they are unknowns beside the air, each lock's
//! motion tells its own, and all locks together what is wind.

use nalgebra::{DMatrix, DVector};

/// Places along a lock at which the bends of its natural shape may be off, linear in between: its root, its middle and its tip.
const BEND_PLACES: usize = 3;

/// Numbers of a lock: the logarithms of its stiffness and of its drag over what they are taken for, then for each of
/// [`BEND_PLACES`] how far its natural shape is bent otherwise, rad a joint, about the two axes across the stick.
pub(crate) const N_CONSTANTS: usize = 2 + 2 * BEND_PLACES;

/// A lock's constants; zero where it is what it is taken for.
pub(crate) type Constants = [f64; N_CONSTANTS];

/// How far the logarithm of a lock's stiffness may be from that of all, as they are taken for.
const STIFFNESS: f64 = 0.1;

/// How far the logarithm of a lock's drag may be from that of its width, which is measured to a few per cent.
const DRAG: f64 = 0.05;

/// How far a joint's natural bend may be off, rad: where a lock hangs free at rest its balance there says more, where it lies on
/// the body nothing else does.
const BEND: f64 = 0.15;

/// The same, of a lock that nobody saw at rest.
const BEND_UNSEEN: f64 = 0.4;

/// How far the mean over all locks of the logarithm of stiffness, and of drag, may be moved by what is seen. It is held: seen bends
/// have errors, so a balance always finds hair softer than it is, and what all drag has in common cannot be told from the wind's
/// strength. How far they may be off nevertheless ([`super::Taught::stiffness_spread`], [`ALL_DRAG`]) counts in how sure the air is, as of
/// parameters that are considered but not estimated (S. F. Schmidt, "Application of state-space methods to navigation problems",
/// *Advances in Control Systems* 3, 1966).
const MEAN: f64 = 1e-3;

/// How far the logarithm of all locks' drag may be off together: all widths are measured with one gauge, to a few per cent, and laws
/// of a cylinder's drag differ by a tenth ([`tousle_rod::DragLaw`]: by up to two).
const ALL_DRAG: f64 = 0.1;

/// Where the column of a bend stands, at a place and about an axis.
pub(crate) fn bend_column(place: usize, axis: usize) -> usize {
    2 + 2 * place + axis
}

/// How much the bend at a place counts at `share` of the way from root to tip.
pub(crate) fn bend_share(place: usize, share: f64) -> f64 {
    f64::max(1.0 - (share * (BEND_PLACES - 1) as f64 - place as f64).abs(), 0.0)
}

/// All places.
pub(crate) fn bend_places() -> core::ops::Range<usize> {
    0..BEND_PLACES
}

/// What is likely of all locks' constants before any is asked.
#[derive(Clone, Copy)]
pub(crate) struct LikelyConstants {
    /// How many locks there are.
    pub(crate) n_locks: usize,
    /// Whether their shape at rest was seen.
    pub(crate) rest_seen: bool,
}

/// What is said of all locks' constants, lock after lock, and of them together with the air at every step.
pub(crate) struct ConstantsSaid {
    /// Symmetric.
    pub(crate) information: DMatrix<f64>,
    pub(crate) vector: DVector<f64>,
    /// By step: the block that joins the air's state (rows) to the constants.
    pub(crate) with_air: Vec<DMatrix<f64>>,
    /// If what is unknown of them shall count in the covariances of the states: the vectors that move what is held of the means, of
    /// stiffness and of drag, by their standard deviations.
    pub(crate) means_off: Option<DMatrix<f64>>,
}

/// What a step says of the constants.
#[derive(Default)]
pub(crate) struct ConstantsAt {
    /// By lock.
    pub(crate) information: Vec<DMatrix<f64>>,
    pub(crate) vector: DVector<f64>,
    /// As in [`ConstantsSaid`].
    pub(crate) with_air: DMatrix<f64>,
}

impl ConstantsSaid {
    /// All steps together, with what is likely before any is asked. `stiffness_spread`: how far the mean logarithm of stiffness
    /// may be off, if what is unknown shall count.
    pub(crate) fn together(
        steps: impl Iterator<Item = ConstantsAt>,
        likely: LikelyConstants,
        stiffness_spread: Option<f64>,
    ) -> Self {
        let (information, n) = (likely.information(), likely.n_locks * N_CONSTANTS);
        let by_spreads = |stiffness: f64| {
            let spreads = [stiffness, ALL_DRAG];
            let alike = |i: usize, mean: usize| if i % N_CONSTANTS == mean { spreads[mean] } else { 0.0 };
            &information * DMatrix::from_fn(n, spreads.len(), alike)
        };
        let means_off = stiffness_spread.map(by_spreads);
        let mut said = Self { information, vector: DVector::zeros(n), with_air: Vec::new(), means_off };
        for step in steps {
            for (lock, of_lock) in step.information.iter().enumerate() {
                let at = lock * N_CONSTANTS;
                let mut own = said.information.view_mut((at, at), (N_CONSTANTS, N_CONSTANTS));
                own += of_lock;
            }
            said.vector += step.vector;
            said.with_air.push(step.with_air);
        }
        said
    }
}

impl LikelyConstants {
    /// Their precision.
    fn information(self) -> DMatrix<f64> {
        let Self { n_locks, rest_seen } = self;
        let n = n_locks * N_CONSTANTS;
        let spread = |constant: usize| match constant {
            0 => STIFFNESS,
            1 => DRAG,
            _ if rest_seen => BEND,
            _ => BEND_UNSEEN,
        };
        let mean = 1.0 / (MEAN * n_locks as f64 * MEAN * n_locks as f64);
        DMatrix::from_fn(n, n, |r, c| {
            let (constant, other) = (r % N_CONSTANTS, c % N_CONSTANTS);
            let own = if r == c { 1.0 / (spread(constant) * spread(constant)) } else { 0.0 };
            own + if constant == other && constant < 2 { mean } else { 0.0 }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Locks may differ, all of them together may not.
    #[test]
    fn the_mean_is_known() {
        let n_locks = 9;
        let likely = LikelyConstants { n_locks, rest_seen: true };
        let spread = likely.information().try_inverse().unwrap();
        let one = |constant: usize| {
            DVector::from_fn(spread.nrows(), |i, _| f64::from(u8::from(i % N_CONSTANTS == constant)))
        };
        let mean = |constant: usize| one(constant).dot(&(&spread * one(constant))).sqrt() / n_locks as f64;
        assert!(mean(0) <= MEAN && mean(1) <= MEAN && (mean(2) - BEND / 3.0).abs() < 1e-9);
        let difference = spread[(0, 0)] + spread[(N_CONSTANTS, N_CONSTANTS)] - 2.0 * spread[(0, N_CONSTANTS)];
        assert!((difference - 2.0 * STIFFNESS * STIFFNESS).abs() < 1e-6);
    }

    /// Together the places share a bend out.
    #[test]
    fn places_share_a_bend_out() {
        for share in [0.0, 0.2, 0.5, 0.9, 1.0] {
            let sum: f64 = bend_places().map(|place| bend_share(place, share)).sum();
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }
}
