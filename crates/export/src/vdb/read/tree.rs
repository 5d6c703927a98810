//! The tree of a grid, as a list of boxes: leaves with a value a voxel, tiles with one value.

use super::bytes::Bytes;
use super::values::{self, Kind, is_on};
use crate::vdb::VdbError;

/// Voxels along the edge of a leaf, of a node of leaves, and of a node of nodes.
const LEAF: i32 = 8;
const LOWER: i32 = 16 * LEAF;
const UPPER: i32 = 32 * LOWER;
/// Bytes of their masks.
const LEAF_MASK: usize = 64;
const LOWER_MASK: usize = 512;
const UPPER_MASK: usize = 4096;

/// What a grid's tree holds.
#[derive(Debug)]
pub(super) struct Tree {
    pub background: Vec<f32>,
    pub leaves: Vec<Leaf>,
    /// Tiles that are active; those that are not and are no background would be lost on nobody.
    pub tiles: Vec<Tile>,
}

/// 8 x 8 x 8 voxels.
#[derive(Debug)]
pub(super) struct Leaf {
    pub origin: [i32; 3],
    pub active: [u8; LEAF_MASK],
    pub values: Vec<f32>,
}

/// A cube of one value.
#[derive(Debug)]
pub(super) struct Tile {
    pub origin: [i32; 3],
    pub edge: i32,
    pub value: Vec<f32>,
}

impl Tree {
    /// Reads a tree: all nodes, then the values of all leaves.
    pub fn read(bytes: &mut Bytes<'_>, kind: Kind, compression: u32) -> Result<Self, VdbError> {
        let n_buffers = bytes.u32()?;
        if n_buffers != 1 {
            return Err(bytes.bad(format!("{n_buffers} buffers of values"), "1"));
        }
        let mut tree = Self { background: kind.value(bytes)?, leaves: Vec::new(), tiles: Vec::new() };
        let (n_tiles, n_children) = (bytes.u32()?, bytes.u32()?);
        for _ in 0..n_tiles {
            let (origin, value) = (bytes.index()?, kind.value(bytes)?);
            if bytes.u8()? != 0 {
                tree.tiles.push(Tile { origin, edge: UPPER, value });
            }
        }
        for _ in 0..n_children {
            let origin = bytes.index()?;
            let mut node = Node { tree: &mut tree, kind, compression };
            node.read(bytes, origin, UPPER)?;
        }
        for k in 0..tree.leaves.len() {
            let active = bytes.take(LEAF_MASK)?;
            tree.leaves[k].active.copy_from_slice(active);
            tree.leaves[k].values = values::read(bytes, kind, compression, active, &tree.background)?;
        }
        Ok(tree)
    }
}

struct Node<'t> {
    tree: &'t mut Tree,
    kind: Kind,
    compression: u32,
}

impl Node<'_> {
    /// Reads a node of this edge and all nodes in it.
    fn read(&mut self, bytes: &mut Bytes<'_>, origin: [i32; 3], edge: i32) -> Result<(), VdbError> {
        if edge == LEAF {
            bytes.take(LEAF_MASK)?;
            self.tree.leaves.push(Leaf { origin, active: [0; LEAF_MASK], values: Vec::new() });
            return Ok(());
        }
        let (mask_size, child_edge) = if edge == UPPER { (UPPER_MASK, LOWER) } else { (LOWER_MASK, LEAF) };
        let per_edge = (edge / child_edge) as usize;
        let (children, active) = (bytes.take(mask_size)?, bytes.take(mask_size)?);
        let values = values::read(bytes, self.kind, self.compression, active, &self.tree.background)?;
        let place = |k: usize| {
            let within = [k / (per_edge * per_edge), k / per_edge % per_edge, k % per_edge];
            [0, 1, 2].map(|axis: usize| origin[axis].saturating_add(within[axis] as i32 * child_edge))
        };
        for k in (0..8 * mask_size).filter(|k| is_on(active, *k) && !is_on(children, *k)) {
            let value = values[k * self.kind.n..(k + 1) * self.kind.n].to_vec();
            self.tree.tiles.push(Tile { origin: place(k), edge: child_edge, value });
        }
        for k in (0..8 * mask_size).filter(|k| is_on(children, *k)) {
            self.read(bytes, place(k), child_edge)?;
        }
        Ok(())
    }
}
