//! Named values in an OpenVDB file, and its strings.

/// A named value's value.
pub(super) enum Metadata {
    Bool(bool),
    Double(f64),
    Int64(i64),
    Text(String),
    Vec3d([f64; 3]),
    Vec3i([i32; 3]),
}

/// A string: its length in 32 bits, then its bytes.
pub(super) fn put_text(out: &mut Vec<u8>, text: &str) {
    out.extend((text.len() as u32).to_le_bytes());
    out.extend(text.as_bytes());
}

/// All values of a file or a grid: their number, then name, type, size and bytes of each.
pub(super) fn put_metadata(out: &mut Vec<u8>, values: &[(&str, Metadata)]) {
    out.extend((values.len() as u32).to_le_bytes());
    for (name, value) in values {
        put_text(out, name);
        let (kind, bytes) = encode(value);
        put_text(out, kind);
        out.extend((bytes.len() as u32).to_le_bytes());
        out.extend(bytes);
    }
}

fn encode(value: &Metadata) -> (&'static str, Vec<u8>) {
    match value {
        Metadata::Bool(value) => ("bool", vec![u8::from(*value)]),
        Metadata::Double(value) => ("double", value.to_le_bytes().to_vec()),
        Metadata::Int64(value) => ("int64", value.to_le_bytes().to_vec()),
        Metadata::Text(text) => ("string", text.as_bytes().to_vec()),
        Metadata::Vec3d(v) => ("vec3d", v.iter().flat_map(|x| x.to_le_bytes()).collect()),
        Metadata::Vec3i(v) => ("vec3i", v.iter().flat_map(|x| x.to_le_bytes()).collect()),
    }
}
