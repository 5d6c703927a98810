//! One time step of a field as an OpenVDB file (`.vdb`); [`read`] takes it, and other programs' files, in again.
//!
//! An own writer: no crate writes the format. It is file version 224, which OpenVDB has read since version 4 and
//! writes today. OpenVDB's sources are its only specification (`io/Archive.cc`, `tree/RootNode.h`,
//! `tree/InternalNode.h`, `tree/LeafNode.h`, `io/Compression.h`).

mod error;
mod grid;
mod metadata;
mod read;
mod tree;
mod uuid;

use std::io::Write;

use tousle_field::{Field, FieldSequence};

use crate::ExportError;
pub use error::VdbError;
use grid::Grid;
use metadata::{Metadata, put_metadata};
pub use read::{VdbOptions, VdbStep, join_steps_vdb, read_step_vdb};

const MAGIC: i64 = 0x5644_4220;
const FILE_VERSION: u32 = 224;
/// The library that is said to have written the file; what matters to readers is the file version.
const LIBRARY_VERSION: [u32; 2] = [10, 0];

/// Writes one step of a field as OpenVDB reads it, edits added to the voxels ([`FieldSequence::flattened`]).
///
/// | grid | type | |
/// |---|---|---|
/// | `wind` | `vec3s` | the vectors, head axes; metadata `quantity` and `unit` say what they are |
/// | `flag` | `float` | 0 outside, 1 interpolated, 2 measured |
/// | `sd` | `float` | standard deviation; only if the step has one |
///
/// Every voxel of the box is active, index (0, 0, 0) is the first; the transform takes an index to the voxel's
/// center in head space, m: x forward, y to the subject's left, z up. The file's metadata has the step's time, the
/// steps a second, the corner of the box and the wind outside. The same field gives the same bytes: the file's UUID is made from its contents.
///
/// # Errors
/// [`ExportError::BadField`] if the field fails its own check, [`ExportError::BadOptions`] if there is no such
/// step, [`ExportError::Io`] if `out` takes no more.
pub fn write_step_vdb(field: &FieldSequence, step: usize, mut out: impl Write) -> Result<(), ExportError> {
    let step = flattened_step(field, step)?;
    let grids = grids(&step, &step.steps[0]);
    let mut header = Vec::new();
    put_metadata(&mut header, &file_metadata(&step));
    header.extend((grids.len() as u32).to_le_bytes());

    let uuid = uuid::from_contents(std::iter::once(&header).chain(grids.iter().map(|g| &g.body)));
    let mut bytes = Vec::new();
    bytes.extend(MAGIC.to_le_bytes());
    bytes.extend(FILE_VERSION.to_le_bytes());
    bytes.extend(LIBRARY_VERSION.iter().flat_map(|v| v.to_le_bytes()));
    bytes.push(1); // grids are found by their offsets
    bytes.extend(uuid.as_bytes());
    bytes.append(&mut header);
    out.write_all(&bytes)?;

    let mut position = bytes.len() as u64;
    for grid in &grids {
        position += grid.write(position, &mut out)?;
    }
    out.flush()?;
    Ok(())
}

/// One step as a field of its own, with its edits in the voxels. Flattening the others would be for nothing.
fn flattened_step(field: &FieldSequence, step: usize) -> Result<FieldSequence, ExportError> {
    let Some(only) = field.steps.get(step) else {
        let (found, expected) = (format!("step {step}"), format!("one below {}", field.steps.len()));
        return Err(ExportError::BadOptions { found, expected });
    };
    let one = FieldSequence {
        grid: field.grid,
        quantity: field.quantity,
        start_secs: field.time_secs(step),
        rate_hz: field.rate_hz,
        steps: vec![only.clone()],
        layers: field.layers.clone(),
    };
    one.check()?;
    Ok(if one.layers.is_empty() { one } else { one.flattened() })
}

fn grids(field: &FieldSequence, step: &Field) -> Vec<Grid> {
    let spec = &field.grid;
    let n_voxels = spec.n_voxels();
    let mut wind = vec![
        ("quantity", Metadata::Text(field.quantity.name().to_owned())),
        ("unit", Metadata::Text(field.quantity.unit().to_owned())),
    ];
    // How the vectors turn when a tool turns the grid: as velocities do.
    wind.push(("vector_type", Metadata::Text("contravariant relative".to_owned())));
    let vector = |flat: usize| [0, 1, 2].map(|axis| step.u[axis * n_voxels + flat]);
    let mut grids = vec![
        Grid::new("wind", "Tree_vec3s_5_4_3", spec, wind, vector),
        Grid::new("flag", "Tree_float_5_4_3", spec, Vec::new(), |flat| [f32::from(step.flags[flat] as u8)]),
    ];
    if let Some(sd) = &step.sd {
        grids.push(Grid::new("sd", "Tree_float_5_4_3", spec, Vec::new(), |flat| [sd[flat]]));
    }
    grids
}

fn file_metadata(field: &FieldSequence) -> Vec<(&'static str, Metadata)> {
    let outside: [f64; 3] = field.steps[0].outside.into();
    vec![
        ("creator", Metadata::Text("tousle".to_owned())),
        ("origin_m", Metadata::Vec3d(field.grid.origin_m.into())),
        ("outside", Metadata::Vec3d(outside)),
        ("rate_hz", Metadata::Double(field.rate_hz)),
        ("space", Metadata::Text("head: x forward, y to the subject's left, z up; m".to_owned())),
        ("time_secs", Metadata::Double(field.start_secs)),
    ]
}
