//! Key-frame edits of a field: an animator pulls a strand, a layer of extra force comes out.
//!
//! [`read_edits`] gives an [`EditList`]; [`apply`] puts it on a field as layers, which are stored beside the
//! voxels and never baked in; [`measure`] tells what came of it once the groom was simulated again. [`mute`],
//! [`rename`] and [`remove`] change the stack.
//!
//! *Invariant:* this crate simulates nothing: motions come in from outside.

mod air;
mod apply;
mod chain;
mod e4;
mod effect;
mod error;
mod list;
mod options;
mod path;
mod raw;
mod read;
mod report;
mod resolve;
mod stack;

pub use apply::{Edited, Layers, apply, make_layers};
pub use effect::{Change, EditEffect, EditEffects, FAR_M, Moved, Residual, measure, residuals};
pub use error::EditError;
pub use list::{
    Action, ControlPoint, DEFAULT_EASE, DEFAULT_REACH_M, Drag, EDITS_VERSION, Edit, EditList, KeyTime, Target,
};
pub use options::{EditMethod, EditOptions, PaperSpan};
pub use read::{read_edits, write_edits};
pub use report::{EditOutcome, EditReport, Unreachable};
pub use stack::{mute, remove, rename};
