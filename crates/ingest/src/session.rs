//! Session files: what the people in the room knew, JSON or TOML.
//!
//! The file's shape is in `file`, what stands for what it leaves out in `defaults`; here the two become a
//! [`Session`] in SI units.

mod defaults;
mod error;
mod fans;
mod file;
mod number;
mod spelling;
mod strands;

pub use error::SessionError;

use file::SessionFile;
use number::{finite, length, point, positive};
use std::collections::BTreeSet;
use tousle_core::{
    Assumption, Attachment, Body, Collider, HeadMarker, LengthUnit, Session, Shape, UpAxis, Vec3,
};

/// Reads a session file, JSON or TOML, whichever the bytes are.
///
/// Places are in the head frame (x forward, y to the subject's left, z up), lengths in mm. Out: SI. Every value that
/// the file leaves out and a default stands for is in [`Session::assumed`]; fields that are not listed here are
/// notes, unless one is nearly spelled like a field that is missing.
///
/// | field | if it is left out |
/// |---|---|
/// | `head_markers_mm_in_head_frame` | required: label → `[x, y, z]`, three or more that span a plane |
/// | `strands[].strand`, `.length_mm`, `.root_mm`, `.markers` (root to tip) | required |
/// | `strands[].linear_density_g_per_m`, `.lock_width_mm` | each from the other, a lock being equally loose whatever its size; 2 g/m and 5 mm if both are missing |
/// | `strands[].marker_distance_from_root_mm` | `None` |
/// | `strands[].marker_mass_mg`, one number or one for each marker | 20 mg |
/// | `colliders.head_ellipsoid_half_axes_mm`, `.neck_capsule_mm`, `.shoulders_capsule_mm` (`a`, `b`, `radius`) | without `colliders`, an adult's, the head scaled to the roots; within it, what is left out is not there |
/// | `head_pivot_mm`, here or in `colliders` | on the neck's axis, 15 mm below where it leaves the head |
/// | `friction`, here or in `colliders` | 0.25 |
/// | `fans[].from_azimuth_deg`, `.speed_mps` | required for each fan; without `fans`, none |
/// | `fans[].from_elevation_deg` | 0° |
/// | `fans[].to_azimuth_deg`, `.blows_towards_world`, `.program` | `None`, empty |
/// | `air_density_kg_m3` | 1.2 kg/m³ |
/// | `name` | `session` |
/// | `still_frames` | `None`: whoever prepares the capture takes those before `wind_starts_about_frame`, or looks for them in it |
/// | `subject`, `rate_hz`, `units`, `up_axis`, `wind_starts_about_frame` | `None` |
///
/// # Errors
/// [`SessionError`] with line and column where the text cannot be read, and with the field's path where a value
/// cannot be: not finite, not positive, a marker named twice.
pub fn read_session(bytes: &[u8]) -> Result<Session, SessionError> {
    let file = file::parse(bytes)?;
    let mut assumed = Vec::new();
    let strands = strands::read(&file, &mut assumed)?;
    let head_markers = head_markers(&file)?;
    check_unique(&head_markers, &strands)?;
    let body = body(&file, &strands, &mut assumed)?;
    Ok(Session {
        name: file.name.clone().unwrap_or_else(|| assume(&mut assumed, defaults::name())),
        subject: file.subject.clone(),
        rate_hz: file.rate_hz.map(|rate| positive("rate_hz", rate)).transpose()?,
        unit: file.units.as_deref().map(unit).transpose()?,
        up_axis: file.up_axis.as_deref().map(up_axis).transpose()?,
        still_frames: file.still_frames.map(still_frames).transpose()?,
        wind_start_frame: file.wind_starts_about_frame,
        head_markers,
        body,
        fans: fans::read(&file, &mut assumed)?,
        air_density: match file.air_density_kg_m3 {
            Some(density) => positive("air_density_kg_m3", density)?,
            None => assume(&mut assumed, defaults::air_density()),
        },
        strands,
        assumed,
    })
}

/// Takes a default and lists it.
fn assume<T>(assumed: &mut Vec<Assumption>, (value, assumption): (T, Assumption)) -> T {
    assumed.push(assumption);
    value
}

fn unit(name: &str) -> Result<LengthUnit, SessionError> {
    LengthUnit::from_name(name)
        .ok_or_else(|| SessionError::field("units", format!("{name:?}"), "mm, cm, m or in"))
}

fn up_axis(name: &str) -> Result<UpAxis, SessionError> {
    UpAxis::from_name(name).ok_or_else(|| SessionError::field("up_axis", format!("{name:?}"), "X, Y or Z"))
}

fn still_frames([first, last]: [i64; 2]) -> Result<(i64, i64), SessionError> {
    if first <= last {
        return Ok((first, last));
    }
    let found = format!("[{first}, {last}]");
    Err(SessionError::field("still_frames", found, "the first frame before the last"))
}

/// Registration of a rigid body needs three markers off one line.
fn head_markers(file: &SessionFile) -> Result<Vec<HeadMarker>, SessionError> {
    const PATH: &str = "head_markers_mm_in_head_frame";
    let markers: Vec<HeadMarker> = file
        .head_markers_mm_in_head_frame
        .0
        .iter()
        .map(|(label, mm)| {
            let position_m = point(&format!("{PATH}.{label}"), *mm)?;
            Ok(HeadMarker { label: file.bare(label).to_owned(), position_m })
        })
        .collect::<Result<_, SessionError>>()?;
    let positions: Vec<Vec3> = markers.iter().map(|m| m.position_m).collect();
    if spread_off_a_line(&positions) < 0.01 {
        let found = format!("{} markers within 10 mm of one line", markers.len());
        return Err(SessionError::field(PATH, found, "at least three markers that span a plane"));
    }
    Ok(markers)
}

/// How far the points reach from the line through the two that are farthest apart, m.
fn spread_off_a_line(points: &[Vec3]) -> f64 {
    let pairs = || points.iter().flat_map(|a| points.iter().map(move |b| (*a, *b)));
    let length = |(a, b): &(Vec3, Vec3)| (b - a).norm();
    let Some((a, b)) = pairs().max_by(|p, q| length(p).total_cmp(&length(q))) else { return 0.0 };
    let Some(along) = (b - a).try_normalize(1e-9) else { return 0.0 };
    points.iter().map(|p| (p - a).cross(&along).norm()).fold(0.0, f64::max)
}

fn check_unique(head: &[HeadMarker], strands: &[tousle_core::StrandSpec]) -> Result<(), SessionError> {
    let mut seen = BTreeSet::new();
    let labels = head.iter().map(|m| (&m.label, "head_markers_mm_in_head_frame".to_owned()));
    let on_strands = strands
        .iter()
        .flat_map(|s| s.markers.iter().map(move |m| (&m.label, format!("strands[{}].markers", s.name))));
    for (label, path) in labels.chain(on_strands) {
        if !seen.insert(label) {
            return Err(SessionError::field(&path, format!("{label:?} again"), "each marker once"));
        }
    }
    Ok(())
}

fn body(
    file: &SessionFile,
    strands: &[tousle_core::StrandSpec],
    assumed: &mut Vec<Assumption>,
) -> Result<Body, SessionError> {
    let colliders = match &file.colliders {
        Some(given) => colliders(given)?,
        None => assume(assumed, defaults::colliders(strands)),
    };
    let given_pivot = file.head_pivot_mm.or_else(|| file.colliders.as_ref().and_then(|c| c.head_pivot_mm));
    let pivot_m = match given_pivot {
        Some(mm) => point("head_pivot_mm", mm)?,
        None => assume(assumed, defaults::pivot(&colliders)),
    };
    let given_friction = file.friction.or_else(|| file.colliders.as_ref().and_then(|c| c.friction));
    let friction = match given_friction {
        Some(friction) if finite("friction", friction)? >= 0.0 => friction,
        Some(friction) => return Err(SessionError::field("friction", friction.to_string(), "a number >= 0")),
        None => assume(assumed, defaults::friction()),
    };
    Ok(Body { colliders, pivot_m, friction })
}

/// The shapes that the file names; what it leaves out is not there.
fn colliders(given: &file::CollidersFile) -> Result<Vec<Collider>, SessionError> {
    let mut colliders = Vec::new();
    if let Some(half_axes) = given.head_ellipsoid_half_axes_mm {
        let path = "colliders.head_ellipsoid_half_axes_mm";
        let half_axes_m = point(path, half_axes)?;
        half_axes.iter().try_for_each(|&mm| positive(path, mm).map(drop))?;
        colliders.push(Collider {
            name: "head".into(),
            shape: Shape::Ellipsoid { center_m: Vec3::zeros(), half_axes_m },
            attachment: Attachment::Head,
        });
    }
    let capsules = [
        ("neck", &given.neck_capsule_mm, Attachment::Head),
        ("shoulders", &given.shoulders_capsule_mm, Attachment::Torso),
    ];
    for (name, capsule, attachment) in capsules {
        let Some(capsule) = capsule else { continue };
        let path = format!("colliders.{name}_capsule_mm");
        let shape = Shape::Capsule {
            a_m: point(&format!("{path}.a"), capsule.a)?,
            b_m: point(&format!("{path}.b"), capsule.b)?,
            radius_m: length(&format!("{path}.radius"), capsule.radius)?,
        };
        colliders.push(Collider { name: name.into(), shape, attachment });
    }
    Ok(colliders)
}

#[cfg(test)]
mod tests;
