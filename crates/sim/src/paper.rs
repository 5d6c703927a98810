//! The method `paper`: the Hair Object Model, E1 and E2, one joint after another (`docs/equations.md`).
//!
//! A strand is a chain of sticks. The angles Φ of a stick are the two components of a rotation vector across it,
//! counted from where the joint before carries the stick's rest direction; each step starts a chart of its own
//! at the stick's present direction, so E(Φ) is exact and its pole a quarter turn away. Forces act on a joint
//! with everything further out; inertia and air resistance as if all that swung about the root together with
//! the joint's own stick. So every joint has an equation of its own, and the answer does not depend on the
//! number of sticks.
//!
//! As many strands as fit a register are stepped side by side ([`crate::lane`]).

mod bending;
mod build;
mod contact;
mod forces;
mod mechanics;
mod stability;

use crate::Integrator;
use crate::extent::Extent;
use crate::joint::{JointEquation, JointStep};
use crate::plan::Terms;
use crate::timeline::StepScene;
use contact::Contacts;
use tousle_lanes::{Lane, Symmetric, Vector, cos_and_sine_share};
use tousle_rod::{DragLaw, Lock, turned};

/// What all strands of a run share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Paper {
    integrator: Integrator,
    terms: Terms,
    friction: f64,
    law: DragLaw,
}

/// Strands that are stepped together, one a lane.
#[derive(Clone, Debug)]
pub(crate) struct Batch<L> {
    /// Where they grow, head space, m.
    root: Vector<L>,
    /// Internal damping over stiffness, s.
    damping_secs: L,
    sticks: Vec<Stick<L>>,
    motions: Vec<Motion<L>>,
    contacts: Contacts<L>,
    /// The strands that are read, and the steps that they have taken.
    n_strands: u64,
    n_steps: u64,
    /// Where the strands asked the field, if that is to be known.
    asked: Option<Extent<L>>,
}

/// A stick, the joint at its near end and the point at its far end: what never changes.
#[derive(Clone, Copy, Debug)]
struct Stick<L> {
    /// Length, m, and that of the hair on it.
    length: L,
    hair_length: L,
    /// Half the distance of the point from the root, along the sticks, m.
    half_arc: L,
    /// Mass of the point, kg.
    mass: L,
    /// One over I1, 1/(kg·m²).
    per_inertia: L,
    /// Stiffness of the joint, N·m, and what neighboring joints' springs can ask of it at most.
    stiffness: L,
    bending_bound: L,
    /// ½ ρ width, kg/m²: drag across over speed squared, for each length of hair, but for the coefficient.
    drag: L,
    /// 10 (ν / width)^⅔, (m/s)^⅔: how much stronger drag is at low speeds.
    viscous: L,
    /// Mass per length of hair, kg/m.
    density: L,
    /// Direction at rest, head axes, unit length.
    rest_direction: Vector<L>,
    /// τ Φ0: the torque the joint holds at rest, in the axes of the stick before, N·m.
    rest_torque: Vector<L>,
}

/// Where a stick points, and how it turns.
#[derive(Clone, Copy, Debug)]
struct Motion<L> {
    /// Head axes, unit length.
    direction: Vector<L>,
    /// Φ′ over the last step: its angular velocity, across it, rad/s.
    rate: Vector<L>,
}

/// What one step writes and reads again.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Work<L> {
    /// The far end, head space, m, and its velocity in head space, m/s.
    end: Vector<L>,
    velocity: Vector<L>,
    /// The field's vector at the stick's middle.
    wind: Vector<L>,
    /// H: the force on the far end, N.
    force: Vector<L>,
    air: AirOnStick<L>,
    /// What the joint does to the stick, N·m.
    bending_torque: Vector<L>,
    step: JointStep<L>,
}

/// The air on one stick, shared out to its ends in halves.
#[derive(Clone, Copy, Debug)]
struct AirOnStick<L> {
    /// How much stronger the push would be if the stick stood still, to first order, N.
    resisted: Vector<L>,
    /// The change of the push with the wind, N·s/m, and the most it can be in any direction.
    resistance: Symmetric<L>,
    most: L,
}

/// A step, compiled for the widest registers of the machine it runs on.
struct Step<'a, 'b, L> {
    batch: &'a mut Batch<L>,
    work: &'a mut Vec<Work<L>>,
    model: &'a Paper,
    scene: &'a StepScene<'b>,
}

impl<L: Lane> pulp::NullaryFnOnce for Step<'_, '_, L> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.batch.step_here(self.work, self.model, self.scene);
    }
}

impl<L: Lane> Batch<L> {
    /// One step of E1 for every joint. `work` is room for it.
    fn step(&mut self, work: &mut Vec<Work<L>>, model: &Paper, scene: &StepScene<'_>) {
        L::dispatch(Step { batch: self, work, model, scene });
    }

    #[inline(always)]
    fn step_here(&mut self, work: &mut Vec<Work<L>>, model: &Paper, scene: &StepScene<'_>) {
        work.resize(self.sticks.len(), Work::new());
        self.n_steps += 1;
        self.move_points(work);
        // E2: gravity, head movement, wind, collision; the spring along the strand is the sum in `solve_joints`.
        self.weigh(work, scene);
        if model.terms.blows() {
            self.blow(work, model, scene);
        }
        self.contacts.find(work, scene);
        self.contacts.push(work);
        // E1: strength towards rest, then joint by joint; last what the body must push more than it did.
        self.bend(work);
        self.solve_joints(work, model, scene.dt_secs);
        self.contacts.resolve(&self.sticks, &mut self.motions, work, model.friction, scene.dt_secs);
        self.turn_sticks(scene.dt_secs);
        self.contacts.keep_outside(self.root, &self.sticks, &mut self.motions, scene);
    }

    #[inline(always)]
    fn move_points(&self, work: &mut [Work<L>]) {
        let (mut end, mut velocity) = (self.root, Vector::none(self.damping_secs));
        for ((stick, motion), work) in self.sticks.iter().zip(&self.motions).zip(work) {
            end = motion.direction.mul_add(stick.length, end);
            velocity = motion.rate.cross(motion.direction).mul_add(stick.length, velocity);
            work.end = end;
            work.velocity = velocity;
        }
    }

    /// S of E2 and E1: sums along the strand from the tip, and each joint's equation on the way.
    #[inline(always)]
    fn solve_joints(&mut self, work: &mut [Work<L>], model: &Paper, dt_secs: f64) {
        let mut pull = Vector::none(self.damping_secs);
        let mut air = AirFurtherOut::nothing(self.damping_secs);
        let mut next_torque = Vector::none(self.damping_secs);
        for j in (0..work.len()).rev() {
            let (stick, Motion { direction, rate }) = (&self.sticks[j], self.motions[j]);
            pull += work[j].force;
            let mut torque = work[j].bending_torque - next_torque;
            let mut resistance = stick.bending_bound * self.damping_secs;
            let mut lever = pull;
            if model.terms.air {
                air.gather(work, stick.half_arc, j);
                // The push holds the air's resistance to the strand's true motion; I2 has in its place that to a
                // swing of everything further out about the root.
                lever += air.resisted - air.resistance.mul_vector(rate.cross(direction));
                resistance = stick.length.mul_add(air.most, resistance);
            }
            torque += direction.cross(lever).mul_add(stick.length, rate * resistance);
            torque = torque.across(direction);
            let strength = stick.length.mul_add(pull.norm_squared().sqrt(), stick.bending_bound);
            let joint = JointEquation { per_inertia: stick.per_inertia, resistance, strength };
            let step = JointStep::new(model.integrator, joint, dt_secs);
            self.motions[j].rate = step.rate(rate, torque);
            work[j].step = step;
            next_torque = work[j].bending_torque;
        }
    }

    #[inline(always)]
    fn turn_sticks(&mut self, dt_secs: f64) {
        let dt = self.damping_secs.same(dt_secs);
        for Motion { direction, rate } in &mut self.motions {
            // Rodrigues' formula; the turn is at right angles to the stick, but for rounding errors.
            let turn = *rate * dt;
            let angle2 = turn.norm_squared();
            let (cos, sine_share) = cos_and_sine_share(angle2.min(self.damping_secs.same(1.0)));
            let mut to = direction.mul_add(cos, turn.cross(*direction) * sine_share);
            if angle2.any_above(self.damping_secs.same(1.0)) {
                let far = |lane: usize| turned(direction.get(lane), turn.get(lane));
                to = Vector::where_above(angle2, self.damping_secs.same(1.0), Vector::from_fn(far), to);
            }
            *direction = to.normalized_again();
            *rate = rate.across(*direction);
        }
    }

    /// Shows the far end of every stick, from the root, head space, m.
    #[inline(always)]
    fn show_ends_m(&self, mut show: impl FnMut(usize, Vector<L>)) {
        let mut end = self.root;
        for (k, (stick, motion)) in self.sticks.iter().zip(&self.motions).enumerate() {
            end = motion.direction.mul_add(stick.length, end);
            show(k, end);
        }
    }
}

/// The air on everything from a point outwards.
struct AirFurtherOut<L> {
    resisted: Vector<L>,
    /// Σ resistance · s and Σ most · s, s the distance from the root along the strand, N·s.
    resistance: Symmetric<L>,
    most: L,
}

impl<L: Lane> AirFurtherOut<L> {
    fn nothing(like: L) -> Self {
        Self { resisted: Vector::none(like), resistance: Symmetric::none(like), most: like.same(0.0) }
    }

    /// Adds the point at the end of stick `j`: half of each stick that meets there.
    #[inline(always)]
    fn gather(&mut self, work: &[Work<L>], half_arc: L, j: usize) {
        for work in &work[j..(j + 2).min(work.len())] {
            self.resisted = work.air.resisted.mul_add(half_arc.same(0.5), self.resisted);
            self.resistance.add_scaled(&work.air.resistance, half_arc);
            self.most = work.air.most.mul_add(half_arc, self.most);
        }
    }
}

/// I1: a joint's stick and everything further out, as it swings about the root: l Σ m s, kg·m².
///
/// s, the distance from the root along the strand, stands for the distance in space. It makes the sum a
/// constant, and no smaller than any row of the chain's mass matrix, however the strand lies.
fn inertias(lock: &Lock) -> Vec<f64> {
    let mut further_out = 0.0;
    let mut inertias = vec![0.0; lock.n_sticks()];
    for j in (0..lock.n_sticks()).rev() {
        further_out += lock.masses_kg[j] * lock.arcs_m[j];
        inertias[j] = lock.lengths_m[j] * further_out;
    }
    inertias
}

/// τ as far as it keeps joints stable that are solved one by one: the sum of the absolute values of a joint's row
/// of the chain's stiffness (Gershgorin), N·m. Nothing that its neighbors do can ask for more.
fn bending_bounds(lock: &Lock) -> Vec<f64> {
    let stiffness = |j: usize| lock.joint_stiffness.get(j).copied().unwrap_or(0.0);
    (0..lock.n_sticks())
        .map(|j| {
            let before = if j > 0 { stiffness(j) } else { 0.0 };
            before + stiffness(j) + 2.0 * stiffness(j + 1)
        })
        .collect()
}

impl<L: Lane> Work<L> {
    fn new() -> Self {
        let (o, zero) = (Vector::zero(), L::zero());
        Self {
            end: o,
            velocity: o,
            wind: o,
            force: o,
            air: AirOnStick { resisted: o, resistance: Symmetric::zero(), most: zero },
            bending_torque: o,
            step: JointStep { rate_per_rate: zero, rate_per_torque: zero },
        }
    }
}
