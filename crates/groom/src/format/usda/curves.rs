//! One `BasisCurves` prim: its strands in the layer's own space.

use nalgebra::{Matrix4, Point3};
use tousle_core::Vec3;

use super::bad;
use super::curve::{Basis, evenly};
use super::layer::Prim;
use crate::error::GroomReadError;
use crate::raw::RawStrand;

/// What a prim gave.
pub(super) struct Curves {
    pub(super) strands: Vec<RawStrand>,
    /// Whether control points were exchanged for points on the curve.
    pub(super) is_cubic: bool,
    /// Whether points change over time.
    pub(super) is_animated: bool,
    pub(super) warnings: Vec<String>,
}

pub(super) fn read(
    prim: &Prim,
    path: &str,
    world_from_prim: &Matrix4<f64>,
) -> Result<Curves, GroomReadError> {
    let counts = counts(prim, path)?;
    let points = points(prim, path, counts.iter().sum(), world_from_prim)?;
    let kind = kind(prim, path)?;
    let mut warnings = Vec::new();
    let widths = widths(prim, &counts, mean_scale(world_from_prim), path, &mut warnings);
    let mut strands = Vec::new();
    let mut n_without_curve = 0;
    let mut first = 0;
    for (k, n) in counts.iter().enumerate() {
        let control = &points[first..first + n];
        first += n;
        let on_curve = match kind {
            Kind::Polyline => Some(control.to_vec()),
            Kind::Cubic { basis, pinned } => evenly(basis, pinned, control, *n),
        };
        n_without_curve += usize::from(on_curve.is_none());
        strands.push(RawStrand {
            name: Some(format!("{path}[{k}]")),
            drawn_width: widths.as_ref().map(|w| w[k]),
            ..RawStrand::of_points(on_curve.unwrap_or_default())
        });
    }
    if n_without_curve > 0 {
        warnings.push(format!("{path}: {n_without_curve} curves have too few control points to be drawn"));
    }
    let is_animated = prim.is_animated("points");
    Ok(Curves { strands, is_cubic: kind != Kind::Polyline, is_animated, warnings })
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// The control points are on the curve.
    Polyline,
    Cubic {
        basis: Basis,
        pinned: bool,
    },
}

/// How control points make a curve; USD's own fallbacks where the prim does not say: cubic, Bézier, open.
fn kind(prim: &Prim, path: &str) -> Result<Kind, GroomReadError> {
    let unknown = |what: &str, found: &str, expected: &str| {
        Err(bad(path.to_owned(), &format!("{what} {found:?}"), expected))
    };
    let pinned = match prim.text("wrap").unwrap_or("nonperiodic") {
        "nonperiodic" => false,
        "pinned" => true,
        found => return unknown("wrap", found, "nonperiodic or pinned: strands have a root and a tip"),
    };
    match prim.text("type").unwrap_or("cubic") {
        "linear" => return Ok(Kind::Polyline),
        "cubic" => (),
        found => return unknown("type", found, "linear or cubic"),
    }
    let basis = match prim.text("basis").unwrap_or("bezier") {
        "bezier" => Basis::Bezier,
        "bspline" => Basis::Bspline,
        // It runs through every control point.
        "catmullRom" if pinned => return Ok(Kind::Polyline),
        "catmullRom" => Basis::CatmullRom,
        found => return unknown("basis", found, "bezier, bspline or catmullRom"),
    };
    Ok(Kind::Cubic { basis, pinned })
}

fn counts(prim: &Prim, path: &str) -> Result<Vec<usize>, GroomReadError> {
    let Some(numbers) = prim.numbers("curveVertexCounts") else {
        return Err(bad(path.to_owned(), "no curveVertexCounts", "a count for each curve"));
    };
    let count = |x: &f64| (x.fract() == 0.0 && (0.0..=1e9).contains(x)).then_some(*x as usize);
    let counts: Option<Vec<usize>> = numbers.iter().map(count).collect();
    counts.ok_or_else(|| bad(path.to_owned(), "curveVertexCounts that are no counts", "whole numbers"))
}

/// Control points in the layer's own space.
fn points(
    prim: &Prim,
    path: &str,
    n: usize,
    world_from_prim: &Matrix4<f64>,
) -> Result<Vec<Vec3>, GroomReadError> {
    let numbers = prim.numbers("points").unwrap_or_default();
    if n.checked_mul(3) != Some(numbers.len()) {
        let found = format!("{} points", numbers.len() as f64 / 3.0);
        return Err(bad(path.to_owned(), &found, &format!("{n}, the sum of curveVertexCounts")));
    }
    let place = |p: &[f64]| world_from_prim.transform_point(&Point3::new(p[0], p[1], p[2])).coords;
    Ok(numbers.chunks_exact(3).map(place).collect())
}

/// The mean width of each curve. How many there are tells what they belong to: all, a curve, a point.
fn widths(
    prim: &Prim,
    counts: &[usize],
    scale: f64,
    path: &str,
    warnings: &mut Vec<String>,
) -> Option<Vec<f64>> {
    let widths = prim.numbers("widths").filter(|w| !w.is_empty())?;
    let n_points: usize = counts.iter().sum();
    let of_curves: Vec<f64> = if widths.len() == 1 {
        vec![widths[0]; counts.len()]
    } else if widths.len() == counts.len() {
        widths.to_vec()
    } else if widths.len() == n_points {
        let mut rest = widths;
        let mut mean = |n: &usize| {
            let (these, others) = rest.split_at(*n);
            rest = others;
            these.iter().sum::<f64>() / *n as f64
        };
        counts.iter().map(&mut mean).collect()
    } else {
        let found = widths.len();
        warnings.push(format!("{path}: {found} widths, neither one, nor one a curve or a point: not used"));
        return None;
    };
    Some(of_curves.into_iter().map(|w| w * scale).collect())
}

/// How much longer things get on average: the cube root of how much more room they take.
fn mean_scale(matrix: &Matrix4<f64>) -> f64 {
    libm::cbrt(matrix.fixed_view::<3, 3>(0, 0).determinant().abs())
}

#[cfg(test)]
mod tests {
    use super::super::parser::parse;
    use super::*;

    fn curves(body: &str) -> Result<Curves, GroomReadError> {
        let layer = parse(&format!("def BasisCurves \"c\" {{ {body} }}"))?;
        let doubled = Matrix4::new_scaling(2.0);
        read(&layer.prims[0], "/c", &doubled)
    }

    const POINTS: &str = "int[] curveVertexCounts = [2, 3] \
                          point3f[] points = [(0,0,0), (0,0,1), (1,0,0), (1,0,1), (1,0,2)] ";

    #[test]
    fn linear_curves_and_their_widths() {
        for (widths, expected) in [
            ("", None),
            ("float[] widths = [0.5]", Some([1.0, 1.0])),
            ("float[] widths = [1, 2]", Some([2.0, 4.0])),
            ("float[] widths = [1, 2, 1, 1, 4]", Some([3.0, 4.0])),
            ("float[] widths = [1, 2, 3]", None),
        ] {
            let read = curves(&format!("{POINTS} uniform token type = \"linear\" {widths}")).unwrap();
            assert!(!read.is_cubic);
            assert_eq!(read.strands[1].points[2], Vec3::new(2.0, 0.0, 4.0));
            assert_eq!(read.strands[1].name.as_deref(), Some("/c[1]"));
            let found: Vec<_> = read.strands.iter().map(|s| s.drawn_width).collect();
            assert_eq!(found, expected.map_or(vec![None, None], |e| e.map(Some).to_vec()));
            assert_eq!(read.warnings.len(), usize::from(widths.contains("3]")));
        }
    }

    #[test]
    fn what_cannot_be_drawn_says_why() {
        for (body, says) in [
            ("point3f[] points = []", "no curveVertexCounts"),
            ("int[] curveVertexCounts = [1.5]", "curveVertexCounts that are no counts"),
            ("int[] curveVertexCounts = [1000000000, 1000000000]", "found 0 points, expected 2000000000"),
            (&format!("{POINTS} uniform token type = \"nurbs\""), "type \"nurbs\""),
            (&format!("{POINTS} uniform token basis = \"power\""), "basis \"power\""),
            (&format!("{POINTS} uniform token wrap = \"periodic\""), "wrap \"periodic\""),
        ] {
            let error = curves(body).err().unwrap().to_string();
            assert!(error.contains(says), "{says}: {error}");
        }
        let read = curves(&format!("{POINTS} uniform token basis = \"bspline\"")).unwrap();
        assert_eq!(read.warnings, ["/c: 2 curves have too few control points to be drawn"]);
    }
}
