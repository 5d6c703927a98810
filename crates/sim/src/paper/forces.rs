use super::{PaperModel, PaperStrand};
use crate::timeline::StepScene;
use tousle_core::{Quantity, Vec3};

impl PaperStrand {
    /// g and Ξ of E2: gravity turned into head axes, and the inertia of a head that speeds up or turns.
    pub(super) fn weigh(&mut self, model: &PaperModel, scene: &StepScene<'_>) {
        let work = &mut self.work;
        let head = scene.head.filter(|_| model.terms.head_movement);
        let Some(head) = head else {
            for (force, mass) in work.forces.iter_mut().zip(&self.lock.masses_kg) {
                *force = scene.gravity * *mass;
            }
            return;
        };
        for j in 0..work.forces.len() {
            let point = work.ends_m[j];
            let turning = head.angular_velocity;
            let acceleration = head.acceleration
                + head.angular_acceleration.cross(&point)
                + turning.cross(&turning.cross(&point));
            work.forces[j] = (scene.gravity - acceleration) * self.lock.masses_kg[j];
            // Coriolis' force turns a stick's rate about the stick and changes nothing else of it. Turning the
            // rate by that angle is exact for a stick alone and keeps its energy for every step.
            let direction = self.directions[j];
            let (sin, cos) = libm::sincos(-2.0 * turning.dot(&direction) * scene.dt_secs);
            self.rates[j] = self.rates[j] * cos + direction.cross(&self.rates[j]) * sin;
        }
    }

    /// Ω of E2, and what I2 stands for: the air's push on each stick, half to each of its ends.
    ///
    /// Air velocity acts through the drag law, less the strand's own velocity. A force per mass acts as it is;
    /// the resistance that the air then offers is that of the wind whose push across the stick it would be.
    pub(super) fn blow(&mut self, model: &PaperModel, scene: &StepScene<'_>) {
        let n = self.lock.n_sticks();
        self.work.air_resistances.fill(0.0);
        self.work.air_forces.fill(Vec3::zeros());
        let mut near = self.lock.root_m;
        let mut near_velocity = Vec3::zeros();
        for j in 0..n {
            let (far, far_velocity) = (self.work.ends_m[j], self.work.velocities[j]);
            let middle = (near + far) * 0.5;
            let velocity = (near_velocity + far_velocity) * 0.5;
            self.blow_stick(model, scene, j, middle, velocity);
            (near, near_velocity) = (far, far_velocity);
        }
    }

    fn blow_stick(
        &mut self,
        model: &PaperModel,
        scene: &StepScene<'_>,
        j: usize,
        middle: Vec3,
        velocity: Vec3,
    ) {
        let direction = self.directions[j];
        let width = self.lock.width_m;
        let length = self.lock.hair_lengths_m[j];
        let vector = scene.wind.map_or_else(Vec3::zeros, |wind| wind.sample(middle));
        let head_velocity = scene.head.map_or_else(Vec3::zeros, |head| head.velocity_of(middle));
        let (wind, along_push) = match model.terms.quantity {
            Quantity::AirVelocity => (vector - head_velocity, Vec3::zeros()),
            Quantity::ForcePerMass => {
                let push = vector * self.lock.linear_density_kg_per_m;
                let along = direction * direction.dot(&push);
                let across = push - along;
                let strength = across.norm();
                let speed = model.drag.speed_across(width, strength);
                let wind = if strength > 0.0 { across * (speed / strength) } else { Vec3::zeros() };
                (wind, along)
            }
        };
        let drag = model.drag.at(width, direction, wind - velocity);
        let force = (drag.force + along_push) * length;
        let resisted = drag.change(direction, velocity) * length;
        // Twice the resistance across is what a motion along the wind meets: no direction meets more.
        let resistance = 2.0 * drag.across * length;
        for end in [j.checked_sub(1), Some(j)].into_iter().flatten() {
            self.work.forces[end] += force * 0.5;
            self.work.air_forces[end] += resisted * 0.5;
            self.work.air_resistances[end] += resistance * 0.5;
        }
    }
}
