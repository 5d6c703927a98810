//! USD's text form: every `BasisCurves` under its transforms, in one groom.
//!
//! `tousle-usda` reads the layer and says what it does not follow. Where values change over time the first sample is
//! taken for the rest pose, with a warning.
//!
//! Source: `UsdGeomBasisCurves` for the meaning of curves.

mod curves;
mod properties;

use tousle_usda::{Prim, Specifier, UsdaError};

use super::GroomFormat;
use super::curves::{Curves, Place};
use crate::error::GroomReadError;
use crate::raw::RawGroom;

pub(super) fn read(text: &[u8]) -> Result<RawGroom, GroomReadError> {
    let layer = tousle_usda::parse(text)?;
    let mut curves = Curves::default();
    curves.raw.warnings = layer.warnings.clone();
    curves.raw.unit_m = Some(tousle_usda::meters_per_unit(&layer, &mut curves.raw.warnings)?);
    curves.raw.up_axis = Some(tousle_usda::up_axis(&layer, &mut curves.raw.warnings)?);
    for prim in &layer.prims {
        visit(prim, "", Place::top(), &mut curves)?;
    }
    let warnings = curves.raw.warnings.clone();
    curves.finish().ok_or_else(|| {
        let found = match &warnings[..] {
            [] => "no BasisCurves".to_owned(),
            some => format!("no BasisCurves ({})", some.join("; ")),
        };
        bad("the layer".to_owned(), &found, "some")
    })
}

/// What would not be seen of a prim, or not only where it stands, in words.
fn unlike_others(prim: &Prim) -> Option<&'static str> {
    if prim.text("visibility") == Some("invisible") {
        return Some("it is invisible, and is taken all the same");
    }
    if matches!(prim.text("purpose"), Some("guide" | "proxy")) {
        return Some("its purpose is not to be rendered, and it is taken all the same");
    }
    (prim.type_name == "PointInstancer")
        .then_some("its instances were not followed: what it repeats is taken once")
}

/// Takes in a prim's curves and those below it. `over` and `class` prims are opinions, not things.
fn visit(prim: &Prim, parent: &str, above: Place, curves: &mut Curves) -> Result<(), GroomReadError> {
    if prim.specifier != Specifier::Def {
        return Ok(());
    }
    let path = format!("{parent}/{}", prim.name);
    if !prim.is_active {
        curves.raw.warnings.push(format!("{path}: it is not active, and was left out with all below it"));
        return Ok(());
    }
    if let Some(words) = unlike_others(prim) {
        curves.raw.warnings.push(format!("{path}: {words}"));
    }
    let local = tousle_usda::local(prim, &path, None)?;
    let above = if local.resets { Place::top() } else { above };
    let place = above.then(&local.matrix, tousle_usda::is_animated(prim));
    if prim.type_name == "BasisCurves" {
        let first = curves.raw.strands.len();
        let control = curves::control(prim, &path, &mut curves.raw.warnings)?;
        curves.take(&control, &place)?;
        let RawGroom { strands, warnings, .. } = &mut curves.raw;
        properties::apply(prim, &path, &mut strands[first..], warnings);
    }
    prim.children.iter().try_for_each(|child| visit(child, &path, place, curves))
}

fn bad(place: String, found: &str, expected: &str) -> GroomReadError {
    GroomReadError::Malformed {
        format: GroomFormat::Usda,
        place,
        found: found.to_owned(),
        expected: expected.to_owned(),
    }
}

impl From<UsdaError> for GroomReadError {
    fn from(error: UsdaError) -> Self {
        let UsdaError { place, found, expected, .. } = error;
        Self::Malformed { format: GroomFormat::Usda, place, found, expected }
    }
}
