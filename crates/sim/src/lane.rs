//! Several numbers side by side: one for each of some strands that are stepped together.
//!
//! Everything in the method `physical` is written over [`Lane`], so the same lines run for one strand at a time or for
//! as many as fit the processor's registers. The operations are plain loops over an array that the compiler turns
//! into vector instructions. Where two are fused it is by [`Lane::mul_add`], which rounds once on every machine, with or
//! without an instruction for it: so every machine gives the same bits.

mod array;
mod functions;
mod matrix;
mod quaternion;
mod vector;

pub(crate) use array::{Wide1, Wide4, Wide8};
pub(crate) use functions::{cos_and_sine_share, fade, series, sine_to_quarter};
pub(crate) use matrix::{Matrix, Symmetric};
pub(crate) use quaternion::Turn;
pub(crate) use vector::Vector;

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Numbers of several strands, one a strand.
pub(crate) trait Lane:
    Copy
    + Debug
    + Send
    + Sync
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

    /// The same number for all.
    fn splat(value: f64) -> Self;

    /// The number of one strand.
    fn get(&self, lane: usize) -> f64;

    /// Sets the number of one strand.
    fn set(&mut self, lane: usize, value: f64);

    /// This times `by` plus `to`, rounded once.
    fn mul_add(self, by: Self, to: Self) -> Self;

    /// The square root.
    fn sqrt(self) -> Self;

    /// The cube root of numbers that are not negative, to a few digits less than the type holds.
    fn cbrt(self) -> Self;

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

    /// 0 for all.
    fn zero() -> Self {
        Self::splat(0.0)
    }

    /// 1 for all.
    fn one() -> Self {
        Self::splat(1.0)
    }

    /// The number of one strand for each, as a function of its place.
    fn from_fn(mut f: impl FnMut(usize) -> f64) -> Self {
        let mut lanes = Self::zero();
        for lane in 0..Self::N {
            lanes.set(lane, f(lane));
        }
        lanes
    }

    /// The smallest of all; NaN if any is.
    fn smallest(self) -> f64 {
        (0..Self::N)
            .map(|lane| self.get(lane))
            .fold(f64::INFINITY, |a, b| if b < a || b.is_nan() { b } else { a })
    }

    /// The largest of all; NaN counts as infinite.
    fn largest(self) -> f64 {
        (0..Self::N).map(|lane| self.get(lane)).fold(f64::NEG_INFINITY, |a, b| {
            let b = if b.is_nan() { f64::INFINITY } else { b };
            if b > a { b } else { a }
        })
    }
}
