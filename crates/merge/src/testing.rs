//! What the tests of several files need.

use crate::Input;
use tousle_core::{Body, Pose, PoseTrack, Quantity, Vec3};
use tousle_field::{GridSpec, Scene};

/// A head that stands still, and nothing that hair can touch.
pub(crate) fn scene() -> Scene {
    Scene {
        poses: PoseTrack::still(Pose::identity()),
        rest_pose: Pose::identity(),
        gravity_world: Vec3::z() * -9.81,
        air_density: 1.2,
        body: Body { colliders: Vec::new(), pivot_m: Vec3::zeros(), friction: 0.3 },
    }
}

/// A field of one voxel and three steps, 0 to 0.2 s.
pub(crate) fn input<'a>(name: &'a str, scene: &'a Scene) -> Input<'a> {
    Input {
        name,
        quantity: Quantity::AirVelocity,
        grid: GridSpec { origin_m: Vec3::zeros(), edge_m: 0.1, dims: [1, 1, 1] },
        start_secs: 0.0,
        rate_hz: 10.0,
        n_steps: 3,
        layers: &[],
        scene,
        offset_secs: 0.0,
    }
}
