//! The formats, and which one some bytes are in.

mod alembic;
mod curve;
mod curves;
mod hair;
mod json;
mod ply;
mod usc;
mod usda;

use std::fmt;

use serde::Serialize;

use crate::error::GroomReadError;
use crate::raw::RawGroom;

/// The format of a groom file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum GroomFormat {
    /// Tousle's own JSON: meters, head axes, properties.
    Json,
    /// Cem Yuksel's `.hair`.
    Hair,
    /// USC-HairSalon's `.data`.
    Data,
    /// `.data` with seven numbers a point, the first three its position.
    Bin,
    /// PLY with vertices and a `strand` element.
    Ply,
    /// USD's text form.
    Usda,
    /// Alembic in an Ogawa container.
    Alembic,
}

impl GroomFormat {
    /// The format's name in files and reports: `json`, `hair`, `data`, `bin`, `ply`, `usda`, `alembic`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Json => "json",
            Self::Hair => "hair",
            Self::Data => "data",
            Self::Bin => "bin",
            Self::Ply => "ply",
            Self::Usda => "usda",
            Self::Alembic => "alembic",
        }
    }
}

impl fmt::Display for GroomFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Json => f.write_str("JSON"),
            Self::Alembic => f.write_str("Alembic"),
            other => write!(f, ".{}", other.name()),
        }
    }
}

/// Tells the format from the bytes and reads curves, in the file's own axes and unit. All numbers are finite.
pub(crate) fn read_raw(bytes: &[u8]) -> Result<(GroomFormat, RawGroom), GroomReadError> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let format = if bytes.starts_with(b"HAIR") {
        GroomFormat::Hair
    } else if text.starts_with(b"#usda") {
        GroomFormat::Usda
    } else if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r\n") {
        GroomFormat::Ply
    } else if bytes.starts_with(b"Ogawa") {
        GroomFormat::Alembic
    } else if let Some(error) = known_but_not_read(bytes) {
        return Err(error);
    } else if let Some(format) = usc::recognize(bytes) {
        // Before JSON: a count of 0x7b or 0x5b starts like an object or a list, and only .data ends where it says.
        format
    } else if text.trim_ascii_start().starts_with(b"{") || text.trim_ascii_start().starts_with(b"[") {
        GroomFormat::Json
    } else {
        let start = String::from_utf8_lossy(&bytes[..bytes.len().min(16)]).into_owned();
        return Err(GroomReadError::UnknownFormat { start });
    };
    let raw = match format {
        GroomFormat::Json => json::read(text),
        GroomFormat::Hair => hair::read(bytes),
        GroomFormat::Data | GroomFormat::Bin => usc::read(bytes, format),
        GroomFormat::Ply => ply::read(bytes),
        GroomFormat::Usda => usda::read(text),
        GroomFormat::Alembic => alembic::read(bytes),
    }?;
    check_finite(&raw, format)?;
    Ok((format, raw))
}

fn known_but_not_read(bytes: &[u8]) -> Option<GroomReadError> {
    let (found, advice) = if bytes.starts_with(b"PXR-USDC") {
        ("binary USD (usdc)", "write it as text with `usdcat FILE -o FILE.usda`")
    } else if bytes.starts_with(b"PK\x03\x04") {
        ("a zip archive (.usdz? .npz?)", "of a .usdz: unpack it and write its layer as text with `usdcat`")
    } else if bytes.starts_with(b"\x89HDF") {
        ("Alembic in HDF5", "write it again with a newer Alembic (Ogawa), or export the curves as .usda")
    } else {
        return None;
    };
    Some(GroomReadError::Unsupported { found, advice })
}

fn check_finite(raw: &RawGroom, format: GroomFormat) -> Result<(), GroomReadError> {
    for (k, strand) in raw.strands.iter().enumerate() {
        if let Some(point) = strand.points.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
            let name = strand.name.as_ref().map_or_else(|| format!("{}", k + 1), Clone::clone);
            return Err(GroomReadError::Malformed {
                format,
                place: format!("strand {name}, point {point}"),
                found: format!("{:?}", strand.points[point].as_slice()),
                expected: "finite numbers".to_owned(),
            });
        }
    }
    Ok(())
}

/// Little-endian numbers out of bytes whose length was checked.
fn f32_at(bytes: &[u8], at: usize) -> f64 {
    f64::from(f32::from_bits(u32_at(bytes, at)))
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}
