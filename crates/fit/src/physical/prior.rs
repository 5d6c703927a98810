//! What is known of the air before any lock is asked.

use super::smoother::{Carried, Wander};
use super::solve::Problem;
use super::triangle::inverse_factor;
use crate::outside::fan_winds;
use nalgebra::{DMatrix, DVector, Matrix3, Translation3};
use tousle_core::{Pose, Vec3};
use tousle_flow::{AirFlow, N_STREAM};

/// Strength of swirls over the stream's: what a wind between walls carries, and what a simple wake and layer leave out.
pub(crate) const SWIRL_SHARE: f64 = 0.25;

/// The least strength of swirls, m/s, so that air that stands still far away may move near the head.
const LEAST_SWIRL_MPS: f64 = 0.05;

/// How long a swirl lasts while the stream carries it, s: those of a decimeter or two turn over in about so long, and pass a
/// head in a tenth of it. A third or three times as long changes little.
const SWIRL_LASTS_SECS: f64 = 1.0;

/// How far the wind may be from the fans' setting, as a share of it: gusts, and fans that are set by eye.
const FAN_SHARE: f64 = 0.5;

/// The same up and down, where fans do not swing and floor and ceiling are near.
const RISING_SHARE: f64 = 0.07;

/// Time in which the wind far away may change as far, s.
const OUTSIDE_LASTS_SECS: f64 = 0.6;

/// Wind that may blow where no fan is named, m/s.
const UNNAMED_MPS: f64 = 3.0;

/// Draft in a room before the fans are on, m/s.
const DRAFT_MPS: f64 = 0.05;

/// Wake, layer, and what slips past the scalp: mean, standard deviation, and how long they stay, s; the last for a whole capture.
pub(crate) const WAKE: [f64; 3] = [0.6, 0.3, 1.0];
pub(crate) const LOG_LAYER: [f64; 3] = [-4.4, 0.7, 2.0];
pub(crate) const SLIP: [f64; 3] = [0.3, 0.3, 1000.0];

/// How strong swirls are in a stream, m/s.
pub(crate) fn swirl_mps(outside: Vec3, share: f64) -> f64 {
    f64::max(share * outside.norm(), LEAST_SWIRL_MPS)
}

/// What the fans are set to at a step.
pub(crate) struct FanWind {
    /// The wind of all together, head axes, m/s; zero before they are on.
    pub(crate) velocity: Vec3,
    /// Where each blows, head axes, unit length; zero for one that is off.
    pub(crate) directions: Vec<Vec3>,
}

/// Wind from the fans at every step.
pub(crate) fn fan_wind(problem: &Problem<'_>) -> Vec<FanWind> {
    let Problem { session, head, clock, rest_pose, .. } = problem;
    let start_secs = session.wind_start_secs(head.first_frame, head.rate_hz).unwrap_or(f64::NEG_INFINITY);
    (0..clock.n_steps)
        .map(|k| {
            let time_secs = clock.time_secs(k);
            let winds = fan_winds(session, head, rest_pose, clock.pose(k), time_secs);
            let is_on = time_secs >= start_secs && !is_still(problem, k);
            FanWind {
                velocity: if is_on { winds.iter().sum() } else { Vec3::zeros() },
                directions: winds.iter().map(|wind| wind.try_normalize(1e-9).unwrap_or_default()).collect(),
            }
        })
        .collect()
}

/// Whether nothing moves at a step.
pub(crate) fn is_still(problem: &Problem<'_>, step: usize) -> bool {
    let frame = problem.clock.frame(step);
    problem.still.is_some_and(|(first, last)| (first..=last).contains(&frame))
}

/// The state's prior: swirls about nothing and the wind far away about anything, carried as [`carried`] says, wake, layer and slip about
/// what is usual.
pub(crate) fn wander(problem: &Problem<'_>, n_modes: usize) -> Wander {
    let n = n_modes + N_STREAM;
    let dt = 1.0 / problem.clock.rate_hz;
    let keep = |lasts_secs: f64| libm::exp(-dt / lasts_secs);
    let n_carried = n_modes + 3;
    let mut keeps = DVector::zeros(n);
    let mut mean = DVector::zeros(n);
    let mut sd = DVector::from_element(n, 1.0);
    for (i, [value, spread, lasts]) in [WAKE, LOG_LAYER, SLIP].iter().enumerate() {
        let at = n_modes + 3 + i;
        (keeps[at], mean[at], sd[at]) = (keep(*lasts), *value, *spread);
    }
    let mut first = sd.map(|s: f64| 1.0 / (s * s));
    let fresh = DVector::from_fn(n, |i, _| first[i] / (1.0 - keeps[i] * keeps[i]));
    first.rows_mut(n_modes, 3).fill(0.0);
    Wander { mean, first, keeps, fresh, n_carried }
}

/// How swirls that travel, and the wind far away, come to a step from the one before.
///
/// The stream carries swirls past (G. I. Taylor's hypothesis, "The spectrum of turbulence", 1938): what blows somewhere was
/// upstream before, at the speed that `air` has far away. The wind far away is in the axes of the head, which turns: in those of the
/// room it goes on as it was, but for what it may change by if the fans' strongest wind is `strongest_mps`.
pub(crate) fn carried(problem: &Problem<'_>, air: &AirFlow, strongest_mps: f64, step: usize) -> Carried {
    let n = air.modes.n_modes();
    let dt = 1.0 / problem.clock.rate_hz;
    let before = step.saturating_sub(1);
    let travel_m = (air.states[before].outside() + air.states[step].outside()) * (0.5 * dt);
    let head_before_from_now: Pose = problem.clock.pose(before).inverse() * problem.clock.pose(step);
    let by = air.modes.carried(&(Translation3::from(-travel_m) * head_before_from_now))
        * libm::exp(-dt / SWIRL_LASTS_SECS);
    let fresh = DMatrix::identity(n, n) - &by * by.transpose();
    let unmixed = inverse_factor(&fresh).unwrap_or_else(|| DMatrix::identity(n, n));
    let turned = head_before_from_now.rotation.inverse().to_rotation_matrix().into_inner();
    let walk = |share: f64| walk_mps(share * strongest_mps, dt).powi(2);
    let changes = level_and_up(problem, step, walk(FAN_SHARE), walk(RISING_SHARE));
    let changes = changes.cholesky().and_then(|factor| factor.l().try_inverse());
    Carried::new(&beside(&by, &turned), &beside(&unmixed, &changes.expect("shares above zero")))
}

/// Two square matrices along the diagonal of one.
fn beside(first: &DMatrix<f64>, second: &Matrix3<f64>) -> DMatrix<f64> {
    let n = first.nrows();
    let mut both = first.clone().resize(n + 3, n + 3, 0.0);
    both.fixed_view_mut::<3, 3>(n, n).copy_from(second);
    both
}

/// By how much the wind far away changes from step to step, m/s, so that it is off by `spread_mps` in the long run.
fn walk_mps(spread_mps: f64, step_secs: f64) -> f64 {
    spread_mps * (2.0 * step_secs / OUTSIDE_LASTS_SECS).sqrt()
}

/// The matrix that is one number level with the ground and another one up and down, head axes.
fn level_and_up(problem: &Problem<'_>, step: usize, level: f64, rising: f64) -> Matrix3<f64> {
    let up = -(problem.clock.pose(step).rotation.inverse() * problem.gravity_world).normalize();
    Matrix3::from_diagonal_element(level) + up * up.transpose() * (rising - level)
}

/// What is known of the wind far away at every step before any lock is asked: the precision matrix of its value, which is
/// about [`fan_wind`].
///
/// A number that wanders by σ from step to step and is pulled back with a spread of s has a spread of √(σ s / 2) in the long
/// run, and forgets in s/σ steps: σ and s are chosen for [`OUTSIDE_LASTS_SECS`] and, level with the ground, where fans are turned and
/// take turns, [`FAN_SHARE`] of the fans' wind, up and down [`RISING_SHARE`] of it.
pub(crate) fn known_outside(problem: &Problem<'_>, fan_wind: &[FanWind]) -> Vec<Matrix3<f64>> {
    let strongest = strongest_mps(fan_wind);
    let dt = 1.0 / problem.clock.rate_hz;
    let precision = |share: f64| {
        let spread_mps = share * strongest;
        let pull_mps = 2.0 * spread_mps * spread_mps / walk_mps(spread_mps, dt);
        1.0 / (pull_mps * pull_mps)
    };
    (0..problem.clock.n_steps)
        .map(|step| {
            if is_still(problem, step) {
                return Matrix3::from_diagonal_element(1.0 / (DRAFT_MPS * DRAFT_MPS));
            }
            level_and_up(problem, step, precision(FAN_SHARE), precision(RISING_SHARE))
        })
        .collect()
}

/// The strongest wind that the fans make, m/s; where there is none, what may blow unnamed.
pub(crate) fn strongest_mps(fan_wind: &[FanWind]) -> f64 {
    let strongest = fan_wind.iter().map(|fans| fans.velocity.norm()).fold(0.0, f64::max);
    if strongest > 0.0 { strongest } else { UNNAMED_MPS }
}
