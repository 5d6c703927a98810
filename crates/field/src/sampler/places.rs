//! What points need of the voxels around them.

use super::WIDTH;
use super::ghosts::Ghosts;

/// Where some points lie in the grid.
#[derive(Clone, Copy)]
pub(super) struct Places {
    /// The voxel before each point along all axes; how far it is to the next along x and along y (0 at the grid's side).
    pub low: [u32; WIDTH],
    pub steps: [[u32; WIDTH]; 2],
    /// How far along the way to the next voxel each point is, 0 to 1, along x, y, z.
    pub shares: [[f32; WIDTH]; 3],
    /// How much of the wind there is that outside the grid.
    pub far: [f32; WIDTH],
}

/// A vector a voxel, and a number more that stands for nothing, so that a pair of them is eight side by side; and one voxel more,
/// so that each has a next one.
pub(super) type Voxels = Box<[[f32; 4]]>;

/// A step as it lies in memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Raw<'a> {
    /// By components.
    pub vectors: [&'a [f32]; 3],
    /// Voxels that are read as something else, and as what.
    pub ghosts: Option<(&'a Ghosts, &'a [[f32; 3]])>,
}

/// Two steps mixed in every voxel.
pub(super) fn lay_together(before: &Voxels, after: &Voxels, share: f32) -> Voxels {
    let mut voxels = before.clone();
    for (number, after) in voxels.as_flattened_mut().iter_mut().zip(after.as_flattened()) {
        *number = mix(*number, *after, share);
    }
    voxels
}

/// Where voxels can be read.
pub(super) trait Pairs: Copy {
    /// A voxel and the next along z; at the grid's side another one, of which nothing is taken.
    fn pair(self, flat: u32) -> [f32; 8];
}

impl Pairs for &Voxels {
    #[inline(always)]
    fn pair(self, flat: u32) -> [f32; 8] {
        pair_of(self, flat).as_flattened().try_into().expect("two voxels of four numbers")
    }
}

/// A voxel and the next along z.
#[inline(always)]
fn pair_of(voxels: &Voxels, flat: u32) -> &[[f32; 4]; 2] {
    let both = &voxels[flat as usize..flat as usize + 2];
    both.try_into().expect("two voxels")
}

impl Pairs for &Raw<'_> {
    #[inline(always)]
    fn pair(self, flat: u32) -> [f32; 8] {
        let [x, y, z] = self.vectors;
        let this = flat as usize;
        let next = (this + 1).min(x.len() - 1);
        let mut pair = [x[this], y[this], z[this], 0.0, x[next], y[next], z[next], 0.0];
        if let Some((ghosts, vectors)) = self.ghosts {
            for (half, flat) in pair.chunks_exact_mut(4).zip([this, next]) {
                if let Some(ghost) = ghosts.at(flat) {
                    half[..3].copy_from_slice(&vectors[ghost]);
                }
            }
        }
        pair
    }
}

/// A point behind each of the voxels that points lie behind, and how many these are: [`Places::first_in_each`].
pub(super) type Firsts = ([usize; FEW], usize);

impl Places {
    /// Nowhere in particular.
    pub const ZERO: Self =
        Self { low: [0; WIDTH], steps: [[0; WIDTH]; 2], shares: [[0.0; WIDTH]; 3], far: [0.0; WIDTH] };

    /// Four pairs of voxels around the `k`-th point: those before it and the next along y, then the same for the next
    /// along x.
    #[inline(always)]
    fn around(&self, voxels: impl Pairs, k: usize) -> [[f32; 8]; 4] {
        let (low, step_x, step_y) = (self.low[k], self.steps[0][k], self.steps[1][k]);
        // Written out: `map` would be a call for each point, of code for any processor.
        [
            voxels.pair(low),
            voxels.pair(low + step_y),
            voxels.pair(low + step_x),
            voxels.pair(low + step_x + step_y),
        ]
    }

    /// Vectors between the eight voxels around each point, by components. `firsts`: as [`Places::first_in_each`] finds them.
    #[inline(always)]
    pub fn gather(&self, voxels: &Voxels, (firsts, n): Firsts) -> [[f32; WIDTH]; 3] {
        if n > FEW { self.point_by_point(voxels) } else { self.voxel_by_voxel(voxels, &firsts[..n]) }
    }

    /// [`Places::gather`] of two steps laid together, in the same order for each number.
    #[inline(always)]
    pub fn gather_mixed<P: Pairs>(&self, before: P, after: P, share: f32) -> [[f32; WIDTH]; 3] {
        let mut pairs = [[0.0; 8]; WIDTH];
        for (k, pair) in pairs.iter_mut().enumerate() {
            let (a, b) = (self.around(before, k), self.around(after, k));
            let shares = [self.shares[0][k], self.shares[1][k]];
            for n in 0..8 {
                pair[n] = among(
                    mix(a[0][n], b[0][n], share),
                    mix(a[1][n], b[1][n], share),
                    mix(a[2][n], b[2][n], share),
                    mix(a[3][n], b[3][n], share),
                    shares,
                );
            }
        }
        self.along_z(&pairs)
    }

    /// The first point behind each voxel that has some, and how many these are; if they are more than [`FEW`], not all.
    #[inline(always)]
    pub fn first_in_each(&self) -> Firsts {
        let (mut firsts, mut n) = ([0; FEW], 0);
        // A bit for each point that is behind none of those yet.
        let mut left: u32 = (1 << WIDTH) - 1;
        while left != 0 {
            if n == FEW {
                return (firsts, FEW + 1);
            }
            let first = left.trailing_zeros() as usize % WIDTH;
            let low = self.low[first];
            let mut others = 0;
            for k in 0..WIDTH {
                others |= u32::from(self.low[k] != low) << k;
            }
            left &= others;
            firsts[n] = first;
            n += 1;
        }
        (firsts, n)
    }

    /// Vectors of all points behind a voxel at once. `firsts`: a point behind each.
    #[inline(always)]
    fn voxel_by_voxel(&self, voxels: &Voxels, firsts: &[usize]) -> [[f32; WIDTH]; 3] {
        let mut found = [[0.0; WIDTH]; 3];
        for first in firsts {
            let (low, step_x, step_y) = (self.low[*first], self.steps[0][*first], self.steps[1][*first]);
            // Borrowed: what is copied in fours the processor must put together before it reads one of them.
            let near = pair_of(voxels, low);
            let next_y = pair_of(voxels, low + step_y);
            let next_x = pair_of(voxels, low + step_x);
            let next_xy = pair_of(voxels, low + step_x + step_y);
            for axis in 0..3 {
                let [a, b] =
                    [0, 1].map(|z| [near[z][axis], next_y[z][axis], next_x[z][axis], next_xy[z][axis]]);
                for (k, found) in found[axis].iter_mut().enumerate() {
                    let shares = [self.shares[0][k], self.shares[1][k]];
                    let between = mix(
                        among(a[0], a[1], a[2], a[3], shares),
                        among(b[0], b[1], b[2], b[3], shares),
                        self.shares[2][k],
                    );
                    *found = if self.low[k] == low { between } else { *found };
                }
            }
        }
        found
    }

    /// The same vectors, to the bit, of one point after another.
    #[inline(always)]
    fn point_by_point(&self, voxels: &Voxels) -> [[f32; WIDTH]; 3] {
        let mut pairs = [[0.0; 8]; WIDTH];
        for (k, pair) in pairs.iter_mut().enumerate() {
            let around = self.around(voxels, k);
            let shares = [self.shares[0][k], self.shares[1][k]];
            for n in 0..8 {
                pair[n] = among(around[0][n], around[1][n], around[2][n], around[3][n], shares);
            }
        }
        self.along_z(&pairs)
    }

    /// The points' numbers between those of two voxels along z, by components. By itself: where both halves of a pair are made
    /// and taken apart in one loop, the compiler makes vectors of halves only.
    #[inline(always)]
    fn along_z(&self, pairs: &[[f32; 8]; WIDTH]) -> [[f32; WIDTH]; 3] {
        let mut vectors = [[0.0; 4]; WIDTH];
        for (k, (vector, pair)) in vectors.iter_mut().zip(pairs).enumerate() {
            for axis in 0..4 {
                vector[axis] = mix(pair[axis], pair[4 + axis], self.shares[2][k]);
            }
        }
        let mut found = [[0.0; WIDTH]; 3];
        for k in 0..WIDTH {
            for axis in 0..3 {
                found[axis][k] = vectors[k][axis];
            }
        }
        found
    }
}

/// Points behind so few voxels are looked up voxel by voxel: strands side by side in a dense hairstyle.
pub(super) const FEW: usize = 4;

/// A number between those of four neighbors along x and y.
#[inline(always)]
fn among(near: f32, next_y: f32, next_x: f32, next_xy: f32, [share_x, share_y]: [f32; 2]) -> f32 {
    mix(mix(near, next_y, share_y), mix(next_x, next_xy, share_y), share_x)
}

/// A number between two others.
#[inline(always)]
fn mix(a: f32, b: f32, share: f32) -> f32 {
    a + (b - a) * share
}
