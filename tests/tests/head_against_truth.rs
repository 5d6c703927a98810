//! The head's pose against the truth of captures that a stranger does not have (`TOUSLE_SHARED`).

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fs;
use std::path::Path;
use tousle_bench::Truth;
use tousle_head::{HeadOptions, locate_head};
use tousle_ingest::{IngestOptions, read_capture, read_session};
use tousle_tests::{name, shared_captures};

/// Root mean square errors of the head's center (mm) and turn (mrad), per frame and of the smooth track.
fn errors(folder: &Path) -> [f64; 4] {
    let name = name(folder);
    let session = read_session(&fs::read(folder.join("session.json")).unwrap()).unwrap();
    let bytes = fs::read(folder.join(format!("{name}.csv"))).unwrap();
    let capture = read_capture(&bytes, &IngestOptions::from_session(&session)).unwrap().capture;
    let located = locate_head(&capture, &session, &HeadOptions::default()).unwrap();
    let tracked = &located.tracked;
    let truth = Truth::open(folder).unwrap().head().unwrap();
    let mut sums = [0.0; 4];
    let mut n = 0.0;
    for (frame, pose) in located.head.poses.iter().enumerate() {
        let time_secs = frame as f64 / capture.rate_hz;
        let smooth = tracked.poses.motion_at(time_secs).world_from_head;
        let truth = truth.poses[frame];
        let Some(pose) = pose else { continue };
        for (k, pose) in [pose.world_from_head, smooth].iter().enumerate() {
            sums[2 * k] += (pose.translation.vector - truth.translation.vector).norm_squared();
            sums[2 * k + 1] += pose.rotation.angle_to(&truth.rotation).powi(2);
        }
        n += 1.0;
    }
    let untrusted = located.report.markers.iter().filter(|m| !m.trusted).map(|m| m.label.as_str());
    let untrusted: Vec<&str> = untrusted.collect();
    println!("{name}: {:?}, not trusted: {untrusted:?}", tracked.report);
    sums.map(|s: f64| (s / n).sqrt() * 1e3)
}

/// The session's marker places carry a hand's error of 1 to 2 mm, so no pose can be nearer than about that.
#[test]
fn poses_are_as_near_as_the_session_allows() {
    for folder in shared_captures() {
        let [frame_mm, frame_mrad, smooth_mm, smooth_mrad] = errors(&folder);
        println!(
            "  per frame {frame_mm:.2} mm {frame_mrad:.2} mrad; smooth {smooth_mm:.2} mm {smooth_mrad:.2} mrad"
        );
        assert!(frame_mm < 1.5 && smooth_mm < 1.5, "{}: {frame_mm} mm, {smooth_mm} mm", folder.display());
        assert!(
            frame_mrad < 15.0 && smooth_mrad < 15.0,
            "{}: {frame_mrad}, {smooth_mrad} mrad",
            folder.display()
        );
    }
}
