//! One iteration of Newton's method: forces and their derivatives at the present guess, a sweep inwards that
//! eliminates every stick's turn, a sweep outwards that applies them.
//!
//! To the stick before, everything from a joint outwards is a quadratic form of the near end's displacement and that
//! stick's own turn: a 6 × 6 matrix in three blocks. So one sweep solves all joints, as Featherstone's articulated
//! bodies do ("The calculation of robot dynamics using articulated-body inertias", 1983), with the joints' stiffness,
//! the air and the surfaces at the step's end in it.

use super::batch::{Batch, Model};
use super::contact::{Firmness, Touchable};
use super::drag::{Push, push};
use super::link::{Bending, Link, Work};
use super::scene::Now;
use tousle_lanes::{Lane, Matrix, Shifted, Symmetric, Turn, Vector};

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

/// The joint between a stick that is turned like `before` and one of some work.
#[inline(always)]
pub(super) fn bend_joint<L: Lane>(before: Turn<L>, work: &Work<L>) -> Bending<L> {
    let relative = before.inverse().after(work.turn);
    let per = work.stiffness.same(1.0) / relative.one_more();
    let per2 = (per + per) * per;
    // The bend is 4 v / (1 + w).
    let bend_per_v = (per + per) * work.stiffness.same(2.0);
    let load = relative.v.mul_add(bend_per_v * work.stiffness, -work.natural);
    // For a turn ε of the stick, in the axes of the stick before, d bend = (1 − σ²) ε − 2 σ × ε + 2 σ (σ·ε), σ = bend / 4:
    // a rotation by half the joint's turn times 1 + σ² = 2 / (1 + w), so that the second derivative is the same in all
    // directions. Together with the turn of the stick before, that rotation is along the sum of both sticks' turns,
    // whose square is 2 (1 + w).
    let (w, v) = (before.w + work.turn.w, before.v + work.turn.v);
    let turned = v.cross(load.mul_add(w, v.cross(load)));
    Bending { torque: turned.mul_add(per2, load * (per + per)), curvature: work.stiffness * (per2 + per2) }
}

impl<L: Lane> Batch<L> {
    /// Forces on every point and joint, and their derivatives. Here no stick waits for another: a processor works on some
    /// at a time, which it could not while a sweep goes from one to the next; and on the more, the less there is to do for each.
    /// So points come first, then joints.
    #[inline(always)]
    pub(super) fn load_sticks(
        &self,
        work: &mut [Work<L>],
        model: &Model,
        now: &Now<'_>,
        weights: &Weights<L>,
    ) {
        self.load_points(work, model, self.root_velocity(now) * weights.h, weights);
        let mut turn_before = self.root_turn;
        for work in &mut *work {
            work.joint = bend_joint(turn_before, work);
            turn_before = work.turn;
        }
        for (stick, bearing) in self.touchable.iter().flat_map(Touchable::touched) {
            work[stick].touch(bearing);
        }
    }

    /// Inertia, and what the air does.
    #[inline(always)]
    fn load_points(&self, work: &mut [Work<L>], model: &Model, root_way: Vector<L>, weights: &Weights<L>) {
        let (along, half) = (weights.h.same(model.along), weights.h.same(0.5));
        let half_per_h = half * weights.per_h;
        // The air on the stick further out, of which a half acts here.
        let mut air = Push::none(weights.h);
        for j in (0..work.len()).rev() {
            let (inner, outer) = work.split_at_mut(j);
            let (link, here) = (&self.links[j], &mut outer[0]);
            let inertia = link.mass * weights.per_h2;
            here.slope = (here.place - here.drifting) * inertia;
            here.hessian = Symmetric::scaled_identity(inertia);
            if model.air {
                let way_before = inner.last().map_or(root_way, Work::way);
                let wind = (way_before + here.way()).mul_add(-half_per_h, here.wind);
                let push = push(link, along, here.direction, wind);
                here.slope = (push.force + air.force).mul_add(-half, here.slope);
                here.hessian.add_scaled(&push.slope, half_per_h);
                here.hessian.add_scaled(&air.slope, half_per_h);
                air = push;
            } else if model.pushes {
                here.slope -= here.wind * link.mass;
            }
        }
    }

    /// From the tip: every stick's turn eliminated.
    #[inline(always)]
    pub(super) fn sweep_inwards(&self, work: &mut [Work<L>], weights: &Weights<L>) {
        let mut further_out = FurtherOut::nothing(weights.h);
        for (link, here) in self.links.iter().zip(work).rev() {
            further_out.add_point(here.slope, &here.hessian);
            let rotary = link.rotary * weights.per_h2;
            further_out.eliminate(here, link.length, here.joint, rotary, weights.h.same(1.0));
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
        let mut off2 = weights.h.same(0.0);
        for touchable in &mut self.touchable {
            let surface = &now.surfaces[touchable.collider];
            let at = |stick: usize| {
                let work = &work[stick];
                (work.place, work.velocity(weights.per_h), work.direction)
            };
            off2 = off2.max(touchable.feel(model, surface, at, firmness));
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
    /// What mixes the two, over the second derivative of the joint's potential; and that derivative.
    mixed: Matrix<L>,
    curvature: L,
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
            curvature: like.same(0.0),
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
        let m = self.mixed.mul_add(self.curvature, &self.places.mul_lever(lever));
        let twice = self.mixed.mul_add(self.curvature, &m);
        let mut q = self.turns;
        q.add_lever_product(lever, &twice);
        let slope = lever.cross_add(self.place_slope, self.turn_slope);
        // A pull rights the stick, as weight does a pendulum. What would push it over is left to the gradient.
        let pull = (-self.outer_slope.dot(lever)).max(length.same(0.0)) * righting;
        q.add_identity(pull + rotary);
        q.add_outer(work.direction, -pull);
        let Shifted { part, inner, outer, det } = q.shifted(curvature);
        let per_det = length.same(1.0) / det;
        let load = slope + torque;
        let turned = part.mul_vector(load);
        let offset = load.mul_add(inner, turned) * per_det;
        let gain = part.plus_identity(inner).scale(per_det);
        let m_gain = m.mul_symmetric(&gain);
        work.joint.curvature = curvature;
        work.gain = gain;
        work.lever = m_gain;
        work.offset = offset;
        // What is left for the stick before.
        self.places.subtract_product(&m_gain, &m);
        self.place_slope = m.subtract_from(self.place_slope, offset);
        self.mixed = m_gain;
        self.curvature = curvature;
        // k − k gain k = k gain q, and k gain slope − gain q torque likewise.
        let scale = curvature * per_det;
        let whole = outer * per_det;
        self.turns = part.scale(-(curvature * scale)).plus_identity(curvature * whole);
        self.turn_slope = slope.mul_add(inner, turned) * scale - torque * whole;
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
        let from_before = work.gain.mul_vector_add(self.turn * work.joint.curvature, -work.offset);
        self.turn = work.lever.transpose_mul_add(-self.displacement, from_before);
        self.displacement = self.turn.cross_add(work.direction * link.length, self.displacement);
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
