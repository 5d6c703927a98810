//! Real hairstyles and the captures' own. Needs `TOUSLE_SHARED`, the folder that holds `captures` and `corpus`.

#![allow(clippy::unwrap_used, reason = "a helper of tests may panic as a test may")]

use std::path::{Path, PathBuf};

use tousle_core::{Axis, LengthUnit, Vec3};
use tousle_groom::{
    GroomFormat, GroomOptions, GroomReadError, HeadShape, Placement, ReadGroom, inspect_groom, read_groom,
};

fn shared() -> Option<PathBuf> {
    let shared = std::env::var_os("TOUSLE_SHARED");
    if shared.is_none() {
        println!("skipped: TOUSLE_SHARED is not set");
    }
    shared.map(|s| Path::new(&s).to_owned())
}

fn hairstyle(shared: &Path, name: &str) -> Vec<u8> {
    std::fs::read(shared.join("corpus/hairstyles").join(name)).unwrap()
}

fn told() -> GroomOptions {
    let mut options = GroomOptions::default();
    options.unit = Some(LengthUnit::Millimeter);
    options.up_axis = Some(Axis::PlusZ);
    options
}

/// Strands, points, points of a strand: from the corpus's README, counted by other programs.
#[test]
fn every_hairstyle_loads_with_its_counts() {
    let Some(shared) = shared() else { return };
    for (name, format, strands, points, per_strand) in [
        ("yuksel--straight.hair", GroomFormat::Hair, 10_000, 160_000, 16..=16),
        ("ct2hair--Bangs_100.hair", GroomFormat::Hair, 100, 1165, 5..=21),
        ("ct2hair--Bangs_100.data", GroomFormat::Data, 100, 1165, 5..=21),
        ("ct2hair--Bangs_100.bin", GroomFormat::Bin, 100, 1165, 5..=21),
        ("ct2hair--Bangs_100.abc", GroomFormat::Alembic, 100, 1165, 5..=21),
        ("ct2hair--Bangs_100.ply", GroomFormat::Ply, 100, 1165, 5..=21),
        ("arnold-usd--0179-houdini-groom-bspline.usda", GroomFormat::Usda, 285, 3135, 11..=11),
        ("arnold-usd--0189-houdini-guides-linear.usda", GroomFormat::Usda, 2484, 22_356, 9..=9),
        ("arnold-usd--0213-deforming-linear.usda", GroomFormat::Usda, 11, 1111, 101..=101),
        ("arnold-usd--1334-maya-catmullrom.usda", GroomFormat::Usda, 3, 89, 28..=33),
    ] {
        let bytes = hairstyle(&shared, name);
        let options = if format == GroomFormat::Usda { GroomOptions::default() } else { told() };
        let read = read_groom(&bytes, &options).unwrap();
        assert_eq!(read.format, format, "{name}");
        assert_eq!((read.groom.strands.len(), read.groom.n_points()), (strands, points), "{name}");
        let counts = read.groom.counts();
        assert_eq!(counts.iter().min(), Some(per_strand.start()), "{name}");
        assert_eq!(counts.iter().max(), Some(per_strand.end()), "{name}");
        let summary = inspect_groom(&bytes, &GroomOptions::default()).unwrap();
        assert_eq!((summary.strands, summary.points), (strands, points), "{name}");
        assert_eq!(summary.counts, counts, "{name}");
        let states_all = format == GroomFormat::Usda;
        assert_eq!(summary.bounds_m.is_some(), states_all, "{name}: {:?}", summary.warnings);
        println!("{name}: {:?}", read.warnings);
    }
}

#[test]
fn one_hairstyle_in_five_containers_is_the_same() {
    let Some(shared) = shared() else { return };
    let read = |name: &str| read_groom(&hairstyle(&shared, name), &told()).unwrap().groom;
    let expected = read("ct2hair--Bangs_100.hair");
    assert_eq!(read("ct2hair--Bangs_100.data"), expected);
    assert_eq!(read("ct2hair--Bangs_100.bin"), expected);
    let of_curves = |name: &str| read(name).strands.into_iter().map(|s| s.rest_curve_m).collect::<Vec<_>>();
    assert_eq!(of_curves("ct2hair--Bangs_100.abc"), of_curves("ct2hair--Bangs_100.hair"));
    // The PLY is rounded to about 5e-4 of a millimeter.
    for (a, b) in read("ct2hair--Bangs_100.ply").strands.iter().zip(&expected.strands) {
        assert_eq!(a.rest_curve_m.len(), b.rest_curve_m.len());
        assert!(a.rest_curve_m.iter().zip(&b.rest_curve_m).all(|(a, b)| (a - b).norm() < 1.5e-6));
    }
}

#[test]
fn what_a_file_does_not_state_is_asked_for() {
    let Some(shared) = shared() else { return };
    for name in ["yuksel--straight.hair", "ct2hair--Bangs_100.data"] {
        let error = read_groom(&hairstyle(&shared, name), &GroomOptions::default()).unwrap_err();
        assert!(matches!(error, GroomReadError::NotStated { what: "up axis", .. }), "{error}");
    }
}

/// Roots fitted to the head of the captures: roots within a centimeter of it, and where the file's unit can be told
/// from its source, nearly that unit. Guides on a lawn and curves in a row are no hairstyle, and the error says so.
#[test]
fn real_hairstyles_fit_a_head() {
    let Some(shared) = shared() else { return };
    let head = HeadShape { center_m: Vec3::zeros(), half_axes_m: Vec3::new(0.095, 0.075, 0.1) };
    for (name, up, unit_m) in [
        ("yuksel--straight.hair", Some(Axis::PlusZ), None),
        ("ct2hair--Bangs_100.hair", Some(Axis::PlusY), Some(1e-3)),
        ("ct2hair--Bangs_100.data", Some(Axis::PlusY), Some(1e-3)),
        ("ct2hair--Bangs_100.bin", Some(Axis::PlusY), Some(1e-3)),
        ("ct2hair--Bangs_100.abc", Some(Axis::PlusY), Some(1e-3)),
        ("ct2hair--Bangs_100.ply", Some(Axis::PlusY), Some(1e-3)),
        ("arnold-usd--0179-houdini-groom-bspline.usda", None, None),
        ("arnold-usd--0189-houdini-guides-linear.usda", None, None),
        ("arnold-usd--0213-deforming-linear.usda", None, None),
        ("arnold-usd--1334-maya-catmullrom.usda", None, None),
    ] {
        let mut options = GroomOptions::default();
        options.up_axis = up;
        let bytes = hairstyle(&shared, name);
        let length = |read: &ReadGroom| read.groom.strands.iter().map(|s| s.length_m).sum::<f64>();
        options.unit = up.map(|_| LengthUnit::Meter);
        let as_is = length(&read_groom(&bytes, &options).unwrap());
        options.placement = Placement::FitToHead(head);
        let read = match read_groom(&bytes, &options) {
            Ok(read) => read,
            Err(error) => {
                assert!(matches!(error, GroomReadError::Placement { .. }), "{name}: {error}");
                assert!(["0189", "0213", "1334"].iter().any(|n| name.contains(n)), "{name}: {error}");
                continue;
            }
        };
        println!("{name}: {:?}", read.warnings);
        if let Some(unit_m) = unit_m {
            let scale = length(&read) / as_is;
            assert!((scale / unit_m - 1.0).abs() < 0.1, "{name}: {scale}");
        }
        let distance = |root: Vec3| {
            let length = root.component_div(&head.half_axes_m).norm();
            (root * (1.0 - 1.0 / length)).norm()
        };
        let mut off: Vec<f64> = read.groom.strands.iter().map(|s| distance(s.rest_curve_m[0])).collect();
        off.sort_by(f64::total_cmp);
        assert!(off[off.len() / 2] < 0.01, "{name}: {}", off[off.len() / 2]);
    }
}

#[test]
fn the_captures_grooms_are_complete() {
    let Some(shared) = shared() else { return };
    for name in ["gusts_left", "nod_turn", "steady_front", "sweep_0_120", "turbulent_dirty", "two_fans"] {
        let bytes = std::fs::read(shared.join("captures").join(name).join("style_b.json")).unwrap();
        let read = read_groom(&bytes, &GroomOptions::default()).unwrap();
        assert_eq!((read.groom.strands.len(), read.format), (60, GroomFormat::Json));
        assert_eq!((read.groom.assumed, read.warnings), (Vec::new(), Vec::new()));
        assert_eq!(read.groom.strands[0].name, "B01");
    }
}
