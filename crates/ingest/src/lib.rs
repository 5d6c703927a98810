//! Any marker bytes to one [`tousle_core::Capture`]; session files to a [`tousle_core::Session`].
//!
//! - [`guess_format`] tells the format from the bytes, never from a name.
//! - [`read_capture`] gives positions in meters. The unit comes from the file; where the file names none it has
//!   to be given, and is never guessed.
//! - [`summarize`] says what is in a file, in the file's own unit.
//! - [`read_session`] reads what the people in the room knew, JSON or TOML; every default is listed.
//! - [`check_against`] holds the two together.

mod capture;
mod check;
mod error;
mod format;
mod label;
mod options;
mod recording;
mod session;
mod summary;
mod time;

pub use capture::{IngestReport, Ingested, read_capture};
pub use check::{CheckError, MissingMarker, check_against};
pub use error::IngestError;
pub use format::{CaptureFormat, guess_format};
pub use options::IngestOptions;
pub use session::{SessionError, read_session};
pub use summary::{CaptureSummary, OtherContent, TrajectorySummary, summarize};
