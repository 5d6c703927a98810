//! How long the writers take and how much they write. Run by hand:
//! `cargo test --release -p tousle-export --test timing -- --ignored --nocapture`.

#![allow(clippy::unwrap_used, reason = "a helper of tests may panic as a test may")]

use std::io::{BufWriter, Seek, Write};
use std::time::Instant;

use tousle_core::{Groom, Quantity, Strand, StrandMotion, Vec3};
use tousle_export::{
    HairGeometry, UsdOptions, write_field_npz, write_motion_npz, write_motion_usda, write_step_vdb,
};
use tousle_field::{Field, FieldSequence, GridSpec};

/// 10,000 strands of 16 points in 24 frames, swinging.
fn motion() -> StrandMotion {
    let (n_strands, n_points, n_frames) = (10_000_u16, 16_u8, 24_u8);
    let mut positions_m = Vec::new();
    for frame in 0..n_frames {
        for strand in 0..n_strands {
            let (sin, cos) = libm::sincosf(f32::from(strand));
            for point in 0..n_points {
                let down = f32::from(point) * 0.015;
                let swing = 0.2 * down * libm::sinf(f32::from(frame) * 0.3 + f32::from(strand) * 0.01);
                positions_m.push([0.09 * cos + swing, 0.08 * sin + down * down, 0.05 - down]);
            }
        }
    }
    StrandMotion {
        counts: vec![usize::from(n_points); usize::from(n_strands)],
        times_secs: (0..n_frames).map(|k| f64::from(k) / 24.0).collect(),
        positions_m,
    }
}

/// A groom that hangs as the motion begins.
fn groom(motion: &StrandMotion) -> Groom {
    let strand = |k: usize| Strand {
        name: k.to_string(),
        rest_curve_m: motion.strand(0, k).iter().map(|p| Vec3::from(p.map(f64::from))).collect(),
        length_m: 0.25,
        linear_density_kg_per_m: 1e-3,
        lock_width_m: 0.001,
        bending_stiffness_n_m2: 1e-6,
        internal_damping_secs: 0.02,
        along: tousle_core::Along::default(),
        holds_style: false,
    };
    Groom { strands: (0..motion.counts.len()).map(strand).collect(), assumed: Vec::new() }
}

/// 30³ voxels in 150 steps of smooth wind with noise in its last bits, as fields from captures have.
fn field() -> FieldSequence {
    let grid = GridSpec::cube(0.6, 0.02).unwrap();
    let mut seed = 1_u32;
    let mut steps = Vec::new();
    for k in 0..150_u8 {
        let mut field = Field::still(&grid);
        for flat in 0..grid.n_voxels() {
            let p = grid.cell_center_m(grid.unflat(flat));
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let noise = f64::from(seed >> 8) * 1e-9;
            let gust = libm::sin(f64::from(k) * 0.1 + p.x * 9.0);
            field.set_vector(flat, Vec3::new(3.0 + gust, p.y * 4.0, p.z + noise));
        }
        steps.push(field);
    }
    let quantity = Quantity::AirVelocity;
    FieldSequence { grid, quantity, start_secs: 0.0, rate_hz: 30.0, steps, layers: Vec::new() }
}

fn time(what: &str, write: impl FnOnce(&mut BufWriter<std::fs::File>)) {
    let mut out = BufWriter::new(tempfile::tempfile().unwrap());
    let start = Instant::now();
    write(&mut out);
    out.flush().unwrap();
    let secs = start.elapsed().as_secs_f64();
    let mb = out.stream_position().unwrap() as f64 / 1e6;
    println!("{what}: {secs:.2} s, {mb:.1} MB");
}

#[test]
#[ignore = "takes seconds and prints figures"]
fn writers() {
    let (motion, field) = (motion(), field());
    let groom = groom(&motion);
    println!("motion: 10,000 strands x 16 points x 24 frames; field: 30^3 voxels x 150 steps");
    time("motion .npz", |out| write_motion_npz(&motion, out).unwrap());
    let mut options = UsdOptions::default();
    time("curves .usda", |out| write_motion_usda(&motion, &groom, &options, out).unwrap());
    options.geometry = HairGeometry::Reeds;
    time("reeds .usda", |out| write_motion_usda(&motion, &groom, &options, out).unwrap());
    time("field .vdb, all steps", |out| {
        (0..field.steps.len()).for_each(|step| write_step_vdb(&field, step, &mut *out).unwrap());
    });
    time("field .npz", |out| write_field_npz(&field, out).unwrap());
}
