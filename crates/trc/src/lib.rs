//! TRC bytes to TRC records, nothing more.
//!
//! A TRC is a table of marker positions below five lines of header:
//!
//! ```text
//! PathFileType  4  (X/Y/Z)  trial.trc
//! DataRate  CameraRate  NumFrames  NumMarkers  Units  OrigDataRate  OrigDataStartFrame  OrigNumFrames
//! 100.00  100.00  2  2  mm  100.00  1  2
//! Frame#  Time  LFHD            NOSE
//!               X1    Y1    Z1    X2    Y2    Z2
//!
//! 1       0.00  165.1 331.8 1508.1 195.4 359.3 1447.5
//! ```
//!
//! Cells are separated by tabs. Files in the wild are not that tidy: counts in the header are wrong, labels are
//! one cell apart, lines are short or end in CR CR LF, cells are separated by commas or blanks. What can be read
//! in one way only is read, with a warning where header and body differ; the rest is refused with its line.

mod error;
mod header;
mod line;
mod read;

pub use error::TrcError;
pub use header::Header;
pub use read::{Marker, Trc, read};

/// Whether bytes look like a TRC: one of the first two lines begins with the word that all of them begin with.
pub fn detect(bytes: &[u8]) -> bool {
    let bytes = &*tousle_cells::plain(bytes);
    let starts = |line: line::Line| {
        let text = line.bytes.trim_ascii().to_ascii_lowercase();
        text.starts_with(b"pathfiletype") || text.starts_with(b"datarate")
    };
    line::Lines::new(bytes).take(2).any(starts)
}
