//! A simulator that stays prepared: the same bytes as a run that begins anew.

mod common;

use common::{groom, gusts, lift, mannequin, many};
use tousle_core::{NoProgress, StrandMotion, Vec3};
use tousle_field::FieldLayer;
use tousle_sim::{Integrator, Method, Precision, SimOptions, Simulator, simulate};

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
