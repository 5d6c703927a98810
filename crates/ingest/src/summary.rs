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
    /// The points' labels as the file has them, padding cut off, in file order; fewer than points if the file has
    /// fewer.
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
    /// Their names, as far as they have any.
    pub names: Vec<String>,
    /// Samples a second, if the file says.
    pub rate_hz: Option<f64>,
}

impl fmt::Display for OtherContent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({})", self.what, self.count)
    }
}

/// Says what is in a capture file. No unit is needed: nothing is converted, and no sample is dropped.
///
/// # Errors
/// [`IngestError`] if the format is unknown or the file is broken.
pub fn summarize(bytes: &[u8]) -> Result<CaptureSummary, IngestError> {
    let mut recording = crate::recording::read(bytes)?;
    let all: Vec<usize> = (0..recording.points.len()).collect();
    let mut sums = vec![Sum::default(); all.len()];
    let mut n_zeros = 0;
    recording.visit(&all, |k, _, position| {
        sums[k].add(position);
        n_zeros += usize::from(position == [0.0; 3]);
    })?;
    if n_zeros > 0 {
        recording.warnings.push(format!(
            "{n_zeros} positions are exactly 0, 0, 0; conversion takes them as missing unless told to keep them"
        ));
    }
    let frames = recording.frames.n_rows();
    let valid: usize = sums.iter().map(|sum| sum.n).sum();
    let labels = || recording.points.iter().map(|p| p.label.clone());
    let trajectories = labels().zip(&sums).map(|(label, sum)| TrajectorySummary {
        label: label.unwrap_or_default(),
        valid: sum.n,
        mean: sum.mean(),
    });
    Ok(CaptureSummary {
        kind: "capture",
        format: recording.format,
        frames,
        first_frame: recording.frames.first(),
        rate_hz: recording.rate_hz,
        unit: recording.unit,
        labels: labels().flatten().collect(),
        invalid_samples: frames * sums.len() - valid,
        trajectories: trajectories.collect(),
        other: recording.other,
        warnings: recording.warnings,
    })
}

/// The sum of the positions of one point.
#[derive(Clone, Default)]
struct Sum {
    n: usize,
    total: [f64; 3],
}

impl Sum {
    fn add(&mut self, position: [f64; 3]) {
        self.n += 1;
        for (total, coordinate) in self.total.iter_mut().zip(position) {
            *total += coordinate;
        }
    }

    fn mean(&self) -> Option<[f64; 3]> {
        (self.n > 0).then(|| self.total.map(|total| total / self.n as f64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_contract_of_inspect() {
        let csv = "Devices\n1000\n,,Plate,,\nFrame,Sub Frame,Fx,Fy,Fz\n,,N,N,N\n7,0,1,2,3\n\n\
            Trajectories\n120\n,,Wig: LFHD ,,,*1,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm\n\
            7,0,1.5,2,3,,,\n8,0,2.5,4,9,,,\n";
        let summary = summarize(csv.as_bytes()).unwrap();
        assert_eq!(
            serde_json::to_value(&summary).unwrap(),
            serde_json::json!({
                "kind": "capture",
                "format": "vicon-csv",
                "frames": 2,
                "first_frame": 7,
                "rate_hz": 120.0,
                "unit": "mm",
                "labels": ["Wig: LFHD", "*1"],
                "invalid_samples": 2,
                "trajectories": [
                    {"label": "Wig: LFHD", "valid": 2, "mean": [2.0, 3.0, 6.0]},
                    {"label": "*1", "valid": 0, "mean": null},
                ],
                "other": [{"what": "Devices", "count": 1, "names": ["Plate"], "rate_hz": 1000.0}],
                "warnings": [],
            })
        );
    }
}
