use crate::label::Label;
use crate::recording::Role;
use crate::{CaptureFormat, IngestError};
use serde::Serialize;
use std::fmt;
use tousle_core::UpAxis;

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
    /// The axis that the file says is up. Not in JSON, whose fields are settled.
    #[serde(skip)]
    pub up_axis: Option<UpAxis>,
    /// The prefixes of the labels, in the order in which they first occur. Not in JSON.
    #[serde(skip)]
    pub subjects: Vec<String>,
    /// Points that nobody labeled. Not in JSON.
    #[serde(skip)]
    pub n_unlabeled: usize,
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
    /// Runs of rows without a position. Not in JSON.
    #[serde(skip)]
    pub gaps: usize,
    /// Rows of the longest of them. Not in JSON.
    #[serde(skip)]
    pub longest_gap: usize,
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
    recording.visit(&all, |k, row, position| {
        sums[k].add(row, position);
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
        gaps: sum.gaps + usize::from(sum.next_row < frames),
        longest_gap: sum.longest_gap.max(frames - sum.next_row),
    });
    let of_markers = recording.points.iter().filter(|p| p.role == Role::Marker).enumerate();
    let names: Vec<Label> = of_markers.map(|(idx, p)| Label::of(idx, p.label.as_deref())).collect();
    let mut subjects: Vec<String> = Vec::new();
    for subject in names.iter().filter_map(|name| name.subject.as_ref()) {
        if !subjects.contains(subject) {
            subjects.push(subject.clone());
        }
    }
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
        up_axis: recording.up_axis,
        subjects,
        n_unlabeled: names.iter().filter(|name| name.name.starts_with('*')).count(),
    })
}

/// The sum of the positions of one point, whose rows come in order, and the gaps between them.
#[derive(Clone, Default)]
struct Sum {
    n: usize,
    total: [f64; 3],
    next_row: usize,
    gaps: usize,
    longest_gap: usize,
}

impl Sum {
    fn add(&mut self, row: usize, position: [f64; 3]) {
        self.n += 1;
        self.gaps += usize::from(row > self.next_row);
        self.longest_gap = self.longest_gap.max(row - self.next_row);
        self.next_row = row + 1;
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

    /// Seen in rows 2 and 3 of 0 to 5: a gap at either end, the longest of two rows.
    #[test]
    fn gaps_are_counted_at_both_ends_too() {
        let rows = ["7,0,,,,,,", "8,0,,,,1,2,3", "9,0,1,2,3,,,", "10,0,1,2,3,1,2,3", "11,0,,,,,,"];
        let csv = format!(
            "Trajectories\n120\n,,Wig:A,,,Ann:B,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm\n{}\n",
            rows.join("\n")
        );
        let summary = summarize(csv.as_bytes()).unwrap();
        let gaps: Vec<_> = summary.trajectories.iter().map(|t| (t.gaps, t.longest_gap)).collect();
        assert_eq!(gaps, [(2, 2), (3, 1)]);
        assert_eq!(summary.subjects, ["Wig", "Ann"]);
    }

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
