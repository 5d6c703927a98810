//! One iteration of Newton's method: forces and their derivatives at the present guess, a sweep inwards that
//! eliminates every stick's turn, a sweep outwards that applies them.
//!
//! To the stick before, everything from a joint outwards is a quadratic form of the near end's displacement and that
//! stick's own turn: a 6 × 6 matrix in three blocks. So one sweep solves all joints, as Featherstone's articulated
//! bodies do ("The calculation of robot dynamics using articulated-body inertias", 1983), with the joints' stiffness,
//! the air and the surfaces at the step's end in it.

use super::batch::{Batch, Model};
use super::contact::Firmness;
use super::drag::push;
use super::link::{Link, Work};
use super::scene::Now;
use crate::lane::{Lane, Matrix, Symmetric, Turn, Vector};

/// How velocity hangs on place at a step's end: velocity = (place − from) / h.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weights<L> {
    pub dt: L,
    pub h: L,
    pub per_h: L,
    pub per_h2: L,
}

impl<L: Lane> Weights<L> {
    pub fn new(dt_secs: f64, h_secs: f64) -> Self {
        let per_h = 1.0 / h_secs;
        Self {
            dt: L::splat(dt_secs),
            h: L::splat(h_secs),
            per_h: L::splat(per_h),
            per_h2: L::splat(per_h * per_h),
        }
    }
}

/// Directions and places of sticks from their turns.
#[inline(always)]
pub(super) fn place_sticks<L: Lane>(root: Vector<L>, links: &[Link<L>], work: &mut [Work<L>]) {
    let mut end = root;
    for (link, work) in links.iter().zip(work) {
        work.direction = work.turn.x_axis();
        end = work.direction.mul_add(link.length, end);
        work.place = end;
    }
}

/// What bends and twists each joint: gradient and (Gauss-Newton) second derivative of its potential.
#[inline(always)]
pub(super) fn bend_joints<L: Lane>(root_turn: Turn<L>, work: &mut [Work<L>]) {
    let mut before = root_turn;
    let two = L::splat(2.0);
    for work in work {
        let bend = before.inverse().after(work.turn).bend();
        let sigma = bend * L::splat(0.25);
        let sigma2 = sigma.norm_squared();
        let load = bend.mul_add(work.stiffness, -work.natural);
        // For a turn ε of the stick, in the axes of the stick before, d bend = (1 − σ²) ε − 2 σ × ε + 2 σ (σ·ε): a
        // rotation times 1 + σ², so that the second derivative is the same in all directions.
        let torque =
            load.mul_add(L::one() - sigma2, sigma.cross(load).mul_add(two, sigma * (sigma.dot(load) * two)));
        work.torque = before.rotate(torque);
        let scale = L::one() + sigma2;
        work.curvature = work.stiffness * scale * scale;
        before = work.turn;
    }
}

impl<L: Lane> Batch<L> {
    /// Inertia, weight, air and surfaces at each point.
    #[inline(always)]
    pub(super) fn load_points(
        &self,
        work: &mut [Work<L>],
        model: &Model,
        now: &Now<'_>,
        weights: &Weights<L>,
    ) {
        let gravity = Vector::splat(now.gravity);
        for (link, work) in self.links.iter().zip(&mut *work) {
            let inertia = link.mass * weights.per_h2;
            work.slope = (work.place - work.drifting).mul_add(inertia, -(gravity * link.mass));
            work.hessian = Symmetric::scaled_identity(inertia);
        }
        if model.air {
            self.blow(work, model, now, weights);
        } else if model.pushes {
            for (link, work) in self.links.iter().zip(&mut *work) {
                work.slope -= work.wind * link.mass;
            }
        }
        for touchable in &self.touchable {
            for near in &touchable.near {
                let work = &mut work[near.stick];
                work.slope += near.bearing.slope;
                work.hessian.add(&near.bearing.hessian);
            }
        }
    }

    /// What surfaces do to the points where they are; [`Touchable::feel`] of all.
    #[inline(always)]
    pub(super) fn feel_contacts(
        &mut self,
        work: &[Work<L>],
        model: &Model,
        now: &Now<'_>,
        weights: &Weights<L>,
    ) -> L {
        let firmness = self.firmness(weights);
        let mut off2 = L::zero();
        for touchable in &mut self.touchable {
            let surface = &now.surfaces[touchable.collider];
            let at = |stick: usize| {
                let work = &work[stick];
                (work.place, (work.place - work.from) * weights.per_h)
            };
            off2 = off2.max(touchable.feel(model, surface, at, firmness));
        }
        off2
    }

    /// How hard contacts are in an implicit step.
    pub(super) fn firmness(&self, weights: &Weights<L>) -> Firmness<L> {
        Firmness { stiffness: self.contact_stiffness, per_h: weights.per_h, dt: weights.dt }
    }

    /// The velocity over the ground of the place where the strands grow, head axes, m/s.
    #[inline(always)]
    pub(super) fn root_velocity(&self, now: &Now<'_>) -> Vector<L> {
        now.head.as_ref().map_or(Vector::zero(), |head| {
            Vector::splat(head.velocity) + Vector::splat(head.angular_velocity).cross(self.root)
        })
    }

    /// The air on each stick, half at either end.
    #[inline(always)]
    fn blow(&self, work: &mut [Work<L>], model: &Model, now: &Now<'_>, weights: &Weights<L>) {
        let along = L::splat(model.along);
        let half = L::splat(0.5);
        let half_per_h = half * weights.per_h;
        let mut velocity_before = self.root_velocity(now);
        for stick in 0..work.len() {
            let here = &mut work[stick];
            let velocity = (here.place - here.from) * weights.per_h;
            let middle = (velocity_before + velocity) * half;
            let push = push(&self.links[stick], along, here.direction, here.wind - middle);
            let slope = push.force * half;
            here.slope -= slope;
            here.hessian.add_scaled(&push.slope, half_per_h);
            if stick > 0 {
                let before = &mut work[stick - 1];
                before.slope -= slope;
                before.hessian.add_scaled(&push.slope, half_per_h);
            }
            velocity_before = velocity;
        }
    }
}

/// From the tip: eliminates the turn of every stick. `rotary` is what a stick's rotary inertia counts, `righting` (0 or
/// 1) what a pull along it does.
#[inline(always)]
pub(super) fn sweep_inwards<L: Lane>(links: &[Link<L>], work: &mut [Work<L>], rotary: L, righting: L) {
    let mut places = Symmetric::zero();
    let mut mixed = Matrix::zero();
    let mut turns = Symmetric::zero();
    let mut place_slope = Vector::zero();
    let mut turn_slope = Vector::zero();
    let mut outer_slope = Vector::zero();
    for (link, work) in links.iter().zip(work).rev() {
        places.add(&work.hessian);
        place_slope += work.slope;
        outer_slope += work.slope;
        // The point's displacement is that of the stick's near end plus turn × lever.
        let lever = work.direction * link.length;
        let a = places.to_matrix().mul_lever(lever);
        let z = a.mul_add(L::splat(0.5), &mixed);
        let y = z.lever_mul(lever);
        let mut q = turns;
        q.add_with_transpose(&y);
        let m = a.add(&mixed);
        let slope = turn_slope + lever.cross(place_slope);
        // A pull rights the stick, as weight does a pendulum. What would push it over is left to the gradient.
        let pull = (-outer_slope.dot(lever)).max(L::zero()) * righting;
        q.add_identity(pull + link.rotary * rotary);
        q.add_outer(work.direction, -pull);
        let mut sum = q;
        sum.add_identity(work.curvature);
        let gain = sum.inverse();
        let m_gain = m.mul_symmetric(&gain);
        let load = slope + work.torque;
        work.gain = gain;
        work.lever = m_gain;
        work.offset = gain.mul_vector(load);
        // What is left for the stick before.
        places.subtract_product(&m_gain, &m);
        place_slope -= m_gain.mul_vector(load);
        mixed = m_gain.scale(work.curvature);
        // k − k gain k = k gain q, without taking like from like.
        turns = gain.times_commuting(&q, work.curvature);
        turn_slope = gain.mul_vector(slope * work.curvature) - gain.mul_vector(q.mul_vector(work.torque));
    }
}

/// From the root: the turn of every stick, left in `offset`. Out: how far any point of each strand went, m².
#[inline(always)]
pub(super) fn sweep_outwards<L: Lane>(links: &[Link<L>], work: &mut [Work<L>]) -> L {
    let mut displacement = Vector::zero();
    let mut turn_before = Vector::zero();
    let mut farthest = L::zero();
    for (link, work) in links.iter().zip(work) {
        let turn = work.gain.mul_vector(turn_before * work.curvature)
            - work.lever.transpose_mul(displacement)
            - work.offset;
        displacement += turn.cross(work.direction * link.length);
        // Sticks that only fill up the batch have no mass and no say.
        farthest = farthest.max(link.mass.above(L::zero(), displacement.norm_squared(), L::zero()));
        work.offset = turn;
        turn_before = turn;
    }
    farthest
}
