//! Small made-up worlds: scenes, winds and hair for measurements and for tests whose answer is known.

use tousle_core::{
    Attachment, Body, Collider, Groom, Pose, PoseTrack, Quantity, Shape, Strand, StrandMotion, Vec3,
};
use tousle_field::{Ease, Field, FieldLayer, FieldSequence, GridSpec, Handle, LayerOrigin, Scene, VoxelFlag};
use tousle_rod::Surface;

/// Gravity in a world whose z is up, m/s².
pub const DOWN: Vec3 = Vec3::new(0.0, 0.0, -9.81);

/// Half the head's length, width and height, m.
pub const HEAD_HALF_AXES_M: Vec3 = Vec3::new(0.095, 0.075, 0.1);

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
    let head = Shape::Ellipsoid { center_m: Vec3::zeros(), half_axes_m: HEAD_HALF_AXES_M };
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

/// A layer of one handle, which grows up to the middle of its time and fades from there.
pub fn push(handle: Handle, (first_secs, last_secs): (f64, f64)) -> FieldLayer {
    FieldLayer {
        id: "1".into(),
        name: "1".into(),
        muted: false,
        first_secs,
        last_secs,
        ease: Ease { rise: 0.5, fall: 0.5 },
        handles: vec![handle],
        reshape: None,
        origin: LayerOrigin::Wind { action: "gust".into() },
    }
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
    let half_axes = HEAD_HALF_AXES_M + Vec3::repeat(2e-3);
    let on_head = |k: usize| {
        let (sin, cos) = libm::sincos(1.6 * k as f64 / 8.0);
        Vec3::new(0.0, sin * half_axes.y, cos * half_axes.z)
    };
    let mut points: Vec<Vec3> = (0..=8).map(on_head).collect();
    let last = points[8];
    points.extend((1..=6).map(|k| last - Vec3::z() * (0.018 * f64::from(k))));
    strand(points)
}

/// A lock over the head, one that leans out beside it, and one of a single stick.
pub fn lock_fan() -> Vec<Strand> {
    vec![
        over_the_head(),
        straight(Vec3::new(0.05, 0.08, 0.03), Vec3::new(0.3, 0.3, -1.0), 0.25, 12),
        straight(Vec3::new(-0.098, 0.0, 0.0), Vec3::new(-1.0, 0.0, -0.2), 0.12, 1),
    ]
}

/// A hairstyle of these strands.
pub fn groom(strands: Vec<Strand>) -> Groom {
    Groom { strands, assumed: Vec::new() }
}

/// A wind from the front with gusts that travel through it: 30³ voxels of 2 cm, 2 s at 30 Hz, 0 within the head.
///
/// Made of waves, so that every voxel differs from its neighbors and every step from the next, as in a capture.
pub fn gusts() -> FieldSequence {
    const N_STEPS: u32 = 61;
    let grid = GridSpec::cube(0.6, 0.02).expect("a cube of 30 voxels a side");
    let in_head = |p: &Vec3| p.component_div(&HEAD_HALF_AXES_M).norm_squared() < 1.0;
    let step = |k: u32| {
        let secs = f64::from(k) / 30.0;
        let wave =
            |p: &Vec3, hz: f64, way: Vec3| libm::sin(core::f64::consts::TAU * (hz * secs - p.dot(&way)));
        let mut field = Field::still(&grid);
        field.outside = Vec3::new(-3.0, 0.0, 0.0);
        for voxel in 0..grid.n_voxels() {
            let p = grid.cell_center_m(grid.unflat(voxel));
            if !in_head(&p) {
                let u = -3.0 + 1.5 * wave(&p, 0.7, Vec3::new(-2.0, 1.0, 0.0));
                let v = 1.2 * wave(&p, 1.3, Vec3::new(-3.0, 0.0, 2.0));
                let w = 0.6 * wave(&p, 2.1, Vec3::new(-4.0, 2.0, 1.0));
                field.set_vector(voxel, Vec3::new(u, v, w));
            }
        }
        field
    };
    FieldSequence {
        grid,
        quantity: Quantity::AirVelocity,
        start_secs: 0.0,
        rate_hz: 30.0,
        steps: (0..N_STEPS).map(step).collect(),
        layers: Vec::new(),
    }
}

/// Hair all over the head of [`mannequin`]: every strand lies along the head down to its widest place and hangs from
/// there, 22 cm long, those that grow higher farther out.
///
/// # Panics
/// If a strand has fewer than 2 points.
pub fn wig(n_strands: usize, n_points: usize) -> Groom {
    const LENGTH_M: f64 = 0.22;
    assert!(n_points >= 2, "a strand of {n_points} points");
    let lock = |k: usize| {
        let share = (k as f64 + 0.5) / n_strands as f64;
        // Evenly over a cap that ends a little above the widest place, turning by the golden angle.
        let from_crown = libm::acos(1.0 - 0.75 * share);
        let (sin_azimuth, cos_azimuth) = libm::sincos(2.399_963_229_728_653 * k as f64);
        let gap_m = 2e-3 + 8e-3 * (1.0 - share);
        let axes = HEAD_HALF_AXES_M + Vec3::repeat(gap_m);
        let on_head = |angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            Vec3::new(axes.x * sin * cos_azimuth, axes.y * sin * sin_azimuth, axes.z * cos)
        };
        let mut points = vec![on_head(from_crown)];
        let mut angle = from_crown;
        let stick_m = LENGTH_M / (n_points - 1) as f64;
        while points.len() < n_points {
            let last = points[points.len() - 1];
            // So far round as a stick reaches, if that is still on the upper half.
            let turn = stick_m / (on_head(angle + 1e-3) - on_head(angle)).norm() * 1e-3;
            angle += turn;
            let on = on_head(angle);
            points.push(if angle < 1.5 { on } else { last - Vec3::z() * stick_m });
        }
        Strand { name: format!("strand {k}"), ..strand(points) }
    };
    groom((0..n_strands).map(lock).collect())
}

/// The least distance of any point but the roots from the body's surfaces as they are in each frame, m; below 0 within.
pub fn nearest_m(scene: &Scene, motion: &StrandMotion) -> f64 {
    let mut nearest_m = f64::INFINITY;
    for (frame, secs) in motion.times_secs.iter().enumerate() {
        let pose = scene.poses.motion_at(*secs).world_from_head;
        let surfaces = Surface::of_body(&scene.body, &scene.body.head_from_torso(&pose, &scene.rest_pose));
        for strand in 0..motion.counts.len() {
            for point in &motion.strand(frame, strand)[1..] {
                let distances = surfaces.iter().map(|s| s.gap(Vec3::from(point.map(f64::from))).distance_m);
                nearest_m = distances.fold(nearest_m, f64::min);
            }
        }
    }
    nearest_m
}
