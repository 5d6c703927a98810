//! Whole multiples of a quantum, as differences along the three axes.
//!
//! Where a field is smooth, a voxel is nearly the sum of its three nearer neighbors less the two that those
//! share, plus the one that all share (Ibarria et al. 2003, "Out-of-core compression and decompression of large
//! n-dimensional scalar fields", the Lorenzo predictor). What is left after that prediction is what remains
//! after taking differences along z, then y, then x; so a reader takes running sums along each axis.

use super::{Shape, Unpackable, planes};
use crate::wire::proto::{self, Encoding};

/// Packs numbers as multiples of a quantum that keeps every one within `max_error`, what a float rounds
/// included. 16 bits if they suffice, else 32.
pub(super) fn pack(values: &[f32], shape: Shape, max_error: f64) -> Result<proto::Array, Unpackable> {
    let largest = values.iter().copied().fold(0.0, |a: f32, v| if v.abs() <= a { a } else { v.abs() });
    let unpackable = || {
        let expected = format!("values small enough that single precision keeps them within {max_error}");
        Unpackable { found: largest, expected }
    };
    if !largest.is_finite() {
        return Err(unpackable());
    }
    // A reader rounds multiple x quantum to a float: up to half its last place is spent on that. The multiple
    // may lie beyond the largest value, where last places are worth more.
    let beyond = (f64::from(largest) + max_error) as f32;
    let spent = f64::from((beyond.next_up() - beyond) / 2.0);
    let quantum = 2.0 * (max_error - spent) * (1.0 - 1e-12);
    let most = f64::from(largest) / quantum;
    if !(quantum > 0.0 && most <= 2e9) {
        return Err(unpackable());
    }
    let multiples: Vec<i32> = values.iter().map(|v| (f64::from(*v) / quantum).round() as i32).collect();
    if multiples.iter().all(|m| i16::try_from(*m).is_ok()) {
        let narrow: Vec<i16> = multiples.iter().map(|m| *m as i16).collect();
        let left = differences(narrow, shape, i16::wrapping_sub);
        let data = planes::split_16(&left, |d| ((d << 1) ^ (d >> 15)) as u16);
        Ok(proto::Array { encoding: Encoding::Fixed16 as i32, quantum, data: data.into() })
    } else {
        let left = differences(multiples, shape, i32::wrapping_sub);
        let data = planes::split_32(&left, |d| ((d << 1) ^ (d >> 31)) as u32);
        Ok(proto::Array { encoding: Encoding::Fixed32 as i32, quantum, data: data.into() })
    }
}

/// The numbers that [`pack`] packed; `width` bytes each, 2 or 4.
pub(super) fn unpack(data: &[u8], width: usize, quantum: f64, shape: Shape) -> Vec<f32> {
    if width == 2 {
        let left = planes::join_16(data).map(|d| (d >> 1) as i16 ^ -((d & 1) as i16));
        let multiples = sums(left.collect(), shape, i16::wrapping_add);
        multiples.into_iter().map(|m| (f64::from(m) * quantum) as f32).collect()
    } else {
        let left = planes::join_32(data).map(|d| (d >> 1) as i32 ^ -((d & 1) as i32));
        let multiples = sums(left.collect(), shape, i32::wrapping_add);
        multiples.into_iter().map(|m| (f64::from(m) * quantum) as f32).collect()
    }
}

/// Differences to the neighbor before, along each axis in turn. They wrap, and so do the sums that undo them.
fn differences<T: Copy>(mut values: Vec<T>, shape: Shape, minus: fn(T, T) -> T) -> Vec<T> {
    for (stride, block) in axes(shape) {
        for block in values.chunks_exact_mut(block.max(1)) {
            for k in (stride..block.len()).rev() {
                block[k] = minus(block[k], block[k - stride]);
            }
        }
    }
    values
}

/// Running sums along each axis in turn.
fn sums<T: Copy>(mut values: Vec<T>, shape: Shape, plus: fn(T, T) -> T) -> Vec<T> {
    for (stride, block) in axes(shape) {
        for block in values.chunks_exact_mut(block.max(1)) {
            for k in stride..block.len() {
                block[k] = plus(block[k], block[k - stride]);
            }
        }
    }
    values
}

/// For z, y, x: how far apart neighbors along it lie, and how long a run is in which only it and what is
/// faster changes.
fn axes(shape: Shape) -> [(usize, usize); 3] {
    let [nx, ny, nz] = shape.dims;
    [(1, nz), (nz, ny * nz), (ny * nz, nx * ny * nz)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A 2 x 2 grid: what is left is the first value, two steps along an edge, and what those two do not tell.
    #[test]
    fn differences_by_hand() {
        let shape = Shape { planes: 1, dims: [1, 2, 2] };
        // 10 13
        // 12 16: the plane through the first three gives 15.
        let left = differences(vec![10i16, 13, 12, 16], shape, i16::wrapping_sub);
        assert_eq!(left, [10, 3, 2, 1]);
        assert_eq!(sums(left, shape, i16::wrapping_add), [10, 13, 12, 16]);
    }

    #[test]
    fn planes_are_apart() {
        let shape = Shape { planes: 2, dims: [2, 1, 1] };
        assert_eq!(differences(vec![5i32, 6, 100, 90], shape, i32::wrapping_sub), [5, 1, 100, -10]);
    }

    #[test]
    fn what_wraps_comes_back() {
        let shape = Shape { planes: 1, dims: [2, 2, 2] };
        let values = vec![i16::MAX, i16::MIN, 7, i16::MAX, i16::MIN, i16::MIN, 0, i16::MAX];
        let left = differences(values.clone(), shape, i16::wrapping_sub);
        assert_eq!(sums(left, shape, i16::wrapping_add), values);
    }

    #[test]
    fn width_follows_the_range() {
        let narrow = pack(&[1.0, -2.0], Shape::list(1, 2), 1e-3).unwrap();
        assert_eq!((narrow.encoding, narrow.data.len()), (Encoding::Fixed16 as i32, 4));
        let wide = pack(&[100.0, -2.0], Shape::list(1, 2), 1e-3).unwrap();
        assert_eq!((wide.encoding, wide.data.len()), (Encoding::Fixed32 as i32, 8));
    }
}
