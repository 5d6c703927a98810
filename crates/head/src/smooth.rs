use crate::bridge::{Bridge, bridges};
use nalgebra::UnitQuaternion;
use serde::Serialize;
use tousle_core::{Pose, PoseTrack, Vec3};

/// How poses become a smooth track.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SmoothOptions {
    /// Length of the window a parabola is fitted to, s; `None` lets the poses choose.
    ///
    /// Raised, quick nods are rounded off; lowered, the cameras' noise shakes the hair, as the acceleration's
    /// noise falls with the window to the power 5/2. The poses choose by leave-one-out cross-validation: the
    /// window whose parabola foretells a pose best from the others.
    pub window_secs: Option<f64>,
}

/// Windows to choose from, s: from what a quick nod asks for to what a slow turn allows.
const WINDOWS_SECS: [f64; 6] = [0.05, 0.075, 0.1, 0.15, 0.2, 0.3];

/// A smooth pose track, the pose at rest, and how they came about.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackedPoses {
    /// The track; a single pose if the head never moved.
    pub poses: PoseTrack,
    /// The mean pose of the still frames (of all frames without a still interval).
    pub rest_pose: Pose,
    /// What was done.
    pub report: PoseTrackReport,
    /// Frames without a pose, and what is known of it.
    pub(crate) bridges: Vec<Bridge>,
}

impl TrackedPoses {
    /// The smooth pose of a frame of the capture.
    pub(crate) fn pose(&self, frame: usize) -> &Pose {
        &self.poses.poses[frame.min(self.poses.poses.len() - 1)]
    }
}

/// How a pose track came about.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PoseTrackReport {
    /// Frames without a pose of their own, bridged from their neighbors.
    pub frames_bridged: usize,
    /// Whether the head moved at all, beyond the noise.
    pub moves: bool,
    /// Length of the window that was smoothed over, s.
    pub window_secs: f64,
    /// Root mean square difference between measured and smooth positions, m.
    pub smoothing_m: f64,
    /// The same for the angle, rad.
    pub smoothing_rad: f64,
}

/// Makes of the poses of a capture a smooth track.
///
/// Position and rotation vector (about the pose in the window's middle) are fitted by a parabola over a sliding
/// window (Savitzky and Golay 1964), after frames without a pose got one from those on both sides ([`bridges`]); before
/// the first pose and after the last one the head is held. A head whose smooth poses
/// do not stray from their mean by more than what noise makes of a still one gives a track of one pose, so
/// that a simulator can leave the head's motion out.
///
/// # Panics
/// If no frame has a pose; `locate_head` refuses such a capture.
pub(crate) fn pose_track(
    poses: &[Option<Pose>],
    rate_hz: f64,
    still: Option<(usize, usize)>,
    options: &SmoothOptions,
) -> TrackedPoses {
    let known: Vec<(usize, Pose)> = poses.iter().enumerate().filter_map(|(f, p)| Some((f, (*p)?))).collect();
    let half = options.window_secs.map_or_else(|| best_half(&known, rate_hz), |secs| half(secs, rate_hz));
    let bridges = bridges(&known, rate_hz);
    let mut all_within = known.clone();
    all_within
        .extend(bridges.iter().flat_map(|bridge| bridge.frames.clone().zip(bridge.poses.iter().copied())));
    all_within.sort_by_key(|(frame, _)| *frame);
    let (first, last) = (all_within[0].0, all_within[all_within.len() - 1].0);
    let smooth: Vec<Pose> =
        (0..poses.len()).map(|frame| smooth_pose(&all_within, frame.clamp(first, last), half)).collect();
    let rest: Vec<Pose> = match still {
        Some((first, last)) => {
            known.iter().filter(|(f, _)| (first..=last).contains(f)).map(|(_, p)| *p).collect()
        }
        None => Vec::new(),
    };
    let all: Vec<Pose> = known.iter().map(|(_, p)| *p).collect();
    let rest_pose = mean_pose(if rest.is_empty() { &all } else { &rest });
    let differences = |reference: &dyn Fn(usize) -> Pose| rms_difference(&known, reference);
    let (smoothing_m, smoothing_rad) = differences(&|f| smooth[f]);
    // Noise of the smooth track of a still head: a parabola over n poses keeps about 1.5 of 1/√n of it.
    let kept = 1.5 / ((2 * half + 1) as f64).sqrt();
    let whole = mean_pose(&all);
    // Where a pose was seen: what bridges a gap rests on few poses and strays farther.
    let smooth_known: Vec<(usize, Pose)> = known.iter().map(|(f, _)| (*f, smooth[*f])).collect();
    let (stray_m, stray_rad) = rms_difference(&smooth_known, &|_| whole);
    // Twice that: slow drifts of the cameras are no motion of the head either.
    let moves = stray_m > 2.0 * kept * smoothing_m || stray_rad > 2.0 * kept * smoothing_rad;
    let track =
        if moves { PoseTrack { start_secs: 0.0, rate_hz, poses: smooth } } else { PoseTrack::still(whole) };
    let frames_bridged = poses.len() - known.len();
    let window_secs = (2 * half + 1) as f64 / rate_hz;
    let report = PoseTrackReport { frames_bridged, moves, window_secs, smoothing_m, smoothing_rad };
    TrackedPoses { poses: track, rest_pose: if moves { rest_pose } else { whole }, report, bridges }
}

/// Frames on each side of a window's middle.
fn half(window_secs: f64, rate_hz: f64) -> usize {
    ((window_secs * rate_hz / 2.0).round() as usize).max(2)
}

/// The window that foretells each pose best from the others.
fn best_half(known: &[(usize, Pose)], rate_hz: f64) -> usize {
    let halves = WINDOWS_SECS.map(|secs| half(secs, rate_hz));
    let errors = halves.map(|half| foretelling_error(known, half));
    let best = (0..halves.len()).min_by(|&a, &b| errors[a].total_cmp(&errors[b]));
    halves[best.unwrap_or(0)]
}

/// How far apart two poses are, squared: m² of the center plus m² of a point 0.1 m from it, so that turns and travel count
/// as they move hair.
pub(crate) fn distance2(a: &Pose, b: &Pose) -> f64 {
    const LEVER_M: f64 = 0.1;
    let angle = a.rotation.angle_to(&b.rotation) * LEVER_M;
    (a.translation.vector - b.translation.vector).norm_squared() + angle * angle
}

/// Mean square difference between a pose and what the others in its window say of it; infinite if no window holds three others.
fn foretelling_error(known: &[(usize, Pose)], half: usize) -> f64 {
    let (mut sum, mut n) = (0.0, 0);
    // Some hundred frames tell as much as all.
    let stride = known.len() / 400 + 1;
    for (at, (frame, pose)) in known.iter().enumerate().step_by(stride) {
        let from = known.partition_point(|(f, _)| *f + half < *frame);
        let mut others: Vec<(usize, Pose)> = known[from..at].to_vec();
        others.extend(known[at + 1..].iter().take_while(|(f, _)| *f <= frame + half));
        if others.len() < 3 {
            continue;
        }
        let foretold = smooth_pose(&others, *frame, half);
        sum += distance2(&foretold, pose);
        n += 1;
    }
    if n > 0 { sum / f64::from(n) } else { f64::INFINITY }
}

/// The parabola over the window about a frame; the window grows until it holds three poses (or all there are).
fn smooth_pose(known: &[(usize, Pose)], frame: usize, half: usize) -> Pose {
    let mut half = half;
    let window = loop {
        let from = known.partition_point(|(f, _)| *f + half < frame);
        let to = known.partition_point(|(f, _)| *f <= frame + half);
        if to - from >= 3 || to - from == known.len() {
            break &known[from..to];
        }
        half *= 2;
    };
    let nearest = window
        .iter()
        .min_by_key(|(f, _)| f.abs_diff(frame))
        .expect("a capture with a pose has one in every grown window");
    let base = nearest.1.rotation;
    let mut positions = Vec::with_capacity(window.len());
    let mut turns = Vec::with_capacity(window.len());
    for (f, pose) in window {
        let place = *f as f64 - frame as f64;
        positions.push((place, pose.translation.vector));
        turns.push((place, (base.inverse() * pose.rotation).scaled_axis()));
    }
    let rotation = base * UnitQuaternion::from_scaled_axis(parabola_at_zero(&turns));
    Pose::from_parts(parabola_at_zero(&positions).into(), rotation)
}

/// The value at 0 of the least-squares parabola through points `(x, y)`; the mean where x does not settle one.
fn parabola_at_zero(points: &[(f64, Vec3)]) -> Vec3 {
    let mut normal = nalgebra::Matrix3::<f64>::zeros();
    let mut right = nalgebra::Matrix3::<f64>::zeros();
    for (x, y) in points {
        let powers = Vec3::new(1.0, *x, x * x);
        normal += powers * powers.transpose();
        right += powers * y.transpose();
    }
    match normal.cholesky() {
        Some(factor) if points.len() >= 3 => factor.solve(&right).row(0).transpose(),
        _ => points.iter().map(|(_, y)| y).sum::<Vec3>() / points.len() as f64,
    }
}

/// The mean position and the rotation whose rotation vectors to all others add up to nothing.
fn mean_pose(poses: &[Pose]) -> Pose {
    let n = poses.len() as f64;
    let position = poses.iter().map(|p| p.translation.vector).sum::<Vec3>() / n;
    let mut rotation = poses[0].rotation;
    for _ in 0..4 {
        let turn = poses.iter().map(|p| (rotation.inverse() * p.rotation).scaled_axis()).sum::<Vec3>() / n;
        rotation *= UnitQuaternion::from_scaled_axis(turn);
    }
    Pose::from_parts(position.into(), rotation)
}

fn rms_difference(poses: &[(usize, Pose)], reference: &dyn Fn(usize) -> Pose) -> (f64, f64) {
    let (mut m2, mut rad2) = (0.0, 0.0);
    for (frame, pose) in poses {
        let reference = reference(*frame);
        m2 += (pose.translation.vector - reference.translation.vector).norm_squared();
        let angle = pose.rotation.angle_to(&reference.rotation);
        rad2 += angle * angle;
    }
    let n = poses.len().max(1) as f64;
    ((m2 / n).sqrt(), (rad2 / n).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    /// A parabola in time is kept exactly, also across a gap.
    #[test]
    fn an_even_acceleration_is_kept() {
        let pose = |k: f64| Pose::translation(1e-3 * k + 1e-5 * k * k, 0.0, 1.5);
        let poses = (0..60).map(|k| (!(20..24).contains(&k)).then(|| pose(f64::from(k))));
        let poses: Vec<_> = poses.collect();
        let tracked = pose_track(&poses, 120.0, None, &SmoothOptions::default());
        assert!(tracked.report.moves);
        assert_eq!(tracked.report.frames_bridged, 4);
        for k in [10, 22, 40] {
            let off = tracked.poses.poses[k].translation.vector - pose(k as f64).translation.vector;
            assert!(off.norm() < 1e-12, "{k}: {off}");
        }
    }

    /// A window that can foretell no pose is never the best.
    #[test]
    fn a_window_of_too_few_poses_is_not_chosen() {
        let sway = |k: usize| Pose::translation(5e-3 * libm::sin(0.3 * k as f64), 0.0, 1.5);
        let known: Vec<_> = (0..120).step_by(2).map(|k| (k, sway(k))).collect();
        assert_eq!(foretelling_error(&known, 3), f64::INFINITY);
        assert!(foretelling_error(&known, 5) < foretelling_error(&known, 9));
        assert_eq!(best_half(&known, 60.0), 5);
    }

    /// Where nothing is seen for long the track runs straight on, and is held at the ends: it does not fly off.
    #[test]
    fn a_long_gap_is_bridged_from_both_sides() {
        let mut state = 7_u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5) * 4e-4
        };
        let poses: Vec<_> = (0..200)
            .map(|k| {
                let pose = Pose::translation(1e-3 * f64::from(k) + noise(), noise(), 1.5 + noise());
                (!(60..140).contains(&k) && (10..190).contains(&k)).then_some(pose)
            })
            .collect();
        let tracked = pose_track(&poses, 120.0, None, &SmoothOptions::default());
        for (k, pose) in tracked.poses.poses.iter().enumerate() {
            let place = k.clamp(10, 189) as f64 * 1e-3;
            let off = (pose.translation.vector - Vec3::new(place, 0.0, 1.5)).norm();
            assert!(off < 2e-3, "{k}: {off}");
        }
    }

    /// Noise alone is no motion: the track of a noisy still head has one pose.
    #[test]
    fn a_noisy_still_head_is_still() {
        // A fixed sequence of numbers without pattern (a linear congruential generator), ±0.1 mm.
        let mut state = 1_u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5) * 2e-4
        };
        let poses: Vec<_> = (0..600)
            .map(|_| {
                Some(Pose::new(
                    Vec3::new(noise(), noise(), 1.5 + noise()),
                    Vec3::new(noise(), noise(), noise()),
                ))
            })
            .collect();
        let tracked = pose_track(&poses, 120.0, None, &SmoothOptions::default());
        assert!(!tracked.report.moves, "{:?}", tracked.report);
        assert!(tracked.poses.is_still());
    }
}
