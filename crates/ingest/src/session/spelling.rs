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
];
const COLLIDERS: &[&str] =
    &["head_ellipsoid_half_axes_mm", "neck_capsule_mm", "shoulders_capsule_mm", "head_pivot_mm", "friction"];
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
    let Some(fields) = level.as_object() else { return Ok(()) };
    for field in fields.keys().filter(|field| !known.contains(&field.as_str())) {
        // A field that is there in its right spelling too is not lost.
        let near = known.iter().find(|name| !fields.contains_key(**name) && is_near(field, name));
        if let Some(near) = near {
            let path = format!("{path}{field}");
            return Err(SessionError::field(&path, "a field of that name", format!("`{near}`")));
        }
    }
    Ok(())
}

/// One slip in a short word, two in a long one. `length_m` for `length_mm`, the costliest of all, is one.
fn is_near(field: &str, name: &str) -> bool {
    const LONG: usize = 8;
    let letters = |word: &str| word.chars().collect::<Vec<_>>();
    let most = if name.len() < LONG { 1 } else { 2 };
    distance(&letters(field), &letters(name)) <= most
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn slips_are_found_and_notes_are_welcome() {
        for (session, slip) in [
            (json!({"unit": "mm"}), true),
            (json!({"strands": [{"lenght_mm": 1}]}), true),
            (json!({"fans": [{}, {"from_elevation_degrees": 1}]}), false),
            (json!({"fans": [{}, {"from_elevation_dge": 1}]}), true),
            (json!({"note": "", "date": "", "operator": "", "frame": 3}), false),
            (json!({"subject": "Wig", "subjects": 1}), false),
        ] {
            assert_eq!(check(&session).is_err(), slip, "{session}");
        }
    }
}
