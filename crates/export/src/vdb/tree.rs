//! The tree of an OpenVDB grid: a root, nodes of 32³ and of 16³ children, leaves of 8³ voxels.
//!
//! A box of voxels, all active, from index (0, 0, 0) on. Inner nodes hold children only; leaves that stick out of
//! the box hold active values for what is inside, the background for the rest. Values are written for active
//! voxels alone, and packed by zlib (the format's "active mask" and "zip" compressions).

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

/// Voxels along the edge of a leaf, of a node of leaves, and of a node of nodes.
const LEAF: usize = 8;
const LOWER: usize = 16 * LEAF;
const UPPER: usize = 32 * LOWER;

/// A node's byte that says: all inactive values are the background, and only active ones follow.
const ONLY_ACTIVE: u8 = 0;

/// Everything about a tree but the values in its leaves. The background is 0.
pub(super) fn put_topology<const N: usize>(out: &mut Vec<u8>, dims: [usize; 3]) {
    out.extend(1_u32.to_le_bytes()); // one buffer of values
    out.extend([0_f32; N].iter().flat_map(|x| x.to_le_bytes())); // background
    let uppers = blocks([0; 3], dims, UPPER);
    out.extend(0_u32.to_le_bytes()); // tiles
    out.extend((uppers.len() as u32).to_le_bytes());
    for upper in uppers {
        out.extend(upper.iter().flat_map(|x| (*x as i32).to_le_bytes()));
        put_inner::<4096>(out, upper, dims, UPPER, LOWER);
        for lower in blocks(upper, ends(upper, dims, UPPER), LOWER) {
            put_inner::<512>(out, lower, dims, LOWER, LEAF);
            for leaf in blocks(lower, ends(lower, dims, LOWER), LEAF) {
                out.extend(leaf_mask(leaf, dims));
            }
        }
    }
}

/// The leaves' values, in the order of [`put_topology`].
pub(super) fn put_leaves<const N: usize>(
    out: &mut Vec<u8>,
    dims: [usize; 3],
    value: impl Fn(usize) -> [f32; N],
) {
    let mut values = Vec::new();
    for upper in blocks([0; 3], dims, UPPER) {
        for lower in blocks(upper, ends(upper, dims, UPPER), LOWER) {
            for leaf in blocks(lower, ends(lower, dims, LOWER), LEAF) {
                out.extend(leaf_mask(leaf, dims));
                out.push(ONLY_ACTIVE);
                values.clear();
                each_voxel(leaf, dims, |_, flat| {
                    values.extend(value(flat).iter().flat_map(|x| x.to_le_bytes()));
                });
                put_packed(out, &values);
            }
        }
    }
}

/// A node of nodes: which children it has, no active values of its own, and no values therefore.
fn put_inner<const N_BYTES: usize>(
    out: &mut Vec<u8>,
    origin: [usize; 3],
    dims: [usize; 3],
    size: usize,
    child: usize,
) {
    let per_edge = size / child;
    let mut children = [0_u8; N_BYTES];
    for block in blocks(origin, ends(origin, dims, size), child) {
        let [x, y, z] = [0, 1, 2].map(|axis| (block[axis] - origin[axis]) / child);
        set(&mut children, (x * per_edge + y) * per_edge + z);
    }
    out.extend(children);
    out.extend([0_u8; N_BYTES]);
    out.push(ONLY_ACTIVE);
    put_packed(out, &[]);
}

/// Bytes packed by zlib behind the length of what follows; as they are behind their negative length if packing
/// does not make them shorter.
fn put_packed(out: &mut Vec<u8>, bytes: &[u8]) {
    // The fastest level: floating-point noise packs no better at any other.
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    let packed = encoder.write_all(bytes).and_then(|()| encoder.finish());
    match packed {
        Ok(packed) if packed.len() < bytes.len() => {
            out.extend((packed.len() as i64).to_le_bytes());
            out.extend(packed);
        }
        _ => {
            out.extend((-(bytes.len() as i64)).to_le_bytes());
            out.extend(bytes);
        }
    }
}

/// Origins of the cubes of `size` that a box from `low` to `high` touches, x slowest, as nodes order children.
fn blocks(low: [usize; 3], high: [usize; 3], size: usize) -> Vec<[usize; 3]> {
    let along = |axis: usize| (low[axis]..high[axis]).step_by(size);
    along(0).flat_map(|x| along(1).flat_map(move |y| along(2).map(move |z| [x, y, z]))).collect()
}

/// Where a node that starts at `origin` ends, within the box.
fn ends(origin: [usize; 3], dims: [usize; 3], size: usize) -> [usize; 3] {
    [0, 1, 2].map(|axis| dims[axis].min(origin[axis] + size))
}

fn leaf_mask(leaf: [usize; 3], dims: [usize; 3]) -> [u8; 64] {
    let mut mask = [0; 64];
    each_voxel(leaf, dims, |bit, _| set(&mut mask, bit));
    mask
}

/// The voxels of a leaf that are in the box: place in the leaf, place in the field.
fn each_voxel(leaf: [usize; 3], dims: [usize; 3], mut visit: impl FnMut(usize, usize)) {
    let [end_x, end_y, end_z] = ends(leaf, dims, LEAF);
    for x in leaf[0]..end_x {
        for y in leaf[1]..end_y {
            for z in leaf[2]..end_z {
                let bit = ((x - leaf[0]) * LEAF + (y - leaf[1])) * LEAF + (z - leaf[2]);
                visit(bit, (x * dims[1] + y) * dims[2] + z);
            }
        }
    }
}

/// Sets a bit of a mask. Masks are 64-bit words, little endian, so bit `k` is bit `k % 8` of byte `k / 8`.
fn set(mask: &mut [u8], bit: usize) {
    mask[bit / 8] |= 1 << (bit % 8);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 9 x 1 x 2 voxels are two leaves along x: the first full along x, the second with one layer.
    #[test]
    fn a_small_box() {
        let dims = [9, 1, 2];
        let mut topology = Vec::new();
        put_topology::<1>(&mut topology, dims);
        // Buffers, background, tiles, children, origin; two inner nodes of two masks, a byte and the length of no
        // values; two leaf masks.
        assert_eq!(topology.len(), 4 + 4 + 4 + 4 + 12 + (2 * 4096 + 9) + (2 * 512 + 9) + 2 * 64);
        let upper = &topology[28..28 + 4096];
        assert_eq!((upper[0], upper.iter().map(|b| b.count_ones()).sum::<u32>()), (1, 1));
        let lower = &topology[28 + 8201..][..512];
        // Children at (0, 0, 0) and (1, 0, 0): bits 0 and 256.
        assert_eq!((lower[0], lower[32], lower.iter().map(|b| b.count_ones()).sum::<u32>()), (1, 1, 2));

        let mut leaves = Vec::new();
        put_leaves(&mut leaves, dims, |flat| [flat as f32]);
        // Few numbers do not pack: they stand as they are behind minus their length.
        assert_eq!((leaves[0], leaves[8], leaves[64]), (0b11, 0b11, 0));
        assert_eq!(leaves[65..73], (-64_i64).to_le_bytes());
        let second = &leaves[65 + 8 + 64..];
        assert_eq!((second[0], second[8], second.len()), (0b11, 0, 65 + 8 + 8));
        assert_eq!(second[65..73], (-8_i64).to_le_bytes());
        assert_eq!(second[73..], [16_f32.to_le_bytes(), 17_f32.to_le_bytes()].concat());
    }

    #[test]
    fn equal_values_pack() {
        let mut out = Vec::new();
        put_packed(&mut out, &[0; 512]);
        let n = i64::from_le_bytes(out[..8].try_into().unwrap());
        assert!((1..64).contains(&n), "{n}");
        assert_eq!(out.len(), 8 + n as usize);
        out.clear();
        put_packed(&mut out, &[]);
        assert_eq!(out, 0_i64.to_le_bytes());
    }

    #[test]
    fn a_box_longer_than_a_node_has_several() {
        assert_eq!(blocks([0; 3], [4097, 1, 1], UPPER), [[0, 0, 0], [4096, 0, 0]]);
        assert_eq!(blocks([4096, 0, 0], ends([4096, 0, 0], [4097, 1, 1], UPPER), LOWER), [[4096, 0, 0]]);
    }
}
