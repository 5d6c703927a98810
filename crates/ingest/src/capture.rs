use crate::label::Label;
use crate::recording::{Point, Recording, Role};
use crate::time::Rows;
use crate::{CaptureFormat, IngestError, IngestOptions};
use serde::Serialize;
use std::collections::BTreeSet;
use tousle_core::{Capture, LengthUnit, Track, Trajectory, Vec3};

/// A capture, and how it came to be.
#[derive(Clone, Debug, PartialEq)]
pub struct Ingested {
    /// Marker positions, world space, m.
    pub capture: Capture,
    /// The format the bytes were in.
    pub format: CaptureFormat,
    /// What was odd, assumed, or left out.
    pub report: IngestReport,
}

/// What was odd, assumed, or left out as a file was read.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct IngestReport {
    /// In words, each with its place.
    pub warnings: Vec<String>,
    /// Frames that the file claims and frames that are there, of a file that was cut off.
    pub cut: Option<(u64, u64)>,
}

/// Reads the markers of any capture file.
///
/// In: the whole file. Out: world-space positions, m; what the cameras did not see stays missing. Frames that
/// the file skips are there and missing, so that time runs evenly. Points that are no markers (angles, forces,
/// poses of bodies) are left out and reported.
///
/// # Errors
/// [`IngestError`] if the format is unknown or the file is broken, if neither file nor options give unit or
/// rate, or if the subject asked for is not there.
pub fn read_capture(bytes: &[u8], options: &IngestOptions) -> Result<Ingested, IngestError> {
    let mut recording = crate::recording::read(bytes)?;
    if let Some((claimed, found)) = recording.cut.filter(|_| !options.allow_cut) {
        return Err(IngestError::CutShort { claimed, found });
    }
    let mut warnings = std::mem::take(&mut recording.warnings);
    let chosen = choose(&recording, options, &mut warnings)?;
    let (unit, file_unit) = unit(&recording, options, &mut warnings)?;
    let rate_hz = rate(&recording, options, &mut warnings)?;
    let rows = Rows::of(&recording.frames, chosen.len(), bytes.len(), &mut warnings)?;
    let tracks = tracks(&mut recording, &chosen, unit, &rows, options, &mut warnings)?;
    let named = chosen.into_iter().zip(tracks);
    let capture = Capture {
        rate_hz,
        first_frame: recording.frames.first(),
        n_frames: rows.n_frames,
        file_unit,
        up_axis: recording.up_axis,
        trajectories: named
            .map(|((_, label), track)| Trajectory { subject: label.subject, label: label.name, track })
            .collect(),
    };
    Ok(Ingested { capture, format: recording.format, report: IngestReport { warnings, cut: recording.cut } })
}

/// The points to load, by index: the markers, each once, of the subject that was asked for.
fn choose(
    recording: &Recording<'_>,
    options: &IngestOptions,
    warnings: &mut Vec<String>,
) -> Result<Vec<(usize, Label)>, IngestError> {
    let markers = markers(recording, warnings)?;
    let label = |idx: usize| (idx, Label::of(idx, recording.points[idx].label.as_deref()));
    let labeled: Vec<(usize, Label)> = markers.into_iter().map(label).collect();
    match &options.subject {
        Some(subject) => of_subject(labeled, subject, warnings),
        None => Ok(labeled),
    }
}

fn markers(recording: &Recording<'_>, warnings: &mut Vec<String>) -> Result<Vec<usize>, IngestError> {
    let points = &recording.points;
    let of_role = |role: Role| points.iter().filter(|p| p.role == role).count();
    if of_role(Role::Computed) > 0 {
        let n = of_role(Role::Computed);
        warnings.push(format!("{n} points are computed (angles, forces, poses), not seen, and are left out"));
    }
    let measured: BTreeSet<&str> =
        points.iter().filter(|p| p.role == Role::Marker).filter_map(|p| p.label.as_deref()).collect();
    let is_measured = |p: &Point| p.label.as_deref().is_some_and(|label| measured.contains(label));
    // Bodies can be exported solved beside markers that are measured: each label by itself tells which it is.
    let n_twice = points.iter().filter(|p| p.role == Role::Solved && is_measured(p)).count();
    if n_twice > 0 {
        warnings.push(format!(
            "{n_twice} solved positions of markers are left out: the measured ones are there too"
        ));
    }
    let n_solved = of_role(Role::Solved) - n_twice;
    if n_solved > 0 {
        warnings.push(format!(
            "{n_solved} markers are where a solved body has them: no measured ones have their labels"
        ));
    }
    let is_wanted = |p: &Point| p.role == Role::Marker || p.role == Role::Solved && !is_measured(p);
    let markers: Vec<usize> = (0..points.len()).filter(|&idx| is_wanted(&points[idx])).collect();
    if markers.is_empty() || recording.frames.n_rows() == 0 {
        return Err(IngestError::NoTrajectories { found: contents(recording, markers.len()) });
    }
    Ok(markers)
}

/// What a file without trajectories holds instead.
fn contents(recording: &Recording<'_>, n_markers: usize) -> String {
    let points = match (n_markers, recording.points.len()) {
        (0, 0) => "no points".to_owned(),
        (0, n) => format!("{n} points, none of them a marker"),
        (n, _) => format!("{n} markers and no frames"),
    };
    let other = recording.other.iter().map(ToString::to_string);
    std::iter::once(points).chain(other).collect::<Vec<_>>().join(", ")
}

/// The subject's markers, those that nobody labeled, and those whose labels name no subject: one that has the name of a marker of the
/// subject's is somebody else's.
fn of_subject(
    mut labeled: Vec<(usize, Label)>,
    wanted: &str,
    warnings: &mut Vec<String>,
) -> Result<Vec<(usize, Label)>, IngestError> {
    let mut subjects: Vec<&str> = labeled.iter().filter_map(|(_, l)| l.subject.as_deref()).collect();
    subjects.sort_unstable();
    subjects.dedup();
    if subjects.is_empty() {
        warnings.push(format!("no label names a subject; all markers are taken to be those of {wanted:?}"));
        return Ok(labeled);
    }
    if !subjects.contains(&wanted) {
        return Err(IngestError::NoSuchSubject { wanted: wanted.to_owned(), found: subjects.join(", ") });
    }
    let n_all = labeled.len();
    let is_own = |l: &Label| l.subject.as_deref() == Some(wanted);
    let own: BTreeSet<String> =
        labeled.iter().filter(|(_, l)| is_own(l)).map(|(_, l)| l.name.clone()).collect();
    let is_bare = |l: &Label| l.subject.is_none() && !l.is_unlabeled() && !own.contains(&l.name);
    labeled.retain(|(_, l)| l.is_unlabeled() || is_own(l) || is_bare(l));
    let n_bare = labeled.iter().filter(|(_, l)| is_bare(l)).count();
    if n_bare > 0 {
        warnings.push(format!(
            "{n_bare} markers whose labels name no subject are taken to be those of {wanted:?}"
        ));
    }
    if labeled.len() < n_all {
        warnings.push(format!("{} markers of other subjects are left out", n_all - labeled.len()));
    }
    Ok(labeled)
}

/// The unit to read positions in, and the one the file names.
fn unit(
    recording: &Recording<'_>,
    options: &IngestOptions,
    warnings: &mut Vec<String>,
) -> Result<(LengthUnit, Option<LengthUnit>), IngestError> {
    let named = recording.unit.as_deref();
    let in_file = named.and_then(LengthUnit::from_name);
    if let Some(unit) = options.unit_override {
        if in_file != Some(unit)
            && let Some(named) = named
        {
            warnings.push(format!("the file says {named:?}, read as {}, as given", unit.name()));
        }
        return Ok((unit, in_file));
    }
    match (in_file, named, options.unit) {
        (Some(unit), _, given) => {
            if let Some(given) = given.filter(|&given| given != unit) {
                let (unit, given) = (unit.name(), given.name());
                warnings.push(format!("the file says {unit}, {given} was given; read as the file says"));
            }
            Ok((unit, in_file))
        }
        (None, Some(found), Some(unit)) => {
            let unit_name = unit.name();
            warnings.push(format!(
                "the file's unit {found:?} is not one of length; read as {unit_name}, as given"
            ));
            Ok((unit, None))
        }
        (None, Some(found), None) => Err(IngestError::UnknownUnit { found: found.to_owned() }),
        (None, None, Some(unit)) => Ok((unit, None)),
        (None, None, None) => Err(IngestError::NoUnit),
    }
}

fn rate(
    recording: &Recording<'_>,
    options: &IngestOptions,
    warnings: &mut Vec<String>,
) -> Result<f64, IngestError> {
    let is_same = |a: f64, b: f64| (a - b).abs() <= 1e-3 * a;
    let found = match (recording.rate_hz, options.rate_hz) {
        // A file that contradicts itself, and a witness.
        (Some(rate), Some(given))
            if !is_same(rate, given)
                && recording.other_rate_hz.is_some_and(|other| is_same(other, given)) =>
        {
            let other = recording.other_rate_hz.unwrap_or(given);
            warnings.push(format!(
                "the file says {rate} frames a second and {other}, {given} was given; read as {other}, which two say"
            ));
            other
        }
        (Some(rate), other) => {
            if let Some(other) = other.filter(|&other| !is_same(rate, other)) {
                warnings.push(format!(
                    "the file says {rate} frames a second, {other} was given; read as the file says"
                ));
            }
            rate
        }
        (None, Some(rate)) => {
            warnings.push(format!("the file names no frame rate; {rate} a second, as given"));
            rate
        }
        (None, None) => return Err(IngestError::NoRate),
    };
    if found.is_finite() && found > 0.0 { Ok(found) } else { Err(IngestError::BadRate { found }) }
}

fn tracks(
    recording: &mut Recording<'_>,
    chosen: &[(usize, Label)],
    unit: LengthUnit,
    rows: &Rows,
    options: &IngestOptions,
    warnings: &mut Vec<String>,
) -> Result<Vec<Track>, IngestError> {
    let idxs: Vec<usize> = chosen.iter().map(|(idx, _)| *idx).collect();
    let mut tracks = vec![Track::missing(rows.n_frames); idxs.len()];
    let (mut n_zeros, mut n_faulty) = (0, 0);
    recording.visit(&idxs, |k, row, position| {
        if position == [0.0; 3] && !options.keep_exact_zeros {
            n_zeros += 1;
            return;
        }
        let position_m = Vec3::from(position) * unit.meters();
        n_faulty += usize::from(position_m.amax() > FARTHEST_M);
        tracks[k].set(rows.frame(row), Some(position_m));
    })?;
    if n_zeros > 0 {
        warnings.push(format!("{n_zeros} positions are exactly 0, 0, 0 and count as missing"));
    }
    if n_faulty > 0 {
        warnings.push(format!(
            "{n_faulty} positions are more than {FARTHEST_M} m from the origin: is the unit right?"
        ));
    }
    Ok(tracks)
}

/// No capture room reaches so far, m; millimeters taken for meters do.
const FARTHEST_M: f64 = 100.0;

#[cfg(test)]
mod tests;
