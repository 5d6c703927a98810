use serde::{Deserialize, Serialize};
use std::ops::Range;

/// First and last frame of something, as the file numbers them, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct FrameSpan {
    /// First frame.
    pub first_frame: i64,
    /// Last frame.
    pub last_frame: i64,
}

impl FrameSpan {
    /// The span of frames counted from 0 (the end excluded) in a capture that begins with `first_frame`.
    pub fn of(first_frame: i64, frames: &Range<usize>) -> Self {
        let number = |frame: usize| first_frame.saturating_add(frame as i64);
        Self { first_frame: number(frames.start), last_frame: number(frames.end.saturating_sub(1)) }
    }

    /// How many frames it holds.
    pub fn n_frames(&self) -> u64 {
        if self.last_frame < self.first_frame { 0 } else { self.last_frame.abs_diff(self.first_frame) + 1 }
    }
}

/// Maximal runs of frames with a property, in order.
pub fn runs(n_frames: usize, has: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for f in (0..n_frames).filter(|&f| has(f)) {
        match runs.last_mut() {
            Some(run) if run.end == f => run.end += 1,
            _ => runs.push(f..f + 1),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_count_both_ends() {
        let span = FrameSpan::of(101, &(4..6));
        assert_eq!((span.first_frame, span.last_frame, span.n_frames()), (105, 106, 2));
    }

    #[test]
    fn runs_are_maximal() {
        let seen = [true, true, false, true, false];
        assert_eq!(runs(5, |f| seen[f]), [0..2, 3..4]);
        assert!(runs(5, |_| false).is_empty());
    }
}
