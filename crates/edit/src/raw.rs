//! The flat tables of an edits file, and what must hold for one of them alone.

use crate::list::{DEFAULT_EASE, DEFAULT_REACH_M};
use crate::{Action, ControlPoint, Drag, Edit, KeyTime, Target};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use std::fmt;
use tousle_core::Vec3;
use tousle_field::Ease;

/// An `[[edit]]` table as it stands in the file.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawEdit {
    name: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    kind: Option<Kind>,
    strand: String,
    control_point: ControlPoint,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    first_secs: Option<Finite>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    first_frame: Option<i64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    second_secs: Option<Finite>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    second_frame: Option<i64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    target_m: Option<[Finite; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    offset_m: Option<[Finite; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    reach_m: Option<Reach>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    muted: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    ease: Option<Shares>,
}

/// The kinds of edits that this version knows.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Kind {
    Drag,
}

/// A number that is neither NaN nor infinite. TOML can write both.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(try_from = "f64", into = "f64")]
struct Finite(f64);

/// A reach, m.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(try_from = "f64", into = "f64")]
struct Reach(f64);

/// The two shares of an [`Ease`].
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawShares {
    rise: f64,
    fall: f64,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(try_from = "RawShares", into = "RawShares")]
struct Shares(Ease);

/// Bounds of a reach, m: below a quarter of a default voxel no field can show it, above a meter it is no longer
/// an edit of a place.
const REACH_M: std::ops::RangeInclusive<f64> = 0.005..=1.0;

impl TryFrom<f64> for Finite {
    type Error = String;

    fn try_from(found: f64) -> Result<Self, String> {
        if found.is_finite() {
            Ok(Self(found))
        } else {
            Err(format!("found {found}, expected a finite number"))
        }
    }
}

impl TryFrom<f64> for Reach {
    type Error = String;

    fn try_from(found: f64) -> Result<Self, String> {
        if REACH_M.contains(&found) {
            return Ok(Self(found));
        }
        Err(format!("found a reach of {found} m, expected {} to {} m", REACH_M.start(), REACH_M.end()))
    }
}

impl TryFrom<RawShares> for Shares {
    type Error = String;

    fn try_from(RawShares { rise, fall }: RawShares) -> Result<Self, String> {
        // A sum written as decimals may round to just above 1.
        if rise >= 0.0 && fall >= 0.0 && rise + fall <= 1.0 + 1e-9 {
            return Ok(Self(Ease { rise, fall }));
        }
        Err(format!(
            "found rise {rise} and fall {fall}, expected shares of the span that add up to at most 1"
        ))
    }
}

impl From<Shares> for RawShares {
    fn from(Shares(Ease { rise, fall }): Shares) -> Self {
        Self { rise, fall }
    }
}

impl TryFrom<RawEdit> for Edit {
    type Error = String;

    fn try_from(raw: RawEdit) -> Result<Self, String> {
        let point = |p: [Finite; 3]| Vec3::from(p.map(|c| c.0));
        let target = match (raw.target_m, raw.offset_m) {
            (Some(at), None) => Target::At(point(at)),
            (None, Some(offset)) => Target::Offset(point(offset)),
            (Some(_), Some(_)) => {
                return Err("found both `target_m` and `offset_m`, expected one of them".into());
            }
            (None, None) => {
                return Err("found neither `target_m` nor `offset_m`, expected one of them".into());
            }
        };
        if raw.control_point == ControlPoint::Index(0) {
            return Err("found control point 0, expected 1 or more: the root stays where it grows".into());
        }
        Ok(Self {
            name: raw.name,
            first: key("first", raw.first_secs, raw.first_frame)?,
            second: key("second", raw.second_secs, raw.second_frame)?,
            ease: raw.ease.map_or(DEFAULT_EASE, |shares| shares.0),
            muted: raw.muted,
            action: Action::Drag(Drag {
                strand: raw.strand,
                control_point: raw.control_point,
                target,
                reach_m: raw.reach_m.map_or(DEFAULT_REACH_M, |reach| reach.0),
            }),
        })
    }
}

fn key(which: &str, secs: Option<Finite>, frame: Option<i64>) -> Result<KeyTime, String> {
    match (secs, frame) {
        (Some(secs), None) => Ok(KeyTime::Secs(secs.0)),
        (None, Some(frame)) => Ok(KeyTime::Frame(frame)),
        (Some(_), Some(_)) => {
            Err(format!("found both `{which}_secs` and `{which}_frame`, expected one of them"))
        }
        (None, None) => {
            Err(format!("found neither `{which}_secs` nor `{which}_frame`, expected one of them"))
        }
    }
}

impl From<Edit> for RawEdit {
    fn from(edit: Edit) -> Self {
        let Action::Drag(drag) = edit.action;
        let point = |p: Vec3| -> [Finite; 3] { <[f64; 3]>::from(p).map(Finite) };
        let secs = |time: KeyTime| if let KeyTime::Secs(secs) = time { Some(Finite(secs)) } else { None };
        let frame = |time: KeyTime| if let KeyTime::Frame(frame) = time { Some(frame) } else { None };
        let (target_m, offset_m) = match drag.target {
            Target::At(at) => (Some(point(at)), None),
            Target::Offset(offset) => (None, Some(point(offset))),
        };
        Self {
            name: edit.name,
            kind: Some(Kind::Drag),
            strand: drag.strand,
            control_point: drag.control_point,
            first_secs: secs(edit.first),
            first_frame: frame(edit.first),
            second_secs: secs(edit.second),
            second_frame: frame(edit.second),
            target_m,
            offset_m,
            reach_m: Some(Reach(drag.reach_m)),
            muted: edit.muted,
            ease: Some(Shares(edit.ease)),
        }
    }
}

impl From<Finite> for f64 {
    fn from(Finite(number): Finite) -> Self {
        number
    }
}

impl From<Reach> for f64 {
    fn from(Reach(reach_m): Reach) -> Self {
        reach_m
    }
}

impl Serialize for ControlPoint {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match *self {
            Self::Tip => serializer.serialize_str("tip"),
            Self::Index(index) => serializer.serialize_u32(index),
        }
    }
}

impl<'de> Deserialize<'de> for ControlPoint {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl de::Visitor<'_> for Visitor {
            type Value = ControlPoint;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("\"tip\" or a whole number counted from the root")
            }

            fn visit_str<E: de::Error>(self, text: &str) -> Result<ControlPoint, E> {
                if text == "tip" {
                    return Ok(ControlPoint::Tip);
                }
                Err(E::invalid_value(de::Unexpected::Str(text), &self))
            }

            fn visit_i64<E: de::Error>(self, index: i64) -> Result<ControlPoint, E> {
                if index < 0 {
                    return Err(E::custom(format!("found control point {index}, expected 1 or more")));
                }
                self.visit_u64(index as u64)
            }

            fn visit_u64<E: de::Error>(self, index: u64) -> Result<ControlPoint, E> {
                let index =
                    u32::try_from(index).map_err(|_| E::custom(format!("found no control point {index}")))?;
                Ok(ControlPoint::Index(index))
            }
        }
        deserializer.deserialize_any(Visitor)
    }
}
