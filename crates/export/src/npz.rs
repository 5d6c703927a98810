//! NumPy's `.npz`: a zip archive of `.npy` arrays.
//!
//! An own reader and writer over the `zip` crate. `ndarray-npy` brings a second array library and reads one
//! type at a time, `npyz` leaves the bounds of what is allocated to its caller and writes the header it likes;
//! what is needed here is small: a header of one line, numbers of any type to `f32`, places in errors, sizes
//! held against the bytes that are there, and archives that are a function of the arrays alone.

mod dtype;
mod error;
mod field;
mod header;
mod motion;
mod numbers;
mod poses;
mod read_field;
mod reader;
mod writer;

pub(crate) use dtype::half;
pub use error::NpzError;
pub use field::write_field_npz;
pub use motion::{MotionNpz, read_motion_npz, write_motion_npz, write_numbered_motion_npz};
pub use numbers::read_numbers_npz;
pub use poses::{read_poses_npz, write_poses_npz};
pub(crate) use read_field::mean_of_faces;
pub use read_field::{FieldNpzOptions, ReadField, read_field_npz, read_field_npz_with};
