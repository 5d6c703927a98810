//! Version 0: a cube of plain floats, read as what version 1 would have made of it.
//!
//! It knew neither samples nor edits nor standard deviations, packed nothing, and began at 0 s.

use super::manifest::{EncodingInfo, FieldInfo, Grid, Manifest, PoseInfo, QuantityName};
use super::proto;
use super::scene::{Body, RestPose, Scene};
use super::tags::Fields;
use crate::array::{self, Encoding};
use serde::{Deserialize, Serialize};

/// The manifest of version 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[cfg_attr(test, schemars(title = "tousle.eff.v0.Manifest"))]
pub(crate) struct ManifestV0 {
    /// Always `tousle.eff`.
    #[cfg_attr(test, schemars(extend("const" = "tousle.eff")))]
    pub format: String,
    /// The format's version.
    #[cfg_attr(test, schemars(extend("const" = 0)))]
    pub version: u32,
    /// What the field is called, for people.
    pub name: String,
    /// The method that made the field.
    pub method: String,
    /// The program that made the field, with its version.
    pub generator: String,
    /// What the vectors are.
    pub quantity: QuantityName,
    /// The edge of the cube around the head's center, m.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0.0)))]
    pub extent_m: f64,
    /// Voxels along an edge of the cube.
    #[cfg_attr(test, schemars(range(min = 1, max = 256)))]
    pub n_voxels: u64,
    /// Steps a second.
    #[cfg_attr(test, schemars(range(max = 1e6), extend("exclusiveMinimum" = 0.0)))]
    pub rate_hz: f64,
    /// How many steps there are.
    #[cfg_attr(test, schemars(range(min = 1)))]
    pub n_steps: u64,
    /// Poses a second.
    #[cfg_attr(test, schemars(range(max = 1e6), extend("exclusiveMinimum" = 0.0)))]
    pub pose_rate_hz: f64,
    /// How many poses there are.
    #[cfg_attr(test, schemars(range(min = 1)))]
    pub n_poses: u64,
    /// Gravity, world axes, m/s².
    pub gravity_world: [f64; 3],
    /// Density of the air, kg/m³.
    #[cfg_attr(test, schemars(range(min = 0.0)))]
    pub air_density: f64,
    /// The head's pose in the still interval: x, y, z, m, then a unit quaternion: x, y, z, w.
    pub rest_pose: [f64; 7],
    /// What hair can touch.
    pub body: Body,
}

impl From<ManifestV0> for Manifest {
    fn from(old: ManifestV0) -> Self {
        let [x, y, z, qx, qy, qz, qw] = old.rest_pose;
        Self {
            format: old.format,
            version: old.version,
            requires: Vec::new(),
            name: old.name,
            method: old.method,
            generator: old.generator,
            field: FieldInfo {
                quantity: old.quantity,
                grid: Grid {
                    origin_m: [-old.extent_m / 2.0; 3],
                    edge_m: old.extent_m / old.n_voxels as f64,
                    dims: [old.n_voxels; 3],
                },
                start_secs: 0.0,
                rate_hz: old.rate_hz,
                n_steps: Some(old.n_steps),
                encoding: EncodingInfo::from(Encoding::F32),
            },
            pose: PoseInfo { start_secs: 0.0, rate_hz: old.pose_rate_hz, n_poses: old.n_poses },
            scene: Scene {
                gravity_world: old.gravity_world,
                air_density: old.air_density,
                rest_pose: RestPose { translation_m: [x, y, z], rotation_xyzw: [qx, qy, qz, qw] },
                body: old.body,
            },
            samples: None,
            extensions: serde_json::Map::new(),
        }
    }
}

/// One time step of version 0.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct FieldStepV0 {
    #[prost(uint64, tag = "1")]
    pub index: u64,
    #[prost(uint64, tag = "2")]
    pub time_ns: u64,
    #[prost(float, repeated, tag = "3")]
    pub u: Vec<f32>,
    #[prost(bytes = "vec", tag = "4")]
    pub flags: Vec<u8>,
    #[prost(double, repeated, tag = "5")]
    pub outside: Vec<f64>,
}

pub(crate) static FIELD_STEP: Fields = Fields::plain(&[
    (1, "index", false),
    (2, "time_ns", false),
    (3, "u", true),
    (4, "flags", false),
    (5, "outside", true),
]);

impl FieldStepV0 {
    /// What version 1 would have written; `None` if the wind outside is no vector.
    pub fn into_v1(self) -> Option<proto::FieldStep> {
        let [x, y, z] = self.outside.try_into().ok()?;
        Some(proto::FieldStep {
            index: self.index,
            time_ns: self.time_ns,
            u: Some(array::pack_f32(&self.u)),
            flags: self.flags.into(),
            sd: None,
            outside: Some(proto::Vector3 { x, y, z }),
        })
    }
}

/// The head's pose at one time of version 0.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct PoseStepV0 {
    #[prost(uint64, tag = "1")]
    pub index: u64,
    #[prost(uint64, tag = "2")]
    pub time_ns: u64,
    #[prost(double, repeated, tag = "3")]
    pub pose: Vec<f64>,
}

pub(crate) static POSE_STEP: Fields =
    Fields::plain(&[(1, "index", false), (2, "time_ns", false), (3, "pose", true)]);

impl PoseStepV0 {
    /// What version 1 would have written; `None` if there are not seven numbers.
    pub fn into_v1(self) -> Option<proto::PoseStep> {
        let [x, y, z, qx, qy, qz, qw] = self.pose.try_into().ok()?;
        Some(proto::PoseStep {
            index: self.index,
            time_ns: self.time_ns,
            translation_m: Some(proto::Vector3 { x, y, z }),
            rotation: Some(proto::Quaternion { x: qx, y: qy, z: qz, w: qw }),
        })
    }
}
