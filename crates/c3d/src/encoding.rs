/// The machine whose numbers a file is written in. It holds for header, parameters and data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Processor {
    /// Little-endian integers, IEEE 754 floats (number 84 in files).
    #[default]
    Intel,
    /// Little-endian integers, VAX F floats: words swapped, exponent bias 129 (number 85).
    Dec,
    /// Big-endian integers and IEEE 754 floats, SGI and MIPS (number 86).
    Mips,
}

/// How samples are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Storage {
    /// 16-bit integers; coordinates are multiplied by the scale.
    Int16,
    /// 32-bit floats; coordinates are in the file's unit already.
    #[default]
    Float32,
}

impl Processor {
    /// The processor of the number that stands in the parameter section's fourth byte.
    pub fn from_number(number: u8) -> Option<Self> {
        match number {
            84 => Some(Self::Intel),
            85 => Some(Self::Dec),
            86 => Some(Self::Mips),
            _ => None,
        }
    }

    /// The number for the parameter section's fourth byte.
    pub fn number(self) -> u8 {
        match self {
            Self::Intel => 84,
            Self::Dec => 85,
            Self::Mips => 86,
        }
    }

    pub(crate) fn read_u16(self, bytes: [u8; 2]) -> u16 {
        match self {
            Self::Intel | Self::Dec => u16::from_le_bytes(bytes),
            Self::Mips => u16::from_be_bytes(bytes),
        }
    }

    pub(crate) fn read_i16(self, bytes: [u8; 2]) -> i16 {
        self.read_u16(bytes).cast_signed()
    }

    pub(crate) fn read_f32(self, bytes: [u8; 4]) -> f32 {
        match self {
            Self::Intel => f32::from_le_bytes(bytes),
            Self::Dec => f32_from_dec(bytes),
            Self::Mips => f32::from_be_bytes(bytes),
        }
    }

    pub(crate) fn write_u16(self, value: u16) -> [u8; 2] {
        match self {
            Self::Intel | Self::Dec => value.to_le_bytes(),
            Self::Mips => value.to_be_bytes(),
        }
    }

    /// Whether a float of this processor can be this number: finite, and for a VAX below 2^127.
    pub(crate) fn holds(self, value: f32) -> bool {
        let limit = if self == Self::Dec { f32::from_bits(254 << 23) } else { f32::INFINITY };
        value.abs() < limit
    }

    pub(crate) fn write_f32(self, value: f32) -> [u8; 4] {
        match self {
            Self::Intel => value.to_le_bytes(),
            Self::Dec => dec_from_f32(value),
            Self::Mips => value.to_be_bytes(),
        }
    }
}

impl Storage {
    /// Bytes of one word of data.
    pub fn word_bytes(self) -> u64 {
        match self {
            Self::Int16 => 2,
            Self::Float32 => 4,
        }
    }
}

/// A VAX F float: the two 16-bit words of an IEEE float swapped, 0.1f times two to the exponent less 128, so
/// that it reads as four times the number in IEEE terms. Exponent 0 is zero whatever the fraction says, or,
/// with the sign set, a reserved operand, which we give as NaN.
/// Source: VAX Architecture Reference Manual, "`F_floating` data".
#[inline]
fn f32_from_dec([b0, b1, b2, b3]: [u8; 4]) -> f32 {
    let bits = u32::from_le_bytes([b2, b3, b0, b1]);
    let exponent = (bits >> 23) & 0xff;
    if exponent > 2 {
        // Subtracting from the exponent and not dividing the float: exponents 254 and 255 are numbers here.
        f32::from_bits(bits - (2 << 23))
    } else if exponent > 0 {
        let sign = if bits >> 31 == 1 { -1.0 } else { 1.0 };
        let fraction = f64::from((bits & 0x7f_ffff) | 0x80_0000);
        // Two to the -151 or -150 times 24 bits of fraction: exact in f64, and rounded once.
        (sign * fraction * f64::from(exponent) * f64::from_bits((1023 - 151) << 52)) as f32
    } else if bits >> 31 == 1 {
        f32::NAN
    } else {
        0.0
    }
}

/// The inverse of [`f32_from_dec`] for what a VAX float can hold: too small a number becomes zero, NaN, infinity
/// and numbers of 2^127 or more become the reserved operand.
fn dec_from_f32(value: f32) -> [u8; 4] {
    let bits = value.to_bits();
    let sign = bits & 0x8000_0000;
    let exponent = (bits >> 23) & 0xff;
    let vax = match exponent {
        0 => small_dec_from_f32(bits & 0x7f_ffff, sign),
        1..=253 => bits + (2 << 23),
        _ => 0x8000_0000,
    };
    let [b2, b3, b0, b1] = vax.to_le_bytes();
    [b0, b1, b2, b3]
}

/// IEEE denormals of 2^-128 and more are normal VAX floats.
fn small_dec_from_f32(fraction: u32, sign: u32) -> u32 {
    match fraction {
        0x40_0000.. => sign | (2 << 23) | ((fraction << 1) & 0x7f_ffff),
        0x20_0000.. => sign | (1 << 23) | ((fraction << 2) & 0x7f_ffff),
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// VAX F: the word with sign and exponent first; 1.0 is 0.1 binary times 2^1, so its exponent is 129.
    #[test]
    fn vax_floats() {
        let check = |bytes: [u8; 4], value: f32| {
            assert_eq!(Processor::Dec.read_f32(bytes), value);
            assert_eq!(Processor::Dec.write_f32(value), bytes);
        };
        check([0x80, 0x40, 0x00, 0x00], 1.0);
        check([0x80, 0xc0, 0x00, 0x00], -1.0);
        check([0x60, 0x41, 0x00, 0x00], 3.5);
        check([0xf6, 0x43, 0x79, 0xe9], 123.456);
        check([0x00, 0x00, 0x00, 0x00], 0.0);
        // The largest, and the smallest, which is a denormal of IEEE 754.
        check([0xff, 0x7f, 0xff, 0xff], 1.701_411_7e38);
        check([0x80, 0x00, 0x00, 0x00], f32::from_bits(0x20_0000));
        check([0x00, 0x01, 0x00, 0x00], f32::from_bits(0x40_0000));
    }

    #[test]
    fn what_a_vax_float_is_not() {
        assert!(Processor::Dec.read_f32([0x00, 0x80, 0x00, 0x00]).is_nan(), "reserved operand");
        assert_eq!(Processor::Dec.read_f32([0x7f, 0x00, 0xff, 0xff]), 0.0, "exponent 0 is zero");
        assert_eq!(Processor::Dec.write_f32(1e-45), [0; 4], "too small");
        assert!(Processor::Dec.holds(1.701_411_7e38));
        assert!(!Processor::Dec.holds(1.701_411_8e38));
        assert!(!Processor::Dec.holds(f32::NAN));
    }

    #[test]
    fn byte_orders() {
        assert_eq!(Processor::Intel.read_u16([0x39, 0x30]), 12345);
        assert_eq!(Processor::Dec.read_u16([0x39, 0x30]), 12345);
        assert_eq!(Processor::Mips.read_u16([0x30, 0x39]), 12345);
        assert_eq!(Processor::Mips.read_f32([0x3f, 0x80, 0x00, 0x00]), 1.0);
        assert_eq!(Processor::Intel.read_f32([0x00, 0x00, 0x80, 0x3f]), 1.0);
    }
}
