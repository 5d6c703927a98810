use serde::Serialize;
use tousle_core::Assumption;
use tousle_fit::FitReport;
use tousle_head::HeadReport;
use tousle_ingest::IngestReport;
use tousle_raster::RasterReport;

/// What happened in a conversion, stage by stage. It travels in the field file as `report.json`.
///
/// No times of day and no durations: the same input gives the same bytes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConversionReport {
    /// Which method was used.
    pub method: String,
    /// The capture's format, frames, rate and trajectories.
    pub capture: CaptureSummary,
    /// Values that nobody gave, and the defaults that stand for them.
    pub assumed: Vec<Assumption>,
    /// What reading the marker file brought up.
    pub ingest: IngestReport,
    /// How the head was found.
    pub head: HeadReport,
    /// How motion became wind.
    pub fit: FitReport,
    /// How the grid was filled.
    pub raster: RasterReport,
    /// What was asked for and is not in the field, in words; a conversion with any finishes "with loss".
    pub losses: Vec<String>,
}

/// A capture in a few numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CaptureSummary {
    /// The format's name.
    pub format: String,
    /// Frames.
    pub n_frames: usize,
    /// Frames a second.
    pub rate_hz: f64,
    /// How long it lasts, s.
    pub duration_secs: f64,
    /// Labeled and unlabeled trajectories.
    pub n_trajectories: usize,
    /// Trajectories that nobody labeled; this method does not use them.
    pub n_unlabeled: usize,
    /// Share of the session's lock markers times frames that was seen.
    pub seen: f64,
}

impl ConversionReport {
    /// What was asked for and is not in the field.
    pub(crate) fn find_losses(&mut self) {
        let mut losses = Vec::new();
        if let Some((claimed, found)) = self.ingest.cut {
            losses.push(format!("the capture is cut off: {found} of {claimed} frames are there"));
        }
        if !self.head.frames_without_pose.is_empty() {
            let n = self.head.frames_without_pose.len();
            losses
                .push(format!("{n} of {} frames have no head pose and were left out", self.capture.n_frames));
        }
        if !self.fit.strands_skipped.is_empty() {
            losses.push(format!("locks that gave no sample at all: {}", self.fit.strands_skipped.join(", ")));
        }
        if self.raster.n_steps_empty > 0 {
            let n = self.raster.n_steps_empty;
            losses.push(format!(
                "{n} of {} time steps hold no measurement: outside wind only",
                self.fit.n_steps
            ));
        }
        self.losses = losses;
    }
}
