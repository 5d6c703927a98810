//! The voxel field around the head: grid, steps, sampling, layers.
//!
//! A [`FieldSequence`] is wind over time on a cube around the head, in head axes. [`GridSpec`] says where the
//! voxels are, [`Field`] holds one time step, [`FieldLayer`] an edit that is added when the field is sampled
//! and never baked in. [`FieldSequence::at`] gives a [`FieldSlice`] of one time, which is sampled anywhere.
//!
//! *Invariant:* this crate knows neither markers nor hair.

mod grid;
mod layer;
mod sampler;
mod scene;
mod sequence;
mod window;

pub use grid::{GridError, GridSpec, MAX_VOXELS, VoxelIndex};
pub use layer::{Ease, FieldLayer, Handle, LayerKey, LayerOrigin, Reshape};
pub use sampler::{Moment, Reading, Rows, SAMPLED_AT_ONCE, Sampler};
pub use scene::Scene;
pub use sequence::{Field, FieldError, FieldSequence, FieldSlice, Stencil, VoxelFlag, all_finite};
pub use window::Window;
