//! Markers and head over time, smooth and with derivatives, at the time steps asked for.

use super::smooth::{Motion, motion_at, noise_left, penalty, smooth};
use nalgebra::UnitQuaternion;
use tousle_core::{HeadCapture, Pose, Sample, Track, Vec3, median_high};

/// Time steps of a capture and where the head is at each.
pub(crate) struct Clock {
    pub(crate) n_steps: usize,
    pub(crate) rate_hz: f64,
    /// `world_from_head` in every frame; where nobody knows it, between those around.
    pub(crate) poses: Vec<Pose>,
    pub(crate) frame_rate_hz: f64,
    /// `world_from_head` at every step.
    at_steps: Vec<Pose>,
}

impl Clock {
    /// `None` if no frame has a pose.
    pub(crate) fn new(head: &HeadCapture, n_steps: usize, rate_hz: f64) -> Option<Self> {
        let known: Vec<(usize, Pose)> = head
            .poses
            .iter()
            .enumerate()
            .filter_map(|(frame, pose)| Some((frame, pose.as_ref()?.world_from_head)))
            .collect();
        let poses =
            (!known.is_empty()).then(|| (0..head.n_frames()).map(|f| between(&known, f)).collect())?;
        Some(Self::of_poses(poses, head.rate_hz, n_steps, rate_hz))
    }

    /// `poses`: in every frame, at least one.
    fn of_poses(poses: Vec<Pose>, frame_rate_hz: f64, n_steps: usize, rate_hz: f64) -> Self {
        let last = poses.len() - 1;
        let at_step = |step: usize| {
            let place = step as f64 / rate_hz * frame_rate_hz;
            let before = (place as usize).min(last);
            on_the_way(&poses[before], &poses[(before + 1).min(last)], (place - before as f64).min(1.0))
        };
        let at_steps = (0..n_steps).map(at_step).collect();
        Self { n_steps, rate_hz, poses, frame_rate_hz, at_steps }
    }

    pub(crate) fn time_secs(&self, step: usize) -> f64 {
        step as f64 / self.rate_hz
    }

    /// The frame nearest to a step.
    pub(crate) fn frame(&self, step: usize) -> usize {
        ((self.time_secs(step) * self.frame_rate_hz).round() as usize).min(self.poses.len() - 1)
    }

    /// Where the head is at a step: between two frames on the straight way.
    pub(crate) fn pose(&self, step: usize) -> &Pose {
        &self.at_steps[step]
    }
}

/// The pose in a frame, on the straight way from the last known one to the next: a head that stood still and then jumped would
/// shake all hair.
fn between(known: &[(usize, Pose)], frame: usize) -> Pose {
    let next = known.partition_point(|(f, _)| *f < frame).min(known.len() - 1);
    let ((from, before), (to, after)) = (known[next.saturating_sub(1)], known[next]);
    if frame >= to || frame <= from {
        return if frame >= to { after } else { before };
    }
    on_the_way(&before, &after, (frame - from) as f64 / (to - from) as f64)
}

/// A part of the straight way from one pose to another.
fn on_the_way(before: &Pose, after: &Pose, part: f64) -> Pose {
    let turn = (before.rotation.inverse() * after.rotation).scaled_axis() * part;
    Pose::from_parts(
        before.translation.vector.lerp(&after.translation.vector, part).into(),
        before.rotation * UnitQuaternion::from_scaled_axis(turn),
    )
}

/// A marker's smooth motion at every step, world space, and the expected error of its place, m.
pub(crate) struct MarkerMotion {
    pub(crate) motions: Vec<Motion>,
    pub(crate) errors_m: Vec<f64>,
}

/// What is taken for the error of a marker that nobody says anything of, m: that of a good camera system.
pub(crate) const PLAIN_ERROR_M: f64 = 0.3e-3;

/// How the cutoff falls with a marker's usual error. Where noise drowns motion, the best filter for it is the one that cuts off where
/// both are as strong (Wiener): markers' motion falls so steeply with frequency that ten times the error moves that by a third.
/// With 1/3, which a motion of white third differences would have, a millimeter of noise took swings of 7 Hz for noise.
const CUTOFF_BY_ERROR: f64 = -1.0 / 6.0;

/// The smooth motion of a marker of head space; `None` if it was hardly ever seen.
///
/// Frames count by their errors over what is usual of the marker; how much is taken for noise, by that and `cutoff_hz`, which is for
/// a good camera system.
pub(crate) fn marker_motion(
    track: &Track,
    samples: Option<&[Sample]>,
    clock: &Clock,
    cutoff_hz: f64,
) -> Option<MarkerMotion> {
    let expected = |frame: usize| match samples {
        Some(samples) => samples[frame].error_m.max(0.5 * PLAIN_ERROR_M),
        None => PLAIN_ERROR_M,
    };
    let n = clock.poses.len();
    let mut places = vec![Vec3::zeros(); n];
    let mut frame_errors = vec![f64::INFINITY; n];
    for frame in 0..n {
        if let Some(p) = track.at(frame) {
            places[frame] = (clock.poses[frame] * nalgebra::Point3::from(p)).coords;
            frame_errors[frame] = expected(frame);
        }
    }
    let usual_m = usual_error_m(samples);
    let weights: Vec<f64> = frame_errors.iter().map(|error_m| (usual_m / error_m).powi(2).min(1.0)).collect();
    let cutoff_hz = cutoff_hz * libm::pow(usual_m / PLAIN_ERROR_M, CUTOFF_BY_ERROR);
    let curve = smooth(&places, &weights, penalty(cutoff_hz, clock.frame_rate_hz))?;
    let motions =
        (0..clock.n_steps).map(|k| motion_at(&curve, clock.frame_rate_hz, clock.time_secs(k))).collect();
    let noise_left = noise_left(cutoff_hz, clock.frame_rate_hz);
    let error = |step: usize| {
        let frame = clock.frame(step);
        let is_noise = samples.is_none_or(|samples| samples[frame].kind.is_seen());
        frame_errors[frame] * if is_noise { noise_left } else { 1.0 }
    };
    let errors_m = (0..clock.n_steps).map(error).collect();
    Some(MarkerMotion { motions, errors_m })
}

/// The error that a marker has where it is seen, m, by the median; not less than that of a good camera system.
fn usual_error_m(samples: Option<&[Sample]>) -> f64 {
    let seen = samples.into_iter().flatten().filter(|sample| sample.kind.is_seen());
    median_high(seen.map(|sample| sample.error_m).collect()).unwrap_or(PLAIN_ERROR_M).max(PLAIN_ERROR_M)
}

/// The smooth motion of something fixed to the head, from its place or direction in every frame, world axes.
pub(crate) fn fixed_motion(of_frame: impl Fn(&Pose) -> Vec3, clock: &Clock, cutoff_hz: f64) -> Vec<Motion> {
    let places: Vec<Vec3> = clock.poses.iter().map(of_frame).collect();
    let weights = vec![1.0; places.len()];
    let curve = smooth(&places, &weights, penalty(cutoff_hz, clock.frame_rate_hz)).unwrap_or(places);
    (0..clock.n_steps)
        .map(|k| {
            if curve.len() < 3 {
                Motion { position: curve[clock.frame(k)], ..Motion::default() }
            } else {
                motion_at(&curve, clock.frame_rate_hz, clock.time_secs(k))
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::SampleKind;

    const FRAMES: usize = 480;

    /// A marker that swings by 1 cm at 5 Hz beside a head that stands still, seen at 120 frames a second with the given errors: how
    /// much of the swing is left.
    fn left_of_swing(samples: &[Sample]) -> f64 {
        let clock = Clock::of_poses(vec![Pose::identity(); FRAMES], 120.0, FRAMES, 120.0);
        let mut track = Track::missing(FRAMES);
        for frame in 0..FRAMES {
            let phase = 2.0 * core::f64::consts::PI * 5.0 * frame as f64 / 120.0;
            track.set(frame, Some(Vec3::x() * 0.01 * libm::sin(phase)));
        }
        let Some(found) = marker_motion(&track, Some(samples), &clock, 12.0) else { panic!("a track") };
        let middle = &found.motions[FRAMES / 4..FRAMES * 3 / 4];
        middle.iter().map(|motion| motion.position.x.abs()).fold(0.0, f64::max) / 0.01
    }

    fn all(error_m: f64) -> Vec<Sample> {
        vec![Sample { kind: SampleKind::Seen, error_m }; FRAMES]
    }

    /// At a step between two frames the head is between their poses, as far as the step is.
    #[test]
    fn a_head_goes_on_between_frames() {
        let pose = |k: usize| {
            let turn = UnitQuaternion::from_scaled_axis(Vec3::z() * (0.04 * k as f64));
            Pose::from_parts((Vec3::x() * (0.01 * k as f64)).into(), turn)
        };
        // 25 frames a second, 30 steps: the fourth is at frame 2.5.
        let clock = Clock::of_poses((0..6).map(pose).collect(), 25.0, 6, 30.0);
        let found = clock.pose(3);
        assert!((found.translation.vector - Vec3::x() * 0.025).norm() < 1e-12);
        assert!((found.rotation.scaled_axis() - Vec3::z() * 0.1).norm() < 1e-12);
        // A step after the last frame is there.
        let clock = Clock::of_poses((0..2).map(pose).collect(), 25.0, 4, 30.0);
        assert!((clock.pose(3).translation.vector - Vec3::x() * 0.01).norm() < 1e-12);
    }

    /// What is left of a swing falls slowly with how noisy a marker is: of one at 5 Hz 99.5 % with 0.3 mm, 97 % with 1.7 mm.
    #[test]
    fn noisy_markers_keep_what_hair_does() {
        let [good, better, noisy] = [0.3e-3, 0.1e-3, 1.7e-3].map(|error_m| left_of_swing(&all(error_m)));
        assert!(good == better && good > 0.99, "{good} {better}");
        assert!((0.96..good).contains(&noisy), "{noisy}");
    }

    /// What was filled in does not make a marker a noisy one, and counts little beside what was seen.
    #[test]
    fn filled_samples_leave_the_cutoff() {
        let mut samples = all(0.3e-3);
        for sample in samples.iter_mut().step_by(3) {
            *sample = Sample { kind: SampleKind::Filled, error_m: 30e-3 };
        }
        assert!((left_of_swing(&samples) - left_of_swing(&all(0.3e-3))).abs() < 5e-3);
    }
}
