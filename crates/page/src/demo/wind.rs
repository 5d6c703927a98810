use crate::{Packed, short};
use serde::Serialize;
use tousle_field::{Field, FieldSequence, GridSpec, VoxelFlag, VoxelIndex};

/// The field as the page's script gets it: every n-th voxel of every n-th step.
#[derive(Serialize)]
pub(super) struct WindData {
    quantity: &'static str,
    unit: &'static str,
    /// Voxels shown along x, y, z.
    dims: [usize; 3],
    /// Center of the first voxel shown, head space, m.
    first_m: [f64; 3],
    /// Distance between the centers of voxels shown, m.
    edge_m: f64,
    /// Outer corners of the grid, head space, m.
    corners_m: [[f64; 3]; 2],
    start_secs: f64,
    rate_hz: f64,
    n_steps: usize,
    /// The value of 1 in `vectors`, in the quantity's unit.
    step: f64,
    /// Step after step: all x components, then y, then z; x slowest.
    vectors: Packed,
    /// Step after step: 0 outside, 1 interpolated, 2 measured.
    flags: Packed,
    /// The vector outside the grid at each step shown.
    outside: Vec<[f64; 3]>,
    /// 99 % of the vectors shown are no longer than this: the top of the color scale.
    top: f64,
    /// Mean length where hair was (measured and interpolated), at each step shown; outside if there is none.
    profile: Vec<f64>,
    /// Share of all voxels and steps that are outside, interpolated, measured.
    pub(super) shares: [f64; 3],
}

/// Steps a second that are kept: gusts of up to 5 Hz show, and 30³ voxels for 5 s stay below 2 MB.
const SHOWN_RATE_HZ: f64 = 15.0;

/// Voxels shown a step, and numbers shown in all.
const MAX_VOXELS: usize = 36 * 36 * 36;
const MAX_NUMBERS: usize = 8_000_000;

/// Characters that the packed vectors may take. Wind that is smooth in space takes about 2 bytes a vector; what is
/// noisier than that is shown at fewer times.
const MAX_TEXT: usize = 3_500_000;

/// Vectors are quantized to this share of their 99th percentile: a third of a pixel of the longest arrow.
const STEP_SHARE: f64 = 0.01;

/// Packs the field, thinned out to what a page can carry, its layers added in.
pub(super) fn wind_data(field: &FieldSequence, blobs: &mut Vec<Packed>, notes: &mut Vec<String>) -> WindData {
    let flat;
    let field = if field.layers.iter().all(|l| l.muted) {
        field
    } else {
        flat = field.flattened();
        &flat
    };
    let mut shown = Shown::of(field);
    let mut packed = shown.pack(field);
    while packed.vectors.text.len() > MAX_TEXT && 2 * shown.step_stride < field.steps.len() {
        shown.step_stride *= 2;
        packed = shown.pack(field);
    }
    shown.say(field, notes);
    let steps = shown.steps(field);
    let PackedVectors { vectors, step, top } = packed;
    let flags: Vec<i16> =
        steps.iter().flat_map(|s| shown.voxels.iter().map(|&v| s.flags[v] as i16)).collect();
    let flags = Packed::new("wind-flags", &flags, &[&[shown.voxels.len()], &[]]);
    blobs.extend([vectors.clone(), flags.clone()]);
    let grid = &field.grid;
    WindData {
        quantity: field.quantity.name(),
        unit: field.quantity.unit(),
        dims: shown.dims,
        first_m: grid.cell_center_m(nth_voxel(grid, shown.voxel_stride, [0; 3])).into(),
        edge_m: grid.edge_m * shown.voxel_stride as f64,
        corners_m: [grid.origin_m.into(), grid.far_corner_m().into()],
        start_secs: field.start_secs,
        rate_hz: field.rate_hz / shown.step_stride as f64,
        n_steps: steps.len(),
        step,
        vectors,
        flags,
        outside: steps.iter().map(|s| s.outside.into()).collect(),
        top,
        profile: steps.iter().map(|s| mean_where_hair_was(s)).collect(),
        shares: shares(field),
    }
}

/// Which voxels and steps are shown.
struct Shown {
    voxel_stride: usize,
    step_stride: usize,
    dims: [usize; 3],
    /// Their flat indices in the field's grid.
    voxels: Vec<usize>,
}

/// The vectors shown, with the value of one step and the 99th percentile of their lengths.
struct PackedVectors {
    vectors: Packed,
    step: f64,
    top: f64,
}

impl Shown {
    fn of(field: &FieldSequence) -> Self {
        let grid = &field.grid;
        let mut voxel_stride = 1;
        while count(dims_of(grid, voxel_stride)) > MAX_VOXELS {
            voxel_stride += 1;
        }
        let dims = dims_of(grid, voxel_stride);
        let max_steps = (MAX_NUMBERS / (3 * count(dims))).max(1);
        let step_stride = ((field.rate_hz / SHOWN_RATE_HZ).round() as usize)
            .max(field.steps.len().div_ceil(max_steps))
            .max(1);
        let voxels = voxels_of(grid, dims, voxel_stride);
        Self { voxel_stride, step_stride, dims, voxels }
    }

    fn say(&self, field: &FieldSequence, notes: &mut Vec<String>) {
        if self.voxel_stride > 1 {
            notes.push(format!(
                "This page shows every {}th voxel of the field along each axis.",
                self.voxel_stride
            ));
        }
        if self.step_stride > 1 {
            let (shown, all) = (field.rate_hz / self.step_stride as f64, field.rate_hz);
            notes.push(format!(
                "This page shows the field {} times a second, linear in between; the file holds {}.",
                short(shown, 2),
                short(all, 2)
            ));
        }
    }

    fn steps<'a>(&self, field: &'a FieldSequence) -> Vec<&'a Field> {
        field.steps.iter().step_by(self.step_stride).collect()
    }

    fn pack(&self, field: &FieldSequence) -> PackedVectors {
        let steps = self.steps(field);
        let lengths = steps.iter().flat_map(|s| self.voxels.iter().map(|&v| s.vector(v).norm()));
        let (top, largest) = top_and_largest(lengths.collect());
        let step = quantum(top, largest);
        let values = self.vectors(&steps, step);
        PackedVectors { vectors: Packed::new("wind-vectors", &values, &[&[1, self.dims[2]]]), step, top }
    }

    fn vectors(&self, steps: &[&Field], step: f64) -> Vec<i16> {
        let mut values = Vec::with_capacity(3 * steps.len() * self.voxels.len());
        for field in steps {
            let n = field.flags.len();
            for axis in 0..3 {
                let component = self.voxels.iter().map(|&v| f64::from(field.u[axis * n + v]));
                values.extend(component.map(|c| (c / step).round() as i16));
            }
        }
        values
    }
}

fn dims_of(grid: &GridSpec, stride: usize) -> [usize; 3] {
    grid.dims.map(|n| n.saturating_sub(stride / 2).max(1).div_ceil(stride))
}

fn count(dims: [usize; 3]) -> usize {
    dims.iter().product()
}

/// The middle voxel of a block of `stride` voxels a side, or the last one where the grid ends before it.
fn nth_voxel(grid: &GridSpec, stride: usize, block: [usize; 3]) -> VoxelIndex {
    VoxelIndex([0, 1, 2].map(|a| (block[a] * stride + stride / 2).min(grid.dims[a] - 1)))
}

/// Flat indices of the voxels shown.
fn voxels_of(grid: &GridSpec, dims: [usize; 3], stride: usize) -> Vec<usize> {
    let mut voxels = Vec::with_capacity(count(dims));
    for x in 0..dims[0] {
        for y in 0..dims[1] {
            for z in 0..dims[2] {
                voxels.push(grid.flat(nth_voxel(grid, stride, [x, y, z])));
            }
        }
    }
    voxels
}

/// The 99th percentile of the lengths, and the largest.
fn top_and_largest(mut lengths: Vec<f64>) -> (f64, f64) {
    if lengths.is_empty() {
        return (0.0, 0.0);
    }
    let at = lengths.len() * 99 / 100;
    let (_, top, above) = lengths.select_nth_unstable_by(at, f64::total_cmp);
    let largest = above.iter().copied().fold(*top, f64::max);
    (*top, largest)
}

/// The value of one step: fine enough for the arrows, coarse enough that the largest vector fits 16 bits.
fn quantum(top: f64, largest: f64) -> f64 {
    let step = (top * STEP_SHARE).max(largest / f64::from(i16::MAX));
    if step > 0.0 { step } else { 1.0 }
}

fn mean_where_hair_was(field: &Field) -> f64 {
    let lengths = || {
        field
            .flags
            .iter()
            .enumerate()
            .filter(|(_, f)| **f != VoxelFlag::Outside)
            .map(|(v, _)| field.vector(v).norm())
    };
    match lengths().count() {
        0 => field.outside.norm(),
        n => lengths().sum::<f64>() / n as f64,
    }
}

fn shares(field: &FieldSequence) -> [f64; 3] {
    let mut counts = [0_usize; 3];
    for flag in field.steps.iter().flat_map(|s| &s.flags) {
        counts[*flag as usize] += 1;
    }
    let all = counts.iter().sum::<usize>().max(1) as f64;
    counts.map(|n| n as f64 / all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fine_grid_is_thinned_about_its_own_middle() {
        let grid = GridSpec::cube(0.6, 0.01).unwrap();
        let dims = dims_of(&grid, 2);
        assert_eq!(dims, [30; 3]);
        let voxels = voxels_of(&grid, dims, 2);
        assert_eq!(grid.unflat(voxels[0]).0, [1, 1, 1]);
        assert_eq!(grid.unflat(voxels[26_999]).0, [59, 59, 59]);
        assert_eq!(dims_of(&GridSpec::cube(0.6, 0.02).unwrap(), 1), [30; 3]);
        // 1 voxel along an axis stays 1.
        assert_eq!(dims_of(&GridSpec { dims: [1, 1, 1], ..grid }, 5), [1; 3]);
    }

    #[test]
    fn the_largest_vector_fits() {
        assert_eq!(quantum(2.0, 3.0), 0.02);
        assert!(1e6 / quantum(2.0, 1e6) <= 32_767.0);
        assert_eq!(quantum(0.0, 0.0), 1.0);
        let lengths = (0..200).map(f64::from).collect();
        assert_eq!(top_and_largest(lengths), (198.0, 199.0));
    }
}
