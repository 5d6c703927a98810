use super::{AirOnStick, PaperModel, PaperStrand};
use crate::timeline::StepScene;
use nalgebra::Matrix3;
use tousle_core::{HeadMotion, Quantity, Vec3};

impl PaperStrand {
    /// g and Ξ of E2: gravity turned into head axes, and the inertia of a head that speeds up or turns.
    pub(super) fn weigh(&mut self, scene: &StepScene<'_>) {
        for (force, mass) in self.work.forces.iter_mut().zip(&self.lock.masses_kg) {
            *force = scene.gravity * *mass;
        }
        if let Some(head) = &scene.head {
            self.move_head(head, scene.dt_secs);
        }
    }

    fn move_head(&mut self, head: &HeadMotion, dt_secs: f64) {
        let turning = head.angular_velocity;
        for (j, force) in self.work.forces.iter_mut().enumerate() {
            let point = self.work.ends_m[j];
            let acceleration = head.acceleration
                + head.angular_acceleration.cross(&point)
                + turning.cross(&turning.cross(&point));
            *force -= acceleration * self.lock.masses_kg[j];
            // Coriolis' force on a stick turns its rate about the stick and changes nothing else of it. To turn
            // the rate by that angle is exact for a stick alone and keeps its energy for every step.
            let direction = self.directions[j];
            let (sin, cos) = libm::sincos(-2.0 * turning.dot(&direction) * dt_secs);
            self.rates[j] = self.rates[j] * cos + direction.cross(&self.rates[j]) * sin;
        }
    }

    /// Ω of E2, and what I2 stands for: the air's push on each stick, half of it at either end.
    pub(super) fn blow(&mut self, model: &PaperModel, scene: &StepScene<'_>) {
        let mut near = self.lock.root_m;
        let mut near_velocity = Vec3::zeros();
        for j in 0..self.lock.n_sticks() {
            let (far, far_velocity) = (self.work.ends_m[j], self.work.velocities[j]);
            let middle = (near + far) * 0.5;
            let air = self.air_on_stick(model, scene, j, middle, (near_velocity + far_velocity) * 0.5);
            self.work.forces[j] += air.force * 0.5;
            if j > 0 {
                self.work.forces[j - 1] += air.force * 0.5;
            }
            self.work.air[j] = air;
            (near, near_velocity) = (far, far_velocity);
        }
    }

    /// Air velocity acts through the drag law, less the strand's own velocity. A force per mass acts as it is;
    /// the resistance that the air then offers is that of the wind whose push across the stick it would be.
    fn air_on_stick(
        &self,
        model: &PaperModel,
        scene: &StepScene<'_>,
        j: usize,
        middle: Vec3,
        velocity: Vec3,
    ) -> AirOnStick {
        let direction = self.directions[j];
        let lock = &self.lock;
        let vector = scene.wind.map_or_else(Vec3::zeros, |wind| wind.sample(middle));
        let (wind, push) = match model.terms.quantity {
            Quantity::AirVelocity => {
                let head = scene.head.map_or_else(Vec3::zeros, |head| head.velocity_of(middle));
                (vector - head, Vec3::zeros())
            }
            Quantity::ForcePerMass => {
                let push = vector * lock.linear_densities_kg_per_m[j];
                model.wind_that_pushes(push, direction, lock.widths_m[j])
            }
        };
        let drag = model.drag.at(lock.widths_m[j], direction, wind - velocity);
        let length = lock.hair_lengths_m[j];
        let outer = |a: Vec3| a * a.transpose();
        let along = outer(direction);
        let across = Matrix3::identity() - along + outer(drag.direction);
        AirOnStick {
            force: (drag.force + push) * length,
            resisted: drag.change(direction, velocity) * length,
            resistance: (across * drag.across + along * drag.along) * length,
            // Twice the resistance across is what a motion along the wind meets; along the stick it is less.
            most: f64::max(2.0 * drag.across, drag.along) * length,
        }
    }
}

impl PaperModel {
    /// The wind across a stick whose push on it is the part across of this force per length, N/m; and the rest.
    fn wind_that_pushes(&self, push: Vec3, direction: Vec3, width_m: f64) -> (Vec3, Vec3) {
        let along = direction * direction.dot(&push);
        let across = push - along;
        let strength = across.norm();
        if !self.terms.air || strength == 0.0 {
            return (Vec3::zeros(), push);
        }
        (across * (self.drag.speed_across(width_m, strength) / strength), along)
    }
}
