use super::PaperStrand;
use nalgebra::UnitQuaternion;
use tousle_core::Vec3;
use tousle_rod::{shortest_rotation, shortest_turn};

impl PaperStrand {
    /// τ (Φ0 − Φ) of E1, and the hair's internal damping: what each joint does to the stick that hangs on it.
    ///
    /// Φ is the turn from where the stick before carries this one's rest direction. τ Φ0 is what the joint holds
    /// at rest; kept as a torque it needs no bound on Φ0, which for soft hair is many turns. The axes that carry
    /// it are turned along the strand by the shortest way, so a lock may roll but stores no twist.
    pub(super) fn bend(&mut self) {
        let lock = &self.lock;
        let mut axes = UnitQuaternion::identity();
        let mut rate_before = Vec3::zeros();
        for (j, torque) in self.work.bending_torques.iter_mut().enumerate() {
            let direction = self.directions[j];
            let carried = axes * lock.rest_directions[j];
            let angles = shortest_turn(carried, direction);
            let stiffness = lock.joint_stiffness[j];
            let bent = angles + (self.rates[j] - rate_before) * lock.damping_secs;
            *torque = axes * self.rest_torques[j] - bent * stiffness;
            *torque -= direction * direction.dot(torque);
            axes = shortest_rotation(carried, direction) * axes;
            rate_before = self.rates[j];
        }
    }
}
