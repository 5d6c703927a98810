//! IEEE 754 binary16: a sign, 5 bits of exponent, 10 of fraction.

/// Half a unit in the last place of 11 binary digits.
pub(super) const RELATIVE_ERROR: f64 = 1.0 / 2048.0;

/// Half the distance of two neighbors below 2⁻¹⁴, where the numbers lie evenly: 2⁻²⁵.
pub(super) const ABSOLUTE_ERROR: f64 = 1.0 / 33_554_432.0;

/// The bits of infinity, without sign.
pub(super) const INFINITY: u16 = 0x7c00;

/// The nearest half to a float, the even one of two; infinite from 65520 on.
pub(super) fn pack(value: f32) -> u16 {
    let sign = (value.to_bits() >> 16) as u16 & 0x8000;
    let bits = value.to_bits() & 0x7fff_ffff;
    let magnitude = if bits > 0x7f80_0000 {
        INFINITY | 0x200
    } else if bits >= 0x477f_f000 {
        INFINITY
    } else if bits < 0x3880_0000 {
        // Below 2⁻¹⁴ a half counts in steps of 2⁻²⁴; the product is exact.
        (f32::from_bits(bits) * 16_777_216.0).round_ties_even() as u16
    } else {
        // Rounds the 13 bits off that a half does not have, carrying into the exponent where it must, and
        // moves the exponent's bias from 127 to 15.
        let rounded = bits + 0xfff + (bits >> 13 & 1);
        ((rounded - 0x3800_0000) >> 13) as u16
    };
    sign | magnitude
}

/// The float of a half, exactly.
pub(super) fn unpack(half: u16) -> f32 {
    let fraction = u32::from(half & 0x3ff);
    let magnitude = match u32::from(half >> 10 & 0x1f) {
        0 => fraction as f32 / 16_777_216.0,
        31 => f32::from_bits(0x7f80_0000 | fraction << 13),
        exponent => f32::from_bits((exponent + 112) << 23 | fraction << 13),
    };
    if half & 0x8000 == 0 { magnitude } else { -magnitude }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_halves() {
        for (value, half) in [
            (0.0, 0x0000),
            (-0.0, 0x8000),
            (1.0, 0x3c00),
            (-2.0, 0xc000),
            (65504.0, 0x7bff),
            (65519.996, 0x7bff),
            (65520.0, 0x7c00),
            (5.960_464_5e-8, 0x0001),
            (6.103_515_6e-5, 0x0400),
            (f32::NEG_INFINITY, 0xfc00),
        ] {
            assert_eq!(pack(value), half, "{value}");
        }
        assert!(unpack(pack(f32::NAN)).is_nan());
    }

    #[test]
    fn every_half_comes_back() {
        for half in 0..=u16::MAX {
            let value = unpack(half);
            if !value.is_nan() {
                assert_eq!(pack(value), half, "{value}");
            }
        }
    }

    /// Halfway between two halves the even one is taken, a little beside it the nearer one.
    #[test]
    fn between_two_halves_the_nearest_is_taken() {
        for half in (0..0x7bff).step_by(7) {
            let (low, high) = (unpack(half), unpack(half + 1));
            let middle = (low + high) / 2.0;
            assert_eq!(pack(middle), half + (half & 1), "{middle}");
            assert_eq!(pack(middle.next_down()), half);
            assert_eq!(pack(middle.next_up()), half + 1);
        }
    }
}
