use serde::Serialize;
use tousle_clean::CleanReport;
use tousle_core::Assumption;
use tousle_fit::FitReport;
use tousle_head::HeadReport;
use tousle_ingest::IngestReport;
use tousle_raster::RasterReport;
use tousle_refine::RefineReport;

/// How good a capture is, and everything that was odd, assumed, left out or changed before wind was told from it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct QualityReport {
    /// The session's name.
    pub name: String,
    /// The capture's format, frames, rate and trajectories.
    pub capture: CaptureSummary,
    /// Values that nobody gave, and the defaults that stand for them.
    pub assumed: Vec<Assumption>,
    /// What reading the marker file brought up.
    pub ingest: IngestReport,
    /// How the head was found.
    pub head: HeadReport,
    /// What cleaning changed; `None` if the locks were left as the file has them.
    pub clean: Option<CleanReport>,
}

/// What happened in a conversion, stage by stage. It travels in the field file as `report.json`.
///
/// No times of day and no durations: the same input gives the same bytes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConversionReport {
    /// Which method was used.
    pub method: String,
    /// How good the capture is, and what was changed in it.
    #[serde(flatten)]
    pub quality: QualityReport,
    /// How motion became wind.
    pub fit: FitReport,
    /// How the wind was mended by simulating the captured wig; `None` if nobody wanted that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refine: Option<RefineReport>,
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
    /// The number the file gives its first frame.
    pub first_frame: i64,
    /// Frames a second.
    pub rate_hz: f64,
    /// How long it lasts, s.
    pub duration_secs: f64,
    /// Labeled and unlabeled trajectories.
    pub n_trajectories: usize,
    /// Trajectories that nobody labeled: pieces of lost markers, or ghosts.
    pub n_unlabeled: usize,
    /// Share of the session's lock markers times frames that was seen under its own label and with a head pose.
    pub seen: f64,
}

impl QualityReport {
    /// What the file says it has and does not, in words.
    pub fn loss(&self) -> Option<String> {
        let (claimed, found) = self.ingest.cut?;
        Some(format!("the capture is cut off: {found} of {claimed} frames are there"))
    }
}

impl ConversionReport {
    /// What was asked for and is not in the field.
    pub(crate) fn find_losses(&mut self) {
        let mut losses: Vec<String> = self.quality.loss().into_iter().collect();
        let QualityReport { capture, head, .. } = &self.quality;
        let n = head.n_without_pose();
        if n > 0 {
            losses.push(format!("{n} of {} frames have no head pose and were left out", capture.n_frames));
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
