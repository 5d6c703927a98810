//! Several numbers side by side: one for each of some strands that are stepped together.
//!
//! Everything in the method `physical` is written over [`Lane`], so the same lines run for one strand at a time or for
//! as many as fit the processor's registers. The operations are plain loops over an array that the compiler turns
//! into vector instructions. Where two are fused it is by [`Lane::mul_add`], which rounds once on every machine, with or
//! without an instruction for it: so every machine gives the same bits.

mod array;
mod functions;
mod matrix;
mod number;
mod quaternion;
mod registers;
mod vector;

pub(crate) use array::{F32x1, F32x8, F32x16, F64x1, F64x4, F64x8};
pub(crate) use functions::{cos_and_sine_share, fade, series, sine_to_quarter};
pub(crate) use matrix::{Matrix, Symmetric};
pub(crate) use quaternion::Turn;
pub(crate) use registers::{Registers, WithLanes};
pub(crate) use vector::Vector;

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use pulp::NullaryFnOnce;

/// Numbers of several strands, one a strand.
pub(crate) trait Lane:
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

    /// Calls something, compiled for registers as wide as this.
    ///
    /// # Panics
    /// If the machine has no such registers; [`Registers::widest`] says.
    fn dispatch<Op: NullaryFnOnce>(op: Op) -> Op::Output;

    /// The same number for all.
    fn splat(value: f64) -> Self;

    /// The number of one strand.
    fn get(&self, lane: usize) -> f64;

    /// Sets the number of one strand.
    fn set(&mut self, lane: usize, value: f64);

    /// This times `by` plus `to`, rounded once.
    fn mul_add(self, by: Self, to: Self) -> Self;

    /// One over the square root of numbers that are not negative, to a few units in the last place; of 0 something
    /// large. Without a division or a root, which processors make one at a time.
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
