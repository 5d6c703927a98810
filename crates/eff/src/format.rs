//! The names and limits of the format, as `docs/eff.md` gives them.

pub use tousle_core::MAX_SECS;

/// The version this crate writes, and the newest it reads.
pub const VERSION: u32 = 1;

/// The profile in the MCAP header of every field file.
pub const PROFILE: &str = "tousle.eff";

/// What a manifest says it is.
pub(crate) const FORMAT: &str = "tousle.eff";

/// Topics of version 1, in the order in which a file has them.
pub(crate) mod topic {
    pub(crate) const MANIFEST: &str = "/eff/manifest";
    pub(crate) const EDITS: &str = "/eff/edits";
    pub(crate) const POSE: &str = "/eff/pose";
    pub(crate) const SAMPLES: &str = "/eff/samples";
    pub(crate) const FIELD: &str = "/eff/field";
    /// Where the head is, for viewers.
    pub(crate) const PREVIEW_HEAD: &str = "/preview/head";
    /// What the wind looks like, for viewers.
    pub(crate) const PREVIEW_WIND: &str = "/preview/wind";
    /// What begins like this belongs to the format; a reader refuses what it does not know of it.
    pub(crate) const OURS: &str = "/eff/";
}

/// Where a message's numbers are described, and how it is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Stream {
    pub version: u32,
    pub topic: &'static str,
    pub message_encoding: &'static str,
    pub schema_name: &'static str,
    pub schema_encoding: &'static str,
    pub schema: &'static [u8],
}

/// The descriptors of the binary messages, a `FileDescriptorSet`.
pub(crate) const DESCRIPTORS: &[u8] = include_bytes!("../../../schemas/eff.v1.binpb");
/// The descriptors of version 0.
pub(crate) const DESCRIPTORS_V0: &[u8] = include_bytes!("../../../schemas/eff.v0.binpb");
/// The JSON Schema of a manifest of version 0.
pub(crate) const MANIFEST_SCHEMA_V0: &[u8] = include_bytes!("../../../schemas/eff.v0.manifest.json");
/// The JSON Schema of a manifest.
pub(crate) const MANIFEST_SCHEMA: &[u8] = include_bytes!("../../../schemas/eff.v1.manifest.json");
/// The JSON Schema of edits.
pub(crate) const EDITS_SCHEMA: &[u8] = include_bytes!("../../../schemas/eff.v1.edits.json");

const fn json(version: u32, topic: &'static str, schema_name: &'static str, schema: &'static [u8]) -> Stream {
    Stream { version, topic, message_encoding: "json", schema_name, schema_encoding: "jsonschema", schema }
}

const fn protobuf(
    version: u32,
    topic: &'static str,
    schema_name: &'static str,
    schema: &'static [u8],
) -> Stream {
    Stream { version, topic, message_encoding: "protobuf", schema_name, schema_encoding: "protobuf", schema }
}

/// The channels of version 1.
pub(crate) static STREAMS: [Stream; 5] = [
    json(1, topic::MANIFEST, "tousle.eff.v1.Manifest", MANIFEST_SCHEMA),
    json(1, topic::EDITS, "tousle.eff.v1.Edits", EDITS_SCHEMA),
    protobuf(1, topic::POSE, "tousle.eff.v1.PoseStep", DESCRIPTORS),
    protobuf(1, topic::SAMPLES, "tousle.eff.v1.SampleStep", DESCRIPTORS),
    protobuf(1, topic::FIELD, "tousle.eff.v1.FieldStep", DESCRIPTORS),
];

/// The channels of version 0.
static STREAMS_V0: [Stream; 3] = [
    json(0, topic::MANIFEST, "tousle.eff.v0.Manifest", MANIFEST_SCHEMA_V0),
    protobuf(0, topic::POSE, "tousle.eff.v0.PoseStep", DESCRIPTORS_V0),
    protobuf(0, topic::FIELD, "tousle.eff.v0.FieldStep", DESCRIPTORS_V0),
];

/// What the schemas of version 1 said before its feature `directing`: files written then carry these texts, for ever.
static EARLIER_SCHEMAS: [(&str, &[u8]); 2] = [
    ("tousle.eff.v1.Manifest", include_bytes!("../../../schemas/earlier/eff.v1.manifest.1.json")),
    ("tousle.eff.v1.Edits", include_bytes!("../../../schemas/earlier/eff.v1.edits.1.json")),
];

/// Whether a schema's text is one that files of this version have or had.
pub(crate) fn is_schema_text(stream: &Stream, text: &[u8]) -> bool {
    text == stream.schema || EARLIER_SCHEMAS.contains(&(stream.schema_name, text))
}

/// The channels of all versions, the newest first.
pub(crate) fn streams() -> impl Iterator<Item = &'static Stream> {
    STREAMS.iter().chain(&STREAMS_V0)
}

/// The highest rate a file can have, Hz, so that no two steps share a nanosecond.
pub const MAX_RATE_HZ: f64 = 1e6;

/// The most voxels a step may have: 256³.
pub(crate) const MAX_VOXELS: u64 = 1 << 24;

/// The most that a voxel of a step takes, bytes: a vector, a flag, a standard deviation, and some.
pub(crate) const MAX_VOXEL_BYTES: u64 = 18;

/// The longest a chunk may be when unpacked, bytes: a step of [`MAX_VOXELS`].
pub(crate) const MAX_CHUNK: u64 = MAX_VOXEL_BYTES * MAX_VOXELS;

/// The time of step `k`, s: `start + k / rate`, in doubles.
pub(crate) fn step_secs(start_secs: f64, rate_hz: f64, k: u64) -> f64 {
    start_secs + k as f64 / rate_hz
}

/// A time as the file has it: the nearest nanosecond, halves away from zero; `None` before 0 or past the end.
pub(crate) fn time_ns(secs: f64) -> Option<u64> {
    ((0.0..=MAX_SECS).contains(&secs)).then(|| (secs * 1e9).round() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_rounded_to_the_nearest_nanosecond() {
        assert_eq!(time_ns(step_secs(0.0, 30.0, 1)), Some(33_333_333));
        assert_eq!(time_ns(step_secs(0.0, 30.0, 2)), Some(66_666_667));
        assert_eq!(time_ns(step_secs(0.5, 120.0, 60)), Some(1_000_000_000));
        for beyond in [-1e-3, 1e6 + 1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(time_ns(beyond), None, "{beyond}");
        }
    }
}
