//! The vocabulary every other crate speaks: units, spaces, captures, grooms, motions.
//!
//! SI throughout (m, s, kg, rad); millimeters end where bytes are read. Names of quantities that a type does
//! not settle carry their unit (`edge_m`, `dt_secs`). Three spaces occur, and every position says its own:
//!
//! - `world`: as the capture room had it; its up axis is part of the [`Capture`].
//! - `head`: origin at the head's center, x forward (nose), y to the subject's left, z up along the head.
//! - `grid`: voxel indices, in `tousle-field`.
//!
//! A transform is named so that names meet: `p_head = head_from_world * p_world`.

mod axes;
mod body;
mod capture;
mod groom;
mod head;
mod median;
mod motion;
mod progress;
mod sample;
mod samples;
mod session;
mod solid;
mod span;
mod track;
mod unit;

pub use axes::{Axis, HeadAxes};
pub use body::{Attachment, Body, Collider, Shape};
pub use capture::{Capture, Trajectory};
pub use groom::{Along, Assumption, Groom, GroomError, Strand};
pub use head::{HeadCapture, HeadPose, StrandTracks, UnlabeledTrack};
pub use median::{median, median_high};
pub use motion::{HeadMotion, PoseTrack, StrandMotion};
pub use progress::{NoProgress, Progress};
pub use sample::{Sample, SampleKind};
pub use samples::{Quantity, WindSample, WindSamples};
pub use session::{Fan, HeadMarker, Session, StrandMarker, StrandSpec};
pub use solid::{DistanceGrid, Solid};
pub use span::{FrameSpan, runs};
pub use track::Track;
pub use unit::{LengthUnit, UpAxis};

/// A position or a vector in one of the three spaces; the field's name or the documentation says which.
pub type Vec3 = nalgebra::Vector3<f64>;

/// A rigid transform, for instance `world_from_head`.
pub type Pose = nalgebra::Isometry3<f64>;

/// Standard gravity, m/s².
pub const STANDARD_GRAVITY: f64 = 9.81;

/// The latest time that a field can speak of, s: eleven days. Nanoseconds of it are exact in a double.
pub const MAX_SECS: f64 = 1e6;
