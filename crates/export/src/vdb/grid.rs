//! One grid of an OpenVDB file.

use std::io::{self, Write};

use tousle_core::Vec3;
use tousle_field::GridSpec;

use super::metadata::{Metadata, put_metadata, put_text};
use super::tree::{put_leaves, put_topology};

/// Values are packed by zlib (1), and written for active voxels alone (2).
const COMPRESSION: u32 = 1 | 2;

/// A grid ready to be written.
pub(super) struct Grid {
    /// Name, type and the like, up to the offsets.
    header: Vec<u8>,
    /// Metadata, transform and tree.
    pub(super) body: Vec<u8>,
    /// Where in the body the leaves' values start.
    leaves_at: usize,
}

impl Grid {
    /// A grid of all voxels of `spec`, each with the `N` numbers that `value` gives for its flat index.
    pub(super) fn new<const N: usize>(
        name: &str,
        tree_type: &str,
        spec: &GridSpec,
        metadata: Vec<(&'static str, Metadata)>,
        value: impl Fn(usize) -> [f32; N],
    ) -> Self {
        let mut header = Vec::new();
        put_text(&mut header, name);
        put_text(&mut header, tree_type);
        put_text(&mut header, ""); // shares its tree with no other grid
        let mut body = COMPRESSION.to_le_bytes().to_vec();
        put_metadata(&mut body, &grid_metadata(name, spec, N, metadata));
        put_transform(&mut body, spec);
        put_topology::<N>(&mut body, spec.dims);
        let leaves_at = body.len();
        put_leaves(&mut body, spec.dims, value);
        Self { header, body, leaves_at }
    }

    /// Writes the grid at a position of the file; gives the bytes written.
    pub(super) fn write(&self, position: u64, out: &mut impl Write) -> io::Result<u64> {
        let start = position + self.header.len() as u64 + 3 * 8;
        let leaves = start + self.leaves_at as u64;
        let end = start + self.body.len() as u64;
        out.write_all(&self.header)?;
        for offset in [start, leaves, end] {
            out.write_all(&offset.to_le_bytes())?;
        }
        out.write_all(&self.body)?;
        Ok(end - position)
    }
}

/// The metadata every grid has, and the grid's own, sorted by name as OpenVDB keeps them.
fn grid_metadata(
    name: &str,
    spec: &GridSpec,
    n_components: usize,
    own: Vec<(&'static str, Metadata)>,
) -> Vec<(&'static str, Metadata)> {
    let last = spec.dims.map(|n| n as i32 - 1);
    let n_bytes = spec.n_voxels() * 4 * n_components;
    let mut all = own;
    all.extend([
        ("class", Metadata::Text("unknown".to_owned())),
        ("file_bbox_max", Metadata::Vec3i(last)),
        ("file_bbox_min", Metadata::Vec3i([0; 3])),
        ("file_compression", Metadata::Text("zip + active values".to_owned())),
        ("file_mem_bytes", Metadata::Int64(n_bytes as i64)),
        ("file_voxel_count", Metadata::Int64(spec.n_voxels() as i64)),
        ("is_saved_as_half_float", Metadata::Bool(false)),
        ("name", Metadata::Text(name.to_owned())),
    ]);
    all.sort_by_key(|(name, _)| *name);
    all
}

/// From index to head space: an edge a step, and index (0, 0, 0) on the first voxel's center.
fn put_transform(out: &mut Vec<u8>, spec: &GridSpec) {
    put_text(out, "UniformScaleTranslateMap");
    let scale = Vec3::repeat(spec.edge_m);
    let inverse = scale.map(|x| 1.0 / x);
    let translation = spec.origin_m + scale / 2.0;
    let rows = [translation, scale, scale, inverse, inverse.component_mul(&inverse), inverse / 2.0];
    out.extend(rows.iter().flatten().flat_map(|x| x.to_le_bytes()));
}
