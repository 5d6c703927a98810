//! Which registers the machine has, and how many numbers are side by side in them.

use crate::{F32x1, F32x8, F64x1, F64x4, Lane, Precision};
#[cfg(target_arch = "x86_64")]
use crate::{F32x16, F64x8};
use pulp::NullaryFnOnce;
#[cfg(target_arch = "x86_64")]
use pulp::x86::{V3, V4};

/// Registers to work in. What is worked out in lanes is the same to the bit in all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Registers {
    /// AVX-512.
    #[cfg(target_arch = "x86_64")]
    Bits512,
    /// AVX2 with fused products and sums, or whatever another processor has.
    Bits256,
    /// An x86 processor without AVX2: one number at a time, and its fused operations are worked out by a library.
    #[cfg_attr(not(target_arch = "x86_64"), allow(dead_code, reason = "other processors have wider ones"))]
    Scalar,
}

/// Something to be done with lanes that fit the registers.
pub trait WithLanes {
    /// What comes of it.
    type Output;

    /// Does it.
    fn with<L: Lane>(self) -> Self::Output;
}

impl Registers {
    /// The widest that this machine has.
    #[cfg(target_arch = "x86_64")]
    pub fn widest() -> Self {
        if V4::try_new().is_some() {
            Self::Bits512
        } else if V3::try_new().is_some() {
            Self::Bits256
        } else {
            Self::Scalar
        }
    }

    /// The widest that this machine has.
    #[cfg(not(target_arch = "x86_64"))]
    pub fn widest() -> Self {
        Self::Bits256
    }

    /// All that this machine has, the widest first.
    pub fn here() -> Vec<Self> {
        let all = [
            #[cfg(target_arch = "x86_64")]
            Self::Bits512,
            Self::Bits256,
            Self::Scalar,
        ];
        all.into_iter().skip_while(|registers| *registers != Self::widest()).collect()
    }

    /// Does something with lanes that fit.
    pub fn with_lanes<W: WithLanes>(self, precision: Precision, work: W) -> W::Output {
        match (self, precision) {
            #[cfg(target_arch = "x86_64")]
            (Self::Bits512, Precision::Double) => work.with::<F64x8>(),
            #[cfg(target_arch = "x86_64")]
            (Self::Bits512, Precision::Single) => work.with::<F32x16>(),
            (Self::Bits256, Precision::Double) => work.with::<F64x4>(),
            (Self::Bits256, Precision::Single) => work.with::<F32x8>(),
            (Self::Scalar, Precision::Double) => work.with::<F64x1>(),
            (Self::Scalar, Precision::Single) => work.with::<F32x1>(),
        }
    }
}

/// Calls what was compiled for one number at a time, with fused products and sums if the processor has them.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(crate) fn on_any<Op: NullaryFnOnce>(op: Op) -> Op::Output {
    match V3::try_new() {
        Some(simd) => simd.vectorize(op),
        None => op.call(),
    }
}

/// Other processors that this is compiled for have their registers and fused operations from the start.
#[cfg(not(target_arch = "x86_64"))]
pub(crate) use on_scalars as on_any;

/// Calls what was compiled for any processor.
#[inline(always)]
pub(crate) fn on_scalars<Op: NullaryFnOnce>(op: Op) -> Op::Output {
    op.call()
}
