use super::Lane;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// One strand by itself, in double precision.
pub(crate) type Wide1 = Wide<f64, 1>;
/// Four strands in double precision: one register of 256 bits.
pub(crate) type Wide4 = Wide<f64, 4>;
/// Eight strands in single precision: one register of 256 bits.
pub(crate) type Wide8 = Wide<f32, 8>;

/// Numbers of `N` strands.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub(crate) struct Wide<T, const N: usize>([T; N]);

macro_rules! elementwise {
    ($t:ty, $trait:ident, $method:ident, $op:tt) => {
        impl<const N: usize> $trait for Wide<$t, N> {
            type Output = Self;

            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                for (a, b) in self.0.iter_mut().zip(&other.0) {
                    *a $op *b;
                }
                self
            }
        }
    };
}

macro_rules! lane {
    ($t:ty, $from:expr, $cbrt:path, $exp2:path) => {
        elementwise!($t, Add, add, +=);
        elementwise!($t, Sub, sub, -=);
        elementwise!($t, Mul, mul, *=);
        elementwise!($t, Div, div, /=);

        impl<const N: usize> Neg for Wide<$t, N> {
            type Output = Self;

            #[inline(always)]
            fn neg(mut self) -> Self {
                for a in &mut self.0 {
                    *a = -*a;
                }
                self
            }
        }

        impl<const N: usize> AddAssign for Wide<$t, N> {
            #[inline(always)]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }

        impl<const N: usize> SubAssign for Wide<$t, N> {
            #[inline(always)]
            fn sub_assign(&mut self, other: Self) {
                *self = *self - other;
            }
        }

        impl<const M: usize> Lane for Wide<$t, M> {
            const N: usize = M;

            #[inline(always)]
            fn splat(value: f64) -> Self {
                Self([$from(value); M])
            }

            #[inline(always)]
            fn get(&self, lane: usize) -> f64 {
                f64::from(self.0[lane])
            }

            #[inline(always)]
            fn set(&mut self, lane: usize, value: f64) {
                self.0[lane] = $from(value);
            }

            #[inline(always)]
            fn mul_add(mut self, by: Self, to: Self) -> Self {
                for k in 0..M {
                    self.0[k] = self.0[k].mul_add(by.0[k], to.0[k]);
                }
                self
            }

            #[inline(always)]
            fn sqrt(mut self) -> Self {
                for a in &mut self.0 {
                    *a = a.sqrt();
                }
                self
            }

            #[inline(always)]
            fn cbrt(mut self) -> Self {
                for a in &mut self.0 {
                    *a = $cbrt(*a);
                }
                self
            }

            #[inline(always)]
            fn round(mut self) -> Self {
                for a in &mut self.0 {
                    *a = a.round_ties_even();
                }
                self
            }

            #[inline(always)]
            fn exp2_whole(mut self) -> Self {
                for a in &mut self.0 {
                    *a = $exp2(*a);
                }
                self
            }

            #[inline(always)]
            fn max(mut self, other: Self) -> Self {
                for (a, b) in self.0.iter_mut().zip(&other.0) {
                    *a = if *a > *b { *a } else { *b };
                }
                self
            }

            #[inline(always)]
            fn min(mut self, other: Self) -> Self {
                for (a, b) in self.0.iter_mut().zip(&other.0) {
                    *a = if *a < *b { *a } else { *b };
                }
                self
            }

            #[inline(always)]
            fn above(self, bound: Self, mut yes: Self, no: Self) -> Self {
                for k in 0..M {
                    yes.0[k] = if self.0[k] > bound.0[k] { yes.0[k] } else { no.0[k] };
                }
                yes
            }
        }
    };
}

lane!(f32, |value: f64| value as f32, cbrt32, exp2_whole32);
lane!(f64, |value: f64| value, cbrt64, exp2_whole64);

/// The exponent's bits are the number plus 127. Added to 2²³ it stands in the last bits, and is shifted from there.
#[inline(always)]
fn exp2_whole32(x: f32) -> f32 {
    f32::from_bits((x + (8_388_608.0 + 127.0)).to_bits() << 23)
}

/// As [`exp2_whole32`].
#[inline(always)]
fn exp2_whole64(x: f64) -> f64 {
    f64::from_bits((x + (4_503_599_627_370_496.0 + 1023.0)).to_bits() << 52)
}

/// A third of the exponent's bits is a guess within 4 %; Halley's iteration cubes that error.
#[inline(always)]
fn cbrt32(x: f32) -> f32 {
    let mut root = f32::from_bits(x.to_bits() / 3 + 0x2a51_19f2);
    for _ in 0..2 {
        let cube = root * root * root;
        root *= (cube + 2.0 * x) / (2.0 * cube + x);
    }
    if x > f32::MIN_POSITIVE { root } else { 0.0 }
}

/// As [`cbrt32`], to about 1e-13.
#[inline(always)]
fn cbrt64(x: f64) -> f64 {
    let mut root = f64::from_bits(x.to_bits() / 3 + 0x2a9f_7893_0000_0000);
    for _ in 0..2 {
        let cube = root * root * root;
        root *= (cube + 2.0 * x) / (2.0 * cube + x);
    }
    if x > f64::MIN_POSITIVE { root } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cube_roots_are_cube_roots() {
        for x in [1e-30, 1e-3, 1.0, 27.0, 1e20] {
            assert!((cbrt32(x as f32) / libm::cbrtf(x as f32) - 1.0).abs() < 1e-6, "{x}");
            assert!((cbrt64(x) / libm::cbrt(x) - 1.0).abs() < 1e-12, "{x}");
        }
        assert_eq!((cbrt32(0.0), cbrt64(0.0)), (0.0, 0.0));
    }

    #[test]
    fn a_choice_is_made_for_each_strand() {
        let x = Wide4::from_fn(|lane| lane as f64);
        let chosen = x.above(Wide4::splat(1.5), Wide4::splat(10.0), -x);
        assert_eq!(chosen, Wide([0.0, -1.0, 10.0, 10.0]));
        assert_eq!(x.largest(), 3.0);
        assert_eq!((x / Wide4::zero()).largest(), f64::INFINITY);
    }
}
