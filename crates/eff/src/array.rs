//! Runs of numbers, packed: the four encodings of `docs/eff.md`, section "Arrays".
//!
//! What is packed here is compressed afterwards, by the chunk around it. Hence the byte planes (all first bytes,
//! then all second bytes, …): the bytes that hold sign and exponent are alike from voxel to voxel and compress,
//! the last ones are noise and are left alone.

mod f16;
mod fixed;
mod planes;

use crate::finding::Place;
use crate::wire::proto;
use crate::{Code, Finding};
use serde::Serialize;

/// How the field's vectors are packed, and what they may lose by it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Encoding {
    /// As they are, `f32`. Nothing is lost.
    #[default]
    F32,
    /// Half precision: about three digits, a third of the size.
    F16,
    /// Whole multiples of a step, small where the field is smooth.
    Fixed {
        /// The most that a component may be off, in the quantity's unit, > 0.
        max_error: f64,
    },
}

/// How far what is read may be from what was written: the larger of the two.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ErrorBound {
    /// In the quantity's unit.
    pub absolute: f64,
    /// As a share of the value.
    pub relative: f64,
}

impl Encoding {
    /// The bound that every component keeps, whatever the field.
    pub fn error_bound(self) -> ErrorBound {
        match self {
            Self::F32 => ErrorBound::default(),
            Self::F16 => ErrorBound { absolute: f16::ABSOLUTE_ERROR, relative: f16::RELATIVE_ERROR },
            Self::Fixed { max_error } => ErrorBound { absolute: max_error, relative: 0.0 },
        }
    }
}

/// How many numbers an array has, and how they lie: planes of a grid, x slowest, z fastest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shape {
    pub planes: usize,
    pub dims: [usize; 3],
}

impl Shape {
    /// Planes of a plain list of `n` numbers each.
    pub fn list(planes: usize, n: usize) -> Self {
        Self { planes, dims: [n, 1, 1] }
    }

    pub fn len(self) -> usize {
        self.planes * self.dims.iter().product::<usize>()
    }
}

/// Why numbers cannot be packed as asked.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Unpackable {
    pub found: f32,
    pub expected: String,
}

/// Packs numbers as the encoding has them.
///
/// # Errors
/// [`Unpackable`] where the encoding's bound cannot be kept.
pub(crate) fn pack(values: &[f32], shape: Shape, encoding: Encoding) -> Result<proto::Array, Unpackable> {
    debug_assert_eq!(values.len(), shape.len());
    match encoding {
        Encoding::F32 => Ok(pack_f32(values)),
        Encoding::F16 => {
            if let Some(found) =
                values.iter().find(|v| v.is_finite() && f16::pack(**v) & 0x7fff == f16::INFINITY)
            {
                return Err(Unpackable {
                    found: *found,
                    expected: "at most 65504 for half precision".into(),
                });
            }
            let halves: Vec<u16> = values.iter().map(|v| f16::pack(*v)).collect();
            let data = planes::split_16(&halves, |half| half);
            Ok(proto::Array { encoding: proto::Encoding::F16 as i32, quantum: 0.0, data: data.into() })
        }
        Encoding::Fixed { max_error } => fixed::pack(values, shape, max_error),
    }
}

/// Packs numbers as they are.
pub(crate) fn pack_f32(values: &[f32]) -> proto::Array {
    let data = planes::split_32(values, f32::to_bits);
    proto::Array { encoding: proto::Encoding::F32 as i32, quantum: 0.0, data: data.into() }
}

/// Packs numbers in half precision if all of them fit its range, as they are otherwise.
pub(crate) fn pack_f16_if_possible(values: &[f32]) -> proto::Array {
    let shape = Shape::list(1, values.len());
    pack(values, shape, Encoding::F16).unwrap_or_else(|_| pack_f32(values))
}

/// Gives the numbers of an array back. Allocates no more than the array's bytes account for.
///
/// # Errors
/// A [`Finding`] at `place` if the encoding is unknown or the bytes do not fit the shape.
pub(crate) fn unpack(
    array: &proto::Array,
    shape: Shape,
    place: Place<'_>,
    what: &str,
) -> Result<Vec<f32>, Box<Finding>> {
    let Ok(encoding) = proto::Encoding::try_from(array.encoding) else {
        let expected = "an encoding of version 1: 1 to 4";
        return Err(place.finding(Code::Encoding, format!("{what}.encoding"), array.encoding, expected));
    };
    let width = match encoding {
        proto::Encoding::F16 | proto::Encoding::Fixed16 => 2,
        proto::Encoding::F32 | proto::Encoding::Fixed32 => 4,
        proto::Encoding::Unspecified => {
            let expected = "an encoding of version 1: 1 to 4";
            return Err(place.finding(Code::Encoding, format!("{what}.encoding"), 0, expected));
        }
    };
    if array.data.len() != shape.len() * width {
        let found = format!("{} bytes", array.data.len());
        let expected = format!("{} ({} numbers of {width} bytes)", shape.len() * width, shape.len());
        return Err(place.finding(Code::Size, format!("{what}.data"), found, expected));
    }
    let data = &array.data;
    match encoding {
        proto::Encoding::F32 => Ok(planes::join_32(data).map(f32::from_bits).collect()),
        proto::Encoding::F16 => Ok(planes::join_16(data).map(f16::unpack).collect()),
        _ if !(array.quantum.is_finite() && array.quantum > 0.0) => {
            let expected = "a finite number above 0";
            Err(place.finding(Code::Encoding, format!("{what}.quantum"), array.quantum, expected))
        }
        _ => Ok(fixed::unpack(data, width, array.quantum, shape)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn unpacked(array: &proto::Array, shape: Shape) -> Vec<f32> {
        unpack(array, shape, Place::default(), "u").unwrap()
    }

    fn shape_and_values(range: std::ops::Range<f32>) -> impl Strategy<Value = (Shape, Vec<f32>)> {
        (1..4usize, [1..6usize, 1..6, 1..6]).prop_flat_map(move |(planes, dims)| {
            let shape = Shape { planes, dims };
            (Just(shape), prop::collection::vec(range.clone(), shape.len()))
        })
    }

    proptest! {
        #[test]
        fn f32_loses_nothing((shape, values) in shape_and_values(-1e9..1e9)) {
            let array = pack(&values, shape, Encoding::F32).unwrap();
            prop_assert_eq!(unpacked(&array, shape), values);
        }

        #[test]
        fn f16_keeps_its_bound((shape, values) in shape_and_values(-6e4..6e4), scale in -12..1i32) {
            let values: Vec<f32> = values.iter().map(|v| v * 10f32.powi(scale)).collect();
            let array = pack(&values, shape, Encoding::F16).unwrap();
            let bound = Encoding::F16.error_bound();
            for (read, written) in unpacked(&array, shape).into_iter().zip(values) {
                let (read, written) = (f64::from(read), f64::from(written));
                let allowed = bound.absolute.max(bound.relative * written.abs());
                prop_assert!((read - written).abs() <= allowed, "{} {}", read, written);
            }
        }

        #[test]
        fn fixed_keeps_its_bound(
            (shape, values) in shape_and_values(-150.0..150.0),
            max_error in prop::sample::select(vec![1.0, 0.1, 1e-2, 1e-3, 1e-4, 2e-5]),
        ) {
            let array = pack(&values, shape, Encoding::Fixed { max_error }).unwrap();
            for (read, written) in unpacked(&array, shape).into_iter().zip(values) {
                prop_assert!((f64::from(read) - f64::from(written)).abs() <= max_error, "{} {}", read, written);
            }
        }

        #[test]
        fn no_bytes_panic(
            encoding in -1..6i32,
            quantum in prop::num::f64::ANY,
            data in prop::collection::vec(any::<u8>(), 0..40),
            dims in [0..4usize, 0..4, 0..4],
        ) {
            let array = proto::Array { encoding, quantum, data: data.into() };
            let _ = unpack(&array, Shape { planes: 1, dims }, Place::default(), "u");
        }
    }

    #[test]
    fn what_cannot_be_kept_is_refused() {
        let shape = Shape::list(1, 2);
        assert_eq!(pack(&[1.0, 7e4], shape, Encoding::F16).unwrap_err().found, 7e4);
        // A float near 1e4 moves in steps of 1e-3: no integer grid brings it within 1e-5.
        let error = pack(&[1.0, 1e4], shape, Encoding::Fixed { max_error: 1e-5 }).unwrap_err();
        assert_eq!(error.found, 1e4);
        assert_eq!(pack_f16_if_possible(&[1.0, 7e4]).encoding, proto::Encoding::F32 as i32);
        assert_eq!(pack_f16_if_possible(&[1.0, f32::INFINITY]).encoding, proto::Encoding::F16 as i32);
    }

    #[test]
    fn an_unknown_encoding_is_named() {
        let array = proto::Array { encoding: 9, quantum: 0.0, data: vec![0; 4].into() };
        let finding = unpack(&array, Shape::list(1, 1), Place::default(), "u").unwrap_err();
        assert_eq!(finding.code, Code::Encoding);
        assert_eq!(
            finding.to_string(),
            "encoding: u.encoding: found 9, expected an encoding of version 1: 1 to 4"
        );
    }
}
