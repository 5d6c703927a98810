//! The flat tables of an edits file, and what must hold for one of them alone.

use crate::list::{DEFAULT_EASE, DEFAULT_REACH_M};
use crate::{Action, ControlPoint, Drag, Edit, Key, KeyTime, Target, WindChange, WindEdit};
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
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    also: Vec<RawKey>,
}

/// An `[[edit.also]]` table. What it leaves out is as in its edit.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawKey {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    strand: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    control_point: Option<ControlPoint>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    secs: Option<Finite>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    frame: Option<i64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    target_m: Option<[Finite; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    offset_m: Option<[Finite; 3]>,
}

/// A `[[wind]]` table as it stands in the file.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawWind {
    name: String,
    kind: WindKind,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    first_secs: Option<Finite>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    first_frame: Option<i64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    last_secs: Option<Finite>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    last_frame: Option<i64>,
    center_m: [Finite; 3],
    reach_m: Reach,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    vector: Option<[Finite; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    factor: Option<Finite>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    turn_rad: Option<[Finite; 3]>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    muted: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    ease: Option<Shares>,
}

/// How the wind may be changed.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum WindKind {
    Gust,
    Calm,
    Strength,
    Turn,
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
        let target = target(raw.target_m, raw.offset_m)?;
        check_point(raw.control_point)?;
        let second = key("second_", raw.second_secs, raw.second_frame)?;
        let also = |other: RawKey| {
            let control_point = other.control_point.unwrap_or(raw.control_point);
            check_point(control_point)?;
            Ok::<_, String>(Key {
                strand: other.strand.unwrap_or_else(|| raw.strand.clone()),
                control_point,
                time: match (other.secs, other.frame) {
                    (None, None) => second,
                    (secs, frame) => key("", secs, frame)?,
                },
                target: self::target(other.target_m, other.offset_m)?,
            })
        };
        Ok(Self {
            name: raw.name,
            first: key("first_", raw.first_secs, raw.first_frame)?,
            second,
            ease: raw.ease.map_or(DEFAULT_EASE, |shares| shares.0),
            muted: raw.muted,
            action: Action::Drag(Drag {
                also: raw.also.into_iter().map(also).collect::<Result<_, _>>()?,
                strand: raw.strand,
                control_point: raw.control_point,
                target,
                reach_m: raw.reach_m.map_or(DEFAULT_REACH_M, |reach| reach.0),
            }),
        })
    }
}

impl TryFrom<RawWind> for WindEdit {
    type Error = String;

    fn try_from(raw: RawWind) -> Result<Self, String> {
        let vector = |v: [Finite; 3]| Vec3::from(v.map(|c| c.0));
        let change = match (raw.kind, raw.vector, raw.factor, raw.turn_rad) {
            (WindKind::Gust, Some(v), None, None) => WindChange::Gust { vector: vector(v) },
            (WindKind::Calm, None, None, None) => WindChange::Calm,
            (WindKind::Strength, None, Some(Finite(factor)), None) if factor >= 0.0 => {
                WindChange::Strength { factor }
            }
            (WindKind::Turn, None, None, Some(turn)) => WindChange::Turn { turn: vector(turn) },
            _ => {
                return Err("expected `vector` of a gust, nothing of a calm, a `factor` of at least 0 of a \
                            strength, `turn_rad` of a turn, and no other of these"
                    .into());
            }
        };
        Ok(Self {
            name: raw.name,
            first: key("first_", raw.first_secs, raw.first_frame)?,
            last: key("last_", raw.last_secs, raw.last_frame)?,
            ease: raw.ease.map_or(DEFAULT_EASE, |shares| shares.0),
            muted: raw.muted,
            center_m: vector(raw.center_m),
            reach_m: raw.reach_m.0,
            change,
        })
    }
}

impl From<WindEdit> for RawWind {
    fn from(edit: WindEdit) -> Self {
        let vector = |v: Vec3| <[f64; 3]>::from(v).map(Finite);
        let (kind, v, factor, turn) = match edit.change {
            WindChange::Gust { vector: v } => (WindKind::Gust, Some(vector(v)), None, None),
            WindChange::Calm => (WindKind::Calm, None, None, None),
            WindChange::Strength { factor } => (WindKind::Strength, None, Some(Finite(factor)), None),
            WindChange::Turn { turn } => (WindKind::Turn, None, None, Some(vector(turn))),
        };
        Self {
            name: edit.name,
            kind,
            first_secs: secs(edit.first),
            first_frame: frame(edit.first),
            last_secs: secs(edit.last),
            last_frame: frame(edit.last),
            center_m: vector(edit.center_m),
            reach_m: Reach(edit.reach_m),
            vector: v,
            factor,
            turn_rad: turn,
            muted: edit.muted,
            ease: Some(Shares(edit.ease)),
        }
    }
}

fn target(target_m: Option<[Finite; 3]>, offset_m: Option<[Finite; 3]>) -> Result<Target, String> {
    let point = |p: [Finite; 3]| Vec3::from(p.map(|c| c.0));
    match (target_m, offset_m) {
        (Some(at), None) => Ok(Target::At(point(at))),
        (None, Some(offset)) => Ok(Target::Offset(point(offset))),
        (Some(_), Some(_)) => Err("found both `target_m` and `offset_m`, expected one of them".into()),
        (None, None) => Err("found neither `target_m` nor `offset_m`, expected one of them".into()),
    }
}

fn check_point(control_point: ControlPoint) -> Result<(), String> {
    if control_point == ControlPoint::Index(0) {
        return Err("found control point 0, expected 1 or more: the root stays where it grows".into());
    }
    Ok(())
}

fn key(which: &str, secs: Option<Finite>, frame: Option<i64>) -> Result<KeyTime, String> {
    match (secs, frame) {
        (Some(secs), None) => Ok(KeyTime::Secs(secs.0)),
        (None, Some(frame)) => Ok(KeyTime::Frame(frame)),
        (Some(_), Some(_)) => {
            Err(format!("found both `{which}secs` and `{which}frame`, expected one of them"))
        }
        (None, None) => Err(format!("found neither `{which}secs` nor `{which}frame`, expected one of them")),
    }
}

impl From<Edit> for RawEdit {
    fn from(edit: Edit) -> Self {
        let Action::Drag(drag) = edit.action;
        let (target_m, offset_m) = raw_target(drag.target);
        let also = |key: Key| {
            let (target_m, offset_m) = raw_target(key.target);
            RawKey {
                strand: Some(key.strand),
                control_point: Some(key.control_point),
                secs: secs(key.time),
                frame: frame(key.time),
                target_m,
                offset_m,
            }
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
            also: drag.also.into_iter().map(also).collect(),
        }
    }
}

fn raw_target(target: Target) -> (Option<[Finite; 3]>, Option<[Finite; 3]>) {
    let point = |p: Vec3| Some(<[f64; 3]>::from(p).map(Finite));
    match target {
        Target::At(at) => (point(at), None),
        Target::Offset(offset) => (None, point(offset)),
    }
}

fn secs(time: KeyTime) -> Option<Finite> {
    if let KeyTime::Secs(secs) = time { Some(Finite(secs)) } else { None }
}

fn frame(time: KeyTime) -> Option<i64> {
    if let KeyTime::Frame(frame) = time { Some(frame) } else { None }
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
