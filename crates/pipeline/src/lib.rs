//! Runs the stages in order, gathers their reports, and writes whole files or none.
//!
//! [`convert`] takes the bytes of a capture and of a session to an [`Eff`](tousle_eff::Eff). Paths and clocks
//! stop here: [`read_file`] and [`write_whole`] are the only doors to the disk.

mod convert;
mod files;
mod report;
mod watch;

pub use convert::{ConvertError, ConvertOptions, Converted, GENERATOR, Input, convert};
pub use files::{FileError, read_file, write_whole};
pub use report::{CaptureSummary, ConversionReport};
pub use watch::{Silent, Watch};
