use serde::Serialize;
use tousle_core::FrameSpan;

/// Everything that cleaning found and changed. Frames are numbered as the file does, both ends included.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct CleanReport {
    /// Samples farther from their lock's root than hair reaches, left out; what they leave is a gap.
    pub far: Vec<FarRefused>,
    /// Outliers cut out of a track; what they leave is a gap.
    pub spikes: Vec<SpikeCut>,
    /// Markers that had exchanged labels.
    pub swaps: Vec<SwapMended>,
    /// Nameless trajectories given to a marker during its own gap.
    pub given_back: Vec<PieceGivenBack>,
    /// Nameless trajectories that fit no marker, and were left out.
    pub ghosts: Vec<GhostRefused>,
    /// Gaps that were filled, each in as many parts as its seen neighbors changed.
    pub gaps: Vec<GapFilled>,
    /// Gaps that were left as they are.
    pub unfilled: Vec<Unfilled>,
    /// Every marker of every lock, for timelines.
    pub markers: Vec<MarkerTimeline>,
}

impl CleanReport {
    /// How many gaps were filled; [`Self::gaps`] lists their parts, as neighbors come and go.
    pub fn n_gaps_filled(&self) -> usize {
        self.markers.iter().map(|m| m.filled.len()).sum()
    }

    /// What someone should look at, in words: labels that were on something else than hair, lock after lock.
    pub fn warnings(&self) -> Vec<String> {
        self.far.chunk_by(|a, b| a.strand == b.strand).map(far_in_words).collect()
    }
}

/// What was too far from the root of one lock, in words.
fn far_in_words(of_lock: &[FarRefused]) -> String {
    let of_marker = |far: &[FarRefused]| {
        let n_frames: u64 = far.iter().map(|far| far.span.n_frames()).sum();
        let farthest_m = far.iter().map(|far| far.distance_m).fold(0.0, f64::max);
        format!(
            "{} up to {farthest_m:.2} m, expected at most {:.2} m (frames {} to {}, {n_frames} in all)",
            far[0].marker,
            far[0].reach_m,
            far[0].span.first_frame,
            far[far.len() - 1].span.last_frame,
        )
    };
    let markers: Vec<String> = of_lock.chunk_by(|a, b| a.marker == b.marker).map(of_marker).collect();
    format!(
        "lock {}: found markers farther from its root than hair lets them be, and left them out: {}",
        of_lock[0].strand,
        markers.join("; ")
    )
}

/// Samples that no marker in its place on its lock can be.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FarRefused {
    /// The lock's name.
    pub strand: String,
    /// The marker's label.
    pub marker: String,
    /// The frames.
    pub span: FrameSpan,
    /// How far from the lock's root the farthest of them was, m.
    pub distance_m: f64,
    /// How far the hair lets the marker be, measuring errors included, m.
    pub reach_m: f64,
}

/// An outlier that was cut out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpikeCut {
    /// The marker's label.
    pub marker: String,
    /// The frames.
    pub span: FrameSpan,
    /// How far the worst sample was from the line between its neighbors, m.
    pub height_m: f64,
    /// Probability that it was no motion, 0 to 1.
    pub confidence: f64,
}

/// Two markers that had exchanged labels in a span.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SwapMended {
    /// The two labels.
    pub markers: [String; 2],
    /// The frames in which the labels were exchanged in the file.
    pub span: FrameSpan,
    /// How far the labels jumped where the exchange began (or ended, if it began with the capture), m.
    pub jump_m: f64,
    /// Probability that it was an exchange, by the continuity of both motions, 0 to 1.
    pub confidence: f64,
}

/// A nameless trajectory that belongs to a marker.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PieceGivenBack {
    /// What the file calls the piece.
    pub piece: String,
    /// The marker that got it.
    pub marker: String,
    /// The frames.
    pub span: FrameSpan,
    /// Root mean square distance from where the lock says the marker is, m.
    pub distance_m: f64,
    /// How far off the lock's word usually is there, m.
    pub expected_m: f64,
    /// Probability that the piece is that marker, against all other markers and against a ghost, 0 to 1.
    pub confidence: f64,
}

/// A nameless trajectory that belongs to nothing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GhostRefused {
    /// What the file calls it.
    pub piece: String,
    /// The frames.
    pub span: FrameSpan,
    /// The marker it came nearest to by likelihood, if one was in a gap all the while.
    pub nearest_marker: Option<String>,
    /// Probability that it is a ghost or cannot be told whose it is, 0 to 1.
    pub confidence: f64,
}

/// How a gap was filled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum FillMethod {
    /// A straight line in head space between the ends.
    Line,
    /// A cubic in head space that keeps the velocity at both ends.
    Cubic,
    /// The nearest seen neighbors on the lock, with the offset at both ends carried over the gap.
    Neighbors,
    /// As [`FillMethod::Neighbors`], the offset keeping its rate of change at both ends.
    NeighborsCubic,
    /// Two neighbors on either side, with the offset carried over the gap.
    Lock,
    /// As [`FillMethod::Lock`], the offset keeping its rate of change at both ends.
    LockCubic,
}

/// A gap that was filled, or the part of it in which the same neighbors were seen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GapFilled {
    /// The lock's name.
    pub strand: String,
    /// The marker's label.
    pub marker: String,
    /// The frames.
    pub span: FrameSpan,
    /// How, the best of all in trials on this marker's own seen frames.
    pub method: FillMethod,
    /// Root mean square error of the same fill at other times, where the marker was seen, m; raised where the
    /// lock took a shape that those times did not show; the worst of all other gaps' where there are no trials.
    pub expected_error_m: f64,
    /// At how many other times that was tried; 0 if the error is borrowed.
    pub trials: usize,
    /// Frames in which the lock's length forbade what the method said, and had its way.
    pub shortened_frames: usize,
}

/// A gap that could not be filled.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Unfilled {
    /// The marker's label.
    pub marker: String,
    /// The frames.
    pub span: FrameSpan,
    /// Why.
    pub why: &'static str,
}

/// One marker over time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MarkerTimeline {
    /// The lock's name.
    pub strand: String,
    /// The marker's label.
    pub marker: String,
    /// White noise of one coordinate, m; from the still frames where there are any.
    pub noise_m: Option<f64>,
    /// Root mean square distance between the marker and the prediction from its neighbors, m.
    pub shape_residual_m: Option<f64>,
    /// Frames in which the file's own label was seen and kept.
    pub seen: Vec<FrameSpan>,
    /// Frames taken from another label.
    pub mended: Vec<FrameSpan>,
    /// Frames taken from a nameless piece.
    pub given_back: Vec<FrameSpan>,
    /// Frames that no camera saw.
    pub filled: Vec<FrameSpan>,
}
