//! Markers and head over time, smooth and with derivatives, at the time steps asked for.

use super::smooth::{Motion, motion_at, penalty, smooth};
use nalgebra::UnitQuaternion;
use tousle_core::{HeadCapture, Pose, Sample, Track, Vec3};

/// Time steps of a capture and where the head is at each.
pub(crate) struct Clock {
    pub(crate) n_steps: usize,
    pub(crate) rate_hz: f64,
    /// `world_from_head` in every frame; where nobody knows it, between those around.
    pub(crate) poses: Vec<Pose>,
    pub(crate) frame_rate_hz: f64,
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
        Some(Self { n_steps, rate_hz, poses, frame_rate_hz: head.rate_hz })
    }

    pub(crate) fn time_secs(&self, step: usize) -> f64 {
        step as f64 / self.rate_hz
    }

    /// The frame nearest to a step.
    pub(crate) fn frame(&self, step: usize) -> usize {
        ((self.time_secs(step) * self.frame_rate_hz).round() as usize).min(self.poses.len() - 1)
    }

    pub(crate) fn pose(&self, step: usize) -> &Pose {
        &self.poses[self.frame(step)]
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
    let part = (frame - from) as f64 / (to - from) as f64;
    let turn = (before.rotation.inverse() * after.rotation).scaled_axis() * part;
    Pose::from_parts(
        before.translation.vector.lerp(&after.translation.vector, part).into(),
        before.rotation * UnitQuaternion::from_scaled_axis(turn),
    )
}

/// A marker's motion at every step, world space, and the expected error of its place, m.
pub(crate) struct MarkerMotion {
    pub(crate) motions: Vec<Motion>,
    pub(crate) errors_m: Vec<f64>,
}

/// What is taken for the error of a marker that nobody says anything of, m: that of a good camera system.
pub(crate) const PLAIN_ERROR_M: f64 = 0.3e-3;

/// The smooth motion of a marker of head space; `None` if it was hardly ever seen.
pub(crate) fn marker_motion(
    track: &Track,
    samples: Option<&[Sample]>,
    clock: &Clock,
    cutoff_hz: f64,
) -> Option<MarkerMotion> {
    let error = |frame: usize| match samples {
        Some(samples) => samples[frame].error_m.max(0.5 * PLAIN_ERROR_M),
        None => PLAIN_ERROR_M,
    };
    let n = clock.poses.len();
    let mut places = vec![Vec3::zeros(); n];
    let mut weights = vec![0.0; n];
    let mut frame_errors = vec![f64::INFINITY; n];
    for frame in 0..n {
        if let Some(p) = track.at(frame) {
            places[frame] = (clock.poses[frame] * nalgebra::Point3::from(p)).coords;
            let share = PLAIN_ERROR_M / error(frame);
            weights[frame] = (share * share).min(1.0);
            frame_errors[frame] = error(frame);
        }
    }
    let curve = smooth(&places, &weights, penalty(cutoff_hz, clock.frame_rate_hz))?;
    let motions =
        (0..clock.n_steps).map(|k| motion_at(&curve, clock.frame_rate_hz, clock.time_secs(k))).collect();
    let errors_m = (0..clock.n_steps).map(|k| frame_errors[clock.frame(k)]).collect();
    Some(MarkerMotion { motions, errors_m })
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
