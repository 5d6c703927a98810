//! Hair at rest stays at rest, and hair in motion stays out of the body.

mod common;

use common::{
    DOWN, assert_sound, farthest, mannequin, nearest_m, options, over_the_head, run, still_air, straight,
    uniform, vacuum,
};
use tousle_core::{Pose, PoseTrack, Quantity, Vec3};
use tousle_field::Scene;
use tousle_sim::{Integrator, Method};

/// In still air nothing moves: the natural shape balances the weight less what the body bears.
#[test]
fn rest_is_rest() {
    let curl: Vec<Vec3> = (0..20)
        .map(|k| {
            let (sin, cos) = libm::sincos(0.7 * f64::from(k));
            Vec3::new(0.15 + 0.02 * cos, 0.02 * sin, 0.1 - 0.012 * f64::from(k))
        })
        .collect();
    for integrator in Integrator::of(Method::Paper).iter().copied() {
        let strands = vec![
            over_the_head(),
            common::strand(curl.clone()),
            straight(Vec3::new(0.2, 0.0, 0.0), Vec3::x(), 0.1, 5),
        ];
        let motion =
            run(&still_air(), &mannequin(), strands, &options(integrator, 1.0 / 120.0, 20.0)).unwrap().motion;
        assert!(farthest(&motion) < 1e-6, "{integrator:?}: {}", farthest(&motion));
    }
}

/// Blown onto head and shoulders from all sides, with a head that turns, no point goes in.
#[test]
fn the_body_keeps_hair_out() {
    let gusts: Vec<Vec3> = (0..90)
        .map(|k| {
            let (sin, cos) = libm::sincos(0.25 * f64::from(k));
            Vec3::new(12.0 * cos, 12.0 * sin, 4.0 * libm::sin(0.9 * f64::from(k)))
        })
        .collect();
    let field = uniform(Quantity::AirVelocity, 30.0, &gusts);
    let turn = |k: i32| {
        let angle = 0.8 * libm::sin(f64::from(k) * 0.03);
        Pose::from_parts(
            Vec3::zeros().into(),
            nalgebra::UnitQuaternion::from_scaled_axis(Vec3::new(0.2, 0.4, 1.0) * angle),
        )
    };
    let poses = PoseTrack { start_secs: 0.0, rate_hz: 120.0, poses: (0..360).map(turn).collect() };
    let scene = Scene { poses, ..mannequin() };
    let long = (0..6)
        .map(|k| {
            let (sin, cos) = libm::sincos(f64::from(k));
            straight(
                Vec3::new(0.1 * cos, 0.08 * sin, 0.02),
                -Vec3::z() + Vec3::new(cos, sin, 0.0) * 0.3,
                0.21,
                14,
            )
        })
        .chain([over_the_head()]);
    for dt_secs in [1.0 / 60.0, 1.0 / 240.0] {
        let simulation =
            run(&field, &scene, long.clone().collect(), &options(Integrator::Exponential, dt_secs, 2.9))
                .unwrap();
        assert_sound(&simulation, "gusts");
        assert!(farthest(&simulation.motion) > 0.1);
        let nearest = nearest_m(&scene, &simulation.motion);
        assert!(nearest > 1e-3, "{dt_secs}: {nearest}");
    }
}

/// A lock that lies on the shoulders is dragged along when the head turns away under it.
#[test]
fn friction_holds_hair_to_the_shoulders() {
    // Down beside the neck for 8 cm, then along the top of the shoulder, which is 7 cm thick about z = −0.27.
    let down = (0..4).map(|k| Vec3::new(-0.02, 0.062, -0.118 - 0.02 * f64::from(k)));
    let along = (0..6).map(|k| Vec3::new(-0.02, 0.062 + 0.015 * f64::from(k), -0.198));
    let mut lock = common::strand(down.chain(along).collect());
    lock.bending_stiffness_n_m2 = 1e-8;
    let mut scene = mannequin();
    let turn = |k: i32| {
        let angle = 0.15 * f64::from((k - 30).clamp(0, 240)) / 240.0;
        Pose::from_parts(Vec3::zeros().into(), nalgebra::UnitQuaternion::from_scaled_axis(Vec3::z() * angle))
    };
    scene.poses = PoseTrack { start_secs: 0.0, rate_hz: 120.0, poses: (0..400).map(turn).collect() };
    let drift = |friction: f64| {
        let mut scene = scene.clone();
        scene.body.friction = friction;
        let motion = run(
            &still_air(),
            &scene,
            vec![lock.clone()],
            &options(Integrator::Exponential, 1.0 / 240.0, 3.0),
        )
        .unwrap()
        .motion;
        let torso = scene.body.head_from_torso(&scene.poses.motion_at(3.0).world_from_head, &scene.rest_pose);
        let [first, last] = [0, 180].map(|f| Vec3::from(motion.frame(f)[9].map(f64::from)));
        ((torso * nalgebra::Point3::from(first)).coords - last).norm()
    };
    let (held, slips) = (drift(2.0), drift(0.0));
    assert!(held < 0.5 * slips, "with friction {held} m from where the shoulder went, without {slips}");
}

/// A root inside the head, as scalps of real grooms have it: allowed as deep as it rests, and said.
#[test]
fn hair_that_rests_inside_the_body_does_not_jump() {
    let strand = straight(Vec3::new(0.0, 0.0, 0.085), Vec3::new(0.3, 0.0, 1.0), 0.06, 6);
    let simulation =
        run(&still_air(), &mannequin(), vec![strand], &options(Integrator::Exponential, 1.0 / 120.0, 2.0))
            .unwrap();
    assert!(farthest(&simulation.motion) < 1e-6);
    assert!(
        simulation.report.assumed.iter().any(|a| a.what.contains("collision")),
        "{:?}",
        simulation.report.assumed
    );
}

/// What bears a lock is a guess, and said: by the free ones, where there are enough of them, and else by itself.
#[test]
fn what_bears_hair_is_told_by_hair_that_hangs_free() {
    let free = |k: u32| straight(Vec3::new(0.2, 0.01 * f64::from(k), 0.0), Vec3::x(), 0.1, 10);
    let said = |n_free: u32| {
        let strands = core::iter::once(over_the_head()).chain((0..n_free).map(free)).collect();
        let assumed =
            run(&still_air(), &mannequin(), strands, &common::physical(Integrator::Implicit, 0.01, 0.1))
                .unwrap()
                .report
                .assumed;
        let bears = assumed.into_iter().find(|a| a.what.starts_with("what the body bears of 1 of"));
        bears.unwrap().value
    };
    assert!(said(1).contains("as likely straight"), "{}", said(1));
    assert!(said(5).contains("as that of the free strands"), "{}", said(5));
}

/// Without a body nothing is said to be touched; with one out of reach neither.
#[test]
fn what_cannot_be_reached_is_left_out() {
    let far = straight(Vec3::new(5.0, 0.0, 0.0), -Vec3::z(), 0.1, 4);
    for scene in [vacuum(DOWN), mannequin()] {
        let report =
            run(&still_air(), &scene, vec![far.clone()], &options(Integrator::Exponential, 0.01, 0.1))
                .unwrap()
                .report;
        let collision = report.plan.iter().find(|entry| entry.term == "collision").unwrap();
        assert!(!collision.active, "{}", collision.why);
    }
}
