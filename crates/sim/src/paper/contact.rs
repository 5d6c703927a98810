use super::{Motion, Stick, Work};
use crate::gap::{Seen, gaps, room};
use crate::prepared::Prepared;
use crate::timeline::StepScene;
use crate::touchable::{Touchable, reached};
use tousle_lanes::{Lane, Symmetric, Vector};

/// Ψ of E2: what the body does to the points it touches, found so that they stay outside.
///
/// A force is remembered from step to step. It acts on the joints with all others, and is then corrected by what
/// the joints' new rates still lack: at rest nothing is lacking, and what bears a strand bears it for ever.
#[derive(Clone, Debug)]
pub(super) struct Contacts<L> {
    /// The colliders that some of the strands can reach.
    colliders: Vec<Touchable>,
    /// One slot a point and collider, the colliders of a point together.
    slots: Vec<Slot<L>>,
    /// What is known of each slot's distance.
    seen: Vec<Seen<L>>,
    /// Which slots may say something.
    is_borne: Vec<bool>,
    /// What touches in this step, ordered from the root.
    touching: Vec<Touch<L>>,
    /// What a sweep adds to the force on each point, N.
    corrections: Vec<Vector<L>>,
}

/// What is remembered of a collider and a point.
#[derive(Clone, Copy, Debug)]
struct Slot<L> {
    /// How near the point may come, m; minus infinity where it cannot.
    clearance_m: L,
    /// Force outwards, N, ≥ 0.
    push: L,
    /// Friction along the surface, N.
    rub: Vector<L>,
}

#[derive(Clone, Copy, Debug)]
struct Touch<L> {
    slot: usize,
    stick: usize,
    /// 1 for a strand that touches, 0 for one that does not.
    touches: L,
    normal: Vector<L>,
    /// How far the point still is from where it may not go, m; negative beyond.
    room_m: L,
    /// Velocity of the surface in head space, m/s.
    surface_velocity: Vector<L>,
}

/// Sweeps over the contacts in a step. What they leave over is corrected by the next step; with 8 the scores on
/// the development captures move by less than 0.001.
const SWEEPS: usize = 2;

/// A point this near to a surface, m, is on it. Without it rounding errors would be taken for motion, and a
/// strand that lies on a head would creep by 0.05 mm a second.
const ON_SURFACE_M: f64 = 1e-5;

/// A point is looked for within as much and twice the way it would go unhindered, m; what turns faster is caught when
/// the step is done.
const MARGIN_M: f64 = 1e-4;

impl<L: Lane> Contacts<L> {
    pub fn new(strands: &[&Prepared<()>], n: usize) -> Self {
        let of = |lane: usize| strands[lane.min(strands.len() - 1)];
        let colliders = reached(strands);
        let slot = |(collider, stick): (usize, usize)| {
            let reaches = |lane: usize| {
                let p = of(lane);
                stick < p.lock.n_sticks() && p.touchable.iter().any(|t| t.collider == collider)
            };
            let borne = |lane: usize| {
                of(lane).rest.bearings.iter().find(|b| b.collider == collider && b.stick == stick)
            };
            Slot {
                clearance_m: L::from_fn(|lane| {
                    let p = of(lane);
                    if reaches(lane) {
                        p.rest.clearances_m[collider * p.lock.n_sticks() + stick]
                    } else {
                        f64::NEG_INFINITY
                    }
                }),
                push: L::from_fn(|lane| borne(lane).filter(|_| reaches(lane)).map_or(0.0, |b| b.force_n)),
                rub: Vector::zero(),
            }
        };
        let slots: Vec<_> =
            (0..n).flat_map(|stick| colliders.iter().map(move |c| (c.collider, stick))).map(slot).collect();
        Self {
            colliders,
            seen: vec![Seen::not_yet(); slots.len()],
            is_borne: vec![true; slots.len()],
            slots,
            touching: Vec::new(),
            corrections: vec![Vector::zero(); n],
        }
    }

    /// Finds the points that touch or may touch within the step, where the body is at its end.
    #[inline(always)]
    pub fn find(&mut self, work: &[Work<L>], scene: &StepScene<'_>) {
        self.touching.clear();
        if self.colliders.is_empty() {
            return;
        }
        // A surface that moves comes nearer by itself.
        let is_still = scene.head.is_none();
        for (stick, work) in work.iter().enumerate() {
            let speed = work.velocity.norm_squared().sqrt();
            let margin_m = speed.mul_add(speed.same(2.0 * scene.dt_secs), speed.same(MARGIN_M));
            for k in 0..self.colliders.len() {
                let slot = self.slot(stick, k);
                if is_still && self.seen[slot].is_far(work.end, margin_m) {
                    self.let_go(slot, margin_m);
                } else {
                    self.look((stick, k), work.end, margin_m, scene);
                }
            }
        }
    }

    /// The slot of a stick's end and the `k`-th collider.
    #[inline(always)]
    fn slot(&self, stick: usize, k: usize) -> usize {
        stick * self.colliders.len() + k
    }

    /// A point is far from a surface: nothing of what bore it is left.
    #[inline(always)]
    fn let_go(&mut self, slot: usize, like: L) {
        if self.is_borne[slot] {
            self.is_borne[slot] = false;
            let slot = &mut self.slots[slot];
            (slot.push, slot.rub) = (like.same(0.0), Vector::none(like));
        }
    }

    /// Whether a stick's end may touch one of the colliders, the `k`-th, within the step.
    #[inline(always)]
    fn look(&mut self, (stick, k): (usize, usize), place: Vector<L>, margin_m: L, scene: &StepScene<'_>) {
        let (slot, touchable) = (self.slot(stick, k), self.colliders[k]);
        let (nothing, one) = (margin_m.same(0.0), margin_m.same(1.0));
        let remembered = &mut self.slots[slot];
        let clearance_m = remembered.clearance_m;
        let surface = &scene.surfaces[touchable.collider];
        let (gap, normal) = gaps(surface, place);
        self.seen[slot] = Seen { place, room_m: room(surface, gap, clearance_m) };
        let margin_m = margin_m * margin_m.same(surface.steepness());
        let reaches = (clearance_m + margin_m).max(nothing) - gap;
        let touches = reaches.above(nothing, one, nothing);
        let touches = clearance_m.above(margin_m.same(f64::NEG_INFINITY), touches, nothing);
        remembered.push = remembered.push * touches;
        remembered.rub = remembered.rub * touches;
        if !touches.any_above(nothing) {
            return;
        }
        self.is_borne[slot] = true;
        let room_m = gap - clearance_m;
        let on_surface = margin_m.same(ON_SURFACE_M) - room_m.max(-room_m);
        let surface_velocity = scene.surface_velocity(touchable.on_torso, place);
        self.touching.push(Touch {
            slot,
            stick,
            touches,
            normal,
            room_m: on_surface.above(nothing, nothing, room_m),
            surface_velocity,
        });
    }

    /// Adds what is remembered to the forces on the points.
    #[inline(always)]
    pub fn push(&mut self, work: &mut [Work<L>]) {
        for touch in &self.touching {
            let slot = &mut self.slots[touch.slot];
            slot.rub = slot.rub.across(touch.normal);
            work[touch.stick].force += touch.normal.mul_add(slot.push, slot.rub) * touch.touches;
        }
    }

    /// Corrects the forces until no point runs into the body within the step and no friction exceeds its bound.
    #[inline(always)]
    pub fn resolve(
        &mut self,
        sticks: &[Stick<L>],
        motions: &mut [Motion<L>],
        work: &[Work<L>],
        friction: f64,
        dt_secs: f64,
    ) {
        // Farther out nothing changes.
        let Some(Touch { stick: last, .. }) = self.touching.last() else { return };
        let sticks = &sticks[..=*last];
        for _ in 0..SWEEPS {
            self.sweep(
                sticks,
                motions,
                work,
                sticks[0].length.same(friction),
                sticks[0].length.same(1.0 / dt_secs),
            );
            let mut pull = Vector::none(sticks[0].length);
            for j in (0..sticks.len()).rev() {
                pull += self.corrections[j];
                let turns = sticks[j].length * work[j].step.rate_per_torque;
                let motion = &mut motions[j];
                motion.rate = motion.direction.cross(pull).mul_add(turns, motion.rate);
            }
        }
    }

    /// From root to tip: a force at a point turns every stick before it, so the velocity that it gives the point
    /// is the sum of what it gives those sticks, which is carried along. One sweep costs no more than one step.
    #[inline(always)]
    fn sweep(
        &mut self,
        sticks: &[Stick<L>],
        motions: &[Motion<L>],
        work: &[Work<L>],
        friction: L,
        per_dt: L,
    ) {
        let mut velocity = Vector::none(friction);
        // Velocity that a force at the present point gives it within the step, (m/s)/N.
        let mut mobility = Symmetric::none(friction);
        let mut next = 0;
        for j in 0..sticks.len() {
            let (Motion { direction, rate }, length) = (motions[j], sticks[j].length);
            velocity = rate.cross(direction).mul_add(length, velocity);
            let yields = length * length * work[j].step.rate_per_torque;
            mobility.add_identity(yields);
            mobility.add_outer(direction, -yields);
            self.corrections[j] = Vector::none(friction);
            while next < self.touching.len() && self.touching[next].stick == j {
                let touch = &self.touching[next];
                let change = self.slots[touch.slot].correct(touch, velocity, &mobility, friction, per_dt);
                velocity += mobility.mul_vector(change);
                self.corrections[j] += change;
                next += 1;
            }
        }
    }

    /// Last of all: a point that is still inside is brought out by turning its stick, from root to tip.
    #[inline(always)]
    pub fn keep_outside(
        &self,
        root: Vector<L>,
        sticks: &[Stick<L>],
        motions: &mut [Motion<L>],
        scene: &StepScene<'_>,
    ) {
        if self.colliders.is_empty() {
            return;
        }
        let nothing = root.x.same(0.0);
        let mut near = root;
        for (stick, Motion { direction, rate }) in motions.iter_mut().enumerate() {
            let length = sticks[stick].length;
            for _ in 0..MAX_PUSHES {
                let (out, deepest) = self.way_out(direction.mul_add(length, near), stick, scene);
                let inside = deepest.above(root.x.same(ON_SURFACE_M), root.x.same(1.0), nothing);
                if !inside.any_above(nothing) {
                    break;
                }
                let turned = direction.mul_add(length, out).normalized();
                *direction = Vector::where_above(inside, nothing, turned, *direction);
                *rate = Vector::where_above(inside, nothing, rate.across(*direction), *rate);
            }
            near = direction.mul_add(length, near);
        }
    }

    /// How far and where a point must go to leave the collider it is in deepest, and how deep that is, m.
    #[inline(always)]
    fn way_out(&self, point: Vector<L>, stick: usize, scene: &StepScene<'_>) -> (Vector<L>, L) {
        let (mut out, mut deepest) = (Vector::none(point.x), point.x.same(ON_SURFACE_M));
        for (k, touchable) in self.colliders.iter().enumerate() {
            let slot = self.slot(stick, k);
            if self.seen[slot].is_far(point, point.x.same(0.0)) {
                continue;
            }
            let (gap, normal) = gaps(&scene.surfaces[touchable.collider], point);
            let depth = self.slots[slot].clearance_m - gap;
            out = Vector::where_above(depth, deepest, normal * depth, out);
            deepest = deepest.max(depth);
        }
        (out, deepest)
    }
}

/// Pushes that a point may get in a step. Each is followed by a turn that keeps the stick's length, so some depth
/// remains where the stick points into the surface: less than a tenth of it after each push.
const MAX_PUSHES: usize = 8;

/// How far a point goes along a direction for each newton, times the square of the direction's length.
#[inline(always)]
fn yields<L: Lane>(mobility: &Symmetric<L>, along: Vector<L>) -> L {
    along.dot(mobility.mul_vector(along)).max(along.x.same(1e-30))
}

impl<L: Lane> Slot<L> {
    /// The change of force that keeps the point out and rubs it, N.
    #[inline(always)]
    fn correct(
        &mut self,
        touch: &Touch<L>,
        velocity: Vector<L>,
        mobility: &Symmetric<L>,
        friction: L,
        per_dt: L,
    ) -> Vector<L> {
        let tiny = friction.same(1e-30);
        let normal = touch.normal;
        let before = normal.mul_add(self.push, self.rub);
        let approach = touch.room_m.mul_add(per_dt, velocity.dot(normal));
        if !self.push.any_above(friction.same(0.0)) && !friction.same(0.0).any_above(approach) {
            // Nothing pushes, and nothing comes so near that it has to.
            return Vector::none(friction);
        }
        let push = (self.push - approach / yields(mobility, normal)).max(friction.same(0.0));
        // Nothing is done about what is not finite, nor for a strand that does not touch.
        let done = friction.same(f64::from(f32::MAX)).above(push, touch.touches, friction.same(0.0));
        let sliding =
            velocity + mobility.mul_vector(normal.mul_add(push, self.rub) - before) - touch.surface_velocity;
        let sliding = sliding.across(normal);
        // What would hold it, opposite to the sliding, but no more than twice what friction can do.
        let speed2 = sliding.norm_squared();
        let bound = friction * push;
        let holds = (speed2 / yields(mobility, sliding)).min((bound + bound) * speed2.max(tiny).per_sqrt());
        let mut rub = self.rub - sliding * holds;
        rub = rub * (bound * rub.norm_squared().max(tiny).per_sqrt()).min(friction.same(1.0));
        self.push = done.above(friction.same(0.0), push, self.push);
        self.rub = Vector::where_above(done, friction.same(0.0), rub, self.rub);
        let after = normal.mul_add(self.push, self.rub);
        Vector::where_above(done, friction.same(0.0), after - before, Vector::none(friction))
    }
}
