/// Why no head can be found.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum HeadError {
    /// So many of the head's markers are not in the capture that fewer than three are.
    #[error("found {found} of the head's markers in the capture, expected at least 3: it does not have {}", labels.join(", "))]
    MissingMarkers {
        /// How many there are.
        found: usize,
        /// Labels of those that are not.
        labels: Vec<String>,
    },
    /// Three markers settle a pose.
    #[error("found {found} head markers in the session, expected at least 3")]
    TooFewMarkers {
        /// How many there are.
        found: usize,
    },
    /// The head in the capture is of another size than the session's.
    #[error(
        "found head markers {scale:.3} times as far apart as in the session, expected the same size: is the capture in another unit \
         than its file names (`unit` overrides that), or are the session's millimeters others?"
    )]
    OtherScale {
        /// The size in the capture over that in the session.
        scale: f64,
    },
    /// The head in the capture is the mirror image of the session's.
    #[error(
        "found head markers {} where a mirror has them: {mirrored_mm:.1} mm from the session's places mirrored, {as_labeled_mm:.0} mm \
         from the places themselves, expected the head as it is: are left and right exchanged, or is the capture or the session \
         a mirrored (left-handed) export?",
        labels.join(", ")
    )]
    Mirrored {
        /// Labels of the markers that fit in the mirror.
        labels: Vec<String>,
        /// Root mean square distance of these from the session's places in the mirror, mm.
        mirrored_mm: f64,
        /// The same from the places themselves, mm.
        as_labeled_mm: f64,
    },
    /// No frame shows three markers that agree.
    #[error(
        "found none of {n_frames} frames that shows 3 head markers within {tolerance_mm} mm of their places on the head, expected one at least"
    )]
    NoPose {
        /// The tolerance, mm.
        tolerance_mm: f64,
        /// Frames in the capture.
        n_frames: usize,
    },
}
