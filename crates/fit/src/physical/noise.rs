//! How far a lock's moments may be off, and how they go together.

use super::moments::Balance;
use nalgebra::DMatrix;
use tousle_core::{STANDARD_GRAVITY, Vec3};

/// Error of the force on a piece of lock as a share of its weight: of its mass, its drag, its inertia.
///
/// If it rises, the field follows the stream more and the locks less.
const FORCE_SHARE: f64 = 0.015;

/// Way along a lock over which the errors of forces are the same, m.
const FORCE_REACH_M: f64 = 0.1;

/// How fast the error of a marker's smoothed place comes and goes, 1/s: an error of place is an error of acceleration by its square.
///
/// If it rises, noisy and filled markers tell less, and the wind from them is weaker.
const MARKER_ERROR_RATE: f64 = 15.0;

/// Error of a joint's stiffness as a share of it.
const STIFFNESS_SHARE: f64 = 0.3;

/// Error of a joint's bend before the first marker, rad, if it is not larger anyway: a clamped lock bends within some
/// (EI / tension)^½ of its root, 2 cm, which a curve through markers does not draw, and whether the root gives way nobody sees.
///
/// If it rises, the inner ends of locks tell less, most of stiff ones. If it falls, a lock whose root gives way finds too strong a wind.
const UNSEEN_BEND: f64 = 0.1;

/// Error of a joint's bend, rad, of a lock that nobody saw at rest: what three numbers about each axis ([`super::constants`]) do
/// not tell of its natural shape, some .2. It stays for a whole capture, and counts as one that does not: so its square is three
/// times as large.
const BEND_UNKNOWN: f64 = 0.35;

/// Error of what a joint held at rest, as a share of it.
const REST_SHARE: f64 = 0.15;

/// The covariance of a lock's imbalance at a step, (N·m)².
///
/// Moments of nested joints err together: a force that is off is off in all of them.
pub(crate) fn covariance(balance: &Balance<'_>) -> DMatrix<f64> {
    let Balance { seen, step, rest, error_stiffness, bend_error_rad, .. } = *balance;
    let (lock, at) = (&seen.lock, &seen.steps[step]);
    let n = lock.n_sticks();
    let spread = |k: usize| {
        let of_weight = FORCE_SHARE * STANDARD_GRAVITY;
        let of_place = at.errors_m[k] * MARKER_ERROR_RATE * MARKER_ERROR_RATE;
        lock.masses_kg[k] * (of_weight * of_weight + of_place * of_place).sqrt()
    };
    let spreads: Vec<f64> = (0..n).map(spread).collect();
    // Levers: the moment of a unit force at every point on every joint, across its stick.
    let mut levers = DMatrix::zeros(2 * n, 3 * n);
    for j in 0..n {
        for k in j..n {
            let arm: Vec3 = at.points_m[k + 1] - at.points_m[j];
            for (row, axis) in at.across[j].iter().enumerate() {
                // axis · (arm × f) = (axis × arm) · f
                let lever = axis.cross(&arm) * spreads[k];
                for c in 0..3 {
                    levers[(2 * j + row, 3 * k + c)] = lever[c];
                }
            }
        }
    }
    // An exponential correlation along the lock is that of a chain: mix = a factor of it.
    let mut mixed = levers;
    for k in (0..n.saturating_sub(1)).rev() {
        let alike = libm::exp(-(lock.arcs_m[k + 1] - lock.arcs_m[k]) / FORCE_REACH_M);
        let fresh = (1.0 - alike * alike).sqrt();
        for c in 0..3 {
            for row in 0..2 * n {
                let outer = mixed[(row, 3 * (k + 1) + c)];
                mixed[(row, 3 * k + c)] += alike * outer;
                mixed[(row, 3 * (k + 1) + c)] = fresh * outer;
            }
        }
    }
    let mut covariance = &mixed * mixed.transpose();
    let first_marker = seen.marker_points.iter().flatten().min().copied().unwrap_or(n);
    for j in 0..n {
        let stiffness = lock.joint_stiffness[j] * error_stiffness;
        let bend = match rest {
            Some(_) => {
                let unseen = if j < first_marker { UNSEEN_BEND } else { 0.0 };
                STIFFNESS_SHARE * at.bends[j].norm() + bend_error_rad.max(unseen)
            }
            None => BEND_UNKNOWN,
        };
        let held = rest.map_or(0.0, |rest| REST_SHARE * rest.torques[j].norm());
        let own = (stiffness * bend) * (stiffness * bend) + held * held;
        for row in 0..2 {
            covariance[(2 * j + row, 2 * j + row)] += own;
        }
    }
    covariance
}
