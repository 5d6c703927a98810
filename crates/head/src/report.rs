use crate::frames::{FrameQuality, LabelMended, PoseGap};
use crate::registration::Registration;
use crate::shape::HeadShape;
use crate::smooth::{PoseTrackReport, TrackedPoses};
use serde::Serialize;
use tousle_core::{FrameSpan, HeadCapture, HeadPose, Session, Track, runs};

/// How the head was found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HeadReport {
    /// Each head marker, in the session's order.
    pub markers: Vec<MarkerReport>,
    /// Where there is no pose, and why.
    pub without_pose: Vec<PoseGap>,
    /// Samples that stood under another head marker's label.
    pub labels_mended: Vec<LabelMended>,
    /// Each frame's own quality.
    pub frames: FrameQuality,
    /// Root mean square of the per-frame residuals, m; `None` if no frame has a pose.
    pub fit_residual_m: Option<f64>,
    /// White noise of a marker coordinate in the still interval, m; `None` without a still interval.
    pub noise_m: Option<f64>,
    /// How the poses became a smooth track.
    pub pose_track: PoseTrackReport,
}

impl HeadReport {
    /// How many frames have no pose, not even one that can be told from those around them.
    pub fn n_without_pose(&self) -> usize {
        let lost = self.without_pose.iter().filter(|gap| gap.bridged_to_m.is_none());
        lost.map(|gap| gap.span.n_frames()).sum::<u64>() as usize
    }
}

/// How one head marker behaved.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MarkerReport {
    /// Its label.
    pub label: String,
    /// Share of frames in which it was seen.
    pub seen: f64,
    /// Share of the frames in which it was seen and agreed with the pose.
    pub agreed: f64,
    /// Whether it was used at all.
    pub trusted: bool,
    /// How far its place in the still frames is from the session's, m.
    pub correction_m: f64,
    /// Frames in which no camera saw it.
    pub missing: Vec<FrameSpan>,
    /// Frames with a pose in which it was seen and left out.
    pub left_out: Vec<FrameSpan>,
}

impl MarkerReport {
    /// Whether it was there and is not used, as it moves by itself: one that was never seen did nothing wrong.
    pub fn is_left_out(&self) -> bool {
        !self.trusted && !self.is_never_seen()
    }

    /// Whether no frame shows it.
    pub fn is_never_seen(&self) -> bool {
        self.seen <= 0.0
    }
}

/// How each head marker behaved, in the session's order.
pub(crate) fn marker_reports(
    registrations: &[Option<Registration>],
    session: &Session,
    tracks: &[Track],
    shape: &HeadShape,
    agreement: &[f64],
    trust: &[f64],
    head: &HeadCapture,
) -> Vec<MarkerReport> {
    let n_frames = head.n_frames();
    let spans = |has: &dyn Fn(usize) -> bool| -> Vec<FrameSpan> {
        runs(n_frames, has).iter().map(|run| FrameSpan::of(head.first_frame, run)).collect()
    };
    let is_left_out = |k: usize, f: usize| {
        tracks[k].at(f).is_some() && registrations[f].as_ref().is_some_and(|r| !r.used.contains(&k))
    };
    let marker = |k: usize| MarkerReport {
        label: session.head_markers[k].label.clone(),
        seen: tracks[k].n_valid() as f64 / n_frames.max(1) as f64,
        agreed: agreement[k],
        trusted: trust[k] > 0.0,
        correction_m: shape.correction_m[k],
        missing: spans(&|f| tracks[k].at(f).is_none()),
        left_out: spans(&|f| is_left_out(k, f)),
    };
    (0..tracks.len()).map(marker).collect()
}

/// What was found, together, with what follows from it.
pub(crate) fn report(
    own_poses: &[Option<HeadPose>],
    markers: Vec<MarkerReport>,
    labels_mended: Vec<LabelMended>,
    without_pose: Vec<PoseGap>,
    frames: FrameQuality,
    shape: &HeadShape,
    tracked: &TrackedPoses,
) -> HeadReport {
    let residuals: Vec<f64> =
        own_poses.iter().flatten().map(|p| p.fit_residual_m * p.fit_residual_m).collect();
    HeadReport {
        markers,
        without_pose,
        labels_mended,
        frames,
        fit_residual_m: (!residuals.is_empty())
            .then(|| (residuals.iter().sum::<f64>() / residuals.len() as f64).sqrt()),
        noise_m: shape.noise_m,
        pose_track: tracked.report.clone(),
    }
}
