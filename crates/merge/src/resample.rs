//! What an input says of one time, on the merged field's grid.

use crate::Plan;
use crate::plan::{Between, is_same};
use std::borrow::Cow;
use tousle_core::Vec3;
use tousle_field::{Field, GridSpec, Stencil, VoxelFlag};

impl Plan {
    /// What an input says of a time, on the merged field's grid, from the two steps of it that [`Plan::wanted`]
    /// names. Where grid and time are its own, its numbers are what they were.
    ///
    /// Vectors are linear in time and in space, as sampling has them. A standard deviation is the same weighted
    /// mean of standard deviations: whatever the correlation of the parts, it is not larger. In time a flag is the
    /// lesser of the two; in space it is that of the voxel around the point, and *outside* beyond the input's box.
    ///
    /// # Panics
    /// If a step does not have the input's grid.
    pub fn view<'f>(
        &self,
        input: usize,
        between: Between,
        before: &'f Field,
        after: &Field,
    ) -> Cow<'f, Field> {
        let grid = self.grid_of(input);
        let step = match between.share {
            0.0 => Cow::Borrowed(before),
            share => Cow::Owned(in_time(before, after, share)),
        };
        if is_same(grid, &self.grid) { step } else { Cow::Owned(in_space(&step, grid, &self.grid)) }
    }
}

fn mean(a: f32, b: f32, share: f64) -> f32 {
    // Infinite means unknown, and stays so whatever its share.
    (f64::from(a) * (1.0 - share) + f64::from(b) * share) as f32
}

fn in_time(before: &Field, after: &Field, share: f64) -> Field {
    let means = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| mean(*a, *b, share)).collect();
    Field {
        u: means(&before.u, &after.u),
        flags: before.flags.iter().zip(&after.flags).map(|(a, b)| lesser(*a, *b)).collect(),
        sd: before.sd.as_ref().zip(after.sd.as_ref()).map(|(a, b)| means(a, b)),
        outside: before.outside * (1.0 - share) + after.outside * share,
    }
}

fn lesser(a: VoxelFlag, b: VoxelFlag) -> VoxelFlag {
    if (a as u8) < b as u8 { a } else { b }
}

fn in_space(step: &Field, from: &GridSpec, to: &GridSpec) -> Field {
    let mut field = Field::still(to);
    field.outside = step.outside;
    let mut sd = step.sd.as_ref().map(|_| vec![f32::INFINITY; to.n_voxels()]);
    for flat in 0..to.n_voxels() {
        let point_m: Vec3 = to.cell_center_m(to.unflat(flat));
        field.set_vector(flat, step.sample(from, point_m));
        let Some(voxel) = from.voxel_at(point_m) else { continue };
        field.flags[flat] = step.flags[from.flat(voxel)];
        if let (Some(sd), Some(theirs)) = (&mut sd, &step.sd) {
            let stencil = Stencil::at(from, point_m);
            let parts = stencil.flats.iter().zip(&stencil.weights).filter(|(_, weight)| **weight > 0.0);
            sd[flat] = parts.map(|(k, weight)| f64::from(theirs[*k]) * weight).sum::<f64>() as f32;
        }
    }
    field.sd = sd;
    field
}
