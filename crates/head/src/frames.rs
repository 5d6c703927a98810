use crate::labels::Mislabeled;
use serde::Serialize;
use tousle_core::{FrameSpan, HeadPose, Session, Track, runs};

/// How well the head was found, frame by frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FrameQuality {
    /// Root mean square distance of the used markers from their places, m, to the micrometer; `None` without a
    /// pose.
    pub residual_m: Vec<Option<f64>>,
    /// Head markers that were used.
    pub n_used: Vec<usize>,
    /// Head markers that were seen.
    pub n_visible: Vec<usize>,
}

/// Frames without a pose of their own.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PoseGap {
    /// The frames.
    pub span: FrameSpan,
    /// Head markers seen in the best of these frames.
    pub n_visible: usize,
    /// Why there is no pose.
    pub why: &'static str,
    /// How far off hair is seen, m, from the pose that is told from those around: 0 if the head stands still. `None` if that
    /// is too far or nobody knows: then locks are not seen from the head here, and only the smooth track bridges the gap.
    pub bridged_to_m: Option<f64>,
}

/// Samples that stood under another head marker's label, and were given to their own.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LabelMended {
    /// The label that carried the samples.
    pub label: String,
    /// The marker they are of, by its place on the head.
    pub marker: String,
    /// The frames.
    pub span: FrameSpan,
}

impl FrameQuality {
    pub(crate) fn of(poses: &[Option<HeadPose>], tracks: &[Track]) -> Self {
        let micrometers = |m: f64| (m * 1e6).round() / 1e6;
        Self {
            residual_m: poses.iter().map(|p| Some(micrometers(p.as_ref()?.fit_residual_m))).collect(),
            n_used: poses.iter().map(|p| p.as_ref().map_or(0, |p| p.n_used)).collect(),
            n_visible: (0..poses.len()).map(|f| n_visible(tracks, f)).collect(),
        }
    }
}

pub(crate) fn n_visible(tracks: &[Track], frame: usize) -> usize {
    tracks.iter().filter(|t| t.at(frame).is_some()).count()
}

/// The runs of frames without a pose, each with what is to blame.
pub(crate) fn pose_gaps(quality: &FrameQuality, bridged: &[Option<f64>], first_frame: i64) -> Vec<PoseGap> {
    let gaps = runs(quality.residual_m.len(), |f| quality.residual_m[f].is_none());
    let gap = |frames: &std::ops::Range<usize>| {
        let n_visible = quality.n_visible[frames.clone()].iter().copied().max().unwrap_or(0);
        let why = if n_visible < 3 {
            "fewer than 3 head markers are seen"
        } else {
            "no 3 head markers that follow the head are seen where they sit on it"
        };
        PoseGap {
            span: FrameSpan::of(first_frame, frames),
            n_visible,
            why,
            bridged_to_m: bridged[frames.start],
        }
    };
    gaps.iter().map(gap).collect()
}

/// Mislabeled samples, gathered into spans: in the order of labels, then of time.
pub(crate) fn label_spans(
    mislabeled: &[Mislabeled],
    session: &Session,
    first_frame: i64,
) -> Vec<LabelMended> {
    let mut sorted = mislabeled.to_vec();
    sorted.sort_unstable();
    let name = |k: usize| session.head_markers[k].label.clone();
    let mut spans = Vec::new();
    for of_pair in sorted.chunk_by(|a, b| (a.label, a.is) == (b.label, b.is)) {
        for run in of_pair.chunk_by(|a, b| a.frame + 1 == b.frame) {
            let frames = run[0].frame..run[run.len() - 1].frame + 1;
            let span = FrameSpan::of(first_frame, &frames);
            spans.push(LabelMended { label: name(run[0].label), marker: name(run[0].is), span });
        }
    }
    spans
}
