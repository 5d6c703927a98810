mod vicon;

use crate::{CaptureFormat, IngestError, OtherContent, guess_format};

/// How many frames may pass, on average, for each row of a file: more is a mistake in the frame numbers.
pub(crate) const LARGEST_SPREAD: usize = 100;

/// What a file says before anyone decides what its numbers mean: positions in the file's own unit.
#[derive(Debug)]
pub(crate) struct Recording {
    pub format: CaptureFormat,
    pub rate_hz: Option<f64>,
    pub frames: Frames,
    /// The unit as the file writes it.
    pub unit: Option<String>,
    pub up_axis: Option<tousle_core::UpAxis>,
    pub points: Vec<Point>,
    /// What else is in the file and is not loaded.
    pub other: Vec<OtherContent>,
    pub warnings: Vec<String>,
}

/// The frame numbers of the rows of positions.
#[derive(Debug)]
pub(crate) enum Frames {
    /// One after the other.
    From { first: i64, n_rows: usize },
    /// As each row says.
    Listed(Vec<i64>),
}

/// One point of a recording.
#[derive(Debug)]
pub(crate) struct Point {
    /// The label as the file has it, with its prefix.
    pub label: String,
    pub role: Role,
    /// In each row; `None` where it was not seen.
    pub positions: Vec<Option<[f64; 3]>>,
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

impl Frames {
    /// Frame numbers as listed, in short form if they simply count.
    pub fn listed(frames: Vec<i64>) -> Self {
        let counts = frames.windows(2).all(|pair| pair[0].checked_add(1) == Some(pair[1]));
        match frames.first() {
            Some(&first) if counts => Self::From { first, n_rows: frames.len() },
            None => Self::From { first: 1, n_rows: 0 },
            Some(_) => Self::Listed(frames),
        }
    }

    pub fn first(&self) -> i64 {
        match self {
            Self::From { first, .. } => *first,
            Self::Listed(frames) => frames.first().copied().unwrap_or(1),
        }
    }

    pub fn n_rows(&self) -> usize {
        match self {
            Self::From { n_rows, .. } => *n_rows,
            Self::Listed(frames) => frames.len(),
        }
    }
}

/// Reads any capture.
pub(crate) fn read(bytes: &[u8]) -> Result<Recording, IngestError> {
    if bytes.is_empty() {
        return Err(IngestError::Empty);
    }
    let mut recording = match guess_format(bytes) {
        Some(CaptureFormat::ViconCsv | CaptureFormat::ViconWorkstationCsv) => vicon::read(bytes)?,
        None => return Err(IngestError::UnknownFormat { found: beginning(bytes) }),
    };
    warn_of_duplicates(&mut recording);
    Ok(recording)
}

/// The first bytes as text that can be printed.
fn beginning(bytes: &[u8]) -> String {
    let text: String = bytes.iter().take(24).map(|b| b.escape_ascii().to_string()).collect();
    format!("\"{text}\"")
}

fn warn_of_duplicates(recording: &mut Recording) {
    let mut labels: Vec<&str> = recording.points.iter().map(|p| p.label.as_str()).collect();
    labels.sort_unstable();
    let mut twice: Vec<&str> =
        labels.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect();
    twice.dedup();
    if !twice.is_empty() {
        recording.warnings.push(format!("labels that occur more than once: {}", twice.join(", ")));
    }
}
