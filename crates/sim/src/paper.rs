//! The method `paper`: the Hair Object Model, E1 and E2, one joint after another (`docs/equations.md`).
//!
//! A strand is a chain of sticks. The angles Φ of a stick are the two components of a rotation vector across it,
//! counted from where the joint before carries the stick's rest direction; each step starts a chart of its own
//! at the stick's present direction, so E(Φ) is exact and its pole a quarter turn away. Forces act on a joint
//! with everything further out; inertia and air resistance as if all that swung about the root together with
//! the joint's own stick. So every joint has an equation of its own, and the answer does not depend on the
//! number of sticks.

mod bending;
mod contact;
mod forces;
mod run;

pub(crate) use run::{Prepared, Ready};

use crate::Integrator;
use crate::joint::{JointEquation, JointStep};
use crate::plan::Terms;
use crate::timeline::StepScene;
use crate::touchable::Touchable;
use contact::Contacts;
use nalgebra::Matrix3;
use tousle_core::Vec3;
use tousle_rod::{DragLaw, Lock, Rest, turned};

/// What all strands of a run share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PaperModel {
    pub integrator: Integrator,
    pub terms: Terms,
    pub drag: DragLaw,
    pub friction: f64,
}

/// One strand in motion.
#[derive(Clone, Debug)]
pub(crate) struct PaperStrand {
    lock: Lock,
    /// τ Φ0: the torque each joint holds at rest, in the axes of the stick before, N·m.
    rest_torques: Vec<Vec3>,
    /// I1 of each joint, kg·m².
    inertias: Vec<f64>,
    /// What neighboring joints' springs can ask of each joint at most, N·m.
    bending_bounds: Vec<f64>,
    /// Direction of each stick, head axes, unit length.
    directions: Vec<Vec3>,
    /// Φ′ of each stick over the last step: its angular velocity, across it, rad/s.
    rates: Vec<Vec3>,
    contacts: Contacts,
    work: Work,
}

/// What one step writes and reads again; kept only to spare allocations.
#[derive(Clone, Debug)]
struct Work {
    /// The far end of each stick, head space, m, and its velocity in head space, m/s.
    ends_m: Vec<Vec3>,
    velocities: Vec<Vec3>,
    /// H: the force on each of these points, N.
    forces: Vec<Vec3>,
    /// What the air does to each stick.
    air: Vec<AirOnStick>,
    /// What each joint does to the stick that hangs on it, N·m.
    bending_torques: Vec<Vec3>,
    steps: Vec<JointStep>,
}

/// The air on one stick, shared out to its ends in halves.
#[derive(Clone, Copy, Debug)]
struct AirOnStick {
    /// The push, N.
    force: Vec3,
    /// How much stronger the push would be if the stick stood still, to first order, N.
    resisted: Vec3,
    /// The change of the push with the wind, N·s/m, and the most it can be in any direction.
    resistance: Matrix3<f64>,
    most: f64,
}

impl PaperStrand {
    /// A strand at rest in its rest curve.
    pub fn new(lock: Lock, rest: &Rest, touchable: &[Touchable]) -> Self {
        let n = lock.n_sticks();
        Self {
            rest_torques: rest.torques.clone(),
            inertias: inertias(&lock),
            bending_bounds: bending_bounds(&lock),
            directions: lock.rest_directions.clone(),
            rates: vec![Vec3::zeros(); n],
            contacts: Contacts::new(rest, touchable, n),
            work: Work::new(n),
            lock,
        }
    }

    /// The far end of every stick, head space, m.
    pub fn ends_m(&mut self) -> &[Vec3] {
        self.lock.place(&self.directions, &mut self.work.ends_m);
        &self.work.ends_m
    }

    /// One step of E1 for every joint.
    pub fn step(&mut self, model: &PaperModel, scene: &StepScene<'_>) {
        self.move_points();
        // E2: gravity, head movement, wind, collision; the spring along the strand is the sum in `solve_joints`.
        self.weigh(scene);
        if model.terms.blows() {
            self.blow(model, scene);
        }
        self.contacts.find(&self.work.ends_m, &self.work.velocities, scene);
        self.contacts.push(&mut self.work.forces);
        // E1: strength towards rest, then joint by joint; last what the body must push more than it did.
        self.bend();
        self.solve_joints(model, scene.dt_secs);
        let dt_secs = scene.dt_secs;
        self.contacts.resolve(
            &self.lock,
            &self.directions,
            &self.work.steps,
            &mut self.rates,
            model,
            dt_secs,
        );
        self.turn_sticks(dt_secs);
        self.contacts.keep_outside(&self.lock, &mut self.directions, scene);
    }

    fn move_points(&mut self) {
        self.lock.place(&self.directions, &mut self.work.ends_m);
        let mut velocity = Vec3::zeros();
        for (j, slot) in self.work.velocities.iter_mut().enumerate() {
            velocity += self.rates[j].cross(&self.directions[j]) * self.lock.lengths_m[j];
            *slot = velocity;
        }
    }

    /// S of E2 and E1: sums along the strand from the tip, and each joint's equation on the way.
    fn solve_joints(&mut self, model: &PaperModel, dt_secs: f64) {
        let lock = &self.lock;
        let work = &mut self.work;
        let mut pull = Vec3::zeros();
        let mut air = AirFurtherOut::default();
        let mut next_torque = Vec3::zeros();
        for j in (0..lock.n_sticks()).rev() {
            let (length, direction, rate) = (lock.lengths_m[j], self.directions[j], self.rates[j]);
            pull += work.forces[j];
            let mut torque = work.bending_torques[j] - next_torque;
            let mut joint = JointEquation {
                inertia: self.inertias[j],
                resistance: self.bending_bounds[j] * lock.damping_secs,
                strength: self.bending_bounds[j] + length * pull.norm(),
            };
            let mut lever = pull;
            if model.terms.air {
                air.gather(&work.air, lock, j);
                // The push holds the air's resistance to the strand's true motion; I2 has in its place that to a
                // swing of everything further out about the root.
                lever += air.resisted - air.resistance * rate.cross(&direction);
                joint.resistance += length * air.most;
                torque += rate * (length * air.most);
            }
            torque += direction.cross(&lever) * length + rate * (self.bending_bounds[j] * lock.damping_secs);
            torque -= direction * direction.dot(&torque);
            let step = JointStep::new(model.integrator, joint, dt_secs);
            self.rates[j] = step.rate(rate, torque);
            work.steps[j] = step;
            next_torque = work.bending_torques[j];
        }
    }

    fn turn_sticks(&mut self, dt_secs: f64) {
        for (direction, rate) in self.directions.iter_mut().zip(&mut self.rates) {
            *direction = turned(*direction, *rate * dt_secs).normalize();
            *rate -= *direction * direction.dot(rate);
        }
    }
}

/// The air on everything from a point outwards.
#[derive(Default)]
struct AirFurtherOut {
    resisted: Vec3,
    /// Σ resistance · s and Σ most · s, s the distance from the root along the strand, N·s.
    resistance: Matrix3<f64>,
    most: f64,
}

impl AirFurtherOut {
    /// Adds the point at the end of stick `j`: half of each stick that meets there.
    fn gather(&mut self, air: &[AirOnStick], lock: &Lock, j: usize) {
        let half_arc_m = 0.5 * lock.arcs_m[j];
        for stick in &air[j..(j + 2).min(air.len())] {
            self.resisted += stick.resisted * 0.5;
            self.resistance += stick.resistance * half_arc_m;
            self.most += stick.most * half_arc_m;
        }
    }
}

/// I1: a joint's stick and everything further out, as it swings about the root: l Σ m s, kg·m².
///
/// s, the distance from the root along the strand, stands for the distance in space. It makes the sum a
/// constant, and no smaller than any row of the chain's mass matrix, however the strand lies.
pub(crate) fn inertias(lock: &Lock) -> Vec<f64> {
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
pub(crate) fn bending_bounds(lock: &Lock) -> Vec<f64> {
    let stiffness = |j: usize| lock.joint_stiffness.get(j).copied().unwrap_or(0.0);
    (0..lock.n_sticks())
        .map(|j| {
            let before = if j > 0 { stiffness(j) } else { 0.0 };
            before + stiffness(j) + 2.0 * stiffness(j + 1)
        })
        .collect()
}

impl Work {
    fn new(n: usize) -> Self {
        let zeros = vec![Vec3::zeros(); n];
        let still = AirOnStick {
            force: Vec3::zeros(),
            resisted: Vec3::zeros(),
            resistance: Matrix3::zeros(),
            most: 0.0,
        };
        Self {
            ends_m: zeros.clone(),
            velocities: zeros.clone(),
            forces: zeros.clone(),
            air: vec![still; n],
            bending_torques: zeros,
            steps: vec![JointStep::default(); n],
        }
    }
}
