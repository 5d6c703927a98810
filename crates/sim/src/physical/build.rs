use super::batch::Batch;
use super::contact::{CONTACT_RATE, Touchable, limit_m};
use super::link::{Link, State};
use crate::parts::Count;
use crate::touchable::reached;
use nalgebra::UnitQuaternion;
use tousle_core::{HeadMotion, Vec3};
use tousle_lanes::{Lane, MOST_LANES, Turn, Vector};
use tousle_rod::{DragLaw, Lock, Rest, shortest_rotation, torque_to_load};

/// A strand ready to be put into a batch.
pub(super) type Prepared = crate::prepared::Prepared<Shape>;

/// How a strand is turned, bent and twisted at rest.
#[derive(Debug)]
pub(crate) struct Shape {
    /// Stick axes to head axes at rest: the first by the shortest turn from x, each next by the shortest turn on.
    pub turns: Vec<UnitQuaternion<f64>>,
    /// Stiffness times the natural turn of each joint, axes of the stick before, N·m.
    pub natural: Vec<Vec3>,
    /// By how many times joints were made stiffer to hold the style, at most; 1 if none was.
    pub stiffened: f64,
    /// The highest frequency at which the joints swing, rad/s; 0 unless the integrator is limited by it.
    pub stiffest: f64,
}

impl Shape {
    /// The frames of a strand at rest, and the natural turns that leave it in balance there.
    pub fn new(lock: &Lock, rest: &Rest, stiffened: f64) -> Self {
        let mut turns: Vec<UnitQuaternion<f64>> = Vec::with_capacity(lock.n_sticks());
        let mut natural = Vec::with_capacity(lock.n_sticks());
        let mut direction_before = Vec3::x();
        for (j, direction) in lock.rest_directions.iter().enumerate() {
            let before = turns.last().copied().unwrap_or_default();
            let turn = shortest_rotation(direction_before, *direction) * before;
            // The first stick's joint is straight at rest: it is clamped as it grows.
            let before = if j == 0 { turn } else { before };
            let bend = bend_of(before.inverse() * turn);
            let held = before.inverse() * rest.torques[j];
            natural.push(bend * lock.joint_stiffness[j] + torque_to_load(bend, held));
            turns.push(turn);
            direction_before = *direction;
        }
        Self { turns, natural, stiffened, stiffest: 0.0 }
    }
}

/// [`Turn::bend`] of one rotation.
fn bend_of(turn: UnitQuaternion<f64>) -> Vec3 {
    turn.imag() * (4.0 / (1.0 + turn.w))
}

/// Length of a stick without mass that follows a shorter strand's tip, m.
const LENGTH_BEYOND_M: f64 = 0.01;

/// Puts up to as many strands as there are lanes side by side.
pub(super) fn build<L: Lane>(strands: &[&Prepared], law: &DragLaw) -> Batch<L> {
    let of = |lane: usize| strands[lane.min(strands.len() - 1)];
    let n = strands.iter().map(|p| p.lock.n_sticks()).max().unwrap_or(0);
    let links: Vec<Link<L>> = (0..n)
        .map(|k| Link {
            length: per_stick(k, &of, |lock| lock.lengths_m[k], LENGTH_BEYOND_M),
            mass: per_stick(k, &of, |lock| lock.masses_kg[k], 0.0),
            stiffness: per_stick(k, &of, |lock| lock.joint_stiffness[k], 1e-6),
            damping_secs: per_stick(k, &of, |lock| lock.damping_secs, 0.0),
            natural: Vector::from_fn(|lane| of(lane).shape.natural.get(k).copied().unwrap_or_default()),
            drag: per_stick(
                k,
                &of,
                |lock| 0.5 * law.air_density * lock.widths_m[k] * lock.hair_lengths_m[k],
                0.0,
            ),
            viscous: per_stick(k, &of, |lock| viscous(law, lock.widths_m[k]), 0.0),
            rotary: per_stick(
                k,
                &of,
                |lock| lock.masses_kg[k] * lock.widths_m[k] * lock.widths_m[k] / 8.0,
                0.0,
            ),
        })
        .collect();
    let points_m: Vec<Vec<Vec3>> = strands.iter().map(|p| p.lock.rest_points()).collect();
    let point = |lane: usize, point: usize| {
        let own = &points_m[lane.min(strands.len() - 1)];
        own.get(point).copied().unwrap_or_else(|| {
            let beyond = (point + 1 - own.len()) as f64 * LENGTH_BEYOND_M;
            own[own.len() - 1] + *of(lane).lock.rest_directions.last().unwrap_or(&Vec3::x()) * beyond
        })
    };
    let state = |k: usize| state_at_rest(k, Vector::from_fn(|lane| point(lane, k + 1)), &of);
    let states: Vec<State<L>> = (0..n).map(state).collect();
    let touchable: Vec<_> = reached(strands).iter().map(|t| touchable(t.collider, n, &of)).collect();
    Batch {
        n_strands: strands.len(),
        root: Vector::from_fn(|lane| of(lane).lock.root_m),
        root_turn: turn_lanes(|lane| of(lane).shape.turns[0]),
        widths_m: (0..n).map(|k| per_stick(k, &of, |lock| lock.widths_m[k], 1e-3)).collect(),
        densities: (0..n).map(|k| per_stick(k, &of, |lock| lock.linear_densities_kg_per_m[k], 0.0)).collect(),
        links,
        states_before: states.clone(),
        states,
        touchable,
        contact_stiffness: L::from_fn(|lane| contact_stiffness(&of(lane).lock)),
        contact_give: L::from_fn(|lane| 1.0 / contact_stiffness(&of(lane).lock)),
        contraction2: L::one(),
        went_m: L::zero(),
        at_rest: true,
        n_moved: 0,
        asked: None,
        count: Count::default(),
    }
}

/// A number of a stick; `beyond` for those that follow a shorter strand's tip.
fn per_stick<'a, L: Lane>(
    stick: usize,
    of: &impl Fn(usize) -> &'a Prepared,
    value: impl Fn(&Lock) -> f64,
    beyond: f64,
) -> L {
    L::from_fn(|lane| {
        let lock = &of(lane).lock;
        if stick < lock.n_sticks() { value(lock) } else { beyond }
    })
}

/// [`Link::viscous`] of a width, m.
fn viscous(law: &DragLaw, width_m: f64) -> f64 {
    let cbrt = libm::cbrt(law.viscosity / width_m);
    10.0 * cbrt * cbrt
}

impl<L: Lane> Batch<L> {
    /// Strands at rest have the head's velocity at the start, as if they had come with it.
    pub fn go_along(&mut self, head: &HeadMotion) {
        for (state, before) in self.states.iter_mut().zip(&mut self.states_before) {
            state.velocity = Vector::from_fn(|lane| head.velocity_of(state.place.get(lane)));
            before.velocity = state.velocity;
        }
    }
}

/// Spring of a contact, N/m: [`CONTACT_RATE`] for the mean mass of the lock's points.
pub(super) fn contact_stiffness(lock: &Lock) -> f64 {
    lock.masses_kg.iter().sum::<f64>() / lock.n_sticks() as f64 * CONTACT_RATE * CONTACT_RATE
}

/// A stick at rest, by where its far end is.
fn state_at_rest<'a, L: Lane>(
    stick: usize,
    place: Vector<L>,
    of: &impl Fn(usize) -> &'a Prepared,
) -> State<L> {
    // Sticks beyond a strand's own tip go on straight.
    let turn_of = |p: &Prepared| p.shape.turns[stick.min(p.shape.turns.len() - 1)];
    let turn = turn_lanes(|lane| turn_of(of(lane)));
    let bend = Vector::from_fn(|lane| {
        let turns = &of(lane).shape.turns;
        if stick == 0 || stick >= turns.len() {
            Vec3::zeros()
        } else {
            bend_of(turns[stick - 1].inverse() * turns[stick])
        }
    });
    State { turn, place, velocity: Vector::zero(), bend }
}

fn turn_lanes<L: Lane>(of: impl Fn(usize) -> UnitQuaternion<f64>) -> Turn<L> {
    let v = Vector::from_fn(|lane| of(lane).imag());
    Turn { w: L::from_fn(|lane| of(lane).w), v }
}

fn touchable<'a, L: Lane>(collider: usize, n: usize, of: &impl Fn(usize) -> &'a Prepared) -> Touchable<L> {
    let (mut limits_m, mut pushes) = (vec![[f64::NEG_INFINITY; MOST_LANES]; n], vec![[0.0; MOST_LANES]; n]);
    let mut slips = vec![[Vec3::zeros(); MOST_LANES]; n];
    for lane in 0..L::N {
        let p = of(lane);
        let stiffness = contact_stiffness(&p.lock);
        for borne in p.rest.bearings.iter().filter(|borne| borne.collider == collider) {
            pushes[borne.stick][lane] = borne.force_n;
            slips[borne.stick][lane] = -borne.rub_n / stiffness;
        }
        if p.touchable.iter().any(|t| t.collider == collider) {
            let clearances_m = &p.rest.clearances_m[collider * p.lock.n_sticks()..][..p.lock.n_sticks()];
            for ((limits_m, pushes), clearance_m) in limits_m.iter_mut().zip(&pushes).zip(clearances_m) {
                limits_m[lane] = limit_m(*clearance_m, pushes[lane], stiffness);
            }
        }
    }
    let lanes = |numbers: &[f64; MOST_LANES]| L::from_fn(|lane| numbers[lane]);
    Touchable {
        collider,
        limits_m: limits_m.iter().map(lanes).collect(),
        pushes: pushes.iter().map(lanes).collect(),
        slips: slips.iter().map(|slips| Vector::from_fn(|lane| slips[lane])).collect(),
        is_borne: vec![true; n],
        seen: Vec::new(),
        idle_m: L::zero(),
        near: Vec::new(),
        bearings: Vec::new(),
    }
}
