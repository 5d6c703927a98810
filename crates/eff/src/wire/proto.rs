//! The binary messages, field for field as `schemas/eff.v1.proto` has them.
//!
//! Written by hand rather than generated: five messages are shorter than the build step that would generate
//! them. A test compares every field with the descriptor that travels in the file.

use prost::bytes::Bytes;

/// One time step of the field.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct FieldStep {
    #[prost(uint64, tag = "1")]
    pub index: u64,
    #[prost(uint64, tag = "2")]
    pub time_ns: u64,
    #[prost(message, optional, tag = "3")]
    pub u: Option<Array>,
    #[prost(bytes = "bytes", tag = "4")]
    pub flags: Bytes,
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
    #[prost(bytes = "bytes", tag = "3")]
    pub data: Bytes,
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

#[cfg(test)]
mod tests {
    use super::*;
    use prost::Message;
    use protox::prost_reflect::{DescriptorPool, DynamicMessage, ReflectMessage, Value};

    /// What we write, read by the descriptors that travel in the file: every field arrives, by its name.
    #[test]
    fn the_descriptors_read_what_we_write() {
        let array = |encoding: Encoding| Array {
            encoding: encoding as i32,
            quantum: 0.25,
            data: Bytes::from_static(&[1, 2]),
        };
        let vector = Vector3 { x: 1.0, y: 2.0, z: 3.0 };
        let field = by_descriptor(
            "FieldStep",
            &FieldStep {
                index: 1,
                time_ns: 2,
                u: Some(array(Encoding::F16)),
                flags: Bytes::from_static(&[3]),
                sd: Some(array(Encoding::F32)),
                outside: Some(vector),
            },
        );
        assert_eq!(field.get_field_by_name("time_ns").unwrap().as_u64(), Some(2));
        assert_eq!(field.get_field_by_name("flags").unwrap().as_bytes().unwrap()[..], [3]);
        let u = field.get_field_by_name("u").unwrap();
        let u = u.as_message().unwrap();
        assert_eq!(*u.get_field_by_name("encoding").unwrap(), Value::EnumNumber(2));
        assert_eq!(*u.get_field_by_name("quantum").unwrap(), Value::F64(0.25));
        by_descriptor(
            "SampleStep",
            &SampleStep {
                index: 1,
                time_ns: 2,
                strand_idx: vec![3, 4],
                marker_idx: vec![5, 6],
                position_m: Some(array(Encoding::F32)),
                value: Some(array(Encoding::Fixed16)),
                covariance: Some(array(Encoding::Fixed32)),
            },
        );
        let pose = by_descriptor(
            "PoseStep",
            &PoseStep {
                index: 1,
                time_ns: 2,
                translation_m: Some(vector),
                rotation: Some(Quaternion { x: 1.0, y: 2.0, z: 3.0, w: 4.0 }),
            },
        );
        let rotation = pose.get_field_by_name("rotation").unwrap();
        assert_eq!(*rotation.as_message().unwrap().get_field_by_name("w").unwrap(), Value::F64(4.0));
    }

    fn by_descriptor(name: &str, message: &impl Message) -> DynamicMessage {
        let pool = DescriptorPool::decode(crate::format::DESCRIPTORS).unwrap();
        let descriptor = pool.get_message_by_name(&format!("tousle.eff.v1.{name}")).unwrap();
        let bytes = message.encode_to_vec();
        let read = DynamicMessage::decode(descriptor, &bytes[..]).unwrap();
        assert_eq!(read.unknown_fields().count(), 0);
        assert!(read.descriptor().fields().all(|field| read.has_field(&field)), "{name}");
        assert_eq!(read.encode_to_vec(), bytes);
        read
    }
}
