use crate::Lane;
use crate::functions::{per_sixth_root_from, per_sqrt_from};
use crate::number::Number;
use crate::registers::{on_any, on_scalars};
use core::ops::{Add, Div, Mul, Neg, Sub};
use pulp::NullaryFnOnce;

macro_rules! elementwise {
    ($name:ident, [$($k:literal)*], $trait:ident, $method:ident, $op:tt) => {
        impl $trait for $name {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self([$(self.0[$k] $op other.0[$k]),*])
            }
        }
    };
}

/// Numbers of as many strands as there are indices, as wide as the registers that `$dispatch` compiles for.
///
/// Every number is written out: loops would be thousands in a step, and most of the time that the compiler takes for it.
macro_rules! lane {
    ($(#[$doc:meta])* $name:ident, $t:ident, $n:literal, $indices:tt, $align:literal, $dispatch:path) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[repr(align($align))]
        pub struct $name([$t; $n]);

        elementwise!($name, $indices, Add, add, +);
        elementwise!($name, $indices, Sub, sub, -);
        elementwise!($name, $indices, Mul, mul, *);
        elementwise!($name, $indices, Div, div, /);
        lane!(@functions $name, $t, $n, $indices, $dispatch);

        in_place!($name);
    };
    (@functions $name:ident, $t:ident, $n:literal, [$($k:literal)*], $dispatch:path) => {
        impl Neg for $name {
            type Output = Self;

            #[inline(always)]
            fn neg(self) -> Self {
                Self([$(-self.0[$k]),*])
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
            fn same(self, value: f64) -> Self {
                Self::splat(value)
            }

            #[inline(always)]
            fn of_single(self, numbers: &[f32]) -> Self {
                Self([$($t::from(numbers[$k])),*])
            }

            #[inline(always)]
            fn to_single(self, numbers: &mut [f32]) {
                numbers.copy_from_slice(&[$(self.0[$k].single()),*]);
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
            fn mul_add(self, by: Self, to: Self) -> Self {
                Self([$(self.0[$k].mul_add(by.0[$k], to.0[$k])),*])
            }

            #[inline(always)]
            fn per_sqrt(self) -> Self {
                per_sqrt_from(self, Self([$(self.0[$k].guess_per_sqrt()),*]), $t::TO_PER_SQRT)
            }

            #[inline(always)]
            fn per_sixth_root(self) -> Self {
                let guess = Self([$(self.0[$k].guess_per_sixth_root()),*]);
                per_sixth_root_from(self, guess, $t::TO_PER_SIXTH_ROOT)
            }

            #[inline(always)]
            fn round(self) -> Self {
                Self([$(self.0[$k] + $t::WHOLE_FROM_HERE - $t::WHOLE_FROM_HERE),*])
            }

            #[inline(always)]
            fn exp2_whole(self) -> Self {
                Self([$(self.0[$k].exp2_whole()),*])
            }

            #[inline(always)]
            fn max(self, other: Self) -> Self {
                Self([$(if self.0[$k] > other.0[$k] { self.0[$k] } else { other.0[$k] }),*])
            }

            #[inline(always)]
            fn min(self, other: Self) -> Self {
                Self([$(if self.0[$k] < other.0[$k] { self.0[$k] } else { other.0[$k] }),*])
            }

            #[inline(always)]
            fn above(self, bound: Self, yes: Self, no: Self) -> Self {
                Self([$(if self.0[$k] > bound.0[$k] { yes.0[$k] } else { no.0[$k] }),*])
            }

            #[inline(always)]
            fn any_above(self, bound: Self) -> bool {
                false $(| (self.0[$k] > bound.0[$k]))*
            }

            #[inline(always)]
            fn all_above(self, bound: Self) -> bool {
                true $(& (self.0[$k] > bound.0[$k]))*
            }
        }
    };
}

lane!(
    /// One strand by itself, in double precision.
    F64x1, f64, 1, [0], 8, on_any
);
lane!(
    /// One strand by itself, in single precision.
    F32x1, f32, 1, [0], 4, on_scalars
);
#[cfg(not(target_arch = "x86_64"))]
lane!(
    /// Four strands in double precision.
    F64x4, f64, 4, [0 1 2 3], 32, on_scalars
);
#[cfg(not(target_arch = "x86_64"))]
lane!(
    /// Eight strands in single precision.
    F32x8, f32, 8, [0 1 2 3 4 5 6 7], 32, on_scalars
);
