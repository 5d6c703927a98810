//! A field as NumPy arrays: the writer, and the options of the reader (`read_field.rs`).

use std::borrow::Cow;
use std::io::{Seek, Write};

use tousle_field::FieldSequence;

use super::writer::NpzWriter;
use crate::ExportError;

/// Writes a field as NumPy reads it, edits added to the voxels ([`FieldSequence::flattened`]).
///
/// | array | shape, type | |
/// |---|---|---|
/// | `t` | (T) f64 | time of each step, s |
/// | `u` | (T, 3, X, Y, Z) f32 | vectors at voxel centers, head axes |
/// | `flag` | (T, X, Y, Z) u8 | 0 outside, 1 interpolated, 2 measured |
/// | `origin` | (3) f64 | outer corner of voxel (0, 0, 0), head space, m |
/// | `edge` | () f64 | edge of a voxel, m |
/// | `quantity` | () text | `air_velocity` (m/s) or `force_per_mass` (m/s²) |
/// | `outside` | (T, 3) f64 | what holds outside the grid, head axes |
/// | `sd` | (T, X, Y, Z) f32 | standard deviation, infinite where nobody knows; only if every step has one |
///
/// The same field gives the same bytes. Wrap a file in a [`std::io::BufWriter`].
///
/// # Errors
/// [`ExportError::BadField`] if the field fails its own check, [`ExportError::Io`] if `out` takes no more.
pub fn write_field_npz(field: &FieldSequence, out: impl Write + Seek) -> Result<(), ExportError> {
    field.check()?;
    let flat = if field.layers.is_empty() { Cow::Borrowed(field) } else { Cow::Owned(field.flattened()) };
    let steps = &flat.steps;
    let [x, y, z] = flat.grid.dims;
    let n_steps = steps.len();
    let mut npz = NpzWriter::packed(out);
    npz.array("t", &[n_steps], (0..n_steps).map(|k| flat.time_secs(k)))?;
    npz.array("origin", &[3], flat.grid.origin_m.iter().copied())?;
    npz.array("edge", &[], std::iter::once(flat.grid.edge_m))?;
    npz.text("quantity", flat.quantity.name())?;
    npz.array("outside", &[n_steps, 3], steps.iter().flat_map(|s| s.outside.iter().copied()))?;
    npz.array("u", &[n_steps, 3, x, y, z], steps.iter().flat_map(|s| s.u.iter().copied()))?;
    npz.array("flag", &[n_steps, x, y, z], steps.iter().flat_map(|s| s.flags.iter().map(|f| *f as u8)))?;
    if steps.iter().all(|s| s.sd.is_some()) {
        let sd = steps.iter().flat_map(|s| s.sd.iter().flatten().copied());
        npz.array("sd", &[n_steps, x, y, z], sd)?;
    }
    npz.finish()?;
    Ok(())
}
