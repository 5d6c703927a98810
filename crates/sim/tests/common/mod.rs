//! Small worlds with known answers.
#![allow(dead_code, reason = "each test file uses its own part")]

pub mod head;

#[allow(unused_imports, reason = "each test file uses its own part")]
pub use tousle_bench::worlds::{
    DOWN, groom, mannequin, nearest_m, over_the_head, push, still_air, straight, strand, uniform, vacuum,
};
use tousle_core::{NoProgress, Quantity, Strand, StrandMotion, Vec3};
use tousle_field::{FieldLayer, FieldSequence, Handle, Scene};
use tousle_sim::{Integrator, Method, SimError, SimOptions, Simulation, simulate};

pub fn run(
    field: &FieldSequence,
    scene: &Scene,
    strands: Vec<Strand>,
    options: &SimOptions,
) -> Result<Simulation, SimError> {
    simulate(field, scene, &groom(strands), options, &NoProgress)
}

pub fn options(integrator: Integrator, dt_secs: f64, duration_secs: f64) -> SimOptions {
    SimOptions {
        method: Method::Paper,
        integrator: Some(integrator),
        dt_secs: Some(dt_secs),
        duration_secs: Some(duration_secs),
        ..SimOptions::default()
    }
}

/// The same with method `physical`.
pub fn physical(integrator: Integrator, dt_secs: f64, duration_secs: f64) -> SimOptions {
    SimOptions { method: Method::Physical, ..options(integrator, dt_secs, duration_secs) }
}

/// One control point over all frames.
pub fn track(motion: &StrandMotion, point: usize) -> Vec<Vec3> {
    (0..motion.times_secs.len()).map(|frame| Vec3::from(motion.frame(frame)[point].map(f64::from))).collect()
}

/// The farthest that any point gets from where it was in the first frame, m.
pub fn farthest(motion: &StrandMotion) -> f64 {
    (0..motion.n_points())
        .flat_map(|k| {
            let track = track(motion, k);
            let first = track[0];
            track.into_iter().map(move |p| (p - first).norm())
        })
        .fold(0.0, f64::max)
}

/// Panics unless every position is finite and no stick has changed its length by a thousandth.
pub fn assert_sound(simulation: &Simulation, what: &str) {
    let finite = simulation.motion.positions_m.iter().flatten().all(|c| c.is_finite());
    assert!(finite, "{what}: not finite");
    assert!(simulation.report.max_stretch < 1e-3, "{what}: stretch {}", simulation.report.max_stretch);
}

/// A layer that blows for 0.4 s, from 0.5 s on, near the hair in front.
pub fn lift(extra: Vec3) -> FieldLayer {
    push(Handle { center_m: Vec3::new(0.1, 0.0, -0.1), reach_m: 0.3, extra }, (0.5, 0.9))
}

/// A wind from the front that swings from side to side, for 1 s.
pub fn gusts() -> FieldSequence {
    let gust = |k: i32| Vec3::new(-2.0, 3.0 * libm::sin(0.4 * f64::from(k)), 0.5);
    uniform(Quantity::AirVelocity, 30.0, &(0..31).map(gust).collect::<Vec<_>>())
}

/// Strands of 5 to 11 points all round the head.
pub fn many() -> Vec<Strand> {
    (0..23)
        .map(|k| {
            let (sin, cos) = libm::sincos(0.27 * f64::from(k));
            straight(
                Vec3::new(0.1 * cos, 0.09 * sin, 0.03),
                Vec3::new(0.2 * cos, 0.2 * sin, -1.0),
                0.2,
                5 + k as usize % 7,
            )
        })
        .collect()
}
