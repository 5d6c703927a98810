//! One iteration of Newton's method: forces and their derivatives at the present guess, a sweep inwards that
//! eliminates every stick's turn, a sweep outwards that applies them.
//!
//! To the stick before, everything from a joint outwards is a quadratic form of the near end's displacement and that
//! stick's own turn: a 6 × 6 matrix in three blocks. So one sweep solves all joints, as Featherstone's articulated
//! bodies do ("The calculation of robot dynamics using articulated-body inertias", 1983), with the joints' stiffness,
//! the air and the surfaces at the step's end in it.

use super::batch::{Batch, Model};
use super::contact::Firmness;
use super::drag::{Push, push};
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

/// What bends and twists a joint: gradient and (Gauss-Newton) second derivative of its potential.
pub(super) struct Bending<L> {
    /// By a turn of the stick, head axes, N·m.
    pub torque: Vector<L>,
    /// N·m, the same in all directions.
    pub curvature: L,
}

/// The joint between a stick that is turned like `before` and one of some work.
#[inline(always)]
pub(super) fn bend_joint<L: Lane>(before: Turn<L>, work: &Work<L>) -> Bending<L> {
    let two = work.stiffness.same(2.0);
    let bend = before.inverse().after(work.turn).bend();
    let sigma = bend * work.stiffness.same(0.25);
    let sigma2 = sigma.norm_squared();
    let load = bend.mul_add(work.stiffness, -work.natural);
    // For a turn ε of the stick, in the axes of the stick before, d bend = (1 − σ²) ε − 2 σ × ε + 2 σ (σ·ε): a
    // rotation times 1 + σ², so that the second derivative is the same in all directions.
    let torque = load.mul_add(
        work.stiffness.same(1.0) - sigma2,
        sigma.cross(load).mul_add(two, sigma * (sigma.dot(load) * two)),
    );
    let scale = work.stiffness.same(1.0) + sigma2;
    Bending { torque: before.rotate(torque), curvature: work.stiffness * scale * scale }
}

impl<L: Lane> Batch<L> {
    /// From the tip: forces on every point and joint and their derivatives, and every stick's turn eliminated. What it
    /// works out is used at once, while it is near.
    #[inline(always)]
    pub(super) fn sweep_inwards(
        &self,
        work: &mut [Work<L>],
        model: &Model,
        now: &Now<'_>,
        weights: &Weights<L>,
    ) {
        let gravity = Vector::same(weights.h, now.gravity);
        let (along, half) = (weights.h.same(model.along), weights.h.same(0.5));
        let half_per_h = half * weights.per_h;
        let root_velocity = self.root_velocity(now);
        let mut further_out = FurtherOut::nothing(weights.h);
        // The air on the stick further out, of which a half acts here.
        let mut air = Push::none(weights.h);
        for j in (0..work.len()).rev() {
            let (inner, outer) = work.split_at_mut(j);
            let (link, here) = (&self.links[j], &mut outer[0]);
            let (turn_before, velocity_before) = match inner.last() {
                Some(before) => (before.turn, before.velocity(weights.per_h)),
                None => (self.root_turn, root_velocity),
            };
            let inertia = link.mass * weights.per_h2;
            let mut slope = (here.place - here.drifting).mul_add(inertia, -(gravity * link.mass));
            let mut hessian = Symmetric::scaled_identity(inertia);
            if model.air {
                let middle = (velocity_before + here.velocity(weights.per_h)) * half;
                let push = push(link, along, here.direction, here.wind - middle);
                slope -= (push.force + air.force) * half;
                hessian.add_scaled(&push.slope, half_per_h);
                hessian.add_scaled(&air.slope, half_per_h);
                air = push;
            } else if model.pushes {
                slope -= here.wind * link.mass;
            }
            if here.touches {
                slope += here.slope;
                hessian.add(&here.hessian);
            }
            further_out.add_point(slope, &hessian);
            let joint = bend_joint(turn_before, here);
            further_out.eliminate(
                here,
                link.length,
                joint,
                link.rotary * weights.per_h2,
                weights.h.same(1.0),
            );
        }
    }

    /// What surfaces do to the points where they are; [`Touchable::feel`] of all.
    #[inline(always)]
    pub(super) fn feel_contacts(
        &mut self,
        work: &mut [Work<L>],
        model: &Model,
        now: &Now<'_>,
        weights: &Weights<L>,
    ) -> L {
        let firmness = self.firmness(weights);
        let mut off2 = weights.h.same(0.0);
        for near in self.touchable.iter().flat_map(|touchable| &touchable.near) {
            work[near.stick].forget_touch();
        }
        for touchable in &mut self.touchable {
            let surface = &now.surfaces[touchable.collider];
            let at = |stick: usize| (work[stick].place, work[stick].velocity(weights.per_h));
            off2 = off2.max(touchable.feel(model, surface, at, firmness));
            for near in &touchable.near {
                work[near.stick].touch(&near.bearing);
            }
        }
        off2
    }

    /// How hard contacts are in an implicit step.
    pub(super) fn firmness(&self, weights: &Weights<L>) -> Firmness<L> {
        Firmness {
            stiffness: self.contact_stiffness,
            give: self.contact_give,
            per_h: weights.per_h,
            dt: weights.dt,
        }
    }

    /// The velocity over the ground of the place where the strands grow, head axes, m/s.
    #[inline(always)]
    pub(super) fn root_velocity(&self, now: &Now<'_>) -> Vector<L> {
        now.head.as_ref().map_or(Vector::none(self.contact_give), |head| {
            Vector::same(self.contact_give, head.velocity)
                + Vector::same(self.contact_give, head.angular_velocity).cross(self.root)
        })
    }
}

/// Everything from a joint outwards: a quadratic form of its near end's displacement and of the turn of the stick before.
pub(super) struct FurtherOut<L> {
    places: Symmetric<L>,
    mixed: Matrix<L>,
    turns: Symmetric<L>,
    place_slope: Vector<L>,
    turn_slope: Vector<L>,
    /// All forces on points, to know what pulls along a stick.
    outer_slope: Vector<L>,
}

impl<L: Lane> FurtherOut<L> {
    /// Beyond the tip there is nothing.
    #[inline(always)]
    pub fn nothing(like: L) -> Self {
        let o = Vector::none(like);
        Self {
            places: Symmetric::none(like),
            mixed: Matrix::none(like),
            turns: Symmetric::none(like),
            place_slope: o,
            turn_slope: o,
            outer_slope: o,
        }
    }

    /// Adds a point at the end that it has come to.
    #[inline(always)]
    pub fn add_point(&mut self, slope: Vector<L>, hessian: &Symmetric<L>) {
        self.places.add(hessian);
        self.place_slope += slope;
        self.outer_slope += slope;
    }

    /// Goes on to a stick's near end: leaves in its work what its turn hangs on. `rotary` is what its rotary inertia
    /// counts, `righting` (0 or 1) what a pull along it does.
    #[inline(always)]
    pub fn eliminate(
        &mut self,
        work: &mut Work<L>,
        length: L,
        Bending { torque, curvature }: Bending<L>,
        rotary: L,
        righting: L,
    ) {
        // The point's displacement is that of the stick's near end plus turn × lever.
        let lever = work.direction * length;
        let a = self.places.to_matrix().mul_lever(lever);
        let z = a.mul_add(length.same(0.5), &self.mixed);
        let y = z.lever_mul(lever);
        let mut q = self.turns;
        q.add_with_transpose(&y);
        let m = a.add(&self.mixed);
        let slope = self.turn_slope + lever.cross(self.place_slope);
        // A pull rights the stick, as weight does a pendulum. What would push it over is left to the gradient.
        let pull = (-self.outer_slope.dot(lever)).max(length.same(0.0)) * righting;
        q.add_identity(pull + rotary);
        q.add_outer(work.direction, -pull);
        let mut sum = q;
        sum.add_identity(curvature);
        let gain = sum.inverse();
        let m_gain = m.mul_symmetric(&gain);
        let load = slope + torque;
        work.curvature = curvature;
        work.gain = gain;
        work.lever = m_gain;
        work.offset = gain.mul_vector(load);
        // What is left for the stick before.
        self.places.subtract_product(&m_gain, &m);
        self.place_slope -= m_gain.mul_vector(load);
        self.mixed = m_gain.scale(curvature);
        // k − k gain k = k gain q, without taking like from like.
        self.turns = gain.times_commuting(&q, curvature);
        self.turn_slope = gain.mul_vector(slope * curvature) - gain.mul_vector(q.mul_vector(torque));
    }
}

/// From the root: the turn of every stick.
pub(super) struct Outwards<L> {
    displacement: Vector<L>,
    turn: Vector<L>,
    /// How far any point of each strand goes, m².
    pub farthest2: L,
}

impl<L: Lane> Outwards<L> {
    /// At the root nothing moves.
    #[inline(always)]
    pub fn at_root(like: L) -> Self {
        Self { displacement: Vector::none(like), turn: Vector::none(like), farthest2: like.same(0.0) }
    }

    /// The turn of the next stick.
    #[inline(always)]
    pub fn next(&mut self, link: &Link<L>, work: &Work<L>) -> Vector<L> {
        self.turn = work.gain.mul_vector(self.turn * work.curvature)
            - work.lever.transpose_mul(self.displacement)
            - work.offset;
        self.displacement += self.turn.cross(work.direction * link.length);
        // Sticks that only fill up the batch have no mass and no say.
        let went2 =
            link.mass.above(link.mass.same(0.0), self.displacement.norm_squared(), link.mass.same(0.0));
        self.farthest2 = self.farthest2.max(went2);
        self.turn
    }
}

/// From the root: turns every stick by as much of the way as is asked, each strand's own. Out: how far the whole way would
/// take any point of each strand, m².
#[inline(always)]
pub(super) fn sweep_outwards<L: Lane>(root: Vector<L>, links: &[Link<L>], work: &mut [Work<L>], way: L) -> L {
    let mut outwards = Outwards::at_root(way);
    let mut end = root;
    for (link, work) in links.iter().zip(work) {
        let turned = work.turn.turned(outwards.next(link, work) * way);
        work.turn = turned.where_above(way, way.same(0.0), work.turn);
        work.direction = work.turn.x_axis();
        end = work.direction.mul_add(link.length, end);
        work.place = end;
    }
    outwards.farthest2
}
