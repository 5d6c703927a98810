use super::PaperStrand;
use nalgebra::UnitQuaternion;
use tousle_core::Vec3;
use tousle_rod::{shortest_rotation, shortest_turn};

impl PaperStrand {
    /// τ (Φ − Φ0) of E1, and the hair's internal damping: what each joint does to the stick that hangs on it.
    ///
    /// Φ is the turn from where the stick before carries this one's rest direction. τ Φ0 is what the joint holds
    /// at rest; kept as a torque it needs no bound on Φ0, which for soft hair is many turns. The axes that carry
    /// it are turned along the strand by the shortest way, so a lock may roll but stores no twist.
    pub(super) fn bend(&mut self) {
        let lock = &self.lock;
        let mut before = UnitQuaternion::identity();
        let mut rate_before = Vec3::zeros();
        for j in 0..lock.n_sticks() {
            let direction = self.directions[j];
            let carried = before * lock.rest_directions[j];
            let angles = shortest_turn(carried, direction);
            let stiffness = lock.joint_stiffness[j];
            let damping = (self.rates[j] - rate_before) * (stiffness * lock.damping_secs);
            let torque = before * self.rest_torques[j] - angles * stiffness - damping;
            self.work.bending_torques[j] = torque - direction * direction.dot(&torque);
            before = shortest_rotation(carried, direction) * before;
            self.work.carried[j] = before;
            rate_before = self.rates[j];
        }
    }
}
