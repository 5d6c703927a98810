//! Small worlds with known answers.
#![allow(dead_code, reason = "each test file uses its own part")]

use tousle_core::{
    Attachment, Body, Collider, Groom, NoProgress, Pose, PoseTrack, Quantity, Shape, Strand, StrandMotion,
    Vec3,
};
use tousle_field::{Field, FieldSequence, GridSpec, Scene, VoxelFlag};
use tousle_rod::Surface;
use tousle_sim::{Integrator, Method, SimError, SimOptions, Simulation, simulate};

pub const DOWN: Vec3 = Vec3::new(0.0, 0.0, -9.81);

/// A scene without air, body or head motion, under gravity.
pub fn vacuum(gravity_world: Vec3) -> Scene {
    Scene {
        poses: PoseTrack::still(Pose::identity()),
        rest_pose: Pose::identity(),
        gravity_world,
        air_density: 0.0,
        body: Body::none(),
    }
}

/// A scene in air, with a head, a neck and shoulders.
pub fn mannequin() -> Scene {
    let collider =
        |name: &str, shape: Shape, attachment: Attachment| Collider { name: name.into(), shape, attachment };
    let head = Shape::Ellipsoid { center_m: Vec3::zeros(), half_axes_m: Vec3::new(0.095, 0.075, 0.1) };
    let neck = Shape::Capsule {
        a_m: Vec3::new(-0.015, 0.0, -0.07),
        b_m: Vec3::new(-0.02, 0.0, -0.19),
        radius_m: 0.055,
    };
    let shoulders = Shape::Capsule {
        a_m: Vec3::new(-0.02, -0.15, -0.27),
        b_m: Vec3::new(-0.02, 0.15, -0.27),
        radius_m: 0.07,
    };
    let body = Body {
        colliders: vec![
            collider("head", head, Attachment::Head),
            collider("neck", neck, Attachment::Head),
            collider("shoulders", shoulders, Attachment::Torso),
        ],
        pivot_m: Vec3::new(-0.02, 0.0, -0.11),
        friction: 0.25,
    };
    Scene { air_density: 1.2, body, ..vacuum(DOWN) }
}

/// A field with the same vector everywhere, one a step.
pub fn uniform(quantity: Quantity, rate_hz: f64, vectors: &[Vec3]) -> FieldSequence {
    let grid = GridSpec::cube(0.6, 0.1).expect("a cube of 6 voxels a side");
    let n = grid.n_voxels();
    let step = |vector: &Vec3| {
        let mut field =
            Field { u: vec![0.0; 3 * n], flags: vec![VoxelFlag::Measured; n], sd: None, outside: *vector };
        (0..n).for_each(|voxel| field.set_vector(voxel, *vector));
        field
    };
    FieldSequence {
        grid,
        quantity,
        start_secs: 0.0,
        rate_hz,
        steps: vectors.iter().map(step).collect(),
        layers: Vec::new(),
    }
}

/// Air that stands still.
pub fn still_air() -> FieldSequence {
    uniform(Quantity::AirVelocity, 30.0, &[Vec3::zeros()])
}

/// A straight strand: 1.5 g/m, 4 mm wide, 2e-6 N·m², 0.02 s.
pub fn straight(root_m: Vec3, direction: Vec3, length_m: f64, n_sticks: usize) -> Strand {
    let point = |k: usize| root_m + direction.normalize() * (length_m * k as f64 / n_sticks as f64);
    strand((0..=n_sticks).map(point).collect())
}

/// The same hair along any curve.
pub fn strand(rest_curve_m: Vec<Vec3>) -> Strand {
    let length_m = rest_curve_m.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
    Strand {
        name: "strand".into(),
        rest_curve_m,
        length_m,
        linear_density_kg_per_m: 1.5e-3,
        lock_width_m: 4e-3,
        bending_stiffness_n_m2: 2e-6,
        internal_damping_secs: 0.02,
        along: tousle_core::Along::default(),
        holds_style: false,
    }
}

/// A lock that lies over the crown, down the side of the head and hangs beside the neck.
pub fn over_the_head() -> Strand {
    let half_axes = Vec3::new(0.095, 0.075, 0.1) + Vec3::repeat(2e-3);
    let on_head = |k: usize| {
        let (sin, cos) = libm::sincos(1.6 * k as f64 / 8.0);
        Vec3::new(0.0, sin * half_axes.y, cos * half_axes.z)
    };
    let mut points: Vec<Vec3> = (0..=8).map(on_head).collect();
    let last = points[8];
    points.extend((1..=6).map(|k| last - Vec3::z() * (0.018 * f64::from(k))));
    strand(points)
}

pub fn groom(strands: Vec<Strand>) -> Groom {
    Groom { strands, assumed: Vec::new() }
}

pub fn run(
    field: &FieldSequence,
    scene: &Scene,
    strands: Vec<Strand>,
    options: &SimOptions,
) -> Result<Simulation, SimError> {
    simulate(field, scene, &groom(strands), options, &NoProgress)
}

pub fn options(integrator: Integrator, dt_secs: f64, duration_secs: f64) -> SimOptions {
    SimOptions {
        method: Method::Paper,
        integrator: Some(integrator),
        dt_secs: Some(dt_secs),
        duration_secs: Some(duration_secs),
        ..SimOptions::default()
    }
}

/// The same with method `physical`.
pub fn physical(integrator: Integrator, dt_secs: f64, duration_secs: f64) -> SimOptions {
    SimOptions { method: Method::Physical, ..options(integrator, dt_secs, duration_secs) }
}

/// One control point over all frames.
pub fn track(motion: &StrandMotion, point: usize) -> Vec<Vec3> {
    (0..motion.times_secs.len()).map(|frame| Vec3::from(motion.frame(frame)[point].map(f64::from))).collect()
}

/// The farthest that any point gets from where it was in the first frame, m.
pub fn farthest(motion: &StrandMotion) -> f64 {
    (0..motion.n_points())
        .flat_map(|k| {
            let track = track(motion, k);
            let first = track[0];
            track.into_iter().map(move |p| (p - first).norm())
        })
        .fold(0.0, f64::max)
}

/// Panics unless every position is finite and no stick has changed its length by a thousandth.
pub fn assert_sound(simulation: &Simulation, what: &str) {
    let finite = simulation.motion.positions_m.iter().flatten().all(|c| c.is_finite());
    assert!(finite, "{what}: not finite");
    assert!(simulation.report.max_stretch < 1e-3, "{what}: stretch {}", simulation.report.max_stretch);
}

/// The least distance of any point but the roots from the body's surfaces as they are in each frame, m.
pub fn nearest(scene: &Scene, motion: &StrandMotion) -> f64 {
    let mut nearest = f64::INFINITY;
    for (frame, t) in motion.times_secs.iter().enumerate() {
        let pose = scene.poses.motion_at(*t).world_from_head;
        let surfaces = Surface::of_body(&scene.body, &scene.body.head_from_torso(&pose, &scene.rest_pose));
        for strand in 0..motion.counts.len() {
            for point in &motion.strand(frame, strand)[1..] {
                let distances = surfaces.iter().map(|s| s.gap(Vec3::from(point.map(f64::from))).distance_m);
                nearest = distances.fold(nearest, f64::min);
            }
        }
    }
    nearest
}
