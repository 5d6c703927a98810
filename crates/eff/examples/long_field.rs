//! Writes a field of many steps to a file, reads every step back, and says how much memory that took:
//!
//!     cargo run --release -p tousle-eff --example long_field -- OUT.eff.mcap [STEPS]

use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::time::Instant;
use tousle_core::{Body, Pose, PoseTrack, Quantity, Vec3};
use tousle_eff::{Head, Reader, WriteOptions, Writer, validate};
use tousle_field::{Field, GridSpec, Scene};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let path = args.next().ok_or("expected a file to write to")?;
    let n_steps = args.next().map_or(Ok(10_000), |n| n.parse())?;
    let grid = GridSpec::cube(0.6, 0.02)?;
    let scene = Scene {
        poses: PoseTrack::still(Pose::identity()),
        rest_pose: Pose::identity(),
        gravity_world: Vec3::new(0.0, 0.0, -9.81),
        air_density: 1.2,
        body: Body::none(),
    };
    let head = Head {
        name: "long",
        method: "by hand",
        generator: "example",
        grid,
        quantity: Quantity::AirVelocity,
        start_secs: 0.0,
        rate_hz: 30.0,
        n_steps: Some(n_steps),
        layers: &[],
        scene: &scene,
        samples: None,
    };

    let start = Instant::now();
    let mut writer = Writer::new(BufWriter::new(File::create(&path)?), &head, &WriteOptions::default())?;
    let mut noise = 1;
    for k in 0..n_steps {
        writer.step(&step(&grid, k, &mut noise))?;
    }
    let (report, _) = writer.finish()?;
    println!(
        "wrote {n_steps} steps, {:.0} MB, in {:.1?}; {}",
        report.n_bytes as f64 / 1e6,
        start.elapsed(),
        peak()
    );

    let start = Instant::now();
    let mut reader = Reader::open(BufReader::new(File::open(&path)?))?;
    for k in 0..reader.n_steps() {
        reader.step(k)?;
    }
    println!("read them one by one in {:.1?}; {}", start.elapsed(), peak());

    let start = Instant::now();
    let is_sound = validate(BufReader::new(File::open(&path)?))?.is_sound;
    println!("validated (sound: {is_sound}) in {:.1?}; {}", start.elapsed(), peak());
    Ok(())
}

/// Smooth wind that swells, with some noise so that it compresses as real wind does.
fn step(grid: &GridSpec, k: u64, noise: &mut u64) -> Field {
    let swell = 2.0 + libm::sin(0.1 * k as f64);
    let mut field = Field::still(grid);
    for flat in 0..grid.n_voxels() {
        let p = grid.cell_center_m(grid.unflat(flat));
        *noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let jitter = (*noise >> 40) as f64 / f64::from(1 << 24) - 0.5;
        field.set_vector(flat, Vec3::new(swell + p.y, 0.3 * p.x + 0.01 * jitter, p.z * swell));
    }
    field
}

/// The most memory this program has had, where the system says.
fn peak() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    peak.map_or_else(|| "memory unknown".into(), |peak| format!("peak memory {}", peak.trim()))
}
