//! Numbers in the vector registers of x86 processors.
//!
//! Each operation is one of the processor's, asked for through `pulp`'s witness that it is there: a compiler that is left
//! to find vectors in arrays finds two thirds of them.

use crate::Lane;
use crate::functions::{per_sixth_root_from, per_sqrt_from};
use crate::number::Number;
use core::ops::{Add, Div, Mul, Neg, Sub};
use pulp::bytemuck::cast;
use pulp::x86::{V3, V4};
use pulp::{NullaryFnOnce, Simd, b8, b16, f32x8, f32x16, f64x4, f64x8, m32x8, m64x4};

/// What a comparison gives.
trait Found {
    /// Whether it holds for any strand.
    fn any(self) -> bool;
}

impl Found for b8 {
    #[inline(always)]
    fn any(self) -> bool {
        self.0 != 0
    }
}

impl Found for b16 {
    #[inline(always)]
    fn any(self) -> bool {
        self.0 != 0
    }
}

impl Found for m64x4 {
    #[inline(always)]
    fn any(self) -> bool {
        cast::<_, [u64; 4]>(self) != [0; 4]
    }
}

impl Found for m32x8 {
    #[inline(always)]
    fn any(self) -> bool {
        cast::<_, [u64; 4]>(self) != [0; 4]
    }
}

macro_rules! elementwise {
    ($name:ident, $trait:ident, $method:ident, $op:ident) => {
        impl $trait for $name {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.with(self.simd.$op(self.numbers, other.numbers))
            }
        }
    };
}

/// [`Lane::each_point`] of numbers in single precision, interleaved in their registers: in which order they come out is
/// the registers' affair. Written out, as loops here would go through memory.
macro_rules! each_point {
    ($($lane:literal)*) => {
        #[inline(always)]
        fn each_point([x, y, z]: [Self; 3], mut say: impl FnMut(usize, [f32; 4])) {
            let interleaved = x.simd.interleave_shfl_f32s([x, y, z, z].map(|component| component.numbers));
            let mut points = cast::<_, [[f32; 4]; Self::N]>(interleaved).into_iter();
            $(if let Some(point) = points.next() { say($lane, point); })*
        }
    };
}

/// [`Lane::each_point`] of numbers in double precision: by way of memory, where they are rounded side by side.
macro_rules! each_point_of_rows {
    () => {
        #[inline(always)]
        fn each_point(components: [Self; 3], mut say: impl FnMut(usize, [f32; 4])) {
            let mut rows = [[0.0; Self::N]; 3];
            for (row, component) in rows.iter_mut().zip(components) {
                component.to_single(row);
            }
            for lane in 0..Self::N {
                say(lane, [rows[0][lane], rows[1][lane], rows[2][lane], rows[2][lane]]);
            }
        }
    };
}

/// Numbers of `$n` strands in a register: the names of what is done with it, and with its bits.
macro_rules! wide {
    (
        $(#[$doc:meta])* $name:ident, $simd:ident, $numbers:ident, [$t:ident; $n:literal], $align:literal,
        [$splat:ident $add:ident $sub:ident $mul:ident $div:ident $neg:ident $mul_add:ident],
        [$max:ident $min:ident $select:ident $greater:ident $not:ident],
        [$splat_bits:ident $sub_bits:ident $shift_left:ident $shift_right:ident],
        $of_single:expr, $to_single:expr, $each_point:ident![$($lane:literal)*]
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        #[repr(align($align))]
        pub struct $name {
            numbers: $numbers,
            simd: $simd,
        }

        elementwise!($name, Add, add, $add);
        elementwise!($name, Sub, sub, $sub);
        elementwise!($name, Mul, mul, $mul);
        elementwise!($name, Div, div, $div);

        impl Neg for $name {
            type Output = Self;

            #[inline(always)]
            fn neg(self) -> Self {
                self.with(self.simd.$neg(self.numbers))
            }
        }

        in_place!($name);

        impl $name {
            #[inline(always)]
            fn with(self, numbers: $numbers) -> Self {
                Self { numbers, ..self }
            }
        }

        impl Lane for $name {
            const N: usize = $n;

            #[inline(always)]
            fn dispatch<Op: NullaryFnOnce>(op: Op) -> Op::Output {
                $simd::try_new().expect("the registers that were chosen").vectorize(op)
            }

            fn splat(value: f64) -> Self {
                let simd = $simd::try_new().expect("the registers that were chosen");
                Self { numbers: simd.$splat($t::nearest(value)), simd }
            }

            #[inline(always)]
            fn same(self, value: f64) -> Self {
                self.with(self.simd.$splat($t::nearest(value)))
            }

            #[inline(always)]
            fn get(&self, lane: usize) -> f64 {
                f64::from(cast::<_, [$t; $n]>(self.numbers)[lane])
            }

            #[inline(always)]
            fn set(&mut self, lane: usize, value: f64) {
                let mut numbers: [$t; $n] = cast(self.numbers);
                numbers[lane] = $t::nearest(value);
                self.numbers = cast(numbers);
            }

            #[inline(always)]
            fn from_fn(mut f: impl FnMut(usize) -> f64) -> Self {
                // All of them at once: a register of which one number is set goes through memory for each.
                let mut numbers = [0.0; $n];
                for (lane, number) in numbers.iter_mut().enumerate() {
                    *number = $t::nearest(f(lane));
                }
                Self::zero().with(cast(numbers))
            }

            #[inline(always)]
            fn of_single(self, numbers: &[f32]) -> Self {
                let numbers: [f32; $n] = numbers.try_into().expect("as many as there are strands");
                self.with($of_single(self.simd, cast(numbers)))
            }

            #[inline(always)]
            fn to_single(self, numbers: &mut [f32]) {
                numbers.copy_from_slice(&cast::<_, [f32; $n]>($to_single(self.simd, self.numbers)));
            }

            $each_point!($($lane)*);

            #[inline(always)]
            fn mul_add(self, by: Self, to: Self) -> Self {
                self.with(self.simd.$mul_add(self.numbers, by.numbers, to.numbers))
            }

            #[inline(always)]
            fn per_sqrt(self) -> Self {
                let half = self.simd.$shift_right::<1>(cast(self.numbers));
                let at_one = self.simd.$splat_bits($t::PER_SQRT_AT_1);
                let guess = self.with(cast(self.simd.$sub_bits(at_one, half)));
                per_sqrt_from(self, guess, $t::TO_PER_SQRT)
            }

            #[inline(always)]
            fn per_sixth_root(self) -> Self {
                let first = self.simd.$shift_right::<{ $t::BELOW_FIRST_20 as _ }>(cast(self.numbers));
                let sixth = self.simd.mul_u32s(cast(first), self.simd.splat_u32s($t::SIXTH));
                let sixth = self.simd.$shift_left::<{ $t::BELOW_FIRST_32 as _ }>(cast(sixth));
                let at_one = self.simd.$splat_bits($t::PER_SIXTH_ROOT_AT_1);
                let guess = self.with(cast(self.simd.$sub_bits(at_one, sixth)));
                per_sixth_root_from(self, guess, $t::TO_PER_SIXTH_ROOT)
            }

            #[inline(always)]
            fn round(self) -> Self {
                let whole = self.simd.$splat($t::WHOLE_FROM_HERE);
                self.with(self.simd.$sub(self.simd.$add(self.numbers, whole), whole))
            }

            #[inline(always)]
            fn exp2_whole(self) -> Self {
                let sum = self.simd.$add(self.numbers, self.simd.$splat($t::EXPONENT_FROM_HERE));
                self.with(cast(self.simd.$shift_left::<{ $t::BELOW_EXPONENT as _ }>(cast(sum))))
            }

            #[inline(always)]
            fn max(self, other: Self) -> Self {
                self.with(self.simd.$max(self.numbers, other.numbers))
            }

            #[inline(always)]
            fn min(self, other: Self) -> Self {
                self.with(self.simd.$min(self.numbers, other.numbers))
            }

            #[inline(always)]
            fn above(self, bound: Self, yes: Self, no: Self) -> Self {
                let above = self.simd.$greater(self.numbers, bound.numbers);
                self.with(self.simd.$select(above, yes.numbers, no.numbers))
            }

            #[inline(always)]
            fn any_above(self, bound: Self) -> bool {
                self.simd.$greater(self.numbers, bound.numbers).any()
            }

            #[inline(always)]
            fn all_above(self, bound: Self) -> bool {
                !self.simd.$not(self.simd.$greater(self.numbers, bound.numbers)).any()
            }
        }
    };
}

wide!(
    /// Four strands in double precision: one register of 256 bits.
    F64x4, V3, f64x4, [f64; 4], 32,
    [splat_f64s add_f64s sub_f64s mul_f64s div_f64s neg_f64s mul_add_f64s],
    [max_f64s min_f64s select_f64s greater_than_f64s not_m64s],
    [splat_u64s sub_u64s shl_const_u64x4 shr_const_u64x4],
    |simd: V3, single| simd.convert_f32x4_to_f64x4(single),
    |simd: V3, double| simd.convert_f64x4_to_f32x4(double),
    each_point_of_rows![]
);
wide!(
    /// Eight strands in double precision: one register of 512 bits.
    F64x8, V4, f64x8, [f64; 8], 64,
    [splat_f64s add_f64s sub_f64s mul_f64s div_f64s neg_f64s mul_add_f64s],
    [max_f64s min_f64s select_f64s greater_than_f64s not_m64s],
    [splat_u64s sub_u64s shl_const_u64x8 shr_const_u64x8],
    |simd: V4, single| simd.convert_f32x8_to_f64x8(single),
    |simd: V4, double| simd.convert_f64x8_to_f32x8(double),
    each_point_of_rows![]
);
wide!(
    /// Eight strands in single precision: one register of 256 bits.
    F32x8, V3, f32x8, [f32; 8], 32,
    [splat_f32s add_f32s sub_f32s mul_f32s div_f32s neg_f32s mul_add_f32s],
    [max_f32s min_f32s select_f32s greater_than_f32s not_m32s],
    [splat_u32s sub_u32s shl_const_u32x8 shr_const_u32x8],
    |_, single: f32x8| single,
    |_, single: f32x8| single,
    each_point![0 4 1 5 2 6 3 7]
);
wide!(
    /// Sixteen strands in single precision: one register of 512 bits.
    F32x16, V4, f32x16, [f32; 16], 64,
    [splat_f32s add_f32s sub_f32s mul_f32s div_f32s neg_f32s mul_add_f32s],
    [max_f32s min_f32s select_f32s greater_than_f32s not_m32s],
    [splat_u32s sub_u32s shl_const_u32x16 shr_const_u32x16],
    |_, single: f32x16| single,
    |_, single: f32x16| single,
    each_point![0 4 8 12 1 5 9 13 2 6 10 14 3 7 11 15]
);
