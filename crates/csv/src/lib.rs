//! Motion-capture CSV bytes to their own records, nothing more.
//!
//! [`vicon::read`] takes what Vicon Nexus and its ancestor Workstation export: one or more sections
//! (`Devices`, `Model Outputs`, `Trajectories` …), each with its own rate and table.
//!
//! [`motive::read`] takes what OptiTrack Motive exports.
//!
//! Cells are separated by commas, semicolons or tabs; numbers are written with a decimal point or, where the
//! separator leaves no doubt, with a decimal comma. What could be read in two ways is refused, with its line
//! and column. Numbers stay in the file's own unit, whatever that is.

mod error;
pub mod motive;
mod points;
mod rows;
pub mod vicon;

pub use error::CsvError;
pub use points::{Point, PointTable};
