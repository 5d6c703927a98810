//! Field files of every kind, for tests.

use proptest::prelude::*;
use tousle_core::{
    Attachment as Carrier, Body, Collider, NoProgress, Pose, PoseTrack, Quantity, Shape, Vec3, WindSample,
    WindSamples,
};
use tousle_eff::{Attachment, Eff, Encoding, WriteOptions, write};
use tousle_field::{Ease, Field, FieldLayer, FieldSequence, GridSpec, Handle, LayerOrigin, Scene, VoxelFlag};

/// A small file with something of everything: 4 x 3 x 2 voxels, 5 steps, 17 poses, samples, an edit.
pub fn small() -> Eff {
    let grid = GridSpec { origin_m: Vec3::new(-0.2, -0.15, -0.1), edge_m: 0.1, dims: [4, 3, 2] };
    let steps = (0..5).map(|k| step(&grid, f64::from(k))).collect();
    Eff {
        name: "small".into(),
        method: "physical".into(),
        generator: "test 1".into(),
        field: FieldSequence {
            grid,
            quantity: Quantity::AirVelocity,
            start_secs: 0.0,
            rate_hz: 30.0,
            steps,
            layers: vec![layer("1")],
        },
        scene: scene(),
        samples: Some(samples(&grid, 5)),
        attachments: vec![Attachment {
            name: "session.json".into(),
            media_type: "application/json".into(),
            bytes: b"{\"name\":\"small\"}".to_vec(),
        }],
    }
}

/// Wind along x that turns with the place and grows with time; the first voxels are measured.
pub fn step(grid: &GridSpec, k: f64) -> Field {
    let n = grid.n_voxels();
    let mut field = Field::still(grid);
    for flat in 0..n {
        let p = grid.cell_center_m(grid.unflat(flat));
        field.set_vector(flat, Vec3::new(2.0 + 0.1 * k + p.x, p.y - 0.3 * p.z, 0.25 * k * p.z));
        field.flags[flat] = match flat % 7 {
            0 => VoxelFlag::Measured,
            1..4 => VoxelFlag::Interpolated,
            _ => VoxelFlag::Outside,
        };
    }
    field.sd =
        Some((0..n).map(|flat| if flat % 5 == 4 { f32::INFINITY } else { 0.1 * flat as f32 }).collect());
    field.outside = Vec3::new(2.0 + 0.1 * k, 0.1, 0.0);
    field
}

pub fn scene() -> Scene {
    let pose = |k: u32| {
        let turn = nalgebra::UnitQuaternion::from_euler_angles(0.01 * f64::from(k), 0.2, -0.1);
        Pose::from_parts(Vec3::new(0.1, 1.0, 1.5 + 0.001 * f64::from(k)).into(), turn)
    };
    Scene {
        poses: PoseTrack { start_secs: 0.0, rate_hz: 120.0, poses: (0..17).map(pose).collect() },
        rest_pose: pose(0),
        gravity_world: Vec3::new(0.0, 0.0, -9.81),
        air_density: 1.2,
        body: Body {
            colliders: vec![
                Collider {
                    name: "head".into(),
                    shape: Shape::Ellipsoid {
                        center_m: Vec3::zeros(),
                        half_axes_m: Vec3::new(0.095, 0.075, 0.1),
                    },
                    attachment: Carrier::Head,
                },
                Collider {
                    name: "shoulders".into(),
                    shape: Shape::Capsule {
                        a_m: Vec3::new(-0.02, -0.15, -0.27),
                        b_m: Vec3::new(-0.02, 0.15, -0.27),
                        radius_m: 0.07,
                    },
                    attachment: Carrier::Torso,
                },
            ],
            pivot_m: Vec3::new(-0.02, 0.0, -0.11),
            friction: 0.3,
        },
    }
}

pub fn layer(id: &str) -> FieldLayer {
    FieldLayer {
        id: id.into(),
        name: "lift".into(),
        muted: false,
        first_secs: 0.02,
        last_secs: 0.12,
        ease: Ease { rise: 0.7, fall: 0.3 },
        handles: vec![Handle { center_m: Vec3::new(0.1, 0.0, 0.05), reach_m: 0.1, extra: Vec3::z() }],
        reshape: None,
        origin: LayerOrigin::Drag {
            strand: "S01".into(),
            control_point: 3,
            target_m: Vec3::new(0.1, 0.05, 0.0),
            method: "paper".into(),
        },
    }
}

/// Samples in the centers of measured voxels, in numbers that a float holds.
pub fn samples(grid: &GridSpec, n_steps: usize) -> WindSamples {
    let sample = |marker_idx: u32| {
        let center = grid.cell_center_m(grid.unflat(7 * marker_idx as usize));
        let unknown = f64::INFINITY;
        let covariance = match marker_idx {
            0 => [unknown, unknown, unknown, 0.0, 0.0, 0.0],
            _ => [0.25, 0.5, 1.0, 0.125, 0.0, -0.25],
        };
        WindSample {
            strand_idx: 2,
            marker_idx,
            position_m: center.map(|c| f64::from(c as f32)),
            value: Vec3::new(2.0, -0.5, 0.25),
            covariance,
        }
    };
    let steps = (0..n_steps).map(|k| (0..k.min(3) as u32).map(sample).collect()).collect();
    WindSamples { quantity: Quantity::ForcePerMass, rate_hz: 30.0, steps }
}

/// The bytes of a field file.
pub fn written(eff: &Eff, options: &WriteOptions) -> Vec<u8> {
    let mut bytes = Vec::new();
    let report = write(eff, &mut bytes, options, &NoProgress).unwrap();
    assert_eq!(report.n_bytes, bytes.len() as u64);
    bytes
}

/// The bytes of [`small`], written as files are unless told otherwise.
pub fn small_file() -> Vec<u8> {
    written(&small(), &WriteOptions::default())
}

/// The bytes of [`tiny`].
pub fn tiny_file(encoding: Encoding) -> Vec<u8> {
    written(&tiny(), &WriteOptions::with_encoding(encoding))
}

/// Any field file that can be written.
pub fn any_eff() -> impl Strategy<Value = Eff> {
    let grid = (prop::array::uniform3(1..5usize), 0.001..1.0, prop::array::uniform3(-1.0..1.0)).prop_map(
        |(dims, edge_m, origin): ([usize; 3], f64, [f64; 3])| GridSpec {
            origin_m: origin.into(),
            edge_m,
            dims,
        },
    );
    let times = (0.0..1e3, 0.1..1e3, 1..4usize, any::<bool>());
    let scene = (0..3usize, 1..5usize, 0.0..100.0, 0.5..500.0);
    (grid, times, scene, 0..3usize, any::<bool>()).prop_flat_map(
        |(grid, (start_secs, rate_hz, n_steps, has_sd), scene, n_layers, has_samples)| {
            let fields = prop::collection::vec(any_field(grid, has_sd), n_steps);
            let poses = prop::collection::vec(any_pose(), scene.1);
            (fields, poses, any_quantity(), ".{0,9}").prop_map(move |(steps, poses, quantity, name)| Eff {
                name,
                method: "paper".into(),
                generator: "test".into(),
                field: FieldSequence {
                    grid,
                    quantity,
                    start_secs,
                    rate_hz,
                    steps,
                    layers: (0..n_layers).map(|id| layer(&id.to_string())).collect(),
                },
                scene: Scene {
                    rest_pose: poses[0],
                    poses: PoseTrack { start_secs: scene.2, rate_hz: scene.3, poses },
                    body: Body {
                        colliders: self::scene().body.colliders.split_off(2 - scene.0),
                        ..self::scene().body
                    },
                    ..self::scene()
                },
                samples: has_samples.then(|| {
                    let mut samples = samples(&GridSpec::cube(0.6, 0.2).unwrap(), n_steps);
                    samples.rate_hz = rate_hz;
                    samples
                }),
                attachments: Vec::new(),
            })
        },
    )
}

fn any_quantity() -> impl Strategy<Value = Quantity> {
    prop::sample::select(vec![Quantity::AirVelocity, Quantity::ForcePerMass])
}

fn any_field(grid: GridSpec, has_sd: bool) -> impl Strategy<Value = Field> {
    let n = grid.n_voxels();
    let float = prop::num::f32::NORMAL | prop::num::f32::ZERO | prop::num::f32::SUBNORMAL;
    let flag = prop::sample::select(vec![VoxelFlag::Outside, VoxelFlag::Interpolated, VoxelFlag::Measured]);
    let u = prop::collection::vec(float, 3 * n);
    let flags = prop::collection::vec(flag, n);
    let sd = prop::collection::vec(0.0f32..1e9, n);
    (u, flags, sd, prop::array::uniform3(-1e9..1e9)).prop_map(move |(u, flags, sd, outside)| Field {
        u,
        flags,
        sd: has_sd.then_some(sd),
        outside: outside.into(),
    })
}

fn any_pose() -> impl Strategy<Value = Pose> {
    (prop::array::uniform3(-10.0..10.0), prop::array::uniform3(-3.0..3.0)).prop_map(
        |(place, turn): ([f64; 3], [f64; 3])| {
            let rotation = nalgebra::UnitQuaternion::from_scaled_axis(Vec3::from(turn));
            Pose::from_parts(Vec3::from(place).into(), rotation)
        },
    )
}

/// As little as a file with everything in it can be: 2 x 2 x 1 voxels, 2 steps, 3 poses.
pub fn tiny() -> Eff {
    let mut eff = small();
    let grid = GridSpec { origin_m: Vec3::new(-0.1, -0.1, -0.05), edge_m: 0.1, dims: [2, 2, 1] };
    eff.name = "tiny".into();
    eff.field.grid = grid;
    eff.field.steps = (0..2).map(|k| step(&grid, f64::from(k))).collect();
    eff.scene.poses.poses.truncate(3);
    // Two samples at the second step, both in the first voxel, which is flagged as measured.
    let mut samples = samples(&grid, 2);
    let mut first = samples.steps[1][0];
    first.marker_idx = 1;
    first.covariance = [0.25, 0.5, 1.0, 0.125, 0.0, -0.25];
    samples.steps[1].push(first);
    eff.samples = Some(samples);
    eff
}
