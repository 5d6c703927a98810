//! Foxglove's messages that previews are written in, field for field as `schemas/preview.proto` has them.

use super::proto::{Quaternion, Vector3};

/// A moment.
#[derive(Clone, Copy, PartialEq, prost::Message)]
pub(crate) struct Timestamp {
    #[prost(int64, tag = "1")]
    pub seconds: i64,
    #[prost(int32, tag = "2")]
    pub nanos: i32,
}

/// Where one frame is in another.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct FrameTransform {
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    #[prost(string, tag = "2")]
    pub parent_frame_id: String,
    #[prost(string, tag = "3")]
    pub child_frame_id: String,
    #[prost(message, optional, tag = "4")]
    pub translation: Option<Vector3>,
    #[prost(message, optional, tag = "5")]
    pub rotation: Option<Quaternion>,
}

/// Points with what belongs to each.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct PointCloud {
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    #[prost(string, tag = "2")]
    pub frame_id: String,
    #[prost(message, optional, tag = "3")]
    pub pose: Option<Pose>,
    #[prost(fixed32, tag = "4")]
    pub point_stride: u32,
    #[prost(message, repeated, tag = "5")]
    pub fields: Vec<PackedElementField>,
    #[prost(bytes = "vec", tag = "6")]
    pub data: Vec<u8>,
}

/// A number that every point has.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct PackedElementField {
    #[prost(string, tag = "1")]
    pub name: String,
    #[prost(fixed32, tag = "2")]
    pub offset: u32,
    #[prost(int32, tag = "3")]
    pub kind: i32,
}

/// One byte without a sign.
pub(crate) const UINT8: i32 = 1;
/// IEEE 754 binary32.
pub(crate) const FLOAT32: i32 = 7;

impl PackedElementField {
    /// How many bytes it takes; `None` for a type that is not known.
    pub fn width(&self) -> Option<u32> {
        Some(match self.kind {
            1 | 2 => 1,
            3 | 4 => 2,
            5..=7 => 4,
            8 => 8,
            _ => return None,
        })
    }
}

/// A place and a turn.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct Pose {
    #[prost(message, optional, tag = "1")]
    pub position: Option<Vector3>,
    #[prost(message, optional, tag = "2")]
    pub orientation: Option<Quaternion>,
}

impl Timestamp {
    /// A time as the file has it.
    pub fn from_ns(time_ns: u64) -> Self {
        Self { seconds: (time_ns / 1_000_000_000) as i64, nanos: (time_ns % 1_000_000_000) as i32 }
    }
}
