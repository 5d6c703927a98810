//! The scene: gravity, air, body, the head's pose at rest.

use crate::EffError;
use nalgebra::{Quaternion, UnitQuaternion};
use serde::{Deserialize, Serialize};
use tousle_core::{Pose, PoseTrack};

/// All that a simulator needs besides wind and poses.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Scene {
    /// Gravity, world axes, m/s².
    pub gravity_world: [f64; 3],
    /// Density of the air, kg/m³.
    #[cfg_attr(test, schemars(range(min = 0.0)))]
    pub air_density: f64,
    /// The head's pose in the still interval: head space to world space.
    pub rest_pose: RestPose,
    /// What hair can touch.
    pub body: Body,
}

/// A rigid transform.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct RestPose {
    /// Where the head's center is, world space, m.
    pub translation_m: [f64; 3],
    /// How the head is turned, a unit quaternion: x, y, z, w.
    pub rotation_xyzw: [f64; 4],
}

/// What hair can touch, and the pivot about which the head turns on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Body {
    /// The shapes.
    pub colliders: Vec<Collider>,
    /// The point about which the head turns, head space, m.
    pub pivot_m: [f64; 3],
    /// Coulomb friction between hair and body.
    #[cfg_attr(test, schemars(range(min = 0.0)))]
    pub friction: f64,
}

/// One shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Collider {
    /// What it stands for.
    pub name: String,
    /// The shape, head space at rest, m.
    pub shape: Shape,
    /// What carries it.
    pub attachment: Attachment,
}

/// A convex shape.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub enum Shape {
    /// An ellipsoid with its axes along the head's.
    #[serde(rename_all = "snake_case")]
    Ellipsoid {
        /// Center, m.
        center_m: [f64; 3],
        /// Half the length of each axis, m.
        #[cfg_attr(test, schemars(inner(range(min = 0.0))))]
        half_axes_m: [f64; 3],
    },
    /// All points within a radius of a line segment.
    Capsule {
        /// One end of the segment, m.
        a_m: [f64; 3],
        /// The other end, m.
        b_m: [f64; 3],
        /// The radius, m.
        #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0.0)))]
        radius_m: f64,
    },
}

impl Shape {
    /// All its numbers.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> + use<> {
        let (a, b, c) = match *self {
            Self::Ellipsoid { center_m, half_axes_m } => (center_m, half_axes_m, None),
            Self::Capsule { a_m, b_m, radius_m } => (a_m, b_m, Some(radius_m)),
        };
        a.into_iter().chain(b).chain(c)
    }
}

/// What carries a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub enum Attachment {
    /// The head: the shape is at rest in head space.
    Head,
    /// The torso: it shares the pivot with the head and keeps its orientation in the world.
    Torso,
}

impl Scene {
    /// The scene in the vocabulary's words, with its poses.
    pub(crate) fn with_poses(self, poses: PoseTrack) -> tousle_field::Scene {
        tousle_field::Scene {
            poses,
            rest_pose: pose(self.rest_pose.translation_m, self.rest_pose.rotation_xyzw),
            gravity_world: self.gravity_world.into(),
            air_density: self.air_density,
            body: self.body.into(),
        }
    }
}

impl TryFrom<&tousle_field::Scene> for Scene {
    type Error = EffError;

    fn try_from(scene: &tousle_field::Scene) -> Result<Self, EffError> {
        Ok(Self {
            // What is nothing is 0 in the file, never -0.
            gravity_world: scene.gravity_world.map(|component| component + 0.0).into(),
            air_density: scene.air_density,
            rest_pose: RestPose {
                translation_m: scene.rest_pose.translation.vector.into(),
                rotation_xyzw: scene.rest_pose.rotation.coords.into(),
            },
            body: (&scene.body).try_into()?,
        })
    }
}

/// A pose of numbers that were checked; it keeps every bit, so nothing is normalized again.
pub(crate) fn pose(translation: [f64; 3], [x, y, z, w]: [f64; 4]) -> Pose {
    let rotation = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
    Pose::from_parts(tousle_core::Vec3::from(translation).into(), rotation)
}

impl TryFrom<&tousle_core::Body> for Body {
    type Error = EffError;

    fn try_from(body: &tousle_core::Body) -> Result<Self, EffError> {
        Ok(Self {
            colliders: body.colliders.iter().map(Collider::try_from).collect::<Result<_, _>>()?,
            pivot_m: body.pivot_m.into(),
            friction: body.friction,
        })
    }
}

impl From<Body> for tousle_core::Body {
    fn from(body: Body) -> Self {
        let collider = |c: Collider| tousle_core::Collider {
            name: c.name,
            shape: c.shape.into(),
            attachment: match c.attachment {
                Attachment::Head => tousle_core::Attachment::Head,
                Attachment::Torso => tousle_core::Attachment::Torso,
            },
        };
        Self {
            colliders: body.colliders.into_iter().map(collider).collect(),
            pivot_m: body.pivot_m.into(),
            friction: body.friction,
        }
    }
}

impl TryFrom<&tousle_core::Collider> for Collider {
    type Error = EffError;

    fn try_from(collider: &tousle_core::Collider) -> Result<Self, EffError> {
        let shape = match &collider.shape {
            tousle_core::Shape::Ellipsoid { center_m, half_axes_m } => {
                Shape::Ellipsoid { center_m: (*center_m).into(), half_axes_m: (*half_axes_m).into() }
            }
            tousle_core::Shape::Capsule { a_m, b_m, radius_m } => {
                Shape::Capsule { a_m: (*a_m).into(), b_m: (*b_m).into(), radius_m: *radius_m }
            }
            tousle_core::Shape::Mesh(_) => {
                let what = format!("collider {:?}", collider.name);
                return Err(EffError::bad(what, "a mesh", "an ellipsoid or a capsule"));
            }
        };
        let attachment = match collider.attachment {
            tousle_core::Attachment::Head => Attachment::Head,
            tousle_core::Attachment::Torso => Attachment::Torso,
        };
        Ok(Self { name: collider.name.clone(), shape, attachment })
    }
}

impl From<Shape> for tousle_core::Shape {
    fn from(shape: Shape) -> Self {
        match shape {
            Shape::Ellipsoid { center_m, half_axes_m } => {
                Self::Ellipsoid { center_m: center_m.into(), half_axes_m: half_axes_m.into() }
            }
            Shape::Capsule { a_m, b_m, radius_m } => {
                Self::Capsule { a_m: a_m.into(), b_m: b_m.into(), radius_m }
            }
        }
    }
}
