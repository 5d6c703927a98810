//! Types of the values in a `.npy` array, and their bytes.

use std::fmt;

/// The type of one value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Dtype {
    kind: Kind,
    big_endian: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// IEEE 754 number of 2, 4 or 8 bytes.
    Float(usize),
    /// Two's complement integer of 1, 2, 4 or 8 bytes.
    Int(usize),
    /// Unsigned integer of 1, 2, 4 or 8 bytes.
    Uint(usize),
    /// One byte, 0 or 1.
    Bool,
    /// UTF-32 text of so many characters, padded with zeros.
    Text(usize),
    /// Text of so many bytes, padded with zeros.
    Bytes(usize),
}

impl Dtype {
    pub(crate) const F4: Self = Self::little(Kind::Float(4));
    pub(crate) const F8: Self = Self::little(Kind::Float(8));
    pub(crate) const I8: Self = Self::little(Kind::Int(8));
    pub(crate) const U1: Self = Self::little(Kind::Uint(1));

    const fn little(kind: Kind) -> Self {
        Self { kind, big_endian: false }
    }

    /// Text of so many characters.
    pub(crate) const fn text(n_chars: usize) -> Self {
        Self::little(Kind::Text(n_chars))
    }

    /// Reads NumPy's name of a type, `<f4`; `None` for one that is not read here.
    pub(crate) fn from_name(name: &str) -> Option<Self> {
        let (order, rest) = match name.as_bytes().first()? {
            b'<' | b'|' => (false, &name[1..]),
            b'>' => (true, &name[1..]),
            _ => (false, name),
        };
        let letter = *rest.as_bytes().first()?;
        let size: usize = rest.get(1..)?.parse().ok()?;
        let kind = match (letter, size) {
            (b'f', 2 | 4 | 8) => Kind::Float(size),
            (b'i', 1 | 2 | 4 | 8) => Kind::Int(size),
            (b'u', 1 | 2 | 4 | 8) => Kind::Uint(size),
            (b'b', 1) => Kind::Bool,
            (b'U', 0..=4096) => Kind::Text(size),
            (b'S', 0..=4096) => Kind::Bytes(size),
            _ => return None,
        };
        Some(Self { kind, big_endian: order })
    }

    /// Bytes of one value.
    pub(crate) fn size(self) -> usize {
        match self.kind {
            Kind::Float(size) | Kind::Int(size) | Kind::Uint(size) | Kind::Bytes(size) => size,
            Kind::Bool => 1,
            Kind::Text(n_chars) => 4 * n_chars,
        }
    }

    /// Whether values are numbers.
    pub(crate) fn is_number(self) -> bool {
        !matches!(self.kind, Kind::Text(_) | Kind::Bytes(_))
    }

    /// Half the distance between neighboring numbers, as a share of the number: 0 for integers.
    pub(crate) fn rounding(self) -> f64 {
        match self.kind {
            Kind::Float(2) => libm::exp2(-11.0),
            Kind::Float(4) => libm::exp2(-24.0),
            Kind::Float(_) => libm::exp2(-53.0),
            _ => 0.0,
        }
    }

    /// The number in `bytes`, which are [`Dtype::size`] long; NaN for text.
    pub(crate) fn number(self, bytes: &[u8]) -> f64 {
        let mut raw = [0; 8];
        let size = bytes.len().min(8);
        raw[..size].copy_from_slice(&bytes[..size]);
        if self.big_endian {
            raw[..size].reverse();
        }
        let word = u64::from_le_bytes(raw);
        match self.kind {
            Kind::Float(2) => half(word as u16),
            Kind::Float(4) => f64::from(f32::from_bits(word as u32)),
            Kind::Float(_) => f64::from_bits(word),
            Kind::Int(1) => f64::from(word as i8),
            Kind::Int(2) => f64::from(word as i16),
            Kind::Int(4) => f64::from(word as i32),
            Kind::Int(_) => (word as i64) as f64,
            Kind::Uint(_) | Kind::Bool => word as f64,
            Kind::Text(_) | Kind::Bytes(_) => f64::NAN,
        }
    }

    /// The text in `bytes`, up to its padding; `None` if it is not text.
    pub(crate) fn string(self, bytes: &[u8]) -> Option<String> {
        let text: String = match self.kind {
            Kind::Bytes(_) => str::from_utf8(bytes).ok()?.to_owned(),
            Kind::Text(_) => {
                let code = |c: &[u8]| {
                    let c = [c[0], c[1], c[2], c[3]];
                    char::from_u32(if self.big_endian {
                        u32::from_be_bytes(c)
                    } else {
                        u32::from_le_bytes(c)
                    })
                };
                bytes.chunks_exact(4).map(code).collect::<Option<_>>()?
            }
            _ => return None,
        };
        Some(text.trim_end_matches('\0').to_owned())
    }
}

/// The value of an IEEE 754 half-precision number.
pub(crate) fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let exponent = i32::from(bits >> 10 & 0x1f);
    let fraction = f64::from(bits & 0x3ff) / 1024.0;
    sign * match exponent {
        0 => fraction * libm::exp2(-14.0),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => libm::ldexp(1.0 + fraction, exponent - 15),
    }
}

impl fmt::Display for Dtype {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (letter, size) = match self.kind {
            Kind::Float(size) => ('f', size),
            Kind::Int(size) => ('i', size),
            Kind::Uint(size) => ('u', size),
            Kind::Bool => ('b', 1),
            Kind::Text(size) => ('U', size),
            Kind::Bytes(size) => ('S', size),
        };
        let one_byte = size == 1 && letter != 'U' || letter == 'S';
        let order = match (one_byte, self.big_endian) {
            (true, _) => '|',
            (false, false) => '<',
            (false, true) => '>',
        };
        write!(f, "{order}{letter}{size}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_every_type() {
        for (name, bytes, expected) in [
            ("<f2", &[0x00, 0x3c][..], 1.0),
            ("<f2", &[0x01, 0x80], -5.960_464_477_539_063e-8),
            ("<f2", &[0xff, 0x7b], 65504.0),
            ("<f2", &[0x00, 0x7c], f64::INFINITY),
            (">f4", &[0x40, 0x20, 0, 0], 2.5),
            ("<f8", &[0, 0, 0, 0, 0, 0, 0x04, 0x40], 2.5),
            ("|i1", &[0xfe], -2.0),
            (">i2", &[0xff, 0x00], -256.0),
            ("<i8", &[0xff; 8], -1.0),
            ("<u4", &[0xff; 4], 4_294_967_295.0),
            ("|b1", &[1], 1.0),
        ] {
            let dtype = Dtype::from_name(name).unwrap();
            assert_eq!(dtype.size(), bytes.len(), "{name}");
            assert_eq!(dtype.number(bytes), expected, "{name}");
            assert_eq!(dtype.to_string(), name);
        }
        assert!(Dtype::from_name("<f2").unwrap().number(&[1, 0x7c]).is_nan());
    }

    #[test]
    fn text_of_both_kinds() {
        assert_eq!(Dtype::from_name("|S4").unwrap().string(b"ab\0\0").unwrap(), "ab");
        assert_eq!(Dtype::from_name(">U2").unwrap().string(&[0, 0, 0, b'a', 0, 0, 0, 0]).unwrap(), "a");
        assert_eq!(Dtype::from_name("<U1").unwrap().string(&[0xff; 4]), None);
    }

    #[test]
    fn types_that_are_not_read() {
        for name in ["", "<", "|O", "<f16", "<c8", "<M8[ns]", "<f", "<U99999999", "é4"] {
            assert_eq!(Dtype::from_name(name), None, "{name}");
        }
    }
}
