use crate::{Pose, Track};

/// A capture seen from the head: its pose in every frame and the locks' markers in head space.
#[derive(Clone, Debug, PartialEq)]
pub struct HeadCapture {
    /// Frames a second.
    pub rate_hz: f64,
    /// The number the file gives its first frame.
    pub first_frame: i64,
    /// One pose a frame, of the smooth track in which the locks are seen; `None` where too few head markers were seen and the
    /// poses around do not tell it.
    pub poses: Vec<Option<HeadPose>>,
    /// The locks, in the session's order.
    pub strands: Vec<StrandTracks>,
    /// Trajectories that nobody labeled, in the capture's order: pieces of a lost marker, or ghosts.
    pub unlabeled: Vec<UnlabeledTrack>,
}

/// A trajectory without a name, head space, m.
#[derive(Clone, Debug, PartialEq)]
pub struct UnlabeledTrack {
    /// What the capture system calls it: `*12`.
    pub label: String,
    /// Positions, as long as the capture.
    pub track: Track,
}

/// Where the head was in one frame, and how far that can be trusted.
#[derive(Clone, Debug, PartialEq)]
pub struct HeadPose {
    /// Head space to world space.
    pub world_from_head: Pose,
    /// How far off hair is seen from it, m, if it is told from the poses around; 0 if the head was seen.
    pub expected_error_m: f64,
    /// Root mean square distance between the markers that were used and their places on the head, m.
    pub fit_residual_m: f64,
    /// How many head markers were seen and used.
    pub n_used: usize,
    /// How many head markers were seen.
    pub n_visible: usize,
}

impl HeadPose {
    /// A pose that so many markers agree on without any error, as in a made-up capture.
    pub fn exact(world_from_head: Pose, n_markers: usize) -> Self {
        Self {
            world_from_head,
            expected_error_m: 0.0,
            fit_residual_m: 0.0,
            n_used: n_markers,
            n_visible: n_markers,
        }
    }
}

/// The markers of one lock, head space, m.
#[derive(Clone, Debug, PartialEq)]
pub struct StrandTracks {
    /// Index of the lock in the session.
    pub strand_idx: usize,
    /// Root to tip, one track a marker of the session, all as long as the capture.
    pub markers: Vec<Track>,
}

impl HeadCapture {
    /// Frames in every track.
    pub fn n_frames(&self) -> usize {
        self.poses.len()
    }

    /// How long the capture lasts, s.
    pub fn duration_secs(&self) -> f64 {
        self.n_frames() as f64 / self.rate_hz
    }
}
