//! Runs of values in a file: packed or not, in half precision or not, with or without those that are not active.

use super::blosc;
use super::bytes::Bytes;
use crate::npz::half;
use crate::vdb::VdbError;

/// How a grid's values are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kind {
    /// Numbers a value: 3 for vectors.
    pub n: usize,
    /// Bytes a number.
    pub width: usize,
    /// Whether runs of values are in half precision.
    pub is_half: bool,
}

impl Kind {
    /// The kind of a tree's name; `None` for one that is not read here.
    pub fn from_tree(name: &str) -> Option<Self> {
        let (name, is_half) = match name.strip_suffix("_HalfFloat") {
            Some(name) => (name, true),
            None => (name, false),
        };
        let (n, width) = match name {
            "Tree_vec3s_5_4_3" => (3, 4),
            "Tree_vec3d_5_4_3" => (3, 8),
            "Tree_float_5_4_3" => (1, 4),
            "Tree_double_5_4_3" => (1, 8),
            _ => return None,
        };
        Some(Self { n, width, is_half })
    }

    /// One value as it is outside of runs.
    pub fn value(self, bytes: &mut Bytes<'_>) -> Result<Vec<f32>, VdbError> {
        Ok(numbers(bytes.take(self.n * self.width)?, self.width))
    }
}

fn numbers(bytes: &[u8], width: usize) -> Vec<f32> {
    match width {
        2 => bytes.as_chunks().0.iter().map(|b| half(u16::from_le_bytes(*b)) as f32).collect(),
        4 => bytes.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect(),
        _ => bytes.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b) as f32).collect(),
    }
}

const ZIP: u32 = 1;
const ACTIVE_MASK: u32 = 2;
const BLOSC: u32 = 4;

/// Whether all flags are known.
pub(super) fn is_known(compression: u32) -> bool {
    compression & !(ZIP | ACTIVE_MASK | BLOSC) == 0
}

/// What a node's byte says of the values that are not active (`io/Compression.h`).
mod inactive {
    /// The background.
    pub const BACKGROUND: u8 = 0;
    // 1 is the background with its sign turned.
    /// One value, which follows.
    pub const ONE: u8 = 2;
    /// The background here, with its sign turned there: a mask follows.
    pub const MASK: u8 = 3;
    /// The background there, one value here.
    pub const MASK_AND_ONE: u8 = 4;
    /// One value here, another there.
    pub const MASK_AND_TWO: u8 = 5;
    /// They are all there, like those that are active.
    pub const ALL: u8 = 6;
}

/// Reads the values of a node, `8 * active.len()` of them: numbers, value after value.
pub(super) fn read(
    bytes: &mut Bytes<'_>,
    kind: Kind,
    compression: u32,
    active: &[u8],
    background: &[f32],
) -> Result<Vec<f32>, VdbError> {
    let n_values = 8 * active.len();
    let how = bytes.u8()?;
    if how > inactive::ALL {
        return Err(bytes.bad(format!("the node byte {how}"), "0 to 6"));
    }
    // What is where the second mask is off, and where it is on.
    let sign = if how == inactive::BACKGROUND { 1.0 } else { -1.0 };
    let mut off: Vec<f32> = background.iter().map(|x| sign * x).collect();
    let mut on = background.to_vec();
    if matches!(how, inactive::ONE | inactive::MASK_AND_ONE | inactive::MASK_AND_TWO) {
        off = kind.value(bytes)?;
        if how == inactive::MASK_AND_TWO {
            on = kind.value(bytes)?;
        }
    }
    let mask = match how {
        inactive::MASK | inactive::MASK_AND_ONE | inactive::MASK_AND_TWO => Some(bytes.take(active.len())?),
        _ => None,
    };
    let has_all = compression & ACTIVE_MASK == 0 || how == inactive::ALL;
    let n_kept = if has_all { n_values } else { active.iter().map(|b| b.count_ones() as usize).sum() };
    let width = if kind.is_half { 2 } else { kind.width };
    if kind.is_half && n_kept == 0 {
        // Not even a length is written for half numbers of which there are none.
        return Ok(filled(n_values, active, mask, &on, &off, &[], kind.n));
    }
    let kept = numbers(&unpacked(bytes, n_kept * kind.n * width, compression)?, width);
    if has_all {
        return Ok(kept);
    }
    Ok(filled(n_values, active, mask, &on, &off, &kept, kind.n))
}

/// The values of all places: those that were kept where they are active, one of two elsewhere.
fn filled(
    n_values: usize,
    active: &[u8],
    mask: Option<&[u8]>,
    on: &[f32],
    off: &[f32],
    kept: &[f32],
    n: usize,
) -> Vec<f32> {
    let mut kept = kept.chunks_exact(n);
    let mut values = Vec::with_capacity(n_values * n);
    for k in 0..n_values {
        let of_mask = if mask.is_some_and(|mask| is_on(mask, k)) { on } else { off };
        let value = if is_on(active, k) { kept.next().unwrap_or(of_mask) } else { of_mask };
        values.extend_from_slice(value);
    }
    values
}

/// The next run of bytes, unpacked to `n`.
fn unpacked(bytes: &mut Bytes<'_>, n: usize, compression: u32) -> Result<Vec<u8>, VdbError> {
    if compression & (ZIP | BLOSC) == 0 {
        return Ok(bytes.take(n)?.to_vec());
    }
    let length = bytes.i64()?;
    let at = *bytes;
    let size = usize::try_from(length.unsigned_abs()).unwrap_or(usize::MAX);
    let data = bytes.take(size)?;
    if length <= 0 {
        return if size == n {
            Ok(data.to_vec())
        } else {
            Err(at.bad(format!("{size} bytes"), format!("{n} bytes")))
        };
    }
    if compression & BLOSC != 0 {
        return blosc::unpack(data, n).map_err(|found| at.bad(found, "what Blosc packed with LZ4 or zlib"));
    }
    blosc::inflate(data, n)
        .ok_or_else(|| at.bad("a run that zlib does not unpack to its size", format!("{n} bytes")))
}

/// Whether a bit of a mask is set. Masks are 64-bit words, little endian.
pub(super) fn is_on(mask: &[u8], bit: usize) -> bool {
    mask.get(bit / 8).is_some_and(|byte| byte >> (bit % 8) & 1 == 1)
}
