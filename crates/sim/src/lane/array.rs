use super::Lane;
use super::functions::closer;
use super::number::Number;
use super::registers::{on_any, on_bits_256, on_bits_512, on_scalars};
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use pulp::NullaryFnOnce;

macro_rules! elementwise {
    ($name:ident, $trait:ident, $method:ident, $op:tt) => {
        impl $trait for $name {
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

/// Numbers of `$n` strands, as wide as the registers that `$dispatch` compiles for.
macro_rules! lane {
    ($(#[$doc:meta])* $name:ident, $t:ident, $n:literal, $align:literal, $dispatch:path) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[repr(align($align))]
        pub(crate) struct $name([$t; $n]);

        elementwise!($name, Add, add, +=);
        elementwise!($name, Sub, sub, -=);
        elementwise!($name, Mul, mul, *=);
        elementwise!($name, Div, div, /=);

        impl Neg for $name {
            type Output = Self;

            #[inline(always)]
            fn neg(mut self) -> Self {
                for a in &mut self.0 {
                    *a = -*a;
                }
                self
            }
        }

        impl AddAssign for $name {
            #[inline(always)]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }

        impl SubAssign for $name {
            #[inline(always)]
            fn sub_assign(&mut self, other: Self) {
                *self = *self - other;
            }
        }

        impl Lane for $name {
            const N: usize = $n;

            #[inline(always)]
            fn dispatch<Op: NullaryFnOnce>(op: Op) -> Op::Output {
                $dispatch(op)
            }

            #[inline(always)]
            fn splat(value: f64) -> Self {
                Self([$t::nearest(value); $n])
            }

            #[inline(always)]
            fn get(&self, lane: usize) -> f64 {
                f64::from(self.0[lane])
            }

            #[inline(always)]
            fn set(&mut self, lane: usize, value: f64) {
                self.0[lane] = $t::nearest(value);
            }

            #[inline(always)]
            fn mul_add(mut self, by: Self, to: Self) -> Self {
                for k in 0..$n {
                    self.0[k] = self.0[k].mul_add(by.0[k], to.0[k]);
                }
                self
            }

            #[inline(always)]
            fn per_sqrt(self) -> Self {
                let mut root = self;
                for a in &mut root.0 {
                    *a = a.guess_per_sqrt();
                }
                for terms in $t::TO_PER_SQRT {
                    let rest = (-self * root).mul_add(root, Self::one());
                    root = closer(root, rest, terms);
                }
                root
            }

            #[inline(always)]
            fn per_sixth_root(self) -> Self {
                let mut root = self;
                for a in &mut root.0 {
                    *a = a.guess_per_sixth_root();
                }
                for terms in $t::TO_PER_SIXTH_ROOT {
                    let cube = root * root * root;
                    let rest = (-self * cube).mul_add(cube, Self::one());
                    root = closer(root, rest, terms);
                }
                root
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
                    *a = a.exp2_whole();
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
                for k in 0..$n {
                    yes.0[k] = if self.0[k] > bound.0[k] { yes.0[k] } else { no.0[k] };
                }
                yes
            }

            #[inline(always)]
            fn any_above(self, bound: Self) -> bool {
                let mut any = false;
                for k in 0..$n {
                    any |= self.0[k] > bound.0[k];
                }
                any
            }

            #[inline(always)]
            fn all_above(self, bound: Self) -> bool {
                let mut all = true;
                for k in 0..$n {
                    all &= self.0[k] > bound.0[k];
                }
                all
            }
        }
    };
}

lane!(
    /// One strand by itself, in double precision.
    F64x1, f64, 1, 8, on_any
);
lane!(
    /// Four strands in double precision: one register of 256 bits.
    F64x4, f64, 4, 32, on_bits_256
);
lane!(
    /// Eight strands in double precision: one register of 512 bits.
    F64x8, f64, 8, 64, on_bits_512
);
lane!(
    /// One strand by itself, in single precision.
    F32x1, f32, 1, 4, on_scalars
);
lane!(
    /// Eight strands in single precision: one register of 256 bits.
    F32x8, f32, 8, 32, on_bits_256
);
lane!(
    /// Sixteen strands in single precision: one register of 512 bits.
    F32x16, f32, 16, 64, on_bits_512
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_roots() {
        for x in [1e-24, 1e-3, 0.5, 1.0, 1.9, 27.0, 1e20] {
            let (square, sixth) = (1.0 / libm::sqrt(x), 1.0 / libm::sqrt(libm::cbrt(x)));
            let close = |found: f64, expected: f64, tolerance: f64| {
                assert!((found / expected - 1.0).abs() < tolerance, "{x}: {found}, expected {expected}");
            };
            close(F64x4::splat(x).per_sqrt().get(1), square, 1e-15);
            close(F64x4::splat(x).per_sixth_root().get(1), sixth, 1e-13);
            close(F32x8::splat(x).per_sqrt().get(1), square, 2e-7);
            close(F32x8::splat(x).per_sixth_root().get(1), sixth, 3e-7);
        }
        assert_eq!((F64x1::zero().sqrt().get(0), F32x1::zero().sqrt().get(0)), (0.0, 0.0));
        assert!(F64x1::splat(f64::NAN).sqrt().get(0).is_nan());
    }

    #[test]
    fn a_choice_is_made_for_each_strand() {
        let x = F64x4::from_fn(|lane| lane as f64);
        let chosen = x.above(F64x4::splat(1.5), F64x4::splat(10.0), -x);
        assert_eq!(chosen, F64x4([0.0, -1.0, 10.0, 10.0]));
        assert_eq!(x.largest(), 3.0);
        assert_eq!((x / F64x4::zero()).largest(), f64::INFINITY);
    }
}
