//! One `BasisCurves` prim.

use super::bad;
use crate::error::GroomReadError;
use crate::format::GroomFormat;
use crate::format::curve::Basis;
use crate::format::curves::{Control, Kind};
use tousle_usda::Prim;

/// A prim's control points and what they mean.
pub(super) fn control<'a>(
    prim: &'a Prim,
    path: &'a str,
    warnings: &mut Vec<String>,
) -> Result<Control<'a>, GroomReadError> {
    let Some(counts) = prim.numbers("curveVertexCounts") else {
        return Err(bad(path.to_owned(), "no curveVertexCounts", "a count for each curve"));
    };
    Ok(Control {
        format: GroomFormat::Usda,
        path,
        kind: kind(prim, path)?,
        counts,
        points: prim.numbers("points").unwrap_or_default(),
        widths: widths(prim, path, warnings),
        is_animated: prim.is_animated("points"),
    })
}

/// How wide curves are drawn. As for all that may be a primvar, one of that name goes before the attribute.
///
/// Source: `UsdImagingBasisCurvesAdapter`, which asks for `primvars:widths` first.
fn widths<'a>(prim: &'a Prim, path: &str, warnings: &mut Vec<String>) -> Option<&'a [f64]> {
    let Some(widths) = prim.numbers("primvars:widths") else { return prim.numbers("widths") };
    let is_indexed = prim.properties.contains_key("primvars:widths:indices");
    if is_indexed {
        let expected = "one width, or one a curve or a point";
        warnings.push(format!("{path}.primvars:widths: found indices, expected {expected}: no widths used"));
    }
    (!is_indexed).then_some(widths)
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
        control(&layer.prims[0], "/c", &mut Vec::new()).map(|c| c.kind)
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
    fn a_primvars_widths_go_before_the_attributes() {
        let attribute = "float[] widths = [1]";
        let primvar = "float[] primvars:widths = [2, 3]";
        let indices = "int[] primvars:widths:indices = [1, 0]";
        for (body, expected, n_warnings) in [
            (String::new(), None, 0),
            (attribute.to_owned(), Some(&[1.0][..]), 0),
            (format!("{attribute} {primvar}"), Some(&[2.0, 3.0]), 0),
            (format!("{attribute} {primvar} {indices}"), None, 1),
        ] {
            let layer = parse(format!("def BasisCurves \"c\" {{ {body} }}").as_bytes()).unwrap();
            let mut warnings = Vec::new();
            assert_eq!(widths(&layer.prims[0], "/c", &mut warnings), expected, "{body}");
            assert_eq!(warnings.len(), n_warnings, "{warnings:?}");
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
        let error = control(&layer.prims[0], "/c", &mut Vec::new()).err().unwrap().to_string();
        assert!(error.contains("no curveVertexCounts"), "{error}");
    }
}
