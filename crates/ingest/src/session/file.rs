//! The fields of a session file, as they are written.

use super::{SessionError, spelling};
use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use std::fmt;

/// A session file.
#[derive(Debug, Deserialize)]
pub(super) struct SessionFile {
    pub name: Option<String>,
    pub subject: Option<String>,
    pub rate_hz: Option<f64>,
    pub units: Option<String>,
    pub up_axis: Option<String>,
    pub still_frames: Option<[i64; 2]>,
    pub wind_starts_about_frame: Option<i64>,
    pub head_markers_mm_in_head_frame: Places,
    pub colliders: Option<CollidersFile>,
    pub head_pivot_mm: Option<[f64; 3]>,
    pub friction: Option<f64>,
    pub fans: Option<Vec<FanFile>>,
    pub air_density_kg_m3: Option<f64>,
    pub strands: Vec<StrandFile>,
}

#[derive(Debug, Deserialize)]
pub(super) struct CollidersFile {
    pub head_ellipsoid_half_axes_mm: Option<[f64; 3]>,
    pub neck_capsule_mm: Option<CapsuleFile>,
    pub shoulders_capsule_mm: Option<CapsuleFile>,
    pub head_pivot_mm: Option<[f64; 3]>,
    pub friction: Option<f64>,
}

#[derive(Debug, Deserialize)]
pub(super) struct CapsuleFile {
    pub a: [f64; 3],
    pub b: [f64; 3],
    pub radius: f64,
}

#[derive(Debug, Deserialize)]
pub(super) struct FanFile {
    pub from_azimuth_deg: f64,
    pub to_azimuth_deg: Option<f64>,
    pub from_elevation_deg: Option<f64>,
    pub speed_mps: f64,
    pub program: Option<String>,
    pub blows_towards_world: Option<[f64; 3]>,
}

#[derive(Debug, Deserialize)]
pub(super) struct StrandFile {
    pub strand: String,
    pub length_mm: f64,
    pub linear_density_g_per_m: Option<f64>,
    pub lock_width_mm: Option<f64>,
    pub root_mm: [f64; 3],
    pub markers: Vec<String>,
    pub marker_distance_from_root_mm: Option<Vec<f64>>,
    pub marker_mass_mg: Option<OneOrEach>,
}

/// One number for all markers of a lock, or one for each.
#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "a number, or a list with a number for each marker")]
pub(super) enum OneOrEach {
    One(f64),
    Each(Vec<f64>),
}

/// Labels and places, in the file's order, each label once.
#[derive(Debug)]
pub(super) struct Places(pub Vec<(String, [f64; 3])>);

impl SessionFile {
    /// A label without the subject's prefix, should it carry one.
    pub fn bare<'a>(&self, label: &'a str) -> &'a str {
        let prefix = self.subject.as_deref();
        prefix.and_then(|subject| label.strip_prefix(subject)?.strip_prefix(':')).unwrap_or(label)
    }
}

impl<'de> Deserialize<'de> for Places {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(PlacesVisitor)
    }
}

struct PlacesVisitor;

impl<'de> Visitor<'de> for PlacesVisitor {
    type Value = Places;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("labels of head markers, each with its place [x, y, z]")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Places, A::Error> {
        let mut places: Vec<(String, [f64; 3])> = Vec::new();
        while let Some((label, place)) = map.next_entry::<String, [f64; 3]>()? {
            if places.iter().any(|(known, _)| *known == label) {
                return Err(A::Error::custom(format!("found head marker {label:?} again, expected it once")));
            }
            places.push((label, place));
        }
        Ok(Places(places))
    }
}

/// Parses JSON or TOML, whichever the text is: a JSON session begins with a brace, which no TOML does. Errors of TOML would mislead
/// about what can only be meant for JSON.
pub(super) fn parse(bytes: &[u8]) -> Result<SessionFile, SessionError> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    if bytes.trim_ascii().is_empty() {
        return Err(SessionError::NotASession { found: "an empty file".into() });
    }
    if let Some(format) = crate::guess_format(bytes) {
        return Err(SessionError::NotASession { found: format!("a capture ({format})") });
    }
    let text = std::str::from_utf8(bytes).map_err(|e| SessionError::NotText { offset: e.valid_up_to() })?;
    if let Some(found) = no_session(text.trim_start()) {
        return Err(SessionError::NotASession { found: found.into() });
    }
    let (file, fields) =
        if text.trim_start().starts_with('{') { parse_json(text)? } else { parse_toml(text)? };
    spelling::check(&fields)?;
    Ok(file)
}

/// What a text is that is neither TOML nor JSON with a brace at its start.
fn no_session(text: &str) -> Option<&'static str> {
    if text.starts_with("//") || text.starts_with("/*") {
        return Some("a comment with a slash, which neither JSON nor TOML has");
    }
    // TOML names a table between brackets.
    let in_list = text.strip_prefix('[')?.trim_start_matches('[').trim_start();
    in_list.starts_with(['{', ']']).then_some("a JSON list")
}

fn parse_json(text: &str) -> Result<(SessionFile, serde_json::Value), SessionError> {
    let syntax = |e: serde_json::Error| {
        let (line, column) = (e.line(), e.column());
        let message = e.to_string();
        let message = message.strip_suffix(&format!(" at line {line} column {column}")).unwrap_or(&message);
        SessionError::Syntax { line, column, message: message.to_owned() }
    };
    Ok((serde_json::from_str(text).map_err(syntax)?, serde_json::from_str(text).map_err(syntax)?))
}

fn parse_toml(text: &str) -> Result<(SessionFile, serde_json::Value), SessionError> {
    let syntax = |e: toml::de::Error| {
        let before = text.get(..e.span().map_or(0, |span| span.start)).unwrap_or_default();
        let line_start = before.rfind('\n').map_or(0, |end| end + 1);
        SessionError::Syntax {
            line: before.matches('\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
            message: e.message().to_owned(),
        }
    };
    Ok((toml::from_str(text).map_err(syntax)?, toml::from_str(text).map_err(syntax)?))
}
