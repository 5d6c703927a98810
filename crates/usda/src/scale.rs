//! What a layer says of its unit, its up axis and its clock.

use tousle_core::UpAxis;

use crate::error::bad;
use crate::{Layer, UsdaError, Value};

/// What USD says a layer without `metersPerUnit` means.
const FALLBACK_METERS_PER_UNIT: f64 = 0.01;

/// What USD says a layer without `timeCodesPerSecond` and `framesPerSecond` means.
const FALLBACK_CODES_PER_SECOND: f64 = 24.0;

/// Meters in one of the layer's units; USD's fallback, with a warning, where the layer does not say.
///
/// # Errors
/// [`UsdaError`] if it is no number above 0.
pub fn meters_per_unit(layer: &Layer, warnings: &mut Vec<String>) -> Result<f64, UsdaError> {
    let unit = above_zero(layer, "metersPerUnit")?;
    Ok(unit.unwrap_or_else(|| {
        let fallback = FALLBACK_METERS_PER_UNIT;
        warnings.push(format!("the layer states no metersPerUnit; USD says that means {fallback}"));
        fallback
    }))
}

/// The layer's up axis; USD's fallback, with a warning, where the layer does not say.
///
/// # Errors
/// [`UsdaError`] if it is neither Y nor Z.
pub fn up_axis(layer: &Layer, warnings: &mut Vec<String>) -> Result<UpAxis, UsdaError> {
    match layer.metadata.get("upAxis").map(Value::text) {
        None => {
            warnings.push("the layer states no upAxis; USD says that means Y".to_owned());
            Ok(UpAxis::Y)
        }
        Some(Some("Y")) => Ok(UpAxis::Y),
        Some(Some("Z")) => Ok(UpAxis::Z),
        Some(found) => Err(bad(
            "upAxis",
            found.map_or_else(|| "no text".to_owned(), |axis| format!("{axis:?}")),
            "\"Y\" or \"Z\"",
        )),
    }
}

/// Time codes in a second: `timeCodesPerSecond`, else `framesPerSecond`, else USD's fallback with a warning.
///
/// # Errors
/// [`UsdaError`] if one that is there is no number above 0.
pub fn time_codes_per_second(layer: &Layer, warnings: &mut Vec<String>) -> Result<f64, UsdaError> {
    let stated = above_zero(layer, "timeCodesPerSecond")?;
    let frames = above_zero(layer, "framesPerSecond")?;
    Ok(stated.or(frames).unwrap_or_else(|| {
        let fallback = FALLBACK_CODES_PER_SECOND;
        warnings.push(format!("the layer states no timeCodesPerSecond; USD says that means {fallback}"));
        fallback
    }))
}

fn above_zero(layer: &Layer, name: &str) -> Result<Option<f64>, UsdaError> {
    match layer.metadata.get(name).map(Value::number) {
        None => Ok(None),
        Some(Some(number)) if number.is_finite() && number > 0.0 => Ok(Some(number)),
        Some(found) => Err(bad(
            name,
            found.map_or_else(|| "no number".to_owned(), |number| number.to_string()),
            "a number above 0",
        )),
    }
}
