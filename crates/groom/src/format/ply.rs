//! PLY with strands: an element `vertex` with `x`, `y`, `z`, and an element `strand` with `nsegs`, segments of one
//! strand after the other, each of one vertex more. `CT2Hair` writes hair this way.
//!
//! Source: Greg Turk, "The PLY polygon file format", 1994, for the container.

use tousle_core::Vec3;

use super::GroomFormat;
use crate::error::GroomReadError;
use crate::raw::RawGroom;

#[derive(Clone, Copy, PartialEq)]
enum Encoding {
    Ascii,
    Little,
    Big,
}

#[derive(Clone, Copy)]
enum Scalar {
    Int(usize),
    Uint(usize),
    Float(usize),
}

struct Property {
    name: String,
    /// The type of a list's length, if it is a list.
    list: Option<Scalar>,
    value: Scalar,
}

struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

struct Header {
    encoding: Encoding,
    elements: Vec<Element>,
    /// Where the elements' values start.
    end: usize,
}

pub(super) fn read(bytes: &[u8]) -> Result<RawGroom, GroomReadError> {
    let header = read_header(bytes)?;
    let mut values = Values { bytes, at: header.end, encoding: header.encoding };
    let mut vertices: Vec<Vec3> = Vec::new();
    let mut counts: Vec<usize> = Vec::new();
    for element in &header.elements {
        for _ in 0..element.count {
            match element.name.as_str() {
                "vertex" => vertices.push(vertex(&mut values, element)?),
                "strand" => counts.push(segments(&mut values, element)? + 1),
                _ => values.row(element, |_, _| ())?,
            }
            // An element whose rows have no bytes would cost a count nothing.
            if element.properties.is_empty() {
                return Err(bad(
                    "the header",
                    format!("element {} without properties", element.name),
                    "some",
                ));
            }
        }
    }
    let mut at = 0_usize;
    let mut curves = Vec::new();
    for n in counts {
        let Some(points) = vertices.get(at..at.saturating_add(n)) else {
            let found = format!("strands of more than {at} vertices");
            return Err(bad("the strands", found, &format!("at most the file's {}", vertices.len())));
        };
        curves.push(points.to_vec());
        at += n;
    }
    if curves.is_empty() {
        return Err(bad("the header", "no strands".to_owned(), "an element `strand` with `nsegs`"));
    }
    let mut raw = RawGroom::of_curves(curves);
    if at < vertices.len() {
        raw.warnings.push(format!("{} vertices belong to no strand and were left out", vertices.len() - at));
    }
    Ok(raw)
}

fn vertex(values: &mut Values<'_>, element: &Element) -> Result<Vec3, GroomReadError> {
    let mut point = Vec3::repeat(f64::NAN);
    values.row(element, |name, value| match name {
        "x" => point.x = value,
        "y" => point.y = value,
        "z" => point.z = value,
        _ => (),
    })?;
    Ok(point)
}

fn segments(values: &mut Values<'_>, element: &Element) -> Result<usize, GroomReadError> {
    let mut n = f64::NAN;
    values.row(element, |name, value| {
        if name == "nsegs" {
            n = value;
        }
    })?;
    if (0.0..=f64::from(u32::MAX)).contains(&n) {
        Ok(n as usize)
    } else {
        Err(bad("element strand", format!("nsegs {n}"), "a count"))
    }
}

fn read_header(bytes: &[u8]) -> Result<Header, GroomReadError> {
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut at = 0_usize;
    for line in bytes.split_inclusive(|b| *b == b'\n').take(1000) {
        at += line.len();
        let line = str::from_utf8(line).map_err(|_| bad("the header", "bytes".to_owned(), "text"))?;
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            ["format", "ascii", _] => encoding = Some(Encoding::Ascii),
            ["format", "binary_little_endian", _] => encoding = Some(Encoding::Little),
            ["format", "binary_big_endian", _] => encoding = Some(Encoding::Big),
            ["element", name, count] => {
                let count =
                    count.parse().map_err(|_| bad("the header", line.trim().to_owned(), "a count"))?;
                elements.push(Element { name: (*name).to_owned(), count, properties: Vec::new() });
            }
            ["property", rest @ ..] => {
                let property =
                    property(rest).ok_or_else(|| bad("the header", line.trim().to_owned(), "a property"))?;
                let Some(element) = elements.last_mut() else {
                    return Err(bad("the header", line.trim().to_owned(), "an element first"));
                };
                element.properties.push(property);
            }
            ["end_header"] => {
                let Some(encoding) = encoding else {
                    return Err(bad("the header", "no format".to_owned(), "a line `format ascii 1.0` or so"));
                };
                return Ok(Header { encoding, elements, end: at });
            }
            _ => (),
        }
    }
    Err(bad("the header", "no end".to_owned(), "a line `end_header`"))
}

fn property(words: &[&str]) -> Option<Property> {
    match words {
        ["list", length, value, name] => {
            Some(Property { name: (*name).to_owned(), list: Some(scalar(length)?), value: scalar(value)? })
        }
        [value, name] => Some(Property { name: (*name).to_owned(), list: None, value: scalar(value)? }),
        _ => None,
    }
}

fn scalar(name: &str) -> Option<Scalar> {
    Some(match name {
        "char" | "int8" => Scalar::Int(1),
        "short" | "int16" => Scalar::Int(2),
        "int" | "int32" => Scalar::Int(4),
        "uchar" | "uint8" => Scalar::Uint(1),
        "ushort" | "uint16" => Scalar::Uint(2),
        "uint" | "uint32" => Scalar::Uint(4),
        "float" | "float32" => Scalar::Float(4),
        "double" | "float64" => Scalar::Float(8),
        _ => return None,
    })
}

/// The values behind the header, one after the other.
struct Values<'a> {
    bytes: &'a [u8],
    at: usize,
    encoding: Encoding,
}

impl Values<'_> {
    /// Reads one row of an element; `visit` gets each plain property's name and value.
    fn row(&mut self, element: &Element, mut visit: impl FnMut(&str, f64)) -> Result<(), GroomReadError> {
        for property in &element.properties {
            match property.list {
                None => visit(&property.name, self.next(property.value)?),
                Some(length) => {
                    let n = self.next(length)?;
                    for _ in 0..n.max(0.0) as usize {
                        self.next(property.value)?;
                    }
                }
            }
        }
        Ok(())
    }

    fn next(&mut self, scalar: Scalar) -> Result<f64, GroomReadError> {
        let (Scalar::Int(size) | Scalar::Uint(size) | Scalar::Float(size)) = scalar;
        if self.encoding == Encoding::Ascii {
            return self.next_word();
        }
        let Some(bytes) = self.bytes.get(self.at..self.at + size) else {
            return Err(bad(&format!("byte {}", self.at), "the end of the file".to_owned(), "a value"));
        };
        self.at += size;
        let mut raw = [0; 8];
        raw[..size].copy_from_slice(bytes);
        if self.encoding == Encoding::Big {
            raw[..size].reverse();
        }
        let word = u64::from_le_bytes(raw);
        Ok(match scalar {
            Scalar::Int(1) => f64::from(word as i8),
            Scalar::Int(2) => f64::from(word as i16),
            Scalar::Int(_) => f64::from(word as i32),
            Scalar::Uint(_) => word as f64,
            Scalar::Float(4) => f64::from(f32::from_bits(word as u32)),
            Scalar::Float(_) => f64::from_bits(word),
        })
    }

    fn next_word(&mut self) -> Result<f64, GroomReadError> {
        let rest = &self.bytes[self.at..];
        let start = rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len());
        let word = rest[start..].split(u8::is_ascii_whitespace).next().unwrap_or_default();
        let place = self.at + start;
        self.at = place + word.len();
        let text = String::from_utf8_lossy(word);
        text.parse().map_err(|_| bad(&format!("byte {place}"), format!("{text:?}"), "a number"))
    }
}

fn bad(place: &str, found: String, expected: &str) -> GroomReadError {
    let (place, expected) = (place.to_owned(), expected.to_owned());
    GroomReadError::Malformed { format: GroomFormat::Ply, place, found, expected }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "element vertex 3\nproperty float x\nproperty double y\nproperty short z\n\
                          property list uchar int skipped\nelement strand 2\nproperty ushort nsegs\nend_header\n";

    fn binary(big: bool) -> Vec<u8> {
        let name = if big { "big" } else { "little" };
        let mut bytes = format!("ply\nformat binary_{name}_endian 1.0\ncomment x\n{HEADER}").into_bytes();
        let mut put = |mut b: Vec<u8>| {
            if big {
                b.reverse();
            }
            bytes.extend(b);
        };
        for k in 0..3_u8 {
            put(f32::from(k).to_le_bytes().to_vec());
            put(0.25_f64.to_le_bytes().to_vec());
            put((-i16::from(k)).to_le_bytes().to_vec());
            put(vec![k]);
            (0..k).for_each(|_| put(vec![9; 4]));
        }
        put(1_u16.to_le_bytes().to_vec());
        put(0_u16.to_le_bytes().to_vec());
        bytes
    }

    #[test]
    fn every_encoding() {
        let ascii =
            format!("ply\r\nformat ascii 1.0\n{HEADER}0 .25 0 0\n1 0.25 -1 1 9\n2 2.5e-1 -2 2 9 9\n1\n0\n");
        for bytes in [binary(false), binary(true), ascii.into_bytes()] {
            let raw = read(&bytes).unwrap();
            let points: Vec<_> = raw.strands.iter().map(|s| s.points.as_slice()).collect();
            let [a, b, c] = [0.0, 1.0, 2.0].map(|x| Vec3::new(x, 0.25, -x));
            assert_eq!(points, [&[a, b][..], &[c]]);
            for len in 0..bytes.len() - 2 {
                assert!(read(&bytes[..len]).is_err(), "{len}");
            }
        }
    }

    #[test]
    fn what_is_no_hair_says_why() {
        for (text, says) in [
            ("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n", "no strands"),
            (
                "ply\nformat ascii 1.0\nelement strand 1\nproperty int nsegs\nend_header\n3\n",
                "at most the file's 0",
            ),
            ("ply\nformat ascii 1.0\nelement strand 1\nproperty int nsegs\nend_header\n-3\n", "nsegs -3"),
            ("ply\nformat ascii 1.0\nelement strand 1\nproperty int other\nend_header\n3\n", "nsegs NaN"),
            ("ply\nformat ascii 1.0\nelement vertex 99999999999\nend_header\n", "without properties"),
            ("ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nend_header\n1", "byte 77"),
            ("ply\nproperty float x\n", "an element first"),
            ("ply\nelement vertex -1\n", "a count"),
            ("ply\nend_header\n", "no format"),
        ] {
            let error = read(text.as_bytes()).unwrap_err().to_string();
            assert!(error.contains(says), "{says}: {error}");
        }
    }
}
