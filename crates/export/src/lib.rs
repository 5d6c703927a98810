//! Motions and fields to files for other tools: `.npz`, `.usda`, `.vdb`.
//!
//! Every writer takes a value and a sink. Files and their names, and that they appear whole or not at all, are
//! the business of `tousle-pipeline`. The same value gives the same bytes.
//!
//! - [`write_motion_npz`], [`write_field_npz`]: arrays for NumPy; [`read_motion_npz`], [`read_field_npz`] read
//!   them back, and wind from elsewhere.
//! - [`write_motion_usda`]: hair as curves or reed-shaped ribbons for everything that reads USD.
//! - [`write_step_vdb`]: a step of a field for everything that reads OpenVDB; [`read_step_vdb`] and
//!   [`join_steps_vdb`] read wind from what writes it.
//!
//! *Invariant:* nothing here knows of captures or of the field file.

mod error;
mod motion;
mod npz;
mod usd;
mod vdb;

pub use error::ExportError;
pub use npz::{
    FieldNpzOptions, MotionNpz, NpzError, ReadField, read_field_npz, read_field_npz_with, read_motion_npz,
    read_numbers_npz, read_poses_npz, write_field_npz, write_motion_npz, write_numbered_motion_npz,
    write_poses_npz,
};
pub use usd::{CurveType, HairGeometry, UsdOptions, write_motion_usda};
pub use vdb::{VdbError, VdbOptions, VdbStep, join_steps_vdb, read_step_vdb, write_step_vdb};
