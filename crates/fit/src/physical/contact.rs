//! What the body does to a lock: pushes outwards, never pulls, and rubs.

use super::lock::{LockAt, SeenLock};
use super::moments::across;
use super::triangle::Triangle;
use nalgebra::{DMatrix, DVector};
use tousle_core::Vec3;
use tousle_rod::{Surface, nonnegative_least_squares};

/// A place where a lock may touch the body.
pub(crate) struct Touch {
    /// The stick that ends there.
    stick: usize,
    /// Out of the body.
    normal: Vec3,
}

impl Touch {
    /// All places of a lock that are near enough.
    pub(crate) fn all(seen: &SeenLock, at: &LockAt, surfaces: &[Surface], within_m: f64) -> Vec<Self> {
        let mut touches = Vec::new();
        for stick in 0..seen.lock.n_sticks() {
            for surface in surfaces {
                if let Some(gap) = surface.gap_within(at.points_m[stick + 1], within_m) {
                    touches.push(Self { stick, normal: gap.normal });
                }
            }
        }
        touches
    }

    /// Moments of a unit push.
    pub(crate) fn of_push(&self, at: &LockAt) -> DVector<f64> {
        self.of_force(at, self.normal)
    }

    /// Moments of unit rubs two ways along the surface.
    pub(crate) fn of_rubs(&self, at: &LockAt) -> [DVector<f64>; 2] {
        across(self.normal).map(|force| self.of_force(at, force))
    }

    fn of_force(&self, at: &LockAt, force: Vec3) -> DVector<f64> {
        let mut moments = DVector::zeros(2 * at.across.len());
        for j in 0..=self.stick {
            let arm = at.points_m[self.stick + 1] - at.points_m[j];
            for (row, axis) in at.across[j].iter().enumerate() {
                moments[2 * j + row] = axis.cross(&arm).dot(&force);
            }
        }
        moments
    }
}

/// Takes out of a whitened imbalance what the body may do: `of_pushes`, a column for each place where it may push, and
/// `of_rubs`, two for each of those where it does, being whitened in the same way. Out: at how many places it pushes.
///
/// `white`: rows of the imbalance, combined so that they are independent and of variance 1; first their values, then their change
/// with each unknown.
/// The pushes ≥ 0 are those that leave the least imbalance, small ones preferred (`likely_push_n` is their scale, N).
/// Where it pushes, its push and its friction, up to `friction` of it, are unknowns of that size: what they would explain is
/// no evidence of wind.
pub(crate) fn less_body(
    white: &mut DMatrix<f64>,
    of_pushes: &DMatrix<f64>,
    of_rubs: impl Fn(&[usize]) -> DMatrix<f64>,
    likely_push_n: f64,
    friction: f64,
) -> usize {
    if of_pushes.ncols() == 0 {
        return 0;
    }
    let pushes = pushes(&white.column(0).into_owned(), of_pushes, likely_push_n);
    let pushing: Vec<usize> = (0..pushes.len()).filter(|touch| pushes[*touch] > 0.0).collect();
    if pushing.is_empty() {
        return 0;
    }
    let of_rubs = of_rubs(&pushing);
    let mut unknown = DMatrix::zeros(white.nrows(), 3 * pushing.len());
    for (k, touch) in pushing.iter().enumerate() {
        unknown.column_mut(3 * k).axpy(likely_push_n, &of_pushes.column(*touch), 0.0);
        for along in 0..2 {
            let of_rub = of_rubs.column(2 * k + along);
            unknown.column_mut(3 * k + 1 + along).axpy(friction * pushes[*touch], &of_rub, 0.0);
        }
    }
    if whiten_anew(white, &unknown).is_some() { pushing.len() } else { 0 }
}

/// Whitens columns anew beside whose errors of variance 1 stand unknowns C of variance 1. `None`, and nothing done, if a number is not
/// finite.
///
/// With `I + CᵀC = LLᵀ` that takes off `C (L + I)⁻ᵀ L⁻¹ Cᵀ` times them (Andrews, "A square root formulation of the Kalman covariance
/// equations", 1968): the unknowns are few, so their product is small.
fn whiten_anew(columns: &mut DMatrix<f64>, unknown: &DMatrix<f64>) -> Option<()> {
    let turned = unknown.transpose();
    let one = DMatrix::identity(unknown.ncols(), unknown.ncols());
    let lower = (&turned * unknown + &one).cholesky()?.l();
    let told = Triangle::of(&lower).solve(&(turned * &*columns));
    columns.gemm(-1.0, unknown, &Triangle::of(&(lower + one)).solve_turned(&told), 1.0);
    Some(())
}

/// The pushes ≥ 0, N, that leave the least of a whitened imbalance, small ones preferred.
fn pushes(moments: &DVector<f64>, of_pushes: &DMatrix<f64>, likely_push_n: f64) -> DVector<f64> {
    let likely = of_pushes * likely_push_n;
    let gram = likely.tr_mul(&likely) + DMatrix::identity(likely.ncols(), likely.ncols());
    nonnegative_least_squares(&gram, &-likely.tr_mul(moments)) * likely_push_n
}

/// A whitened imbalance less those pushes of the body.
pub(crate) fn less_pushes(
    moments: &DVector<f64>,
    of_pushes: &DMatrix<f64>,
    likely_push_n: f64,
) -> DVector<f64> {
    let pushes = pushes(moments, of_pushes, likely_push_n);
    pushes.iter().enumerate().fold(moments.clone(), |left, (k, push)| left + of_pushes.column(k) * *push)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Moments, each of which changes with an unknown of its own.
    fn white(moments: [f64; 2]) -> DMatrix<f64> {
        DMatrix::from_row_slice(2, 3, &[moments[0], 1.0, 0.0, moments[1], 0.0, 1.0])
    }

    /// A push that balances what is left explains it; a pull that would is not there, and the same is evidence of wind.
    #[test]
    fn the_body_pushes_and_never_pulls() {
        // 1 N outwards makes a moment of 100 in the first row; nothing along the surface does anything.
        let (of_push, of_rubs) =
            (DMatrix::from_row_slice(2, 1, &[100.0, 0.0]), |_: &[usize]| DMatrix::zeros(2, 2));
        let mut pushed = white([-5.0, 1.0]);
        assert_eq!(less_body(&mut pushed, &of_push, of_rubs, 1.0, 0.25), 1);
        assert!(pushed[(0, 0)].abs() < 0.1 && (pushed[(1, 0)] - 1.0).abs() < 1e-12);
        assert!(pushed[(0, 1)] < 0.02, "wind there is no longer told");
        let mut pulled = white([5.0, 1.0]);
        assert_eq!(less_body(&mut pulled, &of_push, of_rubs, 1.0, 0.25), 0);
        assert_eq!(pulled, white([5.0, 1.0]));
    }

    /// What is whitened anew has the covariance I if what it was made of had one of I and the unknowns' product.
    #[test]
    fn unknowns_are_whitened() {
        let unknown = DMatrix::from_fn(5, 3, |r, c| f64::from((3 * r as u8 + 5 * c as u8) % 7) - 2.5);
        let one = DMatrix::<f64>::identity(5, 5);
        let mut whitening = one.clone();
        whiten_anew(&mut whitening, &unknown).unwrap();
        let covariance = &whitening * (&unknown * unknown.transpose() + &one) * whitening.transpose();
        assert!((covariance - one).amax() < 1e-12);
    }

    /// Friction explains as much as it may: what takes no more than its share of the push.
    #[test]
    fn friction_is_an_unknown_of_its_size() {
        let of_push = DMatrix::from_row_slice(2, 1, &[100.0, 0.0]);
        let of_rubs = |_: &[usize]| DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 100.0, 0.0]);
        let mut rubbed = white([-50.0, 3.0]);
        assert_eq!(less_body(&mut rubbed, &of_push, of_rubs, 1.0, 0.25), 1);
        // Half a newton pushes: friction's unknown moment has a standard deviation of 12.5 beside the error's 1.
        assert!((rubbed[(1, 0)] - 3.0 / libm::hypot(1.0, 12.5)).abs() < 0.01, "{}", rubbed[(1, 0)]);
    }
}
