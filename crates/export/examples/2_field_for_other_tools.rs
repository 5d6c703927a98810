//! A field as files for other tools: `cargo run -p tousle-export --example 2_field_for_other_tools -- FOLDER`.
//!
//! Writes `field.npz` (NumPy) and `field.0000.vdb` to `field.0004.vdb` (OpenVDB, one file a time step).

use std::fs::File;
use std::io::{BufWriter, Error};
use std::path::Path;

use tousle_core::{Quantity, Vec3};
use tousle_export::{write_field_npz, write_step_vdb};
use tousle_field::{Field, FieldSequence, GridSpec, VoxelFlag};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).ok_or_else(|| Error::other("found no folder, expected one"))?;
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    let field = field()?;
    write_field_npz(&field, BufWriter::new(File::create(folder.join("field.npz"))?))?;
    for step in 0..field.steps.len() {
        let file = File::create(folder.join(format!("field.{step:04}.vdb")))?;
        write_step_vdb(&field, step, BufWriter::new(file))?;
    }
    println!("{:?} voxels, {} steps: {}", field.grid.dims, field.steps.len(), folder.display());
    Ok(())
}

/// A vortex about the head's z axis that speeds up, on a box that is no cube.
fn field() -> Result<FieldSequence, Box<dyn std::error::Error>> {
    let grid = GridSpec { dims: [30, 17, 24], ..GridSpec::cube(0.6, 0.02)? };
    let step = |k: u8| {
        let mut step = Field::still(&grid);
        let mut sd = Vec::new();
        for flat in 0..grid.n_voxels() {
            let p = grid.cell_center_m(grid.unflat(flat));
            step.set_vector(flat, Vec3::new(-p.y, p.x, 0.1 * p.z) * f64::from(k + 1) * 10.0);
            step.flags[flat] = if p.norm() < 0.15 { VoxelFlag::Measured } else { VoxelFlag::Interpolated };
            sd.push((p.norm() * 2.0) as f32);
        }
        Field { sd: Some(sd), outside: Vec3::new(-3.0, 0.5, 0.25), ..step }
    };
    Ok(FieldSequence {
        grid,
        quantity: Quantity::AirVelocity,
        start_secs: 0.5,
        rate_hz: 30.0,
        steps: (0..5).map(step).collect(),
        layers: Vec::new(),
    })
}
