use crate::error::HeadError;
use crate::frames::{FrameQuality, label_spans, n_visible, pose_gaps};
use crate::labels::mend_labels;
use crate::mirror::{Mirrored, mirrored};
use crate::registration::{Pair, Registration, register};
use crate::report::{HeadReport, marker_reports, report};
use crate::shape::{HeadShape, head_shape};
use crate::smooth::{SmoothOptions, TrackedPoses, pose_track};
use rayon::prelude::*;
use tousle_core::{
    Capture, HeadCapture, HeadMarker, HeadPose, Session, StrandTracks, Track, UnlabeledTrack, Vec3, median,
};

/// How the head is found.
#[derive(Clone, Debug, PartialEq)]
pub struct HeadOptions {
    /// A marker farther than this from where the pose puts it is left out of that frame, m.
    ///
    /// Raised, a neck that follows half a turn bends the pose; lowered below the noise, good markers are lost.
    /// 3 mm is twenty times the noise of an optical system and a fortieth of the head.
    pub tolerance_m: f64,
    /// A marker that agrees in fewer than this share of its frames is not trusted in any: it sits on something
    /// that moves by itself.
    pub least_agreement: f64,
    /// How the poses are smoothed.
    pub smooth: SmoothOptions,
}

impl Default for HeadOptions {
    fn default() -> Self {
        Self { tolerance_m: 3e-3, least_agreement: 0.8, smooth: SmoothOptions::default() }
    }
}

/// A capture in head space, and how the head was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Located {
    /// Poses as seen in each frame, and locks in the head space of the smooth ones.
    pub head: HeadCapture,
    /// The smooth track of the poses, and the pose at rest.
    pub tracked: TrackedPoses,
    /// What was found on the way.
    pub report: HeadReport,
}

/// Finds the head's pose in every frame and expresses every lock in head space.
///
/// In: world-space positions, m; a marker that the capture does not have was never seen. Out: `world_from_head` a frame, `None` where fewer than three trusted markers
/// agree, unless those around tell it; the smooth track of those poses; marker tracks in head space, m, missing wherever
/// the marker or the pose is. Locks are seen from the *smooth* track: the noise of eight markers turns the head by 2 mrad a frame,
/// which would shake a tip 25 cm away by half a millimeter, three times the cameras' own noise.
///
/// The paper takes the head's motion away with 8 markers and does not say how (3.1). Here: the rigid transform
/// of most agreement over the markers that are seen (MSAC over triples of them, then least squares), in two passes.
/// After the first, samples that sit on another marker's place are given to that marker (labels that were
/// exchanged), and the second trusts no marker that failed to follow the head in the first.
///
/// # Errors
/// [`HeadError`] if fewer than three of the session's head markers are in the capture, if they are a head of another size or its mirror image, or
/// if no frame gives a pose.
pub fn locate_head(
    capture: &Capture,
    session: &Session,
    options: &HeadOptions,
) -> Result<Located, HeadError> {
    let mut tracks = head_tracks(capture, session)?;
    if let Some(scale) = scale(&tracks, session)
        && !(1.0 / MOST_SCALE..=MOST_SCALE).contains(&scale)
    {
        return Err(HeadError::OtherScale { scale });
    }
    let still = session.still_range(capture.first_frame, capture.n_frames);
    // As far as still means may be from the session's places and agree with them, see `head_shape`.
    if let Some(Mirrored { labels, mirrored_m, as_labeled_m }) =
        mirrored(&tracks, session, still, 3.0 * options.tolerance_m)
    {
        let (mirrored_mm, as_labeled_mm) = (mirrored_m * 1e3, as_labeled_m * 1e3);
        return Err(HeadError::Mirrored { labels, mirrored_mm, as_labeled_mm });
    }
    let shape = head_shape(&tracks, session, still, 3.0 * options.tolerance_m);
    let first_pass = register_frames(&tracks, &shape, &vec![1.0; tracks.len()], options);
    let (mislabeled, first_pass) = mend_labels(&mut tracks, &shape, &first_pass, options.tolerance_m);
    let agreement = agreement(&tracks, &first_pass);
    let trust = trust(&agreement, options);
    let registrations = register_frames(&tracks, &shape, &trust, options);
    if registrations.iter().all(Option::is_none) {
        let tolerance_mm = options.tolerance_m * 1e3;
        return Err(HeadError::NoPose { tolerance_mm, n_frames: capture.n_frames });
    }
    let own_poses: Vec<_> =
        registrations.iter().enumerate().map(|(frame, r)| head_pose(r.as_ref(), &tracks, frame)).collect();
    let seen: Vec<_> = registrations.iter().map(|r| Some(r.as_ref()?.world_from_head)).collect();
    let tracked = pose_track(&seen, capture.rate_hz, still, &options.smooth);
    let bridged = bridged(capture.n_frames, &tracked);
    let poses = with_bridges(&own_poses, &bridged, &tracks, &tracked);
    let head = HeadCapture {
        rate_hz: capture.rate_hz,
        first_frame: capture.first_frame,
        strands: strand_tracks(capture, session, &poses, &tracked),
        unlabeled: unlabeled_tracks(capture, &poses, &tracked),
        poses,
    };
    let labels_mended = label_spans(&mislabeled, session, capture.first_frame);
    let markers = marker_reports(&registrations, session, &tracks, &shape, &agreement, &trust, &head);
    let frames = FrameQuality::of(&own_poses, &tracks);
    let without_pose = pose_gaps(&frames, &bridged, capture.first_frame);
    let report = report(&own_poses, markers, labels_mended, without_pose, frames, &shape, &tracked);
    Ok(Located { head, tracked, report })
}

/// A head that is this much larger or smaller than the session's is in another unit; the next unit is 2.5 times as large.
const MOST_SCALE: f64 = 1.5;

/// The size of the head in the capture over that in the session: of the distances of all pairs of markers, whoever has which
/// label. The median over frames; `None` if none shows two markers.
fn scale(tracks: &[Track], session: &Session) -> Option<f64> {
    let n_frames = tracks.first().map_or(0, Track::n_frames);
    let at = |frame: usize| {
        let pairs: Vec<(Vec3, Vec3)> = tracks
            .iter()
            .zip(&session.head_markers)
            .filter_map(|(track, marker)| Some((track.at(frame)?, marker.position_m)))
            .collect();
        let (mut seen2, mut own2) = (0.0_f64, 0.0_f64);
        for (k, (seen_m, own_m)) in pairs.iter().enumerate() {
            for (other_seen_m, other_own_m) in &pairs[..k] {
                seen2 += (seen_m - other_seen_m).norm_squared();
                own2 += (own_m - other_own_m).norm_squared();
            }
        }
        (own2 > 0.0).then(|| (seen2 / own2).sqrt())
    };
    median((0..n_frames).filter_map(at).collect())
}

/// How far off hair may be seen from a pose that is told from those around, m. If it falls, more hair is thrown away with its
/// frames; raised, the head's error passes for motion of all the hair at once. Hair in the wind moves by some ten times as much.
const MOST_BRIDGED_M: f64 = 15e-3;

/// How far off the poses of frames without one of their own are, m, where that can be borne; 0 for a head that stands still.
fn bridged(n_frames: usize, tracked: &TrackedPoses) -> Vec<Option<f64>> {
    if !tracked.report.moves {
        return vec![Some(0.0); n_frames];
    }
    let mut errors_m = vec![None; n_frames];
    for bridge in tracked.bridges.iter().filter(|bridge| bridge.expected_error_m <= MOST_BRIDGED_M) {
        errors_m[bridge.frames.clone()].fill(Some(bridge.expected_error_m));
    }
    errors_m
}

/// The poses, and smooth ones where they are bridged.
fn with_bridges(
    poses: &[Option<HeadPose>],
    bridged: &[Option<f64>],
    tracks: &[Track],
    tracked: &TrackedPoses,
) -> Vec<Option<HeadPose>> {
    let smooth = |(frame, pose): (usize, &Option<HeadPose>)| {
        let world_from_head = *tracked.pose(frame);
        let bridge = |expected_error_m: f64| HeadPose {
            world_from_head,
            expected_error_m,
            fit_residual_m: 0.0,
            n_used: 0,
            n_visible: n_visible(tracks, frame),
        };
        match pose {
            Some(own) => Some(HeadPose { world_from_head, ..own.clone() }),
            None => bridged[frame].map(bridge),
        }
    };
    poses.iter().enumerate().map(smooth).collect()
}

/// The tracks of the head's markers; one that is not in the capture was never seen.
fn head_tracks(capture: &Capture, session: &Session) -> Result<Vec<Track>, HeadError> {
    if session.head_markers.len() < 3 {
        return Err(HeadError::TooFewMarkers { found: session.head_markers.len() });
    }
    let find = |m: &HeadMarker| find_track(capture, session, &m.label);
    let tracks: Vec<Option<&Track>> = session.head_markers.iter().map(find).collect();
    let found = tracks.iter().flatten().count();
    if found < 3 {
        let absent = session.head_markers.iter().zip(&tracks).filter(|(_, track)| track.is_none());
        return Err(HeadError::MissingMarkers {
            found,
            labels: absent.map(|(m, _)| m.label.clone()).collect(),
        });
    }
    let or_missing =
        |track: Option<&Track>| track.cloned().unwrap_or_else(|| Track::missing(capture.n_frames));
    Ok(tracks.into_iter().map(or_missing).collect())
}

/// The track of a label; the session's subject decides between two subjects with the same label.
fn find_track<'a>(capture: &'a Capture, session: &Session, label: &str) -> Option<&'a Track> {
    let named = |t: &&tousle_core::Trajectory| t.label == label;
    let of_subject = |t: &&tousle_core::Trajectory| named(t) && t.subject == session.subject;
    let found = capture.trajectories.iter().find(of_subject);
    found.or_else(|| capture.trajectories.iter().find(named)).map(|t| &t.track)
}

fn register_frames(
    tracks: &[Track],
    shape: &HeadShape,
    trust: &[f64],
    options: &HeadOptions,
) -> Vec<Option<Registration>> {
    let n_frames = tracks.first().map_or(0, Track::n_frames);
    let pair = |frame: usize, k: usize| {
        let seen_m = tracks[k].at(frame).filter(|_| trust[k] > 0.0)?;
        Some(Pair { marker: k, place_m: shape.places_m[k], seen_m })
    };
    (0..n_frames)
        .into_par_iter()
        .map(|frame| {
            let pairs: Vec<Pair> = (0..tracks.len()).filter_map(|k| pair(frame, k)).collect();
            let mut registration = register(&pairs, trust, options.tolerance_m)?;
            for k in &mut registration.used {
                *k = pairs[*k].marker;
            }
            Some(registration)
        })
        .collect()
}

/// For each marker the share of its frames in which it agreed with the pose.
fn agreement(tracks: &[Track], registrations: &[Option<Registration>]) -> Vec<f64> {
    let share = |k: usize| {
        let seen = registrations
            .iter()
            .enumerate()
            .filter(|(f, r)| r.is_some() && tracks[k].at(*f).is_some())
            .count();
        let used = registrations.iter().flatten().filter(|r| r.used.contains(&k)).count();
        used as f64 / seen.max(1) as f64
    };
    (0..tracks.len()).map(share).collect()
}

/// 1 for markers that follow the head, 0 for the others; all 1 if fewer than three would be left.
fn trust(agreement: &[f64], options: &HeadOptions) -> Vec<f64> {
    let trust: Vec<f64> =
        agreement.iter().map(|a| f64::from(u8::from(*a >= options.least_agreement))).collect();
    if trust.iter().sum::<f64>() >= 3.0 { trust } else { vec![1.0; agreement.len()] }
}

fn head_pose(registration: Option<&Registration>, tracks: &[Track], frame: usize) -> Option<HeadPose> {
    let registration = registration?;
    Some(HeadPose {
        world_from_head: registration.world_from_head,
        expected_error_m: 0.0,
        fit_residual_m: registration.residual_m,
        n_used: registration.used.len(),
        n_visible: n_visible(tracks, frame),
    })
}

fn strand_tracks(
    capture: &Capture,
    session: &Session,
    poses: &[Option<HeadPose>],
    tracked: &TrackedPoses,
) -> Vec<StrandTracks> {
    let marker = |label: &str| match find_track(capture, session, label) {
        Some(track) => to_head(track, poses, tracked),
        None => Track::missing(capture.n_frames),
    };
    let strand = |(strand_idx, spec): (usize, &tousle_core::StrandSpec)| StrandTracks {
        strand_idx,
        markers: spec.markers.iter().map(|m| marker(&m.label)).collect(),
    };
    session.strands.iter().enumerate().map(strand).collect()
}

fn unlabeled_tracks(
    capture: &Capture,
    poses: &[Option<HeadPose>],
    tracked: &TrackedPoses,
) -> Vec<UnlabeledTrack> {
    let unlabeled = capture.trajectories.iter().filter(|t| t.is_unlabeled());
    let in_head = |t: &tousle_core::Trajectory| UnlabeledTrack {
        label: t.label.clone(),
        track: to_head(&t.track, poses, tracked),
    };
    unlabeled.map(in_head).collect()
}

/// A world-space track as the head sees it; missing wherever the pose is.
fn to_head(track: &Track, poses: &[Option<HeadPose>], tracked: &TrackedPoses) -> Track {
    track.map(|frame, p_world| {
        poses[frame].as_ref()?;
        let world_from_head = tracked.pose(frame);
        Some(world_from_head.inverse_transform_point(&p_world.into()).coords)
    })
}
