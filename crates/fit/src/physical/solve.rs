//! All locks, all times and the air together: Gauss and Newton's method.

use super::PhysicalOptions;
use super::constants::{Constants, ConstantsSaid, LikelyConstants, N_CONSTANTS};
use super::evidence::Station;
use super::lock::SeenLock;
use super::moments::{Balance, DragSlope};
use super::prior::{
    FanWind, LOG_LAYER, SLIP, SWIRL_SHARE, WAKE, carried, fan_wind, known_outside, strongest_mps, swirl_mps,
    wander,
};
use super::smoother::{Said, most_likely};
use super::statements::{StepSaid, ask};
use super::taught::{DefectAt, Defects, Scales, Taught};
use super::tracks::Clock;
use crate::FitError;
use nalgebra::{DVector, Matrix3};
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::BTreeSet;
use tousle_core::{HeadCapture, Pose, Progress, Session, Vec3};
use tousle_flow::{AirFlow, AirState, N_STREAM, Stream, SwirlKernel, SwirlModes};
use tousle_rod::{DragLaw, Rest, Style, Surface, rest_state};

/// What is to be explained.
pub(crate) struct Problem<'a> {
    pub(crate) locks: &'a [SeenLock],
    pub(crate) clock: &'a Clock,
    pub(crate) session: &'a Session,
    pub(crate) head: &'a HeadCapture,
    /// First and last frame in which nothing moves.
    pub(crate) still: Option<(usize, usize)>,
    pub(crate) rest_pose: Pose,
    pub(crate) gravity_world: Vec3,
    pub(crate) options: &'a PhysicalOptions,
    pub(crate) taught: &'a Taught,
}

impl Problem<'_> {
    /// What a lock is made of.
    pub(crate) fn scales(&self, lock: usize) -> Scales {
        self.taught.scales.get(self.locks[lock].strand_idx).copied().unwrap_or_default()
    }

    fn defect(&self, lock: usize, step: usize) -> Option<&DefectAt> {
        self.taught.defects.get(self.locks[lock].strand_idx)?.as_ref()?.at(step)
    }
}

/// The air that explains it, and what was found of the locks.
pub(crate) struct Solved {
    pub(crate) air: AirFlow,
    /// By lock: the share of steps at which the body bears it.
    pub(crate) touches: Vec<f64>,
    /// Mean square of what is left of the moments, each over its expected error.
    pub(crate) left_over: f64,
}

/// Distance of the points from which the modes are chosen, m.
const MODE_POINTS_M: f64 = 0.06;

/// How far around the hair swirls are told, m.
const MODE_REACH_M: f64 = 0.1;

/// Times that everything is made linear anew; the first from a guess. With five,
/// what another hairstyle makes of the wind changes by two thousandths.
const ROUNDS: usize = 3;

/// The same where air is known to start from.
const ROUNDS_FROM_KNOWN: usize = 2;

/// Wind on which a first guess is made linear, m/s.
const GUESS_MPS: f64 = 1.5;

/// Finds the air.
///
/// # Errors
/// [`FitError::NoSolution`] if what the locks say does not add up to a definite system.
pub(crate) fn solve(problem: &Problem<'_>, progress: &dyn Progress) -> Result<Solved, FitError> {
    let Problem { locks, clock, .. } = problem;
    let fan_wind = fan_wind(problem);
    let known = problem.taught.air.as_ref();
    let (mut air, rounds) = match known {
        Some(air) => (in_own_modes(problem, air).at_rate(clock.rate_hz, clock.n_steps), ROUNDS_FROM_KNOWN),
        None => (first_guess(problem, &fan_wind), ROUNDS),
    };
    let mut surroundings = Surroundings::new(problem);
    let outside = known_outside(problem, &fan_wind);
    let mut said = Vec::new();
    for round in 0..rounds {
        let slope =
            if round == 0 && known.is_none() { DragSlope::Secant(GUESS_MPS) } else { DragSlope::Tangent };
        said = ask(problem, &surroundings, &air, slope);
        let sureness = match rounds - 1 - round {
            0 if problem.options.says_how_sure => Sureness::OfAll,
            1 => Sureness::OfAir,
            _ => Sureness::Unasked,
        };
        for (said, (precision, fans)) in said.iter_mut().zip(outside.iter().zip(&fan_wind)) {
            said.of_air.add_outside(precision, fans.velocity);
        }
        surroundings.constants = step_states(problem, &fan_wind, &mut air, &mut said, sureness)
            .ok_or(FitError::NoSolution { round: round + 1, n_rounds: rounds })?;
        if round + 1 < rounds {
            if sureness == Sureness::OfAir {
                air.swirl_share = learnt_share(&air);
            }
            for state in &mut air.states {
                state.rescale(swirl_mps(state.outside(), air.swirl_share));
                state.covariance = None;
            }
        }
        progress.at(round as u64 + 1, rounds as u64);
    }
    let n_rows: usize = locks.iter().map(|seen| 2 * seen.lock.n_sticks()).sum();
    let left: f64 = said.iter().flat_map(|s| &s.of_locks).map(|of_lock| of_lock.square).sum();
    let touches =
        |lock: usize| said.iter().filter(|s| s.of_locks[lock].touches).count() as f64 / said.len() as f64;
    Ok(Solved {
        air,
        touches: (0..locks.len()).map(touches).collect(),
        left_over: left / (n_rows * clock.n_steps) as f64,
    })
}

/// What the balance leaves over of locks that move in a known air, by lock.
pub(crate) fn defects(problem: &Problem<'_>, air: &AirFlow) -> Vec<Defects> {
    let around = Surroundings::new(problem);
    let n_steps = problem.clock.n_steps;
    let air = &air.at_rate(problem.clock.rate_hz, n_steps);
    let of_step = |step: usize| -> Vec<DefectAt> {
        let (stations, now) = (around.stations_at(problem, &air.stream, step), air.now(step));
        let of_lock = |(lock, station): (usize, &Station)| {
            let left = station.left_over(&around.balance(problem, lock, step), air, &now);
            let seen = &problem.locks[lock];
            DefectAt::new(seen, step, &left.unwrap_or_else(|| DVector::zeros(2 * seen.lock.n_sticks())))
        };
        stations.iter().enumerate().map(of_lock).collect()
    };
    let steps: Vec<_> = (0..n_steps).into_par_iter().map(of_step).collect();
    let mut of_locks: Vec<Vec<DefectAt>> =
        problem.locks.iter().map(|_| Vec::with_capacity(n_steps)).collect();
    for step in steps {
        of_locks.iter_mut().zip(step).for_each(|(of_lock, at)| of_lock.push(at));
    }
    of_locks.into_iter().map(Defects::new).collect()
}

/// All that stays the same from round to round.
pub(crate) struct Surroundings {
    law: DragLaw,
    /// By lock; `None` without a still interval.
    rests: Vec<Option<Rest>>,
    /// By lock, what it is off by.
    constants: Vec<Constants>,
}

impl Surroundings {
    fn new(problem: &Problem<'_>) -> Self {
        let Problem { locks, session, rest_pose, .. } = problem;
        let gravity = rest_pose.rotation.inverse() * problem.gravity_world;
        let rods: Vec<_> = locks.iter().map(|seen| seen.lock.clone()).collect();
        // What a marker's lock is made of is only taken for likely: that does not tell how its natural shape falls.
        let style = Style::of(&rods, |_| false, gravity, &session.body);
        let rest = |seen: &SeenLock| {
            let likely = style.likely(&seen.lock, &session.body);
            problem.still.map(|_| rest_state(&seen.lock, gravity, &session.body, &likely))
        };
        Self {
            law: DragLaw::in_air(session.air_density),
            rests: locks.par_iter().map(rest).collect(),
            constants: vec![Constants::default(); locks.len()],
        }
    }

    /// The stations of all locks at a step.
    pub(crate) fn stations_at(&self, problem: &Problem<'_>, stream: &Stream, step: usize) -> Vec<Station> {
        let Problem { locks, clock, session, rest_pose, .. } = problem;
        let torso = session.body.head_from_torso(clock.pose(step), rest_pose);
        let surfaces = Surface::of_body(&session.body, &torso);
        let station = |lock: usize| Station::new(&self.balance(problem, lock, step), &surfaces, stream);
        (0..locks.len()).map(station).collect()
    }

    pub(crate) fn balance<'a>(&'a self, problem: &'a Problem<'_>, lock: usize, step: usize) -> Balance<'a> {
        Balance {
            seen: &problem.locks[lock],
            step,
            step_secs: 1.0 / problem.clock.rate_hz,
            rest: self.rests[lock].as_ref(),
            law: &self.law,
            scales: problem.scales(lock),
            constants: self.constants[lock],
            error_stiffness: if problem.options.stiffness_known {
                problem.scales(lock).stiffness
            } else {
                1.0
            },
            bend_error_rad: problem.options.bend_error_rad,
            defect: problem.defect(lock, step),
        }
    }
}

impl Said {
    /// Adds what is known of the wind far away: a value and its precision.
    fn add_outside(&mut self, precision: &Matrix3<f64>, value: Vec3) {
        let at = self.vector.len() - N_STREAM;
        for (r, c) in [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)] {
            self.information.add(at + r, at + c, precision[(r, c)]);
        }
        let mut rows = self.vector.fixed_rows_mut::<3>(at);
        rows += precision * value;
    }
}

/// How sure the values are that a round finds: what is asked of it beside them.
#[derive(Clone, Copy, PartialEq)]
enum Sureness {
    /// Nothing: only the next round wants the values.
    Unasked,
    /// Covariances of the air, as if what locks are off by were known: they tell how strong swirls are.
    OfAir,
    /// Covariances that count what locks are off by, too: those that are handed on.
    OfAll,
}

/// Moves the states to the most likely ones. Out: by lock, what it is off by; `None` if there is no most likely state.
fn step_states(
    problem: &Problem<'_>,
    fan_wind: &[FanWind],
    air: &mut AirFlow,
    said: &mut [StepSaid],
    sureness: Sureness,
) -> Option<Vec<Constants>> {
    let of_air: Vec<Said> = said.iter_mut().map(|s| core::mem::take(&mut s.of_air)).collect();
    let of_constants = said.iter_mut().map(|s| core::mem::take(&mut s.of_constants));
    let of_constants = problem.options.locks_differ.then(|| {
        let spread = (sureness == Sureness::OfAll).then_some(problem.taught.stiffness_spread);
        let likely = LikelyConstants { n_locks: problem.locks.len(), rest_seen: problem.still.is_some() };
        ConstantsSaid::together(of_constants, likely, spread)
    });
    let wander = wander(problem, air.modes.n_modes());
    let strongest_mps = strongest_mps(fan_wind);
    let carried = |step: usize| carried(problem, air, strongest_mps, step);
    let with_covariance = sureness != Sureness::Unasked;
    let (likely, constants) = most_likely(&wander, carried, of_air, of_constants, with_covariance)?;
    for (state, likely) in air.states.iter_mut().zip(likely) {
        state.move_to(likely.state);
        state.covariance = likely.covariance;
    }
    let constants = constants.unwrap_or_else(|| DVector::zeros(problem.locks.len() * N_CONSTANTS));
    let of_lock = |constants: &[f64]| core::array::from_fn(|i| constants[i]);
    Some(constants.as_slice().chunks_exact(N_CONSTANTS).map(of_lock).collect())
}

/// How strong swirls really are, over the stream: that for which coefficients, as far as the locks tell them, have variance 1
/// (D. J. C. `MacKay`, "Bayesian interpolation", *Neural Computation* 4, 1992).
fn learnt_share(air: &AirFlow) -> f64 {
    let mut square = 0.0;
    let mut told = 0.0;
    for state in &air.states {
        for i in 0..state.n_modes() {
            square += state.values[i] * state.values[i];
            let variance = state.covariance.as_ref().map_or(0.0, |covariance| covariance[(i, i)]);
            told += f64::max(1.0 - variance, 0.0);
        }
    }
    let times = if told > 1.0 { (square / told).sqrt() } else { 1.0 };
    air.swirl_share * times.clamp(0.3, 3.0)
}

/// The fans' wind, no swirls, and wake, layer and slip as they usually are.
fn first_guess(problem: &Problem<'_>, fan_wind: &[FanWind]) -> AirFlow {
    let stream = Stream::round(&problem.session.body);
    let modes = modes(problem, &stream);
    let n_modes = modes.n_modes();
    let n = n_modes + N_STREAM;
    let state = |fans: &FanWind| {
        let fan = fans.velocity;
        let mut values = DVector::zeros(n);
        values.rows_mut(n_modes, N_STREAM).copy_from_slice(&[
            fan.x,
            fan.y,
            fan.z,
            WAKE[0],
            LOG_LAYER[0],
            SLIP[0],
        ]);
        AirState {
            values,
            covariance: None,
            swirl_mps: swirl_mps(fan, SWIRL_SHARE),
            fans: fans.directions.clone(),
        }
    };
    let states = fan_wind.iter().map(state).collect();
    AirFlow { stream, modes, swirl_share: SWIRL_SHARE, rate_hz: problem.clock.rate_hz, states }
}

/// The shapes that swirls near the hair may have.
fn modes(problem: &Problem<'_>, stream: &Stream) -> SwirlModes {
    let kernel = SwirlKernel { length_m: problem.options.swirl_length_m };
    let points_m = mode_points(problem.locks, stream);
    SwirlModes::near(&points_m, kernel, problem.options.max_modes, MODE_REACH_M)
}

/// Known air in the modes that air which is not known would have.
fn in_own_modes<'a>(problem: &Problem<'_>, air: &'a AirFlow) -> Cow<'a, AirFlow> {
    let kernel = SwirlKernel { length_m: problem.options.swirl_length_m };
    let (points_m, max_modes) = (mode_points(problem.locks, &air.stream), problem.options.max_modes);
    if air.modes.are_near(&points_m, kernel, max_modes, MODE_REACH_M) {
        Cow::Borrowed(air)
    } else {
        Cow::Owned(air.in_modes(SwirlModes::near(&points_m, kernel, max_modes, MODE_REACH_M)))
    }
}

/// Where hair ever is, on a lattice, outside the head.
fn mode_points(locks: &[SeenLock], stream: &Stream) -> Vec<Vec3> {
    let cells: BTreeSet<[i64; 3]> = locks
        .iter()
        .flat_map(|seen| &seen.steps)
        .flat_map(|at| &at.points_m)
        .map(|p| [0, 1, 2].map(|axis| (p[axis] / MODE_POINTS_M).round() as i64))
        .collect();
    let points = cells.into_iter().map(|cell| Vec3::from(cell.map(|i| i as f64)) * MODE_POINTS_M);
    points.filter(|p| !stream.is_solid(*p)).collect()
}
