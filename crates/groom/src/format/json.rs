//! Tousle's own groom: a list of strands, each with its rest curve and, if known, what it is made of.
//!
//! Head space, m, root first. Only `rest_curve_m` must be there; the crate's documentation has an example.

mod values;

use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::fmt;

use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use tousle_core::{UpAxis, Vec3};

use super::GroomFormat;
use crate::along::mean_and_shares;
use crate::error::GroomReadError;
use crate::raw::{RawGroom, RawStrand};
use values::Values;

pub(super) fn read(text: &[u8]) -> Result<RawGroom, GroomReadError> {
    let place = Place::default();
    let mut parser = serde_json::Deserializer::from_slice(text);
    let file = FileReader(&place).deserialize(&mut parser);
    let file = file.and_then(|file| parser.end().map(|()| file));
    let file = file.map_err(|error| describe(text, &place, &error))?;
    let mut names = BTreeSet::new();
    for (k, strand) in file.strands.iter().enumerate() {
        if let Some(name) = strand.raw.name.as_ref().filter(|name| !names.insert(name.as_str())) {
            return Err(GroomReadError::Malformed {
                format: GroomFormat::Json,
                place: format!("strands[{k}].name"),
                found: format!("the name {name:?} a second time"),
                expected: "each name once".to_owned(),
            });
        }
    }
    let unknown: BTreeSet<&str> = file.unknown.iter().map(String::as_str).collect();
    let in_strands: BTreeSet<&str> =
        file.strands.iter().flat_map(|s| s.unknown.iter().map(String::as_str)).collect();
    let mut warnings = Vec::new();
    for (what, unknown) in [("the groom", unknown), ("strands", in_strands)] {
        if !unknown.is_empty() {
            let unknown: Vec<&str> = unknown.into_iter().collect();
            warnings.push(format!("fields of {what} that mean nothing here: {}", unknown.join(", ")));
        }
    }
    Ok(RawGroom {
        unit_m: Some(1.0),
        up_axis: Some(UpAxis::Z),
        is_head_space: true,
        strands: file.strands.into_iter().map(|s| s.raw).collect(),
        warnings,
    })
}

/// An error with its place, and plainly where Python's or JavaScript's not-a-number is what stands there.
fn describe(text: &[u8], place: &Place, error: &serde_json::Error) -> GroomReadError {
    let (line, column) = (error.line(), error.column());
    let (start, word) = word_at(text, line, column);
    if ["NaN", "nan", "Infinity", "-Infinity", "inf", "-inf"].contains(&word) {
        let problem = format!("{place}found {word}, expected a finite number");
        return GroomReadError::Json { line, column: start, problem };
    }
    let message = error.to_string();
    let said = message.strip_suffix(&format!(" at line {line} column {column}")).unwrap_or(&message);
    GroomReadError::Json { line, column, problem: format!("{place}{said}") }
}

/// The word around a place, and the column where it starts, from 1. The parser may stop anywhere in it.
fn word_at(text: &[u8], line: usize, column: usize) -> (usize, &str) {
    let line = text.split(|b| *b == b'\n').nth(line.saturating_sub(1)).unwrap_or_default();
    let is_part = |b: &u8| b.is_ascii_alphanumeric() || *b == b'-';
    let (before, after) = line.split_at(column.saturating_sub(1).min(line.len()));
    let start = before.len() - before.iter().rev().take_while(|b| is_part(b)).count();
    let end = before.len() + after.iter().take_while(|b| is_part(b)).count();
    (start + 1, str::from_utf8(&line[start..end]).unwrap_or_default())
}

/// The file's top object.
struct File {
    strands: Vec<Strand>,
    unknown: Vec<String>,
}

/// One strand, and its fields that mean nothing.
#[derive(Default)]
struct Strand {
    raw: RawStrand,
    unknown: Vec<String>,
}

/// Where in the file the reader is, for errors. Each part is set before what it names is read.
#[derive(Debug, Default)]
struct Place {
    strand: Cell<Option<usize>>,
    name: RefCell<Option<String>>,
    field: Cell<Option<&'static str>>,
}

impl Place {
    fn enter(&self, strand: Option<usize>) {
        self.strand.set(strand);
        self.name.replace(None);
        self.field.set(None);
    }

    /// The value of a field, which must not be there twice.
    fn field<'de, T: Deserialize<'de>, A: MapAccess<'de>>(
        &self,
        map: &mut A,
        name: &'static str,
        field: &mut Option<T>,
    ) -> Result<(), A::Error> {
        self.field.set(Some(name));
        match field.replace(map.next_value()?) {
            None => Ok(()),
            Some(_) => Err(A::Error::duplicate_field(name)),
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(strand) = self.strand.get() else { return Ok(()) };
        write!(f, "strands[{strand}]")?;
        if let Some(field) = self.field.get() {
            write!(f, ".{field}")?;
        }
        if let Some(name) = &*self.name.borrow() {
            write!(f, " (strand {name})")?;
        }
        f.write_str(": ")
    }
}

/// Reads the file's top object.
struct FileReader<'a>(&'a Place);

impl<'de> DeserializeSeed<'de> for FileReader<'_> {
    type Value = File;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<File, D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for FileReader<'_> {
    type Value = File;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object with a list of `strands`")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<File, A::Error> {
        let mut strands = None;
        let mut unknown = Vec::new();
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "strands" if strands.is_some() => return Err(A::Error::duplicate_field("strands")),
                "strands" => strands = Some(map.next_value_seed(StrandsReader(self.0))?),
                "note" => drop(map.next_value::<IgnoredAny>()?),
                _ => {
                    map.next_value::<IgnoredAny>()?;
                    unknown.push(key);
                }
            }
        }
        Ok(File { strands: strands.ok_or_else(|| A::Error::missing_field("strands"))?, unknown })
    }
}

/// Reads the list of strands.
struct StrandsReader<'a>(&'a Place);

impl<'de> DeserializeSeed<'de> for StrandsReader<'_> {
    type Value = Vec<Strand>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for StrandsReader<'_> {
    type Value = Vec<Strand>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of strands")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
        let mut strands = Vec::new();
        self.0.enter(Some(0));
        while let Some(strand) = list.next_element_seed(StrandReader(self.0))? {
            strands.push(strand);
            self.0.enter(Some(strands.len()));
        }
        self.0.enter(None);
        Ok(strands)
    }
}

/// Reads a strand.
struct StrandReader<'a>(&'a Place);

impl<'de> DeserializeSeed<'de> for StrandReader<'_> {
    type Value = Strand;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Strand, D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for StrandReader<'_> {
    type Value = Strand;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a strand: an object with `rest_curve_m`")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Strand, A::Error> {
        let place = self.0;
        let mut strand = Strand::default();
        let raw = &mut strand.raw;
        let mut points: Option<Vec<[f64; 3]>> = None;
        let (mut width, mut density, mut stiffness) = (None, None, None);
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "name" => {
                    place.field(&mut map, "name", &mut raw.name)?;
                    place.name.replace(raw.name.clone());
                }
                "rest_curve_m" => place.field(&mut map, "rest_curve_m", &mut points)?,
                "length_m" => place.field(&mut map, "length_m", &mut raw.length)?,
                WIDTH => place.field(&mut map, WIDTH, &mut width)?,
                DENSITY => place.field(&mut map, DENSITY, &mut density)?,
                STIFFNESS => place.field(&mut map, STIFFNESS, &mut stiffness)?,
                DAMPING => place.field(&mut map, DAMPING, &mut raw.internal_damping_secs)?,
                _ => {
                    map.next_value::<IgnoredAny>()?;
                    strand.unknown.push(key);
                }
            }
            place.field.set(None);
        }
        let points = points.ok_or_else(|| A::Error::missing_field("rest_curve_m"))?;
        raw.points = points.into_iter().map(Vec3::from).collect();
        let n_points = raw.points.len();
        let along = |name, values| {
            place.field.set(Some(name));
            along::<A::Error>(values, n_points)
        };
        (raw.lock_width_m, raw.along.width) = along(WIDTH, width)?;
        (raw.linear_density_kg_per_m, raw.along.linear_density) = along(DENSITY, density)?;
        (raw.bending_stiffness_n_m2, raw.along.bending_stiffness) = along(STIFFNESS, stiffness)?;
        Ok(strand)
    }
}

const WIDTH: &str = "lock_width_m";
const DENSITY: &str = "linear_density_kg_per_m";
const STIFFNESS: &str = "bending_stiffness_N_m2";
const DAMPING: &str = "internal_damping_time_s";

/// The number that stands for a property, and how many times it the property is at each point.
fn along<E: Error>(values: Option<Values>, n_points: usize) -> Result<(Option<f64>, Vec<f64>), E> {
    match values {
        None => Ok((None, Vec::new())),
        Some(Values::One(value)) => Ok((Some(value), Vec::new())),
        Some(Values::Along(list)) if list.len() == n_points => {
            let (mean, shares) = mean_and_shares(&list);
            Ok((Some(mean), shares))
        }
        Some(Values::Along(list)) => {
            let n = list.len();
            Err(E::custom(format!("found a list of {n}, expected one for each of {n_points} points")))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_fields_and_none() {
        let raw = read(
            br#"{"note": "x", "made_by": 1, "strands": [
                {"name": "B01", "length_m": 0.2, "linear_density_kg_per_m": 0.001, "lock_width_m": 0.004,
                 "bending_stiffness_N_m2": 1e-6, "internal_damping_time_s": 0.02, "lock_widht_m": 1, "color": [1],
                 "rest_curve_m": [[0, 0, 0], [0, 0, -0.1]]},
                {"rest_curve_m": [[1, 0, 0], [1, 0, -1]]}]}"#,
        )
        .unwrap();
        let first = &raw.strands[0];
        assert_eq!(first.name.as_deref(), Some("B01"));
        assert_eq!((first.length, first.lock_width_m), (Some(0.2), Some(0.004)));
        assert_eq!(first.linear_density_kg_per_m, Some(0.001));
        assert_eq!((first.bending_stiffness_n_m2, first.internal_damping_secs), (Some(1e-6), Some(0.02)));
        assert_eq!(raw.strands[1].points[1], Vec3::new(1.0, 0.0, -1.0));
        assert_eq!(raw.strands[1].lock_width_m, None);
        assert_eq!(
            raw.warnings,
            [
                "fields of the groom that mean nothing here: made_by",
                "fields of strands that mean nothing here: color, lock_widht_m"
            ]
        );
    }

    #[test]
    fn properties_by_the_point() {
        let strand = |fields: &str| {
            read(format!("{{\"strands\": [{{{fields}, \"rest_curve_m\": [[0,0,0],[0,0,1]]}}]}}").as_bytes())
        };
        let raw = strand("\"lock_width_m\": [0.004, 0.002], \"linear_density_kg_per_m\": 1").unwrap();
        assert_eq!(raw.strands[0].lock_width_m, Some(0.003));
        assert_eq!(raw.strands[0].linear_density_kg_per_m, Some(1.0));
        assert_eq!(raw.strands[0].along.width, [0.004 / 0.003, 0.002 / 0.003]);
        assert!(raw.strands[0].along.linear_density.is_empty() && raw.warnings.is_empty());
        for (fields, says) in [
            (
                "\"lock_width_m\": [1, 2, 3]",
                ": strands[0].lock_width_m: found a list of 3, expected one for each of 2 points",
            ),
            ("\"lock_width_m\": []", "a list of one for each point"),
            ("\"lock_width_m\": [1, -2]", "found -2 in a list, expected numbers above 0"),
            ("\"lock_width_m\": \"1\"", "expected a number, or a list of one for each point"),
        ] {
            let error = strand(fields).unwrap_err().to_string();
            assert!(error.contains(says), "{says}: {error}");
        }
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        let strand =
            |fields: &str| format!("{{\"strands\": [\n{{\"rest_curve_m\": [[0,0,0],[0,0,1]]{fields}}}]}}");
        for (text, says) in [
            (
                strand(", \"length_m\": NaN"),
                "line 2, column 49: strands[0].length_m: found NaN, expected a finite number",
            ),
            (
                strand(", \"length_m\": -Infinity"),
                "line 2, column 49: strands[0].length_m: found -Infinity, expected a finite",
            ),
            (strand(", \"length_m\": 1e999"), "line 2, column 53: strands[0].length_m: number out of range"),
            (
                strand(", \"length_m\": \"0.1\""),
                "strands[0].length_m: invalid type: string \"0.1\", expected f64",
            ),
            (strand(", \"length_m\": 1, \"length_m\": 2"), "strands[0].length_m: duplicate field `length_m`"),
            (
                strand("").replace("[0,0,1]", "[0,1]"),
                "strands[0].rest_curve_m: invalid length 2, expected an array of length 3",
            ),
            (strand("").replace("rest_curve_m", "rest"), ": strands[0]: missing field `rest_curve_m`"),
            ("{}".into(), "line 1, column 2: missing field `strands`"),
            ("[]".into(), "expected an object with a list of `strands`"),
            (strand("}, {\"name\": \"a\""), ": strands[1] (strand a): missing field `rest_curve_m`"),
            (
                strand("}, {\"name\": \"a\", \"lock_width_m\": [1, 0]"),
                "strands[1].lock_width_m (strand a): found 0 in a list",
            ),
            (
                strand(", \"name\": \"a\"}, {\"name\": \"a\", \"rest_curve_m\": []"),
                "strands[1].name: found the name \"a\" a second time",
            ),
            ("{\"strands\": [".into(), "strands[0]: EOF while parsing"),
            ("{\"strands\": []} x".into(), "column 17: trailing characters"),
        ] {
            let error = read(text.as_bytes()).unwrap_err().to_string();
            assert!(error.contains(says), "{says}\n{error}");
        }
    }
}
