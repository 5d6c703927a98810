//! Optional fields have defaults, so a misspelled one would be lost without a word: it is looked for.

use super::SessionError;
use crate::check::distance;
use serde_json::Value;

/// The fields of each level. What is not listed and resembles nothing listed is a note, and welcome.
const TOP: &[&str] = &[
    "name",
    "subject",
    "rate_hz",
    "units",
    "up_axis",
    "still_frames",
    "wind_starts_about_frame",
    "head_markers_mm_in_head_frame",
    "colliders",
    "head_pivot_mm",
    "friction",
    "fans",
    "air_density_kg_m3",
    "strands",
    // Notes that captures carry and nothing reads.
    "frames",
    "first_frame",
    "head_frame",
    "head_markers_note",
    "subject_kind",
    "capture_volume_mm",
];
const COLLIDERS: &[&str] = &[
    "head_ellipsoid_half_axes_mm",
    "neck_capsule_mm",
    "shoulders_capsule_mm",
    "head_pivot_mm",
    "friction",
    "note",
];
const FAN: &[&str] = &[
    "from_azimuth_deg",
    "to_azimuth_deg",
    "from_elevation_deg",
    "speed_mps",
    "program",
    "blows_towards_world",
];
const STRAND: &[&str] = &[
    "strand",
    "length_mm",
    "linear_density_g_per_m",
    "lock_width_mm",
    "root_mm",
    "markers",
    "marker_distance_from_root_mm",
    "marker_mass_mg",
];

/// Looks for fields that are nearly spelled like one we know.
pub(super) fn check(session: &Value) -> Result<(), SessionError> {
    check_level(session, "", TOP)?;
    check_level(&session["colliders"], "colliders.", COLLIDERS)?;
    for (list, known) in [("fans", FAN), ("strands", STRAND)] {
        for (idx, item) in session[list].as_array().into_iter().flatten().enumerate() {
            check_level(item, &format!("{list}[{idx}]."), known)?;
        }
    }
    Ok(())
}

fn check_level(level: &Value, path: &str, known: &[&str]) -> Result<(), SessionError> {
    let fields = level.as_object().into_iter().flat_map(|fields| fields.keys());
    for field in fields.filter(|field| !known.contains(&field.as_str())) {
        // The unit at the end included: `length_m` for `length_mm` is the costliest of all slips.
        let letters: Vec<char> = field.chars().collect();
        let near = known.iter().find(|name| distance(&letters, &name.chars().collect::<Vec<_>>()) <= 2);
        if let Some(near) = near {
            return Err(SessionError::field(
                &format!("{path}{field}"),
                "a field of that name",
                format!("`{near}`"),
            ));
        }
    }
    Ok(())
}
