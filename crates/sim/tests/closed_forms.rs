//! Cases whose answer is known in closed form.

mod common;

use common::head::{apart, rises, speeding_up, tilted, turned_about_z, turning};
use common::{DOWN, options, run, straight, track, uniform, vacuum};
use tousle_core::{Quantity, Vec3};
use tousle_field::Scene;
use tousle_sim::{Integrator, Method, TimeMode};

/// One limp stick with its mass at the tip is a pendulum: 2π √(l/g), 0.7778 s for 15 cm and 5° of swing.
#[test]
fn a_stick_swings_like_a_pendulum() {
    for integrator in Integrator::of(Method::Paper).iter().copied() {
        let mut stick = straight(Vec3::zeros(), -Vec3::z(), 0.15, 1);
        stick.bending_stiffness_n_m2 = 0.0;
        let options = options(integrator, 1.0 / 600.0, 8.0);
        let motion = run(
            &uniform(Quantity::ForcePerMass, 30.0, &[Vec3::zeros()]),
            &tilted(0.0873),
            vec![stick],
            &options,
        )
        .unwrap()
        .motion;
        let x: Vec<f64> = track(&motion, 1).iter().map(|p| p.x).collect();
        let middle = 0.15 * libm::sin(0.0873);
        let rises = rises(&x, middle, 60.0);
        let period = (rises[rises.len() - 1] - rises[0]) / (rises.len() - 1) as f64;
        // The exact period of a pendulum is 1 + θ²/16 times that of a small swing.
        let expected = core::f64::consts::TAU * (0.15_f64 / 9.81).sqrt() * (1.0 + 0.0873 * 0.0873 / 16.0);
        assert!((period / expected - 1.0).abs() < 1e-4, "{integrator:?}: {period} against {expected}");
    }
}

/// A springy stick without gravity, pushed aside and let go: its swings fade as e^(−βt), β = ½ T τ/I1.
#[test]
fn internal_damping_fades_a_swing() {
    // τ = 2 EI/l = 4e-5 N·m, mass at the tip ½ρl = 75 mg, I = 7.5e-7: ω² = 53.3, β = ½ · 0.02 · 53.3 = 0.533.
    let stick = straight(Vec3::zeros(), Vec3::x(), 0.1, 1);
    let push = Vec3::new(0.0, 0.0, 0.5);
    let field = uniform(Quantity::ForcePerMass, 1.0, &[push, push, push, push]);
    for integrator in Integrator::of(Method::Paper).iter().copied() {
        let mut options = options(integrator, 1.0 / 960.0, 8.0);
        options.time = TimeMode::Once;
        let motion = run(&field, &vacuum(Vec3::zeros()), vec![stick.clone()], &options).unwrap().motion;
        let z: Vec<f64> = track(&motion, 1).iter().map(|p| p.z).collect();
        let peaks: Vec<(f64, f64)> = (190..z.len() - 1)
            .filter(|k| z[*k] > z[k - 1] && z[*k] > z[k + 1] && z[*k] > 0.0)
            .map(|k| (k as f64 / 60.0, z[k]))
            .collect();
        let (first, last) = (peaks[0], peaks[3]);
        let beta = libm::log(first.1 / last.1) / (last.0 - first.0);
        assert!((beta / 0.533 - 1.0).abs() < 0.03, "{integrator:?}: {beta}");
    }
}

/// A clamped strand under a weak push across: the tip yields by q L⁴ / 8EI once it has come to rest.
#[test]
fn a_weak_push_bends_a_strand_like_a_clamped_rod() {
    for n_sticks in [4, 12] {
        let mut strand = straight(Vec3::zeros(), Vec3::x(), 0.12, n_sticks);
        strand.internal_damping_secs = 0.2;
        let push = 0.02;
        let field = uniform(Quantity::ForcePerMass, 1.0, &[Vec3::z() * push]);
        let options = options(Integrator::Exponential, 1.0 / 240.0, 20.0);
        let motion = run(&field, &vacuum(Vec3::zeros()), vec![strand], &options).unwrap().motion;
        let tip = track(&motion, n_sticks).pop().unwrap();
        let expected = 1.5e-3 * push * 0.12_f64.powi(4) / (8.0 * 2e-6);
        // A chain's error falls as the square of the length of a stick.
        let tolerance = f64::max(1.1 / (n_sticks * n_sticks) as f64, 2e-3);
        assert!((tip.z / expected - 1.0).abs() < tolerance, "{n_sticks}: {} against {expected}", tip.z);
    }
}

/// A strand in a wind settles the same however many sticks it has, and on the way stays near itself.
#[test]
fn the_number_of_sticks_does_not_matter() {
    let wind = uniform(Quantity::AirVelocity, 1.0, &[Vec3::new(-2.0, 0.5, 0.0)]);
    let scene = Scene { air_density: 1.2, ..vacuum(DOWN) };
    let tip = |n_sticks: usize| {
        let strand = straight(Vec3::zeros(), -Vec3::z(), 0.24, n_sticks);
        let options = options(Integrator::Exponential, 1.0 / 480.0, 1.5);
        track(&run(&wind, &scene, vec![strand], &options).unwrap().motion, n_sticks)
    };
    let (coarse, fine) = (tip(8), tip(32));
    let apart = coarse.iter().zip(&fine).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    let moved = fine.iter().map(|p| (p - fine[0]).norm()).fold(0.0, f64::max);
    assert!(moved > 0.1 && apart < 0.1 * moved, "{apart} of {moved}");
}

/// A head that speeds up evenly feels like one under a tilted gravity.
#[test]
fn a_heads_acceleration_is_gravity_tilted() {
    let acceleration = Vec3::new(2.0, -1.0, 0.5);
    let field = uniform(Quantity::ForcePerMass, 1.0, &[Vec3::zeros()]);
    let strand = || vec![straight(Vec3::new(0.0, 0.0, 0.1), Vec3::new(-0.3, 0.1, -1.0), 0.2, 8)];
    let options = options(Integrator::Exponential, 1.0 / 240.0, 1.5);
    let speeding = run(&field, &speeding_up(acceleration), strand(), &options).unwrap().motion;
    // The same strand at rest under true gravity, with the missing part as a force on every point.
    let instead = uniform(Quantity::ForcePerMass, 1.0, &[-acceleration]);
    let pushed = run(&instead, &vacuum(DOWN), strand(), &options).unwrap().motion;
    let apart = apart(&speeding, &pushed);
    assert!(common::farthest(&pushed) > 0.02);
    assert!(apart < 2e-4, "{apart}");
}

/// A limp strand whose root is the pivot does not know that the head turns: it stays where it is in the world.
/// As the head sees it, Euler's, Coriolis' and the centrifugal force swing it round.
#[test]
fn a_turning_head_leaves_a_limp_strand_behind() {
    let (scene, angle) = turning();
    let field = uniform(Quantity::ForcePerMass, 1.0, &[Vec3::zeros()]);
    for n_sticks in [1, 6] {
        let mut limp = straight(Vec3::zeros(), Vec3::new(1.0, 0.0, 0.4), 0.2, n_sticks);
        limp.bending_stiffness_n_m2 = 0.0;
        let options = options(Integrator::Exponential, 1.0 / 960.0, 1.0);
        let motion = run(&field, &scene, vec![limp], &options).unwrap().motion;
        let tip = track(&motion, n_sticks);
        let turned = turned_about_z(-angle).rotation * tip[0];
        assert!((tip[60] - turned).norm() < 2e-3, "{n_sticks}: {} against {turned}", tip[60]);
    }
}

/// Without anything to lose it to, a limp chain keeps its energy: the height it swings back to does not change.
#[test]
fn a_swing_keeps_its_energy() {
    for integrator in Integrator::of(Method::Paper).iter().copied() {
        let mut stick = straight(Vec3::zeros(), -Vec3::z(), 0.15, 1);
        stick.bending_stiffness_n_m2 = 0.0;
        let options = options(integrator, 1.0 / 120.0, 60.0);
        let field = uniform(Quantity::ForcePerMass, 30.0, &[Vec3::zeros()]);
        let motion = run(&field, &tilted(1.0), vec![stick], &options).unwrap().motion;
        let x: Vec<f64> = track(&motion, 1).iter().map(|p| p.x).collect();
        let widest = |range: core::ops::Range<usize>| x[range].iter().copied().fold(0.0, f64::max);
        let (early, late) = (widest(0..240), widest(3360..3600));
        assert!((late / early - 1.0).abs() < 0.01, "{integrator:?}: {early} then {late}");
    }
}

/// Halving the step halves the distance from the converged motion: order 1, as the integrators say.
#[test]
fn the_error_falls_with_the_step() {
    let wind: Vec<Vec3> =
        (0..40).map(|k| Vec3::new(-3.0, 2.0 * libm::sin(0.6 * f64::from(k)), 0.0)).collect();
    let field = uniform(Quantity::AirVelocity, 30.0, &wind);
    let scene = Scene { air_density: 1.2, ..vacuum(DOWN) };
    let strand = || vec![straight(Vec3::zeros(), Vec3::new(-0.5, 0.2, -1.0), 0.25, 10)];
    let end = |integrator: Integrator, steps_per_frame: f64| {
        let options = options(integrator, 1.0 / (60.0 * steps_per_frame), 1.3);
        run(&field, &scene, strand(), &options).unwrap().motion
    };
    let reference = end(Integrator::SemiImplicit, 512.0);
    for integrator in Integrator::of(Method::Paper).iter().copied() {
        let [coarse, fine] = [4.0, 8.0].map(|steps| {
            let motion = end(integrator, steps);
            let pairs = motion.positions_m.iter().zip(&reference.positions_m);
            let sum: f64 = pairs
                .map(|(a, b)| (Vec3::from(a.map(f64::from)) - Vec3::from(b.map(f64::from))).norm_squared())
                .sum();
            (sum / motion.positions_m.len() as f64).sqrt()
        });
        let ratio = coarse / fine;
        assert!((1.7..2.4).contains(&ratio), "{integrator:?}: {coarse} then {fine}");
        assert!(fine < 2e-3, "{integrator:?}: {fine}");
    }
}
