//! How many bytes a second the writers for other tools make, in memory: motions as `.npz` and `.usda`, fields as `.npz` and
//! `.vdb`.
//!
//!     cargo bench -p tousle-bench --bench writing
//!
//! 10,000 strands of 16 points in 24 frames, and the gusts of `stepping`: 30³ voxels in 61 steps.

use divan::counter::BytesCount;
use divan::{Bencher, black_box};
use std::io::Cursor;
use std::sync::LazyLock;
use tousle_bench::worlds::{self, gusts};
use tousle_core::{Groom, Strand, StrandMotion, Vec3};
use tousle_export::{
    HairGeometry, UsdOptions, write_field_npz, write_motion_npz, write_motion_usda, write_step_vdb,
};
use tousle_field::FieldSequence;

fn main() {
    divan::main();
}

static MOTION: LazyLock<StrandMotion> = LazyLock::new(motion);
static GROOM: LazyLock<Groom> = LazyLock::new(|| groom(&MOTION));
static FIELD: LazyLock<FieldSequence> = LazyLock::new(gusts);

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
    let at_rest = |k: usize| motion.strand(0, k).iter().map(|p| Vec3::from(p.map(f64::from))).collect();
    let strand = |k: usize| Strand { name: k.to_string(), ..worlds::strand(at_rest(k)) };
    worlds::groom((0..motion.counts.len()).map(strand).collect())
}

fn measure(bencher: Bencher<'_, '_>, write: impl Fn(&mut Cursor<Vec<u8>>) + Sync) {
    let written = || {
        let mut out = Cursor::new(Vec::new());
        write(&mut out);
        out.into_inner()
    };
    bencher.counter(BytesCount::new(written().len())).bench_local(|| black_box(written()));
}

#[divan::bench(max_time = 4)]
fn motion_npz(bencher: Bencher<'_, '_>) {
    measure(bencher, |out| write_motion_npz(&MOTION, out).expect("a motion"));
}

#[divan::bench(args = [HairGeometry::Curves, HairGeometry::Reeds], max_time = 4)]
fn motion_usda(bencher: Bencher<'_, '_>, geometry: HairGeometry) {
    let mut options = UsdOptions::default();
    options.geometry = geometry;
    measure(bencher, |out| write_motion_usda(&MOTION, &GROOM, &options, out).expect("a motion"));
}

/// All steps, one file after another.
#[divan::bench(max_time = 4)]
fn field_vdb(bencher: Bencher<'_, '_>) {
    measure(bencher, |out| {
        (0..FIELD.steps.len()).for_each(|step| write_step_vdb(&FIELD, step, &mut *out).expect("a field"));
    });
}

#[divan::bench(max_time = 4)]
fn field_npz(bencher: Bencher<'_, '_>) {
    measure(bencher, |out| write_field_npz(&FIELD, out).expect("a field"));
}
