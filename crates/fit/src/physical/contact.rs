//! What the body does to a lock: pushes outwards, never pulls, and rubs.

use super::lock::{LockAt, SeenLock};
use super::moments::across;
use nalgebra::{DMatrix, DVector};
use tousle_core::Vec3;
use tousle_rod::{Surface, nonnegative_least_squares};

/// Moments of unit forces at every point of a lock that may touch the body, three columns each: outwards, and two along
/// the surface.
pub(crate) fn touching(seen: &SeenLock, at: &LockAt, surfaces: &[Surface], within_m: f64) -> DMatrix<f64> {
    let n = seen.lock.n_sticks();
    let mut touches: Vec<(usize, Vec3)> = Vec::new();
    for k in 0..n {
        for surface in surfaces {
            if let Some(gap) = surface.gap_within(at.points_m[k + 1], within_m) {
                touches.push((k, gap.normal));
            }
        }
    }
    let mut columns = DMatrix::zeros(2 * n, 3 * touches.len());
    for (touch, (k, normal)) in touches.iter().enumerate() {
        let [first, second] = across(*normal);
        for j in 0..=*k {
            let arm = at.points_m[k + 1] - at.points_m[j];
            for (row, axis) in at.across[j].iter().enumerate() {
                let lever = axis.cross(&arm);
                for (c, force) in [*normal, first, second].iter().enumerate() {
                    columns[(2 * j + row, 3 * touch + c)] = lever.dot(force);
                }
            }
        }
    }
    columns
}

/// What is known of a lock's imbalance: rows of it, combined so that they are independent and of variance 1.
pub(crate) struct Whitened {
    pub(crate) moments: DVector<f64>,
    pub(crate) by_wind: DMatrix<f64>,
    /// Points at which the body pushes.
    pub(crate) n_pushing: usize,
}

/// Takes out of a whitened imbalance what the body may do, `touching` being whitened in the same way.
///
/// The pushes ≥ 0 are those that leave the least imbalance, small ones preferred (`likely_push_n` is their scale, N).
/// Where it pushes, its push and its friction, up to `friction` of it, are unknowns of that size: what they would explain is
/// no evidence of wind.
pub(crate) fn less_body(
    white: Whitened,
    touching: &DMatrix<f64>,
    likely_push_n: f64,
    friction: f64,
) -> Whitened {
    let n_touches = touching.ncols() / 3;
    if n_touches == 0 {
        return white;
    }
    let pushes = pushes(&white.moments, touching, likely_push_n);
    let pushing: Vec<(usize, f64)> =
        pushes.iter().copied().enumerate().filter(|(_, push)| *push > 0.0).collect();
    if pushing.is_empty() {
        return white;
    }
    let n_rows = white.moments.len();
    let mut unknown = DMatrix::zeros(n_rows, 3 * pushing.len());
    for (k, (touch, push)) in pushing.iter().enumerate() {
        for (along, size_n) in [likely_push_n, friction * push, friction * push].into_iter().enumerate() {
            unknown.column_mut(3 * k + along).axpy(size_n, &touching.column(3 * touch + along), 0.0);
        }
    }
    let n_pushing = pushing.len();
    let Some(known) = told(&unknown) else { return white };
    Whitened {
        moments: &white.moments - &unknown * (&known * &white.moments),
        by_wind: &white.by_wind - &unknown * (&known * &white.by_wind),
        n_pushing,
    }
}

/// What is told of unknowns C of variance 1 that stand beside errors of variance 1: less C times this, a whitened imbalance is
/// whitened anew. `None` if a number is not finite.
///
/// With `I + CᵀC = LLᵀ` that is `(L + I)⁻ᵀ L⁻¹ Cᵀ` (Andrews, "A square root formulation of the Kalman covariance equations",
/// 1968): the unknowns are few, so their product is small.
fn told(unknown: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let one = DMatrix::identity(unknown.ncols(), unknown.ncols());
    let lower = (unknown.tr_mul(unknown) + &one).cholesky()?.l();
    let turn = (&lower + &one).tr_solve_lower_triangular(&lower.solve_lower_triangular(&one)?)?;
    Some(turn * unknown.transpose())
}

/// The pushes ≥ 0, N, that leave the least of a whitened imbalance, small ones preferred.
fn pushes(moments: &DVector<f64>, touching: &DMatrix<f64>, likely_push_n: f64) -> DVector<f64> {
    let n_touches = touching.ncols() / 3;
    let normals = DMatrix::from_fn(touching.nrows(), n_touches, |r, c| touching[(r, 3 * c)] * likely_push_n);
    let gram = normals.tr_mul(&normals) + DMatrix::identity(n_touches, n_touches);
    nonnegative_least_squares(&gram, &-normals.tr_mul(moments)) * likely_push_n
}

/// A whitened imbalance less those pushes of the body.
pub(crate) fn less_pushes(
    moments: &DVector<f64>,
    touching: &DMatrix<f64>,
    likely_push_n: f64,
) -> DVector<f64> {
    let pushes = pushes(moments, touching, likely_push_n);
    pushes.iter().enumerate().fold(moments.clone(), |left, (k, push)| left + touching.column(3 * k) * *push)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn white(moments: &[f64]) -> Whitened {
        Whitened {
            moments: DVector::from_row_slice(moments),
            by_wind: DMatrix::identity(moments.len(), moments.len()),
            n_pushing: 0,
        }
    }

    /// A push that balances what is left explains it; a pull that would is not there, and the same is evidence of wind.
    #[test]
    fn the_body_pushes_and_never_pulls() {
        // 1 N outwards makes a moment of 100 in the first row; nothing along the surface does anything.
        let touching = DMatrix::from_row_slice(2, 3, &[100.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let pushed = less_body(white(&[-5.0, 1.0]), &touching, 1.0, 0.25);
        assert_eq!(pushed.n_pushing, 1);
        assert!(pushed.moments[0].abs() < 0.1 && (pushed.moments[1] - 1.0).abs() < 1e-12);
        assert!(pushed.by_wind[(0, 0)] < 0.02, "wind there is no longer told");
        let pulled = less_body(white(&[5.0, 1.0]), &touching, 1.0, 0.25);
        assert_eq!((pulled.n_pushing, pulled.moments[0]), (0, 5.0));
    }

    /// What is whitened anew has the covariance I if what it was made of had one of I and the unknowns' product.
    #[test]
    fn unknowns_are_whitened() {
        let unknown = DMatrix::from_fn(5, 3, |r, c| f64::from((3 * r as u8 + 5 * c as u8) % 7) - 2.5);
        let one = DMatrix::<f64>::identity(5, 5);
        let whitening = &one - &unknown * told(&unknown).unwrap();
        let covariance = &whitening * (&unknown * unknown.transpose() + &one) * whitening.transpose();
        assert!((covariance - one).amax() < 1e-12);
    }

    /// Friction explains as much as it may: what takes no more than its share of the push.
    #[test]
    fn friction_is_an_unknown_of_its_size() {
        let touching = DMatrix::from_row_slice(2, 3, &[100.0, 0.0, 0.0, 0.0, 100.0, 0.0]);
        let rubbed = less_body(white(&[-50.0, 3.0]), &touching, 1.0, 0.25);
        // Half a newton pushes: friction's unknown moment has a standard deviation of 12.5 beside the error's 1.
        assert!((rubbed.moments[1] - 3.0 / libm::hypot(1.0, 12.5)).abs() < 0.01, "{}", rubbed.moments[1]);
    }
}
