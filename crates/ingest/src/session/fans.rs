use super::file::{FanFile, SessionFile};
use super::number::{finite, positive};
use super::{SessionError, assume, defaults};
use tousle_core::{Assumption, Fan, Vec3};

/// The fans as they were set.
pub(super) fn read(file: &SessionFile, assumed: &mut Vec<Assumption>) -> Result<Vec<Fan>, SessionError> {
    match &file.fans {
        Some(fans) => fans.iter().enumerate().map(|(idx, fan)| one(idx, fan, assumed)).collect(),
        None => Ok(assume(assumed, defaults::fans())),
    }
}

fn one(idx: usize, fan: &FanFile, assumed: &mut Vec<Assumption>) -> Result<Fan, SessionError> {
    let path = |field: &str| format!("fans[{idx}].{field}");
    let angle = |field: &str, degrees: f64| finite(&path(field), degrees).map(f64::to_radians);
    Ok(Fan {
        from_azimuth_rad: angle("from_azimuth_deg", fan.from_azimuth_deg)?,
        to_azimuth_rad: fan.to_azimuth_deg.map(|degrees| angle("to_azimuth_deg", degrees)).transpose()?,
        from_elevation_rad: match fan.from_elevation_deg {
            Some(degrees) => angle("from_elevation_deg", degrees)?,
            None => assume(assumed, defaults::elevation(idx)),
        },
        speed_mps: positive(&path("speed_mps"), fan.speed_mps)?,
        blows_towards_world: match fan.blows_towards_world {
            Some(towards) => Some(direction(&path("blows_towards_world"), towards)?),
            None => None,
        },
        program: fan.program.clone().unwrap_or_default(),
    })
}

fn direction(path: &str, vector: [f64; 3]) -> Result<Vec3, SessionError> {
    let unit = Vec3::from(vector).try_normalize(1e-6).filter(|unit| unit.iter().all(|c| c.is_finite()));
    unit.ok_or_else(|| SessionError::field(path, format!("{vector:?}"), "a direction"))
}
