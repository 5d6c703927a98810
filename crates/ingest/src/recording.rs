mod c3d;
mod motive;
mod trc;
mod vicon;

use crate::{CaptureFormat, IngestError, OtherContent, guess_format};
use tousle_core::UpAxis;

/// What a file says before anyone decides what its numbers mean: positions in the file's own unit.
pub(crate) struct Recording<'a> {
    pub format: CaptureFormat,
    pub rate_hz: Option<f64>,
    /// Another rate that the file states, where its statements contradict one another.
    pub other_rate_hz: Option<f64>,
    pub frames: Frames,
    /// The unit as the file writes it.
    pub unit: Option<String>,
    pub up_axis: Option<UpAxis>,
    pub points: Vec<Point>,
    pub positions: Positions<'a>,
    /// What else is in the file and is not loaded.
    pub other: Vec<OtherContent>,
    pub warnings: Vec<String>,
    /// Frames that the file claims and frames that are there, if all its claims agree that it was longer.
    pub cut: Option<(u64, u64)>,
}

/// The frame numbers of the rows of positions.
#[derive(Debug)]
pub(crate) enum Frames {
    /// One after the other.
    From { first: i64, n_rows: usize },
    /// As each row says; `lines` is where the rows stand in the file, from 1.
    Listed { frames: Vec<i64>, lines: Vec<u64> },
}

/// One point of a recording.
#[derive(Debug)]
pub(crate) struct Point {
    /// The label as the file has it, with its prefix; `None` if the file has none for it.
    pub label: Option<String>,
    pub role: Role,
}

/// What a point is to us.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// A marker, as the cameras saw it.
    Marker,
    /// A marker where a solved body says it should be: the same marker a second time.
    Solved,
    /// A computed thing: an angle, a force, the pose of a body.
    Computed,
}

/// Where the positions are.
pub(crate) enum Positions<'a> {
    /// In memory, point by point.
    Table(Vec<Vec<Option<[f64; 3]>>>),
    /// In the bytes of a C3D, decoded when asked for.
    C3d(Box<tousle_c3d::Reader<std::io::Cursor<&'a [u8]>>>),
}

impl Point {
    pub fn new(label: String, role: Role) -> Self {
        Self { label: Some(label), role }
    }
}

impl Frames {
    /// Frame numbers as listed, in short form if they simply count.
    pub fn listed(frames: Vec<i64>, lines: Vec<u64>) -> Self {
        let counts = frames.windows(2).all(|pair| pair[0].checked_add(1) == Some(pair[1]));
        match frames.first() {
            Some(&first) if counts => Self::From { first, n_rows: frames.len() },
            None => Self::From { first: 1, n_rows: 0 },
            Some(_) => Self::Listed { frames, lines },
        }
    }

    pub fn first(&self) -> i64 {
        match self {
            Self::From { first, .. } => *first,
            Self::Listed { frames, .. } => frames.first().copied().unwrap_or(1),
        }
    }

    pub fn last(&self) -> i64 {
        match self {
            Self::From { first, n_rows } => first.saturating_add_unsigned(*n_rows as u64).saturating_sub(1),
            Self::Listed { frames, .. } => frames.last().copied().unwrap_or(1),
        }
    }

    pub fn n_rows(&self) -> usize {
        match self {
            Self::From { n_rows, .. } => *n_rows,
            Self::Listed { frames, .. } => frames.len(),
        }
    }
}

impl Recording<'_> {
    /// Shows every position of some points that is not missing, as `(index into point_idxs, row, position)`.
    ///
    /// The rows of one point come in order; nothing is said about the order of points.
    pub fn visit(
        &mut self,
        point_idxs: &[usize],
        mut visit: impl FnMut(usize, usize, [f64; 3]),
    ) -> Result<(), IngestError> {
        match &mut self.positions {
            Positions::Table(table) => {
                for (k, &idx) in point_idxs.iter().enumerate() {
                    for (row, position) in table[idx].iter().enumerate() {
                        if let Some(position) = position {
                            visit(k, row, *position);
                        }
                    }
                }
            }
            Positions::C3d(reader) => {
                reader.read_frames(point_idxs, 0..self.frames.n_rows(), |row, points| {
                    for (k, point) in points.iter().enumerate() {
                        if let Some(point) = point {
                            visit(k, row, point.position.map(f64::from));
                        }
                    }
                })?;
            }
        }
        Ok(())
    }
}

/// Reads any capture.
pub(crate) fn read(bytes: &[u8]) -> Result<Recording<'_>, IngestError> {
    if bytes.is_empty() {
        return Err(IngestError::Empty);
    }
    let mut recording = match guess_format(bytes) {
        Some(CaptureFormat::C3d) => c3d::read(bytes)?,
        Some(CaptureFormat::Trc) => trc::read(bytes)?,
        Some(CaptureFormat::MotiveCsv) => motive::read(bytes)?,
        Some(CaptureFormat::ViconCsv | CaptureFormat::ViconWorkstationCsv) => vicon::read(bytes)?,
        None => return Err(IngestError::UnknownFormat { found: beginning(bytes) }),
    };
    warn_of_labels(&mut recording);
    Ok(recording)
}

/// The first bytes as text that can be printed.
fn beginning(bytes: &[u8]) -> String {
    let text: String = bytes.iter().take(24).map(|b| b.escape_ascii().to_string()).collect();
    format!("\"{text}\"")
}

/// A table of points that are all markers.
fn markers(labels: impl Iterator<Item = String>) -> Vec<Point> {
    labels.map(|label| Point::new(label, Role::Marker)).collect()
}

fn warn_of_labels(recording: &mut Recording<'_>) {
    const MOST_SHOWN: usize = 8;
    let n_unnamed = recording.points.iter().filter(|p| p.label.as_ref().is_none_or(String::is_empty)).count();
    if n_unnamed > 0 {
        recording.warnings.push(format!("{n_unnamed} points have no label"));
    }
    let seen = recording.points.iter().filter(|p| p.role == Role::Marker);
    let mut labels: Vec<&str> = seen.filter_map(|p| p.label.as_deref()).filter(|l| !l.is_empty()).collect();
    labels.sort_unstable();
    let mut twice: Vec<&str> =
        labels.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect();
    twice.dedup();
    if !twice.is_empty() {
        let shown = twice[..twice.len().min(MOST_SHOWN)].join(", ");
        let more = if twice.len() > MOST_SHOWN { " and others" } else { "" };
        recording.warnings.push(format!("markers with the same label: {shown}{more}"));
    }
}
