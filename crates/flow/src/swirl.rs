use crate::during::Row;
use crate::exponential::exp;
use nalgebra::{DMatrix, Matrix3};
use rayon::prelude::*;
use tousle_core::{Pose, Vec3, median_high};

/// How velocities at two points of a swirling, divergence-free flow go together: a Gaussian process.
///
/// K(r) = (r rᵀ/ℓ² + (2 − r²/ℓ²) I) exp(−r²/2ℓ²) / 2, of variance 1 a component: the curl of the curl of a bell
/// (Narcowich and Ward, "Generalized Hermite interpolation via matrix-valued conditionally positive definite
/// functions", 1994). Its flow has no divergence, whatever is measured of it. Swirls are of no one size: it is a sum of two such,
/// an octave apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwirlKernel {
    /// The geometric mean of both ℓ, m: half the way over which a swirl turns round.
    pub length_m: f64,
}

/// Shares that the lesser and the larger swirls have in the variance, which grow with the size's power of ⅔ (Kolmogorov, "The local
/// structure of turbulence in incompressible viscous fluid for very large Reynolds numbers", 1941): 2^∓⅓ over their sum.
const OF_LESSER: f64 = 0.386_488_209_564_309_4;
const OF_LARGER: f64 = 1.0 - OF_LESSER;

/// The lesser ℓ over [`SwirlKernel::length_m`].
const LESSER: f64 = core::f64::consts::FRAC_1_SQRT_2;

/// Beyond this nothing of a bell is left that a number can hold.
const BELL_ENDS: f64 = 170.0;

impl SwirlKernel {
    /// The covariance of two points' velocities is `a` r rᵀ + `b` I, where r leads from one to the other.
    fn parts(self, apart_m: Vec3) -> [f64; 2] {
        let per_square = 1.0 / (self.length_m * self.length_m);
        let s = apart_m.norm_squared() * per_square;
        // Half the size, four times the exponent.
        let larger = exp(-f64::min(0.25 * s, BELL_ENDS));
        let lesser = (larger * larger) * (larger * larger);
        let (larger, lesser) = (0.5 * OF_LARGER * larger, 0.5 * OF_LESSER * lesser);
        [(larger * 0.5 + lesser * 2.0) * per_square, larger * (2.0 - 0.5 * s) + lesser * (2.0 - 2.0 * s)]
    }

    /// The covariance of the velocities at two points that are `apart_m` apart.
    pub fn at(&self, apart_m: Vec3) -> Matrix3<f64> {
        let [a, b] = self.parts(apart_m);
        apart_m * apart_m.transpose() * a + Matrix3::from_diagonal_element(b)
    }
}

/// The shapes in which a swirling flow can differ near given points: few enough to solve for, independent of one
/// another, each with a coefficient of variance 1.
///
/// From the points' components those are chosen, one after the other, that the ones before tell least of (a pivoted
/// Cholesky factor of the covariance: Harbrecht, Peters and Schneider, "On the low-rank approximation by the pivoted
/// Cholesky decomposition", 2012); a mode is what a component adds. They are kept on a lattice and read linearly.
#[derive(Clone, Debug, PartialEq)]
pub struct SwirlModes {
    near: Near,
    kernel: SwirlKernel,
    pivots: Vec<(Vec3, usize)>,
    /// Takes velocities at the pivots apart into modes: the inverse of the lower factor of their covariance.
    unmixed: DMatrix<f64>,
    lattice: Lattice,
    /// A column for each component of each node, a row for each mode.
    values: DMatrix<f64>,
}

/// What flows have at a node: x, y and z of each.
pub(crate) type Node = [Row; 3];

/// What modes were asked for, beside the kernel.
#[derive(Clone, Debug, PartialEq)]
struct Near {
    points_m: Vec<Vec3>,
    max_modes: usize,
    reach_m: f64,
}

/// Where a point lies among the nodes at which modes are known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwirlPlace {
    /// The lowest of the eight nodes around it.
    low: usize,
    /// How far it is from there to the highest, along each axis.
    share: [f64; 3],
}

/// A box of points.
#[derive(Clone, Debug, PartialEq)]
struct Lattice {
    origin_m: Vec3,
    edge_m: f64,
    dims: [usize; 3],
}

/// Share of the variance that may be left out at every point.
const LEFT_OUT: f64 = 0.03;

/// Nodes whose modes are told at once.
const NODES_TOGETHER: usize = 64;

/// The most nodes of a lattice: those of a cube of 2.2 m at an ℓ of 14 cm, where a hundred modes take 0.6 GB. No hair needs more,
/// and one point that is far off by mistake may ask for any number.
const MOST_NODES: usize = 1 << 18;

/// Edge of the lattice over the kernel's lesser length: at half of it, reading between nodes is off by some 3 % of a swirl.
const LATTICE_SHARE: f64 = 0.35;

impl SwirlModes {
    /// Modes for the neighborhood of some points, at most `max_modes`, readable within `reach_m` of the points' box. Where that would
    /// be larger than any hair, the points that are farthest from the others are left outside, and no mode reaches them.
    pub fn near(points_m: &[Vec3], kernel: SwirlKernel, max_modes: usize, reach_m: f64) -> Self {
        let lattice = Lattice::around(points_m, reach_m, LATTICE_SHARE * LESSER * kernel.length_m);
        let is_inside = |point_m: &Vec3| lattice.find(*point_m).is_some();
        let inside_m: Vec<Vec3> = points_m.iter().copied().filter(is_inside).collect();
        let (pivots, factor) = pivots(&inside_m, kernel, max_modes);
        let n = pivots.len();
        let unmixed = factor.solve_lower_triangular(&DMatrix::identity(n, n));
        let unmixed = unmixed.expect("a pivot adds more than is left out");
        let near = Near { points_m: points_m.to_vec(), max_modes, reach_m };
        let mut modes = Self { near, kernel, pivots, unmixed, lattice, values: DMatrix::zeros(n, 0) };
        let mut values = DMatrix::zeros(n, 3 * modes.lattice.n_nodes());
        let few = values.as_mut_slice().par_chunks_mut(NODES_TOGETHER * (3 * n).max(1));
        few.enumerate().for_each(|(k, few)| {
            let first = k * NODES_TOGETHER;
            let nodes = first..first + few.len() / (3 * n);
            let points_m: Vec<Vec3> = nodes.map(|node| modes.lattice.place(node)).collect();
            few.copy_from_slice(modes.exact(&points_m).as_slice());
        });
        modes.values = values;
        modes
    }

    /// Whether they are those near some points.
    pub fn are_near(&self, points_m: &[Vec3], kernel: SwirlKernel, max_modes: usize, reach_m: f64) -> bool {
        let Near { points_m: own_m, max_modes: own_most, reach_m: own_reach_m } = &self.near;
        own_m == points_m && self.kernel == kernel && *own_most == max_modes && *own_reach_m == reach_m
    }

    /// How many there are.
    pub fn n_modes(&self) -> usize {
        self.pivots.len()
    }

    /// Where a point lies; `None` where no mode reaches.
    pub fn place(&self, point_m: Vec3) -> Option<SwirlPlace> {
        self.lattice.find(point_m)
    }

    /// Every mode's velocity at a point, x of all modes first, then y, then z, written to `out`.
    ///
    /// # Panics
    /// If `out` is not three times as long as there are modes.
    pub fn at(&self, point_m: Vec3, out: &mut [f64]) {
        let row = 3 * self.n_modes();
        out.fill(0.0);
        let Some(place) = self.place(point_m) else { return };
        for (node, weight) in self.lattice.corners(&place) {
            let values = &self.values.as_slice()[node * row..(node + 1) * row];
            for (sum, value) in out.iter_mut().zip(values) {
                *sum += weight * value;
            }
        }
    }

    /// Nodes at which they are kept.
    pub(crate) fn n_nodes(&self) -> usize {
        self.lattice.n_nodes()
    }

    /// Every mode's x, y and z at a node.
    pub(crate) fn at_node(&self, node: usize) -> [&[f64]; 3] {
        let n = self.n_modes();
        let row = |axis: usize| &self.values.as_slice()[(3 * node + axis) * n..][..n];
        [row(0), row(1), row(2)]
    }

    /// The nodes around a place and their weights.
    #[inline(always)]
    pub(crate) fn corners(&self, place: &SwirlPlace) -> [(usize, f64); 8] {
        self.lattice.corners(place)
    }

    /// Makes of coefficients of other modes those with which these blow like them, where these tell most of it.
    pub fn from_others(&self, others: &Self) -> DMatrix<f64> {
        let n = others.n_modes();
        let mut blow = DMatrix::zeros(self.n_modes(), n);
        let mut at = vec![0.0; 3 * n];
        for (i, (pivot, axis)) in self.pivots.iter().enumerate() {
            others.at(*pivot, &mut at);
            let own = &at[axis * n..(axis + 1) * n];
            blow.row_mut(i).iter_mut().zip(own).for_each(|(blow, own)| *blow = *own);
        }
        &self.unmixed * blow
    }

    /// What becomes of the modes' coefficients when the air travels: row by row, the coefficients then from those now. What
    /// comes in from elsewhere is unknown and not in it. `before_from_now` tells for every point where the air was that is
    /// there now, and turns velocities back to the axes of before.
    pub fn carried(&self, before_from_now: &Pose) -> DMatrix<f64> {
        let was = |(pivot, axis): &(Vec3, usize)| {
            let was_m = before_from_now.transform_point(&(*pivot).into()).coords;
            (was_m, [before_from_now.rotation * Vec3::ith(*axis, 1.0)])
        };
        // A row for each pivot's air before, a column for each pivot: the modes at where the pivots' air was, and then what modes
        // give those values at the pivots, are both what these are taken apart into.
        let columns = self.covariances(self.pivots.iter().map(was));
        &self.unmixed * (&self.unmixed * columns).transpose()
    }

    /// The modes at some points, not read from the lattice: a column for each component of each.
    fn exact(&self, points_m: &[Vec3]) -> DMatrix<f64> {
        let blow = points_m.iter().map(|p| (*p, [0, 1, 2].map(|axis| Vec3::ith(axis, 1.0))));
        &self.unmixed * self.covariances(blow)
    }

    /// How the pivots, a row each, go together with what blows at some points in some directions, a column each.
    fn covariances<const N: usize>(
        &self,
        blow: impl ExactSizeIterator<Item = (Vec3, [Vec3; N])>,
    ) -> DMatrix<f64> {
        let n = self.n_modes();
        let mut columns = DMatrix::zeros(n, N * blow.len());
        let of_points = columns.as_mut_slice().chunks_exact_mut((N * n).max(1));
        for (of_point, (point_m, directions)) in of_points.zip(blow) {
            for (k, (pivot, axis)) in self.pivots.iter().enumerate() {
                let apart_m = pivot - point_m;
                let [a, b] = self.kernel.parts(apart_m);
                let along = a * apart_m[*axis];
                for (c, direction) in directions.iter().enumerate() {
                    of_point[c * n + k] = along * apart_m.dot(direction) + b * direction[*axis];
                }
            }
        }
        columns
    }
}

fn pivots(points_m: &[Vec3], kernel: SwirlKernel, max_modes: usize) -> (Vec<(Vec3, usize)>, DMatrix<f64>) {
    let n = 3 * points_m.len();
    let mut left = vec![1.0; n];
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let mut chosen: Vec<usize> = Vec::new();
    while chosen.len() < max_modes.min(n) {
        let (best, most) =
            left.iter().enumerate().fold((0, 0.0), |b, (i, v)| if *v > b.1 { (i, *v) } else { b });
        if most < LEFT_OUT {
            break;
        }
        let (point, axis) = (points_m[best / 3], best % 3);
        let root = most.sqrt();
        let mut column = vec![0.0; n];
        for (k, other) in points_m.iter().enumerate() {
            let covariance = kernel.at(other - point);
            for c in 0..3 {
                column[3 * k + c] = covariance[(c, axis)];
            }
        }
        for before in &columns {
            let share = before[best];
            for (value, b) in column.iter_mut().zip(before) {
                *value -= share * b;
            }
        }
        for (value, rest) in column.iter_mut().zip(&mut left) {
            *value /= root;
            *rest = f64::max(*rest - *value * *value, 0.0);
        }
        left[best] = 0.0;
        columns.push(column);
        chosen.push(best);
    }
    let factor =
        DMatrix::from_fn(chosen.len(), chosen.len(), |r, c| if c <= r { columns[c][chosen[r]] } else { 0.0 });
    (chosen.iter().map(|i| (points_m[i / 3], i % 3)).collect(), factor)
}

impl Lattice {
    /// The box round some points, or round as many as [`MOST_NODES`] allow of those nearest to where most are.
    fn around(points_m: &[Vec3], reach_m: f64, edge_m: f64) -> Self {
        let round = |points_m: &[Vec3]| Self::round_all(points_m, reach_m, edge_m);
        let all = round(points_m);
        if all.is_small() {
            return all;
        }
        let middle = |axis: usize| median_high(points_m.iter().map(|p| p[axis]).collect()).unwrap_or(0.0);
        let middle_m = Vec3::new(middle(0), middle(1), middle(2));
        let mut nearest_m = points_m.to_vec();
        nearest_m.sort_by(|p, q| (p - middle_m).norm().total_cmp(&(q - middle_m).norm()));
        let counts: Vec<usize> = (1..=nearest_m.len()).collect();
        round(&nearest_m[..counts.partition_point(|n| round(&nearest_m[..*n]).is_small())])
    }

    fn round_all(points_m: &[Vec3], reach_m: f64, edge_m: f64) -> Self {
        let first = points_m.first().copied().unwrap_or_default();
        let low = points_m.iter().fold(first, |low, p| low.inf(p)) - Vec3::repeat(reach_m);
        let high = points_m.iter().fold(first, |high, p| high.sup(p)) + Vec3::repeat(reach_m);
        let dims =
            [0, 1, 2].map(|a| ((high[a] - low[a]) / edge_m).ceil() as usize).map(|n| n.saturating_add(1));
        Self { origin_m: low, edge_m, dims }
    }

    fn is_small(&self) -> bool {
        self.dims.map(|n| n as f64).iter().product::<f64>() <= MOST_NODES as f64
    }

    fn n_nodes(&self) -> usize {
        self.dims.iter().product()
    }

    fn place(&self, node: usize) -> Vec3 {
        let [_, ny, nz] = self.dims;
        let index = [node / (ny * nz), node / nz % ny, node % nz];
        self.origin_m + Vec3::from(index.map(|i| i as f64)) * self.edge_m
    }

    /// Where a point of the box lies; outside no mode reaches.
    fn find(&self, point_m: Vec3) -> Option<SwirlPlace> {
        let place = (point_m - self.origin_m) / self.edge_m;
        let is_inside = (0..3).all(|a| place[a] >= 0.0 && place[a] <= (self.dims[a] - 1) as f64);
        let low = [0, 1, 2].map(|a| (place[a].max(0.0) as usize).min(self.dims[a].saturating_sub(2)));
        let [_, ny, nz] = self.dims;
        is_inside.then(|| SwirlPlace {
            low: (low[0] * ny + low[1]) * nz + low[2],
            share: [0, 1, 2].map(|a| place[a] - low[a] as f64),
        })
    }

    /// The nodes around a place and their weights.
    fn corners(&self, place: &SwirlPlace) -> [(usize, f64); 8] {
        let [_, ny, nz] = self.dims;
        let ([x, y, z], low) = (place.share, place.low);
        let weights = |x: f64, y: f64| [x * y * (1.0 - z), x * y * z];
        let [a, b] = weights(1.0 - x, 1.0 - y);
        let [c, d] = weights(1.0 - x, y);
        let [e, f] = weights(x, 1.0 - y);
        let [g, h] = weights(x, y);
        let far = low + ny * nz;
        [
            (low, a),
            (low + 1, b),
            (low + nz, c),
            (low + nz + 1, d),
            (far, e),
            (far + 1, f),
            (far + nz, g),
            (far + nz + 1, h),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;

    fn points() -> Vec<Vec3> {
        (0..27).map(|k| Vec3::from([k % 3, k / 3 % 3, k / 9].map(f64::from)) * 0.08).collect()
    }

    /// The modes' squares add up to the variance that they are to carry.
    #[test]
    fn modes_carry_the_variance() {
        let modes = SwirlModes::near(&points(), SwirlKernel { length_m: 0.1 }, 200, 0.05);
        let n = modes.n_modes();
        let mut row = vec![0.0; 3 * n];
        for p in points() {
            modes.at(p, &mut row);
            for axis in 0..3 {
                let variance: f64 = row[axis * n..(axis + 1) * n].iter().map(|v| v * v).sum();
                assert!((variance - 1.0).abs() < 0.2, "{axis}: {variance} of {n} modes");
            }
        }
    }

    /// They are known by what was asked for.
    #[test]
    fn modes_are_near_their_points() {
        let (few, kernel) = (&points()[..9], SwirlKernel { length_m: 0.1 });
        let modes = SwirlModes::near(few, kernel, 12, 0.05);
        assert!(modes.are_near(few, kernel, 12, 0.05));
        let others = [
            modes.are_near(&few[1..], kernel, 12, 0.05),
            modes.are_near(few, SwirlKernel { length_m: 0.2 }, 12, 0.05),
            modes.are_near(few, kernel, 13, 0.05),
            modes.are_near(few, kernel, 12, 0.06),
        ];
        assert_eq!(others, [false; 4]);
    }

    /// What is far off is left out, as if nobody had asked for it.
    #[test]
    fn a_point_that_is_far_off_is_out_of_reach() {
        let kernel = SwirlKernel { length_m: 0.1 };
        let own = SwirlModes::near(&points(), kernel, 12, 0.05);
        for far_m in [Vec3::new(30.0, 30.0, 20.0), Vec3::repeat(-1e18), Vec3::x() * 1e300] {
            let mut more = points();
            more.insert(5, far_m);
            let modes = SwirlModes::near(&more, kernel, 12, 0.05);
            assert_eq!((&modes.lattice, &modes.values), (&own.lattice, &own.values));
            assert_eq!((modes.place(far_m), modes.place(points()[26])), (None, own.place(points()[26])));
        }
    }

    /// A mode read from the lattice has hardly any divergence.
    #[test]
    fn modes_have_no_divergence() {
        let modes = SwirlModes::near(&points(), SwirlKernel { length_m: 0.1 }, 60, 0.05);
        let n = modes.n_modes();
        let (p, h) = (Vec3::new(0.07, 0.05, 0.11), 1e-4);
        let (mut divergence, mut steepest) = (vec![0.0; n], 0.0f64);
        for axis in 0..3 {
            let mut step = Vec3::zeros();
            step[axis] = h;
            let [a, b] = [p + step, p - step].map(|p| modes.exact(&[p]));
            for j in 0..n {
                let slope = (a[(j, axis)] - b[(j, axis)]) / (2.0 * h);
                divergence[j] += slope;
                steepest = steepest.max(slope.abs());
            }
        }
        assert!(divergence.iter().all(|d| d.abs() < 1e-4 * steepest), "{divergence:?}");
    }

    /// Air that does not travel stays; air that travels far is forgotten.
    #[test]
    fn travelling_air_is_forgotten() {
        let modes = SwirlModes::near(&points(), SwirlKernel { length_m: 0.1 }, 40, 0.05);
        let stays = modes.carried(&Pose::identity());
        assert!((stays - DMatrix::identity(40, 40)).amax() < 1e-9);
        assert!(modes.carried(&Pose::translation(-2.0, 0.0, 0.0)).norm() < 1e-9);
    }

    /// A swirl that is carried a little way blows there as it blew here.
    #[test]
    fn a_swirl_travels() {
        let modes = SwirlModes::near(&points(), SwirlKernel { length_m: 0.1 }, 200, 0.05);
        let n = modes.n_modes();
        let travel_m = Vec3::new(0.02, -0.01, 0.0);
        let here = Vec3::new(0.08, 0.08, 0.08);
        let mut row = vec![0.0; 3 * n];
        modes.at(here, &mut row);
        // The likeliest swirl that blows at 1 along x here.
        let now = DVector::from_row_slice(&row[..n]);
        let then = modes.carried(&Pose::from(-travel_m)) * &now;
        modes.at(here + travel_m, &mut row);
        let blows: f64 = row[..n].iter().zip(&then).map(|(shape, c)| shape * c).sum();
        assert!((blows - now.norm_squared()).abs() < 0.1, "{blows}");
    }
}
