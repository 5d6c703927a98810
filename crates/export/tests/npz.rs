//! Motions and fields as NumPy arrays: what is written is read, and what cannot be read says why.

#![allow(clippy::unwrap_used, reason = "a helper of tests may panic as a test may")]

use std::io::{Cursor, Write};

use tousle_core::{Quantity, StrandMotion, Vec3};
use tousle_export::{
    FieldNpzOptions, MotionNpz, NpzError, read_field_npz, read_field_npz_with, read_motion_npz,
    write_field_npz, write_motion_npz, write_numbered_motion_npz,
};
use tousle_field::{Ease, Field, FieldLayer, FieldSequence, GridSpec, Handle, LayerOrigin, VoxelFlag};

fn motion() -> StrandMotion {
    StrandMotion {
        counts: vec![2, 3],
        times_secs: vec![0.0, 0.5],
        positions_m: (0..10_u8).map(|k| [f32::from(k), 0.25, -1.0]).collect(),
    }
}

/// Two voxels by one by one, three steps; the first component of a voxel is its number. How sure the second is nobody
/// knows.
fn field() -> FieldSequence {
    let grid = GridSpec { origin_m: Vec3::new(-0.1, -0.05, 0.0), edge_m: 0.1, dims: [2, 1, 1] };
    let step = |k: f32| Field {
        u: vec![10.0 * k, 10.0 * k + 1.0, 0.5, 0.5, -0.5, -0.5],
        flags: vec![VoxelFlag::Measured, VoxelFlag::Outside],
        sd: Some(vec![0.25, f32::INFINITY]),
        outside: Vec3::new(3.0, 0.0, 0.125),
    };
    FieldSequence {
        grid,
        quantity: Quantity::ForcePerMass,
        start_secs: 0.25,
        rate_hz: 30.0,
        steps: vec![step(0.0), step(1.0), step(2.0)],
        layers: Vec::new(),
    }
}

fn bytes_of(write: impl FnOnce(&mut Cursor<Vec<u8>>)) -> Vec<u8> {
    let mut out = Cursor::new(Vec::new());
    write(&mut out);
    out.into_inner()
}

/// An array as another program might write it: any type, any order, any bytes.
fn npy(descr: &str, fortran_order: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if fortran_order { "True" } else { "False" };
    let text = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes.extend(data);
    bytes
}

fn npz(arrays: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (key, bytes) in arrays {
        zip.start_file(format!("{key}.npy"), zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

fn f8(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// A field of two steps on a grid of 1 x 2 x 1 voxels, as little as is allowed, with one array replaced.
fn foreign(replace: &str, by: Option<Vec<u8>>) -> Vec<u8> {
    let mut arrays = vec![
        ("t", npy("<f8", false, "(2,)", &f8(&[0.0, 0.1]))),
        ("u", npy("|i1", false, "(2, 3, 1, 2, 1)", &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12])),
        ("origin", npy("<f8", false, "(3,)", &f8(&[0.0; 3]))),
        ("edge", npy("<f8", false, "()", &f8(&[0.1]))),
        ("quantity", npy("|S12", false, "()", b"air_velocity")),
    ];
    arrays.retain(|(key, _)| *key != replace);
    if let Some(bytes) = by {
        arrays.push((replace, bytes));
    }
    npz(&arrays)
}

#[test]
fn a_motion_comes_back_and_its_bytes_are_always_the_same() {
    let bytes = bytes_of(|out| write_motion_npz(&motion(), out).unwrap());
    assert_eq!(read_motion_npz(&bytes).unwrap(), motion());
    assert_eq!(bytes, bytes_of(|out| write_motion_npz(&motion(), out).unwrap()));
}

#[test]
fn frames_one_by_one_make_the_same_archive() {
    let motion = motion();
    let numbers = [3, 7];
    for numbers in [None, Some(&numbers[..])] {
        let put = |out: &mut Cursor<Vec<u8>>, frames: &[usize]| {
            let mut npz = MotionNpz::begin(&motion.counts, &motion.times_secs, numbers, out)?;
            frames.iter().try_for_each(|frame| npz.put(motion.frame(*frame)))?;
            npz.finish()
        };
        let all: Vec<usize> = (0..motion.times_secs.len()).collect();
        let whole = bytes_of(|out| match numbers {
            None => write_motion_npz(&motion, out).unwrap(),
            Some(numbers) => write_numbered_motion_npz(&motion, numbers, out).unwrap(),
        });
        assert!(bytes_of(|out| put(out, &all).unwrap()) == whole);
        // Neither a frame too few nor one too many.
        let error = |frames: &[usize]| put(&mut Cursor::new(Vec::new()), frames).unwrap_err().to_string();
        let (n, one_more) = (all.len(), [&all[..], &[0]].concat());
        assert_eq!(error(&all[1..]), format!("the motion: found {} frames, expected {n}", n - 1));
        let points = motion.n_points();
        assert_eq!(
            error(&one_more),
            format!(
                "the motion: found {points} points in frame {n}, expected {points} in each of {n} frames"
            )
        );
    }
    let one = [1];
    let error = MotionNpz::begin(&motion.counts, &motion.times_secs, Some(&one), Cursor::new(Vec::new()));
    assert_eq!(error.unwrap_err().to_string(), "the motion: found 1 numbers of strands, expected 2");
}

#[test]
fn a_motion_that_does_not_fit_together_is_not_written() {
    let short = StrandMotion { times_secs: vec![0.0, 0.5, 1.0], ..motion() };
    let error = write_motion_npz(&short, Cursor::new(Vec::new())).unwrap_err().to_string();
    assert_eq!(error, "the motion: found 10 positions, expected 15, which is 5 points in 3 frames");
    let mut broken = motion();
    broken.positions_m[7][1] = f32::NAN;
    let error = write_motion_npz(&broken, Cursor::new(Vec::new())).unwrap_err().to_string();
    assert!(error.contains("in frame 1, point 2"), "{error}");
}

#[test]
fn a_field_comes_back() {
    let bytes = bytes_of(|out| write_field_npz(&field(), out).unwrap());
    let read = read_field_npz_with(&bytes, &FieldNpzOptions::default()).unwrap();
    assert_eq!(read.field, field());
    assert_eq!(read.assumed, []);
}

#[test]
fn edits_are_added_to_the_voxels() {
    let handle =
        Handle { center_m: Vec3::new(-0.05, 0.0, 0.05), reach_m: 0.05, extra: Vec3::new(0.0, 7.0, 0.0) };
    let origin = LayerOrigin::Drag {
        strand: "S01".into(),
        control_point: 1,
        target_m: Vec3::zeros(),
        method: "paper".into(),
    };
    let layer = FieldLayer {
        id: "1".into(),
        name: "lift".into(),
        muted: false,
        first_secs: 0.0,
        last_secs: 9.0,
        ease: Ease { rise: 0.0, fall: 0.0 },
        handles: vec![handle],
        reshape: None,
        origin,
    };
    let edited = FieldSequence { layers: vec![layer], ..field() };
    let bytes = bytes_of(|out| write_field_npz(&edited, out).unwrap());
    let read = read_field_npz(&bytes).unwrap();
    // The handle sits on the center of voxel 0 and does not reach voxel 1: y components are 2 and 3 in `u`.
    assert_eq!(read.steps[1].u[2..4], [7.5, 0.5]);
}

#[test]
fn a_foreign_field_with_as_little_as_allowed() {
    let read = read_field_npz_with(&foreign("", None), &FieldNpzOptions::default()).unwrap();
    assert_eq!(read.field.rate_hz, 10.0);
    assert_eq!(read.field.steps[1].u, [7.0, 8.0, 9.0, 10.0, 11.0, 12.0]);
    assert_eq!(read.field.steps[0].outside, Vec3::new(1.5, 3.5, 5.5), "the mean of the outermost voxels");
    assert_eq!(read.field.steps[0].flags, [VoxelFlag::Interpolated; 2]);
    let assumed: Vec<&str> = read.assumed.iter().map(|a| a.what.as_str()).collect();
    assert_eq!(assumed, ["flag", "outside"]);
}

#[test]
fn fortran_order_and_every_type_read_equal() {
    let expected = read_field_npz(&foreign("", None)).unwrap();
    // The same twelve numbers, first axis fastest: steps alternate.
    let fortran: Vec<u8> = vec![1, 7, 3, 9, 5, 11, 2, 8, 4, 10, 6, 12];
    let fortran = npy("|u1", true, "(2, 3, 1, 2, 1)", &fortran);
    assert_eq!(read_field_npz(&foreign("u", Some(fortran))).unwrap(), expected);
    let big: Vec<u8> = (1..=12_u8).flat_map(|k| f64::from(k).to_be_bytes()).collect();
    assert_eq!(
        read_field_npz(&foreign("u", Some(npy(">f8", false, "(2, 3, 1, 2, 1)", &big)))).unwrap(),
        expected
    );
}

#[test]
fn quantized_vectors_are_scaled() {
    let mut arrays = vec![
        ("t", npy("<f8", false, "(1,)", &f8(&[2.0]))),
        ("scale", npy("<f8", false, "()", &f8(&[0.5]))),
        ("u_q", npy("|i1", false, "(1, 3, 1, 1, 1)", &[2, 0xff, 4])),
    ];
    let options = || FieldNpzOptions::default();
    let error = read_field_npz(&npz(&arrays)).unwrap_err();
    assert!(matches!(error, NpzError::MissingKey { key: "quantity", .. }), "{error}");
    let mut told = options();
    told.extent_m = Some(0.6);
    told.quantity = Some(Quantity::AirVelocity);
    let read = read_field_npz_with(&npz(&arrays), &told).unwrap();
    assert_eq!(read.field.steps[0].u, [1.0, -0.5, 2.0]);
    assert_eq!(read.field.grid, GridSpec::cube(0.6, 0.6).unwrap());
    arrays.remove(1);
    let error = read_field_npz_with(&npz(&arrays), &told).unwrap_err();
    assert!(matches!(error, NpzError::MissingKey { key: "scale", .. }), "{error}");
}

#[test]
fn what_is_wrong_is_named_with_its_place() {
    let u = |descr, shape, data: &[u8]| Some(npy(descr, false, shape, data));
    let nan: Vec<u8> = (0..12).flat_map(|k| if k == 9 { f32::NAN } else { 1.0 }.to_le_bytes()).collect();
    let wide: Vec<u8> = (0..12).flat_map(|k| if k == 11 { 1e300_f64 } else { 1.0 }.to_le_bytes()).collect();
    let times = |t: &[f64]| Some(npy("<f8", false, &format!("({},)", t.len()), &f8(t)));
    for (key, by, says) in [
        ("u", None, "found arrays [\"t\", \"origin\", \"edge\", \"quantity\"], expected one called `u`"),
        ("t", None, "expected one called `t`"),
        ("edge", None, "expected one called `edge`"),
        (
            "u",
            u("<f4", "(2, 3, 1, 2, 1)", &nan),
            "array `u` at [1, 1, 0, 1, 0]: found NaN, expected a finite",
        ),
        ("u", u("<f8", "(2, 3, 1, 2, 1)", &wide), "array `u` at [1, 2, 0, 1, 0]: found 1000000"),
        ("u", u("|i1", "(2, 3, 1, 2, 1)", &[0; 11]), "array `u`: value 6 of 12 cannot be read"),
        ("u", u("|i1", "(2, 3, 2)", &[0; 12]), "array `u`: found shape [2, 3, 2], expected (2, 3, X, Y, Z)"),
        ("u", u("|i1", "(1, 3, 1, 2, 1)", &[0; 6]), "found shape [1, 3, 1, 2, 1], expected (2, 3, X, Y, Z)"),
        ("u", u("|i1", "(2, 3, 1, 0, 1)", &[]), "none of them 0"),
        (
            "u",
            u("|i1", "(2, 3, 300, 300, 300)", &[]),
            "found 27000000 voxels a step, expected at most 16777216",
        ),
        (
            "u",
            u("<f8", "(2, 3, 4000000000, 4000000000, 4000000000)", &[]),
            "expected at most 4294967296 bytes",
        ),
        ("u", u("<c8", "(2, 3, 1, 2, 1)", &[0; 96]), "array `u`: found type \"<c8\", expected f2, f4, f8"),
        ("u", u("<U1", "(2, 3, 1, 2, 1)", &[0; 48]), "array `u`: found type <U1, expected numbers"),
        ("t", times(&[0.0, 0.1, 0.2]), "array `u`: found shape [2, 3, 1, 2, 1]"),
        ("t", times(&[]), "array `t`: found shape [0], expected (T,) with at least one step"),
        ("t", times(&[0.1, 0.1]), "array `t` at [1]: found 0.1 s, expected more than the 0.1 s"),
        ("t", times(&[0.2, 0.1]), "array `t` at [1]: found 0.1 s, expected more than the 0.2 s"),
        ("t", times(&[0.0, f64::INFINITY]), "array `t` at [1]: found inf, expected a finite number"),
        ("edge", Some(npy("<f8", false, "()", &f8(&[0.0]))), "found voxel edge = 0 mm"),
        (
            "edge",
            Some(npy("<f8", false, "(2,)", &f8(&[1.0, 1.0]))),
            "array `edge`: found shape [2], expected () or",
        ),
        (
            "origin",
            Some(npy("<f8", false, "(2,)", &f8(&[1.0, 1.0]))),
            "array `origin`: found shape [2], expected (3,)",
        ),
        (
            "quantity",
            Some(npy("|S4", false, "()", b"wind")),
            "array `quantity`: found \"wind\", expected \"air_velo",
        ),
        (
            "quantity",
            Some(npy("<f8", false, "()", &f8(&[1.0]))),
            "array `quantity`: found type <f8, expected text",
        ),
        (
            "flag",
            Some(npy("|u1", false, "(2, 1, 2, 1)", &[0, 1, 2, 3])),
            "array `flag` at [1, 0, 1, 0]: found 3",
        ),
        ("flag", Some(npy("|u1", false, "(2, 2, 1, 1)", &[0; 4])), "expected (2, 1, 2, 1) as of `u`"),
        (
            "sd",
            Some(npy("|i1", false, "(2, 1, 2, 1)", &[0, 0xff, 0, 0])),
            "array `sd` at [0, 0, 1, 0]: found -1, expected 0 or a number above",
        ),
        (
            "sd",
            Some(npy("<f8", true, "(2, 1, 2, 1)", &f8(&[0.0, f64::INFINITY, f64::NAN, 0.0]))),
            "array `sd` at [0, 0, 1, 0]: found NaN, expected 0 or a number above",
        ),
        (
            "sd",
            Some(npy("<f8", false, "(2, 1, 2, 1)", &f8(&[0.0, 0.0, 1e300, 0.0]))),
            "array `sd` at [1, 0, 0, 0]: found 1000000",
        ),
        (
            "outside",
            Some(npy("|i1", false, "(3, 2)", &[0; 6])),
            "array `outside`: found shape [3, 2], expected (2, 3)",
        ),
    ] {
        let error = read_field_npz(&foreign(key, by)).unwrap_err().to_string();
        assert!(error.contains(says), "{says}\n{error}");
    }
}

#[test]
fn an_uneven_step_is_found_and_rounded_times_are_not() {
    let field_at = |t: &[f64], descr: &str, bytes: Vec<u8>| {
        let n = t.len();
        npz(&[
            ("t", npy(descr, false, &format!("({n},)"), &bytes)),
            ("u", npy("|i1", false, &format!("({n}, 3, 1, 1, 1)"), &vec![1; 3 * n])),
            ("origin", npy("<f8", false, "(3,)", &f8(&[0.0; 3]))),
            ("edge", npy("<f8", false, "()", &f8(&[0.1]))),
            ("quantity", npy("|S12", false, "()", b"air_velocity")),
        ])
    };
    let thirtieths: Vec<f64> = (0..150).map(|k| f64::from(k) / 30.0).collect();
    let f4: Vec<u8> = thirtieths.iter().flat_map(|t| (*t as f32).to_le_bytes()).collect();
    assert_eq!(read_field_npz(&field_at(&thirtieths, "<f4", f4)).unwrap().rate_hz, 30.0);
    let uneven = [0.0, 0.1, 0.25, 0.3];
    let error = read_field_npz(&field_at(&uneven, "<f8", f8(&uneven))).unwrap_err();
    assert!(matches!(error, NpzError::UnevenTime { index: 2, .. }), "{error}");
    let falling = [0.3, 0.2, 0.1, 0.0];
    let error = read_field_npz(&field_at(&falling, "<f8", f8(&falling))).unwrap_err();
    assert!(matches!(error, NpzError::FallingTime { index: 1, found: 0.2, before: 0.3 }), "{error}");
}

/// Whatever is cut off or turned over: refused, or right. A zip holds much that carries no meaning here (times,
/// permissions, a second copy of each header), and a name turned over makes an optional array missing.
#[test]
fn damaged_archives_are_never_read_wrong() {
    let whole = bytes_of(|out| write_field_npz(&field(), out).unwrap());
    for len in 0..whole.len() {
        assert!(read_field_npz(&whole[..len]).is_err(), "cut to {len} bytes");
    }
    let expected = field();
    for at in 0..whole.len() {
        for bit in 0..8 {
            let mut bytes = whole.clone();
            bytes[at] ^= 1 << bit;
            let Ok(read) = read_field_npz_with(&bytes, &FieldNpzOptions::default()) else { continue };
            let field = read.field;
            assert_eq!(field.grid, expected.grid, "byte {at}, bit {bit}");
            assert_eq!(
                (field.start_secs, field.rate_hz, field.quantity),
                (expected.start_secs, expected.rate_hz, expected.quantity),
                "byte {at}, bit {bit}"
            );
            for (found, expected) in field.steps.iter().zip(&expected.steps) {
                assert_eq!(found.u, expected.u, "byte {at}, bit {bit}");
                assert!(!read.assumed.is_empty() || found.flags == expected.flags, "byte {at}, bit {bit}");
                assert!(found.sd.is_none() || found.sd == expected.sd, "byte {at}, bit {bit}");
            }
        }
    }
}
