//! Every capture of the shared folder, its session beside it.

use std::path::{Path, PathBuf};
use tousle_ingest::{IngestOptions, check_against, read_capture, read_session};

const CAPTURES: [&str; 6] =
    ["steady_front", "gusts_left", "sweep_0_120", "turbulent_dirty", "two_fans", "nod_turn"];

fn shared() -> Option<PathBuf> {
    let folder = std::env::var_os("TOUSLE_SHARED");
    if folder.is_none() {
        println!("skipped: TOUSLE_SHARED is not set");
    }
    folder.map(PathBuf::from)
}

fn bytes(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

#[test]
fn csv_and_session_of_every_capture_go_together() {
    let Some(shared) = shared() else { return };
    for name in CAPTURES {
        let folder = shared.join("captures").join(name);
        let session = read_session(&bytes(&folder.join("session.json"))).unwrap();
        let options = IngestOptions::from_session(&session);
        let ingested = read_capture(&bytes(&folder.join(format!("{name}.csv"))), &options).unwrap();
        let capture = &ingested.capture;
        assert_eq!(ingested.report.warnings, [""; 0], "{name}");
        assert_eq!(check_against(capture, &session).unwrap(), [""; 0], "{name}");
        assert_eq!((capture.rate_hz, capture.first_frame), (120.0, 1), "{name}");
        assert!(capture.n_frames >= 600, "{name}");
        assert_eq!(session.strands.len(), 27, "{name}");
        let assumed: Vec<&str> = session.assumed.iter().map(|a| a.what.as_str()).collect();
        assert_eq!(assumed, ["head_pivot_mm", "friction"], "{name}");
        // The note in the files says where the head really turns: the default is near.
        let pivot = tousle_core::Vec3::new(-0.020, 0.0, -0.110);
        assert!((session.body.pivot_m - pivot).norm() < 0.006, "{name}");
    }
}

/// The CSV has decimals, the float C3D single precision, the integer C3D steps of 0.1 mm.
#[test]
fn three_files_of_one_trial_are_one_capture() {
    let Some(shared) = shared() else { return };
    let read = |name: &str| {
        let ingested =
            read_capture(&bytes(&shared.join("captures/two_fans").join(name)), &IngestOptions::default());
        ingested.unwrap_or_else(|e| panic!("{name}: {e}")).capture
    };
    let csv = read("two_fans.csv");
    // Half a step of the integer file, and of the last decimal of six in the CSV; single precision near 2 m.
    for (other, tolerance_m) in
        [("two_fans.c3d", 0.005e-3 + 2e-7), ("two_fans_int.c3d", 0.05e-3 + 0.005e-3 + 2e-7)]
    {
        let c3d = read(other);
        assert_eq!(c3d.rate_hz, csv.rate_hz);
        assert_eq!((c3d.first_frame, c3d.n_frames), (csv.first_frame, csv.n_frames));
        assert_eq!(c3d.file_unit, csv.file_unit);
        assert_eq!(c3d.trajectories.len(), csv.trajectories.len());
        let mut worst = 0.0_f64;
        for (a, b) in c3d.trajectories.iter().zip(&csv.trajectories) {
            assert_eq!((&a.subject, &a.label), (&b.subject, &b.label));
            for (frame, (p, q)) in a.track.iter().zip(b.track.iter()).enumerate() {
                assert_eq!(p.is_some(), q.is_some(), "{other}: {} in frame {frame}", a.label);
                if let (Some(p), Some(q)) = (p, q) {
                    worst = worst.max((p - q).amax());
                }
            }
        }
        println!("{other}: worst difference {:.2e} m", worst);
        assert!(worst <= tolerance_m && worst > 0.0, "{other}: {worst} m");
    }
}
