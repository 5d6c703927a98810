//! Runs the stages in order, gathers their reports, and writes whole files or none.
//!
//! [`prepare`] takes the bytes of a capture and of a session to clean locks in head space and a quality report;
//! [`measure`] tells their wind on a grid; [`convert`] is both and ends with an [`Eff`](tousle_eff::Eff); [`merge`] makes one
//! field of several. Paths and clocks stop here: [`read_file`], [`write_whole`] and [`Outputs`] are the only doors to
//! the disk.

mod attachments;
mod convert;
mod files;
mod held;
mod measure;
mod merge;
mod outputs;
mod prepare;
mod report;
mod still;
mod watch;

pub use attachments::attachments;
pub use convert::{ConvertError, ConvertOptions, Converted, GENERATOR, Input, convert};
pub use files::{FileError, read_file, write_whole};
pub use measure::{MeasureOptions, Measured, measure};
pub use merge::{MergeFilesError, MergeSource, merge};
pub use outputs::Outputs;
pub use prepare::{PrepareOptions, Prepared, prepare};
pub use report::{CaptureSummary, ConversionReport, QualityReport};
pub use watch::{Silent, Watch};
