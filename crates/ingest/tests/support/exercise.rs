// What has to hold for any bytes whatever; the fuzz targets include this file too.

use tousle_core::{LengthUnit, Session};
use tousle_ingest::{IngestOptions, guess_format, read_capture, read_session, summarize};

/// Takes bytes for a capture: the guess at its format, its summary, its markers.
///
/// # Panics
/// If summary and capture contradict themselves, if a position is no number, or if an error says nothing.
pub fn exercise_capture(bytes: &[u8]) {
    let guess = guess_format(bytes);
    match summarize(bytes) {
        Ok(summary) => {
            assert!(guess.is_some());
            let valid: usize = summary.trajectories.iter().map(|t| t.valid).sum();
            assert_eq!(valid + summary.invalid_samples, summary.frames * summary.trajectories.len());
            assert!(summary.labels.len() <= summary.trajectories.len());
        }
        Err(e) => assert!(!e.to_string().is_empty()),
    }
    let unit = Some(LengthUnit::Millimeter);
    let options = IngestOptions { unit, rate_hz: Some(100.0), allow_cut: true, ..IngestOptions::default() };
    match read_capture(bytes, &options) {
        Ok(read) => {
            let capture = read.capture;
            assert!(capture.n_frames > 0 && capture.rate_hz > 0.0 && !capture.trajectories.is_empty());
            for trajectory in &capture.trajectories {
                assert_eq!(trajectory.track.n_frames(), capture.n_frames);
                assert!(trajectory.track.iter().flatten().all(|p| p.iter().all(|x| x.is_finite())));
            }
        }
        Err(e) => assert!(!e.to_string().is_empty()),
    }
}

/// Takes bytes for a session.
///
/// # Panics
/// If a session holds what nothing can be computed from, or if an error says nothing.
pub fn exercise_session(bytes: &[u8]) {
    match read_session(bytes) {
        Ok(session) => check(&session),
        Err(e) => assert!(!e.to_string().is_empty()),
    }
}

fn check(session: &Session) {
    assert!(session.air_density.is_finite());
    for marker in &session.head_markers {
        assert!(marker.position_m.iter().all(|x| x.is_finite()));
    }
    for strand in &session.strands {
        assert!(strand.root_m.iter().all(|x| x.is_finite()));
        let numbers = [strand.length_m, strand.linear_density_kg_per_m, strand.lock_width_m];
        assert!(numbers.iter().all(|x| x.is_finite() && *x > 0.0), "{numbers:?}");
        let distances = strand.markers.iter().filter_map(|m| m.distance_from_root_m);
        assert!(distances.into_iter().all(f64::is_finite));
    }
    assert!(session.fans.iter().all(|f| f.speed_mps.is_finite() && f.from_azimuth_rad.is_finite()));
}
