//! The binary messages, field for field as `schemas/eff.v1.proto` has them.
//!
//! Written by hand rather than generated: five messages are shorter than the build step that would generate
//! them. A test compares every field with the descriptor that travels in the file.

/// One time step of the field.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct FieldStep {
    #[prost(uint64, tag = "1")]
    pub index: u64,
    #[prost(uint64, tag = "2")]
    pub time_ns: u64,
    #[prost(message, optional, tag = "3")]
    pub u: Option<Array>,
    #[prost(bytes = "vec", tag = "4")]
    pub flags: Vec<u8>,
    #[prost(message, optional, tag = "5")]
    pub sd: Option<Array>,
    #[prost(message, optional, tag = "6")]
    pub outside: Option<Vector3>,
}

/// The measured vectors of one time step.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct SampleStep {
    #[prost(uint64, tag = "1")]
    pub index: u64,
    #[prost(uint64, tag = "2")]
    pub time_ns: u64,
    #[prost(uint32, repeated, tag = "3")]
    pub strand_idx: Vec<u32>,
    #[prost(uint32, repeated, tag = "4")]
    pub marker_idx: Vec<u32>,
    #[prost(message, optional, tag = "5")]
    pub position_m: Option<Array>,
    #[prost(message, optional, tag = "6")]
    pub value: Option<Array>,
    #[prost(message, optional, tag = "7")]
    pub covariance: Option<Array>,
}

/// The head's pose at one time.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct PoseStep {
    #[prost(uint64, tag = "1")]
    pub index: u64,
    #[prost(uint64, tag = "2")]
    pub time_ns: u64,
    #[prost(message, optional, tag = "3")]
    pub translation_m: Option<Vector3>,
    #[prost(message, optional, tag = "4")]
    pub rotation: Option<Quaternion>,
}

/// A run of numbers, packed.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct Array {
    /// One of `Encoding`'s values; a number, so that an unknown one can be named in a message.
    #[prost(int32, tag = "1")]
    pub encoding: i32,
    #[prost(double, tag = "2")]
    pub quantum: f64,
    #[prost(bytes = "vec", tag = "3")]
    pub data: Vec<u8>,
}

/// A vector.
#[derive(Clone, Copy, PartialEq, prost::Message)]
pub(crate) struct Vector3 {
    #[prost(double, tag = "1")]
    pub x: f64,
    #[prost(double, tag = "2")]
    pub y: f64,
    #[prost(double, tag = "3")]
    pub z: f64,
}

/// A unit quaternion.
#[derive(Clone, Copy, PartialEq, prost::Message)]
pub(crate) struct Quaternion {
    #[prost(double, tag = "1")]
    pub x: f64,
    #[prost(double, tag = "2")]
    pub y: f64,
    #[prost(double, tag = "3")]
    pub z: f64,
    #[prost(double, tag = "4")]
    pub w: f64,
}

/// How the numbers of an [`Array`] are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, prost::Enumeration)]
#[repr(i32)]
pub(crate) enum Encoding {
    Unspecified = 0,
    F32 = 1,
    F16 = 2,
    Fixed16 = 3,
    Fixed32 = 4,
}
