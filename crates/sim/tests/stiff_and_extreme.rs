//! The list of stiff and extreme cases: nothing explodes, stretches or turns into NaN, whatever is asked.

mod common;

use common::{
    DOWN, assert_sound, mannequin, nearest, options, over_the_head, run, still_air, straight, track, uniform,
    vacuum,
};
use tousle_core::{Pose, PoseTrack, Quantity, Strand, Vec3};
use tousle_field::Scene;
use tousle_sim::{Integrator, Method, SimError, SimOptions, TimeMode};

const STEPS_SECS: [f64; 3] = [1.0 / 24.0, 1.0 / 120.0, 1.0 / 960.0];

fn locks() -> Vec<Strand> {
    vec![
        over_the_head(),
        straight(Vec3::new(0.05, 0.08, 0.03), Vec3::new(0.3, 0.3, -1.0), 0.25, 12),
        straight(Vec3::new(-0.098, 0.0, 0.0), Vec3::new(-1.0, 0.0, -0.2), 0.12, 1),
    ]
}

fn options_at(dt_secs: f64) -> SimOptions {
    SimOptions { rate_hz: 24.0, ..options(Integrator::Exponential, dt_secs, 2.0) }
}

/// From limp to a stiffness over inertia of 1e10 s⁻² and more, damped and not, at every step.
#[test]
fn any_stiffness() {
    let wind = uniform(Quantity::AirVelocity, 30.0, &[Vec3::new(-6.0, 2.0, 0.0)]);
    for dt_secs in STEPS_SECS {
        for bending_stiffness_n_m2 in [0.0, 1e-9, 1e-6, 1e-3, 1.0, 1e3] {
            for internal_damping_secs in [0.0, 0.02, 10.0] {
                let strands = locks().into_iter().map(|lock| Strand {
                    bending_stiffness_n_m2,
                    internal_damping_secs,
                    ..lock
                });
                let simulation = run(&wind, &mannequin(), strands.collect(), &options_at(dt_secs)).unwrap();
                assert_sound(
                    &simulation,
                    &format!("EI {bending_stiffness_n_m2}, damping {internal_damping_secs}, dt {dt_secs}"),
                );
            }
        }
    }
}

/// 100 m/s from the first step on, and turning about with each field step; with and without gravity.
#[test]
fn any_wind() {
    let reversing: Vec<Vec3> =
        (0..60).map(|k| Vec3::new(if k % 2 == 0 { 100.0 } else { -100.0 }, 20.0, 0.0)).collect();
    let fields = [
        uniform(Quantity::AirVelocity, 30.0, &[Vec3::new(60.0, -80.0, 0.0)]),
        uniform(Quantity::AirVelocity, 30.0, &reversing),
        uniform(Quantity::ForcePerMass, 30.0, &reversing.iter().map(|v| v * 1000.0).collect::<Vec<_>>()),
    ];
    for dt_secs in STEPS_SECS {
        for field in &fields {
            for gravity in [DOWN, Vec3::zeros()] {
                let scene = Scene { gravity_world: gravity, ..mannequin() };
                let simulation = run(field, &scene, locks(), &options_at(dt_secs)).unwrap();
                let nearest = nearest(&scene, &simulation.motion);
                assert!(nearest > 1e-3, "{nearest} m from the body, dt {dt_secs}");
                assert_sound(
                    &simulation,
                    &format!("{:?}, dt {dt_secs}, gravity {gravity:?}", field.quantity),
                );
            }
        }
    }
}

/// After a storm of 100 m/s has ended, hair comes to rest: the air takes its energy, and nothing gives it more.
#[test]
fn a_storm_ends() {
    let storm = uniform(Quantity::AirVelocity, 30.0, &[Vec3::new(100.0, 0.0, 0.0); 16]);
    for dt_secs in STEPS_SECS {
        let mut options = options_at(dt_secs);
        (options.time, options.duration_secs) = (TimeMode::Once, Some(30.0));
        let motion = run(&storm, &mannequin(), locks(), &options).unwrap().motion;
        let n = motion.times_secs.len();
        for point in 0..motion.n_points() {
            let track = track(&motion, point);
            let late = (n - 24..n).map(|k| (track[k] - track[n - 1]).norm()).fold(0.0, f64::max);
            assert!(late < 2e-3, "dt {dt_secs}, point {point}: still moves by {late} m");
        }
    }
}

/// 2000°/s, a head that jumps by a meter and turns about from one pose to the next.
#[test]
fn any_head() {
    let spin = |k: i32| {
        nalgebra::UnitQuaternion::from_scaled_axis(
            Vec3::new(0.1, 0.2, 1.0).normalize() * (f64::from(k) * 34.9 / 120.0),
        )
    };
    let jump = |k: i32| if k < 60 { 0.0 } else { 1.0 };
    let turn =
        |k: i32| nalgebra::UnitQuaternion::from_scaled_axis(Vec3::z() * (if k < 60 { 0.0 } else { 3.0 }));
    let poses: [Vec<Pose>; 2] = [
        (0..240).map(|k| Pose::from_parts(Vec3::zeros().into(), spin(k))).collect(),
        (0..240).map(|k| Pose::from_parts((Vec3::x() * jump(k)).into(), turn(k))).collect(),
    ];
    for poses in poses {
        let scene = Scene { poses: PoseTrack { start_secs: 0.0, rate_hz: 120.0, poses }, ..mannequin() };
        for dt_secs in STEPS_SECS {
            let simulation = run(&still_air(), &scene, locks(), &options_at(dt_secs)).unwrap();
            let nearest = nearest(&scene, &simulation.motion);
            assert!(nearest > 1e-3, "{nearest} m from the body, dt {dt_secs}");
            assert_sound(&simulation, &format!("dt {dt_secs}"));
        }
    }
}

/// A thousand sticks; sticks of 10 µm beside 10 cm, which is also a mass ratio of 1e4; hair folded back on itself.
#[test]
fn any_strand() {
    let mut uneven: Vec<Vec3> = Vec::new();
    let mut x = 0.1;
    for k in 0..12 {
        uneven.push(Vec3::new(x, 0.0, 0.0));
        x += if k % 2 == 0 { 0.1 } else { 1e-5 };
    }
    let folded =
        (0..10).map(|k| Vec3::new(0.12, 0.002 * f64::from(k), if k % 2 == 0 { 0.0 } else { 0.03 })).collect();
    let strands = vec![
        straight(Vec3::new(0.0, 0.08, 0.03), Vec3::new(0.0, 0.3, -1.0), 0.4, 1000),
        common::strand(uneven),
        common::strand(folded),
    ];
    let wind = uniform(Quantity::AirVelocity, 30.0, &[Vec3::new(-8.0, 3.0, 1.0)]);
    for dt_secs in [1.0 / 24.0, 1.0 / 120.0] {
        let simulation = run(&wind, &mannequin(), strands.clone(), &options_at(dt_secs)).unwrap();
        // Positions are single precision: 1e-8 m of rounding is a thousandth of a stick of 10 µm.
        let finite = simulation.motion.positions_m.iter().flatten().all(|c| c.is_finite());
        assert!(finite && simulation.report.max_stretch < 1e-2, "{}", simulation.report.max_stretch);
    }
}

/// Blown upside down and over the top: through every angle, up to 180° from rest.
#[test]
fn any_angle() {
    let scene = Scene { air_density: 1.2, ..vacuum(DOWN) };
    for wind in [Vec3::z() * 30.0, -Vec3::z() * 30.0, Vec3::new(0.0, 1e-9, 20.0)] {
        let field = uniform(Quantity::AirVelocity, 30.0, &[wind]);
        for dt_secs in STEPS_SECS {
            let strand = straight(Vec3::new(0.0, 0.0, 0.1), -Vec3::z(), 0.2, 10);
            assert_sound(
                &run(&field, &scene, vec![strand], &options_at(dt_secs)).unwrap(),
                &format!("{wind:?}"),
            );
        }
    }
}

/// Semi-implicit Euler refuses what it does not stand, and names the limit; within it, it holds.
#[test]
fn an_unstable_step_is_refused_with_its_limit() {
    let stiff = || {
        vec![Strand {
            bending_stiffness_n_m2: 1e-2,
            ..straight(Vec3::new(0.2, 0.0, 0.0), -Vec3::z(), 0.1, 6)
        }]
    };
    let error = run(&still_air(), &mannequin(), stiff(), &options(Integrator::SemiImplicit, 1.0 / 60.0, 0.5))
        .unwrap_err();
    let SimError::Unstable { limit_secs, dt_secs, point, .. } = error else { panic!("{error}") };
    assert!(limit_secs < 1e-3 && dt_secs > limit_secs && point == Some(6), "{error}");
    assert!(error.to_string().contains("semi-implicit"), "{error}");
    let wind = uniform(Quantity::AirVelocity, 30.0, &[Vec3::new(30.0, 0.0, 0.0)]);
    // What it chooses by itself is within the limit.
    let by_itself = SimOptions {
        method: Method::Paper,
        integrator: Some(Integrator::SemiImplicit),
        duration_secs: Some(0.5),
        ..SimOptions::default()
    };
    let simulation = run(&wind, &mannequin(), stiff(), &by_itself).unwrap();
    assert!(simulation.report.dt_secs < 1e-3);
    assert_sound(&simulation, "within the limit");
}

#[test]
fn what_is_not_a_number_is_refused() {
    let good = || straight(Vec3::new(0.2, 0.0, 0.0), -Vec3::z(), 0.1, 4);
    let fine = options(Integrator::Exponential, 0.01, 0.1);
    let mut bad = good();
    bad.rest_curve_m[2].y = f64::NAN;
    assert!(matches!(run(&still_air(), &mannequin(), vec![bad], &fine), Err(SimError::Groom(_))));
    assert!(matches!(run(&still_air(), &mannequin(), Vec::new(), &fine), Err(SimError::Groom(_))));
    let mut field = still_air();
    field.steps[0].u[3] = f32::INFINITY;
    assert!(matches!(run(&field, &mannequin(), vec![good()], &fine), Err(SimError::Field(_))));
    let scenes = [
        Scene { gravity_world: Vec3::new(0.0, f64::NAN, 0.0), ..mannequin() },
        Scene { air_density: -1.0, ..mannequin() },
        Scene { poses: PoseTrack { start_secs: 0.0, rate_hz: 1.0, poses: Vec::new() }, ..mannequin() },
        Scene {
            poses: PoseTrack { start_secs: 0.0, rate_hz: 0.0, poses: vec![Pose::identity()] },
            ..mannequin()
        },
    ];
    for scene in scenes {
        let error = run(&still_air(), &scene, vec![good()], &fine).unwrap_err();
        assert!(matches!(error, SimError::BadScene { .. }), "{error}");
    }
    let bad_options = [
        SimOptions { rate_hz: 0.0, ..fine.clone() },
        SimOptions { rate_hz: f64::NAN, ..fine.clone() },
        SimOptions { dt_secs: Some(-0.1), ..fine.clone() },
        SimOptions { dt_secs: Some(1e-30), ..fine.clone() },
        SimOptions { duration_secs: Some(f64::INFINITY), ..fine.clone() },
        SimOptions { duration_secs: Some(1e12), ..fine.clone() },
        SimOptions { start_secs: Some(f64::NAN), ..fine },
    ];
    for options in bad_options {
        let error = run(&still_air(), &mannequin(), vec![good()], &options).unwrap_err();
        assert!(matches!(error, SimError::BadOption { .. }), "{error}");
    }
}
