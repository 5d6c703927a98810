use serde::Serialize;
use tousle_core::Vec3;

/// What each edit became.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct EditReport {
    /// One entry a drag, in the list's order.
    pub edits: Vec<EditOutcome>,
}

/// What an edit became.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EditOutcome {
    /// The edit's name.
    pub name: String,
    /// The id of its layer.
    pub layer_id: String,
    /// Whether the layer does nothing for now.
    pub muted: bool,
    /// The strand's name.
    pub strand: String,
    /// Its control point, from the root.
    pub control_point: usize,
    /// The first key, s.
    pub first_secs: f64,
    /// The second key, s.
    pub second_secs: f64,
    /// Where the unedited motion has the point at the second key, head space, m.
    pub unedited_m: Vec3,
    /// Where it should be, head space, m.
    pub target_m: Vec3,
    /// How far that is, mm.
    pub asked_mm: f64,
    /// Why the target cannot be reached, and by how much. The layer aims at the nearest place within the lock's
    /// length.
    pub unreachable: Option<Unreachable>,
    /// The extra acceleration of the dragged point when the layer is fully there, head axes, m/s².
    pub acceleration: Vec3,
    /// Share of that acceleration which lies along the lock, where wind has no hold; 0 in a field of forces.
    pub along_lock: f64,
    /// What the layer adds at the dragged point when it is fully there, head axes, in the field's quantity.
    pub extra: Vec3,
    /// How many handles the layer has.
    pub n_handles: usize,
}

/// Why a target cannot be reached.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "why", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Unreachable {
    /// It is farther from the root than the lock is long up to the dragged point.
    TooFar {
        /// By so much, mm.
        by_mm: f64,
    },
    /// It is nearer to the root than the lock can fold: one of its sticks is longer than all others together.
    TooNear {
        /// By so much, mm.
        by_mm: f64,
    },
    /// It is inside a collider, where hair cannot go; the layer aims at it all the same.
    InsideBody {
        /// The collider's name.
        collider: String,
        /// By so much, mm.
        by_mm: f64,
    },
    /// The strongest extra vector that is allowed does not bring it there.
    TooWeak {
        /// It stays so far away, mm.
        by_mm: f64,
        /// The strongest extra vector allowed, in the field's quantity.
        limit: f64,
    },
    /// No extra vectors near the strand were found that bring it there: something holds it, or other keys do.
    NotFound {
        /// It stays so far away, mm.
        by_mm: f64,
    },
}

impl Unreachable {
    /// By how much, mm.
    pub fn by_mm(&self) -> f64 {
        match self {
            Self::TooFar { by_mm }
            | Self::TooNear { by_mm }
            | Self::InsideBody { by_mm, .. }
            | Self::TooWeak { by_mm, .. }
            | Self::NotFound { by_mm } => *by_mm,
        }
    }
}

impl std::fmt::Display for Unreachable {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::TooFar { by_mm } => write!(f, "{by_mm:.1} mm farther from the root than the lock is long"),
            Self::TooNear { by_mm } => write!(f, "{by_mm:.1} mm nearer to the root than the lock can fold"),
            Self::InsideBody { collider, by_mm } => write!(f, "{by_mm:.1} mm inside the {collider}"),
            Self::TooWeak { by_mm, limit } => {
                write!(f, "missed by {by_mm:.1} mm with the strongest extra vector allowed, {limit}")
            }
            Self::NotFound { by_mm } => write!(f, "missed by {by_mm:.1} mm by the nearest answer found"),
        }
    }
}
