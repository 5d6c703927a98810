use serde::Serialize;
use tousle_core::Vec3;
use tousle_edit::{Change, EditOutcome, Unreachable};
use tousle_field::LayerKey;

/// What each edit became.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DirectReport {
    /// One entry a drag, in the list's order.
    pub edits: Vec<Made>,
}

/// What an edit became, by the method that made it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "method", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Made {
    /// E4.
    Paper(EditOutcome),
    /// Solved for.
    Physical(SolvedOutcome),
}

/// What a solved drag became.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SolvedOutcome {
    /// The edit's name.
    pub name: String,
    /// Its id, which its layers name.
    pub edit_id: String,
    /// Whether its layers do nothing for now.
    pub muted: bool,
    /// Before this time nothing changes, s.
    pub first_secs: f64,
    /// From this time on the field is as it was, s.
    pub last_secs: f64,
    /// How near each key is met by the layers as they are stored, in order of time.
    pub keys: Vec<KeyOutcome>,
    /// The longest extra vector, in the field's quantity.
    pub strongest: f64,
    /// The largest acceleration of the dragged strands over that of their unedited motion.
    pub acceleration_ratio: f64,
    /// The same of jerk.
    pub jerk_ratio: f64,
    /// What the keys demand of it at the least, whatever pulls the strand: an even acceleration from the motion that it has
    /// at the first key to within the tolerance of each key, over the peak of its unedited motion.
    pub least_acceleration_ratio: f64,
    /// The same of jerk.
    pub least_jerk_ratio: f64,
    /// Whether one of these is more than strands may do unasked ([`crate::DirectOptions::peak_ratio`]).
    pub peaks_demanded: bool,
    /// How often strands were simulated for it.
    pub n_runs: usize,
    /// How many layers it has, and how many handles in all.
    pub n_layers: usize,
    /// How many handles they have in all.
    pub n_handles: usize,
}

/// How near a key is met.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KeyOutcome {
    /// What should be where, and when.
    #[serde(flatten)]
    pub key: LayerKey,
    /// Where it was aimed at, head space, m: the target, or the nearest place to it that the lock can be at.
    pub aimed_m: Vec3,
    /// The distance from the target without and with the edit, mm.
    pub residual_mm: Change,
    /// Why it is not met to within the tolerance, if it is not.
    pub unreachable: Option<Unreachable>,
}

impl Made {
    /// The keys that are not met, and why.
    pub fn unreachable(&self) -> Vec<&Unreachable> {
        match self {
            Self::Paper(outcome) => outcome.unreachable.iter().collect(),
            Self::Physical(outcome) => outcome.keys.iter().filter_map(|k| k.unreachable.as_ref()).collect(),
        }
    }

    /// The edit's id.
    pub fn edit_id(&self) -> &str {
        match self {
            Self::Paper(outcome) => &outcome.layer_id,
            Self::Physical(outcome) => &outcome.edit_id,
        }
    }

    /// The edit's name.
    pub fn name(&self) -> &str {
        match self {
            Self::Paper(outcome) => &outcome.name,
            Self::Physical(outcome) => &outcome.name,
        }
    }
}
