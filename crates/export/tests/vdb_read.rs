//! Wind from OpenVDB files: what we wrote comes back bit for bit, what the real OpenVDB wrote (`fixtures/vdb`, its own
//! generator beside it) is what it says it wrote, and no bytes panic.

#![allow(clippy::unwrap_used, reason = "a helper of tests may panic as a test may")]

use serde_json::Value;
use std::path::{Path, PathBuf};
use tousle_core::{Quantity, Vec3};
use tousle_export::{VdbError, VdbOptions, join_steps_vdb, read_step_vdb, write_step_vdb};
use tousle_field::{Field, FieldSequence, GridSpec, VoxelFlag};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/vdb")
}

fn fixture(name: &str) -> Vec<u8> {
    std::fs::read(folder().join(name)).unwrap()
}

/// Five steps of 20 x 9 x 7 voxels: several leaves, none of them full.
fn field() -> FieldSequence {
    let grid = GridSpec { origin_m: Vec3::new(-0.3, -0.17, 0.01), edge_m: 0.02, dims: [20, 9, 7] };
    let n = grid.n_voxels();
    let step = |k: usize| Field {
        u: (0..3 * n).map(|i| ((i * 37 + k * 11) % 101) as f32 * 0.173 - 7.1).collect(),
        flags: (0..n).map(|i| VoxelFlag::from_byte(((i + k) % 3) as u8).unwrap()).collect(),
        sd: Some((0..n).map(|i| if i % 5 == 0 { f32::INFINITY } else { i as f32 * 0.01 }).collect()),
        outside: Vec3::new(0.1 * k as f64, -2.0, 1.0 / 3.0),
    };
    FieldSequence {
        grid,
        quantity: Quantity::ForcePerMass,
        start_secs: 0.7,
        rate_hz: 29.97,
        steps: (0..5).map(step).collect(),
        layers: Vec::new(),
    }
}

fn written(field: &FieldSequence, step: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_step_vdb(field, step, &mut bytes).unwrap();
    bytes
}

#[test]
fn what_we_write_comes_back_bit_for_bit() {
    let field = field();
    let options = VdbOptions::default();
    let steps: Vec<_> = (0..5).map(|k| read_step_vdb(&written(&field, k), &options).unwrap()).collect();
    let read = join_steps_vdb(&steps, &options).unwrap();
    assert_eq!(read.field, field);
    assert!(read.assumed.is_empty(), "{:?}", read.assumed);
    // A single one, too: its rate is said and not told from times.
    let read = join_steps_vdb(&steps[2..3], &options).unwrap();
    assert_eq!((read.field.rate_hz, read.field.start_secs), (29.97, field.time_secs(2)));
    assert_eq!(read.field.steps[0], field.steps[2]);
}

#[test]
fn what_openvdb_wrote_is_what_it_says() {
    let mut n = 0;
    for entry in std::fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "vdb") {
            continue;
        }
        n += 1;
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let twin: Value =
            serde_json::from_slice(&std::fs::read(path.with_extension("json")).unwrap()).unwrap();
        let step = read_step_vdb(&fixture(&format!("{name}.vdb")), &VdbOptions::default()).unwrap();
        let field = join_steps_vdb(&[step], &VdbOptions::default()).unwrap().field;
        let numbers = |key: &str| -> Vec<f64> {
            twin[key].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
        };
        let edge_m = twin["edge_m"].as_f64().unwrap();
        let (low, center) = (numbers("low"), numbers("center_of_000_m"));
        for axis in 0..3 {
            let corner = center[axis] + (low[axis] - 0.5) * edge_m;
            assert!((field.grid.origin_m[axis] - corner).abs() < 1e-12, "{name}");
        }
        assert!((field.grid.edge_m - edge_m).abs() < 1e-15, "{name}");
        assert_eq!(field.grid.dims.map(|d| d as f64).to_vec(), numbers("dims"), "{name}");
        let active = twin["active"].as_str().unwrap().as_bytes();
        let step = &field.steps[0];
        let n_voxels = field.grid.n_voxels();
        for (flat, expected) in numbers("vectors").chunks_exact(3).enumerate() {
            let found = step.vector(flat);
            for (axis, expected) in expected.iter().enumerate() {
                // Half precision keeps eleven bits; all else is bit for bit.
                let allowed = if name == "half" { expected.abs() / 2048.0 } else { 0.0 };
                let expected = f64::from(*expected as f32);
                assert!((found[axis] - expected).abs() <= allowed, "{name} {flat} {found} {expected}");
            }
            let is_active = step.flags[flat] == VoxelFlag::Interpolated;
            assert_eq!(is_active, active[flat] == b'1', "{name} {flat}");
        }
        assert_eq!(step.flags.len(), n_voxels);
    }
    assert!(n >= 5, "{n}");
}

#[test]
fn steps_of_other_boxes_become_one() {
    let mut field = field();
    field.steps.truncate(1);
    let late = FieldSequence {
        grid: GridSpec { origin_m: field.grid.origin_m, dims: [2, 2, 2], ..field.grid },
        start_secs: 0.8,
        steps: vec![Field::still(&GridSpec { dims: [2, 2, 2], ..field.grid })],
        ..field.clone()
    };
    let options = VdbOptions::default();
    let steps = [&field, &late].map(|f| read_step_vdb(&written(f, 0), &options).unwrap());
    let read = join_steps_vdb(&steps, &options).unwrap().field;
    assert_eq!(read.grid.dims, field.grid.dims);
    assert!((read.rate_hz - 10.0).abs() < 1e-9);
    assert_eq!(read.steps[0], field.steps[0]);
    assert_eq!(read.steps[1].vector(500), Vec3::zeros());
    assert_eq!(read.steps[1].flags[500], VoxelFlag::Outside);
    // The other way round time would run backwards.
    let [a, b] = steps;
    let error = join_steps_vdb(&[b, a], &options).unwrap_err();
    assert!(matches!(error, VdbError::BadStep { step: 1, .. }), "{error}");
}

#[test]
fn what_cannot_be_read_is_refused_in_words() {
    let options = VdbOptions::default();
    let message = |bytes: &[u8]| read_step_vdb(bytes, &options).unwrap_err().to_string();
    assert!(message(b"PK\x03\x04 and so on").contains("OpenVDB"));
    let mut old = fixture("dense.vdb");
    old[8] = 213;
    assert_eq!(message(&old), "found file version 213, expected 222 to 224 (OpenVDB 3 and later)");
    let wanted = VdbOptions::default();
    let wanted = {
        let mut w = wanted;
        w.wind = Some("steam".into());
        w
    };
    let error = read_step_vdb(&fixture("smoke.vdb"), &wanted).unwrap_err().to_string();
    assert!(error.contains("vel (Tree_vec3s_5_4_3)") && error.contains("\"steam\""), "{error}");
    let cut = fixture("dense.vdb");
    assert!(message(&cut[..cut.len() - 9]).contains("expected"));
}

/// Bytes of small files changed in some way, and cuts: an error or a field, never a panic.
#[test]
fn no_bytes_panic() {
    for seed in [written(&field(), 0), fixture("sparse.vdb"), fixture("tiled.vdb")] {
        // Most bytes are masks of nodes that are all zeros; those that say something are in the first part and the
        // last.
        let places = (0..seed.len()).filter(|at| seed[*at] != 0 || at % 997 == 0);
        for (k, at) in places.step_by(5).enumerate() {
            let mut bytes = seed.clone();
            bytes[at] = [bytes[at] ^ 1, 0xff, bytes[at].wrapping_add(16), 0x80][k % 4];
            if let Ok(step) = read_step_vdb(&bytes, &VdbOptions::default()) {
                let _ = join_steps_vdb(&[step], &VdbOptions::default());
            }
            if k % 16 == 0 {
                let _ = read_step_vdb(&seed[..at], &VdbOptions::default());
            }
        }
    }
}
