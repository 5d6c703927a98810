//! Properties of an object: names, types, and the first sample of each.

use super::bad;
use super::ogawa::{Archive, Group};
use crate::error::GroomReadError;

/// Bytes of the key, a hash, before each sample's values.
const KEY_BYTES: usize = 16;

/// Bytes of hashes behind the names of an object's children.
const HASHES_BYTES: usize = 32;

/// An index of this value says that metadata stands here, and not in the archive's list.
const METADATA_HERE: u8 = 0xff;

/// Some properties under one name: a group of their values, their headers last.
pub(super) struct Compound {
    group: Group,
    headers: Vec<Header>,
}

/// What a property is.
struct Header {
    name: String,
    kind: Kind,
    /// Type of a number in it, as Alembic counts types.
    pod: u32,
    n_samples: u32,
    /// Whether a later sample differs from the first.
    changes: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Compound,
    Scalar,
    Array,
}

/// A property's first sample.
pub(super) struct Values {
    pub(super) numbers: Vec<f64>,
    /// Whether a later sample differs.
    pub(super) changes: bool,
}

impl Compound {
    pub(super) fn read(
        archive: &Archive<'_>,
        parent: &Group,
        index: usize,
        path: &str,
    ) -> Result<Self, GroomReadError> {
        let group = parent.group(archive, index)?;
        let last = group.n_children().saturating_sub(1);
        let headers = if group.n_children() == 0 { &[] } else { group.data(archive, last)? };
        Ok(Self { headers: read_headers(headers, path)?, group })
    }

    /// The compound of this name in this one.
    pub(super) fn compound(
        &self,
        archive: &Archive<'_>,
        name: &str,
        path: &str,
    ) -> Result<Option<Self>, GroomReadError> {
        let is_it = |h: &Header| h.name == name && h.kind == Kind::Compound;
        let index = self.headers.iter().position(is_it);
        index.map(|index| Self::read(archive, &self.group, index, path)).transpose()
    }

    /// The numbers of this name: a scalar's, an array's, or the values of an indexed array, each where its index
    /// says.
    pub(super) fn numbers(
        &self,
        archive: &Archive<'_>,
        name: &str,
        path: &str,
    ) -> Result<Option<Values>, GroomReadError> {
        let Some(index) = self.headers.iter().position(|h| h.name == name) else { return Ok(None) };
        let header = &self.headers[index];
        if header.kind == Kind::Compound {
            let indexed = Self::read(archive, &self.group, index, path)?;
            return indexed.indexed(archive, path);
        }
        if header.n_samples == 0 {
            return Ok(None);
        }
        let samples = self.group.group(archive, index)?;
        // An array's sample is its values and its dimensions; the first sample is the first child either way.
        let data = samples.data(archive, 0)?;
        let numbers = decode(data.get(KEY_BYTES..).unwrap_or_default(), header.pod);
        let Some(numbers) = numbers else {
            return Err(bad(path, &format!("property {name} of type {}", header.pod), "numbers"));
        };
        Ok(Some(Values { numbers, changes: header.changes }))
    }

    fn indexed(&self, archive: &Archive<'_>, path: &str) -> Result<Option<Values>, GroomReadError> {
        if !self.headers.iter().any(|h| h.name == ".vals" && h.kind != Kind::Compound) {
            return Ok(None);
        }
        let Some(mut values) = self.numbers(archive, ".vals", path)? else { return Ok(None) };
        if self.headers.iter().any(|h| h.name == ".indices" && h.kind != Kind::Compound) {
            let indices = self.numbers(archive, ".indices", path)?.map_or(Vec::new(), |v| v.numbers);
            let numbers: Option<Vec<f64>> =
                indices.iter().map(|index| values.numbers.get(*index as usize).copied()).collect();
            let Some(numbers) = numbers else {
                return Err(bad(path, "an index past the last value", "one below their number"));
            };
            values.numbers = numbers;
        }
        Ok(Some(values))
    }
}

/// Numbers of Alembic's type `pod`; `None` for text. Bytes that make no whole number are left over.
fn decode(bytes: &[u8], pod: u32) -> Option<Vec<f64>> {
    let size = match pod {
        0..=2 => 1,
        3 | 4 | 9 => 2,
        5 | 6 | 10 => 4,
        7 | 8 | 11 => 8,
        _ => return None,
    };
    let number = |b: &[u8]| {
        let mut raw = [0; 8];
        raw[..size].copy_from_slice(b);
        let word = u64::from_le_bytes(raw);
        match pod {
            2 => f64::from(word as i8),
            4 => f64::from(word as i16),
            6 => f64::from(word as i32),
            8 => word as i64 as f64,
            // Half-precision numbers are colors and the like, never positions or counts.
            9 => f64::NAN,
            10 => f64::from(f32::from_bits(word as u32)),
            11 => f64::from_bits(word),
            _ => word as f64,
        }
    };
    Some(bytes.chunks_exact(size).map(number).collect())
}

/// Names of an object's children, from the data that ends its group.
pub(super) fn object_names(
    archive: &Archive<'_>,
    object: &Group,
    path: &str,
) -> Result<Vec<String>, GroomReadError> {
    let Some(last) = object.n_children().checked_sub(1).filter(|last| !object.has_group(*last)) else {
        return Ok(Vec::new());
    };
    let data = object.data(archive, last)?;
    let mut words = Words { bytes: &data[..data.len().saturating_sub(HASHES_BYTES)], at: 0, path };
    let mut names = Vec::new();
    while words.is_more() {
        let n = words.uint(4)?;
        names.push(words.text(n)?);
        if words.uint(1)? == u32::from(METADATA_HERE) {
            let n = words.uint(4)?;
            words.text(n)?;
        }
    }
    Ok(names)
}

/// Headers of a compound's properties. A word of bits says which numbers follow and how wide they are.
fn read_headers(bytes: &[u8], path: &str) -> Result<Vec<Header>, GroomReadError> {
    let mut words = Words { bytes, at: 0, path };
    let mut headers = Vec::new();
    while words.is_more() {
        let bits = words.uint(4)?;
        let kind = match bits & 0b11 {
            0 => Kind::Compound,
            1 => Kind::Scalar,
            _ => Kind::Array,
        };
        let width = 1 << (bits >> 2 & 0b11);
        let mut n_samples = 0;
        let mut changes = false;
        if kind != Kind::Compound {
            n_samples = words.uint(width)?;
            changes = n_samples > 1;
            if bits & 0x200 != 0 {
                changes &= words.uint(width)? > 0;
                words.uint(width)?;
            } else if bits & 0x800 != 0 {
                changes = false;
            }
            if bits & 0x100 != 0 {
                words.uint(width)?;
            }
        }
        let n = words.uint(width)?;
        let name = words.text(n)?;
        if bits >> 20 & 0xff == u32::from(METADATA_HERE) {
            let n = words.uint(width)?;
            words.text(n)?;
        }
        headers.push(Header { name, kind, pod: bits >> 4 & 0xf, n_samples, changes });
    }
    Ok(headers)
}

/// Numbers and names, one after the other.
struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    path: &'a str,
}

impl Words<'_> {
    fn is_more(&self) -> bool {
        self.at < self.bytes.len()
    }

    fn take(&mut self, n: usize) -> Result<&[u8], GroomReadError> {
        let taken = self.at.checked_add(n).and_then(|end| self.bytes.get(self.at..end));
        self.at = self.at.saturating_add(n);
        taken.ok_or_else(|| bad(self.path, "the end of its headers", &format!("{n} more bytes")))
    }

    /// A number of 1, 2 or 4 bytes.
    fn uint(&mut self, width: usize) -> Result<u32, GroomReadError> {
        let mut raw = [0; 4];
        if width > raw.len() {
            return Err(bad(self.path, "a header with numbers of 8 bytes", "1, 2 or 4"));
        }
        raw[..width].copy_from_slice(self.take(width)?);
        Ok(u32::from_le_bytes(raw))
    }

    fn text(&mut self, n: u32) -> Result<String, GroomReadError> {
        Ok(String::from_utf8_lossy(self.take(n as usize)?).into_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An array of 3 x f32 with one sample, its name in one byte; a scalar with its own metadata and two samples.
    #[test]
    fn headers_by_hand() {
        let mut bytes = (2_u32 | 10 << 4 | 3 << 12 | 1 << 20).to_le_bytes().to_vec();
        bytes.extend([1, 1, b'P']);
        bytes.extend((1_u32 | 1 << 2 | 1 << 4 | 0x100 | 0xff << 20).to_le_bytes());
        bytes.extend([2, 0, 7, 0, 2, 0, b'a', b'b', 1, 0, b'm']);
        let headers = read_headers(&bytes, "/").unwrap();
        assert_eq!((headers[0].name.as_str(), headers[0].pod, headers[0].n_samples), ("P", 10, 1));
        assert!(headers[0].kind == Kind::Array && !headers[0].changes);
        assert_eq!((headers[1].name.as_str(), headers[1].pod, headers[1].n_samples), ("ab", 1, 2));
        assert!(headers[1].kind == Kind::Scalar && headers[1].changes);
        for len in (1..bytes.len()).filter(|len| *len != 7) {
            assert!(read_headers(&bytes[..len], "/").is_err(), "{len}");
        }
    }

    #[test]
    fn numbers_of_every_type() {
        assert_eq!(decode(&[0xfe], 2).unwrap(), [-2.0]);
        assert_eq!(decode(&[1, 0xff, 0], 4).unwrap(), [-255.0]);
        assert_eq!(decode(&2.5_f32.to_le_bytes(), 10).unwrap(), [2.5]);
        assert_eq!(decode(&2.5_f64.to_le_bytes(), 11).unwrap(), [2.5]);
        assert_eq!(decode(b"text", 12), None);
    }
}
