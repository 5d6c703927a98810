//! One lock of hair in a steady wind: where its tip goes.
//!
//!     cargo run -p tousle-sim --example 1_one_lock

use tousle_core::{Body, Groom, NoProgress, Pose, PoseTrack, Quantity, Strand, Vec3};
use tousle_field::{Field, FieldSequence, GridSpec, Scene};
use tousle_sim::{SimOptions, simulate};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Thirty centimeters of hair that hangs straight down, a bundle 4 mm wide.
    let lock = Strand {
        name: "lock".into(),
        rest_curve_m: (0..=15).map(|k| Vec3::new(0.1, 0.0, -0.02 * f64::from(k))).collect(),
        length_m: 0.3,
        linear_density_kg_per_m: 1.5e-3,
        lock_width_m: 4e-3,
        bending_stiffness_n_m2: 2e-6,
        internal_damping_secs: 0.02,
        along: tousle_core::Along::default(),
        holds_style: false,
    };
    let groom = Groom { strands: vec![lock], assumed: Vec::new() };

    // The same wind everywhere and always: 2 m/s from the front. One step stands for all times.
    let grid = GridSpec::cube(0.6, 0.1)?;
    let mut wind = Field::still(&grid);
    wind.outside = Vec3::new(-2.0, 0.0, 0.0);
    (0..grid.n_voxels()).for_each(|voxel| wind.set_vector(voxel, Vec3::new(-2.0, 0.0, 0.0)));
    let field = FieldSequence {
        grid,
        quantity: Quantity::AirVelocity,
        start_secs: 0.0,
        rate_hz: 30.0,
        steps: vec![wind],
        layers: Vec::new(),
    };

    // A head that does not move, and nothing to bump into.
    let scene = Scene {
        poses: PoseTrack::still(Pose::identity()),
        rest_pose: Pose::identity(),
        gravity_world: Vec3::new(0.0, 0.0, -9.81),
        air_density: 1.2,
        body: Body::none(),
    };

    let options = SimOptions { duration_secs: Some(2.0), ..SimOptions::default() };
    let simulation = simulate(&field, &scene, &groom, &options, &NoProgress)?;
    for frame in (0..simulation.motion.times_secs.len()).step_by(12) {
        let [x, _, z] = simulation.motion.strand(frame, 0)[15];
        println!(
            "{:.1} s: tip {:5.1} cm back, {:5.1} cm down",
            simulation.motion.times_secs[frame],
            (0.1 - x) * 100.0,
            -z * 100.0
        );
    }
    for entry in &simulation.report.plan {
        println!("{} {}: {}", if entry.active { "+" } else { "-" }, entry.term, entry.why);
    }
    Ok(())
}
