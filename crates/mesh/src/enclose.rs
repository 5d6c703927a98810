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

/// Nodes along the edge of a block that is asked once whether it is far away.
const BLOCK: usize = 8;

/// Where hair can come, an upright box, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// The corner with the smallest coordinates.
    pub low_m: Vec3,
    /// The corner with the largest.
    pub high_m: Vec3,
}

/// A mesh as a solid, and how that went.
#[derive(Clone, Debug, PartialEq)]
pub struct Enclosed {
    /// The solid.
    pub solid: Solid,
    /// Edges with a triangle on one side only: there what is in and what is out is a guess.
    pub n_open_edges: usize,
}

impl Region {
    /// Where a groom's hair can come in head space.
    pub fn of_hair(groom: &Groom) -> Self {
        Self::around(groom.strands.iter().map(|strand| (strand.rest_curve_m[0], reach_m(strand))))
    }

    /// Where it can come in the space of a torso under a head that turns about a pivot, whichever way it turns.
    pub fn about_pivot(groom: &Groom, pivot_m: Vec3) -> Self {
        let from_pivot = |strand: &Strand| (strand.rest_curve_m[0] - pivot_m).norm() + reach_m(strand);
        Self::around([(pivot_m, groom.strands.iter().map(from_pivot).fold(0.0, f64::max))])
    }

    fn around(balls: impl IntoIterator<Item = (Vec3, f64)>) -> Self {
        let nothing = Self { low_m: Vec3::repeat(f64::INFINITY), high_m: Vec3::repeat(f64::NEG_INFINITY) };
        balls.into_iter().fold(nothing, |region, (center, radius)| Self {
            low_m: region.low_m.inf(&center.add_scalar(-radius)),
            high_m: region.high_m.sup(&center.add_scalar(radius)),
        })
    }

    /// What two regions share; `None` if nothing.
    fn shared(&self, other: &Self) -> Option<Self> {
        let shared = Self { low_m: self.low_m.sup(&other.low_m), high_m: self.high_m.inf(&other.high_m) };
        (0..3).all(|axis| shared.low_m[axis] < shared.high_m[axis]).then_some(shared)
    }
}

fn reach_m(strand: &Strand) -> f64 {
    strand.rest_curve_m.windows(2).map(|ends| (ends[1] - ends[0]).norm()).sum()
}

/// Measures how far points are from a mesh, on a grid in the region where hair can come.
///
/// Distances are to the nearest triangle; inside is behind the mean normal of the nearest feature (Bærentzen and Aanæs,
/// "Signed distance computation using the angle weighted pseudonormal", 2005). `None` if hair cannot come near the
/// mesh.
///
/// # Errors
/// [`MeshError::Distances`] if the triangles make no mesh.
pub fn enclose(mesh: Mesh, region: &Region, edge_m: f64) -> Result<Option<Enclosed>, MeshError> {
    let bounds = Region::around(mesh.points_m.iter().map(|p| (*p, MARGIN_M)));
    let Some(shared) = bounds.shared(region) else { return Ok(None) };
    // Corners are merged by their bits: a zero must not come with two signs.
    let points = mesh.points_m.iter().map(|p| Vector::new(p.x + 0.0, p.y + 0.0, p.z + 0.0)).collect();
    let flags = TriMeshFlags::ORIENTED | TriMeshFlags::MERGE_DUPLICATE_VERTICES;
    let surface = TriMesh::with_flags(points, mesh.triangles.clone(), flags)?;
    let nodes = Nodes::over(&shared, edge_m);
    let distances = DistanceGrid::new(nodes.origin_m, nodes.edge_m, nodes.dims, &measured(&surface, &nodes));
    let solid = Solid { points_m: mesh.points_m, triangles: mesh.triangles, distances };
    Ok(Some(Enclosed { solid, n_open_edges: n_open_edges(&surface) }))
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

/// Signed distances at the nodes, x slowest, z fastest: exact where hair may touch, elsewhere a lower bound.
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
    let is_far = at_middle > half * 3_f64.sqrt() + MARGIN_M;
    let of_node = |at| {
        let place = nodes.place_m(at);
        if is_far { at_middle - (place - middle).norm() } else { signed_distance(surface, place) }
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
        Region { low_m: Vec3::repeat(-0.2), high_m: Vec3::repeat(0.2) }
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
        let region = Region { low_m: Vec3::repeat(0.5), high_m: Vec3::repeat(0.6) };
        assert_eq!(enclose(ball(0.1), &region, EDGE_M).unwrap(), None);
        let mut open = ball(0.1);
        open.triangles.pop();
        assert_eq!(enclose(open, &all_around(), EDGE_M).unwrap().unwrap().n_open_edges, 3);
    }
}
