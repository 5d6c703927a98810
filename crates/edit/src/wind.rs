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
