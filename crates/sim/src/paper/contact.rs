use crate::joint::JointStep;
use crate::timeline::StepScene;
use nalgebra::Matrix3;
use tousle_core::Vec3;
use tousle_rod::{Lock, Rest};

/// A collider that a strand can reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Touchable {
    /// Index in the body.
    pub collider: usize,
}

/// Ψ of E2: what the body does to the points it touches, found so that they stay outside.
///
/// A force is remembered from step to step. It acts with all others on the joints, and is then corrected by what
/// the joints' new rates still lack: at rest nothing is lacking, and what bears a strand bears it for ever.
#[derive(Debug)]
pub(super) struct Contacts {
    /// One slot a collider and point, collider after collider.
    slots: Vec<Slot>,
    colliders: Vec<usize>,
    /// Slots in touch, ordered from the root.
    touching: Vec<Touch>,
    /// Sum of the corrections at each point, N.
    corrections: Vec<Vec3>,
    friction: f64,
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
    /// Velocity of the surface along itself, m/s.
    surface_velocity: Vec3,
}

const SLOP_M: f64 = 1e-5;
/// Passes over the contacts in a step. What one pass leaves is corrected by the next step.
const SWEEPS: usize = 2;

impl Contacts {
    pub fn new(rest: &Rest, touchable: &[Touchable], n: usize) -> Self {
        let colliders: Vec<usize> = touchable.iter().map(|t| t.collider).collect();
        let mut slots: Vec<Slot> = colliders
            .iter()
            .flat_map(|c| &rest.clearances_m[c * n..(c + 1) * n])
            .map(|clearance| Slot { clearance_m: *clearance, push: 0.0, rub: Vec3::zeros() })
            .collect();
        for bearing in &rest.bearings {
            if let Some(place) = colliders.iter().position(|c| *c == bearing.collider) {
                slots[place * n + bearing.stick].push = bearing.force_n;
            }
        }
        let corrections = if colliders.is_empty() { Vec::new() } else { vec![Vec3::zeros(); n] };
        Self { slots, colliders, touching: Vec::new(), corrections, friction: 0.25 }
    }

    /// Finds the points that touch or may touch within the step, where the body is at its end.
    pub fn find(&mut self, ends_m: &[Vec3], velocities: &[Vec3], scene: &StepScene<'_>) {
        self.touching.clear();
        if self.colliders.is_empty() {
            return;
        }
        let n = ends_m.len();
        for stick in 0..n {
            let end = ends_m[stick];
            // Twice the way it would go unhindered; what turns faster is caught when the step is done.
            let margin_m = 2.0 * velocities[stick].norm() * scene.dt_secs + 1e-4;
            for (place, collider) in self.colliders.iter().enumerate() {
                let slot = place * n + stick;
                let remembered = &mut self.slots[slot];
                let limit_m = f64::max(remembered.clearance_m + margin_m, 0.0);
                let Some(gap) = scene.surfaces[*collider].gap_within(end, limit_m) else {
                    remembered.push = 0.0;
                    remembered.rub = Vec3::zeros();
                    continue;
                };
                let room_m = gap.distance_m - remembered.clearance_m;
                let room_m = if room_m.abs() < SLOP_M { 0.0 } else { room_m };
                let surface_velocity = Vec3::zeros();
                self.touching.push(Touch { slot, stick, normal: gap.normal, room_m, surface_velocity });
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

    /// Corrects the forces until no point runs into the body within the step, and no friction exceeds its bound.
    ///
    /// From root to tip: a force at a point turns every stick before it, so the velocity it gives the point is
    /// the sum of what it gives those sticks, which is carried along.
    pub fn resolve(
        &mut self,
        lock: &Lock,
        directions: &[Vec3],
        steps: &[JointStep],
        rates: &mut [Vec3],
        scene: &StepScene<'_>,
    ) {
        if self.touching.is_empty() {
            return;
        }
        for _ in 0..SWEEPS {
            self.sweep(lock, directions, steps, rates, scene.dt_secs);
            let mut pull = Vec3::zeros();
            for j in (0..lock.n_sticks()).rev() {
                pull += self.corrections[j];
                let torque = directions[j].cross(&pull) * lock.lengths_m[j];
                rates[j] += torque * steps[j].rate_per_torque;
            }
        }
    }

    fn sweep(&mut self, lock: &Lock, directions: &[Vec3], steps: &[JointStep], rates: &[Vec3], dt_secs: f64) {
        let mut velocity = Vec3::zeros();
        // Velocity that a force at the present point gives it within the step, (m/s)/N.
        let mut mobility = Matrix3::zeros();
        let mut touching = self.touching.iter().peekable();
        for j in 0..lock.n_sticks() {
            let (direction, length) = (directions[j], lock.lengths_m[j]);
            velocity += rates[j].cross(&direction) * length;
            mobility += (Matrix3::identity() - direction * direction.transpose())
                * (length * length * steps[j].rate_per_torque);
            self.corrections[j] = Vec3::zeros();
            while let Some(touch) = touching.next_if(|t| t.stick == j) {
                let slot = &mut self.slots[touch.slot];
                let correction = slot.correct(touch, velocity, &mobility, dt_secs, self.friction);
                velocity += mobility * correction;
                self.corrections[j] += correction;
            }
        }
    }

    /// Last of all: a point that is still inside is brought out by turning its stick, from root to tip.
    pub fn keep_outside(&self, lock: &Lock, directions: &mut [Vec3], scene: &StepScene<'_>) {
        if self.colliders.is_empty() {
            return;
        }
        let n = lock.n_sticks();
        let mut near = lock.root_m;
        for (j, (direction, length)) in directions.iter_mut().zip(&lock.lengths_m).enumerate() {
            let mut far = near + *direction * *length;
            for _ in 0..3 {
                let mut moved = false;
                for (place, collider) in self.colliders.iter().enumerate() {
                    let clearance_m = self.slots[place * n + j].clearance_m;
                    let gap = scene.surfaces[*collider].gap_within(far, f64::max(clearance_m, 0.0));
                    let Some(gap) = gap else { continue };
                    let depth = clearance_m - gap.distance_m;
                    if depth > SLOP_M {
                        let out = far + gap.normal * depth - near;
                        *direction = out.normalize();
                        far = near + *direction * *length;
                        moved = true;
                    }
                }
                if !moved {
                    break;
                }
            }
            near = far;
        }
    }
}

impl Slot {
    /// The change of force that keeps the point out and rubs it, N.
    fn correct(
        &mut self,
        touch: &Touch,
        velocity: Vec3,
        mobility: &Matrix3<f64>,
        dt_secs: f64,
        friction: f64,
    ) -> Vec3 {
        let normal = touch.normal;
        let before = normal * self.push + self.rub;
        let yields = normal.dot(&(mobility * normal));
        if yields <= 0.0 {
            return Vec3::zeros();
        }
        let approach = velocity.dot(&normal) + touch.room_m / dt_secs;
        self.push = f64::max(self.push - approach / yields, 0.0);
        let moved = velocity + mobility * (normal * self.push + self.rub - before);
        let sliding = moved - touch.surface_velocity;
        let sliding = sliding - normal * normal.dot(&sliding);
        let speed = sliding.norm();
        let bound = friction * self.push;
        if speed > 0.0 {
            let along = sliding / speed;
            let yields = along.dot(&(mobility * along));
            if yields > 0.0 {
                self.rub -= along * (speed / yields);
            }
        }
        let rub = self.rub.norm();
        if rub > bound {
            self.rub *= bound / rub;
        }
        normal * self.push + self.rub - before
    }
}
