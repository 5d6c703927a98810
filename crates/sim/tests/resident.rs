//! A simulator that stays prepared: the same bytes as a run that begins anew.

mod common;

use common::{groom, gusts, lift, mannequin, many, still_air};
use nalgebra::UnitQuaternion;
use tousle_core::{NoProgress, Pose, PoseTrack, StrandMotion, Vec3};
use tousle_field::{FieldLayer, Handle};
use tousle_sim::{Integrator, Method, Precision, SimOptions, Simulator, TimeMode, simulate};

/// Every way to step that keeps something else when it is held.
fn ways() -> Vec<SimOptions> {
    let of = |method, integrator| SimOptions { integrator: Some(integrator), ..SimOptions::of(method) };
    vec![
        of(Method::Paper, Integrator::Exponential),
        of(Method::Paper, Integrator::SemiImplicit),
        of(Method::Physical, Integrator::Implicit),
        of(Method::Physical, Integrator::Adaptive),
        SimOptions { precision: Precision::Single, ..of(Method::Physical, Integrator::ImplicitEuler) },
    ]
}

fn of_strand(motion: &StrandMotion, strand: usize, from: usize) -> Vec<[f32; 3]> {
    (from..motion.times_secs.len()).flat_map(|frame| motion.strand(frame, strand).to_vec()).collect()
}

#[test]
fn layers_that_are_given_are_as_layers_of_the_field() {
    let (field, scene, groom) = (gusts(), mannequin(), groom(many()));
    let mut edited = field.clone();
    edited.layers.push(lift(Vec3::new(8.0, 0.0, 0.0)));
    for options in ways() {
        let resident = Simulator::new(&field, &scene, &groom, &options).unwrap();
        for field in [&field, &edited, &field] {
            let anew = simulate(field, &scene, &groom, &options, &NoProgress).unwrap();
            assert_eq!(resident.simulate(&field.layers, &NoProgress).unwrap(), anew, "{options:?}");
        }
    }
}

/// Held at 0.5 s, where the layer begins, without it; gone on with it.
#[test]
fn strands_that_are_held_go_on_as_if_they_had_not_been() {
    let (field, scene, groom) = (gusts(), mannequin(), groom(many()));
    let layers = [lift(Vec3::new(8.0, 0.0, 0.0))];
    for options in ways() {
        let resident = Simulator::new(&field, &scene, &groom, &options).unwrap();
        let all = resident.simulate(&layers, &NoProgress).unwrap().motion;
        let some = [3, 4, 9, 17, 22];
        let held = resident.hold(&[], &some, 0.51).unwrap();
        assert_eq!(held.frame(), 30);
        let whole = resident.simulate_some(&layers, &some).unwrap();
        let later = resident.go_on(&held, &layers, 9.0).unwrap();
        assert_eq!(later.times_secs, all.times_secs[30..]);
        for (k, strand) in some.into_iter().enumerate() {
            assert_eq!(of_strand(&whole, k, 0), of_strand(&all, strand, 0), "{options:?}");
            assert_eq!(of_strand(&later, k, 0), of_strand(&all, strand, 30), "{options:?}");
        }
    }
}

/// Six variants beside a common layer: more than one register holds, and no multiple of it.
#[test]
fn variants_side_by_side_are_as_runs_of_their_own() {
    let (field, scene, groom) = (gusts(), mannequin(), groom(many()));
    let common = [lift(Vec3::new(0.0, 0.0, 4.0))];
    let variants: Vec<Vec<FieldLayer>> =
        (0..6).map(|k| vec![lift(Vec3::new(3.0 * f64::from(k), 0.0, 0.0))]).collect();
    let variants: Vec<&[FieldLayer]> = variants.iter().map(Vec::as_slice).collect();
    for options in ways() {
        let resident = Simulator::new(&field, &scene, &groom, &options).unwrap();
        let held = resident.hold(&common, &[5], 0.4).unwrap();
        let moved = resident.variants(&held, &common, &variants, 0.8).unwrap();
        assert_eq!(moved.len(), 6);
        for (variant, moved) in variants.iter().zip(moved) {
            let alone = resident.simulate_some(&[&common, *variant].concat(), &[5]).unwrap();
            let n = alone.counts[0];
            assert_eq!(moved.positions_m, alone.positions_m[24 * n..49 * n], "{options:?}");
        }
    }
}

/// [`lift`] within 6 cm of a place.
fn lift_at(center_m: Vec3) -> FieldLayer {
    let layer = lift(Vec3::new(8.0, 0.0, 0.0));
    FieldLayer { handles: vec![Handle { center_m, reach_m: 0.06, ..layer.handles[0] }], ..layer }
}

/// Layers come, are moved, muted, renamed and go: each time only strands near the difference are run again, which some are
/// and some are not, and all are as in a run that begins anew. The field is gone through twice and a half.
#[test]
fn strands_that_feel_no_change_need_not_be_run_again() {
    let (field, scene, groom) = (gusts(), mannequin(), groom(many()));
    let [front, left] = [Vec3::new(0.06, 0.0, -0.06), Vec3::new(-0.02, 0.14, -0.06)].map(lift_at);
    let muted = FieldLayer { muted: true, ..left.clone() };
    let renamed = FieldLayer { id: "2".into(), name: "another".into(), ..front.clone() };
    let stacks = [
        vec![front.clone()],
        vec![front.clone(), left.clone()],
        vec![renamed.clone(), left.clone()],
        vec![lift_at(Vec3::new(0.0, -0.14, -0.04)), renamed, left],
        vec![front, muted],
        vec![],
    ];
    for (time, options) in [TimeMode::Hold, TimeMode::Loop].into_iter().flat_map(|time| {
        let of = move |options| SimOptions { time, duration_secs: Some(2.5), ..options };
        ways().into_iter().map(move |options| (time, of(options)))
    }) {
        let resident = Simulator::new(&field, &scene, &groom, &options).unwrap();
        let integrator = options.integrator.unwrap();
        let is_local = !(integrator.is_limited() || integrator == Integrator::Adaptive);
        let mut last = resident.trace(&[], &NoProgress).unwrap();
        for (k, stack) in stacks.iter().enumerate() {
            let felt_by = last.felt_by(stack);
            match k {
                2 => assert_eq!(felt_by, [0; 0]),
                _ if is_local => assert!(!felt_by.is_empty() && felt_by.len() < 20, "{k} {felt_by:?}"),
                _ => assert_eq!(felt_by.len(), 23),
            }
            last = resident.retrace(&last, stack, &NoProgress).unwrap();
            let anew = resident.simulate(stack, &NoProgress).unwrap().motion;
            assert!(**last.motion() == anew, "stack {k}, {time:?}, {options:?}");
        }
    }
}

/// Hair that sleeps wakes by a breath of wind wherever it blows, so all of it is run again.
#[test]
fn what_sleeps_is_run_again_with_any_layer() {
    let (field, scene, groom) = (still_air(), mannequin(), groom(many()));
    let options = SimOptions { duration_secs: Some(1.0), ..SimOptions::of(Method::Physical) };
    let resident = Simulator::new(&field, &scene, &groom, &options).unwrap();
    let before = resident.trace(&[], &NoProgress).unwrap();
    let layers = [lift_at(Vec3::new(0.06, 0.0, -0.06))];
    assert_eq!(before.felt_by(&layers).len(), 23);
    let after = resident.retrace(&before, &layers, &NoProgress).unwrap();
    assert_eq!(**after.motion(), resident.simulate(&layers, &NoProgress).unwrap().motion);
}

/// A head that shakes.
fn shaking() -> PoseTrack {
    let turn = |k: i32| UnitQuaternion::from_scaled_axis(Vec3::z() * (0.6 * libm::sin(0.12 * f64::from(k))));
    let pose = |k: i32| Pose::from_parts(Vec3::zeros().into(), turn(k));
    PoseTrack { start_secs: 0.0, rate_hz: 120.0, poses: (0..300).map(pose).collect() }
}

/// To the bit: whether a point is looked at again, and what friction remembers of it, is each strand's own affair. The wind
/// jumps where the field begins anew, so that points go far within a step.
#[test]
fn a_strand_moves_the_same_alone_and_beside_others() {
    let (field, scene, groom) = (gusts(), mannequin(), groom(many()));
    for head in [None, Some(shaking())] {
        for options in ways() {
            let options =
                SimOptions { head: head.clone(), time: TimeMode::Loop, duration_secs: Some(2.5), ..options };
            let resident = Simulator::new(&field, &scene, &groom, &options).unwrap();
            let all = resident.simulate(&[], &NoProgress).unwrap().motion;
            for strand in 0..23 {
                let alone = resident.simulate_some(&[], &[strand]).unwrap();
                assert!(alone.positions_m == of_strand(&all, strand, 0), "{strand}, {options:?}");
            }
        }
    }
}
