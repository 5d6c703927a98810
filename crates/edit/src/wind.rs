//! Changes of the wind at some place: gusts, calms, stronger and weaker, turned.

use crate::e4::of_edit;
use crate::{EditError, EditList, KeyTime};
use serde::{Deserialize, Serialize};
use tousle_core::Vec3;
use tousle_field::{Ease, FieldLayer, Handle, LayerOrigin, Reshape};

/// A change of the wind near a place for a while.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "crate::raw::RawWind", into = "crate::raw::RawWind")]
pub struct WindEdit {
    /// A name for people.
    pub name: String,
    /// Before this time nothing changes.
    pub first: KeyTime,
    /// From this time on the field is as it was.
    pub last: KeyTime,
    /// How the change comes and goes between the two.
    pub ease: Ease,
    /// A muted edit becomes a muted layer: kept, and doing nothing.
    pub muted: bool,
    /// The place, head space, m.
    pub center_m: Vec3,
    /// Distance from the place at which nothing is changed any more, m.
    pub reach_m: f64,
    /// What is changed.
    pub change: WindChange,
}

/// What is changed about the wind; all of it at the place, less and less towards the reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WindChange {
    /// This is added, head axes, in the field's quantity.
    Gust {
        /// The vector.
        vector: Vec3,
    },
    /// The wind dies.
    Calm,
    /// The wind is so many times as strong.
    Strength {
        /// At least 0; below 1 it is weaker.
        factor: f64,
    },
    /// The wind is turned about an axis by its length.
    Turn {
        /// Head axes, rad.
        turn: Vec3,
    },
}

impl WindChange {
    /// The name in edits files and in layers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gust { .. } => "gust",
            Self::Calm => "calm",
            Self::Strength { .. } => "strength",
            Self::Turn { .. } => "turn",
        }
    }
}

impl WindEdit {
    /// The change that a layer was made from, to be made again with something changed; `None` of a layer that was made
    /// from something else, or by a method that this crate does not know.
    pub fn of_layer(layer: &FieldLayer) -> Option<Self> {
        let (LayerOrigin::Wind { action }, [handle]) = (&layer.origin, &layer.handles[..]) else {
            return None;
        };
        let change = match (action.as_str(), layer.reshape) {
            ("gust", None) => WindChange::Gust { vector: handle.extra },
            ("calm", Some(_)) => WindChange::Calm,
            ("strength", Some(reshape)) => WindChange::Strength { factor: reshape.scale },
            ("turn", Some(reshape)) => WindChange::Turn { turn: reshape.turn },
            _ => return None,
        };
        Some(Self {
            name: layer.name.clone(),
            first: KeyTime::Secs(layer.first_secs),
            last: KeyTime::Secs(layer.last_secs),
            ease: layer.ease,
            muted: layer.muted,
            center_m: handle.center_m,
            reach_m: handle.reach_m,
            change,
        })
    }
}

/// The layer of a list's change of the wind with this number (from 1).
///
/// # Errors
/// [`EditError::BadEdit`] if its times are frames of no rate, or not in order.
pub fn wind_layer(list: &EditList, number: usize, id: String) -> Result<FieldLayer, EditError> {
    let edit = &list.winds[number - 1];
    let bad = of_edit(number, &edit.name);
    let times = edit.first.secs(list.rate_hz).zip(edit.last.secs(list.rate_hz));
    let (first_secs, last_secs) =
        times.ok_or_else(|| bad("found times given as frames, expected a `rate_hz` in the list".into()))?;
    if last_secs <= first_secs {
        return Err(bad(format!(
            "found an end at {last_secs} s, expected one after the start, {first_secs} s"
        )));
    }
    let (extra, reshape) = match edit.change {
        WindChange::Gust { vector } => (vector, None),
        WindChange::Calm => (Vec3::zeros(), Some(Reshape { turn: Vec3::zeros(), scale: 0.0 })),
        WindChange::Strength { factor } => {
            (Vec3::zeros(), Some(Reshape { turn: Vec3::zeros(), scale: factor }))
        }
        WindChange::Turn { turn } => (Vec3::zeros(), Some(Reshape { turn, scale: 1.0 })),
    };
    Ok(FieldLayer {
        id,
        name: edit.name.clone(),
        muted: edit.muted,
        first_secs,
        last_secs,
        ease: edit.ease,
        handles: vec![Handle { center_m: edit.center_m, reach_m: edit.reach_m, extra }],
        reshape,
        origin: LayerOrigin::Wind { action: edit.change.name().to_owned() },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DEFAULT_EASE;

    #[test]
    fn a_layer_says_what_it_was_made_from() {
        let changes = [
            WindChange::Gust { vector: Vec3::new(1.0, -2.0, 0.5) },
            WindChange::Calm,
            WindChange::Strength { factor: 1.5 },
            WindChange::Turn { turn: Vec3::new(0.0, 0.0, 0.6) },
        ];
        for change in changes {
            let edit = WindEdit {
                name: "by the door".into(),
                first: KeyTime::Secs(0.5),
                last: KeyTime::Secs(1.5),
                ease: DEFAULT_EASE,
                muted: true,
                center_m: Vec3::new(0.2, 0.0, -0.1),
                reach_m: 0.15,
                change,
            };
            let list = EditList { winds: vec![edit.clone()], ..EditList::new() };
            let layer = wind_layer(&list, 1, "door".into()).unwrap();
            assert_eq!(WindEdit::of_layer(&layer), Some(edit));
            let origin = LayerOrigin::Mirrored { edit: "door".into(), of: "window".into() };
            assert_eq!(WindEdit::of_layer(&FieldLayer { origin, ..layer }), None);
        }
    }
}
