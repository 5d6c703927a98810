//! What is known of the air before any lock is asked.

use super::smoother::Wander;
use super::solve::Problem;
use crate::outside_direction;
use nalgebra::DVector;
use tousle_core::Vec3;
use tousle_flow::N_STREAM;

/// Time in which swirls are made anew, s: 10 cm across at half a meter a second.
const SWIRL_LASTS_SECS: f64 = 0.2;

/// Strength of swirls over the stream's: what a wind between walls carries, and what a simple wake and layer leave out.
const SWIRL_SHARE: f64 = 0.25;

/// The least strength of swirls, m/s, so that air that stands still far away may move near the head.
const LEAST_SWIRL_MPS: f64 = 0.05;

/// How far the wind may be from the fans' setting, as a share of it: gusts, and fans that are set by eye.
const FAN_SHARE: f64 = 0.5;

/// Time in which the wind far away may change as far, s.
const OUTSIDE_LASTS_SECS: f64 = 0.6;

/// Wind that may blow where no fan is named, m/s.
const UNNAMED_MPS: f64 = 3.0;

/// Draft in a room before the fans are on, m/s.
const DRAFT_MPS: f64 = 0.05;

/// Wake and layer: mean, standard deviation, and how long they stay, s.
const WAKE: [f64; 3] = [0.6, 0.3, 1.0];
const LOG_LAYER: [f64; 3] = [-4.4, 0.7, 2.0];

/// How strong swirls are in a stream, m/s.
pub(crate) fn swirl_mps(outside: Vec3) -> f64 {
    f64::max(SWIRL_SHARE * outside.norm(), LEAST_SWIRL_MPS)
}

/// Wind from the fans at every step, head axes, m/s; zero before they are on.
pub(crate) fn fan_wind(problem: &Problem<'_>) -> Vec<Vec3> {
    let Problem { session, head, clock, rest_pose, .. } = problem;
    let speed: Vec3 = session.fans.iter().map(|f| f.blows_towards_head() * f.speed_mps).sum();
    let start_secs =
        session.wind_start_frame.map_or(f64::NEG_INFINITY, |f| (f - head.first_frame) as f64 / head.rate_hz);
    (0..clock.n_steps)
        .map(|k| {
            let time_secs = clock.time_secs(k);
            if time_secs < start_secs || is_still(problem, k) {
                return Vec3::zeros();
            }
            outside_direction(session, head, rest_pose, clock.pose(k), time_secs) * speed.norm()
        })
        .collect()
}

/// Whether nothing moves at a step.
pub(crate) fn is_still(problem: &Problem<'_>, step: usize) -> bool {
    let frame = problem.clock.frame(step);
    problem.still.is_some_and(|(first, last)| (first..=last).contains(&frame))
}

/// The state's prior: swirls about nothing, the wind far away about the fans', wake and layer about what is usual.
pub(crate) fn wander(problem: &Problem<'_>, fan_wind: &[Vec3], n_modes: usize) -> Wander {
    let n = n_modes + N_STREAM;
    let dt = 1.0 / problem.clock.rate_hz;
    let keep = |lasts_secs: f64| libm::exp(-dt / lasts_secs);
    let mut keeps = DVector::from_element(n, keep(SWIRL_LASTS_SECS));
    let mut mean = DVector::zeros(n);
    let mut sd = DVector::from_element(n, 1.0);
    for (i, [value, spread, lasts]) in [WAKE, LOG_LAYER].iter().enumerate() {
        let at = n_modes + 3 + i;
        (keeps[at], mean[at], sd[at]) = (keep(*lasts), *value, *spread);
    }
    let strongest = fan_wind.iter().map(Vec3::norm).fold(0.0, f64::max);
    let outside_sd = if strongest > 0.0 { FAN_SHARE * strongest } else { UNNAMED_MPS };
    let mut fresh = DVector::from_fn(n, |i, _| 1.0 / (sd[i] * sd[i] * (1.0 - keeps[i] * keeps[i])));
    for c in 0..3 {
        let wander = outside_sd * (2.0 * dt / OUTSIDE_LASTS_SECS).sqrt();
        keeps[n_modes + c] = 1.0;
        fresh[n_modes + c] = 1.0 / (wander * wander);
    }
    let mut known = Vec::new();
    let mut sure = Vec::new();
    for (k, fan) in fan_wind.iter().enumerate() {
        let mut value = mean.clone();
        let mut precision = DVector::zeros(n);
        if k == 0 {
            precision = sd.map(|s: f64| 1.0 / (s * s));
        }
        let spread = if is_still(problem, k) {
            DRAFT_MPS
        } else {
            outside_sd * (2.0 * OUTSIDE_LASTS_SECS / dt).sqrt()
        };
        for c in 0..3 {
            value[n_modes + c] = fan[c];
            precision[n_modes + c] = 1.0 / (spread * spread);
        }
        known.push(value);
        sure.push(precision);
    }
    Wander { keeps, fresh, mean, known, sure }
}
