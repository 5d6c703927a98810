//! Key-frame edits of a field: an animator pulls a strand, a layer of extra force comes out.
//!
//! [`read_edits`] gives an [`EditList`]; [`apply`] puts it on a field as layers, which are stored beside the
//! voxels and never baked in; [`measure`] tells what came of it once the groom was simulated again. [`mute`],
//! [`retime`], [`mirror`] and others change the stack; [`wind_layer`] makes gusts and calms.
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
#[cfg(test)]
mod testing;
mod wind;

pub use apply::{Edited, Layers, METHOD, apply, free_id, make_layers, make_layers_on, out_of_reach};
pub use chain::{Dragged, drag};
pub use e4::{Way, handles};
pub use effect::{
    Change, EditEffect, EditEffects, FAR_M, KeyEffect, Moved, Residual, StrandEffect, Under, measure,
    peak_acceleration, peak_jerk, residuals,
};
pub use error::EditError;
pub use list::{
    Action, ControlPoint, DEFAULT_EASE, DEFAULT_REACH_M, Drag, EDITS_VERSION, Edit, EditList, Key, KeyTime,
    Target,
};
pub use options::{EditOptions, PaperSpan};
pub use path::StrandPath;
pub use read::{read_edits, write_edits};
pub use report::{EditOutcome, EditReport, Unreachable};
pub use resolve::{FoundKey, find_keys};
pub use stack::{StackChange, change_stack, mirror, mute, remove, rename, retime};
pub use wind::{WindChange, WindEdit, wind_layer};
