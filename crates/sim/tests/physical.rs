//! The method `physical` against closed forms and its own contract: order, rest, length, independence.

mod common;

use common::head::{apart, head, rises, speeding_up, tilted, turned_about_z, turning};
use common::{
    DOWN, farthest, mannequin, over_the_head, physical, run, still_air, straight, strand, track, uniform,
    vacuum,
};
use tousle_core::{NoProgress, Pose, PoseTrack, Quantity, Strand, Vec3};
use tousle_field::Scene;
use tousle_sim::{Frame, Integrator, Method, Precision, SimError, SimOptions, Simulator, TimeMode};

fn no_wind() -> tousle_field::FieldSequence {
    uniform(Quantity::AirVelocity, 30.0, &[Vec3::zeros()])
}

/// One limp stick with its mass at the tip is a pendulum: 2π √(l/g), but for a bundle's own rotary inertia, 1e-4 of it.
#[test]
fn a_stick_swings_like_a_pendulum() {
    for (integrator, dt_secs) in [(Integrator::Implicit, 1.0 / 960.0), (Integrator::Rk4, 1.0 / 960.0)] {
        let stick = Strand {
            bending_stiffness_n_m2: 0.0,
            internal_damping_secs: 0.0,
            ..straight(Vec3::zeros(), -Vec3::z(), 0.15, 1)
        };
        let motion = run(&no_wind(), &tilted(0.0873), vec![stick], &physical(integrator, dt_secs, 4.0))
            .unwrap()
            .motion;
        let x: Vec<f64> = track(&motion, 1).iter().map(|p| p.x).collect();
        let rises = rises(&x, 0.15 * libm::sin(0.0873), 60.0);
        let period = (rises[rises.len() - 1] - rises[0]) / (rises.len() - 1) as f64;
        let expected = core::f64::consts::TAU * (0.15_f64 / 9.81).sqrt() * (1.0 + 0.0873 * 0.0873 / 16.0);
        assert!((period / expected - 1.0).abs() < 5e-4, "{integrator:?}: {period} against {expected}");
    }
}

/// A clamped rod under a force per length f bends by f L⁴ / 8 EI at its tip.
#[test]
fn a_rod_bends_as_a_rod_does() {
    let rod = Strand { bending_stiffness_n_m2: 1e-4, ..straight(Vec3::zeros(), Vec3::x(), 0.2, 24) };
    // 0.3 m/s² on 1.5 g/m: f = 4.5e-4 N/m; 4.5e-4 · 0.2⁴ / 8e-4 = 0.9 mm.
    let push = uniform(Quantity::ForcePerMass, 30.0, &[Vec3::new(0.0, 0.3, 0.0)]);
    let mut options = physical(Integrator::Implicit, 1.0 / 240.0, 4.0);
    options.time = TimeMode::Hold;
    let motion = run(&push, &vacuum(Vec3::zeros()), vec![rod], &options).unwrap().motion;
    let tip = *track(&motion, 24).last().unwrap();
    assert!((tip.y / 0.9e-3 - 1.0).abs() < 5e-3, "{} mm", tip.y * 1e3);
}

/// A quarter circle that is pushed out of its plane at the tip twists as well as it bends; with the twisting stiffness
/// of the bending stiffness the tip goes F R³/EI · (π/4 + 3π/4 − 2) (Castigliano's theorem).
#[test]
fn a_bow_twists() {
    let (n, radius) = (32, 0.1);
    let at = |k: usize| {
        let (sin, cos) = libm::sincos(core::f64::consts::FRAC_PI_2 * k as f64 / n as f64);
        Vec3::new(radius * sin, radius * (1.0 - cos), 0.0)
    };
    let points: Vec<Vec3> = (0..=n).map(at).collect();
    let length_m = points.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
    let bow = Strand {
        rest_curve_m: points,
        length_m,
        bending_stiffness_n_m2: 1e-3,
        ..straight(Vec3::zeros(), Vec3::x(), 0.1, 1)
    };
    // A force per length w along z instead of one at the tip: integrated with the unit load's moments,
    // the tip goes w R⁴/EI · (moments about the tangent and the radius):
    //   bending moment at φ from a piece at ψ: R sin(ψ − φ), torsion R (1 − cos(ψ − φ)).
    let steps = 400_u32;
    let quarter = core::f64::consts::FRAC_PI_2;
    let mut sum = 0.0;
    for i in 0..steps {
        let phi = quarter * (f64::from(i) + 0.5) / f64::from(steps);
        let (mut bending, mut torsion) = (0.0, 0.0);
        for j in 0..steps {
            let psi = quarter * (f64::from(j) + 0.5) / f64::from(steps);
            if psi > phi {
                bending += libm::sin(psi - phi) * quarter / f64::from(steps);
                torsion += (1.0 - libm::cos(psi - phi)) * quarter / f64::from(steps);
            }
        }
        let (unit_bending, unit_torsion) = (libm::sin(quarter - phi), 1.0 - libm::cos(quarter - phi));
        sum += (bending * unit_bending + torsion * unit_torsion) * quarter / f64::from(steps);
    }
    let expected = 1.5e-3 * 0.4 * radius.powi(4) / 1e-3 * sum;
    let push = uniform(Quantity::ForcePerMass, 30.0, &[Vec3::new(0.0, 0.0, 0.4)]);
    let mut options = physical(Integrator::Implicit, 1.0 / 240.0, 4.0);
    options.time = TimeMode::Hold;
    let motion = run(&push, &vacuum(Vec3::zeros()), vec![bow], &options).unwrap().motion;
    let tip = *track(&motion, n).last().unwrap();
    assert!((tip.z / expected - 1.0).abs() < 0.01, "{} against {expected}", tip.z);
}

/// The error falls as the order says when the step is halved; the reference is the Runge-Kutta method at tiny steps.
#[test]
fn errors_fall_with_the_order() {
    let lock = || Strand {
        // So thick that explicit steps of a third of a millisecond stand its twist.
        bending_stiffness_n_m2: 1e-5,
        internal_damping_secs: 0.002,
        along: tousle_core::Along::default(),
        holds_style: false,
        lock_width_m: 0.01,
        ..straight(Vec3::new(0.0, 0.0, 0.2), Vec3::new(0.3, 0.0, -1.0), 0.2, 5)
    };
    let gusts: Vec<Vec3> =
        (0..=60).map(|k| Vec3::new(0.0, 3.0 * libm::sin(f64::from(k) * 0.2), 1.0)).collect();
    let field = uniform(Quantity::AirVelocity, 60.0, &gusts);
    let scene = Scene { air_density: 1.2, ..vacuum(DOWN) };
    let end = |integrator, dt_secs| {
        let motion = run(&field, &scene, vec![lock()], &physical(integrator, dt_secs, 0.75)).unwrap().motion;
        *track(&motion, 5).last().unwrap()
    };
    // What iterations of hair as thick as this leave over at shorter steps would hide the order 2.
    for (integrator, order, steps) in [
        (Integrator::Implicit, 2.0, 240.0),
        (Integrator::ImplicitEuler, 1.0, 1920.0),
        (Integrator::SemiImplicit, 1.0, 1920.0),
    ] {
        // Against the method's own finest answer: the implicit ones leave a bundle's rotary inertia out.
        let reference = end(integrator, 1.0 / 15_360.0);
        let error = |steps: f64| (end(integrator, 1.0 / steps) - reference).norm();
        let (coarse, fine) = (error(steps), error(2.0 * steps));
        let found = libm::log2(coarse / fine);
        assert!(found > order - 0.3, "{integrator:?}: order {found}, {coarse} then {fine} m");
    }
    // Independent ways to the same answer.
    let (implicit, explicit) =
        (end(Integrator::Implicit, 1.0 / 7_680.0), end(Integrator::Rk4, 1.0 / 7_680.0));
    assert!((implicit - explicit).norm() < 1e-3, "{implicit} {explicit}");
    let options = SimOptions { tolerance_m: 1e-6, ..physical(Integrator::Adaptive, 1.0 / 60.0, 0.75) };
    let motion = run(&field, &scene, vec![lock()], &options).unwrap().motion;
    let adaptive = *track(&motion, 5).last().unwrap();
    assert!((implicit - adaptive).norm() < 1e-3, "{implicit} {adaptive}");
}

/// What iterations leave over falls with the step, however short: a thick limp lock, in which they contract least, ends where it
/// does at twice the steps.
#[test]
fn short_steps_converge() {
    let gust = |k: u32| Vec3::new(0.0, 3.0 * libm::sin(0.2 * f64::from(k)), 1.0);
    let gusts = uniform(Quantity::AirVelocity, 60.0, &(0..=60).map(gust).collect::<Vec<_>>());
    let scene = Scene { air_density: 1.2, ..vacuum(DOWN) };
    let thick = || Strand {
        bending_stiffness_n_m2: 1e-5,
        internal_damping_secs: 0.002,
        lock_width_m: 0.01,
        ..straight(Vec3::new(0.0, 0.0, 0.2), Vec3::new(0.3, 0.0, -1.0), 0.2, 5)
    };
    let end_m = |rate_hz: f64| {
        let options = physical(Integrator::Implicit, 1.0 / rate_hz, 0.75);
        let simulation = run(&gusts, &scene, vec![thick()], &options).unwrap();
        assert_eq!(simulation.report.unsettled_steps, 0, "{rate_hz}");
        track(&simulation.motion, 5)[45]
    };
    let apart_m = (end_m(15_360.0) - end_m(7_680.0)).norm();
    assert!(apart_m < 1e-5, "{apart_m}");
}

/// A hundred times the stiffness needs no smaller step: the answer at 1/120 s is as near to the converged one.
#[test]
fn stiff_hair_needs_no_smaller_step() {
    let gusts: Vec<Vec3> =
        (0..=60).map(|k| Vec3::new(3.0 * libm::sin(f64::from(k) * 0.1), 1.0, 0.0)).collect();
    let field = uniform(Quantity::AirVelocity, 60.0, &gusts);
    let scene = Scene { air_density: 1.2, ..vacuum(DOWN) };
    for times in [1.0, 100.0, 10_000.0] {
        let lock = || Strand {
            bending_stiffness_n_m2: 2e-6 * times,
            ..straight(Vec3::new(0.0, 0.0, 0.5), Vec3::new(0.3, 0.0, -1.0), 0.25, 12)
        };
        let end = |dt_secs| {
            let motion = run(&field, &scene, vec![lock()], &physical(Integrator::Implicit, dt_secs, 1.0))
                .unwrap()
                .motion;
            track(&motion, 12)
        };
        let (coarse, fine) = (end(1.0 / 120.0), end(1.0 / 3840.0));
        let off = coarse.iter().zip(&fine).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(off < 4e-3, "EI times {times}: {off} m");
    }
}

/// Under gravity, on a head, nothing moves in a minute: not a tenth of a millimeter, in single precision too.
#[test]
fn at_rest_for_ever() {
    // The air barely moves, so that nothing may sleep.
    let breath = uniform(Quantity::AirVelocity, 30.0, &[Vec3::new(1e-7, 0.0, 0.0)]);
    for precision in [Precision::Double, Precision::Single] {
        let mut options = physical(Integrator::Implicit, 1.0 / 60.0, 60.0);
        (options.precision, options.time) = (precision, TimeMode::Hold);
        // A soft lock that leans far out is held up by a natural shape of many curls, and really is not in stable balance.
        let hanging = straight(Vec3::new(0.05, 0.08, 0.03), Vec3::new(0.05, 0.05, -1.0), 0.25, 12);
        let locks = vec![over_the_head(), hanging];
        let simulation = run(&breath, &mannequin(), locks, &options).unwrap();
        let drift = farthest(&simulation.motion);
        assert!(drift < 1e-4, "{precision:?}: {drift} m");
        assert!(simulation.report.max_stretch < 1e-3, "{}", simulation.report.max_stretch);
        assert_eq!(simulation.report.slept_share, 0.0);
    }
}

/// A lock of half a meter that hangs still in even curls; the air barely moves, so that it may not sleep.
#[test]
fn curls_that_hang_still_do_not_begin_to_swing() {
    let curl = |radius_m: f64, turns: f64, stiffness_n_m2: f64| {
        let point = |k: usize| {
            let share = k as f64 / 27.0;
            let (sin, cos) = libm::sincos(core::f64::consts::TAU * turns * share);
            Vec3::new(0.02 + radius_m * (cos - 1.0), 0.12 + 0.2 * radius_m * sin, 0.03 - 0.53 * share)
        };
        let rest_curve_m: Vec<Vec3> = (0..28).map(point).collect();
        let length_m = rest_curve_m.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
        Strand {
            rest_curve_m,
            length_m,
            linear_density_kg_per_m: 3.77e-3,
            lock_width_m: 8.3e-3,
            bending_stiffness_n_m2: stiffness_n_m2,
            internal_damping_secs: 0.013,
            ..straight(Vec3::zeros(), -Vec3::z(), 0.5, 1)
        }
    };
    let breath = uniform(Quantity::AirVelocity, 30.0, &[Vec3::new(1e-6, 0.0, 0.0)]);
    for (radius_m, turns, stiffness_n_m2) in
        [(4e-3, 5.0, 2.5e-6), (4e-3, 3.0, 1e-6), (8e-3, 5.0, 1e-6), (6e-3, 4.0, 5e-7), (4e-3, 6.0, 5e-7)]
    {
        for (integrator, rate_hz, dt_secs) in [
            (Integrator::Implicit, 60.0, 1.0 / 60.0),
            (Integrator::Implicit, 24.0, 1.0 / 48.0),
            (Integrator::Adaptive, 60.0, 1.0 / 30.0),
        ] {
            let mut options = physical(integrator, dt_secs, 15.0);
            (options.rate_hz, options.time) = (rate_hz, TimeMode::Hold);
            let locks = vec![curl(radius_m, turns, stiffness_n_m2)];
            let motion = run(&breath, &vacuum(DOWN), locks, &options).unwrap().motion;
            let drift = farthest(&motion);
            assert!(drift < 1e-4, "{radius_m} {turns} {stiffness_n_m2} {integrator:?} {rate_hz}: {drift} m");
        }
    }
}

/// In still air nothing is done, and nothing moves by a bit.
#[test]
fn still_strands_sleep_exactly() {
    let simulation = run(
        &still_air(),
        &mannequin(),
        vec![over_the_head()],
        &physical(Integrator::Implicit, 1.0 / 60.0, 2.0),
    )
    .unwrap();
    assert_eq!(simulation.report.slept_share, 1.0);
    assert_eq!(farthest(&simulation.motion), 0.0);
}

/// A strand moves the same alone and beside others, whatever they have in common and however many threads there are.
#[test]
fn a_strand_does_not_know_its_neighbors() {
    let gusts: Vec<Vec3> =
        (0..=60).map(|k| Vec3::new(4.0 * libm::sin(f64::from(k) * 0.2), 1.0, 0.0)).collect();
    let field = uniform(Quantity::AirVelocity, 30.0, &gusts);
    let options = physical(Integrator::Implicit, 1.0 / 60.0, 1.5);
    let locks: Vec<Strand> = (0..7)
        .map(|k| {
            let k = f64::from(k);
            let lock = straight(
                Vec3::new(0.1, 0.01 * k, 0.0),
                Vec3::new(1.0, 0.0, -1.0 - 0.1 * k),
                0.2 + 0.01 * k,
                9,
            );
            // As if nobody had given it: so they do not tell how what lies on the head falls.
            Strand { bending_stiffness_n_m2: 5e-5, holds_style: true, ..lock }
        })
        .chain([over_the_head(), straight(Vec3::new(-0.1, 0.0, 0.0), -Vec3::x(), 0.1, 4)])
        .collect();
    let all = run(&field, &mannequin(), locks.clone(), &options).unwrap().motion;
    for (k, lock) in locks.iter().enumerate() {
        // What lies on the head shows how near hair comes to it, so it has to be there.
        let alone = run(&field, &mannequin(), vec![lock.clone(), over_the_head()], &options).unwrap().motion;
        for frame in 0..alone.times_secs.len() {
            assert_eq!(alone.strand(frame, 0), all.strand(frame, k), "strand {k}, frame {frame}");
        }
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    let threaded = pool.install(|| run(&field, &mannequin(), locks, &options).unwrap().motion);
    assert_eq!(threaded.positions_m, all.positions_m);
}

/// Both ways to take steps, of one length and of lengths of their own.
const STEPS: [(Integrator, f64); 2] =
    [(Integrator::Implicit, 1.0 / 480.0), (Integrator::Adaptive, 1.0 / 60.0)];

/// A limp strand whose root is the pivot does not know that the head turns: it stays where it is in the world.
#[test]
fn a_turning_head_leaves_a_limp_strand_behind() {
    let (scene, angle) = turning();
    for (integrator, dt_secs) in STEPS {
        let limp = Strand {
            bending_stiffness_n_m2: 0.0,
            ..straight(Vec3::zeros(), Vec3::new(1.0, 0.0, 0.4), 0.2, 6)
        };
        let motion = run(&no_wind(), &scene, vec![limp], &physical(integrator, dt_secs, 1.0)).unwrap().motion;
        let tip = track(&motion, 6);
        let stays = turned_about_z(-angle).rotation * tip[0];
        assert!((tip[60] - stays).norm() < 5e-4, "{integrator:?}: {} against {stays}", tip[60]);
    }
}

/// A head that speeds up evenly feels like one under a tilted gravity.
#[test]
fn a_heads_acceleration_is_gravity_tilted() {
    let acceleration = Vec3::new(2.0, -1.0, 0.5);
    let hanging = || vec![straight(Vec3::new(0.0, 0.0, 0.1), Vec3::new(-0.3, 0.1, -1.0), 0.2, 8)];
    for (integrator, dt_secs) in STEPS {
        let options = physical(integrator, dt_secs, 1.5);
        let speeding = run(&no_wind(), &speeding_up(acceleration), hanging(), &options);
        // The same strand under true gravity, with the missing part as a force on every point.
        let instead = uniform(Quantity::ForcePerMass, 1.0, &[-acceleration]);
        let pushed = run(&instead, &vacuum(DOWN), hanging(), &options).unwrap().motion;
        let apart = apart(&speeding.unwrap().motion, &pushed);
        assert!(farthest(&pushed) > 0.02);
        assert!(apart < 5e-4, "{integrator:?}: {apart}");
    }
}

/// A head that goes on evenly in still air feels what a still one feels in a wind against it, from the first step on, whether its
/// track begins before or just then.
#[test]
fn only_the_air_against_a_head_counts() {
    let velocity = Vec3::new(1.5, -0.7, 0.4);
    let locks = || vec![over_the_head(), straight(Vec3::new(-0.1, 0.0, 0.0), -Vec3::z(), 0.25, 9)];
    let against = uniform(Quantity::AirVelocity, 1.0, &[-velocity; 2]);
    for (integrator, dt_secs) in [
        (Integrator::Implicit, 1.0 / 120.0),
        (Integrator::ImplicitEuler, 1.0 / 120.0),
        (Integrator::Adaptive, 1.0 / 60.0),
        (Integrator::SemiImplicit, 1.0 / 4_800.0),
    ] {
        let options = physical(integrator, dt_secs, 0.9);
        let still = run(&against, &mannequin(), locks(), &options).unwrap().motion;
        assert!(farthest(&still) > 0.02);
        for start_secs in [-1.0, 0.0] {
            let pose = |k: i32| Pose::from(velocity * (f64::from(k) / 60.0 + start_secs));
            let poses = PoseTrack { start_secs, rate_hz: 60.0, poses: (0..150).map(pose).collect() };
            let scene = Scene { poses, ..mannequin() };
            let goes = run(&still_air(), &scene, locks(), &options).unwrap().motion;
            let apart = apart(&still, &goes);
            assert!(apart < 1e-5, "{integrator:?}, from {start_secs} s on: {apart} m");
        }
    }
}

/// A hair that is folded by 170° at rest and blown through 180°: what is stored in its joint goes on growing, as what opens
/// it again is the way it came. Nothing of it goes faster than the wind.
#[test]
fn a_fold_is_no_spring_that_lets_go() {
    let root_m = Vec3::new(-0.16, 0.0, 0.0);
    let (sin, cos) = libm::sincos(10_f64.to_radians());
    let back = Vec3::new(cos, 0.0, -sin) * 0.01;
    let fold_m = root_m - Vec3::x() * 0.05;
    let folded = || Strand {
        linear_density_kg_per_m: 2e-4,
        lock_width_m: 3e-3,
        bending_stiffness_n_m2: 1e-6,
        internal_damping_secs: 0.016,
        ..strand([root_m].into_iter().chain((0..6).map(|k| fold_m + back * f64::from(k))).collect())
    };
    let rise = |k: i32| Vec3::new(0.0, 0.0, f64::from(k.min(5)) * 0.8);
    let upwards = uniform(Quantity::AirVelocity, 10.0, &(0..41).map(rise).collect::<Vec<_>>());
    let scene = Scene { air_density: 1.2, ..vacuum(DOWN) };
    for (integrator, dt_secs) in [
        (Integrator::Implicit, 1.0 / 120.0),
        (Integrator::Implicit, 1.0 / 1_920.0),
        (Integrator::ImplicitEuler, 1.0 / 480.0),
        (Integrator::SemiImplicit, 1.0 / 19_200.0),
        (Integrator::Adaptive, 1.0 / 60.0),
    ] {
        let options = SimOptions { rate_hz: 120.0, ..physical(integrator, dt_secs, 4.0) };
        let simulation = run(&upwards, &scene, vec![folded()], &options).unwrap();
        let tip = track(&simulation.motion, 6);
        let fastest = tip.windows(2).map(|p| (p[1] - p[0]).norm() * 120.0).fold(0.0, f64::max);
        assert!(fastest < 4.0, "{integrator:?} {dt_secs}: {fastest} m/s");
        assert!(simulation.report.unsettled_steps == 0, "{integrator:?} {dt_secs}: not settled");
    }
}

/// A hair that doubles back on itself at rest stays so, to and fro, however nearly.
#[test]
fn a_double_fold_stays_at_rest() {
    let breath = uniform(Quantity::AirVelocity, 30.0, &[Vec3::new(1e-6, 0.0, 0.0)]);
    for way in [-Vec3::x(), Vec3::y(), Vec3::z(), Vec3::new(-3.0, 2.0, -3.0).normalize()] {
        for aside_m in [0.0, 1e-9, 1e-7, 1e-6, 1e-4] {
            let aside = way.cross(&Vec3::new(0.3, 0.5, 0.8)).normalize() * aside_m;
            let at = |out: f64, n: f64| Vec3::new(-0.12, 0.0, 0.02) + way * (0.05 * out) + aside * n;
            let points = vec![at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(1.0, 2.0), at(2.0, 2.0)];
            let mut options = physical(Integrator::Implicit, 1.0 / 120.0, 3.0);
            options.time = TimeMode::Hold;
            let folded = Strand { bending_stiffness_n_m2: 1e-3, ..strand(points) };
            let motion = run(&breath, &vacuum(DOWN), vec![folded], &options).unwrap().motion;
            assert!(farthest(&motion) < 1e-4, "{way} {aside_m}: {} m", farthest(&motion));
        }
    }
}

/// Where the shot is cut, the hair goes along, with the shape and the velocities it had. The head stands still just then.
#[test]
fn hair_goes_along_at_a_cut() {
    // To and fro until 0.4 s and again from 0.6 s on.
    let angle = |t: f64| {
        let since = if t < 0.5 { t } else { (t - 0.6).max(0.0) };
        0.3 * (1.0 - libm::cos(core::f64::consts::TAU * since.min(0.4) / 0.4))
    };
    let cut = |secs: f64, poses_hz: f64| {
        let elsewhere = Pose::translation(100.0, -60.0, 0.0) * turned_about_z(2.0);
        head(poses_hz, |t| if t < secs { Pose::identity() } else { elsewhere } * turned_about_z(angle(t)))
    };
    let locks =
        || vec![over_the_head(), straight(Vec3::new(-0.1, 0.0, 0.0), Vec3::new(-1.0, 0.0, -0.5), 0.25, 9)];
    for (integrator, dt_secs, poses_hz) in [
        (Integrator::Implicit, 1.0 / 60.0, 240.0),
        (Integrator::Implicit, 1.0 / 240.0, 240.0),
        (Integrator::Implicit, 1.0 / 240.0, 24.0),
    ] {
        let moved = |secs: f64| {
            let scene = Scene { poses: cut(secs, poses_hz), body: vacuum(DOWN).body, ..mannequin() };
            run(&common::gusts(), &scene, locks(), &physical(integrator, dt_secs, 1.0)).unwrap().motion
        };
        let (whole, cut) = (moved(9.0), moved(0.5));
        assert!(farthest(&whole) > 0.02);
        let apart = apart(&whole, &cut);
        assert!(apart < 1e-5, "{dt_secs}, {poses_hz}: {apart}");
    }
}

/// A head that turns evenly is turned back at once where the capture is played again: the hair goes along, at every step.
#[test]
fn hair_goes_along_where_a_capture_begins_anew() {
    let scene =
        Scene { poses: head(240.0, |t| turned_about_z(0.35 * t)), body: vacuum(DOWN).body, ..mannequin() };
    let hanging = |x: f64, y: f64| straight(Vec3::new(x, y, 0.0), -Vec3::z(), 0.25, 9);
    let locks = || vec![hanging(-0.1, 0.0), hanging(0.05, 0.08)];
    // A second of it.
    let field = uniform(Quantity::AirVelocity, 1.0, &[Vec3::zeros(); 2]);
    for dt_secs in [1.0 / 60.0, 1.0 / 120.0, 1.0 / 480.0] {
        let mut options = physical(Integrator::Implicit, dt_secs, 2.5);
        options.time = TimeMode::Loop;
        let motion = run(&field, &scene, locks(), &options).unwrap().motion;
        let fastest = (1..motion.times_secs.len())
            .flat_map(|frame| motion.frame(frame).iter().zip(motion.frame(frame - 1)))
            .map(|(now, before)| (Vec3::from(now.map(f64::from)) - Vec3::from(before.map(f64::from))).norm())
            .fold(0.0, f64::max);
        assert!(fastest < 2e-3, "{dt_secs}: {fastest} m a frame");
    }
}

/// However much a step may be off, none is longer than was asked for.
#[test]
fn adaptive_keeps_to_the_longest_step() {
    let n_steps = |longest_secs: f64| {
        let options = SimOptions { tolerance_m: 0.05, ..physical(Integrator::Adaptive, longest_secs, 0.5) };
        run(&still_air(), &mannequin(), vec![over_the_head()], &options).unwrap().report.n_steps
    };
    assert!(n_steps(0.02) < 250, "{}", n_steps(0.02));
    assert!(n_steps(0.002) >= 250, "{}", n_steps(0.002));
}

/// An integrator of the other method, a tolerance that is none, an explicit step beyond its limit, and one that is too short
/// for single precision are refused.
#[test]
fn what_cannot_be_is_refused() {
    let go = |options: &SimOptions| run(&still_air(), &mannequin(), vec![over_the_head()], options);
    let other = SimOptions { integrator: Some(Integrator::Exponential), ..SimOptions::of(Method::Physical) };
    assert!(matches!(go(&other), Err(SimError::OtherMethod { .. })), "{:?}", go(&other));
    let none = SimOptions { tolerance_m: 0.0, ..SimOptions::of(Method::Physical) };
    assert!(matches!(go(&none), Err(SimError::BadOption { option: "tolerance_m", .. })));
    // Less than steps can be told to be off by would take the shortest ones all along.
    let tolerance =
        |tolerance_m: f64| SimOptions { tolerance_m, ..physical(Integrator::Adaptive, 1.0 / 60.0, 0.1) };
    assert!(go(&tolerance(1e-4 * 1e-3)).is_ok());
    assert!(matches!(go(&tolerance(9e-8)), Err(SimError::BadOption { option: "tolerance_m", .. })));
    // Too many frames: of the rate and the time the one that is not usual is named.
    let frames = |rate_hz: f64, secs: f64| {
        let options = SimOptions { rate_hz, duration_secs: Some(secs), ..SimOptions::default() };
        match go(&options) {
            Err(SimError::BadOption { option, .. }) => option,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(frames(1e9, 1.0), "rate_hz");
    assert_eq!(frames(60.0, 1e9), "duration_secs");
    assert_eq!(frames(1e-9, 1.0), "rate_hz", "steps that nobody gave are not what is wrong");
    // What goes frame by frame into a sink may be longer than what is held.
    let hour = SimOptions { duration_secs: Some(3600.0), ..SimOptions::default() };
    let (field, scene, hair) = (still_air(), mannequin(), tousle_bench::worlds::wig(400, 16));
    let simulator = Simulator::new(&field, &scene, &hair, &hour).unwrap();
    let held = simulator.simulate(&[], &NoProgress);
    assert!(matches!(held, Err(SimError::BadOption { option: "duration_secs", .. })), "{held:?}");
    let mut to_frame_3 = |frame: Frame<'_>| if frame.number < 3 { Ok(()) } else { Err("enough".into()) };
    let run = simulator.simulate_into(&[], &mut to_frame_3, &NoProgress);
    assert!(matches!(run, Err(SimError::Sink(_))), "{run:?}");
    let single = |rate_hz: f64| SimOptions {
        precision: Precision::Single,
        ..physical(Integrator::Implicit, 1.0 / rate_hz, 0.1)
    };
    assert!(go(&single(480.0)).is_ok());
    assert!(matches!(go(&single(960.0)), Err(SimError::TooShort { .. })));
    for integrator in [Integrator::SemiImplicit, Integrator::Rk4] {
        let error = go(&physical(integrator, 1.0 / 120.0, 0.1)).unwrap_err();
        let SimError::Unstable { limit_secs, .. } = error else { panic!("{error}") };
        assert!(limit_secs < 1e-3, "{limit_secs}");
        // At its limit it holds.
        let simulation = go(&physical(integrator, limit_secs, 0.1)).unwrap();
        assert!(farthest(&simulation.motion) < 1e-4, "{integrator:?}");
    }
}
