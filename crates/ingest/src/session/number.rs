use super::SessionError;
use tousle_core::Vec3;

/// A number that is one.
pub(super) fn finite(path: &str, value: f64) -> Result<f64, SessionError> {
    if value.is_finite() {
        return Ok(value);
    }
    Err(SessionError::field(path, value.to_string(), "a finite number"))
}

/// A number above zero.
pub(super) fn positive(path: &str, value: f64) -> Result<f64, SessionError> {
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    Err(SessionError::field(path, value.to_string(), "a number > 0"))
}

/// A length above zero, mm to m.
pub(super) fn length(path: &str, mm: f64) -> Result<f64, SessionError> {
    positive(path, mm).map(|mm| mm / 1e3)
}

/// A place, mm to m. Nothing in head space is ten meters away.
pub(super) fn point(path: &str, mm: [f64; 3]) -> Result<Vec3, SessionError> {
    if mm.iter().all(|c| c.abs() < 1e4) {
        return Ok(Vec3::from(mm) / 1e3);
    }
    Err(SessionError::field(path, format!("{mm:?}"), "a place on or near the head, mm"))
}
