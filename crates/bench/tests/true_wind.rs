//! The method `physical` in the true wind of the captures: what it reached is kept.

use std::path::Path;
use tousle_bench::{CaptureFolder, sim_in_true_wind};
use tousle_sim::{Method, SimOptions};

/// At 60 steps a second: within .03 of the ceiling (the engine that made the captures), rounded down. In `nod_turn` it
/// takes friction as on a surface that goes back without a velocity (docs/physical.md, "Contact").
#[test]
fn style_b_moves_as_it_really_did() {
    let Some(shared) = std::env::var_os("TOUSLE_SHARED") else {
        eprintln!("skipped: TOUSLE_SHARED is not set");
        return;
    };
    let options = SimOptions { dt_secs: Some(1.0 / 60.0), ..SimOptions::of(Method::Physical) };
    for (name, explained, median) in [
        ("gusts_left", 0.96, 0.97),
        ("nod_turn", 0.945, 0.975),
        ("steady_front", 0.975, 0.97),
        ("sweep_0_120", 0.96, 0.98),
        ("turbulent_dirty", 0.87, 0.925),
        ("two_fans", 0.96, 0.965),
    ] {
        let capture = CaptureFolder::open(&Path::new(&shared).join("captures").join(name)).unwrap();
        let score = sim_in_true_wind(&capture, &options).unwrap().score;
        let found = (score.points.explained_motion, score.locks.as_ref().unwrap().explained_median);
        assert!(
            found.0 >= explained && found.1 >= median,
            "{name}: {found:?}, expected {explained}, {median}"
        );
    }
}
