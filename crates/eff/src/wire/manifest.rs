//! The manifest: what the field is, before its first step.

use super::scene::Scene;
use crate::array::{Encoding, ErrorBound};
use crate::format;
use serde::{Deserialize, Serialize};
use tousle_core::Quantity;
use tousle_field::GridSpec;

/// What a field file is about: the one message of `/eff/manifest`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[cfg_attr(test, schemars(title = "tousle.eff.v1.Manifest"))]
pub struct Manifest {
    /// Always `tousle.eff`.
    #[cfg_attr(test, schemars(extend("const" = "tousle.eff")))]
    pub format: String,
    /// The format's version. A reader refuses a newer one than its own.
    #[cfg_attr(test, schemars(extend("const" = 1)))]
    pub version: u32,
    /// Names of features that a reader must know to read the file. Version 1 began with none and has one: `directing`.
    pub requires: Vec<String>,
    /// What the field is called, for people.
    pub name: String,
    /// The method that made the field: `paper`, `physical`, or another by name.
    pub method: String,
    /// The program that made the field, with its version.
    pub generator: String,
    /// The voxels and their steps.
    pub field: FieldInfo,
    /// The head's poses.
    pub pose: PoseInfo,
    /// All that a simulator needs besides wind and poses.
    pub scene: Scene,
    /// The measured vectors; null if the file has none.
    pub samples: Option<SamplesInfo>,
    /// Whatever else a writer has to say. A reader may skip it.
    #[serde(default, skip_serializing_if = "serde_json::Map::is_empty")]
    pub extensions: serde_json::Map<String, serde_json::Value>,
}

/// The voxels and their steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FieldInfo {
    /// What the vectors are.
    pub quantity: QuantityName,
    /// Where the voxels are.
    pub grid: Grid,
    /// Time of the first step, s.
    #[cfg_attr(test, schemars(range(min = 0.0, max = 1e6)))]
    pub start_secs: f64,
    /// Steps a second.
    #[cfg_attr(test, schemars(range(max = 1e6), extend("exclusiveMinimum" = 0.0)))]
    pub rate_hz: f64,
    /// How many steps there are; null if the writer did not know when it began.
    #[cfg_attr(test, schemars(range(min = 1)))]
    pub n_steps: Option<u64>,
    /// How the vectors are packed.
    pub encoding: EncodingInfo,
}

/// What vectors are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub enum QuantityName {
    /// Velocity of the air over the ground, m/s.
    AirVelocity,
    /// Force per mass on the lock that was measured, m/s².
    ForcePerMass,
}

/// Where the voxels are: a box of cubes, axes along the head's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Grid {
    /// The outer corner of voxel (0, 0, 0), head space, m.
    pub origin_m: [f64; 3],
    /// The edge of a voxel, m.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0.0)))]
    pub edge_m: f64,
    /// Voxels along x, y, z; at most 2²⁴ in all.
    #[cfg_attr(test, schemars(inner(range(min = 1, max = 16_777_216))))]
    pub dims: [u64; 3],
}

/// How the field's vectors are packed, and how far they may be from what they were: the larger of the two.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct EncodingInfo {
    /// The kind.
    pub kind: EncodingName,
    /// The absolute bound of the error of each component, in the quantity's unit.
    #[cfg_attr(test, schemars(range(min = 0.0)))]
    pub max_absolute_error: f64,
    /// The relative bound of the error of each component.
    #[cfg_attr(test, schemars(range(min = 0.0)))]
    pub max_relative_error: f64,
}

/// How vectors are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub enum EncodingName {
    /// Single precision; nothing is lost.
    F32,
    /// Half precision.
    F16,
    /// Whole multiples of a quantum, as differences.
    Fixed,
}

/// The head's poses: the messages of `/eff/pose`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PoseInfo {
    /// Time of the first pose, s.
    #[cfg_attr(test, schemars(range(min = 0.0, max = 1e6)))]
    pub start_secs: f64,
    /// Poses a second.
    #[cfg_attr(test, schemars(range(max = 1e6), extend("exclusiveMinimum" = 0.0)))]
    pub rate_hz: f64,
    /// How many there are.
    #[cfg_attr(test, schemars(range(min = 1)))]
    pub n_poses: u64,
}

/// The measured vectors: the messages of `/eff/samples`. Their first step is at 0 s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SamplesInfo {
    /// What the vectors are.
    pub quantity: QuantityName,
    /// Steps a second.
    #[cfg_attr(test, schemars(range(max = 1e6), extend("exclusiveMinimum" = 0.0)))]
    pub rate_hz: f64,
    /// How many steps there are.
    pub n_steps: u64,
}

impl From<Quantity> for QuantityName {
    fn from(quantity: Quantity) -> Self {
        match quantity {
            Quantity::AirVelocity => Self::AirVelocity,
            Quantity::ForcePerMass => Self::ForcePerMass,
        }
    }
}

impl From<QuantityName> for Quantity {
    fn from(name: QuantityName) -> Self {
        match name {
            QuantityName::AirVelocity => Self::AirVelocity,
            QuantityName::ForcePerMass => Self::ForcePerMass,
        }
    }
}

impl From<GridSpec> for Grid {
    fn from(grid: GridSpec) -> Self {
        Self { origin_m: grid.origin_m.into(), edge_m: grid.edge_m, dims: grid.dims.map(|n| n as u64) }
    }
}

impl Grid {
    /// Voxels in all; [`u64::MAX`] if there are more.
    pub(crate) fn n_voxels(&self) -> u64 {
        self.dims.iter().fold(1, |n, d| n.saturating_mul(*d))
    }

    /// The grid in the vocabulary's words. Only for a grid that was checked.
    pub fn spec(&self) -> GridSpec {
        GridSpec { origin_m: self.origin_m.into(), edge_m: self.edge_m, dims: self.dims.map(|n| n as usize) }
    }
}

impl From<Encoding> for EncodingInfo {
    fn from(encoding: Encoding) -> Self {
        let ErrorBound { absolute, relative } = encoding.error_bound();
        let kind = match encoding {
            Encoding::F32 => EncodingName::F32,
            Encoding::F16 => EncodingName::F16,
            Encoding::Fixed { .. } => EncodingName::Fixed,
        };
        Self { kind, max_absolute_error: absolute, max_relative_error: relative }
    }
}

impl EncodingInfo {
    /// The encoding that a writer would be told to use.
    pub fn encoding(&self) -> Encoding {
        match self.kind {
            EncodingName::F32 => Encoding::F32,
            EncodingName::F16 => Encoding::F16,
            EncodingName::Fixed => Encoding::Fixed { max_error: self.max_absolute_error },
        }
    }
}

impl FieldInfo {
    /// Time of step `k`, s.
    pub fn step_secs(&self, k: u64) -> f64 {
        format::step_secs(self.start_secs, self.rate_hz, k)
    }
}

impl PoseInfo {
    /// Time of pose `k`, s.
    pub fn pose_secs(&self, k: u64) -> f64 {
        format::step_secs(self.start_secs, self.rate_hz, k)
    }
}

impl SamplesInfo {
    /// Time of step `k`, s.
    pub fn step_secs(&self, k: u64) -> f64 {
        format::step_secs(0.0, self.rate_hz, k)
    }
}
