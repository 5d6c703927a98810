//! Changes of the wind at some place, as they are when they are new, and the arrow that stands for a gust.

use tousle_core::{Quantity, Vec3};
use tousle_edit::{DEFAULT_EASE, KeyTime, WindChange, WindEdit};

/// A kind of change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Wind is added.
    Gust,
    /// The wind dies.
    Calm,
    /// The wind is stronger or weaker.
    Strength,
    /// The wind is turned.
    Turn,
}

/// Where and when a new change begins.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// The place, head space, m.
    pub center_m: Vec3,
    /// Where a gust blows to, head axes, of length 1.
    pub along: Vec3,
    /// From when to when, s.
    pub span_secs: [f64; 2],
    /// What the field's vectors are.
    pub quantity: Quantity,
    /// A strong vector of the field, in its unit.
    pub strong: f64,
}

/// How far a new change reaches, m: a side of the head with its hair.
const REACH_M: f64 = 0.15;
/// Length of the arrow that stands for a strong vector, m.
const STRONG_ARROW_M: f64 = 0.08;
/// A new change lasts so long, s.
const USUAL_SECS: f64 = 1.0;
/// What lasts less is hardly seen, s.
const LEAST_SECS: f64 = 0.2;

impl Kind {
    /// The name of a new change.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gust => "Gust",
            Self::Calm => "Calm",
            Self::Strength => "Stronger",
            Self::Turn => "Turn",
        }
    }

    /// A change that is seen at once, to be made what it should be.
    pub fn at(self, spot: &Spot) -> WindEdit {
        let change = match self {
            Self::Gust => {
                WindChange::Gust { vector: f64::max(0.5 * spot.strong, least(spot.quantity)) * spot.along }
            }
            Self::Calm => WindChange::Calm,
            Self::Strength => WindChange::Strength { factor: 2.0 },
            Self::Turn => WindChange::Turn { turn: Vec3::z() * std::f64::consts::FRAC_PI_4 },
        };
        let [first, last] = spot.span_secs.map(KeyTime::Secs);
        WindEdit {
            name: self.name().to_owned(),
            first,
            last,
            ease: DEFAULT_EASE,
            muted: false,
            center_m: spot.center_m,
            reach_m: REACH_M,
            change,
        }
    }
}

/// A gust that hair feels, in a field's unit.
fn least(quantity: Quantity) -> f64 {
    match quantity {
        Quantity::AirVelocity => 2.0,
        Quantity::ForcePerMass => 5.0,
    }
}

/// From when to when a new change lasts, s: from a time on, but not past the end.
pub fn usual_span(time_secs: f64, [start, end]: [f64; 2]) -> [f64; 2] {
    let last = f64::min(time_secs + USUAL_SECS, end);
    if last - time_secs < LEAST_SECS { [f64::max(end - USUAL_SECS, start), end] } else { [time_secs, last] }
}

/// Length of an arrow for each unit of a vector, m, in a field with such strong vectors.
pub fn arrow_m(strong: f64) -> f64 {
    STRONG_ARROW_M / strong
}

/// Where a gust's arrow ends, head space, m; `None` of another change.
pub fn arrow_end_m(edit: &WindEdit, arrow_m: f64) -> Option<Vec3> {
    match edit.change {
        WindChange::Gust { vector } => Some(edit.center_m + vector * arrow_m),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_change_lasts_a_second_or_the_last_one() {
        assert_eq!(usual_span(1.0, [0.0, 5.0]), [1.0, 2.0]);
        assert_eq!(usual_span(4.5, [0.0, 5.0]), [4.5, 5.0]);
        assert_eq!(usual_span(4.9, [0.0, 5.0]), [4.0, 5.0]);
        assert_eq!(usual_span(0.4, [0.0, 0.5]), [0.0, 0.5]);
    }

    #[test]
    fn a_new_gust_is_felt_even_in_still_air() {
        let spot = Spot {
            center_m: Vec3::x(),
            along: Vec3::y(),
            span_secs: [0.0, 1.0],
            quantity: Quantity::AirVelocity,
            strong: 1.0,
        };
        let gust = Kind::Gust.at(&spot);
        assert_eq!(arrow_end_m(&gust, arrow_m(1.0)), Some(Vec3::new(1.0, 0.16, 0.0)));
        let storm = Spot { strong: 20.0, ..spot };
        assert_eq!(Kind::Gust.at(&storm).change, WindChange::Gust { vector: 10.0 * Vec3::y() });
        assert_eq!(arrow_end_m(&Kind::Calm.at(&spot), 1.0), None);
    }
}
