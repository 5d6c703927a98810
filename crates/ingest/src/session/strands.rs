use super::file::{OneOrEach, SessionFile, StrandFile};
use super::number::{length, point, positive};
use super::{SessionError, defaults};
use std::collections::BTreeSet;
use tousle_core::{Assumption, StrandMarker, StrandSpec};

/// A tape measure along a lock is off by a few millimeters: the last marker may seem to sit past the tip.
const MEASURING_SLACK_M: f64 = 0.01;

/// The measured locks.
pub(super) fn read(
    file: &SessionFile,
    assumed: &mut Vec<Assumption>,
) -> Result<Vec<StrandSpec>, SessionError> {
    if file.strands.is_empty() {
        return Err(SessionError::field("strands", "none", "at least one lock"));
    }
    let mut names = BTreeSet::new();
    let mut strands = Vec::with_capacity(file.strands.len());
    let mut missing = Missing::default();
    for (idx, given) in file.strands.iter().enumerate() {
        if !names.insert(&given.strand) {
            let path = format!("strands[{idx}].strand");
            return Err(SessionError::field(&path, format!("{:?} again", given.strand), "each lock once"));
        }
        strands.push(one(idx, given, file, &mut missing, assumed)?);
    }
    assumed.extend(missing.list(file.strands.len()));
    Ok(strands)
}

/// The names of the locks for which a default stands.
#[derive(Default)]
struct Missing {
    density: Vec<String>,
    width: Vec<String>,
    mass: Vec<String>,
}

impl Missing {
    fn list(self, n_strands: usize) -> impl Iterator<Item = Assumption> {
        let lists = [
            (self.density, "linear_density_g_per_m", defaults::DENSITY),
            (self.width, "lock_width_mm", defaults::WIDTH),
            (self.mass, "marker_mass_mg", defaults::MARKER_MASS),
        ];
        lists.into_iter().filter(|(names, ..)| !names.is_empty()).map(move |(names, field, (value, why))| {
            let which = if names.len() == n_strands { "*".to_owned() } else { names.join(", ") };
            defaults::assumption(&format!("strands[{which}].{field}"), value, why)
        })
    }
}

fn one(
    idx: usize,
    given: &StrandFile,
    file: &SessionFile,
    missing: &mut Missing,
    assumed: &mut Vec<Assumption>,
) -> Result<StrandSpec, SessionError> {
    let path = |field: &str| format!("strands[{idx}].{field} (lock {})", given.strand);
    let note = |list: &mut Vec<String>| list.push(given.strand.clone());
    let density = given.linear_density_g_per_m.map(|v| positive(&path("linear_density_g_per_m"), v / 1e3));
    let width = given.lock_width_mm.map(|v| length(&path("lock_width_mm"), v));
    let (density, width) = (density.transpose()?, width.transpose()?);
    if density.is_none() {
        note(&mut missing.density);
    }
    if width.is_none() {
        note(&mut missing.width);
    }
    if given.marker_mass_mg.is_none() {
        note(&mut missing.mass);
    }
    let (linear_density_kg_per_m, lock_width_m) = defaults::lock(density, width);
    let markers = markers(given, file, &path)?;
    let mut length_m = length(&path("length_mm"), given.length_mm)?;
    if let Some(last) = markers.last().and_then(|m| m.distance_from_root_m).filter(|&last| last > length_m) {
        if last > length_m + MEASURING_SLACK_M {
            let found = format!("{} mm on a lock of {} mm", last * 1e3, given.length_mm);
            return Err(SessionError::field(
                &path("marker_distance_from_root_mm"),
                found,
                "a place on the lock",
            ));
        }
        assumed.push(defaults::longer_lock(&path("length_mm"), last));
        length_m = last;
    }
    Ok(StrandSpec {
        name: given.strand.clone(),
        length_m,
        linear_density_kg_per_m,
        lock_width_m,
        root_m: point(&path("root_mm"), given.root_mm)?,
        markers,
    })
}

fn markers(
    given: &StrandFile,
    file: &SessionFile,
    path: &impl Fn(&str) -> String,
) -> Result<Vec<StrandMarker>, SessionError> {
    let n = given.markers.len();
    if n == 0 {
        return Err(SessionError::field(&path("markers"), "none", "at least one marker"));
    }
    let each = |field: &str, found: usize| {
        SessionError::field(&path(field), format!("{found} numbers"), format!("{n}, one for each marker"))
    };
    let distances = given.marker_distance_from_root_mm.as_deref();
    if let Some(distances) = distances {
        check_distances(distances, n, path)?;
    }
    let mass_mg = |idx: usize| match &given.marker_mass_mg {
        None => Ok(defaults::MARKER_MASS_MG),
        Some(OneOrEach::One(mass)) => Ok(*mass),
        Some(OneOrEach::Each(masses)) if masses.len() == n => Ok(masses[idx]),
        Some(OneOrEach::Each(masses)) => Err(each("marker_mass_mg", masses.len())),
    };
    let one = |(idx, label): (usize, &String)| {
        let mass_mg = mass_mg(idx)?;
        if !mass_mg.is_finite() || mass_mg < 0.0 {
            return Err(SessionError::field(&path("marker_mass_mg"), mass_mg.to_string(), "a number >= 0"));
        }
        Ok(StrandMarker {
            label: file.bare(label).to_owned(),
            distance_from_root_m: distances.map(|mm| mm[idx] / 1e3),
            mass_kg: mass_mg / 1e6,
        })
    };
    given.markers.iter().enumerate().map(one).collect()
}

fn check_distances(
    distances: &[f64],
    n_markers: usize,
    path: &impl Fn(&str) -> String,
) -> Result<(), SessionError> {
    let path = path("marker_distance_from_root_mm");
    if distances.len() != n_markers {
        let expected = format!("{n_markers}, one for each marker");
        return Err(SessionError::field(&path, format!("{} numbers", distances.len()), expected));
    }
    let mut last = 0.0;
    for &distance in distances {
        if !distance.is_finite() || distance < last || distance <= 0.0 {
            let expected = "rising distances, markers listed from root to tip";
            return Err(SessionError::field(&path, format!("{distance} after {last}"), expected));
        }
        last = distance;
    }
    Ok(())
}
