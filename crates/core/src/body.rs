use crate::{Pose, Solid, Vec3};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What hair can touch, and the pivot about which the head turns on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// The shapes, each with what carries it.
    pub colliders: Vec<Collider>,
    /// The point about which the head turns, head space, m. Colliders of the torso keep their place about it.
    pub pivot_m: Vec3,
    /// Coulomb friction between hair and body.
    pub friction: f64,
}

/// One shape of a [`Body`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Collider {
    /// What it stands for: `head`, `neck`, `shoulders`.
    pub name: String,
    /// The shape, head space at rest, m.
    pub shape: Shape,
    /// What carries it.
    pub attachment: Attachment,
}

/// A shape, meters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// An ellipsoid with its axes along the space's axes.
    Ellipsoid {
        /// Center.
        center_m: Vec3,
        /// Half the length of each axis, all > 0.
        half_axes_m: Vec3,
    },
    /// All points within a radius of a line segment.
    Capsule {
        /// One end of the segment.
        a_m: Vec3,
        /// The other end.
        b_m: Vec3,
        /// The radius, > 0.
        radius_m: f64,
    },
    /// What a triangle mesh encloses. A shot's own body: no field file holds one.
    #[serde(skip)]
    Mesh(Arc<Solid>),
}

/// What carries a collider.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Attachment {
    /// It moves with the head: at rest in head space.
    Head,
    /// It stays with the torso: as the head turns about the pivot, it keeps its rest orientation in the world.
    Torso,
}

impl Body {
    /// A body of nothing: hair in free air.
    pub fn none() -> Self {
        Self { colliders: Vec::new(), pivot_m: Vec3::zeros(), friction: 0.0 }
    }

    /// Where the torso is as the head sees it: `head_from_torso`, from the head's pose and its pose at rest.
    ///
    /// Torso space is head space at rest. The torso keeps its rest orientation in the world and shares the
    /// pivot with the head, so a head that only travels carries it along, and one that turns does not.
    pub fn head_from_torso(&self, world_from_head: &Pose, world_from_head_at_rest: &Pose) -> Pose {
        let turn = world_from_head.rotation.inverse() * world_from_head_at_rest.rotation;
        Pose::from_parts((self.pivot_m - turn * self.pivot_m).into(), turn)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    #[test]
    fn the_torso_shares_the_pivot_and_does_not_turn() {
        let body = Body { pivot_m: Vec3::new(-0.02, 0.0, -0.11), ..Body::none() };
        let rest = Pose::from_parts(
            Vec3::new(1.0, 2.0, 1.5).into(),
            UnitQuaternion::from_euler_angles(0.1, 0.0, 0.4),
        );
        let turned = Pose::from_parts(
            Vec3::new(1.0, 2.0, 1.5).into(),
            UnitQuaternion::from_euler_angles(0.1, 0.3, 1.2),
        );
        let head_from_torso = body.head_from_torso(&turned, &rest);
        let pivot = head_from_torso * nalgebra::Point3::from(body.pivot_m);
        assert!((pivot.coords - body.pivot_m).norm() < 1e-15);
        let world_from_torso = turned * head_from_torso;
        assert!(world_from_torso.rotation.angle_to(&rest.rotation) < 1e-12);
    }
}
