use crate::MeshError;
use crate::read::Mesh;
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::{TriMesh, TriMeshFlags};
use rayon::prelude::*;
use std::collections::BTreeMap;
use tousle_core::{DistanceGrid, Groom, Solid, Strand, Vec3};

/// Distance between the nodes at which a mesh is measured, m. Finer shows smaller features (an ear is some 20 mm, a
/// nose 15) and costs memory with the third power: 16 bytes a node, 8 MB for a head.
pub const EDGE_M: f64 = 0.004;

/// The most nodes, 256 MB: beyond it they lie farther apart.
const MAX_NODES: f64 = 1.6e7;

/// How far out distances are exact, m: hair that comes this near is looked at closely.
const MARGIN_M: f64 = 0.03;

/// How far in distances are exact, m. No lock grows from deeper inside a body, and contact lets none get there: what lies
/// deeper only has to be inside. Asking there costs the most, as the whole surface is about as far away.
const DEPTH_M: f64 = 0.15;

/// The most roots that are asked whether they lie deep inside.
const MAX_ROOTS: usize = 100;

/// Nodes along the edge of a block that is asked once whether it is far away.
const BLOCK: usize = 8;

/// Where hair can come, an upright box, m.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// The corner with the smallest coordinates.
    pub low_m: Vec3,
    /// The corner with the largest.
    pub high_m: Vec3,
    /// Where it begins, by which a mesh in another unit is told.
    pub roots_m: Vec<Vec3>,
}

/// A mesh as a solid, and how that went.
#[derive(Clone, Debug, PartialEq)]
pub struct Enclosed {
    /// The solid.
    pub solid: Solid,
    /// Edges with a triangle on one side only: there what is in and what is out is a guess.
    pub n_open_edges: usize,
    /// Whether any of the surface lies where hair can come.
    pub is_near: bool,
    /// From the root that is nearest to the surface to it, m; of many roots some are asked.
    pub root_gap_m: f64,
}

impl Region {
    /// Where a groom's hair can come in head space.
    pub fn of_hair(groom: &Groom) -> Self {
        let balls = groom.strands.iter().map(|strand| (strand.rest_curve_m[0], reach_m(strand)));
        Self { roots_m: roots_m(groom), ..Self::around(balls) }
    }

    /// Where it can come in the space of a torso under a head that turns about a pivot, whichever way it turns.
    pub fn about_pivot(groom: &Groom, pivot_m: Vec3) -> Self {
        let from_pivot = |strand: &Strand| (strand.rest_curve_m[0] - pivot_m).norm() + reach_m(strand);
        let ball = (pivot_m, groom.strands.iter().map(from_pivot).fold(0.0, f64::max));
        Self { roots_m: roots_m(groom), ..Self::around([ball]) }
    }

    fn around(balls: impl IntoIterator<Item = (Vec3, f64)>) -> Self {
        let nothing = Self {
            low_m: Vec3::repeat(f64::INFINITY),
            high_m: Vec3::repeat(f64::NEG_INFINITY),
            roots_m: Vec::new(),
        };
        balls.into_iter().fold(nothing, |region, (center, radius)| Self {
            low_m: region.low_m.inf(&center.add_scalar(-radius)),
            high_m: region.high_m.sup(&center.add_scalar(radius)),
            ..region
        })
    }

    /// What the region shares with another one; `None` if nothing.
    fn shared(&self, other: &Self) -> Option<Self> {
        let (low_m, high_m) = (self.low_m.sup(&other.low_m), self.high_m.inf(&other.high_m));
        let is_any = (0..3).all(|axis| low_m[axis] < high_m[axis]);
        is_any.then(|| Self { low_m, high_m, roots_m: self.roots_m.clone() })
    }
}

/// Where strands begin, evenly taken if there are many.
fn roots_m(groom: &Groom) -> Vec<Vec3> {
    let every = groom.strands.len().div_ceil(MAX_ROOTS).max(1);
    groom.strands.iter().step_by(every).map(|strand| strand.rest_curve_m[0]).collect()
}

fn reach_m(strand: &Strand) -> f64 {
    strand.rest_curve_m.windows(2).map(|ends| (ends[1] - ends[0]).norm()).sum()
}

/// Measures how far points are from a mesh, on a grid in the region where hair can come.
///
/// Distances are to the nearest triangle; inside is behind the mean normal of the nearest feature (Bærentzen and Aanæs,
/// "Signed distance computation using the angle weighted pseudonormal", 2005). What lies farther out or in than hair can
/// be touched has a bound in place of a distance: so a mesh costs what its surface does where hair can come, however large it
/// is. `None` if hair cannot come near the mesh.
///
/// # Errors
/// [`MeshError::Distances`] if the triangles make no mesh, [`MeshError::Swallows`] if all hair begins deep inside it: a
/// body in another unit, as a rule.
pub fn enclose(mesh: Mesh, region: &Region, edge_m: f64) -> Result<Option<Enclosed>, MeshError> {
    let bounds = Region::around(mesh.points_m.iter().map(|p| (*p, MARGIN_M)));
    let Some(shared) = bounds.shared(region) else { return Ok(None) };
    // Corners are merged by their bits: a zero must not come with two signs.
    let points = mesh.points_m.iter().map(|p| Vector::new(p.x + 0.0, p.y + 0.0, p.z + 0.0)).collect();
    let flags = TriMeshFlags::ORIENTED | TriMeshFlags::MERGE_DUPLICATE_VERTICES;
    let surface = TriMesh::with_flags(points, mesh.triangles.clone(), flags)?;
    let gaps_m: Vec<f64> = region.roots_m.par_iter().map(|root| signed_distance(&surface, *root)).collect();
    let least_deep_m = gaps_m.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !gaps_m.is_empty() && least_deep_m < -DEPTH_M {
        let (across_m, depth_m) = (mesh.across_m(), -least_deep_m);
        return Err(MeshError::Swallows { across_m, depth_m, limit_m: DEPTH_M });
    }
    let (nodes, distances) = match nowhere_near(&surface, &shared) {
        Some(bounds) => bounds,
        None => {
            let nodes = Nodes::over(&shared, edge_m);
            let distances = measured(&surface, &nodes);
            (nodes, distances)
        }
    };
    let is_near = distances.iter().any(|distance| distance.abs() <= MARGIN_M.max(nodes.edge_m));
    let distances = DistanceGrid::new(nodes.origin_m, nodes.edge_m, nodes.dims, &distances);
    let solid = Solid { points_m: mesh.points_m, triangles: mesh.triangles, distances };
    let root_gap_m = gaps_m.iter().map(|gap| gap.abs()).fold(f64::INFINITY, f64::min);
    Ok(Some(Enclosed { solid, n_open_edges: n_open_edges(&surface), is_near, root_gap_m }))
}

/// Where the nodes are.
struct Nodes {
    origin_m: Vec3,
    edge_m: f64,
    dims: [usize; 3],
}

impl Nodes {
    fn over(region: &Region, edge_m: f64) -> Self {
        let size = region.high_m - region.low_m;
        let volume: f64 = size.iter().map(|s| s / edge_m + 2.0).product();
        let edge_m = edge_m * f64::max(1.0, libm::cbrt(volume / MAX_NODES));
        let dims: [usize; 3] = size.map(|s| (s / edge_m).ceil() as usize + 1).into();
        Self { origin_m: region.low_m, edge_m, dims: dims.map(|n| n.max(2)) }
    }

    fn place_m(&self, at: [usize; 3]) -> Vec3 {
        self.origin_m + Vec3::from(at.map(|i| i as f64)) * self.edge_m
    }

    /// The nodes of a block, by their places along x, y, z.
    fn block(&self, block: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
        let [x, y, z] = [0, 1, 2].map(|a| block[a] * BLOCK..((block[a] + 1) * BLOCK).min(self.dims[a]));
        x.flat_map(move |x| {
            let z = z.clone();
            y.clone().flat_map(move |y| z.clone().map(move |z| [x, y, z]))
        })
    }
}

/// Where no surface is in a region, nodes at its corners and a bound for each, by one distance; `None` if there may be some.
fn nowhere_near(surface: &TriMesh, region: &Region) -> Option<(Nodes, Vec<f64>)> {
    let size = region.high_m - region.low_m;
    // A cube that holds the region, as nodes lie equally far apart along all axes.
    let nodes = Nodes { origin_m: region.low_m, edge_m: size.max(), dims: [2; 3] };
    let half_diagonal = 0.5 * 3_f64.sqrt() * nodes.edge_m;
    let at_middle = signed_distance(surface, nodes.origin_m.add_scalar(0.5 * nodes.edge_m));
    let nearest = at_middle.abs() - half_diagonal;
    (nearest > MARGIN_M).then(|| (nodes, vec![nearest.copysign(at_middle); 8]))
}

/// Signed distances at the nodes, x slowest, z fastest: exact where hair may touch, elsewhere a bound: at
/// most as far out or in as the nodes are.
fn measured(surface: &TriMesh, nodes: &Nodes) -> Vec<f64> {
    let [nx, ny, nz] = nodes.dims.map(|n| n.div_ceil(BLOCK));
    let blocks: Vec<Vec<f64>> = (0..nx * ny * nz)
        .into_par_iter()
        .map(|k| measured_block(surface, nodes, [k / (ny * nz), k / nz % ny, k % nz]))
        .collect();
    let mut distances = vec![0.0; nodes.dims.iter().product()];
    for (k, block) in blocks.iter().enumerate() {
        for ([x, y, z], distance) in nodes.block([k / (ny * nz), k / nz % ny, k % nz]).zip(block) {
            distances[(x * nodes.dims[1] + y) * nodes.dims[2] + z] = *distance;
        }
    }
    distances
}

fn measured_block(surface: &TriMesh, nodes: &Nodes, block: [usize; 3]) -> Vec<f64> {
    let half = 0.5 * (BLOCK - 1) as f64 * nodes.edge_m;
    let middle = nodes.place_m(block.map(|b| b * BLOCK)).add_scalar(half);
    let at_middle = signed_distance(surface, middle);
    let half_diagonal = half * 3_f64.sqrt();
    let is_far = at_middle > half_diagonal + MARGIN_M;
    let is_deep = at_middle < -(half_diagonal + DEPTH_M);
    let of_node = |at| {
        let place = nodes.place_m(at);
        match (is_far, is_deep) {
            (true, _) => at_middle - (place - middle).norm(),
            (_, true) => at_middle + (place - middle).norm(),
            _ => signed_distance(surface, place),
        }
    };
    nodes.block(block).map(of_node).collect()
}

fn signed_distance(surface: &TriMesh, point_m: Vec3) -> f64 {
    let point = Vector::new(point_m.x, point_m.y, point_m.z);
    let nearest = surface.project_local_point(point, false);
    let distance = (nearest.point - point).length();
    if nearest.is_inside { -distance } else { distance }
}

fn n_open_edges(surface: &TriMesh) -> usize {
    let mut sides = BTreeMap::new();
    for [a, b, c] in surface.indices() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *sides.entry((from.min(to), from.max(to))).or_insert(0) += 1;
        }
    }
    sides.values().filter(|n| **n == 1).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball of triangles: an octahedron cut finer and finer, its corners at `radius`.
    fn ball(radius: f64) -> Mesh {
        let mut points = vec![Vec3::x(), Vec3::y(), -Vec3::x(), -Vec3::y(), Vec3::z(), -Vec3::z()];
        let mut triangles: Vec<[u32; 3]> =
            (0..4).flat_map(|k| [[k, (k + 1) % 4, 4], [(k + 1) % 4, k, 5]]).collect();
        for _ in 0..5 {
            let mut finer = Vec::new();
            for [a, b, c] in triangles {
                let mut between = |i: u32, j: u32| {
                    points.push((points[i as usize] + points[j as usize]).normalize());
                    points.len() as u32 - 1
                };
                let (ab, bc, ca) = (between(a, b), between(b, c), between(c, a));
                finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
            }
            triangles = finer;
        }
        Mesh { points_m: points.into_iter().map(|p| p * radius).collect(), triangles }
    }

    fn all_around() -> Region {
        Region {
            low_m: Vec3::repeat(-0.2),
            high_m: Vec3::repeat(0.2),
            roots_m: vec![Vec3::new(0.0, 0.0, 0.1)],
        }
    }

    /// A box of triangles that is `size` across.
    fn cube(size: f64, middle: Vec3) -> Mesh {
        let corner = |k: usize| {
            Vec3::new((k & 1) as f64 - 0.5, (k >> 1 & 1) as f64 - 0.5, (k >> 2) as f64 - 0.5) * size + middle
        };
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = sides.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        Mesh { points_m: (0..8).map(corner).collect(), triangles }
    }

    #[test]
    fn distances_from_a_ball_are_a_balls() {
        let enclosed = enclose(ball(0.1), &all_around(), EDGE_M).unwrap().unwrap();
        assert_eq!(enclosed.n_open_edges, 0);
        for direction in [Vec3::new(0.3, -0.8, 0.2), Vec3::new(-0.5, 0.1, -0.9), Vec3::z()] {
            for radius in [0.06, 0.098, 0.1, 0.103, 0.12] {
                let (distance, out) = enclosed.solid.distances.gap(direction.normalize() * radius);
                // The triangles themselves lie up to 0.03 mm below the ball.
                assert!((distance - (radius - 0.1)).abs() < 1.5e-4, "{radius}: {distance}");
                assert!((out - direction.normalize()).norm() < 0.05, "{radius}: {out}");
            }
        }
        let (far, _) = enclosed.solid.distances.gap(Vec3::new(0.0, 0.0, 1.0));
        assert!(far > 0.5, "{far}");
    }

    #[test]
    fn what_hair_cannot_reach_is_left_out_and_holes_are_counted() {
        let region = Region { low_m: Vec3::repeat(0.5), high_m: Vec3::repeat(0.6), roots_m: Vec::new() };
        assert_eq!(enclose(ball(0.1), &region, EDGE_M).unwrap(), None);
        let mut open = ball(0.1);
        open.triangles.pop();
        assert_eq!(enclose(open, &all_around(), EDGE_M).unwrap().unwrap().n_open_edges, 3);
    }

    #[test]
    fn a_body_in_another_unit_is_refused_by_its_size() {
        // A head of 10 cm in mm, in cm, and in mm read as cm.
        for across in [200.0, 20.0, 2.0] {
            let error = enclose(ball(0.5 * across), &all_around(), EDGE_M).unwrap_err().to_string();
            let found = format!("{across:.3} m across");
            assert!(error.contains(&found) && error.contains("unit"), "{error}");
        }
        let small = enclose(ball(1e-4), &all_around(), EDGE_M).unwrap().unwrap();
        assert!((small.root_gap_m - 0.0999).abs() < 1e-6, "{}", small.root_gap_m);
        let own = enclose(ball(0.1), &all_around(), EDGE_M).unwrap().unwrap();
        assert!(own.is_near && own.root_gap_m < 1e-4, "{}", own.root_gap_m);
    }

    #[test]
    fn of_a_set_what_hair_can_reach_is_measured() {
        // A block of 40 m whose face lies 15 cm below the head's center, and the hair above it.
        let floor = enclose(cube(40.0, Vec3::new(0.0, 0.0, -20.15)), &all_around(), EDGE_M).unwrap().unwrap();
        assert!(floor.is_near);
        for (z, gap) in [(-0.14, 0.01), (-0.15, 0.0), (-0.19, -0.04)] {
            let (distance, out) = floor.solid.distances.gap(Vec3::new(0.05, 0.03, z));
            assert!((distance - gap).abs() < 1e-6 && (out - Vec3::z()).norm() < 1e-6, "{z}: {distance}");
        }
        // Hair above the same block by 2 m, in a gap of a box that surrounds it: nothing to touch, and one node a corner.
        let mut arch = cube(1.0, Vec3::new(0.0, 0.0, 3.0));
        let below = cube(1.0, Vec3::new(0.0, 0.0, -3.0));
        arch.points_m.extend(below.points_m);
        arch.triangles.extend(below.triangles.iter().map(|t| t.map(|corner| corner + 8)));
        let arch = enclose(arch, &all_around(), EDGE_M).unwrap().unwrap();
        assert!(!arch.is_near && arch.solid.distances.n_nodes() == 8);
        assert!(arch.solid.distances.gap(Vec3::zeros()).0 > MARGIN_M);
    }

    #[test]
    fn deep_inside_there_is_a_bound() {
        let (low_m, high_m) = (Vec3::repeat(-0.03), Vec3::new(0.5, 0.03, 0.03));
        let region = Region { low_m, high_m, roots_m: vec![Vec3::x() * 0.5] };
        let deep = enclose(ball(0.5), &region, EDGE_M).unwrap().unwrap();
        for x in [0.0, 0.13, 0.31, 0.36, 0.4] {
            let (distance, _) = deep.solid.distances.gap(Vec3::new(x, 0.0, 0.0));
            assert!(
                distance <= (-DEPTH_M).max(x - 0.5 + 1e-3) && distance >= x - 0.5 - 1e-3,
                "{x}: {distance}"
            );
        }
    }
}
