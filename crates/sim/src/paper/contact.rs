use super::PaperModel;
use crate::joint::JointStep;
use crate::timeline::StepScene;
use crate::touchable::Touchable;
use nalgebra::Matrix3;
use tousle_core::Vec3;
use tousle_rod::{Lock, Rest};

/// Ψ of E2: what the body does to the points it touches, found so that they stay outside.
///
/// A force is remembered from step to step. It acts on the joints with all others, and is then corrected by what
/// the joints' new rates still lack: at rest nothing is lacking, and what bears a strand bears it for ever.
#[derive(Clone, Debug)]
pub(super) struct Contacts {
    touchable: Vec<Touchable>,
    /// One slot a touchable collider and point, collider after collider.
    slots: Vec<Slot>,
    /// What touches in this step, ordered from the root.
    touching: Vec<Touch>,
    /// What a sweep adds to the force on each point, N.
    corrections: Vec<Vec3>,
}

/// What is remembered of a collider and a point.
#[derive(Clone, Copy, Debug)]
struct Slot {
    /// How near the point may come, m.
    clearance_m: f64,
    /// Force outwards, N, ≥ 0.
    push: f64,
    /// Friction along the surface, N.
    rub: Vec3,
}

#[derive(Clone, Copy, Debug)]
struct Touch {
    slot: usize,
    stick: usize,
    normal: Vec3,
    /// How far the point still is from where it may not go, m; negative beyond.
    room_m: f64,
    /// Velocity of the surface in head space, m/s.
    surface_velocity: Vec3,
}

/// Sweeps over the contacts in a step. What they leave over is corrected by the next step; with 8 the scores on
/// the development captures move by less than 0.001.
const SWEEPS: usize = 2;

/// A point this near to a surface, m, is on it. Without it rounding errors would be taken for motion, and a
/// strand that lies on a head would creep by 0.05 mm a second.
const ON_SURFACE_M: f64 = 1e-5;

impl Contacts {
    pub fn new(rest: &Rest, touchable: &[Touchable], n: usize) -> Self {
        let mut slots: Vec<Slot> = touchable
            .iter()
            .flat_map(|t| &rest.clearances_m[t.collider * n..(t.collider + 1) * n])
            .map(|clearance| Slot { clearance_m: *clearance, push: 0.0, rub: Vec3::zeros() })
            .collect();
        for bearing in &rest.bearings {
            if let Some(place) = touchable.iter().position(|t| t.collider == bearing.collider) {
                slots[place * n + bearing.stick].push = bearing.force_n;
            }
        }
        let corrections = if touchable.is_empty() { Vec::new() } else { vec![Vec3::zeros(); n] };
        Self { touchable: touchable.to_vec(), slots, touching: Vec::new(), corrections }
    }

    /// Finds the points that touch or may touch within the step, where the body is at its end.
    pub fn find(&mut self, ends_m: &[Vec3], velocities: &[Vec3], scene: &StepScene<'_>) {
        self.touching.clear();
        if self.touchable.is_empty() {
            return;
        }
        let n = ends_m.len();
        for (stick, (end, velocity)) in ends_m.iter().zip(velocities).enumerate() {
            // Twice the way it would go unhindered; what turns faster is caught when the step is done.
            let margin_m = 2.0 * velocity.norm() * scene.dt_secs + 1e-4;
            for (place, touchable) in self.touchable.iter().enumerate() {
                let slot = place * n + stick;
                let remembered = &mut self.slots[slot];
                let limit_m = f64::max(remembered.clearance_m + margin_m, 0.0);
                let Some(gap) = scene.surfaces[touchable.collider].gap_within(*end, limit_m) else {
                    remembered.push = 0.0;
                    remembered.rub = Vec3::zeros();
                    continue;
                };
                let room_m = gap.distance_m - remembered.clearance_m;
                self.touching.push(Touch {
                    slot,
                    stick,
                    normal: gap.normal,
                    room_m: if room_m.abs() < ON_SURFACE_M { 0.0 } else { room_m },
                    surface_velocity: scene.surface_velocity(touchable.on_torso, *end),
                });
            }
        }
    }

    /// Adds what is remembered to the forces on the points.
    pub fn push(&mut self, forces: &mut [Vec3]) {
        for touch in &self.touching {
            let slot = &mut self.slots[touch.slot];
            slot.rub -= touch.normal * touch.normal.dot(&slot.rub);
            forces[touch.stick] += touch.normal * slot.push + slot.rub;
        }
    }

    /// Corrects the forces until no point runs into the body within the step and no friction exceeds its bound.
    pub fn resolve(
        &mut self,
        lock: &Lock,
        directions: &[Vec3],
        steps: &[JointStep],
        rates: &mut [Vec3],
        model: &PaperModel,
        dt_secs: f64,
    ) {
        if self.touching.is_empty() {
            return;
        }
        for _ in 0..SWEEPS {
            self.sweep(lock, directions, steps, rates, model.friction, dt_secs);
            let mut pull = Vec3::zeros();
            for j in (0..lock.n_sticks()).rev() {
                pull += self.corrections[j];
                rates[j] += directions[j].cross(&pull) * (lock.lengths_m[j] * steps[j].rate_per_torque);
            }
        }
    }

    /// From root to tip: a force at a point turns every stick before it, so the velocity that it gives the point
    /// is the sum of what it gives those sticks, which is carried along. One sweep costs no more than one step.
    fn sweep(
        &mut self,
        lock: &Lock,
        directions: &[Vec3],
        steps: &[JointStep],
        rates: &[Vec3],
        friction: f64,
        dt_secs: f64,
    ) {
        let mut velocity = Vec3::zeros();
        // Velocity that a force at the present point gives it within the step, (m/s)/N.
        let mut mobility = Matrix3::zeros();
        let mut touching = self.touching.iter().peekable();
        for (j, correction) in self.corrections.iter_mut().enumerate() {
            let (direction, length) = (directions[j], lock.lengths_m[j]);
            velocity += rates[j].cross(&direction) * length;
            mobility += (Matrix3::identity() - direction * direction.transpose())
                * (length * length * steps[j].rate_per_torque);
            *correction = Vec3::zeros();
            while let Some(touch) = touching.next_if(|t| t.stick == j) {
                let change = self.slots[touch.slot].correct(touch, velocity, &mobility, friction, dt_secs);
                velocity += mobility * change;
                *correction += change;
            }
        }
    }

    /// Last of all: a point that is still inside is brought out by turning its stick, from root to tip.
    pub fn keep_outside(&self, lock: &Lock, directions: &mut [Vec3], scene: &StepScene<'_>) {
        if self.touchable.is_empty() {
            return;
        }
        let mut near = lock.root_m;
        for (j, direction) in directions.iter_mut().enumerate() {
            let length = lock.lengths_m[j];
            for _ in 0..MAX_PUSHES {
                let Some(out) = self.way_out(near + *direction * length, j, lock.n_sticks(), scene) else {
                    break;
                };
                *direction = (*direction * length + out).normalize();
            }
            near += *direction * length;
        }
    }

    /// How far and where a point must go to leave the collider it is in deepest; `None` if it is in none.
    fn way_out(&self, point_m: Vec3, stick: usize, n: usize, scene: &StepScene<'_>) -> Option<Vec3> {
        let mut deepest = ON_SURFACE_M;
        let mut out = None;
        for (place, touchable) in self.touchable.iter().enumerate() {
            let clearance_m = self.slots[place * n + stick].clearance_m;
            let gap = scene.surfaces[touchable.collider].gap_within(point_m, f64::max(clearance_m, 0.0));
            let depth = gap.map_or(0.0, |gap| clearance_m - gap.distance_m);
            if let Some(gap) = gap.filter(|_| depth > deepest) {
                deepest = depth;
                out = Some(gap.normal * depth);
            }
        }
        out
    }
}

/// Pushes that a point may get in a step. Each is followed by a turn that keeps the stick's length, so some depth
/// remains where the stick points into the surface: less than a tenth of it after each push.
const MAX_PUSHES: usize = 8;

impl Slot {
    /// The change of force that keeps the point out and rubs it, N.
    fn correct(
        &mut self,
        touch: &Touch,
        velocity: Vec3,
        mobility: &Matrix3<f64>,
        friction: f64,
        dt_secs: f64,
    ) -> Vec3 {
        let normal = touch.normal;
        let before = normal * self.push + self.rub;
        // How far the point goes along the normal or along the surface for each newton.
        let yields = |along: Vec3| along.dot(&(mobility * along)).max(f64::MIN_POSITIVE);
        let approach = velocity.dot(&normal) + touch.room_m / dt_secs;
        let push = f64::max(self.push - approach / yields(normal), 0.0);
        if !push.is_finite() {
            return Vec3::zeros();
        }
        self.push = push;
        let sliding = velocity + mobility * (normal * self.push + self.rub - before) - touch.surface_velocity;
        let sliding = sliding - normal * normal.dot(&sliding);
        let speed = sliding.norm();
        if speed > 0.0 {
            let along = sliding / speed;
            self.rub -= along * (speed / yields(along)).min(2.0 * friction * push);
        }
        let bound = friction * self.push;
        let rub = self.rub.norm();
        if rub > bound {
            self.rub *= bound / rub;
        }
        normal * self.push + self.rub - before
    }
}
