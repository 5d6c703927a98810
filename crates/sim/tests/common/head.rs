//! Heads that move, and what measures hair on them.

use super::{DOWN, vacuum};
use tousle_core::{Pose, PoseTrack, StrandMotion, Vec3};
use tousle_field::Scene;

/// A head's poses from a second before the start on.
pub fn head(rate_hz: f64, pose: impl Fn(f64) -> Pose) -> PoseTrack {
    let poses = (0..=(3.5 * rate_hz) as usize).map(|k| pose(k as f64 / rate_hz - 1.0)).collect();
    PoseTrack { start_secs: -1.0, rate_hz, poses }
}

/// A still head, tilted by an angle about y since the strands were at rest: they are released from there.
pub fn tilted(angle: f64) -> Scene {
    let turn = nalgebra::UnitQuaternion::from_scaled_axis(Vec3::y() * angle);
    Scene { poses: PoseTrack::still(Pose::from_parts(Vec3::zeros().into(), turn)), ..vacuum(DOWN) }
}

pub fn turned_about_z(angle: f64) -> Pose {
    let turn = nalgebra::UnitQuaternion::from_scaled_axis(Vec3::z() * angle);
    Pose::from_parts(Vec3::zeros().into(), turn)
}

/// A head without gravity that turns about z by 1.5 rad, from the start on for a second, without a jolt; and by how much it has
/// turned then.
pub fn turning() -> (Scene, f64) {
    use core::f64::consts::TAU;
    let angle = |t: f64| 1.5 * (t.clamp(0.0, 1.0) - libm::sin(TAU * t.clamp(0.0, 1.0)) / TAU);
    let poses = head(240.0, |t| turned_about_z(angle(t)));
    (Scene { poses, ..vacuum(Vec3::zeros()) }, angle(1.0))
}

/// A head that speeds up evenly, all the time; at the start it stands.
pub fn speeding_up(acceleration: Vec3) -> Scene {
    let poses = head(240.0, |t| {
        let way = acceleration * (0.5 * t * t);
        Pose::translation(way.x, way.y, way.z)
    });
    Scene { poses, ..vacuum(DOWN) }
}

/// Times at which a signal passes its level upwards, s, linear between frames.
pub fn rises(signal: &[f64], level: f64, rate_hz: f64) -> Vec<f64> {
    (0..signal.len() - 1)
        .filter(|&k| signal[k] <= level && signal[k + 1] > level)
        .map(|k| (k as f64 + (level - signal[k]) / (signal[k + 1] - signal[k])) / rate_hz)
        .collect()
}

/// How far apart the points of two motions are at most, m.
pub fn apart(one: &StrandMotion, other: &StrandMotion) -> f64 {
    let [a, b] = [one, other].map(|motion| motion.positions_m.iter().map(|p| Vec3::from(p.map(f64::from))));
    a.zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}
