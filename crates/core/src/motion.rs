use crate::{Pose, Vec3};
use core::ops::Range;
use nalgebra::{Matrix3, UnitQuaternion};

/// The simulated motion of a groom, head space.
#[derive(Clone, Debug, PartialEq)]
pub struct StrandMotion {
    /// Control points of each strand.
    pub counts: Vec<usize>,
    /// Time of each frame, s.
    pub times_secs: Vec<f64>,
    /// Positions, head space, m: frame after frame, strand after strand, root first.
    pub positions_m: Vec<[f32; 3]>,
}

impl StrandMotion {
    /// Control points of all strands.
    pub fn n_points(&self) -> usize {
        self.counts.iter().sum()
    }

    /// All control points of one frame.
    ///
    /// # Panics
    /// If `frame` is past the end.
    pub fn frame(&self, frame: usize) -> &[[f32; 3]] {
        let n = self.n_points();
        &self.positions_m[frame * n..(frame + 1) * n]
    }

    /// The control points of one strand in one frame.
    ///
    /// # Panics
    /// If `frame` or `strand_idx` is past the end.
    pub fn strand(&self, frame: usize, strand_idx: usize) -> &[[f32; 3]] {
        &self.frame(frame)[self.points_of(strand_idx)]
    }

    /// Where the control points of one strand are within a frame. It costs a look at all strands before, as a frame does one
    /// at all: who goes through many asks once.
    ///
    /// # Panics
    /// If `strand_idx` is past the end.
    pub fn points_of(&self, strand_idx: usize) -> Range<usize> {
        let first: usize = self.counts[..strand_idx].iter().sum();
        first..first + self.counts[strand_idx]
    }
}

/// The head's pose over time, evenly spaced: `world_from_head`.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseTrack {
    /// Time of the first pose, s.
    pub start_secs: f64,
    /// Poses a second.
    pub rate_hz: f64,
    /// Head space to world space; at least one.
    pub poses: Vec<Pose>,
}

/// How the head moves at one time. Vectors in head axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadMotion {
    /// Head space to world space.
    pub world_from_head: Pose,
    /// Velocity of the head's center over the ground, m/s.
    pub velocity: Vec3,
    /// Acceleration of the head's center, m/s².
    pub acceleration: Vec3,
    /// Angular velocity, rad/s.
    pub angular_velocity: Vec3,
    /// Angular acceleration, rad/s².
    pub angular_acceleration: Vec3,
}

impl PoseTrack {
    /// A head that never moves.
    pub fn still(world_from_head: Pose) -> Self {
        Self { start_secs: 0.0, rate_hz: 1.0, poses: vec![world_from_head] }
    }

    /// Time of the last pose, s.
    pub fn end_secs(&self) -> f64 {
        self.start_secs + (self.poses.len().max(1) - 1) as f64 / self.rate_hz
    }

    /// Whether no pose differs from the first.
    pub fn is_still(&self) -> bool {
        self.poses.iter().all(|p| *p == self.poses[0])
    }

    /// Whether the shot was cut at a time after `from_secs` and no later than `to_secs`: the head then is, from one pose to the
    /// next, where nothing that moves could have taken it.
    ///
    /// That is where the velocity from one pose to the next differs, by more than 20 m/s or 50 rad/s, from both that before and that
    /// after. So neither a head that goes fast (in a car), nor one that is stopped or set going, is cut. A cut takes place at the
    /// pose after it.
    pub fn is_cut_within(&self, from_secs: f64, to_secs: f64) -> bool {
        let place = |secs: f64| ((secs - self.start_secs) * self.rate_hz).floor();
        // Poses after the first whose time is within.
        let first = f64::max(place(from_secs) + 1.0, 1.0);
        let last = f64::min(place(to_secs), self.poses.len() as f64 - 1.0);
        last >= first && (first as usize..=last as usize).any(|pose| self.is_cut_before(pose))
    }

    /// Whether there is a cut between a pose and the one before.
    fn is_cut_before(&self, pose: usize) -> bool {
        let way = |pose: usize| {
            let (before, now) = (self.poses.get(pose.checked_sub(1)?)?, self.poses.get(pose)?);
            Some((
                now.translation.vector - before.translation.vector,
                before.rotation.inverse() * now.rotation,
            ))
        };
        let Some((moved, turned)) = way(pose) else { return false };
        let is_like = |(other_moved, other_turned): (Vec3, UnitQuaternion<f64>)| {
            (moved - other_moved).norm() * self.rate_hz <= CUT_MPS
                && turned.angle_to(&other_turned) * self.rate_hz <= CUT_RAD_PER_SEC
        };
        let neighbors = [pose.checked_sub(1).and_then(way), way(pose + 1)];
        // Of two poses alone nobody can tell.
        neighbors.iter().any(Option::is_some) && !neighbors.into_iter().flatten().any(is_like)
    }

    /// Pose, velocity and acceleration at a time; before the first pose and after the last the head is still. At these two it goes
    /// on as it does beside them: a shot that begins in motion has a head that came that way.
    ///
    /// Up to a cut ([`Self::is_cut_within`]) the head goes on as it went, and after it as it will.
    /// Between poses the position follows the uniform cubic B-spline whose control points are the poses, and
    /// the rotation the same spline of the rotation vector about the nearest pose. That spline has a continuous
    /// acceleration and damps what is left of the cameras' noise; it rounds a pose off by a sixth of the second
    /// difference of its neighbors (0.03 mm at 1 g and 240 Hz).
    ///
    /// # Panics
    /// If the track has no pose.
    pub fn motion_at(&self, time_secs: f64) -> HeadMotion {
        let last = self.poses.len() - 1;
        let place = (time_secs - self.start_secs) * self.rate_hz;
        if last == 0 || place < -SAME_PLACE || place > last as f64 + SAME_PLACE {
            return HeadMotion::still(self.poses[if place > 0.0 { last } else { 0 }]);
        }
        let left = (place.max(0.0) as usize).min(last - 1);
        let s = (place - left as f64).clamp(0.0, 1.0);
        let control = self.control_points(left);
        let base = control[1].rotation;
        let positions = control.map(|p| p.translation.vector);
        let turns = control.map(|p| (base.inverse() * p.rotation).scaled_axis());
        let [position, velocity, acceleration] = spline(positions, s, self.rate_hz);
        let [turn, turn_rate, turn_acceleration] = spline(turns, s, self.rate_hz);
        let rotation = base * UnitQuaternion::from_scaled_axis(turn);
        // A rotation vector's rate is the angular velocity only at zero turn; the right Jacobian maps one to the
        // other. Its own derivative is of second order in the turn between two poses and is left out of the
        // angular acceleration (below 1e-3 of it for turns under 3 degrees a pose).
        let jacobian = right_jacobian(turn);
        let head_from_world = rotation.inverse();
        HeadMotion {
            world_from_head: Pose::from_parts(position.into(), rotation),
            velocity: head_from_world * velocity,
            acceleration: head_from_world * acceleration,
            angular_velocity: jacobian * turn_rate,
            angular_acceleration: jacobian * turn_acceleration,
        }
    }
}

impl PoseTrack {
    /// The poses before and after a time between pose `left` and the next, and one more on each side, all of one side of a cut
    /// and of the track's ends.
    fn control_points(&self, left: usize) -> [Pose; 4] {
        let last = self.poses.len() - 1;
        let (is_first, is_last) = (left == 0, left + 1 == last);
        let ends = [left.saturating_sub(1), left, left + 1, (left + 2).min(last)];
        let [before, from, to, after] = ends.map(|k| self.poses[k]);
        let [is_cut_before, is_cut_here, is_cut_after] =
            [left, left + 1, left + 2].map(|k| self.is_cut_before(k));
        // As far again as from one pose to another.
        let beyond = |a: &Pose, b: &Pose| {
            let place = b.translation.vector * 2.0 - a.translation.vector;
            Pose::from_parts(place.into(), b.rotation * (a.rotation.inverse() * b.rotation))
        };
        if is_cut_here {
            let before = if is_cut_before { from } else { before };
            let to = beyond(&before, &from);
            return [before, from, to, beyond(&from, &to)];
        }
        [
            if is_cut_before || is_first { beyond(&to, &from) } else { before },
            from,
            to,
            if is_cut_after || is_last { beyond(&from, &to) } else { after },
        ]
    }
}

/// Times closer to a pose than this share of the way to the next are its own.
const SAME_PLACE: f64 = 1e-6;

/// A change of velocity from one pose to the next, and back, that no head survives: m/s, rad/s.
const CUT_MPS: f64 = 20.0;
const CUT_RAD_PER_SEC: f64 = 50.0;

impl HeadMotion {
    /// A head at rest in this pose.
    pub fn still(world_from_head: Pose) -> Self {
        Self {
            world_from_head,
            velocity: Vec3::zeros(),
            acceleration: Vec3::zeros(),
            angular_velocity: Vec3::zeros(),
            angular_acceleration: Vec3::zeros(),
        }
    }

    /// Velocity over the ground, head axes, of a point that moves with the head, m/s.
    pub fn velocity_of(&self, point_m: Vec3) -> Vec3 {
        self.velocity + self.angular_velocity.cross(&point_m)
    }
}

/// Value, first and second derivative over time of the uniform cubic B-spline, at share `s` of the middle span.
fn spline(c: [Vec3; 4], s: f64, rate_hz: f64) -> [Vec3; 3] {
    let r = 1.0 - s;
    let value = (c[0] * (r * r * r)
        + c[1] * (3.0 * s * s * s - 6.0 * s * s + 4.0)
        + c[2] * (3.0 * r * r * r - 6.0 * r * r + 4.0)
        + c[3] * (s * s * s))
        / 6.0;
    let slope = (c[1] - c[0]) * (r * r / 2.0) + (c[2] - c[1]) * (0.5 + s * r) + (c[3] - c[2]) * (s * s / 2.0);
    let bend = (c[0] - 2.0 * c[1] + c[2]) * r + (c[1] - 2.0 * c[2] + c[3]) * s;
    [value, slope * rate_hz, bend * (rate_hz * rate_hz)]
}

/// The right Jacobian of the rotation exponential: `angular_velocity = J(v) * dv/dt`, body axes.
/// Source: Chirikjian, "Stochastic Models, Information Theory, and Lie Groups" vol. 2, eq. 10.86.
fn right_jacobian(v: Vec3) -> Matrix3<f64> {
    let angle = v.norm();
    let cross = v.cross_matrix();
    if angle < 1e-6 {
        return Matrix3::identity() - cross * 0.5;
    }
    let (sin, cos) = libm::sincos(angle);
    Matrix3::identity() - cross * ((1.0 - cos) / (angle * angle))
        + cross * cross * ((angle - sin) / (angle * angle * angle))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A head on a circle, turning evenly about a tilted axis: velocity and acceleration are known in closed form.
    #[test]
    fn motion_of_an_even_turn() {
        let (rate_hz, radius, omega) = (120.0, 0.1, 3.0);
        let axis = Vec3::new(0.3, -0.2, 1.0).normalize();
        let pose = |t: f64| {
            let (sin, cos) = libm::sincos(omega * t);
            let rotation = UnitQuaternion::from_scaled_axis(axis * (omega * t));
            Pose::from_parts((Vec3::new(cos, sin, 0.0) * radius).into(), rotation)
        };
        let track = PoseTrack {
            start_secs: 0.5,
            rate_hz,
            poses: (0..121).map(|k| pose(f64::from(k) / rate_hz)).collect(),
        };
        let motion = track.motion_at(0.5 + 0.4137);
        let expected = pose(0.4137);
        let world_velocity =
            Vec3::new(-libm::sin(omega * 0.4137), libm::cos(omega * 0.4137), 0.0) * (radius * omega);
        let world_acceleration = -expected.translation.vector * (omega * omega);
        assert!((motion.world_from_head.translation.vector - expected.translation.vector).norm() < 2e-5);
        assert!(motion.world_from_head.rotation.angle_to(&expected.rotation) < 1e-6);
        assert!((expected.rotation * motion.velocity - world_velocity).norm() < 1e-4);
        assert!((expected.rotation * motion.acceleration - world_acceleration).norm() < 1e-3);
        assert!((motion.angular_velocity - axis * omega).norm() < 1e-6);
        assert!(motion.angular_acceleration.norm() < 1e-6);
    }

    /// A head that goes evenly and turns, is somewhere else from one pose to the next, and goes on: it never goes faster, from the
    /// first pose to the last.
    #[test]
    fn a_cut_is_no_motion() {
        let pose = |k: usize| {
            let (jump, turn) = if k < 12 { (0.0, 0.0) } else { (1.0, 2.5) };
            let rotation = UnitQuaternion::from_scaled_axis(Vec3::z() * (0.02 * k as f64 + turn));
            Pose::from_parts(Vec3::new(0.01 * k as f64 + jump, 0.0, 1.5).into(), rotation)
        };
        let track = PoseTrack { start_secs: 0.0, rate_hz: 24.0, poses: (0..24).map(pose).collect() };
        for k in 0..=230 {
            let secs = f64::from(k) * 0.1 / 24.0;
            let motion = track.motion_at(secs);
            assert!((motion.velocity.norm() - 0.24).abs() < 1e-9, "{secs}: {}", motion.velocity);
            assert!((motion.angular_velocity - Vec3::z() * 0.48).norm() < 1e-9, "{secs}");
            let jump = if k < 120 { 0.0 } else { 1.0 };
            assert!((motion.world_from_head.translation.x - 0.24 * secs - jump).abs() < 1e-9, "{secs}");
        }
        let cut_secs = 12.0 / 24.0;
        assert!(track.is_cut_within(cut_secs - 1e-3, cut_secs) && track.is_cut_within(0.0, 1.0));
        assert!(!track.is_cut_within(cut_secs, 1.0) && !track.is_cut_within(0.0, cut_secs - 1e-3));
        assert!(!track.is_cut_within(-1.0, 0.0) && !track.is_cut_within(2.0, 3.0));
    }

    /// Nor is a stop from 30 m/s, or such a speed, a cut; random places are, all of them.
    #[test]
    fn speed_is_no_cut() {
        let at = |x: f64| Pose::translation(x, 0.0, 0.0);
        let track = |poses: Vec<Pose>| PoseTrack { start_secs: 0.0, rate_hz: 60.0, poses };
        let driven = track((0..40).map(|k| at(0.5 * f64::from(k.min(20)))).collect());
        assert!(!driven.is_cut_within(-1.0, 9.0));
        let random = track([0.0, 3.0, 1.0, 4.0, 0.0, 5.0, 2.0, 6.0, 1.0].map(at).to_vec());
        assert!((1..9).all(|pose| random.is_cut_before(pose)));
        let held = random.motion_at(0.06);
        assert!((held.world_from_head.translation.x - 4.0).abs() < 1e-12 && held.velocity.norm() < 1e-12);
        assert!(!track(vec![at(0.0), at(9.0)]).is_cut_within(-1.0, 9.0), "of two poses nobody can tell");
    }

    #[test]
    fn outside_its_span_the_head_is_still() {
        let a = Pose::translation(1.0, 0.0, 0.0);
        let b = Pose::translation(2.0, 0.0, 0.0);
        let track = PoseTrack { start_secs: 0.0, rate_hz: 10.0, poses: vec![a, b] };
        assert_eq!(track.motion_at(-1.0), HeadMotion::still(a));
        assert_eq!(track.motion_at(9.0), HeadMotion::still(b));
    }
}
