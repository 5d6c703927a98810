//! What points need of the voxels around them.

use super::WIDTH;
use super::ghosts::Ghosts;
use pulp::Simd;
use pulp::bytemuck::cast_slice;

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

impl Places {
    /// Nowhere in particular.
    pub const ZERO: Self =
        Self { low: [0; WIDTH], steps: [[0; WIDTH]; 2], shares: [[0.0; WIDTH]; 3], far: [0.0; WIDTH] };

    /// Four pairs of voxels around the `k`-th point.
    #[inline(always)]
    fn around(&self, voxels: impl Pairs, k: usize) -> Around {
        let (low, step_x, step_y) = (self.low[k], self.steps[0][k], self.steps[1][k]);
        Around {
            near: voxels.pair(low),
            next_y: voxels.pair(low + step_y),
            next_x: voxels.pair(low + step_x),
            next_xy: voxels.pair(low + step_x + step_y),
        }
    }

    /// Vectors between the eight voxels around each point, by components.
    #[inline(always)]
    pub fn gather<S: Simd>(&self, simd: S, voxels: &Voxels) -> [[f32; WIDTH]; 3] {
        let mut found = [[0.0; WIDTH]; 3];
        if self.voxel_by_voxel(simd, voxels, &mut found) { found } else { self.point_by_point(voxels) }
    }

    /// [`Places::gather`] of two steps laid together, in the same order for each number.
    #[inline(always)]
    pub fn gather_mixed<P: Pairs>(&self, before: P, after: P, share: f32) -> [[f32; WIDTH]; 3] {
        let mut pairs = [[0.0; 8]; WIDTH];
        for (k, pair) in pairs.iter_mut().enumerate() {
            let around = self.around(before, k).mixed(&self.around(after, k), share);
            *pair = around.slopes().at([self.shares[0][k], self.shares[1][k]]);
        }
        self.along_z(&pairs)
    }

    /// Vectors of all points behind a voxel at once; says whether these were few enough to find all.
    #[inline(always)]
    fn voxel_by_voxel<S: Simd>(&self, simd: S, voxels: &Voxels, found: &mut [[f32; WIDTH]; 3]) -> bool {
        // Loops and names: what an array's `map` is given would be called, compiled for any processor.
        let low = S::as_simd_u32s(&self.low).0;
        let share_x = S::as_simd_f32s(&self.shares[0]).0;
        let share_y = S::as_simd_f32s(&self.shares[1]).0;
        let share_z = S::as_simd_f32s(&self.shares[2]).0;
        let mut n = 0;
        for part in 0..WIDTH / S::F32_LANES {
            let begin = part * S::F32_LANES;
            // A bit for each point that is behind no voxel so far.
            let mut left: u32 = (1 << S::F32_LANES) - 1;
            let mut sums = [simd.splat_f32s(0.0); 3];
            while left != 0 {
                let first = begin + left.trailing_zeros() as usize % S::F32_LANES;
                let here = simd.equal_u32s(low[part], simd.splat_u32s(self.low[first]));
                left &= !bits(simd, here);
                // Where a part's first point has its voxel for itself, most have.
                if n == FEW || left.count_ones() as usize == S::F32_LANES - 1 {
                    return false;
                }
                n += 1;
                let slopes = self.around(voxels, first).slopes();
                let shares = [share_x[part], share_y[part]];
                for (axis, sum) in sums.iter_mut().enumerate() {
                    let a = slopes.at_many(simd, axis, shares);
                    let b = slopes.at_many(simd, 4 + axis, shares);
                    let between = simd.mul_add_f32s(simd.sub_f32s(b, a), share_z[part], a);
                    *sum = simd.select_f32s(here, between, *sum);
                }
            }
            for (found, sum) in found.iter_mut().zip(sums) {
                S::as_mut_simd_f32s(found).0[part] = sum;
            }
        }
        true
    }

    /// The same vectors, to the bit, of one point after another.
    #[inline(always)]
    fn point_by_point(&self, voxels: &Voxels) -> [[f32; WIDTH]; 3] {
        let mut pairs = [[0.0; 8]; WIDTH];
        for (k, pair) in pairs.iter_mut().enumerate() {
            *pair = self.around(voxels, k).slopes().at([self.shares[0][k], self.shares[1][k]]);
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
                vector[axis] = (pair[4 + axis] - pair[axis]).mul_add(self.shares[2][k], pair[axis]);
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
const FEW: usize = 4;

/// Pairs of voxels along z: those before a point, the next along y, and the same for the next along x.
struct Around {
    near: [f32; 8],
    next_y: [f32; 8],
    next_x: [f32; 8],
    next_xy: [f32; 8],
}

/// Of each number of a pair: what it is, how it changes along y and along x, and how the one change does along the other.
struct Slopes {
    near: [f32; 8],
    by_y: [f32; 8],
    by_x: [f32; 8],
    by_xy: [f32; 8],
}

impl Around {
    /// Each number between that of two times.
    #[inline(always)]
    fn mixed(&self, after: &Self, share: f32) -> Self {
        Self {
            near: mix_all(&self.near, &after.near, share),
            next_y: mix_all(&self.next_y, &after.next_y, share),
            next_x: mix_all(&self.next_x, &after.next_x, share),
            next_xy: mix_all(&self.next_xy, &after.next_xy, share),
        }
    }

    #[inline(always)]
    fn slopes(&self) -> Slopes {
        let (mut by_y, mut by_x, mut by_xy) = ([0.0; 8], [0.0; 8], [0.0; 8]);
        for n in 0..8 {
            by_y[n] = self.next_y[n] - self.near[n];
            by_x[n] = self.next_x[n] - self.near[n];
            by_xy[n] = (self.next_xy[n] - self.next_x[n]) - by_y[n];
        }
        Slopes { near: self.near, by_y, by_x, by_xy }
    }
}

impl Slopes {
    /// The numbers at shares of the way along x and y.
    #[inline(always)]
    fn at(&self, [share_x, share_y]: [f32; 2]) -> [f32; 8] {
        let Self { near, by_y, by_x, by_xy } = self;
        let mut at = [0.0; 8];
        for n in 0..8 {
            let along_x = by_xy[n].mul_add(share_y, by_x[n]);
            at[n] = along_x.mul_add(share_x, by_y[n].mul_add(share_y, near[n]));
        }
        at
    }

    /// The `n`-th number at shares of the way along x and y of points side by side.
    #[inline(always)]
    fn at_many<S: Simd>(&self, simd: S, n: usize, [share_x, share_y]: [S::f32s; 2]) -> S::f32s {
        let Self { near, by_y, by_x, by_xy } = self;
        let along_x = simd.mul_add_f32s(simd.splat_f32s(by_xy[n]), share_y, simd.splat_f32s(by_x[n]));
        let along_y = simd.mul_add_f32s(simd.splat_f32s(by_y[n]), share_y, simd.splat_f32s(near[n]));
        simd.mul_add_f32s(along_x, share_x, along_y)
    }
}

/// A bit for each of a register's numbers for which something is true.
#[inline(always)]
fn bits<S: Simd>(_simd: S, mask: S::m32s) -> u32 {
    let bytes = pulp::bytemuck::bytes_of(&mask);
    match *bytes {
        // A bit for each.
        [low, high] if S::F32_LANES == 16 => u32::from(u16::from_le_bytes([low, high])),
        _ if bytes.len() == 4 * S::F32_LANES => {
            let mut bits = 0;
            for (k, number) in cast_slice::<u8, u32>(bytes).iter().enumerate() {
                bits |= u32::from(*number != 0) << k;
            }
            bits
        }
        // One truth value.
        _ => u32::from(bytes[0]),
    }
}

#[inline(always)]
fn mix_all(a: &[f32; 8], b: &[f32; 8], share: f32) -> [f32; 8] {
    let mut between = [0.0; 8];
    for n in 0..8 {
        between[n] = mix(a[n], b[n], share);
    }
    between
}

/// A number between two others.
#[inline(always)]
fn mix(a: f32, b: f32, share: f32) -> f32 {
    a + (b - a) * share
}
