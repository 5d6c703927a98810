use tousle_core::GroomError;

/// Why strands cannot follow.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GuideError {
    /// The groom cannot be simulated, so it cannot be guided either.
    #[error(transparent)]
    Groom(#[from] GroomError),
    /// Nobody would lead.
    #[error("found 0 guides, expected at least 1")]
    NoGuides,
    /// The guides were chosen in another groom.
    #[error("found guides chosen among {found} strands, expected the groom's {expected}")]
    OtherGroom {
        /// Strands among which the guides were chosen.
        found: usize,
        /// Strands of the groom.
        expected: usize,
    },
    /// A motion that is not the guides' or not that of all strands.
    #[error("a motion does not fit: found {found}, expected {expected}")]
    BadMotion {
        /// What it has.
        found: String,
        /// What it should have.
        expected: String,
    },
    /// More than can be held.
    #[error(
        "found {n_frames} frames of {n_points} control points, expected at most 1e9 positions: follow with fewer \
         strands or a shorter shot"
    )]
    TooLarge {
        /// Frames of the motion.
        n_frames: usize,
        /// Control points of all strands.
        n_points: usize,
    },
}
