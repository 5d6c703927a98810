use crate::recording::{Frames, LARGEST_SPREAD, Point, Recording, Role};
use crate::{CaptureFormat, IngestError, IngestOptions};
use serde::Serialize;
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
    let mut warnings = std::mem::take(&mut recording.warnings);
    keep_markers(&mut recording, &mut warnings)?;
    let (unit, file_unit) = unit(&recording, options, &mut warnings)?;
    let rate_hz = rate(&recording, options, &mut warnings)?;
    let rows = Rows::of(&recording.frames, &mut warnings)?;
    let mut n_zeros = 0;
    let mut trajectories: Vec<Trajectory> = std::mem::take(&mut recording.points)
        .into_iter()
        .map(|point| trajectory(point, &rows, unit.meters(), options.keep_exact_zeros, &mut n_zeros))
        .collect();
    if n_zeros > 0 {
        warnings.push(format!("{n_zeros} positions are exactly 0, 0, 0 and count as missing"));
    }
    if let Some(subject) = &options.subject {
        trajectories = of_subject(trajectories, subject, &mut warnings)?;
    }
    let capture = Capture {
        rate_hz,
        first_frame: recording.frames.first(),
        n_frames: rows.n_frames,
        file_unit,
        up_axis: recording.up_axis,
        trajectories,
    };
    Ok(Ingested { capture, format: recording.format, report: IngestReport { warnings } })
}

/// Leaves the points that are markers, each once.
fn keep_markers(recording: &mut Recording, warnings: &mut Vec<String>) -> Result<(), IngestError> {
    let n_before = recording.points.len();
    recording.points.retain(|p| p.role != Role::Computed);
    if recording.points.len() < n_before {
        let n = n_before - recording.points.len();
        warnings.push(format!("{n} points are computed (angles, forces, poses), not seen, and are left out"));
    }
    let labeled = |p: &Point| p.role == Role::Marker && !is_unlabeled(&p.label);
    if recording.points.iter().any(labeled) && recording.points.iter().any(|p| p.role == Role::Solved) {
        let n_all = recording.points.len();
        recording.points.retain(|p| p.role == Role::Marker);
        let n = n_all - recording.points.len();
        warnings.push(format!(
            "{n} solved positions of markers are left out: the file has the measured ones too"
        ));
    }
    if recording.points.is_empty() || recording.frames.n_rows() == 0 {
        let points = match (recording.points.len(), n_before) {
            (0, 0) => "no points".to_owned(),
            (0, n) => format!("{n} points, none of them a marker"),
            (n, _) => format!("{n} markers and no frames"),
        };
        let other: Vec<String> = recording.other.iter().map(ToString::to_string).collect();
        let found = if other.is_empty() { points } else { format!("{points}; {}", other.join(", ")) };
        return Err(IngestError::NoTrajectories { found });
    }
    Ok(())
}

/// The unit to read positions in, and the one the file names.
fn unit(
    recording: &Recording,
    options: &IngestOptions,
    warnings: &mut Vec<String>,
) -> Result<(LengthUnit, Option<LengthUnit>), IngestError> {
    let named = recording.unit.as_deref();
    let in_file = named.and_then(LengthUnit::from_name);
    if let Some(unit) = options.unit_override {
        if let Some(other) = in_file.filter(|&other| other != unit) {
            warnings.push(format!("the file says {other:?}, read as {unit:?} because the caller says so"));
        }
        return Ok((unit, in_file));
    }
    match (in_file, named, options.unit) {
        (Some(unit), _, other) => {
            if let Some(other) = other.filter(|&other| other != unit) {
                warnings
                    .push(format!("the file says {unit:?}, the session {other:?}; read as the file says"));
            }
            Ok((unit, in_file))
        }
        (None, Some(found), _) => Err(IngestError::UnknownUnit { found: found.to_owned() }),
        (None, None, Some(unit)) => Ok((unit, None)),
        (None, None, None) => Err(IngestError::NoUnit),
    }
}

fn rate(
    recording: &Recording,
    options: &IngestOptions,
    warnings: &mut Vec<String>,
) -> Result<f64, IngestError> {
    let found = match (recording.rate_hz, options.rate_hz) {
        (Some(rate), Some(other)) if (rate - other).abs() > 1e-3 * rate => {
            warnings.push(format!(
                "the file says {rate} frames a second, the session {other}; read as the file says"
            ));
            rate
        }
        (Some(rate), _) => rate,
        (None, Some(rate)) => {
            warnings.push(format!("the file names no frame rate; {rate} a second, as the session says"));
            rate
        }
        (None, None) => return Err(IngestError::NoRate),
    };
    if found.is_finite() && found > 0.0 { Ok(found) } else { Err(IngestError::BadRate { found }) }
}

/// Where each row of the file goes in time.
struct Rows {
    n_frames: usize,
    /// The frame (from 0) of each row; the row's own index if absent.
    frame_of_row: Option<Vec<usize>>,
}

impl Rows {
    fn of(frames: &Frames, warnings: &mut Vec<String>) -> Result<Self, IngestError> {
        let listed = match frames {
            Frames::From { n_rows, .. } => return Ok(Self { n_frames: *n_rows, frame_of_row: None }),
            Frames::Listed(listed) => listed,
        };
        if let Some(pair) = listed.windows(2).find(|pair| pair[1] <= pair[0]) {
            return Err(IngestError::FramesNotRising { frame: pair[1], previous: pair[0] });
        }
        let (first, last) = (frames.first(), listed.last().copied().unwrap_or_default());
        let n_rows = listed.len();
        let too_far = IngestError::FramesTooFarApart { first, last, rows: n_rows };
        let span = last.checked_sub(first).and_then(|span| usize::try_from(span).ok());
        let most = LARGEST_SPREAD.saturating_mul(n_rows);
        let n_frames = span.filter(|&span| span < most).ok_or(too_far)? + 1;
        warnings.push(format!(
            "the file skips {} of the frames {first} to {last}; they count as not seen",
            n_frames - n_rows
        ));
        // Rising from `first` to `last`, each difference lies within the span that was just checked.
        let frame_of_row = listed.iter().map(|frame| (frame - first) as usize).collect();
        Ok(Self { n_frames, frame_of_row: Some(frame_of_row) })
    }
}

fn trajectory(point: Point, rows: &Rows, meters: f64, keep_zeros: bool, n_zeros: &mut usize) -> Trajectory {
    let mut track = Track::missing(rows.n_frames);
    for (row, position) in point.positions.into_iter().enumerate().take(rows.n_frames) {
        let Some(position) = position else { continue };
        if position == [0.0; 3] && !keep_zeros {
            *n_zeros += 1;
            continue;
        }
        let frame = rows.frame_of_row.as_ref().map_or(row, |frames| frames[row]);
        track.set(frame, Some(Vec3::from(position) * meters));
    }
    let (subject, label) = split_label(&point.label);
    Trajectory { subject, label, track }
}

/// The subject's prefix and the marker's name; what nobody labeled gets a name that begins with `*`.
fn split_label(label: &str) -> (Option<String>, String) {
    if is_unlabeled(label) && !label.contains('*') {
        let number: String = label.chars().filter(char::is_ascii_digit).collect();
        return (None, format!("*{number}"));
    }
    match label.split_once(':') {
        Some((subject, name)) if !subject.is_empty() && !name.is_empty() => {
            (Some(subject.trim().to_owned()), name.trim().to_owned())
        }
        _ => (None, label.to_owned()),
    }
}

/// Whether a label is one that a program gives to what nobody labeled: `*12`, `Unlabeled 2278`.
fn is_unlabeled(label: &str) -> bool {
    let name = label.split_once(':').map_or(label, |(_, name)| name);
    let word = label.to_ascii_lowercase();
    let number = ["unlabeled", "unlabelled"].iter().find_map(|start| word.strip_prefix(start));
    name.starts_with('*')
        || number.is_some_and(|rest| {
            let digits = rest.trim_start_matches([' ', ':', '_', '-']);
            !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit())
        })
}

/// The subject's markers and those that nobody labeled.
fn of_subject(
    trajectories: Vec<Trajectory>,
    wanted: &str,
    warnings: &mut Vec<String>,
) -> Result<Vec<Trajectory>, IngestError> {
    let mut subjects: Vec<&str> = trajectories.iter().filter_map(|t| t.subject.as_deref()).collect();
    subjects.sort_unstable();
    subjects.dedup();
    if subjects.is_empty() {
        warnings.push(format!("no label names a subject; all markers are taken to be those of {wanted:?}"));
        return Ok(trajectories);
    }
    if !subjects.contains(&wanted) {
        return Err(IngestError::NoSuchSubject { wanted: wanted.to_owned(), found: subjects.join(", ") });
    }
    let n_all = trajectories.len();
    let is_wanted = |t: &Trajectory| t.is_unlabeled() || t.subject.as_deref() == Some(wanted);
    let kept: Vec<Trajectory> = trajectories.into_iter().filter(is_wanted).collect();
    if kept.len() < n_all {
        warnings.push(format!("{} markers of other subjects are left out", n_all - kept.len()));
    }
    Ok(kept)
}
