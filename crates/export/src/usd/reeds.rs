//! Hair as reed-shaped ribbons: one mesh, a leaf for each strand.
//!
//! Each control point but the tip becomes two vertices across the strand, the tip one. A ribbon lies flat
//! against the head at its root and is carried along the strand without twisting (a rotation-minimizing frame),
//! so it neither flickers over time nor turns on its edge by itself.
//!
//! Source: section 2 of the paper for the shape; Wang, Jüttler, Zheng and Liu, "Computation of rotation
//! minimizing frames", 2008, for the frame.

use std::io::{self, Write};

use tousle_core::{Strand, Vec3};

use super::hair::{Hair, write_color, write_extents};
use super::text::Text;

/// Width at the root, as a share of the widest.
const ROOT_WIDTH: f64 = 0.3;

/// Where the reed is widest, as a share of its length.
const WIDEST_AT: f64 = 0.4;

/// Digits of a normal behind the point: a hundredth of a degree, at half the size of exact ones.
const NORMAL_STEPS: f32 = 1e4;

/// One strand's ribbon, as far as it does not change over time.
struct Reed {
    /// Index of the strand's root among all control points.
    first_point: usize,
    /// Share of the length from the root at each control point.
    shares: Vec<f64>,
    /// Half the width at each control point, m.
    half_widths_m: Vec<f64>,
    /// Direction of the first segment at rest.
    rest_tangent: Vec3,
    /// Direction across the ribbon at the root at rest; at right angles to the tangent.
    rest_side: Vec3,
}

/// A ribbon's vertex in one frame.
#[derive(Clone, Copy)]
struct Vertex {
    point: Vec3,
    normal: Vec3,
}

pub(super) fn write_reeds<W: Write>(text: &mut Text<W>, hair: &Hair<'_>) -> io::Result<()> {
    let reeds = reeds(hair);
    text.open_prim("Mesh", "Reeds")?;
    text.line(format_args!("uniform token subdivisionScheme = \"none\""))?;
    text.line(format_args!("uniform bool doubleSided = 1"))?;
    write_faces(text, &reeds)?;
    let vertex = " (interpolation = \"vertex\")";
    text.array("texCoord2f[] primvars:st", reeds.iter().flat_map(Reed::texture), Text::tuple, vertex)?;
    write_color(text)?;
    write_extents(text, &hair.codes, |frame, bounds| {
        each_vertex(hair, &reeds, frame, |v| bounds.add(single(v.point)));
    })?;
    text.line(format_args!("normal3f[] normals{vertex}"))?;
    text.samples("normal3f[] normals", &hair.codes, |text, frame| {
        let short = |v: Vertex| single(v.normal).map(|x| (x * NORMAL_STEPS).round() / NORMAL_STEPS);
        write_vertices(text, hair, &reeds, frame, short)
    })?;
    text.samples("point3f[] points", &hair.codes, |text, frame| {
        write_vertices(text, hair, &reeds, frame, |v| single(v.point))
    })?;
    text.close("}")
}

fn reeds(hair: &Hair<'_>) -> Vec<Reed> {
    let mut first_point = 0;
    let reed = |(strand, width): (&Strand, &f32)| {
        let reed = Reed::new(strand, f64::from(*width), first_point);
        first_point += strand.rest_curve_m.len();
        reed
    };
    hair.groom.strands.iter().zip(&hair.widths_m).map(reed).collect()
}

/// Quadrilaterals from the root on, a triangle at the tip; counter-clockwise as seen from outside.
fn write_faces<W: Write>(text: &mut Text<W>, reeds: &[Reed]) -> io::Result<()> {
    let sides = |reed: &Reed| {
        let n_quads = reed.shares.len() - 2;
        std::iter::repeat_n(4, n_quads).chain([3])
    };
    text.array("int[] faceVertexCounts", reeds.iter().flat_map(sides), Text::usize, "")?;
    let mut first_vertex = 0;
    let indices = reeds.iter().flat_map(|reed| {
        let (first, last) = (first_vertex, reed.shares.len() - 2);
        first_vertex += reed.n_vertices();
        let quad = move |row: usize| [0, 1, 3, 2].map(|corner| first + 2 * row + corner);
        (0..last).flat_map(quad).chain([0, 1, 2].map(|corner| first + 2 * last + corner))
    });
    text.array("int[] faceVertexIndices", indices, Text::usize, "")?;
    let ids = reeds.iter().enumerate().flat_map(|(id, reed)| std::iter::repeat_n(id, reed.shares.len() - 1));
    text.array("int[] primvars:id", ids, Text::usize, " (interpolation = \"uniform\")")
}

fn write_vertices<W: Write>(
    text: &mut Text<W>,
    hair: &Hair<'_>,
    reeds: &[Reed],
    frame: usize,
    value: impl Fn(Vertex) -> [f32; 3],
) -> io::Result<()> {
    let points = hair.motion.frame(frame);
    let mut vertices = Vec::new();
    let values = reeds.iter().flat_map(|reed| {
        vertices.clear();
        reed.place(points, |v| vertices.push(value(v)));
        std::mem::take(&mut vertices)
    });
    text.list(values, Text::tuple)
}

fn each_vertex(hair: &Hair<'_>, reeds: &[Reed], frame: usize, mut visit: impl FnMut(Vertex)) {
    let points = hair.motion.frame(frame);
    for reed in reeds {
        reed.place(points, &mut visit);
    }
}

impl Reed {
    fn new(strand: &Strand, width_m: f64, first_point: usize) -> Self {
        let points = &strand.rest_curve_m;
        let mut lengths = vec![0.0];
        for pair in points.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + (pair[1] - pair[0]).norm());
        }
        let total = lengths[lengths.len() - 1];
        let shares: Vec<f64> = lengths.iter().map(|l| l / total).collect();
        let half_widths_m = shares.iter().map(|share| width_m / 2.0 * profile(*share)).collect();
        let rest_tangent = (points[1] - points[0]).normalize();
        let chord = points[points.len() - 1] - points[0];
        let rest_side = side_at_rest(points[0], rest_tangent, chord);
        Self { first_point, shares, half_widths_m, rest_tangent, rest_side }
    }

    fn n_vertices(&self) -> usize {
        2 * self.shares.len() - 1
    }

    /// Across the ribbon from 0 to 1, along it from the root at 0 to the tip at 1.
    fn texture(&self) -> impl Iterator<Item = [f32; 2]> {
        let (tip, rows) = (self.shares.len() - 1, &self.shares);
        rows[..tip].iter().flat_map(|t| [[0.0, *t as f32], [1.0, *t as f32]]).chain([[0.5, 1.0]])
    }

    /// The ribbon's vertices for one frame's control points, root first, left before right.
    fn place(&self, points: &[[f32; 3]], mut visit: impl FnMut(Vertex)) {
        let n = self.shares.len();
        let point = |k: usize| Vec3::from(points[self.first_point + k].map(f64::from));
        let mut segment = self.rest_tangent;
        let mut tangent = self.rest_tangent;
        let mut side = self.rest_side;
        for k in 0..n {
            let before = segment;
            // A segment without length, which only a broken motion has, keeps the direction it came from.
            segment = if k + 1 < n { direction(point(k + 1) - point(k)).unwrap_or(before) } else { before };
            let here = if k == 0 { segment } else { direction(before + segment).unwrap_or(before) };
            side = carried(side, tangent, here);
            tangent = here;
            let normal = side.cross(&tangent);
            let half = side * self.half_widths_m[k];
            if k + 1 < n {
                visit(Vertex { point: point(k) - half, normal });
                visit(Vertex { point: point(k) + half, normal });
            } else {
                visit(Vertex { point: point(k), normal });
            }
        }
    }
}

/// Width at a share of the length, as a share of the widest: swelling smoothly, then tapering like a parabola.
fn profile(share: f64) -> f64 {
    if share < WIDEST_AT {
        let x = share / WIDEST_AT;
        ROOT_WIDTH + (1.0 - ROOT_WIDTH) * x * x * (3.0 - 2.0 * x)
    } else {
        let x = (share - WIDEST_AT) / (1.0 - WIDEST_AT);
        1.0 - x * x
    }
}

/// Across the ribbon at the root, so that it lies against the head: at right angles to where the strand hangs
/// and to the way out of the head, which is the way from the head's center. Strands that go straight out have no
/// such direction: any one at right angles serves.
fn side_at_rest(root_m: Vec3, tangent: Vec3, chord: Vec3) -> Vec3 {
    let across = |v: Vec3| direction(v - tangent * v.dot(&tangent));
    let flat = chord.cross(&root_m);
    let well_defined = flat.norm() > 1e-3 * chord.norm() * root_m.norm();
    let least = Vec3::ith(tangent.iamin(), 1.0);
    Some(flat).filter(|_| well_defined).and_then(across).or_else(|| across(least)).unwrap_or_else(Vec3::x)
}

/// `side`, at right angles to `from`, turned by the smallest rotation that takes `from` to `to` (unit vectors).
fn carried(side: Vec3, from: Vec3, to: Vec3) -> Vec3 {
    let sum = 1.0 + from.dot(&to);
    if sum < 1e-9 {
        // Straight back: every rotation by half a turn is as small, and the one about `side` leaves it.
        return side;
    }
    let turned = side - (from + to) * (side.dot(&to) / sum);
    // Rounding would let the length drift along strands of many points.
    direction(turned).unwrap_or(side)
}

fn direction(v: Vec3) -> Option<Vec3> {
    let length = v.norm();
    (length > 1e-12).then(|| v / length)
}

fn single(v: Vec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strand on the back of the head that hangs straight down: the ribbon's face looks backwards.
    #[test]
    fn a_hanging_strand_faces_outwards() {
        let strand = Strand {
            name: "S".into(),
            rest_curve_m: vec![
                Vec3::new(-0.1, 0.0, 0.0),
                Vec3::new(-0.1, 0.0, -0.04),
                Vec3::new(-0.1, 0.0, -0.1),
            ],
            length_m: 0.1,
            linear_density_kg_per_m: 1e-3,
            lock_width_m: 0.01,
            bending_stiffness_n_m2: 1e-6,
            internal_damping_secs: 0.0,
            along: tousle_core::Along::default(),
            holds_style: false,
        };
        let reed = Reed::new(&strand, 0.01, 0);
        let points = [[-0.1, 0.0, 0.0], [-0.1, 0.0, -0.04], [-0.1, 0.0, -0.1]];
        let mut vertices = Vec::new();
        reed.place(&points, |v| vertices.push(v));
        assert_eq!(vertices.len(), 5);
        for v in &vertices {
            assert!((v.normal - Vec3::new(-1.0, 0.0, 0.0)).norm() < 1e-12, "{}", v.normal);
        }
        // Widest, 10 mm, at 40 % of the length, which is the second control point; 30 % of that at the root.
        assert!(((vertices[3].point - vertices[2].point).norm() - 0.01).abs() < 1e-9);
        assert!(((vertices[1].point - vertices[0].point).norm() - 0.003).abs() < 1e-9);
        assert!((vertices[4].point - Vec3::new(-0.1, 0.0, -0.1)).norm() < 1e-7, "the tip is one point");
        // Counter-clockwise as seen from outside.
        let quad = [0, 1, 3].map(|k: usize| vertices[k].point);
        assert!((quad[1] - quad[0]).cross(&(quad[2] - quad[1])).dot(&vertices[0].normal) > 0.0);
        let texture: Vec<[f32; 2]> = reed.texture().collect();
        assert_eq!(texture, [[0.0, 0.0], [1.0, 0.0], [0.0, 0.4], [1.0, 0.4], [0.5, 1.0]]);
    }

    #[test]
    fn a_side_is_carried_round_a_corner_and_back() {
        let (x, y, z) = (Vec3::x(), Vec3::y(), Vec3::z());
        assert!((carried(z, x, y) - z).norm() < 1e-15);
        assert!((carried(y, x, y) + x).norm() < 1e-15);
        assert_eq!(carried(y, x, -x), y);
    }

    #[test]
    fn strands_without_a_side_get_one() {
        // Straight out of the head, and rooted in its center.
        for (root, tangent) in [(Vec3::z(), Vec3::z()), (Vec3::zeros(), Vec3::y())] {
            let side = side_at_rest(root, tangent, tangent);
            assert!(side.dot(&tangent).abs() < 1e-12 && (side.norm() - 1.0).abs() < 1e-12);
        }
    }
}
