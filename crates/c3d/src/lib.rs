//! C3D bytes to and from C3D records, nothing more.
//!
//! A C3D file is a header of one block of 512 bytes, a section of named parameters, and then frames: for each
//! frame the points (three coordinates and a word of camera bits and residual), then the analog samples.
//! Header and parameters repeat each other and, in the wild, contradict each other. [`Reader`] takes the claim
//! that fits the size of the file and reports every contradiction as a [`Warning`].
//!
//! Positions are in the file's own unit and axes; meters, subjects and the meaning of a label are for the caller.
//!
//! ```no_run
//! use tousle_c3d::Reader;
//!
//! let mut reader = Reader::new(std::fs::File::open("trial.c3d")?)?;
//! let n_frames = reader.info().n_frames;
//! let trajectories = reader.read_trajectories(&[0], 0..n_frames)?;
//! println!("{:?}: {:?}", reader.info().label(0), trajectories[0]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod encoding;
mod error;
mod header;
mod info;
mod io;
mod label;
mod parameter;
mod point;
mod trial;
mod warning;

pub use encoding::{Processor, Storage};
pub use error::{ReadError, WriteError};
pub use header::Header;
pub use info::{Analog, Event, Info, Rotations, Subject};
pub use io::reader::Reader;
pub use io::writer::Writer;
pub use label::PointKind;
pub use parameter::{Group, Parameter, Parameters, Value};
pub use point::Point;
pub use trial::Trial;
pub use warning::{Quantity, Warning};

/// The unit in which header and parameters count places in the file.
pub(crate) const BLOCK: u64 = 512;
