//! Payloads, decoded: JSON and protobuf to the vocabulary, or what is wrong with them.

use crate::array::{self, Shape};
use crate::finding::Place;
use crate::format::{EDITS_SCHEMA, FORMAT, MANIFEST_SCHEMA, MANIFEST_SCHEMA_V0, Stream, VERSION, topic};
use crate::json_schema;
use crate::manifest::{FieldInfo, Manifest};
use crate::wire::edits::{DIRECTING, Edits};
use crate::wire::proto::{FieldStep, PoseStep, SampleStep};
use crate::wire::tags::{self, BadField, Fields};
use crate::wire::unique::Unique;
use crate::wire::v0::{self, FieldStepV0, ManifestV0, PoseStepV0};
use crate::wire::{proto, scene};
use crate::{Code, Finding, check};
use prost::bytes::{Buf, Bytes};
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::sync::LazyLock;
use tousle_core::{Pose, Vec3, WindSample};
use tousle_field::{Field, VoxelFlag};

/// What every binary message says of itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Stamp {
    pub index: u64,
    pub time_ns: u64,
}

/// Decodes a manifest; `announced` is the version of the schema of its channel. One of a newer version is
/// refused by that name before its members are looked at.
pub(crate) fn manifest(payload: &[u8], announced: u32, place: Place<'_>) -> Result<Manifest, Vec<Finding>> {
    static SCHEMA: LazyLock<Value> = LazyLock::new(|| json_of(MANIFEST_SCHEMA));
    static SCHEMA_V0: LazyLock<Value> = LazyLock::new(|| json_of(MANIFEST_SCHEMA_V0));
    let value: Value = from_json(payload, place).map_err(|f| vec![*f])?;
    if value["format"] == FORMAT {
        if let Some(version) = value["version"].as_u64().filter(|v| *v > u64::from(VERSION)) {
            let expected = format!("at most {VERSION}, the newest this program reads");
            return Err(vec![*place.finding(Code::Version, "version", version, expected)]);
        }
        if let Some(version) = value["version"].as_u64().filter(|v| *v != u64::from(announced)) {
            let expected = format!("{announced}, the version of its schema");
            return Err(vec![*place.finding(Code::Version, "version", version, expected)]);
        }
        let requires = value["requires"].as_array().map_or(&[][..], Vec::as_slice);
        if let Some((k, feature)) = requires.iter().enumerate().find(|(_, feature)| **feature != DIRECTING) {
            let expected = format!("features that version 1 has: {DIRECTING}");
            return Err(vec![*place.finding(Code::Requires, format!("requires[{k}]"), feature, expected)]);
        }
    }
    if announced == 0 {
        return by_schema::<ManifestV0>(payload, &value, &SCHEMA_V0, place).map(Into::into);
    }
    by_schema(payload, &value, &SCHEMA, place)
}

/// Decodes a message of edits.
pub(crate) fn edits(payload: &[u8], place: Place<'_>) -> Result<Edits, Vec<Finding>> {
    static SCHEMA: LazyLock<Value> = LazyLock::new(|| json_of(EDITS_SCHEMA));
    let value: Value = from_json(payload, place).map_err(|f| vec![*f])?;
    by_schema(payload, &value, &SCHEMA, place)
}

/// Decodes JSON that satisfies its schema.
fn by_schema<T: DeserializeOwned>(
    payload: &[u8],
    value: &Value,
    schema: &Value,
    place: Place<'_>,
) -> Result<T, Vec<Finding>> {
    let violations = json_schema::violations(value, schema);
    if violations.is_empty() {
        // In the value a member that is there twice is there once.
        let unique: Result<Unique, _> = from_json(payload, place);
        return unique.and_then(|Unique| from_json(payload, place)).map_err(|f| vec![*f]);
    }
    let finding = |v: json_schema::Violation| *place.finding(Code::JsonSchema, v.path, v.found, v.expected);
    Err(violations.into_iter().map(finding).collect())
}

/// One of our own schemas.
fn json_of(schema: &[u8]) -> Value {
    serde_json::from_slice(schema).expect("a test keeps the schemas current")
}

/// Whether a message has fields that are other people's, and skipped.
pub(crate) fn has_extensions(stream: &Stream, payload: &[u8]) -> bool {
    let fields = match (stream.version, stream.topic) {
        (0, topic::POSE) => &v0::POSE_STEP,
        (0, topic::FIELD) => &v0::FIELD_STEP,
        (_, topic::POSE) => &tags::POSE_STEP,
        (_, topic::SAMPLES) => &tags::SAMPLE_STEP,
        (_, topic::FIELD) => &tags::FIELD_STEP,
        _ => return false,
    };
    tags::check(payload, fields) == Ok(true)
}

/// Decodes a pose.
pub(crate) fn pose(
    payload: &[u8],
    manifest: &Manifest,
    place: Place<'_>,
) -> Result<(Stamp, Pose), Box<Finding>> {
    let message: PoseStep = match manifest.version {
        0 => {
            let old: PoseStepV0 = from_protobuf(payload, &v0::POSE_STEP, place)?;
            let n = old.pose.len();
            old.into_v1().ok_or_else(|| place.finding(Code::Size, "pose", n, "7 numbers"))?
        }
        _ => from_protobuf(payload, &tags::POSE_STEP, place)?,
    };
    let proto::Vector3 { x, y, z } = message.translation_m.unwrap_or_default();
    let translation = [x, y, z];
    let proto::Quaternion { x, y, z, w } = message.rotation.unwrap_or_default();
    let rotation = [x, y, z, w];
    check::pose(translation, rotation, "", place)?;
    Ok((Stamp { index: message.index, time_ns: message.time_ns }, scene::pose(translation, rotation)))
}

/// Decodes the samples of a step.
pub(crate) fn samples(payload: &[u8], place: Place<'_>) -> Result<(Stamp, Vec<WindSample>), Box<Finding>> {
    let message: SampleStep = from_protobuf(payload, &tags::SAMPLE_STEP, place)?;
    let n = message.strand_idx.len();
    if message.marker_idx.len() != n {
        return Err(place.finding(
            Code::Size,
            "marker_idx",
            message.marker_idx.len(),
            format!("{n}, one a sample"),
        ));
    }
    let column = |array: Option<proto::Array>, planes, what| {
        let array = array.unwrap_or_default();
        check::encoding(&array, &[proto::Encoding::F32], place, what)?;
        array::unpack(&array, Shape::list(planes, n), place, what)
    };
    if n == 0 {
        return Ok((Stamp { index: message.index, time_ns: message.time_ns }, Vec::new()));
    }
    let position = column(message.position_m, 3, "position_m")?;
    let value = column(message.value, 3, "value")?;
    let covariance = column(message.covariance, 6, "covariance")?;
    check::finite(&position, "position_m", place)?;
    check::finite(&value, "value", place)?;
    let vector = |column: &[f32], k: usize| Vec3::from_fn(|axis, _| f64::from(column[axis * n + k]));
    let samples: Vec<_> = (0..n)
        .map(|k| WindSample {
            strand_idx: message.strand_idx[k],
            marker_idx: message.marker_idx[k],
            position_m: vector(&position, k),
            value: vector(&value, k),
            covariance: std::array::from_fn(|c| f64::from(covariance[c * n + k])),
        })
        .collect();
    check::covariances(&samples, place)?;
    Ok((Stamp { index: message.index, time_ns: message.time_ns }, samples))
}

/// Decodes a step of the field and leaves its arrays packed, where they are in the payload.
pub(crate) fn packed_step(
    payload: Bytes,
    manifest: &Manifest,
    place: Place<'_>,
) -> Result<FieldStep, Box<Finding>> {
    match manifest.version {
        0 => {
            let old: FieldStepV0 = from_protobuf(payload, &v0::FIELD_STEP, place)?;
            let n = old.outside.len();
            old.into_v1().ok_or_else(|| place.finding(Code::Size, "outside", n, "3 numbers"))
        }
        _ => from_protobuf(payload, &tags::FIELD_STEP, place),
    }
}

/// Decodes a step of the field.
pub(crate) fn step(
    payload: &[u8],
    manifest: &Manifest,
    place: Place<'_>,
) -> Result<(Stamp, Field), Vec<Finding>> {
    let message = packed_step(Bytes::copy_from_slice(payload), manifest, place).map_err(|f| vec![*f])?;
    let stamp = Stamp { index: message.index, time_ns: message.time_ns };
    Ok((stamp, unpack_step(message, &manifest.field, place)?))
}

/// Unpacks the arrays of a step.
pub(crate) fn unpack_step(
    message: FieldStep,
    info: &FieldInfo,
    place: Place<'_>,
) -> Result<Field, Vec<Finding>> {
    let dims = info.grid.dims.map(|n| n as usize);
    let n = dims.iter().product();
    let u = message.u.unwrap_or_default();
    let mut findings = Vec::new();
    findings.extend(check::encodings(&u, message.sd.as_ref(), info, place).err().map(|f| *f));
    let u = array::unpack(&u, Shape { planes: 3, dims }, place, "u")
        .and_then(|u| check::finite(&u, "u", place).map(|()| u));
    let flags = flags(&message.flags, n, place);
    let sd = message.sd.map(|sd| {
        array::unpack(&sd, Shape { planes: 1, dims }, place, "sd")
            .and_then(|sd| check::deviations(&sd, place).map(|()| sd))
    });
    let proto::Vector3 { x, y, z } = message.outside.unwrap_or_default();
    findings.extend(check::finite_vector([x, y, z], "outside", place).err().map(|f| *f));
    match (u, flags, sd.transpose()) {
        (Ok(u), Ok(flags), Ok(sd)) if findings.is_empty() => {
            Ok(Field { u, flags, sd, outside: Vec3::new(x, y, z) })
        }
        (u, flags, sd) => {
            findings.extend(u.err().map(|f| *f));
            findings.extend(flags.err().map(|f| *f));
            findings.extend(sd.err().map(|f| *f));
            Err(findings)
        }
    }
}

fn flags(bytes: &[u8], n: usize, place: Place<'_>) -> Result<Vec<VoxelFlag>, Box<Finding>> {
    if bytes.len() != n {
        return Err(place.finding(
            Code::Size,
            "flags",
            format!("{} bytes", bytes.len()),
            format!("{n}, one a voxel"),
        ));
    }
    if let Some(k) = bytes.iter().position(|byte| VoxelFlag::from_byte(*byte).is_none()) {
        let expected = "0 outside, 1 interpolated, 2 measured";
        return Err(place.finding(Code::Flag, format!("flags[{k}]"), bytes[k], expected));
    }
    // Two passes, as the second is vector code.
    Ok(bytes.iter().map(|byte| VoxelFlag::from_byte(*byte).unwrap_or_default()).collect())
}

/// Decodes JSON.
fn from_json<T: DeserializeOwned>(payload: &[u8], place: Place<'_>) -> Result<T, Box<Finding>> {
    serde_json::from_slice(payload).map_err(|error| {
        let code = if error.is_data() { Code::JsonSchema } else { Code::Json };
        place.finding(code, "payload", error, "JSON as the schema has it")
    })
}

/// Decodes protobuf that holds fields of this version only.
fn from_protobuf<M: prost::Message + Default>(
    payload: impl Buf + AsRef<[u8]>,
    fields: &Fields,
    place: Place<'_>,
) -> Result<M, Box<Finding>> {
    tags::check(payload.as_ref(), fields).map_err(|bad| match bad {
        BadField::Unknown { path, number } => {
            let within = if path.is_empty() { "payload".to_owned() } else { path };
            place.finding(Code::UnknownField, within, format!("field {number}"), "fields of version 1")
        }
        BadField::Twice { path } => place.finding(Code::Protobuf, path, "the field twice", "once"),
        BadField::Malformed => place.finding(Code::Protobuf, "payload", "bytes that are none", "protobuf"),
    })?;
    M::decode(payload).map_err(|error| place.finding(Code::Protobuf, "payload", error, "protobuf"))
}
