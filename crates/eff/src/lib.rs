//! The field file, `.eff.mcap`: written, read, validated.
//!
//! An [`Eff`] is wind over time around a head with all that a simulator needs besides. [`write()`] puts it into
//! an MCAP file, [`read()`] gets it back, [`validate()`] says everything that is wrong with a file, [`inspect()`]
//! what is in it, and [`recover()`] saves what is whole in a damaged one. [`Writer`] writes and [`Reader`] reads fields of any length, a step at a time. `docs/eff.md` specifies the format,
//! so that others can read and write it without this crate.
//!
//! *Invariant:* streams in, streams out; paths, clocks and threads stop outside, and the same field gives the
//! same bytes.
//!
//! ```
//! # use tousle_eff::{Eff, ReadOptions, WriteOptions, read, write};
//! # use tousle_core::{Body, NoProgress, Pose, PoseTrack, Quantity, Vec3};
//! # use tousle_field::{Field, FieldSequence, GridSpec, Scene};
//! # let grid = GridSpec::cube(0.6, 0.2)?;
//! # let field = FieldSequence {
//! #     grid, quantity: Quantity::AirVelocity, start_secs: 0.0, rate_hz: 30.0,
//! #     steps: vec![Field::still(&grid)], layers: vec![],
//! # };
//! # let scene = Scene {
//! #     poses: PoseTrack::still(Pose::identity()), rest_pose: Pose::identity(),
//! #     gravity_world: -9.81 * Vec3::z(), air_density: 1.2, body: Body::none(),
//! # };
//! let eff = Eff {
//!     name: "still air".into(),
//!     method: "by hand".into(),
//!     generator: "example".into(),
//!     field,
//!     scene,
//!     samples: None,
//!     attachments: vec![],
//! };
//! let mut bytes = Vec::new();
//! write(&eff, &mut bytes, &WriteOptions::default(), &NoProgress)?;
//! assert_eq!(read(&bytes[..], &ReadOptions::default())?, eff);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod array;
mod check;
mod decode;
mod eff;
mod error;
mod finding;
mod format;
mod inspect;
mod json_schema;
mod layers;
mod migrate;
mod preview;
mod read;
mod reader;
mod record;
mod recover;
mod scan;
#[cfg(test)]
mod schemas;
mod validate;
mod wire;
mod writer;

/// The manifest of a field file, as it is in the file.
pub mod manifest {
    pub use crate::wire::manifest::{
        EncodingInfo, EncodingName, FieldInfo, Grid, Manifest, PoseInfo, QuantityName, SamplesInfo,
    };
    pub use crate::wire::scene::{Attachment, Body, Collider, RestPose, Scene, Shape};
}

pub use array::{Encoding, ErrorBound};
pub use eff::{Attachment, Eff};
pub use error::EffError;
pub use finding::{Code, Finding, Severity};
pub use format::{MAX_RATE_HZ, MAX_SECS, PROFILE, VERSION};
pub use inspect::{ChannelSize, Coverage, Inspection, inspect};
pub use layers::replace_layers;
pub use manifest::Manifest;
pub use migrate::{Migration, migrate};
pub use read::{ReadOptions, read};
pub use reader::{Part, Reader};
pub use recover::{Loss, Recovery, recover};
pub use tousle_core as core;
pub use tousle_field as field;
pub use validate::{Validation, validate};
pub use writer::{Head, WriteOptions, WriteReport, Writer, write};
