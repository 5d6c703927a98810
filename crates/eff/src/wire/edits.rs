//! The edits: layers that are added to the field when it is sampled.

use serde::{Deserialize, Serialize};
use tousle_field::{Ease, FieldLayer, LayerOrigin};

/// All edits of a field, in order: the one message of `/eff/edits`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[cfg_attr(test, schemars(title = "tousle.eff.v1.Edits"))]
pub(crate) struct Edits {
    /// The layers, first applied first.
    pub layers: Vec<Layer>,
}

/// An extra vector near some handles during a span of time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[cfg_attr(test, schemars(rename = "Layer"))]
pub(crate) struct Layer {
    /// Unique in the file.
    pub id: String,
    /// A name for people.
    pub name: String,
    /// A muted layer is kept and does nothing.
    pub muted: bool,
    /// The layer begins at this time, s.
    pub first_secs: f64,
    /// The layer has ended at this time, s; later than it begins.
    pub last_secs: f64,
    /// Share of the span in which it rises from nothing, 0 to 1.
    #[cfg_attr(test, schemars(range(min = 0.0, max = 1.0)))]
    pub rise: f64,
    /// Share of the span in which it falls to nothing again, 0 to 1 less `rise`.
    #[cfg_attr(test, schemars(range(min = 0.0, max = 1.0)))]
    pub fall: f64,
    /// Where it acts.
    pub handles: Vec<Handle>,
    /// What it was made from, for an editor; a simulator may skip it.
    pub origin: Origin,
}

impl Layer {
    /// All its numbers.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> + '_ {
        let Origin::Drag { target_m, .. } = &self.origin;
        let handle = |h: &Handle| h.center_m.into_iter().chain([h.reach_m]).chain(h.extra);
        [self.first_secs, self.last_secs, self.rise, self.fall]
            .into_iter()
            .chain(self.handles.iter().flat_map(handle))
            .chain(*target_m)
    }
}

/// One place where a layer acts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Handle {
    /// The center, head space, m.
    pub center_m: [f64; 3],
    /// Distance from the center at which nothing is left, m.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0.0)))]
    pub reach_m: f64,
    /// What is added at the center, head axes, in the field's quantity.
    pub extra: [f64; 3],
}

/// What a layer was made from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) enum Origin {
    /// A strand's control point was dragged to a target.
    Drag {
        /// The strand's name in the groom it was dragged in.
        strand: String,
        /// The control point, from the root, from 0.
        control_point: u64,
        /// Where it should be at the end of the span, head space, m.
        target_m: [f64; 3],
        /// Which method made the handles.
        method: String,
    },
}

impl From<&FieldLayer> for Layer {
    fn from(layer: &FieldLayer) -> Self {
        let handle = |h: &tousle_field::Handle| Handle {
            center_m: h.center_m.into(),
            reach_m: h.reach_m,
            extra: h.extra.into(),
        };
        Self {
            id: layer.id.clone(),
            name: layer.name.clone(),
            muted: layer.muted,
            first_secs: layer.first_secs,
            last_secs: layer.last_secs,
            rise: layer.ease.rise,
            fall: layer.ease.fall,
            handles: layer.handles.iter().map(handle).collect(),
            origin: (&layer.origin).into(),
        }
    }
}

impl From<Layer> for FieldLayer {
    fn from(layer: Layer) -> Self {
        let handle = |h: Handle| tousle_field::Handle {
            center_m: h.center_m.into(),
            reach_m: h.reach_m,
            extra: h.extra.into(),
        };
        Self {
            id: layer.id,
            name: layer.name,
            muted: layer.muted,
            first_secs: layer.first_secs,
            last_secs: layer.last_secs,
            ease: Ease { rise: layer.rise, fall: layer.fall },
            handles: layer.handles.into_iter().map(handle).collect(),
            origin: layer.origin.into(),
        }
    }
}

impl From<&LayerOrigin> for Origin {
    fn from(origin: &LayerOrigin) -> Self {
        match origin {
            LayerOrigin::Drag { strand, control_point, target_m, method } => Self::Drag {
                strand: strand.clone(),
                control_point: *control_point as u64,
                target_m: (*target_m).into(),
                method: method.clone(),
            },
        }
    }
}

impl From<Origin> for LayerOrigin {
    fn from(origin: Origin) -> Self {
        match origin {
            Origin::Drag { strand, control_point, target_m, method } => Self::Drag {
                strand,
                control_point: control_point as usize,
                target_m: target_m.into(),
                method,
            },
        }
    }
}
