use kiddo::{ImmutableKdTree, SquaredEuclidean};
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use tousle_core::{Vec3, WindSample};
use tousle_field::{Field, GridSpec, VoxelFlag};

/// One time step by the rules of the paper's 3.3.
///
/// 1. A voxel that holds markers takes their force, the mean of them if there are several.
/// 2. An empty voxel nearer to the head than the measured voxel nearest to it is interpolated linearly between
///    its two nearest measured voxels.
/// 3. Any other empty voxel lies linearly between the nearest measured voxel and the outside wind, which begins
///    at the side of the grid nearest to it.
///
/// "Nearer to the head" compares distances from the head's center, all distances between voxel centers.
pub(crate) fn fill_step(grid: &GridSpec, samples: &[WindSample], outside: Vec3) -> Field {
    let mut field = Field { outside, ..Field::still(grid) };
    let measured = measured_voxels(grid, samples);
    for (flat, force) in &measured {
        field.set_vector(*flat, *force);
        field.flags[*flat] = VoxelFlag::Measured;
    }
    let tree = MeasuredTree::build(grid, &measured);
    for flat in 0..grid.n_voxels() {
        if field.flags[flat] != VoxelFlag::Measured {
            let (force, flag) = fill_voxel(grid, flat, tree.as_ref(), outside);
            field.set_vector(flat, force);
            field.flags[flat] = flag;
        }
    }
    field
}

/// The voxels that hold markers, by flat index in rising order, each with the mean force of its markers.
fn measured_voxels(grid: &GridSpec, samples: &[WindSample]) -> Vec<(usize, Vec3)> {
    let mut sums: BTreeMap<usize, (Vec3, f64)> = BTreeMap::new();
    for sample in samples {
        if let Some(voxel) = grid.voxel_at(sample.position_m) {
            let (sum, n) = sums.entry(grid.flat(voxel)).or_default();
            *sum += sample.value;
            *n += 1.0;
        }
    }
    sums.into_iter().map(|(flat, (sum, n))| (flat, sum / n)).collect()
}

/// Rules 2 and 3 for one empty voxel.
fn fill_voxel(
    grid: &GridSpec,
    flat: usize,
    tree: Option<&MeasuredTree<'_>>,
    outside: Vec3,
) -> (Vec3, VoxelFlag) {
    let Some(tree) = tree else { return (outside, VoxelFlag::Outside) };
    let center_m = grid.cell_center_m(grid.unflat(flat));
    let (first, second) = tree.two_nearest(center_m);
    if center_m.norm() < first.center_m.norm() {
        let force = match second {
            Some(second) => between(first.force, first.distance_m, second.force, second.distance_m),
            None => first.force,
        };
        return (force, VoxelFlag::Interpolated);
    }
    let to_side_m = distance_to_side_m(grid, center_m);
    (between(first.force, first.distance_m, outside, to_side_m), VoxelFlag::Outside)
}

/// Linear between `a` at a distance on one side and `b` at a distance on the other.
fn between(a: Vec3, distance_a_m: f64, b: Vec3, distance_b_m: f64) -> Vec3 {
    a + (b - a) * (distance_a_m / (distance_a_m + distance_b_m))
}

/// Distance from a voxel's center to the nearest side of the grid, m: at least half an edge.
fn distance_to_side_m(grid: &GridSpec, center_m: Vec3) -> f64 {
    let (near, far) = (center_m - grid.origin_m, grid.far_corner_m() - center_m);
    near.inf(&far).min()
}

/// The measured voxels, ready to be asked for the nearest.
struct MeasuredTree<'a> {
    tree: ImmutableKdTree<f64, 3>,
    measured: &'a [(usize, Vec3)],
    n_asked: NonZeroUsize,
    grid: &'a GridSpec,
}

/// A measured voxel as seen from an empty one.
struct Neighbor {
    center_m: Vec3,
    force: Vec3,
    distance_m: f64,
}

impl<'a> MeasuredTree<'a> {
    /// `None` if nothing was measured.
    fn build(grid: &'a GridSpec, measured: &'a [(usize, Vec3)]) -> Option<Self> {
        let centers: Vec<[f64; 3]> =
            measured.iter().map(|(flat, _)| grid.cell_center_m(grid.unflat(*flat)).into()).collect();
        // As many as share a face with a voxel: of the demo's empty voxels one in 8,000 has more equally near ones.
        let n_asked = NonZeroUsize::new(centers.len().min(6))?;
        let tree = ImmutableKdTree::new_from_slice(&centers).ok()?;
        Some(Self { tree, measured, n_asked, grid })
    }

    /// The nearest measured voxel and the second nearest, if there is one. Of equally near ones (frequent in a
    /// grid) those with the lower flat index, so that the answer does not hang on how the tree was built.
    fn two_nearest(&self, point_m: Vec3) -> (Neighbor, Option<Neighbor>) {
        let mut n_asked = self.n_asked;
        let found = loop {
            let mut found =
                self.tree.query(&point_m.into()).nearest_n::<SquaredEuclidean<f64>>(n_asked).execute();
            found.sort_by(|a, b| rounded(a.distance).cmp(&rounded(b.distance)).then(a.item.cmp(&b.item)));
            // Where all that were asked lie as near as the second, there may be more of them, and we choose, not the tree.
            let nearer =
                |second: usize| rounded(found[second].distance) < rounded(found[found.len() - 1].distance);
            if found.len() == self.measured.len() || nearer(1) {
                break found;
            }
            n_asked = n_asked.saturating_mul(n_asked);
        };
        let neighbor = |item: u32| {
            let (flat, force) = self.measured[item as usize];
            let center_m = self.grid.cell_center_m(self.grid.unflat(flat));
            Neighbor { center_m, force, distance_m: (center_m - point_m).norm() }
        };
        (neighbor(found[0].item), found.get(1).map(|f| neighbor(f.item)))
    }
}

/// Squared meters in whole 1e-12: distances that differ by rounding alone are equal.
fn rounded(distance2_m2: f64) -> u64 {
    (distance2_m2 * 1e12).round() as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_field::VoxelIndex;

    fn sample(position_m: Vec3, value: Vec3) -> WindSample {
        WindSample { strand_idx: 0, marker_idx: 0, position_m, value, covariance: [0.0; 6] }
    }

    /// Twelve measured voxels at √2 edges round an empty one: those count that come first in the grid.
    #[test]
    fn of_many_equally_near_the_first_count() {
        let grid = GridSpec::cube(1.0, 0.1).unwrap();
        for middle in 1..9 {
            let mut flats = Vec::new();
            for (i, j) in [(0, 1), (1, 2), (2, 0)] {
                for (a, b) in [(-1, -1), (-1, 1), (1, -1), (1, 1)] {
                    let mut at = [middle; 3];
                    (at[i], at[j]) = (middle + a, middle + b);
                    flats.push(grid.flat(VoxelIndex(at.map(|c: i32| c as usize))));
                }
            }
            flats.sort_unstable();
            let measured: Vec<(usize, Vec3)> =
                flats.into_iter().map(|flat| (flat, Vec3::x() * flat as f64)).collect();
            let tree = MeasuredTree::build(&grid, &measured).unwrap();
            let center_m = grid.cell_center_m(VoxelIndex([middle as usize; 3]));
            let (first, second) = tree.two_nearest(center_m);
            assert_eq!((first.force, second.unwrap().force), (measured[0].1, measured[1].1));
        }
    }

    /// Voxels of 10 cm, markers at x = 25 cm and y = 25 cm; every rule worked by hand.
    #[test]
    fn each_rule_of_section_3_3() {
        let grid = GridSpec::cube(0.6, 0.1).unwrap();
        let (a, b) = (Vec3::new(0.25, 0.05, 0.05), Vec3::new(0.05, 0.25, 0.05));
        let samples = [sample(a, Vec3::x() * 2.0), sample(a, Vec3::x() * 4.0), sample(b, Vec3::y())];
        let outside = Vec3::z();
        let field = fill_step(&grid, &samples, outside);
        let at = |p: Vec3| {
            let flat = grid.flat(grid.voxel_at(p).unwrap());
            (field.vector(flat), field.flags[flat])
        };
        // 1. Two markers in a voxel: their mean.
        assert_eq!(at(a), (Vec3::x() * 3.0, VoxelFlag::Measured));
        assert_eq!(at(b), (Vec3::y(), VoxelFlag::Measured));
        // 2. Nearer to the head than `a`, 0.1 m from it and √(0.1² + 0.2²) m from `b`.
        let (force, flag) = at(Vec3::new(0.15, 0.05, 0.05));
        let share = 0.1 / (0.1 + 0.05_f64.sqrt());
        assert_eq!(flag, VoxelFlag::Interpolated);
        assert!((force - (Vec3::x() * (3.0 * (1.0 - share)) + Vec3::y() * share)).norm() < 1e-6);
        // 3. Farther out than `a`: 0.1 m above it, 0.05 m from the side x = 0.3.
        let (force, flag) = at(Vec3::new(0.25, 0.05, 0.15));
        let share = 0.1 / 0.15;
        assert_eq!(flag, VoxelFlag::Outside);
        assert!((force - (Vec3::x() * (3.0 * (1.0 - share)) + Vec3::z() * share)).norm() < 1e-6);
    }

    #[test]
    fn with_nothing_measured_all_is_outside() {
        let grid = GridSpec::cube(0.2, 0.1).unwrap();
        let field = fill_step(&grid, &[sample(Vec3::x(), Vec3::x())], Vec3::z());
        assert!(
            (0..8).all(|flat| field.vector(flat) == Vec3::z() && field.flags[flat] == VoxelFlag::Outside)
        );
    }

    /// The tree gives the same two neighbors as asking every measured voxel.
    #[test]
    fn the_tree_agrees_with_brute_force() {
        let grid = GridSpec::cube(0.6, 0.02).unwrap();
        let measured: Vec<(usize, Vec3)> = (0..170).map(|k| (k * 7919 % 27_000, Vec3::zeros())).collect();
        let measured: BTreeMap<usize, Vec3> = measured.into_iter().collect();
        let measured: Vec<(usize, Vec3)> = measured.into_iter().collect();
        let tree = MeasuredTree::build(&grid, &measured).unwrap();
        for flat in (0..27_000).step_by(97) {
            let p = grid.cell_center_m(grid.unflat(flat));
            let mut all: Vec<(u64, usize)> = measured
                .iter()
                .enumerate()
                .map(|(k, (flat, _))| {
                    (rounded((grid.cell_center_m(grid.unflat(*flat)) - p).norm_squared()), k)
                })
                .collect();
            all.sort_unstable();
            let (first, second) = tree.two_nearest(p);
            for (neighbor, (distance2, _)) in [(first, all[0]), (second.unwrap(), all[1])] {
                assert_eq!(rounded(neighbor.distance_m * neighbor.distance_m), distance2, "voxel {flat}");
            }
        }
    }
}
