//! Drags that are solved for: the smallest and smoothest extra wind with which simulated strands meet their keys.
//!
//! [`apply`] turns the edits of a list into layers, by E4 or by [`solve`]; [`solve`] does a single drag, and can begin
//! from its last answer, for an editor that follows a hand. A [`Stage`] is what both need: a simulator that stays
//! prepared, and what it was made of. The maths is in `docs/direct.md`.
//!
//! *Invariant:* a solved layer is like any other: nothing but the field's own rules of sampling is needed to feel it.

mod apply;
mod basis;
mod error;
mod guess;
mod normal;
mod options;
mod report;
mod solve;
mod target;

pub use apply::{Directed, apply};
pub use error::DirectError;
pub use options::{DirectOptions, EditMethod};
pub use report::{DirectReport, KeyOutcome, Made, SolvedOutcome};
pub use solve::{Drag, Ground, Solved, solve};

use tousle_core::Groom;
use tousle_field::{FieldSequence, Scene};
use tousle_sim::Simulator;

/// A simulator that stays prepared, and what it was made of.
#[derive(Clone, Copy, Debug)]
pub struct Stage<'a> {
    /// Runs strands under the layers that are tried.
    pub simulator: &'a Simulator<'a>,
    /// The field it was made of.
    pub field: &'a FieldSequence,
    /// The scene.
    pub scene: &'a Scene,
    /// The groom.
    pub groom: &'a Groom,
}
