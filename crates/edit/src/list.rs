//! Edits as values: what an animator asks for, before it is turned into layers.

use crate::{StackChange, WindEdit};
use serde::{Deserialize, Serialize};
use tousle_core::Vec3;
use tousle_field::Ease;

/// The edits of one file, applied together to one unedited motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EditList {
    /// Version of the layout; 1 is the only one so far, and what a file without it has.
    #[serde(default = "first_version")]
    pub version: u32,
    /// Frames a second of keys that are given as frames.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate_hz: Option<f64>,
    /// Changes of the edits that are on the field already, made first.
    #[serde(default, rename = "change", skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<StackChange>,
    /// Changes of the wind, stacked below the drags, which are made with them in place.
    #[serde(default, rename = "wind", skip_serializing_if = "Vec::is_empty")]
    pub winds: Vec<WindEdit>,
    /// The drags, in the order in which their layers are stacked.
    #[serde(default, rename = "edit")]
    pub edits: Vec<Edit>,
}

/// One edit: what is changed, and when.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "crate::raw::RawEdit", into = "crate::raw::RawEdit")]
pub struct Edit {
    /// A name for people.
    pub name: String,
    /// The first key frame: before it nothing changes.
    pub first: KeyTime,
    /// The second and last key frame: after it the field is as it was.
    pub second: KeyTime,
    /// How the change comes and goes between the two.
    pub ease: Ease,
    /// A muted edit becomes a muted layer: kept, and doing nothing.
    pub muted: bool,
    /// What is changed.
    pub action: Action,
}

/// What an edit changes.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Action {
    /// A strand is dragged to where it should be at the second key.
    Drag(Drag),
}

/// A strand's control point and where it should be.
#[derive(Clone, Debug, PartialEq)]
pub struct Drag {
    /// The strand's name in the groom.
    pub strand: String,
    /// Which of its control points is dragged.
    pub control_point: ControlPoint,
    /// Where it should be at the second key.
    pub target: Target,
    /// Distance from the strand's way at which the extra force has fallen to 0, m.
    pub reach_m: f64,
    /// What else should be where: other points, other strands, other times after the first key.
    pub also: Vec<Key>,
}

/// Where a control point should be at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// The strand's name in the groom.
    pub strand: String,
    /// Which of its control points.
    pub control_point: ControlPoint,
    /// When.
    pub time: KeyTime,
    /// Where.
    pub target: Target,
}

/// A control point of a strand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControlPoint {
    /// The last one.
    Tip,
    /// Counted from the root, which is 0 and cannot be dragged.
    Index(u32),
}

/// Where a control point should be at the second key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// There, head space, m.
    At(Vec3),
    /// So far from where the given motion has it at the second key, head axes, m.
    Offset(Vec3),
}

/// A time on the field's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KeyTime {
    /// Seconds.
    Secs(f64),
    /// Frames from time 0, at [`EditList::rate_hz`].
    Frame(i64),
}

/// The version of the layout that this crate writes, and the only one it reads.
pub const EDITS_VERSION: u32 = 1;

/// The reach of a drag that names none, m: three voxels of the default grid.
///
/// If it rises, more hair follows the dragged strand; if it falls, the strand may swing out of the handles that
/// pull it.
pub const DEFAULT_REACH_M: f64 = 0.06;

/// How a layer comes and goes where the edit does not say: smoothly over half the span, and back over a quarter.
///
/// If the rise grows, the pull begins more gently and has to be stronger later. If the fall grows, the lock is let
/// go earlier and its weight has drawn it further back when the second key comes; if it shrinks, it is let go
/// more suddenly.
pub const DEFAULT_EASE: Ease = Ease { rise: 0.5, fall: 0.25 };

fn first_version() -> u32 {
    EDITS_VERSION
}

impl EditList {
    /// No edits.
    pub fn new() -> Self {
        Self {
            version: EDITS_VERSION,
            rate_hz: None,
            changes: Vec::new(),
            winds: Vec::new(),
            edits: Vec::new(),
        }
    }
}

impl Default for EditList {
    fn default() -> Self {
        Self::new()
    }
}

impl KeyTime {
    /// The time, s; `None` for a frame if there is no rate.
    pub fn secs(self, rate_hz: Option<f64>) -> Option<f64> {
        match self {
            Self::Secs(secs) => Some(secs),
            Self::Frame(frame) => Some(frame as f64 / rate_hz?),
        }
    }
}
