//! USD's text form: every `BasisCurves` under its transforms, in one groom.
//!
//! An own parser of the text form. The one crate that reads USD (`openusd`) needs a newer compiler than this
//! workspace promises and brings composition and the binary form along; curves of one layer need a page of
//! grammar. Not followed: references, payloads, sublayers, inherits, variants; where a layer has them, a warning
//! says so. Where values change over time the first sample is taken for the rest pose.
//!
//! Source: Pixar, "Usda file format specification"; `UsdGeomBasisCurves` and `UsdGeomXformable` for the meaning.

mod curves;
mod layer;
mod lexer;
mod parser;
mod xform;

use nalgebra::Matrix4;
use tousle_core::UpAxis;

use super::GroomFormat;
use super::curves::Curves;
use crate::error::GroomReadError;
use crate::raw::RawGroom;
use layer::{Layer, Prim, Specifier, Value};

/// What USD says a layer without `metersPerUnit` means.
const FALLBACK_METERS_PER_UNIT: f64 = 0.01;

pub(super) fn read(text: &[u8]) -> Result<RawGroom, GroomReadError> {
    let text = str::from_utf8(text).map_err(|error| {
        bad(format!("byte {}", error.valid_up_to()), "bytes that are no text", "UTF-8 text")
    })?;
    let layer = parser::parse(text)?;
    let mut curves = Curves::default();
    curves.raw.warnings = layer.warnings.clone();
    curves.raw.unit_m = Some(unit(&layer, &mut curves.raw.warnings)?);
    curves.raw.up_axis = Some(up_axis(&layer, &mut curves.raw.warnings)?);
    for prim in &layer.prims {
        visit(prim, "", &Matrix4::identity(), &mut curves)?;
    }
    curves.finish().ok_or_else(|| bad("the layer".to_owned(), "no BasisCurves", "some"))
}

/// Takes in a prim's curves and those below it. `over` and `class` prims are opinions, not things.
fn visit(
    prim: &Prim,
    parent: &str,
    world_from_parent: &Matrix4<f64>,
    curves: &mut Curves,
) -> Result<(), GroomReadError> {
    if prim.specifier != Specifier::Def {
        return Ok(());
    }
    let path = format!("{parent}/{}", prim.name);
    let local = xform::local(prim, &path)?;
    let world_from_prim = if local.resets { local.matrix } else { world_from_parent * local.matrix };
    if prim.type_name == "BasisCurves" {
        curves.take(&curves::control(prim, &path)?, &world_from_prim)?;
    }
    prim.children.iter().try_for_each(|child| visit(child, &path, &world_from_prim, curves))
}

fn unit(layer: &Layer, warnings: &mut Vec<String>) -> Result<f64, GroomReadError> {
    match layer.metadata.get("metersPerUnit").map(Value::number) {
        None => {
            let fallback = FALLBACK_METERS_PER_UNIT;
            warnings.push(format!("the layer states no metersPerUnit; USD says that means {fallback}"));
            Ok(fallback)
        }
        Some(Some(unit)) if unit.is_finite() && unit > 0.0 => Ok(unit),
        Some(found) => Err(bad("metersPerUnit".to_owned(), &format!("{found:?}"), "a number above 0")),
    }
}

fn up_axis(layer: &Layer, warnings: &mut Vec<String>) -> Result<UpAxis, GroomReadError> {
    match layer.metadata.get("upAxis").map(Value::text) {
        None => {
            warnings.push("the layer states no upAxis; USD says that means Y".to_owned());
            Ok(UpAxis::Y)
        }
        Some(Some("Y")) => Ok(UpAxis::Y),
        Some(Some("Z")) => Ok(UpAxis::Z),
        Some(found) => Err(bad("upAxis".to_owned(), &format!("{found:?}"), "\"Y\" or \"Z\"")),
    }
}

fn bad(place: String, found: &str, expected: &str) -> GroomReadError {
    GroomReadError::Malformed {
        format: GroomFormat::Usda,
        place,
        found: found.to_owned(),
        expected: expected.to_owned(),
    }
}
