//! Which fields a protobuf payload really has.
//!
//! A protobuf decoder skips fields it does not know, so it takes many a garbage payload for an empty message.
//! Here every tag is looked at, in messages within messages too.

/// What a message may hold: each field's number, name, and shape if it is a message itself.
pub(crate) struct Fields(&'static [(u64, &'static str, bool, Option<&'static Fields>)]);

/// Fields from this number on are other people's, and skipped.
pub(crate) const FIRST_EXTENSION: u64 = 1000;

const ONCE: bool = false;
const REPEATED: bool = true;

static VECTOR3: Fields = Fields(&[(1, "x", ONCE, None), (2, "y", ONCE, None), (3, "z", ONCE, None)]);

static QUATERNION: Fields =
    Fields(&[(1, "x", ONCE, None), (2, "y", ONCE, None), (3, "z", ONCE, None), (4, "w", ONCE, None)]);

static ARRAY: Fields =
    Fields(&[(1, "encoding", ONCE, None), (2, "quantum", ONCE, None), (3, "data", ONCE, None)]);

pub(crate) static FIELD_STEP: Fields = Fields(&[
    (1, "index", ONCE, None),
    (2, "time_ns", ONCE, None),
    (3, "u", ONCE, Some(&ARRAY)),
    (4, "flags", ONCE, None),
    (5, "sd", ONCE, Some(&ARRAY)),
    (6, "outside", ONCE, Some(&VECTOR3)),
]);

pub(crate) static SAMPLE_STEP: Fields = Fields(&[
    (1, "index", ONCE, None),
    (2, "time_ns", ONCE, None),
    (3, "strand_idx", REPEATED, None),
    (4, "marker_idx", REPEATED, None),
    (5, "position_m", ONCE, Some(&ARRAY)),
    (6, "value", ONCE, Some(&ARRAY)),
    (7, "covariance", ONCE, Some(&ARRAY)),
]);

pub(crate) static POSE_STEP: Fields = Fields(&[
    (1, "index", ONCE, None),
    (2, "time_ns", ONCE, None),
    (3, "translation_m", ONCE, Some(&VECTOR3)),
    (4, "rotation", ONCE, Some(&QUATERNION)),
]);

/// A field that must not be there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum BadField {
    /// The version has no field of this number.
    Unknown { path: String, number: u64 },
    /// The field is there twice; decoders differ in what they make of that.
    Twice { path: String },
    /// The bytes are no protobuf.
    Malformed,
}

/// Looks at every tag of a payload.
pub(crate) fn check(payload: &[u8], fields: &Fields) -> Result<(), BadField> {
    check_within(payload, fields, "")
}

fn check_within(mut bytes: &[u8], fields: &Fields, path: &str) -> Result<(), BadField> {
    let mut seen = Vec::new();
    while !bytes.is_empty() {
        let tag = varint(&mut bytes)?;
        let (number, content) = (tag >> 3, content(&mut bytes, tag & 7)?);
        if number >= FIRST_EXTENSION {
            continue;
        }
        let Some((_, name, repeated, within)) = fields.0.iter().find(|f| f.0 == number) else {
            return Err(BadField::Unknown { path: path.to_owned(), number });
        };
        let path = if path.is_empty() { (*name).to_owned() } else { format!("{path}.{name}") };
        if !repeated && seen.contains(&number) {
            return Err(BadField::Twice { path });
        }
        seen.push(number);
        if let Some(within) = within {
            check_within(content.ok_or(BadField::Malformed)?, within, &path)?;
        }
    }
    Ok(())
}

/// Takes a field's content off the bytes; `None` for a plain number.
fn content<'a>(bytes: &mut &'a [u8], wire_type: u64) -> Result<Option<&'a [u8]>, BadField> {
    match wire_type {
        0 => varint(bytes).map(|_| None),
        1 => take(bytes, 8).map(|_| None),
        5 => take(bytes, 4).map(|_| None),
        2 => {
            let length = varint(bytes)?;
            take(bytes, length).map(Some)
        }
        _ => Err(BadField::Malformed),
    }
}

fn take<'a>(bytes: &mut &'a [u8], n: u64) -> Result<&'a [u8], BadField> {
    let n = usize::try_from(n).map_err(|_| BadField::Malformed)?;
    let (taken, rest) = bytes.split_at_checked(n).ok_or(BadField::Malformed)?;
    *bytes = rest;
    Ok(taken)
}

fn varint(bytes: &mut &[u8]) -> Result<u64, BadField> {
    let mut value = 0;
    for shift in (0..64).step_by(7) {
        let byte = take(bytes, 1)?[0];
        value |= u64::from(byte & 0x7f) << shift;
        if byte & 0x80 == 0 {
            return Ok(value);
        }
    }
    Err(BadField::Malformed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::proto;
    use prost::Message as _;
    use protox::prost_reflect::{DescriptorPool, Kind, MessageDescriptor};

    #[test]
    fn what_we_write_has_known_fields_only() {
        let pose = proto::PoseStep {
            index: 300,
            time_ns: 1,
            translation_m: Some(proto::Vector3 { x: 1.0, y: 2.0, z: 3.0 }),
            rotation: Some(proto::Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 }),
        };
        assert_eq!(check(&pose.encode_to_vec(), &POSE_STEP), Ok(()));
    }

    /// The table says what the descriptors say, which travel in every file.
    #[test]
    fn the_table_is_the_descriptors() {
        let pool = DescriptorPool::decode(crate::format::DESCRIPTORS).unwrap();
        for (name, fields) in
            [("FieldStep", &FIELD_STEP), ("SampleStep", &SAMPLE_STEP), ("PoseStep", &POSE_STEP)]
        {
            let message = pool.get_message_by_name(&format!("tousle.eff.v1.{name}")).unwrap();
            assert_same(fields, &message);
        }
    }

    fn assert_same(fields: &Fields, message: &MessageDescriptor) {
        assert_eq!(fields.0.len(), message.fields().len(), "{}", message.name());
        for (number, name, repeated, within) in fields.0 {
            let field = message.get_field(*number as u32).unwrap();
            assert_eq!((field.name(), field.is_list()), (*name, *repeated), "{}", message.name());
            match (within, field.kind()) {
                (Some(within), Kind::Message(message)) => assert_same(within, &message),
                (within, kind) => assert!(within.is_none() && kind.as_message().is_none(), "{name}"),
            }
        }
    }

    #[test]
    fn strangers_are_found_within_messages_too() {
        // Field 5, varint 7, inside translation_m (field 3, 2 bytes).
        let unknown = BadField::Unknown { path: "translation_m".into(), number: 5 };
        assert_eq!(check(&[0x1a, 2, 0x28, 7], &POSE_STEP), Err(unknown));
        // Field 1 twice.
        assert_eq!(check(&[0x08, 1, 0x08, 1], &POSE_STEP), Err(BadField::Twice { path: "index".into() }));
        // Field 1000 is an extension.
        assert_eq!(check(&[0xc0, 0x3e, 1], &POSE_STEP), Ok(()));
        for malformed in [&[0x1a, 9, 0][..], &[0x80], &[0x0b], &[0xff; 11], &[0x18, 0]] {
            assert_eq!(check(malformed, &POSE_STEP), Err(BadField::Malformed), "{malformed:?}");
        }
    }
}
