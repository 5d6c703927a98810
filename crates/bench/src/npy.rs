//! The arrays of the truth beside the captures: `.npz` as `numpy.savez_compressed` writes it.
//!
//! Only what those files hold is read: little-endian numbers in C order. `tousle-export` reads motions and
//! fields as the product's users have them; what lies here is of no use to them.

use std::io::{Cursor, Read};

/// One array.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Array {
    pub(crate) shape: Vec<usize>,
    item: Item,
    bytes: Vec<u8>,
}

/// What makes an array unusable. The caller adds the file's name.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NpyError {
    /// The archive is damaged, or a member is not there.
    #[error("array `{key}` cannot be read")]
    Zip {
        /// The array's name.
        key: String,
        /// What the archive says.
        source: zip::result::ZipError,
    },
    /// The array's bytes make no sense.
    #[error("array `{key}`: found {found}, expected {expected}")]
    Bad {
        /// The array's name.
        key: String,
        /// What is there.
        found: String,
        /// What should be.
        expected: String,
    },
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Item {
    F16,
    F32,
    F64,
    I8,
    U8,
    I32,
    I64,
}

/// The most bytes an array of a capture may have: 1 GiB.
const MAX_BYTES: u64 = 1 << 30;

/// Reads one array of an archive. `shape` gives the lengths it must have, 0 standing for any.
pub(crate) fn read_array(npz: &[u8], key: &str, shape: &[usize]) -> Result<Array, NpyError> {
    let zip_error = |source| NpyError::Zip { key: key.to_owned(), source };
    let mut archive = zip::ZipArchive::new(Cursor::new(npz)).map_err(zip_error)?;
    let member = archive.by_name(&format!("{key}.npy")).map_err(zip_error)?;
    let mut bytes = Vec::new();
    member.take(MAX_BYTES).read_to_end(&mut bytes).map_err(|e| zip_error(e.into()))?;
    let array = parse(&bytes).map_err(|(found, expected)| NpyError::Bad {
        key: key.to_owned(),
        found,
        expected: expected.to_owned(),
    })?;
    let fits = array.shape.len() == shape.len()
        && array.shape.iter().zip(shape).all(|(found, expected)| *expected == 0 || found == expected);
    if !fits {
        let (found, expected) = (format!("shape {:?}", array.shape), format!("{shape:?}, 0 for any"));
        return Err(NpyError::Bad { key: key.to_owned(), found, expected });
    }
    Ok(array)
}

impl Array {
    /// The values as numbers, first axis slowest.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> + '_ {
        self.bytes.chunks_exact(self.item.size()).map(|b| self.item.number(b))
    }

    /// The values as single-precision numbers, exact for every type the captures have.
    pub(crate) fn singles(&self) -> impl Iterator<Item = f32> + '_ {
        self.numbers().map(|x| x as f32)
    }

    /// The values as vectors: the last axis must be 3.
    pub(crate) fn vectors(&self) -> Vec<[f32; 3]> {
        let flat: Vec<f32> = self.singles().collect();
        flat.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect()
    }

    /// The values as masks: everything but 0 is true.
    pub(crate) fn mask(&self) -> Vec<bool> {
        self.numbers().map(|x| x != 0.0).collect()
    }
}

/// The array in the bytes of a `.npy`, or what was found and expected.
fn parse(bytes: &[u8]) -> Result<Array, (String, &'static str)> {
    let bad = |found: &str, expected| Err((found.to_owned(), expected));
    if bytes.len() < 10 || !bytes.starts_with(b"\x93NUMPY\x01") {
        return bad("other first bytes", "a .npy of version 1");
    }
    let header_end = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let Some(header) = bytes.get(10..header_end).and_then(|h| str::from_utf8(h).ok()) else {
        return bad("a cut header", "a whole one");
    };
    if !header.contains("'fortran_order': False") {
        return bad(header.trim(), "C order");
    }
    let descr = between(header, "'descr': '", "'").unwrap_or_default();
    let Some(item) = Item::from_name(descr) else {
        return bad(descr, "a little-endian number");
    };
    let lengths = between(header, "'shape': (", ")").unwrap_or("?");
    let lengths = lengths.split(',').map(str::trim).filter(|s| !s.is_empty()).map(str::parse);
    let Ok(shape) = lengths.collect::<Result<Vec<usize>, _>>() else {
        return bad(header.trim(), "a shape");
    };
    let data = &bytes[header_end..];
    let n_bytes = shape.iter().try_fold(item.size(), |n, length| n.checked_mul(*length));
    if n_bytes != Some(data.len()) {
        return Err((format!("{} bytes for shape {shape:?}", data.len()), "one value for each place"));
    }
    Ok(Array { shape, item, bytes: data.to_vec() })
}

fn between<'a>(text: &'a str, before: &str, after: &str) -> Option<&'a str> {
    let rest = &text[text.find(before)? + before.len()..];
    Some(&rest[..rest.find(after)?])
}

impl Item {
    fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "<f2" => Self::F16,
            "<f4" => Self::F32,
            "<f8" => Self::F64,
            "|i1" => Self::I8,
            "|u1" | "|b1" => Self::U8,
            "<i4" => Self::I32,
            "<i8" => Self::I64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::F16 => 2,
            Self::F32 | Self::I32 => 4,
            Self::F64 | Self::I64 => 8,
        }
    }

    /// The number in bytes that are [`Item::size`] long.
    fn number(self, bytes: &[u8]) -> f64 {
        let mut word = [0; 8];
        word[..bytes.len()].copy_from_slice(bytes);
        let word = u64::from_le_bytes(word);
        match self {
            Self::F16 => half(word as u16),
            Self::F32 => f64::from(f32::from_bits(word as u32)),
            Self::F64 => f64::from_bits(word),
            Self::I8 => f64::from(word as i8),
            Self::U8 => word as f64,
            Self::I32 => f64::from(word as i32),
            Self::I64 => word as i64 as f64,
        }
    }
}

/// The value of a half-precision number: sign, 5 bits of exponent, 10 of fraction.
fn half(bits: u16) -> f64 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let exponent = i32::from(bits >> 10 & 0x1f);
    let fraction = f64::from(bits & 0x3ff);
    match exponent {
        0 => sign * libm::ldexp(fraction, -24),
        31 if fraction == 0.0 => sign * f64::INFINITY,
        31 => f64::NAN,
        _ => sign * libm::ldexp(1024.0 + fraction, exponent - 25),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A `.npy` of version 1 with its header padded as NumPy pads it.
    fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\0".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.bytes());
        bytes.extend(data);
        bytes
    }

    #[test]
    fn numbers_of_the_types_that_captures_have() {
        for (descr, data, expected) in [
            ("<f2", vec![0x00, 0x3c, 0x00, 0xc1], vec![1.0, -2.5]),
            ("<f4", vec![0, 0, 0x20, 0x40], vec![2.5]),
            ("|i1", vec![0xff, 0x7f], vec![-1.0, 127.0]),
            ("|u1", vec![0xff], vec![255.0]),
            ("<i4", vec![0xfe, 0xff, 0xff, 0xff], vec![-2.0]),
        ] {
            let array = parse(&npy(descr, &format!("({},)", expected.len()), &data)).unwrap();
            assert_eq!(array.numbers().collect::<Vec<_>>(), expected, "{descr}");
        }
        assert_eq!(half(0x0001), libm::ldexp(1.0, -24));
    }

    #[test]
    fn a_number_alone_has_no_axes() {
        let array = parse(&npy("<f8", "()", &1.5f64.to_le_bytes())).unwrap();
        assert_eq!(array.shape, [0; 0]);
        assert_eq!(array.numbers().next(), Some(1.5));
    }

    #[test]
    fn shapes_that_do_not_fit_the_bytes_are_refused() {
        for shape in ["(3,)", "(18446744073709551615, 2)", "(x,)"] {
            parse(&npy("|u1", shape, &[1, 2])).unwrap_err();
        }
        assert!(parse(&npy(">f4", "(1,)", &[0; 4])).unwrap_err().0.contains(">f4"));
        for cut in 0..12 {
            parse(&npy("|u1", "(2,)", &[1, 2])[..cut]).unwrap_err();
        }
    }
}
