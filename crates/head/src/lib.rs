//! The head's markers give its pose: `Capture` → `HeadCapture`.
//!
//! [`locate_head`] finds in every frame the rigid transform that carries the markers' places on the head to
//! where the cameras saw them, from whichever markers are there and behave, smooths the poses into the track that
//! a field file carries, and expresses every lock in head space. [`find_still`] finds when the hair hung still, where nobody said.

mod bridge;
mod error;
mod frames;
mod labels;
mod locate;
mod mirror;
mod registration;
mod report;
mod shape;
mod smooth;
mod still;

pub use error::HeadError;
pub use frames::{FrameQuality, LabelMended, PoseGap};
pub use locate::{HeadOptions, Located, locate_head};
pub use report::{HeadReport, MarkerReport};
pub use smooth::{PoseTrackReport, SmoothOptions, TrackedPoses};
pub use still::{StillFound, find_still};
