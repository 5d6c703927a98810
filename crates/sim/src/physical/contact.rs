//! What a body does to a strand's points: a spring that is soft as a lock is, without a rebound, and friction.

use super::batch::Model;
use crate::gap::{Core, Seen, TINY2, gaps, room};
use tousle_core::{Pose, Vec3};
use tousle_lanes::{Lane, Placing, Symmetric, Vector};
use tousle_rod::Surface;

/// A collider that strands of a batch can reach.
#[derive(Clone, Debug)]
pub(crate) struct Touchable<L> {
    /// Index in the body.
    pub collider: usize,
    /// How near each point may come to the surface before it is pushed, m, from its center line; stick after stick.
    /// Minus infinity where it cannot.
    pub limits_m: Vec<L>,
    /// With which force the surface bore each point at the end of the last step, N: what friction goes by.
    pub pushes: Vec<L>,
    /// How far each point has slid from where the surface would hold it without effort, m, head axes: friction is the
    /// spring that pulls it back.
    pub slips: Vec<Vector<L>>,
    /// Of which points the last two may say something.
    pub is_borne: Vec<bool>,
    /// What is known of each point's distance from a mesh, in the axes in which that keeps its place.
    pub seen: Vec<Seen<L>>,
    /// How far each strand's points may go before one of them can be within a margin of the surface; none is looked at while
    /// that is more than the margin, m. Nothing where some may touch, nor where the surface moves against the head.
    pub idle_m: L,
    /// The ends of sticks that may touch in this step.
    pub near: Vec<Near<L>>,
    /// What the surface does to each of them, of those that it touches; at least as many.
    pub bearings: Vec<Bearing<L>>,
}

/// The end of a stick that may touch in a step.
#[derive(Clone, Debug)]
pub(crate) struct Near<L> {
    pub stick: usize,
    /// As in [`Touchable::limits_m`]; minus infinity for strands whose own may not touch in this step.
    limit_m: L,
    /// Where it was looked at or felt last, m; and how far that is from the surface, and the way out, unless it was felt since.
    place: Vector<L>,
    gap: Option<(L, Vector<L>)>,
    /// Whether the surface touched it, for any strand, where it was felt last. What does not touch, as most of what may, has
    /// nothing to be kept.
    touches: bool,
}

/// A surface and how it moves, ready for a step.
#[derive(Clone, Debug)]
pub(crate) struct MovingSurface {
    pub surface: Surface,
    /// Velocity over the ground of the surface's point at the head's center, head axes, m/s.
    pub velocity: Vec3,
    /// What turns it, head axes, rad/s.
    pub angular_velocity: Vec3,
    /// To the axes in which it keeps its place; `None` if these are the head's.
    pub own_from_head: Option<Pose>,
}

/// How the velocity of a point hangs on its place, and how hard what it touches is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Firmness<L> {
    /// Spring of a contact, N/m, and one over it.
    pub stiffness: L,
    pub give: L,
    /// Change of velocity for a change of place, 1/s.
    pub per_h: L,
    /// For how long a point goes on sliding before its friction is felt, s: the step, or nothing for an explicit one.
    pub dt: L,
}

/// What a surface does to a point: the gradient of its potential and its second derivative.
#[derive(Clone, Debug)]
pub(crate) struct Bearing<L> {
    /// Force outwards, N.
    pub push: L,
    /// How far it has slid then ([`Touchable::slips`]).
    pub slip: Vector<L>,
    pub slope: Vector<L>,
    pub hessian: Symmetric<L>,
}

/// Square root of a contact's stiffness over the mean mass of a lock's points, 1/s. A lock is a loose bundle of a few
/// millimeters that gives way by fractions of one. If it rises, contacts are harder (under ten times a point's weight
/// one gives way by 98 / 200² m = 2.5 mm at 200) and take more iterations; between 100 and 500 the scores on the
/// development captures move by less than 0.005.
pub(super) const CONTACT_RATE: f64 = 200.0;

/// Depth over which a contact's spring grows from nothing to its full stiffness, m: a fringe of stray hairs. Without
/// it the search for what touches goes round in circles.
pub(super) const FRINGE_M: f64 = 5e-4;

/// Damping of what is held by friction, over its stiffness, s: critical.
const RUB_SECS: f64 = 2.0 / CONTACT_RATE;

/// How deep a spring must be pressed to push with a force of `give` times its stiffness, m.
pub(super) fn depth_of(give_m: f64) -> f64 {
    if give_m >= 0.5 * FRINGE_M { give_m + 0.5 * FRINGE_M } else { (2.0 * FRINGE_M * give_m).sqrt() }
}

impl<L: Lane> Touchable<L> {
    /// Finds the points that are, or are expected to come, within `margin_m` of where something touches them; `again`: more
    /// of them in the same step. `went_m`: how far any point of each strand has gone, at most, since this was asked last.
    #[inline(always)]
    pub fn look(
        &mut self,
        moving: &MovingSurface,
        places: impl Iterator<Item = Vector<L>>,
        (margin_m, went_m): (L, L),
        again: bool,
    ) {
        if !again {
            self.near.clear();
        }
        self.idle_m -= went_m;
        if self.idle_m.all_above(margin_m) {
            return;
        }
        // Of a surface that moves against the head nobody knows when it comes.
        let may_idle = !again && moving.own_from_head.is_none();
        let idle_m = margin_m.same(if may_idle { f64::INFINITY } else { 0.0 });
        self.idle_m = match Core::of(&moving.surface, margin_m) {
            Some(core) => self.look_around(&core, &moving.surface, places, margin_m, again, idle_m),
            None => self.look_back(moving, places, margin_m, again, idle_m),
        };
    }

    /// [`Touchable::look`] where it is quickly told which points are far. Out: [`Touchable::idle_m`], at most `idle_m`.
    #[inline(always)]
    fn look_around(
        &mut self,
        core: &Core<L>,
        surface: &Surface,
        places: impl Iterator<Item = Vector<L>>,
        margin_m: L,
        again: bool,
        mut idle_m: L,
    ) -> L {
        let nothing = margin_m.same(0.0);
        let reach_m = margin_m * margin_m.same(surface.steepness());
        let per_steepness = margin_m.same(1.0 / surface.steepness());
        for (stick, place) in places.enumerate() {
            let away2 = core.away2(place);
            let limit_m = self.limits_m[stick];
            if away2.all_above(core.far2(limit_m + reach_m)) {
                self.let_go(stick, again);
                if idle_m.any_above(nothing) {
                    idle_m = idle_m.min((core.least_m(away2) - limit_m) * per_steepness);
                }
            } else {
                idle_m = nothing;
                self.look_at(surface, stick, place, margin_m, again);
            }
        }
        idle_m
    }

    /// [`Touchable::look`] where it costs less to remember the last look than to look once more.
    #[inline(always)]
    fn look_back(
        &mut self,
        moving: &MovingSurface,
        places: impl Iterator<Item = Vector<L>>,
        margin_m: L,
        again: bool,
        mut idle_m: L,
    ) -> L {
        let (nothing, one, never) =
            (margin_m.same(0.0), margin_m.same(1.0), margin_m.same(f64::NEG_INFINITY));
        self.seen.resize(self.limits_m.len(), Seen::not_yet());
        let own = moving.own_from_head.map(|own| Placing::same(margin_m, &own));
        for (stick, place) in places.enumerate() {
            // In its own axes the surface does not come nearer by itself.
            let own_place = own.map_or(place, |own| own.place(place));
            let seen = self.seen[stick];
            let far = seen.far(own_place, margin_m);
            if !one.any_above(far) {
                self.let_go(stick, again);
                if idle_m.any_above(nothing) {
                    idle_m = idle_m.min(seen.left_m(own_place));
                }
                continue;
            }
            idle_m = nothing;
            let margin_m = far.above(nothing, never, margin_m);
            let gap = self.look_at(&moving.surface, stick, place, margin_m, again);
            let room_m = room(&moving.surface, gap, self.limits_m[stick]);
            let place = Vector::where_above(far, nothing, seen.place, own_place);
            self.seen[stick] = Seen { place, room_m: far.above(nothing, seen.room_m, room_m) };
        }
        idle_m
    }

    /// Whether the end of a stick may touch in a step: whether, for any strand, it is or is expected to come within
    /// `margin_m` (minus infinity for a strand that does not look); `again`: or comes to in the same step. What bore it is
    /// forgotten by a strand for which it is not, whatever the others do. Out: how far it is from the surface, m.
    #[inline(always)]
    fn look_at(&mut self, surface: &Surface, stick: usize, place: Vector<L>, margin_m: L, again: bool) -> L {
        let (limit_m, nothing) = (self.limits_m[stick], margin_m.same(0.0));
        let (gap, normal) = gaps(surface, place);
        let beyond = gap - limit_m - margin_m * margin_m.same(surface.steepness());
        // A NaN counts as near.
        if beyond.all_above(nothing) {
            self.let_go(stick, again);
        } else {
            if self.is_borne[stick] && !again {
                let slip = self.slips[stick];
                self.pushes[stick] = beyond.above(nothing, nothing, self.pushes[stick]);
                self.slips[stick] = Vector::where_above(beyond, nothing, Vector::none(nothing), slip);
            }
            let limit_m = beyond.above(nothing, margin_m.same(f64::NEG_INFINITY), limit_m);
            let known = if again { self.near.iter_mut().find(|near| near.stick == stick) } else { None };
            match known {
                Some(near) => near.limit_m = near.limit_m.max(limit_m),
                None => {
                    let gap = Some((gap, normal));
                    self.near.push(Near { stick, limit_m, place, gap, touches: false });
                }
            }
        }
        gap
    }

    /// The end of a stick is far: nothing of what bore it is left, unless a step was begun with it.
    #[inline(always)]
    fn let_go(&mut self, stick: usize, again: bool) {
        if self.is_borne[stick] && !again {
            self.is_borne[stick] = false;
            let zero = self.limits_m[stick].same(0.0);
            self.pushes[stick] = zero;
            self.slips[stick] = Vector::none(zero);
        }
    }

    /// What the surface does to all that may touch. `at`: place and velocity of a stick's end, and the stick's direction;
    /// the place is that of the last look, or all have been felt since.
    ///
    /// Out: the square of the farthest that any point of each strand would be off if the surface did what the last call's
    /// forces and derivatives let expect, m²: by how much the force is another, over the spring of a contact.
    #[inline(always)]
    pub fn feel(
        &mut self,
        model: &Model,
        moving: &MovingSurface,
        at: impl Fn(usize) -> (Vector<L>, Vector<L>, Vector<L>),
        firmness: Firmness<L>,
    ) -> L {
        let zero = firmness.give.same(0.0);
        let mut off2 = zero;
        if self.bearings.len() < self.near.len() {
            self.bearings.resize(self.near.len(), Bearing::none(zero));
        }
        for (near, bearing) in self.near.iter_mut().zip(&mut self.bearings) {
            let felt = at(near.stick);
            let place = felt.0;
            let (gap, normal) = near.gap.take().unwrap_or_else(|| gaps(&moving.surface, place));
            let depth = (near.limit_m - gap).max(zero);
            let touches = depth.any_above(zero);
            if touches || near.touches {
                let here = if touches {
                    let history = (self.pushes[near.stick], self.slips[near.stick]);
                    bear(model, (depth, normal), history, moving, felt, firmness)
                } else {
                    Bearing::none(zero)
                };
                let off = if near.touches {
                    here.slope - bearing.slope - bearing.hessian.mul_vector(place - near.place)
                } else {
                    here.slope
                };
                off2 = off2.max(off.norm_squared());
                *bearing = here;
            }
            near.place = place;
            near.touches = touches;
        }
        off2 * firmness.give * firmness.give
    }

    /// Which sticks' ends the surface touches, and what it does to them, as they were felt last.
    #[inline(always)]
    pub fn touched(&self) -> impl Iterator<Item = (usize, &Bearing<L>)> {
        let touched = self.near.iter().zip(&self.bearings).filter(|(near, _)| near.touches);
        touched.map(|(near, bearing)| (near.stick, bearing))
    }

    /// Keeps what friction goes by in the next step, as it was felt last.
    #[inline(always)]
    pub fn remember(&mut self) {
        for (near, bearing) in self.near.iter().zip(&self.bearings) {
            let stick = near.stick;
            if near.touches {
                self.pushes[stick] = bearing.push;
                self.slips[stick] = bearing.slip;
            } else if self.is_borne[stick] {
                let zero = near.limit_m.same(0.0);
                self.pushes[stick] = zero;
                self.slips[stick] = Vector::none(zero);
            }
            self.is_borne[stick] = near.touches;
        }
    }
}

impl<L: Lane> Bearing<L> {
    fn none(like: L) -> Self {
        let o = Vector::none(like);
        Self { push: like.same(0.0), slip: o, slope: o, hessian: Symmetric::none(like) }
    }
}

/// The force of a surface on the end of a stick, so deep in it, at a place and velocity.
///
/// Friction is elastic up to Coulomb's limit and plastic beyond, as in bristle models (Dahl 1968, "A solid friction
/// model"): what is held stays where it is for ever, and what hangs on it from the start is in balance.
#[inline(always)]
fn bear<L: Lane>(
    model: &Model,
    (depth, normal): (L, Vector<L>),
    (push_before, slip_before): (L, Vector<L>),
    moving: &MovingSurface,
    (place, velocity, direction): (Vector<L>, Vector<L>, Vector<L>),
    Firmness { stiffness, give, per_h, dt }: Firmness<L>,
) -> Bearing<L> {
    let (zero, fringe) = (depth.same(0.0), depth.same(FRINGE_M));
    let soft = depth.min(fringe);
    let spring = (soft * soft * depth.same(0.5 / FRINGE_M) + (depth - soft)) * stiffness;
    let share = soft * depth.same(1.0 / FRINGE_M);
    // A critical dashpot that only resists, never pulls: what touches does not bounce.
    let ground =
        Vector::same(depth, moving.velocity) + Vector::same(depth, moving.angular_velocity).cross(place);
    let relative = velocity - ground;
    let leaving = relative.dot(normal);
    let dashpot = stiffness * share * depth.same(2.0 / CONTACT_RATE);
    let push = (spring - dashpot * leaving).max(zero);
    // In the fringe the dashpot grows with the depth. What comes is met by it; what leaves is not let go for it.
    let stiffens = (fringe - depth).above(zero, stiffness * depth.same(2.0 / CONTACT_RATE / FRINGE_M), zero);
    let rise = (-leaving).max(zero).mul_add(stiffens, stiffness * share + dashpot * per_h);
    // What comes fast is met hardest near the surface. An iteration that went by the slope where it is deep would throw it off, the
    // next one let it fall as deep again. So it goes at least by the slope from here to where the surface lets go.
    let rise = rise.max(push / depth.max(fringe));
    let rise = push.above(zero, rise, zero);
    let mut hessian = Symmetric::none(depth);
    let mut slope = -(normal * push);
    if model.friction == 0.0 {
        hessian.add_outer(normal, rise);
        return Bearing { push, slip: Vector::none(depth), slope, hessian };
    }
    // The limit goes by the push a step ago, so that friction does not wait for a push that waits for it.
    let held = depth.above(zero, push_before, zero);
    let limit = held * depth.same(model.friction) * give;
    let along = relative - normal * leaving;
    let rub_secs = depth.same(RUB_SECS);
    let slip = slip_before.across(normal) + along * dt;
    let mut pull = slip + along * rub_secs;
    if moving.own_from_head.is_some() {
        let hops = Hops { held, approach: (-leaving).max(zero), friction: depth.same(model.friction) };
        let mass = stiffness * depth.same(1.0 / (CONTACT_RATE * CONTACT_RATE));
        pull = hops.tilt(pull, along, direction.across(normal), mass);
    }
    let share = share_within(limit, pull);
    let rub = stiffness * share;
    slope += pull * rub;
    let rub_rise = rub * (dt + rub_secs) * per_h;
    hessian.add_identity(rub_rise);
    hessian.add_outer(normal, rise - rub_rise);
    Bearing { push, slip: slip * share_within(limit, slip), slope, hessian }
}

/// How fast a surface that is set to its place at every step, without a velocity, lets hair on it come to rest, 1/s: a
/// contact that is critically damped over 20 ms, nine tenths of it hard, as engines offer it unless told otherwise.
const HOP_RATE: f64 = 2.0 / (0.9 * 0.02);

/// What a kick of one unit at a point of a chain of equal sticks does, in units of one over a stick's mass: along the
/// surface's normal, along the surface across the lock, along the lock, and what the contact itself gives way. Across, a
/// round bundle rolls besides (r² over its rotary inertia ½ m r² is 2). From the mass matrices of chains of 24 to 26 sticks
/// hung over a shoulder.
const YIELDS: [f64; 4] = [1.5, 3.4, 0.2, 0.05];

/// Rounds of the search for how far friction gives way; each is a step of a fixed-point iteration that comes from above.
const TILT_ROUNDS: usize = 8;

/// Hair that follows a surface which goes back without a velocity of its own: it hops. It touches for a share of the time,
/// is thrown off by what damps its approach, and falls again.
#[derive(Clone, Copy)]
struct Hops<L> {
    /// Mean force outwards, N.
    held: L,
    /// How fast the point comes nearer to where the surface was, m/s, ≥ 0.
    approach: L,
    friction: L,
}

impl<L: Lane> Hops<L> {
    /// Which way friction pulls a point that hops.
    ///
    /// While it touches, friction stops the point as far as Coulomb's limit lets it: of all forces within the cone the one
    /// that leaves least kinetic energy (Todorov 2011, "A convex, smooth and invertible contact model for trajectory
    /// optimization"). So it stops first what is light, across the lock, and has the more left to pull along it, where the
    /// lock is as heavy as all that hangs on it. A point that touches all the time has no such choice: there friction
    /// opposes how it slides.
    #[inline(always)]
    fn tilt(self, pull: Vector<L>, slides: Vector<L>, lock: Vector<L>, mass: L) -> Vector<L> {
        let (zero, one, tiny) = (mass.same(0.0), mass.same(1.0), mass.same(1e-30));
        let [outwards, across, along, gives] = YIELDS.map(|y| mass.same(y));
        let thrown = mass * mass.same(HOP_RATE) * self.approach;
        // The push while it touches, N, and for what share of the time it does not.
        let push = self.held + thrown / outwards;
        let aloft = thrown / (push * outwards).max(tiny);
        if !aloft.any_above(zero) {
            return pull;
        }
        let lock = lock * lock.norm_squared().max(mass.same(TINY2)).per_sqrt();
        let slides_on = slides.dot(lock);
        let slides_across2 = (slides - lock * slides_on).norm_squared();
        let (across, along) = (across * aloft, along * aloft);
        // Forces that stop it, over what the limit allows, for one unit of yield.
        let per_limit = mass * mass.same(HOP_RATE) / (push * self.friction).max(tiny);
        let exceeds = |rest: L| {
            let (on, over) = (one / (rest + along), one / (rest + across));
            let force2 = slides_on * slides_on * on * on + slides_across2 * over * over;
            force2 * per_limit * per_limit
        };
        let start2 = (slides_on * slides_on + slides_across2) * per_limit * per_limit;
        let mut rest = (start2 * start2.max(tiny).per_sqrt()).max(gives);
        for _ in 0..TILT_ROUNDS {
            let exceeds2 = exceeds(rest);
            rest = (rest * exceeds2 * exceeds2.max(tiny).per_sqrt()).max(gives);
        }
        let share = (rest + along) / (rest + across);
        let pulls_on = lock * pull.dot(lock);
        let tilted = pulls_on + (pull - pulls_on) * share;
        Vector::where_above(aloft, zero, tilted, pull)
    }
}

/// The share of a way that is no longer than a limit, at most the whole.
#[inline(always)]
fn share_within<L: Lane>(limit: L, way: Vector<L>) -> L {
    let per_way = way.norm_squared().max(limit.same(TINY2)).per_sqrt();
    (limit * per_way).min(limit.same(1.0))
}

/// How near a point may come before it is pushed, from how near it lies at rest and what bears it there.
pub(super) fn limit_m(clearance_m: f64, bearing_n: f64, stiffness: f64) -> f64 {
    clearance_m + depth_of(if stiffness > 0.0 { bearing_n / stiffness } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use tousle_core::{DistanceGrid, Shape, Solid};
    use tousle_lanes::F64x1;

    #[test]
    fn a_depth_pushes_as_hard_as_it_was_made_for() {
        for give in [0.0, 1e-5, 2e-4, 1e-3] {
            let depth = depth_of(give);
            let soft = depth.min(FRINGE_M);
            let pushes = soft * soft * 0.5 / FRINGE_M + (depth - soft);
            assert!((pushes - give).abs() < 1e-15, "{give} {pushes}");
        }
    }

    /// What meets a point is gone where the surface lets go of it, by the slope that an iteration goes by too; of what comes slowly
    /// that is the true one.
    #[test]
    fn an_iteration_does_not_throw_off_what_comes_fast() {
        let (model, moving) = (
            Model {
                along: 0.0,
                air: false,
                pushes: false,
                force_law: None,
                friction: 0.0,
                resolution_m: 0.0,
            },
            standing(Surface::new(&ball(0.1))),
        );
        let (of, stiffness, per_h) = (F64x1::splat, 4.0, 90.0);
        let meet = |depth_m: f64, approach: f64| {
            let firmness = Firmness {
                stiffness: of(stiffness),
                give: of(1.0 / stiffness),
                per_h: of(per_h),
                dt: of(0.0),
            };
            let normal = Vector::splat(Vec3::x());
            let velocity = Vector::splat(Vec3::x() * -approach);
            let felt = (Vector::zero(), velocity, Vector::splat(Vec3::y()));
            let met = bear(&model, (of(depth_m), normal), (of(0.0), Vector::zero()), &moving, felt, firmness);
            (met.push.get(0), met.hessian.mul_vector(normal).get(0).x)
        };
        for depth_m in [1e-5, 1e-4, 4e-4, 6e-4, 2e-3, 0.01] {
            for approach in [0.0, 0.01, 0.3, 3.0] {
                let (push, rise) = meet(depth_m, approach);
                let left = push - rise * depth_m.max(FRINGE_M);
                assert!(left < 1e-12, "{depth_m} {approach}: {left} N");
                let further = 1e-9;
                let slope = (meet(depth_m + further, approach + further * per_h).0 - push) / further;
                assert!(rise > 0.999 * slope, "{depth_m} {approach}: {rise}, {slope} N/m");
                let is_slow = approach <= 0.01 && depth_m > 1e-4;
                assert!(!is_slow || rise < 1.001 * slope, "{depth_m} {approach}: {rise}, {slope} N/m");
            }
        }
    }

    /// A strand that has not been looked at, by how near each of its points may come, m.
    fn touchable_at(limits_m: &[f64]) -> Touchable<F64x1> {
        let n = limits_m.len();
        Touchable {
            collider: 0,
            limits_m: limits_m.iter().map(|limit_m| F64x1::splat(*limit_m)).collect(),
            pushes: vec![F64x1::zero(); n],
            slips: vec![Vector::zero(); n],
            is_borne: vec![false; n],
            seen: Vec::new(),
            idle_m: F64x1::zero(),
            near: Vec::new(),
            bearings: Vec::new(),
        }
    }

    /// A surface that does not move.
    fn standing(surface: Surface) -> MovingSurface {
        MovingSurface {
            surface,
            velocity: Vec3::zeros(),
            angular_velocity: Vec3::zeros(),
            own_from_head: None,
        }
    }

    /// What is not near does not touch before it has gone as far as it was looked for, however flat the surface.
    #[test]
    fn who_is_not_near_cannot_touch_within_the_margin() {
        let (limit_m, margin_m, zero) = (0.004, 0.01, Vec3::zeros());
        let shape = Shape::Ellipsoid { center_m: zero, half_axes_m: Vec3::new(0.1, 0.005, 0.005) };
        let surface = Surface::new(&shape);
        let moving = standing(surface.clone());
        for k in 0..30 * 30 {
            let place = Vec3::new(f64::from(k % 30), 0.0, f64::from(k / 30)) * 0.01;
            let mut touchable = touchable_at(&[limit_m]);
            let (margin, zero) = (F64x1::splat(margin_m), F64x1::zero());
            touchable.look(&moving, [Vector::splat(place)].into_iter(), (margin, zero), false);
            for way in 0..if touchable.near.is_empty() { 64 } else { 0 } {
                let (sin, cos) = libm::sincos(f64::from(way) / 64.0 * std::f64::consts::TAU);
                let gap_m = surface.gap(place + Vec3::new(cos, 0.0, sin) * margin_m).distance_m;
                assert!(gap_m > limit_m, "{place} {way}: {gap_m}");
            }
        }
    }

    /// A ball whose distances lie on a grid.
    fn ball(radius_m: f64) -> Shape {
        let (n, edge_m, origin_m) = (9, 0.05, Vec3::repeat(-0.2));
        let node = |flat: usize| {
            let at = [flat / (n * n), flat / n % n, flat % n].map(|i| i as f64 * edge_m);
            (origin_m + Vec3::from(at)).norm() - radius_m
        };
        let distances_m: Vec<f64> = (0..n * n * n).map(node).collect();
        let distances = DistanceGrid::new(origin_m, edge_m, [n; 3], &distances_m);
        Shape::Mesh(Arc::new(Solid { points_m: Vec::new(), triangles: Vec::new(), distances }))
    }

    /// Points that go to and fro are near whenever they are within the margin, though they are not always looked at.
    #[test]
    fn who_is_near_is_seen_whoever_was_idle() {
        let zero = Vec3::zeros();
        let (limits_m, margin_m) = ([0.004, 0.006], F64x1::splat(0.01));
        let places = |k: u32| {
            let far = |rate: f64| 0.2 + 0.17 * libm::sin(rate * f64::from(k));
            [Vec3::new(0.0, far(0.011), 0.03), Vec3::new(0.02, 0.01, -far(0.007) - 0.08)]
        };
        for shape in [
            Shape::Ellipsoid { center_m: zero, half_axes_m: Vec3::new(0.1, 0.03, 0.1) },
            Shape::Capsule { a_m: -Vec3::x() * 0.1, b_m: Vec3::x() * 0.1, radius_m: 0.1 },
            ball(0.1),
        ] {
            let surface = Surface::new(&shape);
            let moving = standing(surface.clone());
            let mut touchable = touchable_at(&limits_m);
            let (mut n_looked, mut n_near) = (0, 0);
            let mut before = places(0);
            for k in 0..3000 {
                let now = places(k);
                let went_m = (0..2).map(|p| (now[p] - before[p]).norm()).fold(0.0, f64::max);
                let points = now.map(Vector::splat).into_iter().inspect(|_| n_looked += 1);
                touchable.look(&moving, points, (margin_m, F64x1::splat(went_m)), false);
                let is_near = |p: &usize| surface.gap(now[*p]).distance_m - limits_m[*p] <= 0.01;
                for p in (0..2).filter(is_near) {
                    assert!(touchable.near.iter().any(|near| near.stick == p), "{shape:?} {k} {p}");
                    n_near += 1;
                }
                before = now;
            }
            assert!(n_near > 300 && n_looked < 4500, "{shape:?}: {n_near} near, {n_looked} looked at");
            // Looked at first, then known to be far.
            for went_m in [2.0, 0.0] {
                let far = [Vec3::repeat(0.5), Vec3::repeat(-0.5)].map(Vector::splat);
                touchable.look(&moving, far.into_iter(), (margin_m, F64x1::splat(went_m)), false);
            }
            assert!(touchable.idle_m.get(0) > 0.1, "{shape:?}: {}", touchable.idle_m.get(0));
        }
    }

    /// A pull of one both ways, of a point of 0.1 g that slides at a speed, m/s, both ways and comes at another.
    fn tilted(approach: f64, slides: f64) -> Vector<F64x1> {
        let of = F64x1::splat;
        let hops = Hops { held: of(1e-3), approach: of(approach), friction: of(0.25) };
        let both = |size: f64| Vector::splat(Vec3::new(size, size, 0.0));
        hops.tilt(both(1.0), both(slides), Vector::splat(Vec3::x()), of(1e-4))
    }

    /// Friction leaves as much along a lock, and across it what the law in docs/physical.md says: 1.48 mN are thrown off.
    #[test]
    fn friction_stops_hair_that_hops_along_itself_first() {
        assert_eq!(tilted(0.0, 0.1).get(0), Vec3::new(1.0, 1.0, 0.0));
        let aloft = 1e-4 * HOP_RATE * 0.2 / (1e-4 * HOP_RATE * 0.2 + 1.5e-3);
        for slides in [1e-3, 0.05, 0.5] {
            let share = tilted(0.2, slides).get(0);
            assert!((share.x - 1.0).abs() < 1e-12 && share.z == 0.0, "{share}");
            // From the share follows how far friction is from stopping it: share = (ρ + 0.2 a) / (ρ + 3.4 a).
            let rest = (3.4 * share.y - 0.2) * aloft / (1.0 - share.y);
            let force = |yields: f64| 1e-4 * HOP_RATE * slides / (rest + yields * aloft);
            let limit = 0.25 * (1e-3 + 1e-4 * HOP_RATE * 0.2 / 1.5);
            let over = libm::hypot(force(0.2), force(3.4)) / limit;
            if rest > 0.0501 {
                assert!((over - 1.0).abs() < 1e-2, "{slides}: {over} of the limit");
            } else {
                assert!((rest - 0.05).abs() < 1e-9 && over < 1.0, "{slides}: {rest}, {over} of the limit");
            }
        }
    }
}
