//! All locks, all times and the air together: Gauss and Newton's method.

use super::evidence::{Evidence, Places, Witness};
use super::lock::SeenLock;
use super::moments::{Balance, DragSlope, Scales, ScalesSaid};
use super::prior::{fan_wind, swirl_mps, wander};
use super::smoother::{Said, Wander, most_likely};
use super::tracks::Clock;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::collections::BTreeSet;
use tousle_core::{HeadCapture, Pose, Progress, Session, Vec3};
use tousle_flow::{AirFlow, AirState, N_STREAM, Stream, SwirlKernel, SwirlModes};
use tousle_rod::{DragLaw, Likely, Rest, Surface, Touch, Twist, rest_state};

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
    /// The most swirl modes.
    pub(crate) max_modes: usize,
}

/// The air that explains it, and what was found of the locks.
pub(crate) struct Solved {
    pub(crate) air: AirFlow,
    /// By lock.
    pub(crate) scales: Vec<Scales>,
    /// By lock: the share of steps at which the body bears it.
    pub(crate) touches: Vec<f64>,
    /// Mean square of what is left of the moments, each over its expected error.
    pub(crate) left_over: f64,
}

/// Half the way over which a swirl turns round, m: swirls near a head are some 10 to 20 cm across.
const SWIRL_LENGTH_M: f64 = 0.10;

/// Distance of the points from which the modes are chosen, m.
const MODE_POINTS_M: f64 = 0.06;

/// How far around the hair swirls are told, m.
const MODE_REACH_M: f64 = 0.1;

/// Of what a rest curve leaves open: as the simulator has it.
const STRAIGHTNESS: f64 = 0.5;

/// Times that everything is made linear anew; the first from a guess.
const ROUNDS: usize = 5;

/// Wind on which a first guess is made linear, m/s.
const GUESS_MPS: f64 = 1.5;

/// Finds the air.
pub(crate) fn solve(problem: &Problem<'_>, progress: &dyn Progress) -> Solved {
    let Problem { locks, clock, session, .. } = problem;
    let stream = Stream::round(&session.body);
    let kernel = SwirlKernel { length_m: SWIRL_LENGTH_M };
    let modes = SwirlModes::near(&mode_points(locks, &stream), kernel, problem.max_modes, MODE_REACH_M);
    let surroundings = Surroundings::new(problem, &stream);
    let fan_wind = fan_wind(problem);
    let wander = wander(problem, &fan_wind, modes.n_modes());
    let mut air = AirFlow { stream, states: first_guess(&wander, &fan_wind, modes.n_modes()), modes };
    let mut scales = vec![Scales::default(); locks.len()];
    let mut said = Vec::new();
    for round in 0..ROUNDS {
        let slope = if round == 0 { DragSlope::Secant(GUESS_MPS) } else { DragSlope::Tangent };
        said = (0..clock.n_steps)
            .into_par_iter()
            .map(|step| ask(problem, &surroundings, &air, &scales, step, slope))
            .collect();
        let is_last = round + 1 == ROUNDS;
        if round > 0 && !is_last {
            for (lock, scales) in scales.iter_mut().enumerate() {
                scales.update(said.iter().map(|s| &s.of_locks[lock].scales));
            }
        }
        step_states(&mut air.states, &wander, &mut said, is_last);
        progress.at(round as u64 + 1, ROUNDS as u64);
    }
    let n_rows: usize = locks.iter().map(|seen| 2 * seen.lock.n_sticks()).sum();
    let left: f64 = said.iter().flat_map(|s| &s.of_locks).map(|of_lock| of_lock.square).sum();
    let touches =
        |lock: usize| said.iter().filter(|s| s.of_locks[lock].touches).count() as f64 / said.len() as f64;
    Solved {
        air,
        scales,
        touches: (0..locks.len()).map(touches).collect(),
        left_over: left / (n_rows * clock.n_steps) as f64,
    }
}

/// All that stays the same from round to round.
struct Surroundings {
    law: DragLaw,
    /// By lock; `None` without a still interval.
    rests: Vec<Option<Rest>>,
    /// By step.
    surfaces: Vec<Vec<Surface>>,
    /// By step and lock.
    places: Vec<Vec<Places>>,
}

impl Surroundings {
    fn new(problem: &Problem<'_>, stream: &Stream) -> Self {
        let Problem { locks, clock, session, rest_pose, .. } = problem;
        let gravity = rest_pose.rotation.inverse() * problem.gravity_world;
        let rods: Vec<_> = locks.iter().map(|seen| seen.lock.clone()).collect();
        let by_rest = Touch::by_rest(&rods, &session.body);
        let rest = |seen: &SeenLock| {
            let likely = Likely {
                twist: Twist::Held,
                touch: by_rest.unwrap_or_else(|| Touch::by_width(&seen.lock)),
                friction: session.body.friction,
                straightness: STRAIGHTNESS,
            };
            problem.still.map(|_| rest_state(&seen.lock, gravity, &session.body, &likely))
        };
        let surfaces: Vec<Vec<Surface>> = (0..clock.n_steps)
            .map(|step| {
                let torso = session.body.head_from_torso(clock.pose(step), rest_pose);
                Surface::of_body(&session.body, &torso)
            })
            .collect();
        let of_step = |step: usize| {
            locks.iter().map(|seen| Places::new(seen, step, &surfaces[step], stream)).collect::<Vec<_>>()
        };
        let places = (0..clock.n_steps).into_par_iter().map(of_step).collect();
        Self {
            law: DragLaw::in_air(session.air_density),
            rests: locks.iter().map(rest).collect(),
            surfaces,
            places,
        }
    }
}

/// What all locks say at a step.
struct StepSaid {
    of_air: Said,
    of_locks: Vec<LockSaid>,
}

/// What a lock at a step says of itself.
#[derive(Default)]
struct LockSaid {
    square: f64,
    touches: bool,
    scales: ScalesSaid,
}

fn ask(
    problem: &Problem<'_>,
    around: &Surroundings,
    air: &AirFlow,
    scales: &[Scales],
    step: usize,
    slope: DragSlope,
) -> StepSaid {
    let state = &air.states[step];
    let n = state.values.len();
    let mut of_air = Said { information: DMatrix::zeros(n, n), vector: DVector::zeros(n) };
    let mut of_lock = |(lock, seen): (usize, &SeenLock)| {
        let witness = Witness {
            balance: Balance {
                seen,
                step,
                step_secs: 1.0 / problem.clock.rate_hz,
                rest: around.rests[lock].as_ref(),
                law: &around.law,
                scales: scales[lock],
            },
            surfaces: &around.surfaces[step],
            friction: problem.session.body.friction,
        };
        let Some(evidence) = witness.evidence(&around.places[step][lock], &air.modes, state, slope) else {
            return LockSaid::default();
        };
        add(&evidence, &state.values, &mut of_air);
        LockSaid {
            square: evidence.moments.norm_squared(),
            touches: evidence.n_pushing > 0,
            scales: ScalesSaid::new(&evidence.by_scales, &evidence.moments, evidence.weight),
        }
    };
    let of_locks = problem.locks.iter().enumerate().map(&mut of_lock).collect();
    StepSaid { of_air, of_locks }
}

/// Adds a lock's evidence, made linear at `values`, to what a step says.
fn add(evidence: &Evidence, values: &DVector<f64>, said: &mut Said) {
    let target = &evidence.by_state * values - &evidence.moments;
    said.vector += evidence.by_state.tr_mul(&target) * evidence.weight;
    said.information.gemm_tr(evidence.weight, &evidence.by_state, &evidence.by_state, 1.0);
}

/// Moves the states to the most likely ones; in the last round their covariances are kept.
fn step_states(states: &mut [AirState], wander: &Wander, said: &mut [StepSaid], is_last: bool) {
    let of_air: Vec<Said> = said.iter_mut().map(|s| core::mem::take(&mut s.of_air)).collect();
    let Some(likely) = most_likely(wander, &of_air, is_last) else { return };
    for (state, values) in states.iter_mut().zip(likely.states) {
        state.values = values;
        state.tame();
        if !is_last {
            state.rescale(swirl_mps(state.outside()));
        }
    }
    for (state, covariance) in states.iter_mut().zip(likely.covariances) {
        state.covariance = covariance;
    }
}

/// The fans' wind, no swirls, and wake and layer as they usually are.
fn first_guess(wander: &Wander, fan_wind: &[Vec3], n_modes: usize) -> Vec<AirState> {
    let state = |fan: &Vec3| {
        let mut values = wander.mean.clone();
        values.fixed_rows_mut::<3>(n_modes).copy_from(fan);
        let n = n_modes + N_STREAM;
        AirState { values, covariance: DMatrix::zeros(n, n), swirl_mps: swirl_mps(*fan) }
    };
    fan_wind.iter().map(state).collect()
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
