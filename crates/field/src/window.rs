use crate::{GridSpec, VoxelIndex};
use core::ops::Range;
use tousle_core::Vec3;

/// Some voxels of a grid, side by side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// The first along x, y, z.
    pub first: [usize; 3],
    /// How many along x, y, z, each at least 1.
    pub dims: [usize; 3],
}

impl Window {
    /// All voxels of a grid.
    pub fn whole(grid: &GridSpec) -> Self {
        Self { first: [0; 3], dims: grid.dims }
    }

    /// The voxels that points of a box are read between ([`GridSpec::voxels_around`]).
    pub fn around(grid: &GridSpec, low_m: Vec3, high_m: Vec3) -> Self {
        let (VoxelIndex(first), VoxelIndex(last)) = grid.voxels_around(low_m, high_m);
        Self { first, dims: [0, 1, 2].map(|axis| last[axis] - first[axis] + 1) }
    }

    /// Voxels in all.
    pub fn n_voxels(&self) -> usize {
        self.dims.iter().product()
    }

    /// Where a voxel of the grid is among its own, in the order of [`Window::rows`]; `None` if it is not.
    pub fn place(&self, VoxelIndex(voxel): VoxelIndex) -> Option<usize> {
        let mut place = 0;
        for ((voxel, first), n) in voxel.iter().zip(self.first).zip(self.dims) {
            let along = voxel.checked_sub(first)?;
            if along >= n {
                return None;
            }
            place = place * n + along;
        }
        Some(place)
    }

    /// The flat indices, in the whole grid, of each row along z: x slowest.
    pub fn rows(self, grid: &GridSpec) -> impl Iterator<Item = Range<usize>> {
        let ([x, y, z], [nx, ny, nz], grid) = (self.first, self.dims, *grid);
        let row = move |x, y| grid.flat(VoxelIndex([x, y, z]));
        let along_y = move |x| (y..y + ny).map(move |y| row(x, y));
        (x..x + nx).flat_map(along_y).map(move |first| first..first + nz)
    }
}
