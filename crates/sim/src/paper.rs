//! The method `paper`: the Hair Object Model, E1 and E2, one joint after another (`docs/equations.md`).
//!
//! A strand is a chain of sticks. The angles Φ of a stick are the two components of a rotation vector across it,
//! counted from where the joint before carries the stick's rest direction; each step starts a chart of its own
//! at the stick's present direction, so E(Φ) is exact and its pole a quarter turn away. What is further out acts
//! on a joint as if it swung with the joint's stick about the root. That makes every joint an equation of its
//! own, whose inertia, resistance and strength are sums along the strand, and the answer independent of the
//! number of sticks.

mod bending;
mod contact;
mod forces;

pub(crate) use contact::Touchable;

use crate::Integrator;
use crate::joint::{JointEquation, JointStep};
use crate::plan::Terms;
use crate::timeline::StepScene;
use contact::Contacts;
use nalgebra::UnitQuaternion;
use tousle_core::Vec3;
use tousle_rod::{DragLaw, Lock, Rest, turned};

/// One strand in motion.
#[derive(Debug)]
pub(crate) struct PaperStrand {
    lock: Lock,
    /// Torque each joint holds at rest, in the axes of the stick before, N·m.
    rest_torques: Vec<Vec3>,
    /// I1 of each joint, kg·m².
    inertias: Vec<f64>,
    /// Direction of each stick, head axes, unit length.
    directions: Vec<Vec3>,
    /// Φ′ of each stick: its angular velocity, across it, rad/s.
    rates: Vec<Vec3>,
    contacts: Contacts,
    work: Work,
}

/// What one step writes and reads again; kept only to spare allocations.
#[derive(Debug)]
struct Work {
    /// The far end of each stick, head space, m, and its velocity in head space, m/s.
    ends_m: Vec<Vec3>,
    velocities: Vec<Vec3>,
    /// Force on each of these points, N: all of H.
    forces: Vec<Vec3>,
    /// Resistance of the air to a slow motion of each point, N·s/m, and the force it makes now, N.
    air_resistances: Vec<f64>,
    air_forces: Vec<Vec3>,
    /// What each joint does to the stick that hangs on it, N·m.
    bending_torques: Vec<Vec3>,
    /// Rotation of each stick since rest, carried along the strand without twist.
    carried: Vec<UnitQuaternion<f64>>,
    steps: Vec<JointStep>,
}

/// What all strands of a run share.
#[derive(Debug)]
pub(crate) struct PaperModel {
    pub integrator: Integrator,
    pub terms: Terms,
    pub drag: DragLaw,
}

impl PaperStrand {
    /// A strand at rest in its rest curve.
    pub fn new(lock: Lock, rest: &Rest, touchable: &[Touchable]) -> Self {
        let n = lock.n_sticks();
        Self {
            rest_torques: rest.torques.clone(),
            inertias: inertias(&lock),
            directions: lock.rest_directions.clone(),
            rates: vec![Vec3::zeros(); n],
            contacts: Contacts::new(rest, touchable, n),
            work: Work::new(n),
            lock,
        }
    }

    /// The far end of every stick, head space, m.
    pub fn place(&self, ends_m: &mut [Vec3]) {
        self.lock.place(&self.directions, ends_m);
    }

    /// One step of E1 for every joint.
    pub fn step(&mut self, model: &PaperModel, scene: &StepScene<'_>) {
        self.move_points();
        // H: gravity, head movement, wind, collision; then what the joints' own springs add.
        self.weigh(model, scene);
        self.blow(model, scene);
        self.contacts.find(&self.work.ends_m, &self.work.velocities, scene);
        self.contacts.push(&mut self.work.forces);
        self.bend();
        // E1, joint by joint; then what the body must push more, and the new angles.
        self.solve_joints(model, scene.dt_secs);
        self.contacts.resolve(&self.lock, &self.directions, &self.work.steps, &mut self.rates, scene);
        self.turn_sticks(scene.dt_secs);
        self.contacts.keep_outside(&self.lock, &mut self.directions, scene);
    }

    fn move_points(&mut self) {
        self.lock.place(&self.directions, &mut self.work.ends_m);
        let mut velocity = Vec3::zeros();
        for j in 0..self.lock.n_sticks() {
            velocity += self.rates[j].cross(&self.directions[j]) * self.lock.lengths_m[j];
            self.work.velocities[j] = velocity;
        }
    }

    /// Sums along the strand from the tip, and the equation of each joint on the way.
    fn solve_joints(&mut self, model: &PaperModel, dt_secs: f64) {
        let lock = &self.lock;
        let work = &mut self.work;
        let mut pull = Vec3::zeros();
        let mut air_pull = Vec3::zeros();
        let mut air_resistance = 0.0;
        let mut next_torque = Vec3::zeros();
        let mut next_stiffness = 0.0;
        for j in (0..lock.n_sticks()).rev() {
            let (length, direction, rate) = (lock.lengths_m[j], self.directions[j], self.rates[j]);
            let stiffness = lock.joint_stiffness[j];
            pull += work.forces[j];
            air_pull += work.air_forces[j];
            air_resistance += work.air_resistances[j] * lock.arcs_m[j];
            // The air's resistance to the strand's whole motion is in `pull`; E1 has the joint's own in its place.
            let own_resistance = length * air_resistance;
            let lever = direction.cross(&(pull + air_pull)) * length;
            let torque = lever + work.bending_torques[j] - next_torque;
            let torque = torque - direction * direction.dot(&torque);
            // No neighbor's angle can ask for more of a joint than its own coefficient gives: the sums of the
            // absolute values of a row (Gershgorin) keep the joints stable although each is solved alone.
            let bending = stiffness + next_stiffness + next_stiffness + if j > 0 { stiffness } else { 0.0 };
            let damping = rate * (bending * lock.damping_secs);
            let equation = JointEquation {
                inertia: self.inertias[j],
                resistance: own_resistance + bending * lock.damping_secs,
                strength: bending + length * pull.norm(),
            };
            let step = JointStep::new(model.integrator, equation, dt_secs);
            self.rates[j] = step.rate(rate, torque + damping);
            work.steps[j] = step;
            next_torque = work.bending_torques[j];
            next_stiffness = stiffness;
        }
    }

    fn turn_sticks(&mut self, dt_secs: f64) {
        for j in 0..self.lock.n_sticks() {
            let direction = turned(self.directions[j], self.rates[j] * dt_secs).normalize();
            self.directions[j] = direction;
            let rate = self.rates[j];
            self.rates[j] = rate - direction * direction.dot(&rate);
        }
    }
}

/// I1: a joint's stick and everything further out, as it swings about the root: l Σ m s, kg·m².
///
/// s, the distance from the root along the strand, stands for the distance in space. It is what makes the sum a
/// constant, and at least as large as every row of the chain's mass matrix, however the strand lies.
fn inertias(lock: &Lock) -> Vec<f64> {
    let mut further_out = 0.0;
    let mut inertias = vec![0.0; lock.n_sticks()];
    for j in (0..lock.n_sticks()).rev() {
        further_out += lock.masses_kg[j] * lock.arcs_m[j];
        inertias[j] = lock.lengths_m[j] * further_out;
    }
    inertias
}

impl Work {
    fn new(n: usize) -> Self {
        let zeros = vec![Vec3::zeros(); n];
        Self {
            ends_m: zeros.clone(),
            velocities: zeros.clone(),
            forces: zeros.clone(),
            air_resistances: vec![0.0; n],
            air_forces: zeros.clone(),
            bending_torques: zeros,
            carried: vec![UnitQuaternion::identity(); n],
            steps: vec![JointStep::default(); n],
        }
    }
}
