//! The public door: a head that turns, with markers that hide, exchange labels, shake, or sit on the neck.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::ops::Range;
use tousle_core::{Capture, HeadMarker, Pose, Session, StrandMarker, StrandSpec, Track, Trajectory, Vec3};
use tousle_head::{HeadError, HeadOptions, Located, locate_head};

const N_FRAMES: usize = 480;
const RATE_HZ: f64 = 120.0;
/// Label, place in head space (mm), and what a hand measured it wrong by (mm).
const MARKERS: [(&str, [f64; 3], [f64; 3]); 8] = [
    ("LFHD", [84.0, 29.0, 43.0], [0.8, -0.5, 0.2]),
    ("RFHD", [83.5, -30.0, 42.5], [-0.6, 0.4, 0.7]),
    ("NOSE", [113.0, 1.0, -18.0], [0.3, 0.9, -0.4]),
    ("LCHK", [74.0, 47.0, -33.0], [-0.2, -0.8, 0.5]),
    ("RCHK", [73.5, -46.5, -34.0], [0.5, 0.1, -0.9]),
    ("JAW", [64.0, 0.0, -91.0], [0.4, -0.3, 0.6]),
    ("LNCK", [6.0, 52.0, -135.0], [0.7, 0.2, 0.3]),
    ("RNCK", [5.0, -52.5, -136.0], [-0.9, 0.5, -0.1]),
];
const LNCK: usize = 6;

/// Still for a second, then a turn of 60 degrees to and fro.
fn turn_rad(frame: usize) -> f64 {
    let secs = (frame.max(120) - 120) as f64 / RATE_HZ;
    0.5 * (1.0 - libm::cos(2.0 * std::f64::consts::PI * secs / 3.0))
}

fn pose(turn_rad: f64) -> Pose {
    Pose::new(Vec3::new(0.2, -0.1, 1.5), Vec3::new(0.0, 0.05, turn_rad))
}

fn session() -> Session {
    let place = |k: usize| Vec3::from(MARKERS[k].1) + Vec3::from(MARKERS[k].2);
    let head_marker = |k: usize| HeadMarker { label: MARKERS[k].0.to_owned(), position_m: place(k) * 1e-3 };
    let strand = StrandSpec {
        name: "S01".to_owned(),
        length_m: 0.1,
        linear_density_kg_per_m: 3e-3,
        lock_width_m: 7e-3,
        root_m: Vec3::new(0.0, 0.0, 0.1),
        markers: vec![StrandMarker { label: "S01_1".to_owned(), distance_from_root_m: None, mass_kg: 1e-5 }],
    };
    Session {
        still_frames: Some((1, 120)),
        head_markers: (0..8).map(head_marker).collect(),
        strands: vec![strand],
        ..Session::unknown("a turn")
    }
}

/// Eight head markers, the neck's following half of the turn, and one on hair that stays where the head is.
fn capture() -> Capture {
    let mut state = 11_u64;
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5) * 4e-4
    };
    let mut trajectory = |label: &str, place_mm: [f64; 3], share: f64| {
        let at = |f: usize| pose(share * turn_rad(f)).transform_point(&(Vec3::from(place_mm) * 1e-3).into());
        let track =
            (0..N_FRAMES).map(|f| Some(at(f).coords + Vec3::new(noise(), noise(), noise()))).collect();
        Trajectory { subject: None, label: label.to_owned(), track }
    };
    let mut trajectories: Vec<Trajectory> = MARKERS
        .iter()
        .enumerate()
        .map(|(k, (label, place, _))| trajectory(label, *place, if k < LNCK { 1.0 } else { 0.5 }))
        .collect();
    trajectories.push(trajectory("S01_1", [0.0, 30.0, 120.0], 1.0));
    Capture {
        rate_hz: RATE_HZ,
        first_frame: 1,
        n_frames: N_FRAMES,
        file_unit: None,
        up_axis: None,
        trajectories,
    }
}

fn exchange(capture: &mut Capture, [a, b]: [usize; 2], frames: Range<usize>) {
    for f in frames {
        let (p, q) = (capture.trajectories[a].track.at(f), capture.trajectories[b].track.at(f));
        capture.trajectories[a].track.set(f, q);
        capture.trajectories[b].track.set(f, p);
    }
}

fn located(capture: &Capture) -> Located {
    locate_head(capture, &session(), &HeadOptions::default()).unwrap()
}

/// The worst error of the poses that are there: of the center, mm, and of the turn, mrad.
///
/// The head's axes are as good as the hand that measured its markers: what is wrong in the still frames is not
/// counted.
fn worst(located: &Located) -> (f64, f64) {
    let seen = |f: usize| Some(located.head.poses[f].as_ref()?.world_from_head);
    let rest: Vec<Pose> = (0..120).filter_map(seen).collect();
    let bias = pose(0.0).inverse() * rest[rest.len() / 2];
    let off = |f: usize| Some(seen(f)?.inverse() * (pose(turn_rad(f)) * bias));
    (0..N_FRAMES).filter_map(off).fold((0.0, 0.0), |(mm, mrad): (f64, f64), off| {
        (mm.max(off.translation.vector.norm() * 1e3), mrad.max(off.rotation.angle() * 1e3))
    })
}

/// Noise of 0.1 mm on markers some 5 cm from their middle turns a single frame by up to 5 mrad.
fn assert_near(located: &Located) {
    let (mm, mrad) = worst(located);
    assert!(mm < 0.8 && mrad < 8.0, "{mm} mm, {mrad} mrad");
}

#[test]
fn a_neck_that_follows_half_is_left_out() {
    let located = located(&capture());
    assert_near(&located);
    let untrusted = located.report.markers.iter().filter(|m| !m.trusted).map(|m| m.label.as_str());
    assert_eq!(untrusted.collect::<Vec<_>>(), ["LNCK", "RNCK"]);
    assert!(located.report.labels_mended.is_empty() && located.report.without_pose.is_empty());
    assert_eq!(located.report.frames.n_used[300], 6);
    assert_eq!(located.report.frames.n_visible[300], 8);
    assert!(
        located.report.markers[LNCK].left_out.iter().any(|s| s.first_frame <= 200 && s.last_frame >= 400)
    );
}

/// Millimeters read as centimeters are no head.
#[test]
fn a_head_of_another_size_is_refused() {
    let mut capture = capture();
    for trajectory in &mut capture.trajectories {
        for frame in 0..N_FRAMES {
            let scaled = trajectory.track.at(frame).map(|p| p * 10.0);
            trajectory.track.set(frame, scaled);
        }
    }
    let error = locate_head(&capture, &session(), &HeadOptions::default()).unwrap_err();
    assert!(matches!(error, HeadError::OtherScale { scale } if (9.0..11.0).contains(&scale)), "{error}");
}

/// Left for right in the room, or left for right under all labels: a head that is about symmetrical looks the same.
#[test]
fn a_head_in_a_mirror_is_refused() {
    let refused = |capture: &Capture, session: &Session| {
        let error = locate_head(capture, session, &HeadOptions::default()).unwrap_err();
        let HeadError::Mirrored { labels, mirrored_mm, as_labeled_mm } = &error else { panic!("{error}") };
        assert!(labels.len() >= 7 && labels.contains(&"LFHD".to_owned()), "{error}");
        assert!(*mirrored_mm < 3.0 && *as_labeled_mm > 20.0, "{error}");
    };
    let mut left_handed = capture();
    for trajectory in &mut left_handed.trajectories {
        trajectory.track = trajectory.track.map(|_, p| Some(Vec3::new(p.x, p.y, -p.z)));
    }
    let mut exchanged = capture();
    for pair in [[0, 1], [3, 4], [6, 7]] {
        exchange(&mut exchanged, pair, 0..N_FRAMES);
    }
    for capture in [&mut left_handed, &mut exchanged] {
        refused(capture, &session());
        // One marker that is somewhere else hides nothing.
        capture.trajectories[2].track =
            capture.trajectories[2].track.map(|_, p| Some(p + Vec3::repeat(0.03)));
        refused(capture, &session());
    }
    let mut mirrored = session();
    mirrored.head_markers.iter_mut().for_each(|m| m.position_m.y = -m.position_m.y);
    refused(&capture(), &mirrored);
}

/// Two labels exchanged from the first frame to the last, still frames among them.
#[test]
fn one_pair_exchanged_throughout_is_mended() {
    for pair in [[0, 1], [3, 4], [0, 4]] {
        let mut capture = capture();
        exchange(&mut capture, pair, 0..N_FRAMES);
        let located = located(&capture);
        assert_near(&located);
        let mended: Vec<&str> = located.report.labels_mended.iter().map(|m| m.label.as_str()).collect();
        assert_eq!(mended, pair.map(|k| MARKERS[k].0));
        assert!(located.report.markers.iter().all(|m| m.correction_m < 3e-3));
    }
}

/// Labels that are all exchanged for half of the capture are told by the other half.
#[test]
fn a_mirror_for_a_while_is_mended() {
    let mut capture = capture();
    for pair in [[0, 1], [3, 4], [6, 7]] {
        exchange(&mut capture, pair, 130..N_FRAMES);
    }
    assert_near(&located(&capture));
}

#[test]
fn exchanged_labels_are_told_by_their_places() {
    let mut capture = capture();
    exchange(&mut capture, [0, 2], 150..400);
    exchange(&mut capture, [3, 4], 200..260);
    let located = located(&capture);
    assert_near(&located);
    let mended = &located.report.labels_mended;
    let found: Vec<_> = mended
        .iter()
        .map(|m| (m.label.as_str(), m.marker.as_str(), m.span.first_frame, m.span.last_frame))
        .collect();
    assert_eq!(
        found,
        [
            ("LFHD", "NOSE", 151, 400),
            ("NOSE", "LFHD", 151, 400),
            ("LCHK", "RCHK", 201, 260),
            ("RCHK", "LCHK", 201, 260)
        ]
    );
    assert!(located.report.markers[..LNCK].iter().all(|m| m.trusted && m.agreed > 0.99));
    assert_eq!(located.report.frames.n_used[230], 6, "mended markers are used");
}

#[test]
fn labels_exchanged_from_the_first_frame_on_are_told_by_the_session() {
    let mut capture = capture();
    exchange(&mut capture, [0, 5], 0..300);
    let located = located(&capture);
    assert_near(&located);
    let mended = &located.report.labels_mended;
    assert_eq!(mended.len(), 2, "{mended:?}");
    assert_eq!((mended[0].span.first_frame, mended[0].span.last_frame), (1, 300));
}

#[test]
fn a_label_on_another_marker_while_its_own_is_hidden() {
    let mut capture = capture();
    for f in 200..240 {
        let nose = capture.trajectories[2].track.at(f);
        capture.trajectories[1].track.set(f, nose);
        capture.trajectories[2].track.set(f, None);
    }
    let located = located(&capture);
    assert_near(&located);
    let [mended] = &located.report.labels_mended[..] else { panic!("{:?}", located.report.labels_mended) };
    assert_eq!((mended.label.as_str(), mended.marker.as_str()), ("RFHD", "NOSE"));
    assert_eq!(located.report.frames.n_used[220], 5);
}

#[test]
fn frames_without_a_pose_are_named_and_bridged() {
    let mut capture = capture();
    for k in 0..8 {
        // Two stay visible, then none.
        let from = if k < 2 { 230 } else { 200 };
        (from..240).for_each(|f| capture.trajectories[k].track.set(f, None));
    }
    let located = located(&capture);
    assert_near(&located);
    assert_eq!(located.report.n_without_pose(), 0);
    let [gap] = &located.report.without_pose[..] else { panic!("{:?}", located.report.without_pose) };
    assert_eq!((gap.span.first_frame, gap.span.last_frame, gap.n_visible), (201, 240, 2));
    assert_eq!(gap.why, "fewer than 3 head markers are seen");
    assert_eq!(located.report.frames.residual_m[220], None);
    let told = located.head.poses[220].as_ref().unwrap();
    assert_eq!((Some(told.expected_error_m), told.n_used), (gap.bridged_to_m, 0));
    assert!(told.expected_error_m < 1e-3, "a slow turn is foretold: {} m", told.expected_error_m);
    // The hair goes along with the head in this capture.
    let hair = |f: usize| located.head.strands[0].markers[0].at(f).unwrap();
    let off = (hair(220) - hair(190)).norm();
    assert!(off < 3.0 * told.expected_error_m + 1e-3, "{off} m");
}

/// Within the gap the head turned to and fro, which nobody can tell.
#[test]
fn a_gap_that_hides_a_whole_nod_is_not_bridged() {
    let mut capture = capture();
    (0..8).for_each(|k| (180..420).for_each(|f| capture.trajectories[k].track.set(f, None)));
    let located = located(&capture);
    assert_eq!(located.report.n_without_pose(), 240);
    assert_eq!(located.report.without_pose[0].bridged_to_m, None);
    assert_eq!(located.head.strands[0].markers[0].at(300), None, "hair is not seen from a head that is not");
    let bridged = &located.tracked.poses.poses[182];
    let angle = bridged.rotation.angle_to(&pose(turn_rad(182)).rotation);
    assert!(angle < 0.05, "bridged {angle} rad off");
}

#[test]
fn still_heads_keep_their_pose() {
    let mut still = capture();
    for trajectory in &mut still.trajectories {
        (120..N_FRAMES).for_each(|f| trajectory.track.set(f, trajectory.track.at(f - 120)));
    }
    (0..8).for_each(|k| (200..300).for_each(|f| still.trajectories[k].track.set(f, None)));
    let located = located(&still);
    assert!(!located.tracked.report.moves);
    assert_eq!(located.report.n_without_pose(), 0);
    assert!(located.head.strands[0].markers[0].at(250).is_some());
}

#[test]
fn three_that_are_left_are_enough_and_a_shaking_one_is_not() {
    let mut capture = capture();
    for k in [0, 2, 4, 6, 7] {
        (250..320).for_each(|f| capture.trajectories[k].track.set(f, None));
    }
    // A marker that hangs by a thread: 1 cm to and fro.
    for f in 0..N_FRAMES {
        let shaken =
            capture.trajectories[5].track.at(f).map(|p| p + Vec3::x() * 0.01 * libm::sin(f as f64 * 0.9));
        capture.trajectories[5].track.set(f, shaken);
    }
    let located = located(&capture);
    let jaw = &located.report.markers[5];
    assert!(!jaw.trusted, "{jaw:?}");
    // Then two good ones are left in those frames, and the poses around tell more than a wrong one.
    let [gap] = &located.report.without_pose[..] else { panic!("{:?}", located.report.without_pose) };
    assert_eq!((gap.span.n_frames(), gap.n_visible), (70, 3));
    assert!(gap.why.contains("follow the head") && gap.bridged_to_m.is_some_and(|m| m < 5e-3), "{gap:?}");
    assert_near(&located);
}

#[test]
fn a_head_never_seen_is_an_error_that_says_so() {
    let mut capture = capture();
    for k in 0..6 {
        capture.trajectories[k].track = Track::missing(N_FRAMES);
    }
    let error = locate_head(&capture, &session(), &HeadOptions::default()).unwrap_err();
    assert!(matches!(error, HeadError::NoPose { n_frames: N_FRAMES, .. }), "{error}");
    capture.trajectories.drain(..6);
    let error = locate_head(&capture, &session(), &HeadOptions::default()).unwrap_err();
    let expected = "found 2 of the head's markers in the capture, expected at least 3: it does not have LFHD, RFHD, NOSE, LCHK, RCHK, JAW";
    assert_eq!(error.to_string(), expected);
}

/// Programs leave out a marker that was never labeled: no column, or an empty one, is the same.
#[test]
fn a_marker_without_a_column_was_never_seen() {
    let mut capture = capture();
    for idx in [2, 8] {
        capture.trajectories[idx].track = Track::missing(N_FRAMES);
    }
    let empty = located(&capture);
    capture.trajectories.retain(|t| t.track.n_valid() > 0);
    let absent = located(&capture);
    assert!(absent.report == empty.report && absent.tracked == empty.tracked);
    assert_near(&empty);
    let nose = &empty.report.markers[2];
    assert!(nose.is_never_seen() && !nose.is_left_out(), "{nose:?}");
    assert!(empty.report.markers[LNCK].is_left_out());
    assert_eq!(empty.head.strands[0].markers[0].n_valid(), 0);
}
