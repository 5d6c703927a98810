//! Motions as USD text (`.usda`): hair as thin curves, as reed-shaped ribbons, or both.
//!
//! An own writer: text is what every USD reader takes, the crates that write USD's binary form write what
//! Pixar's library refuses, and text can be streamed. Numbers carry the shortest digits that read back as the
//! same 32-bit number, so the `.usda` and the `.npz` of a motion hold the same positions.

mod body;
mod curves;
mod hair;
mod options;
mod reeds;
mod stage;
mod text;
mod transform;

pub use options::{CurveType, HairGeometry, UsdOptions};
pub use stage::write_motion_usda;
