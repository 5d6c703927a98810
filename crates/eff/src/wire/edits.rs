//! The edits: layers that are added to the field when it is sampled.

use serde::{Deserialize, Serialize};
use tousle_field::{Ease, FieldLayer, LayerKey, LayerOrigin};

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
    /// What it does to the vectors that are there; needs the feature `directing`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reshape: Option<Reshape>,
    /// What it was made from, for an editor; a simulator may skip it.
    pub origin: Origin,
}

/// The feature that a reader must know where layers are solved for, change the wind, or are mirrored.
pub(crate) const DIRECTING: &str = "directing";

impl Edits {
    /// The features that a reader must know.
    pub(crate) fn requires(&self) -> Vec<String> {
        let is_new = |layer: &Layer| layer.reshape.is_some() || !matches!(layer.origin, Origin::Drag { .. });
        if self.layers.iter().any(is_new) { vec![DIRECTING.to_owned()] } else { Vec::new() }
    }
}

impl Layer {
    /// All its numbers.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> + '_ {
        let origin: Vec<f64> = match &self.origin {
            Origin::Drag { target_m, .. } => target_m.to_vec(),
            Origin::Keys { first_secs, keys, .. } => {
                let of_key = |key: &Key| [&[key.secs][..], &key.target_m].concat();
                keys.iter().flat_map(of_key).chain([*first_secs]).collect()
            }
            Origin::Wind { .. } | Origin::Mirrored { .. } => Vec::new(),
        };
        let reshape = self.reshape.iter().flat_map(|r| r.turn.into_iter().chain([r.scale]));
        let handle = |h: &Handle| h.center_m.into_iter().chain([h.reach_m]).chain(h.extra);
        [self.first_secs, self.last_secs, self.rise, self.fall]
            .into_iter()
            .chain(self.handles.iter().flat_map(handle))
            .chain(origin)
            .chain(reshape)
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

/// What a layer does to the vectors that are there, before the handles' own are added.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Reshape {
    /// They are turned about this axis by its length, rad, head axes.
    pub turn: [f64; 3],
    /// They are made so many times as long.
    #[cfg_attr(test, schemars(range(min = 0.0)))]
    pub scale: f64,
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
    /// One of the layers that were solved for together; needs the feature `directing`.
    Keys {
        /// The edit that they are all of.
        edit: String,
        /// Before this time the edit does nothing, s.
        first_secs: f64,
        /// What should be where, and when.
        keys: Vec<Key>,
        /// Which method solved for them.
        method: String,
    },
    /// The wind was changed at some places; needs the feature `directing`.
    Wind {
        /// How: `gust`, `calm`, `strength`, `turn`, or another by name.
        action: String,
    },
    /// Another edit, mirrored from left to right; needs the feature `directing`.
    Mirrored {
        /// The edit that this layer is of.
        edit: String,
        /// The edit that was mirrored.
        of: String,
    },
}

/// Where a control point should be at a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Key {
    /// The strand's name in the groom it was dragged in.
    pub strand: String,
    /// The control point, from the root, from 0.
    pub control_point: u64,
    /// When, s.
    pub secs: f64,
    /// Where, head space, m.
    pub target_m: [f64; 3],
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
            reshape: layer.reshape.map(|r| Reshape { turn: r.turn.into(), scale: r.scale }),
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
            reshape: layer.reshape.map(|r| tousle_field::Reshape { turn: r.turn.into(), scale: r.scale }),
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
            LayerOrigin::Keys { edit, first_secs, keys, method } => Self::Keys {
                edit: edit.clone(),
                first_secs: *first_secs,
                keys: keys.iter().map(Into::into).collect(),
                method: method.clone(),
            },
            LayerOrigin::Wind { action } => Self::Wind { action: action.clone() },
            LayerOrigin::Mirrored { edit, of } => Self::Mirrored { edit: edit.clone(), of: of.clone() },
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
            Origin::Keys { edit, first_secs, keys, method } => {
                Self::Keys { edit, first_secs, keys: keys.into_iter().map(Into::into).collect(), method }
            }
            Origin::Wind { action } => Self::Wind { action },
            Origin::Mirrored { edit, of } => Self::Mirrored { edit, of },
        }
    }
}

impl From<&LayerKey> for Key {
    fn from(key: &LayerKey) -> Self {
        Self {
            strand: key.strand.clone(),
            control_point: key.control_point as u64,
            secs: key.secs,
            target_m: key.target_m.into(),
        }
    }
}

impl From<Key> for LayerKey {
    fn from(key: Key) -> Self {
        Self {
            strand: key.strand,
            control_point: key.control_point as usize,
            secs: key.secs,
            target_m: key.target_m.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::Vec3;

    fn layer(origin: LayerOrigin, reshape: Option<tousle_field::Reshape>) -> FieldLayer {
        FieldLayer {
            id: "lift/1".into(),
            name: "lift".into(),
            muted: false,
            first_secs: 1.0,
            last_secs: 1.2,
            ease: Ease { rise: 0.5, fall: 0.5 },
            handles: Vec::new(),
            reshape,
            origin,
        }
    }

    /// Through JSON and back to the bit; only what is new asks for the feature.
    #[test]
    fn every_kind_of_layer_is_read_back_the_same() {
        let key =
            LayerKey { strand: "A".into(), control_point: 3, secs: 0.1 + 0.2, target_m: Vec3::x() / 3.0 };
        let calm = tousle_field::Reshape { turn: Vec3::z(), scale: 0.0 };
        let drag = LayerOrigin::Drag {
            strand: "A".into(),
            control_point: 3,
            target_m: Vec3::zeros(),
            method: "paper".into(),
        };
        let keys = LayerOrigin::Keys {
            edit: "lift".into(),
            first_secs: 1.0,
            keys: vec![key],
            method: "physical".into(),
        };
        let mirrored = LayerOrigin::Mirrored { edit: "a".into(), of: "b".into() };
        for (layer, is_new) in [
            (layer(drag.clone(), None), false),
            (layer(drag, Some(calm)), true),
            (layer(keys, None), true),
            (layer(LayerOrigin::Wind { action: "calm".into() }, Some(calm)), true),
            (layer(mirrored, None), true),
        ] {
            let edits = Edits { layers: vec![(&layer).into()] };
            assert_eq!(!edits.requires().is_empty(), is_new, "{layer:?}");
            let json = serde_json::to_vec(&edits).unwrap();
            let read: Edits = serde_json::from_slice(&json).unwrap();
            assert_eq!(FieldLayer::from(read.layers.into_iter().next().unwrap()), layer);
        }
    }
}
