//! Several captures of one wig into one richer field.
//!
//! A capture measures the wind where its locks happen to be. Repeated in the same wind they are elsewhere, and the
//! fields complete one another. A [`Plan`] says what the merged field will be, or what keeps the fields from being
//! one; [`combine`] puts together what they say of one time, voxel by voxel, by what is surest there
//! (`docs/design.md`, "Merging"); [`join_samples`] keeps the measured vectors, from which the grid can be made again.
//!
//! *Invariant:* values in, values out, one step at a time: this crate neither reads files nor holds whole fields.

mod agree;
mod combine;
mod error;
mod input;
mod layers;
mod plan;
mod report;
mod resample;
mod samples;
#[cfg(test)]
mod testing;

pub use combine::combine;
pub use error::MergeError;
pub use input::{Input, MergeOptions, Span};
pub use plan::{Between, Plan};
pub use report::{InputReport, MergeReport, Tally};
pub use samples::join_samples;
