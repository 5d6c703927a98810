use crate::{CaptureFormat, IngestError};
use serde::Serialize;
use std::fmt;

/// What is in a capture file, in the file's own unit and words.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CaptureSummary {
    /// Always `capture`.
    pub kind: &'static str,
    /// The format the bytes are in.
    pub format: CaptureFormat,
    /// Rows of positions in the file.
    pub frames: usize,
    /// The number the file gives its first frame.
    pub first_frame: i64,
    /// Frames a second, if the file says.
    pub rate_hz: Option<f64>,
    /// The unit of length as the file names it, if it does.
    pub unit: Option<String>,
    /// Every point's label as the file has it, padding cut off, in file order.
    pub labels: Vec<String>,
    /// Samples (point and frame) without a position.
    pub invalid_samples: usize,
    /// The points in file order.
    pub trajectories: Vec<TrajectorySummary>,
    /// What else the file holds and a capture does not.
    pub other: Vec<OtherContent>,
    /// What is odd about the file.
    pub warnings: Vec<String>,
}

/// One point of a [`CaptureSummary`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrajectorySummary {
    /// The label as the file has it.
    pub label: String,
    /// Samples with a position.
    pub valid: usize,
    /// Mean over the valid samples, in the file's own unit; none without such a sample.
    pub mean: Option<[f64; 3]>,
}

/// Something in a capture file that is counted and not loaded: analog channels, events, rotations.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OtherContent {
    /// What it is.
    pub what: String,
    /// How many of them.
    pub count: usize,
    /// Samples a second, if the file says.
    pub rate_hz: Option<f64>,
    /// Samples of each.
    pub rows: usize,
}

impl fmt::Display for OtherContent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({} columns, {} rows)", self.what, self.count, self.rows)
    }
}

/// Says what is in a capture file. No unit is needed: nothing is converted, and no sample is dropped.
///
/// # Errors
/// [`IngestError`] if the format is unknown or the file is broken.
pub fn summarize(bytes: &[u8]) -> Result<CaptureSummary, IngestError> {
    let mut recording = crate::recording::read(bytes)?;
    let trajectories: Vec<TrajectorySummary> = recording.points.iter().map(of_point).collect();
    let frames = recording.frames.n_rows();
    let valid: usize = trajectories.iter().map(|t| t.valid).sum();
    let n_zeros =
        recording.points.iter().flat_map(|p| &p.positions).filter(|p| **p == Some([0.0; 3])).count();
    if n_zeros > 0 {
        recording.warnings.push(format!(
            "{n_zeros} positions are exactly 0, 0, 0; conversion takes them as missing unless told to keep them"
        ));
    }
    Ok(CaptureSummary {
        kind: "capture",
        format: recording.format,
        frames,
        first_frame: recording.frames.first(),
        rate_hz: recording.rate_hz,
        unit: recording.unit,
        labels: recording.points.into_iter().map(|p| p.label).collect(),
        invalid_samples: frames * trajectories.len() - valid,
        trajectories,
        other: recording.other,
        warnings: recording.warnings,
    })
}

fn of_point(point: &crate::recording::Point) -> TrajectorySummary {
    let valid = point.positions.iter().flatten().count();
    let mut sum = [0.0; 3];
    for position in point.positions.iter().flatten() {
        for (total, coordinate) in sum.iter_mut().zip(position) {
            *total += coordinate;
        }
    }
    let mean = (valid > 0).then(|| sum.map(|total| total / valid as f64));
    TrajectorySummary { label: point.label.clone(), valid, mean }
}
