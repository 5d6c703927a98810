//! The method `physical` in the true wind of the captures: what it reached is kept.

use std::path::PathBuf;
use tousle_bench::worlds::uniform;
use tousle_bench::{CaptureFolder, sim_in_true_wind};
use tousle_core::{NoProgress, PoseTrack, Quantity, Vec3};
use tousle_field::Scene;
use tousle_sim::{Method, SimOptions, TimeMode, simulate};

fn shared() -> Option<PathBuf> {
    let shared = std::env::var_os("TOUSLE_SHARED").map(PathBuf::from);
    if shared.is_none() {
        eprintln!("skipped: TOUSLE_SHARED is not set");
    }
    shared
}

/// In air that all but stands still style B hangs as it did: no lock slides off the head, and none begins to swing.
#[test]
fn style_b_hangs_still() {
    let Some(shared) = shared() else { return };
    let breath = uniform(Quantity::AirVelocity, 30.0, &[Vec3::new(1e-6, 0.0, 0.0)]);
    let options =
        SimOptions { duration_secs: Some(5.0), time: TimeMode::Hold, ..SimOptions::of(Method::Physical) };
    for capture in CaptureFolder::all(&shared.join("captures")).unwrap() {
        let (scene, groom) = (capture.true_scene().unwrap(), capture.style_b().unwrap());
        let scene = Scene { poses: PoseTrack::still(scene.rest_pose), ..scene };
        let motion = simulate(&breath, &scene, &groom, &options, &NoProgress).unwrap().motion;
        let first = motion.frame(0).to_vec();
        let apart =
            |p: &[f32; 3], q: &[f32; 3]| (Vec3::from(p.map(f64::from)) - Vec3::from(q.map(f64::from))).norm();
        let moved = motion.positions_m.iter().zip(first.iter().cycle()).map(|(p, q)| apart(p, q));
        let moved = moved.fold(0.0, f64::max);
        assert!(moved < 1e-4, "{}: {moved} m", capture.name());
    }
}

/// At 60 steps a second: within .03 of the ceiling (the engine that made the captures), rounded down. In `nod_turn` it
/// takes friction as on a surface that goes back without a velocity (docs/physical.md, "Contact").
#[test]
fn style_b_moves_as_it_really_did() {
    let Some(shared) = shared() else { return };
    let options = SimOptions { dt_secs: Some(1.0 / 60.0), ..SimOptions::of(Method::Physical) };
    for (name, explained, median) in [
        ("gusts_left", 0.96, 0.97),
        ("nod_turn", 0.945, 0.975),
        ("steady_front", 0.975, 0.97),
        ("sweep_0_120", 0.96, 0.98),
        ("turbulent_dirty", 0.87, 0.925),
        ("two_fans", 0.96, 0.965),
    ] {
        let capture = CaptureFolder::open(&shared.join("captures").join(name)).unwrap();
        let score = sim_in_true_wind(&capture, &options).unwrap().score;
        let found = (score.points.explained_motion, score.locks.as_ref().unwrap().explained_median);
        assert!(
            found.0 >= explained && found.1 >= median,
            "{name}: {found:?}, expected {explained}, {median}"
        );
    }
}
