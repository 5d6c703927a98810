//! Which fields a protobuf payload really has.
//!
//! A protobuf decoder skips fields it does not know, so it takes many a garbage payload for an empty message.
//! Here every tag is looked at, in messages within messages too.

/// What a message may hold: each field's number, name, and shape if it is a message itself.
pub(crate) struct Fields {
    /// Number, name, whether it repeats.
    plain: &'static [(u64, &'static str, bool)],
    /// Number, name, shape.
    messages: &'static [(u64, &'static str, &'static Fields)],
}

impl Fields {
    /// A message that holds no other.
    pub const fn plain(plain: &'static [(u64, &'static str, bool)]) -> Self {
        Self { plain, messages: &[] }
    }

    fn find(&self, number: u64) -> Option<(&'static str, bool, Option<&'static Fields>)> {
        let plain = self.plain.iter().find(|f| f.0 == number).map(|f| (f.1, f.2, None));
        plain.or_else(|| self.messages.iter().find(|f| f.0 == number).map(|f| (f.1, ONCE, Some(f.2))))
    }
}

/// Fields from this number on are other people's, and skipped.
pub(crate) const FIRST_EXTENSION: u64 = 1000;

const ONCE: bool = false;
const REPEATED: bool = true;

static VECTOR3: Fields = Fields::plain(&[(1, "x", ONCE), (2, "y", ONCE), (3, "z", ONCE)]);

static QUATERNION: Fields = Fields::plain(&[(1, "x", ONCE), (2, "y", ONCE), (3, "z", ONCE), (4, "w", ONCE)]);

static ARRAY: Fields = Fields::plain(&[(1, "encoding", ONCE), (2, "quantum", ONCE), (3, "data", ONCE)]);

pub(crate) static FIELD_STEP: Fields = Fields {
    plain: &[(1, "index", ONCE), (2, "time_ns", ONCE), (4, "flags", ONCE)],
    messages: &[(3, "u", &ARRAY), (5, "sd", &ARRAY), (6, "outside", &VECTOR3)],
};

pub(crate) static SAMPLE_STEP: Fields = Fields {
    plain: &[
        (1, "index", ONCE),
        (2, "time_ns", ONCE),
        (3, "strand_idx", REPEATED),
        (4, "marker_idx", REPEATED),
    ],
    messages: &[(5, "position_m", &ARRAY), (6, "value", &ARRAY), (7, "covariance", &ARRAY)],
};

pub(crate) static POSE_STEP: Fields = Fields {
    plain: &[(1, "index", ONCE), (2, "time_ns", ONCE)],
    messages: &[(3, "translation_m", &VECTOR3), (4, "rotation", &QUATERNION)],
};

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

/// Looks at every tag of a payload; whether there are fields that are skipped, in messages within it too.
pub(crate) fn check(payload: &[u8], fields: &Fields) -> Result<bool, BadField> {
    check_within(payload, fields, "")
}

fn check_within(mut bytes: &[u8], fields: &Fields, path: &str) -> Result<bool, BadField> {
    let mut seen = Vec::new();
    let mut has_extensions = false;
    while !bytes.is_empty() {
        let tag = varint(&mut bytes)?;
        let (number, content) = (tag >> 3, content(&mut bytes, tag & 7)?);
        if number >= FIRST_EXTENSION {
            has_extensions = true;
            continue;
        }
        let Some((name, repeated, within)) = fields.find(number) else {
            return Err(BadField::Unknown { path: path.to_owned(), number });
        };
        let path = if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
        if !repeated && seen.contains(&number) {
            return Err(BadField::Twice { path });
        }
        seen.push(number);
        if let Some(within) = within {
            let content = content.ok_or(BadField::Malformed)?;
            has_extensions |= check_within(content, within, &path)?;
        }
    }
    Ok(has_extensions)
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
    use crate::format::{DESCRIPTORS, DESCRIPTORS_V0};
    use crate::wire::{proto, v0};
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
        assert_eq!(check(&pose.encode_to_vec(), &POSE_STEP), Ok(false));
    }

    /// The tables say what the descriptors say, which travel in every file.
    #[test]
    fn the_tables_are_the_descriptors() {
        let tables = [
            (DESCRIPTORS, "v1.FieldStep", &FIELD_STEP),
            (DESCRIPTORS, "v1.SampleStep", &SAMPLE_STEP),
            (DESCRIPTORS, "v1.PoseStep", &POSE_STEP),
            (DESCRIPTORS_V0, "v0.FieldStep", &v0::FIELD_STEP),
            (DESCRIPTORS_V0, "v0.PoseStep", &v0::POSE_STEP),
        ];
        for (descriptors, name, fields) in tables {
            let pool = DescriptorPool::decode(descriptors).unwrap();
            let message = pool.get_message_by_name(&format!("tousle.eff.{name}")).unwrap();
            assert_same(fields, &message);
        }
    }

    fn assert_same(fields: &Fields, message: &MessageDescriptor) {
        assert_eq!(fields.plain.len() + fields.messages.len(), message.fields().len(), "{}", message.name());
        for field in message.fields() {
            let (name, repeated, within) = fields.find(u64::from(field.number())).unwrap();
            assert_eq!((field.name(), field.is_list()), (name, repeated), "{}", message.name());
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
        // Field 1000 is an extension, in translation_m too.
        assert_eq!(check(&[0xc0, 0x3e, 1], &POSE_STEP), Ok(true));
        assert_eq!(check(&[0x1a, 3, 0xc0, 0x3e, 1], &POSE_STEP), Ok(true));
        for malformed in [&[0x1a, 9, 0][..], &[0x80], &[0x0b], &[0xff; 11], &[0x18, 0]] {
            assert_eq!(check(malformed, &POSE_STEP), Err(BadField::Malformed), "{malformed:?}");
        }
    }
}
