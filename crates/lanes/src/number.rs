//! What differs between single and double precision.

/// A number of one strand.
pub(crate) trait Number: Copy {
    /// The bits of one.
    type Bits: Copy;

    /// The coefficients of two steps from a guess of x^(−½) to the root, and of two to x^(−1/6)
    /// ([`crate::functions::closer`]): enough to leave a few units in the last place, and 1e-13 or 1e-7 of the latter.
    const TO_PER_SQRT: [&'static [f64]; 2];
    const TO_PER_SIXTH_ROOT: [&'static [f64]; 2];

    /// The guess of x^(−½), within 3.5 %: half the bits of x, of which the exponent counts, taken from these, which put
    /// the error to either side alike.
    const PER_SQRT_AT_1: Self::Bits;

    /// The guess of x^(−1/6), within 3.5 % from 1e-24 to 1e20: a sixth of the bits likewise.
    const PER_SIXTH_ROOT_AT_1: Self::Bits;

    /// A sixth, as a share of 4096: times the first 20 bits a short product, whose last 12 bits are a fraction.
    const SIXTH: u32 = 683;

    /// How many bits there are below the first 20, and below the first 32.
    const BELOW_FIRST_20: u8;
    const BELOW_FIRST_32: u8;

    /// From here on, half way to the next power of two, numbers are whole; added and taken away again, it rounds.
    const WHOLE_FROM_HERE: Self;

    /// The first number whose last bit is a whole, and the middle of the exponents: a whole number added to it stands in
    /// the last bits as the exponent of 2 to its power.
    const EXPONENT_FROM_HERE: Self;

    /// How many bits there are below the exponent.
    const BELOW_EXPONENT: u8;

    /// The nearest to a number in double precision.
    fn nearest(value: f64) -> Self;

    /// The nearest in single precision.
    fn single(self) -> f32;

    /// The guesses of [`Number::PER_SQRT_AT_1`] and [`Number::PER_SIXTH_ROOT_AT_1`].
    fn guess_per_sqrt(self) -> Self;
    fn guess_per_sixth_root(self) -> Self;

    /// 2 to the power of a whole number from −120 to 120.
    fn exp2_whole(self) -> Self;
}

/// Coefficients of hᵏ in (1 − h)^(−½) and (1 − h)^(−1/6), the first left out.
const SQUARE: [f64; 4] = [0.5, 3.0 / 8.0, 5.0 / 16.0, 35.0 / 128.0];
const SIXTH: [f64; 4] = [1.0 / 6.0, 7.0 / 72.0, 91.0 / 1296.0, 1729.0 / 31104.0];

macro_rules! guesses {
    ($bits:ident) => {
        #[inline(always)]
        fn guess_per_sqrt(self) -> Self {
            Self::from_bits(Self::PER_SQRT_AT_1.wrapping_sub(self.to_bits() >> 1))
        }

        #[inline(always)]
        fn guess_per_sixth_root(self) -> Self {
            let sixth = (self.to_bits() >> Self::BELOW_FIRST_20) * $bits::from(Self::SIXTH);
            Self::from_bits(Self::PER_SIXTH_ROOT_AT_1.wrapping_sub(sixth << Self::BELOW_FIRST_32))
        }

        #[inline(always)]
        fn exp2_whole(self) -> Self {
            Self::from_bits((self + Self::EXPONENT_FROM_HERE).to_bits() << Self::BELOW_EXPONENT)
        }
    };
}

impl Number for f64 {
    type Bits = u64;

    const TO_PER_SQRT: [&'static [f64]; 2] = [&SQUARE, SQUARE.split_at(2).0];
    const TO_PER_SIXTH_ROOT: [&'static [f64]; 2] = [&SIXTH, SIXTH.split_at(2).0];
    const PER_SQRT_AT_1: u64 = 0x5fe6_e353_f7ce_d917;
    const PER_SIXTH_ROOT_AT_1: u64 = 0x4a98_5f3d_70a3_d70b;
    const BELOW_FIRST_20: u8 = 44;
    const BELOW_FIRST_32: u8 = 32;
    const WHOLE_FROM_HERE: Self = 6_755_399_441_055_744.0;
    const EXPONENT_FROM_HERE: Self = 4_503_599_627_370_496.0 + 1023.0;
    const BELOW_EXPONENT: u8 = 52;

    #[inline(always)]
    fn nearest(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn single(self) -> f32 {
        self as f32
    }

    guesses!(u64);
}

impl Number for f32 {
    type Bits = u32;

    const TO_PER_SQRT: [&'static [f64]; 2] = [SQUARE.split_at(2).0, SQUARE.split_at(1).0];
    const TO_PER_SIXTH_ROOT: [&'static [f64]; 2] = [SIXTH.split_at(3).0, SIXTH.split_at(1).0];
    const PER_SQRT_AT_1: u32 = 0x5f37_1aa0;
    const PER_SIXTH_ROOT_AT_1: u32 = 0x4a0e_f9ec;
    const BELOW_FIRST_20: u8 = 12;
    const BELOW_FIRST_32: u8 = 0;
    const WHOLE_FROM_HERE: Self = 12_582_912.0;
    const EXPONENT_FROM_HERE: Self = 8_388_608.0 + 127.0;
    const BELOW_EXPONENT: u8 = 23;

    #[inline(always)]
    fn nearest(value: f64) -> Self {
        value as Self
    }

    #[inline(always)]
    fn single(self) -> f32 {
        self
    }

    guesses!(u32);
}
