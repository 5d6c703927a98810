//! Several numbers side by side: one for each of some strands that are stepped together, of some frames, or of some steps of a wind.
//!
//! What is written over [`Lane`] runs for one strand at a time or for as many as fit the processor's registers, by the
//! same lines: all of the simulator's steps, the strands that follow guides, the wind at voxels. On x86 each operation is one of the processor's; elsewhere it is written out
//! for every number of an array, and the compiler makes vectors of it. Where two are fused it is by [`Lane::mul_add`],
//! which rounds once on every machine, with or without an instruction for it: so every machine gives the same bits.

/// What adds and subtracts in place.
macro_rules! in_place {
    ($name:ident) => {
        impl core::ops::AddAssign for $name {
            #[inline(always)]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }

        impl core::ops::SubAssign for $name {
            #[inline(always)]
            fn sub_assign(&mut self, other: Self) {
                *self = *self - other;
            }
        }
    };
}

mod array;
mod functions;
mod matrix;
mod number;
mod quaternion;
mod registers;
mod vector;
#[cfg(target_arch = "x86_64")]
mod wide;

#[cfg(not(target_arch = "x86_64"))]
use array::{F32x8, F64x4};
#[cfg(target_arch = "x86_64")]
use wide::{F32x8, F32x16, F64x4, F64x8};

pub use array::F32x1;
pub use array::F64x1;
pub use functions::{angle_per_sine, cos_and_sine, cos_and_sine_share, fade, series, squared_chord};
pub use matrix::{Matrix, Placing, Shifted, Symmetric};
pub use quaternion::Turn;
pub use registers::{Registers, WithLanes};
pub use vector::Vector;

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
pub use pulp::NullaryFnOnce;

/// How many digits are computed with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Double.
    #[default]
    Double,
    /// Single, in twice as many lanes.
    Single,
}

/// As many numbers as are ever side by side.
pub const MOST_LANES: usize = 16;

/// Numbers of several strands, one a strand.
pub trait Lane:
    Copy
    + Debug
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// How many strands.
    const N: usize;

    /// Whether this is one strand alone, in double precision.
    const IS_ONE_DOUBLE: bool = Self::N == 1 && size_of::<Self>() == size_of::<f64>();

    /// Calls something, compiled for registers as wide as this.
    ///
    /// # Panics
    /// If the machine has no such registers; [`Registers::widest`] says.
    fn dispatch<Op: NullaryFnOnce>(op: Op) -> Op::Output;

    /// The same number for all. In the loop over steps it is [`Lane::same`] that is asked: where the numbers are in
    /// registers, this must first see that the machine has them.
    fn splat(value: f64) -> Self;

    /// The same number for all, beside a number that there is.
    fn same(self, value: f64) -> Self;

    /// Numbers in single precision, one a strand.
    fn of_single(self, numbers: &[f32]) -> Self;

    /// These numbers in single precision.
    fn to_single(self, numbers: &mut [f32]);

    /// The number of one strand.
    fn get(&self, lane: usize) -> f64;

    /// Sets the number of one strand.
    fn set(&mut self, lane: usize, value: f64);

    /// Says the x, y and z of each place, in single precision and some order, in front of a number that means nothing: four are
    /// written at once.
    #[inline(always)]
    fn each_point([x, y, z]: [Self; 3], mut say: impl FnMut(usize, [f32; 4])) {
        for lane in 0..Self::N {
            say(lane, [x, y, z, z].map(|component| component.get(lane) as f32));
        }
    }

    /// This times `by` plus `to`, rounded once.
    fn mul_add(self, by: Self, to: Self) -> Self;

    /// One over the square root of numbers that are not negative, to a few units in the last place; of 0 something
    /// large; of 1 exactly 1. Without a division or a root, which processors make one at a time.
    fn per_sqrt(self) -> Self;

    /// One over the sixth root of numbers from 1e-24 to 1e20, to a digit or two less than the type holds.
    fn per_sixth_root(self) -> Self;

    /// The square root of numbers that are not negative, to a few units in the last place.
    #[inline(always)]
    fn sqrt(self) -> Self {
        self * self.per_sqrt()
    }

    /// The cube root of numbers that are not negative, to a digit or two less than the type holds.
    #[inline(always)]
    fn cbrt(self) -> Self {
        let per_root = (self * self).max(Self::splat(1e-24)).per_sixth_root();
        self * per_root * per_root
    }

    /// The nearest whole number; between two, the even one.
    fn round(self) -> Self;

    /// 2 to the power of whole numbers from −120 to 120.
    fn exp2_whole(self) -> Self;

    /// The larger of each pair; where one is NaN, the other.
    fn max(self, other: Self) -> Self;

    /// The smaller of each pair; where one is NaN, the other.
    fn min(self, other: Self) -> Self;

    /// `yes` where `self` is above `bound`, else `no`.
    fn above(self, bound: Self, yes: Self, no: Self) -> Self;

    /// Whether any is above its bound.
    fn any_above(self, bound: Self) -> bool;

    /// Whether all are above their bounds.
    fn all_above(self, bound: Self) -> bool;

    /// 0 for all.
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(0.0)
    }

    /// 1 for all.
    #[inline(always)]
    fn one() -> Self {
        Self::splat(1.0)
    }

    /// The number of one strand for each, as a function of its place.
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> f64) -> Self {
        let mut lanes = Self::zero();
        for lane in 0..Self::N {
            lanes.set(lane, f(lane));
        }
        lanes
    }

    /// The largest of all; NaN counts as infinite.
    #[inline(always)]
    fn largest(self) -> f64 {
        (0..Self::N).map(|lane| self.get(lane)).fold(f64::NEG_INFINITY, |a, b| {
            let b = if b.is_nan() { f64::INFINITY } else { b };
            if b > a { b } else { a }
        })
    }
}

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
            close(F64x1::splat(x).per_sqrt().get(0), square, 1e-15);
            close(F64x1::splat(x).per_sixth_root().get(0), sixth, 1e-13);
            close(F32x1::splat(x).per_sqrt().get(0), square, 2e-7);
            close(F32x1::splat(x).per_sixth_root().get(0), sixth, 3e-7);
        }
        assert_eq!((F64x1::one().per_sqrt(), F32x1::one().per_sqrt()), (F64x1::one(), F32x1::one()));
        assert_eq!((F64x1::zero().sqrt().get(0), F32x1::zero().sqrt().get(0)), (0.0, 0.0));
        assert!(F64x1::splat(f64::NAN).sqrt().get(0).is_nan());
    }

    /// A choice among the numbers of each strand, and the largest of all.
    struct Choice;

    impl WithLanes for Choice {
        type Output = ();

        fn with<L: Lane>(self) {
            let x = L::from_fn(|lane| lane as f64);
            let chosen = x.above(x.same(1.5), x.same(10.0), -x);
            for lane in 0..L::N {
                assert_eq!(chosen.get(lane), if lane > 1 { 10.0 } else { -(lane as f64) });
            }
            assert_eq!(x.largest(), (L::N - 1) as f64);
            assert_eq!((x / L::zero()).largest(), f64::INFINITY);
        }
    }

    /// Three numbers of each place, said together.
    struct Points;

    impl WithLanes for Points {
        type Output = ();

        fn with<L: Lane>(self) {
            let component = |axis: f64| L::from_fn(|lane| lane as f64 + 0.25 * axis);
            let mut said = vec![0; L::N];
            L::each_point([component(0.0), component(1.0), component(2.0)], |lane, [x, y, z, _]| {
                assert_eq!([x, y, z], [0.0, 0.25, 0.5].map(|more| lane as f32 + more));
                said[lane] += 1;
            });
            assert_eq!(said, vec![1; L::N]);
        }
    }

    #[test]
    fn each_point_is_said_once() {
        for registers in Registers::here() {
            registers.with_lanes(Precision::Double, Points);
            registers.with_lanes(Precision::Single, Points);
        }
    }

    #[test]
    fn a_choice_is_made_for_each_strand() {
        for registers in Registers::here() {
            registers.with_lanes(Precision::Double, Choice);
            registers.with_lanes(Precision::Single, Choice);
        }
    }

    /// What can be done with 16 pairs of numbers, in lanes that fit some registers. Out: what came of it, operation after
    /// operation, and what was found above.
    struct Everything<'a>(&'a [f64; 16], &'a [f64; 16]);

    impl WithLanes for Everything<'_> {
        type Output = (Vec<u64>, [bool; 2]);

        fn with<L: Lane>(self) -> Self::Output {
            let lanes = |numbers: &[f64; 16]| -> Vec<L> {
                numbers.chunks(L::N).map(|some| L::from_fn(|lane| some[lane])).collect()
            };
            let operations: [fn(L, L) -> L; 16] = [
                |a, b| a + b,
                |a, b| a - b,
                |a, b| a * b,
                |a, b| a / b,
                |a, _| -a,
                |a, b| a.mul_add(b, a),
                |a, b| a.max(b),
                |a, b| a.min(b),
                |a, b| a.above(b, a.same(0.1), b + b),
                |a, _| (a * a).per_sqrt(),
                |a, _| (a * a).per_sixth_root(),
                |a, _| (a * a).cbrt(),
                |a, _| a.round(),
                |a, _| a.min(a.same(99.0)).max(a.same(-99.0)).round().exp2_whole(),
                |a, _| fade(a * a),
                |a, _| {
                    let mut single = vec![0.0; L::N];
                    a.to_single(&mut single);
                    a.of_single(&single)
                },
            ];
            let (a, b) = (lanes(self.0), lanes(self.1));
            let bits = operations.iter().flat_map(|operation| {
                let found = a.iter().zip(&b).map(|(a, b)| operation(*a, *b));
                found.flat_map(|found| (0..L::N).map(move |lane| found.get(lane).to_bits()))
            });
            let pairs = || a.iter().zip(&b);
            let above = [pairs().any(|(a, b)| a.any_above(*b)), pairs().all(|(a, b)| a.all_above(*b))];
            (bits.collect(), above)
        }
    }

    #[test]
    fn operations_are_the_same_in_all_registers() {
        let a: [f64; 16] = core::array::from_fn(|k| (k as f64 - 7.3) * libm::exp2(k as f64 - 6.0));
        let mixed: [f64; 16] = core::array::from_fn(|k| a[(k * 7 + 3) % 16] * 1.000_1);
        let below: [f64; 16] = a.map(|a| a - 1.0);
        let mut but_one = below;
        but_one[13] = a[13];
        let mut wild = mixed;
        (wild[2], wild[9], wild[12]) = (f64::NAN, f64::INFINITY, 0.0);
        for precision in [Precision::Double, Precision::Single] {
            for (b, above) in [
                (mixed, [true, false]),
                (below, [true, true]),
                (but_one, [true, false]),
                (a, [false, false]),
                (wild, [true, false]),
            ] {
                let alone = Registers::Scalar.with_lanes(precision, Everything(&a, &b));
                assert_eq!(alone.1, above);
                for registers in Registers::here() {
                    let found = registers.with_lanes(precision, Everything(&a, &b));
                    assert!(found == alone, "{registers:?}, {precision:?}, {b:?}: {found:?} {alone:?}");
                }
            }
        }
    }
}
