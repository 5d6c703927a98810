//! One `BasisCurves` prim.

use super::bad;
use crate::error::GroomReadError;
use crate::format::GroomFormat;
use crate::format::curve::Basis;
use crate::format::curves::{Control, Kind};
use tousle_usda::Prim;

/// A prim's control points and what they mean.
pub(super) fn control<'a>(prim: &'a Prim, path: &'a str) -> Result<Control<'a>, GroomReadError> {
    let Some(counts) = prim.numbers("curveVertexCounts") else {
        return Err(bad(path.to_owned(), "no curveVertexCounts", "a count for each curve"));
    };
    Ok(Control {
        format: GroomFormat::Usda,
        path,
        kind: kind(prim, path)?,
        counts,
        points: prim.numbers("points").unwrap_or_default(),
        widths: prim.numbers("widths"),
        is_animated: prim.is_animated("points"),
    })
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

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_usda::parse;

    fn kind_of(body: &str) -> Result<Kind, GroomReadError> {
        let layer =
            parse(format!("def BasisCurves \"c\" {{ int[] curveVertexCounts = [2] {body} }}").as_bytes())?;
        control(&layer.prims[0], "/c").map(|c| c.kind)
    }

    #[test]
    fn kinds() {
        let cubic = |basis, pinned| Kind::Cubic { basis, pinned };
        for (body, expected) in [
            ("", cubic(Basis::Bezier, false)),
            ("uniform token basis = \"\" uniform token type = \"linear\"", Kind::Polyline),
            ("uniform token basis = \"bspline\"", cubic(Basis::Bspline, false)),
            ("token basis = \"bspline\" token wrap = \"pinned\"", cubic(Basis::Bspline, true)),
            ("token basis = \"catmullRom\"", cubic(Basis::CatmullRom, false)),
            ("token basis = \"catmullRom\" token wrap = \"pinned\"", Kind::Polyline),
        ] {
            assert_eq!(kind_of(body).unwrap(), expected, "{body}");
        }
    }

    #[test]
    fn kinds_that_make_no_strand() {
        for (body, says) in [
            ("token type = \"nurbs\"", "type \"nurbs\""),
            ("token basis = \"power\"", "basis \"power\""),
            ("token wrap = \"periodic\"", "wrap \"periodic\""),
        ] {
            let error = kind_of(body).unwrap_err().to_string();
            assert!(error.contains(says), "{says}: {error}");
        }
        let layer = parse(b"def BasisCurves \"c\" { }").unwrap();
        let error = control(&layer.prims[0], "/c").err().unwrap().to_string();
        assert!(error.contains("no curveVertexCounts"), "{error}");
    }
}
