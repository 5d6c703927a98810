//! Simulates a hairstyle in a known wind: `true_wind FOLDER OUT.f32 [integrator] [dt_secs]`.
//!
//! FOLDER holds `scene.json` (groom, poses, body) and `field.f32` (steps x 3 x X x Y x Z, m/s); OUT gets the
//! positions (frames x points x 3, m). A script that has the truth of a capture writes the one and reads the
//! other, so that an accuracy figure needs no reader of captures and no field file.

use serde_json::Value;
use std::time::Instant;
use tousle_core::{
    Attachment, Body, Collider, Groom, NoProgress, Pose, PoseTrack, Quantity, Shape, Strand, Vec3,
};
use tousle_field::{Field, FieldSequence, GridSpec, Scene, VoxelFlag};
use tousle_sim::{Integrator, SimOptions, simulate};

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let folder = &arguments[1];
    let json = std::fs::read_to_string(format!("{folder}/scene.json")).expect("scene.json can be read");
    let json: Value = serde_json::from_str(&json).expect("scene.json is JSON");
    let field = field(&json, &std::fs::read(format!("{folder}/field.f32")).expect("field.f32 can be read"));
    let options = SimOptions {
        integrator: arguments
            .get(3)
            .map_or(Integrator::default(), |n| Integrator::from_name(n).expect("a known integrator")),
        dt_secs: arguments.get(4).map(|s| s.parse().expect("dt_secs is a number")),
        ..SimOptions::default()
    };
    let begin = Instant::now();
    let simulation = simulate(&field, &scene(&json), &groom(&json), &options, &NoProgress).expect("it runs");
    let seconds = begin.elapsed().as_secs_f64();
    let report = &simulation.report;
    let last = simulation.motion.times_secs.last().copied().unwrap_or(0.0);
    println!(
        "{} dt {:.6} s, {} steps, {seconds:.3} s of run time, {:.4} a simulated second, stretch {:.1e}",
        report.integrator.name(),
        report.dt_secs,
        report.n_steps,
        seconds / last,
        report.max_stretch
    );
    let bytes: Vec<u8> =
        simulation.motion.positions_m.iter().flatten().flat_map(|c| c.to_le_bytes()).collect();
    std::fs::write(&arguments[2], bytes).expect("OUT can be written");
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("an array").iter().map(|v| v.as_f64().expect("a number")).collect()
}

fn vec3(value: &Value) -> Vec3 {
    Vec3::from_iterator(numbers(value))
}

fn groom(json: &Value) -> Groom {
    let strand = |s: &Value| Strand {
        name: s["name"].as_str().expect("a name").to_owned(),
        rest_curve_m: s["rest_curve_m"].as_array().expect("points").iter().map(vec3).collect(),
        length_m: s["length_m"].as_f64().expect("a number"),
        linear_density_kg_per_m: s["linear_density_kg_per_m"].as_f64().expect("a number"),
        lock_width_m: s["lock_width_m"].as_f64().expect("a number"),
        bending_stiffness_n_m2: s["bending_stiffness_N_m2"].as_f64().expect("a number"),
        internal_damping_secs: s["internal_damping_time_s"].as_f64().expect("a number"),
    };
    Groom {
        strands: json["strands"].as_array().expect("strands").iter().map(strand).collect(),
        assumed: Vec::new(),
    }
}

fn scene(json: &Value) -> Scene {
    let pose = |p: &Value| {
        let rotation = nalgebra::Matrix3::from_row_slice(&numbers(&p["r"]));
        let rotation = nalgebra::UnitQuaternion::from_matrix(&rotation);
        Pose::from_parts(vec3(&p["p"]).into(), rotation)
    };
    let poses: Vec<Pose> = json["poses"].as_array().expect("poses").iter().map(pose).collect();
    let capsule = |name: &str, attachment: Attachment| Collider {
        name: name.into(),
        shape: Shape::Capsule {
            a_m: vec3(&json[name]["a"]),
            b_m: vec3(&json[name]["b"]),
            radius_m: json[name]["radius"].as_f64().expect("a number"),
        },
        attachment,
    };
    let head = Collider {
        name: "head".into(),
        shape: Shape::Ellipsoid { center_m: Vec3::zeros(), half_axes_m: vec3(&json["head"]) },
        attachment: Attachment::Head,
    };
    Scene {
        rest_pose: poses[0],
        poses: PoseTrack { start_secs: 0.0, rate_hz: 120.0, poses },
        gravity_world: Vec3::new(0.0, 0.0, -9.81),
        air_density: json["air_density"].as_f64().expect("a number"),
        body: Body {
            colliders: vec![head, capsule("neck", Attachment::Head), capsule("shoulders", Attachment::Torso)],
            pivot_m: vec3(&json["pivot"]),
            friction: json["friction"].as_f64().expect("a number"),
        },
    }
}

fn field(json: &Value, bytes: &[u8]) -> FieldSequence {
    let grid = GridSpec::cube(0.6, 0.02).expect("30 voxels of 2 cm");
    let n = grid.n_voxels();
    let values: Vec<f32> =
        bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    let outside = json["outside"].as_array().expect("outside");
    let steps = values
        .chunks_exact(3 * n)
        .zip(outside)
        .map(|(u, outside)| Field {
            u: u.to_vec(),
            flags: vec![VoxelFlag::Measured; n],
            sd: None,
            outside: vec3(outside),
        })
        .collect();
    let quantity = Quantity::from_name(json["quantity"].as_str().expect("a name")).expect("a quantity");
    FieldSequence { grid, quantity, start_secs: 0.0, rate_hz: 30.0, steps, layers: Vec::new() }
}
