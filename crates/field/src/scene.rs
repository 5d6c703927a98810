use tousle_core::{Body, PoseTrack, Vec3};

/// All that a simulator must know besides the wind: how the head moves, what hair can touch, what pulls it down.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The head's pose over time.
    pub poses: PoseTrack,
    /// The head's pose in the still interval, from which the torso's place follows.
    pub rest_pose: tousle_core::Pose,
    /// Gravity, world axes, m/s².
    pub gravity_world: Vec3,
    /// Density of the air, kg/m³.
    pub air_density: f64,
    /// What hair can touch.
    pub body: Body,
}
