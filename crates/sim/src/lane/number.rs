//! What differs between single and double precision.

/// A number of one strand.
pub(super) trait Number: Copy {
    /// The coefficients of two steps from a guess of x^(−½) to the root, and of two to x^(−1/6)
    /// ([`super::functions::closer`]): enough to leave a few units in the last place, and 1e-13 or 1e-7 of the latter.
    const TO_PER_SQRT: [&'static [f64]; 2];
    const TO_PER_SIXTH_ROOT: [&'static [f64]; 2];

    /// The nearest to a number in double precision.
    fn nearest(value: f64) -> Self;

    /// One over the square root, within 3.5 %: half the exponent's bits, taken from what they are at 1.
    fn guess_per_sqrt(self) -> Self;

    /// One over the sixth root, within 3.5 %, from 1e-24 to 1e20: a sixth of the exponent's bits likewise.
    fn guess_per_sixth_root(self) -> Self;

    /// 2 to the power of a whole number from −120 to 120: the exponent's bits are the number plus their middle. Added to
    /// the first number whose last bit is a whole, it stands in the last bits, and is shifted from there.
    fn exp2_whole(self) -> Self;
}

/// Coefficients of hᵏ in (1 − h)^(−½) and (1 − h)^(−1/6), the first left out.
const SQUARE: [f64; 4] = [0.5, 3.0 / 8.0, 5.0 / 16.0, 35.0 / 128.0];
const SIXTH: [f64; 4] = [1.0 / 6.0, 7.0 / 72.0, 91.0 / 1296.0, 1729.0 / 31104.0];

/// The guesses work on the first 20 bits, in which a sixth is 683/4096: one short product. The constants put the error to
/// either side alike.
impl Number for f64 {
    const TO_PER_SQRT: [&'static [f64]; 2] = [&SQUARE, SQUARE.split_at(2).0];
    const TO_PER_SIXTH_ROOT: [&'static [f64]; 2] = [&SIXTH, SIXTH.split_at(2).0];

    #[inline(always)]
    fn nearest(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn guess_per_sqrt(self) -> Self {
        Self::from_bits(0x5fe6_e353_f7ce_d917_u64.wrapping_sub(self.to_bits() >> 1))
    }

    #[inline(always)]
    fn guess_per_sixth_root(self) -> Self {
        Self::from_bits(0x4a98_5f3d_70a3_d70b_u64.wrapping_sub(((self.to_bits() >> 44) * 683) << 32))
    }

    #[inline(always)]
    fn exp2_whole(self) -> Self {
        Self::from_bits((self + (4_503_599_627_370_496.0 + 1023.0)).to_bits() << 52)
    }
}

impl Number for f32 {
    const TO_PER_SQRT: [&'static [f64]; 2] = [SQUARE.split_at(2).0, SQUARE.split_at(1).0];
    const TO_PER_SIXTH_ROOT: [&'static [f64]; 2] = [SIXTH.split_at(3).0, SIXTH.split_at(1).0];

    #[inline(always)]
    fn nearest(value: f64) -> Self {
        value as Self
    }

    #[inline(always)]
    fn guess_per_sqrt(self) -> Self {
        Self::from_bits(0x5f37_1aa0_u32.wrapping_sub(self.to_bits() >> 1))
    }

    #[inline(always)]
    fn guess_per_sixth_root(self) -> Self {
        Self::from_bits(0x4a0e_f9ec_u32.wrapping_sub((self.to_bits() >> 12).wrapping_mul(683)))
    }

    #[inline(always)]
    fn exp2_whole(self) -> Self {
        Self::from_bits((self + (8_388_608.0 + 127.0)).to_bits() << 23)
    }
}
