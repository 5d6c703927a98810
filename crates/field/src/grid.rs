use serde::{Deserialize, Serialize};
use tousle_core::Vec3;

/// Where the voxels are: a box of cubes, axes along the head's.
///
/// Values belong to voxel *centers*; [`GridSpec::origin_m`] is the outer *corner* of voxel (0, 0, 0).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GridSpec {
    /// The outer corner of voxel (0, 0, 0), head space, m.
    pub origin_m: Vec3,
    /// The edge of a voxel, m, > 0.
    pub edge_m: f64,
    /// Voxels along x, y, z, each at least 1.
    pub dims: [usize; 3],
}

/// A voxel's place in a grid: along x, y, z, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct VoxelIndex(pub [usize; 3]);

/// What makes a grid impossible.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GridError {
    /// A size is not a finite number above 0.
    #[error("found {what} = {found} mm, expected a number above 0")]
    NotPositive {
        /// Which of the two.
        what: &'static str,
        /// Its value, mm.
        found: f64,
    },
    /// The extent is not a whole number of voxels.
    #[error("an extent of {extent_mm} mm is not a whole number of voxels of {edge_mm} mm")]
    NotWhole {
        /// The extent, mm.
        extent_mm: f64,
        /// The voxel edge, mm.
        edge_mm: f64,
    },
    /// More voxels than a step may have.
    #[error("found {found} voxels a step, expected at most {MAX_VOXELS}")]
    TooMany {
        /// How many it would be.
        found: f64,
    },
}

/// The most voxels a step may have: 256³. A step of them is 200 MB; a reader can bound what it allocates.
pub const MAX_VOXELS: usize = 1 << 24;

impl GridSpec {
    /// A cube of `extent_m` centered on the head, cut into voxels of `edge_m`.
    ///
    /// # Errors
    /// [`GridError`] if a size is not above 0, the extent is not a whole number of voxels (to 1e-6 of one), or
    /// there would be more than [`MAX_VOXELS`].
    pub fn cube(extent_m: f64, edge_m: f64) -> Result<Self, GridError> {
        for (what, value) in [("extent", extent_m), ("voxel edge", edge_m)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(GridError::NotPositive { what, found: value * 1e3 });
            }
        }
        let n = (extent_m / edge_m).round();
        if n < 1.0 || (n * edge_m - extent_m).abs() > 1e-6 * edge_m {
            return Err(GridError::NotWhole { extent_mm: extent_m * 1e3, edge_mm: edge_m * 1e3 });
        }
        if n * n * n > MAX_VOXELS as f64 {
            return Err(GridError::TooMany { found: n * n * n });
        }
        Ok(Self { origin_m: Vec3::repeat(-extent_m / 2.0), edge_m, dims: [n as usize; 3] })
    }

    /// Voxels in all.
    pub fn n_voxels(&self) -> usize {
        self.dims.iter().product()
    }

    /// The outer corner across from the origin, head space, m.
    pub fn far_corner_m(&self) -> Vec3 {
        self.origin_m + Vec3::from(self.dims.map(|n| n as f64)) * self.edge_m
    }

    /// Whether a point, head space, m, lies in the box.
    pub fn contains(&self, point_m: Vec3) -> bool {
        let far = self.far_corner_m();
        (0..3).all(|a| point_m[a] >= self.origin_m[a] && point_m[a] < far[a])
    }

    /// How much of the wind at a point, head space, m, is that outside the grid: 0 in the box, then growing with
    /// the distance from it, 1 from half the box's shortest side on.
    ///
    /// Swirls do not end where a grid does, so what blows at its side is the best guess for what blows close by; a
    /// jump would shake every strand that crosses it.
    pub fn share_outside(&self, point_m: Vec3) -> f64 {
        let far = self.far_corner_m();
        let beyond = |axis: usize| {
            let p = point_m[axis];
            let beyond = f64::max(self.origin_m[axis] - p, p - far[axis]);
            // `max` would make a 0 of a NaN.
            if beyond < 0.0 { 0.0 } else { beyond }
        };
        let distance2: f64 = (0..3).map(|axis| beyond(axis) * beyond(axis)).sum();
        let shortest = self.dims.iter().copied().min().unwrap_or(1) as f64 * self.edge_m;
        // A NaN counts as far away.
        let share = distance2.sqrt() / (0.5 * shortest);
        if share < 1.0 { share } else { 1.0 }
    }

    /// The voxel that holds a point, head space, m; `None` outside the box or for a NaN.
    pub fn voxel_at(&self, point_m: Vec3) -> Option<VoxelIndex> {
        self.contains(point_m).then(|| {
            let place = (point_m - self.origin_m) / self.edge_m;
            // Rounding can lift a point just inside the far side onto it.
            VoxelIndex([0, 1, 2].map(|a| (place[a] as usize).min(self.dims[a] - 1)))
        })
    }

    /// The voxels that points of a box are read between, by its lower and its upper corner, head space, m: the first and
    /// the last along each axis. All of an axis along which a corner is NaN.
    pub fn voxels_around(&self, low_m: Vec3, high_m: Vec3) -> (VoxelIndex, VoxelIndex) {
        let ends = |axis: usize| {
            let last = self.dims[axis] - 1;
            let place = |corner: Vec3| (corner[axis] - self.origin_m[axis]) / self.edge_m - 0.5;
            // A hair's breadth more, so that rounding never leaves a neighbor out. A NaN becomes 0 here,
            let low = ((place(low_m) - 1e-9).floor().max(0.0) as usize).min(last);
            // and the last one here.
            let high = (place(high_m) + 1e-9).ceil();
            let high = if high < last as f64 { high.max(0.0) as usize } else { last };
            (low, high.max(low))
        };
        let ends = [0, 1, 2].map(ends);
        (VoxelIndex(ends.map(|(low, _)| low)), VoxelIndex(ends.map(|(_, high)| high)))
    }

    /// The center of a voxel, head space, m.
    pub fn cell_center_m(&self, voxel: VoxelIndex) -> Vec3 {
        self.origin_m + Vec3::from(voxel.0.map(|i| i as f64 + 0.5)) * self.edge_m
    }

    /// A voxel's place in a planar array: x slowest, z fastest.
    pub fn flat(&self, voxel: VoxelIndex) -> usize {
        let [x, y, z] = voxel.0;
        (x * self.dims[1] + y) * self.dims[2] + z
    }

    /// The voxel at a place in a planar array.
    pub fn unflat(&self, flat: usize) -> VoxelIndex {
        let [_, ny, nz] = self.dims;
        VoxelIndex([flat / (ny * nz), flat / nz % ny, flat % nz])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_grid_is_60_cm_of_30_voxels_about_the_head() {
        let grid = GridSpec::cube(0.6, 0.02).unwrap();
        assert_eq!(grid.dims, [30; 3]);
        let first = grid.cell_center_m(VoxelIndex([0; 3]));
        assert!((first - Vec3::repeat(-0.29)).norm() < 1e-12);
        for flat in [0, 1, 30, 900, 26_999] {
            let voxel = grid.unflat(flat);
            assert_eq!(grid.flat(voxel), flat);
            assert_eq!(grid.voxel_at(grid.cell_center_m(voxel)), Some(voxel));
        }
        assert_eq!(grid.voxel_at(Vec3::new(0.3, 0.0, 0.0)), None);
        assert_eq!(grid.voxel_at(Vec3::new(f64::NAN, 0.0, 0.0)), None);
    }

    #[test]
    fn a_box_is_read_between_the_centers_around_it() {
        let grid = GridSpec { origin_m: Vec3::zeros(), edge_m: 1.0, dims: [4, 4, 4] };
        // Along x the centers 1.5 and 2.5, along y the nearest of the first voxel, along z from 1.5 to the end.
        let found = grid.voxels_around(Vec3::new(1.6, 0.1, 2.0), Vec3::new(2.4, 0.4, 9.0));
        assert_eq!(found, (VoxelIndex([1, 0, 1]), VoxelIndex([2, 0, 3])));
        // On a center, with its neighbors; beyond the box, its side; nowhere, all.
        let found = grid.voxels_around(Vec3::new(1.5, 7.0, f64::NAN), Vec3::new(1.5, 9.0, f64::NAN));
        assert_eq!(found, (VoxelIndex([0, 3, 0]), VoxelIndex([2, 3, 3])));
    }

    #[test]
    fn impossible_grids_are_refused() {
        assert!(matches!(GridSpec::cube(0.6, 0.07), Err(GridError::NotWhole { .. })));
        assert!(matches!(GridSpec::cube(0.6, 0.0), Err(GridError::NotPositive { .. })));
        assert!(matches!(GridSpec::cube(f64::NAN, 0.02), Err(GridError::NotPositive { .. })));
        assert!(matches!(GridSpec::cube(60.0, 0.002), Err(GridError::TooMany { .. })));
    }
}
