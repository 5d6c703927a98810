//! A small world for unit tests.

use crate::document::{Document, Source};
use tousle_core::{Along, Body, Groom, Pose, PoseTrack, Quantity, Strand, Vec3};
use tousle_field::{Ease, Field, FieldLayer, FieldSequence, GridSpec, Handle, LayerOrigin, Scene};

/// A second of still air, 60 cm wide, at 30 Hz.
pub fn field() -> FieldSequence {
    let grid = GridSpec::cube(0.6, 0.1).unwrap();
    FieldSequence {
        grid,
        quantity: Quantity::AirVelocity,
        start_secs: 0.0,
        rate_hz: 30.0,
        steps: vec![Field::still(&grid); 31],
        layers: Vec::new(),
    }
}

/// A head that keeps still, without a body.
pub fn scene() -> Scene {
    Scene {
        poses: PoseTrack::still(Pose::identity()),
        rest_pose: Pose::identity(),
        gravity_world: -9.81 * Vec3::z(),
        air_density: 1.2,
        body: Body::none(),
    }
}

/// Two strands of 10 cm that hang 4 cm apart: A at y = 0 and B at y = 0.04.
pub fn groom() -> Groom {
    let strand = |name: &str, y: f64| Strand {
        name: name.into(),
        rest_curve_m: (0..5).map(|k| Vec3::new(0.1, y, -0.025 * f64::from(k))).collect(),
        length_m: 0.1,
        linear_density_kg_per_m: 0.002,
        lock_width_m: 0.005,
        bending_stiffness_n_m2: 1e-6,
        internal_damping_secs: 0.02,
        along: Along::default(),
        holds_style: false,
    };
    Groom { strands: vec![strand("A", 0.0), strand("B", 0.04)], assumed: Vec::new() }
}

/// All of these.
pub fn document() -> Document {
    Document::new(field(), scene(), groom(), Source::default())
}

/// A drag of strand A's tip with one handle.
pub fn layer(id: &str) -> FieldLayer {
    FieldLayer {
        id: id.into(),
        name: id.into(),
        muted: false,
        first_secs: 0.2,
        last_secs: 0.8,
        ease: Ease { rise: 0.5, fall: 0.25 },
        handles: vec![Handle { center_m: Vec3::new(0.1, 0.0, -0.1), reach_m: 0.06, extra: Vec3::x() }],
        reshape: None,
        origin: LayerOrigin::Drag {
            strand: "A".into(),
            control_point: 4,
            target_m: Vec3::new(0.13, 0.0, -0.09),
            method: "paper".into(),
        },
    }
}
