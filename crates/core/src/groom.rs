use crate::Vec3;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A hairstyle at rest: every strand's curve in head space and what it is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Groom {
    /// The strands; their order is the order of everything made from the groom.
    pub strands: Vec<Strand>,
    /// Every physical property that the file did not give and a default stands for.
    pub assumed: Vec<Assumption>,
}

/// One strand (a lock, a wisp, or a single hair) at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Strand {
    /// The strand's name.
    pub name: String,
    /// Control points as they hang still under gravity, head space, m, root first, at least two.
    pub rest_curve_m: Vec<Vec3>,
    /// Length from root to tip, m. May differ a little from the polyline's, which cuts corners.
    pub length_m: f64,
    /// Mass per length, kg/m.
    pub linear_density_kg_per_m: f64,
    /// How wide the strand is across the wind, m.
    pub lock_width_m: f64,
    /// Resistance to bending, N·m².
    pub bending_stiffness_n_m2: f64,
    /// Internal damping over stiffness, s: how long a bend takes to give way.
    pub internal_damping_secs: f64,
    /// How the above changes from root to tip.
    pub along: Along,
    /// Whether joints may be made stiffer where the rest curve would not stay as it is: so where nobody gave the
    /// stiffness, and the style is all that is known.
    pub holds_style: bool,
}

/// How a strand changes from root to tip: at each control point, how many times the strand's own value, > 0; linear in
/// between. An empty list is 1 everywhere.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Along {
    /// Of the width.
    pub width: Vec<f64>,
    /// Of the mass per length.
    pub linear_density: Vec<f64>,
    /// Of the resistance to bending.
    pub bending_stiffness: Vec<f64>,
}

/// A value that nobody gave, and the default that stands for it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Assumption {
    /// What was missing: `strands[*].lock_width_m`.
    pub what: String,
    /// The value that stands for it, with its unit.
    pub value: String,
    /// Why that value.
    pub why: String,
}

/// `what = value (why)`: as every report has it in words.
impl fmt::Display for Assumption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, value, why } = self;
        write!(f, "{what} = {value} ({why})")
    }
}

/// What makes a groom unusable.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GroomError {
    /// There is nothing to simulate.
    #[error("found no strands in the groom, expected one at least")]
    Empty,
    /// A strand needs a root and a tip.
    #[error("strand {strand}: found {found} control points, expected at least 2")]
    TooFewPoints {
        /// The strand's name.
        strand: String,
        /// How many it has.
        found: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("strand {strand}, control point {point}: found coordinates {found:?}, expected finite numbers")]
    NotFinite {
        /// The strand's name.
        strand: String,
        /// Index of the point, from the root.
        point: usize,
        /// The coordinates.
        found: [f64; 3],
    },
    /// Two neighboring points coincide.
    #[error("strand {strand}: found control points {point} and {} on one another, expected them apart", point + 1)]
    EmptySegment {
        /// The strand's name.
        strand: String,
        /// Index of the first of the two, from the root.
        point: usize,
    },
    /// A property is outside what it can be.
    #[error("strand {strand}: found {property} = {found}, expected {expected}")]
    BadProperty {
        /// The strand's name.
        strand: String,
        /// The property's name.
        property: &'static str,
        /// Its value.
        found: f64,
        /// What it should be.
        expected: &'static str,
    },
}

/// The most that a strand's numbers may be, SI: a steel cable's and more. Numbers much larger cannot be computed with, and no
/// one means them.
const MOST_LENGTH_M: f64 = 1e4;
const MOST_LINEAR_DENSITY: f64 = 1e3;
const MOST_WIDTH_M: f64 = 10.0;
const MOST_STIFFNESS: f64 = 1e9;
const MOST_DAMPING_SECS: f64 = 1e6;

impl Groom {
    /// Control points of all strands.
    pub fn n_points(&self) -> usize {
        self.strands.iter().map(|s| s.rest_curve_m.len()).sum()
    }

    /// Control points of each strand.
    pub fn counts(&self) -> Vec<usize> {
        self.strands.iter().map(|s| s.rest_curve_m.len()).collect()
    }

    /// Checks that every strand can be simulated: at least two points, finite, apart, with possible properties.
    ///
    /// # Errors
    /// The first [`GroomError`] in strand order.
    pub fn check(&self) -> Result<(), GroomError> {
        if self.strands.is_empty() {
            return Err(GroomError::Empty);
        }
        self.strands.iter().try_for_each(Strand::check)
    }
}

impl Along {
    /// A list's value at a control point.
    ///
    /// # Panics
    /// If the list is neither empty nor has the point.
    pub fn at(list: &[f64], point: usize) -> f64 {
        if list.is_empty() { 1.0 } else { list[point] }
    }
}

impl Strand {
    fn check(&self) -> Result<(), GroomError> {
        let strand = || self.name.clone();
        let points = &self.rest_curve_m;
        if points.len() < 2 {
            return Err(GroomError::TooFewPoints { strand: strand(), found: points.len() });
        }
        if let Some(point) = points.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
            return Err(GroomError::NotFinite { strand: strand(), point, found: points[point].into() });
        }
        if let Some(point) = points.windows(2).position(|p| (p[1] - p[0]).norm() < 1e-9) {
            return Err(GroomError::EmptySegment { strand: strand(), point });
        }
        let above_zero = [
            ("length_m", self.length_m, MOST_LENGTH_M, "a number above 0, at most 10 km"),
            (
                "linear_density_kg_per_m",
                self.linear_density_kg_per_m,
                MOST_LINEAR_DENSITY,
                "a number above 0, at most 1000",
            ),
            ("lock_width_m", self.lock_width_m, MOST_WIDTH_M, "a number above 0, at most 10 m"),
        ];
        for (property, found, most, expected) in above_zero {
            if !(found > 0.0 && found <= most) {
                return Err(GroomError::BadProperty { strand: strand(), property, found, expected });
            }
        }
        let along = [
            ("along.width", &self.along.width),
            ("along.linear_density", &self.along.linear_density),
            ("along.bending_stiffness", &self.along.bending_stiffness),
        ];
        for (property, list) in along {
            let bad = list.iter().copied().find(|x| !(x.is_finite() && *x > 0.0));
            let (found, expected) = match bad {
                Some(found) => (found, "numbers above 0"),
                None if list.is_empty() || list.len() == points.len() => continue,
                None => (list.len() as f64, "none, or as many numbers as control points"),
            };
            return Err(GroomError::BadProperty { strand: strand(), property, found, expected });
        }
        let not_negative = [
            (
                "bending_stiffness_N_m2",
                self.bending_stiffness_n_m2,
                MOST_STIFFNESS,
                "0 or a number above, at most 1e9",
            ),
            (
                "internal_damping_time_s",
                self.internal_damping_secs,
                MOST_DAMPING_SECS,
                "0 or a number above, at most 1e6",
            ),
        ];
        for (property, found, most, expected) in not_negative {
            if !(found >= 0.0 && found <= most) {
                return Err(GroomError::BadProperty { strand: strand(), property, found, expected });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strand() -> Strand {
        Strand {
            name: "a".to_owned(),
            rest_curve_m: vec![Vec3::zeros(), Vec3::x()],
            length_m: 1.0,
            linear_density_kg_per_m: 1e-3,
            lock_width_m: 0.004,
            bending_stiffness_n_m2: 0.0,
            internal_damping_secs: 0.0,
            along: Along::default(),
            holds_style: false,
        }
    }

    #[test]
    fn properties_that_no_hair_has_are_named() {
        type Change = fn(&mut Strand) -> &mut f64;
        let properties: [(&str, Change, f64); 5] = [
            ("length_m", |s| &mut s.length_m, 1e4),
            ("linear_density_kg_per_m", |s| &mut s.linear_density_kg_per_m, 1e3),
            ("lock_width_m", |s| &mut s.lock_width_m, 10.0),
            ("bending_stiffness_N_m2", |s| &mut s.bending_stiffness_n_m2, 1e9),
            ("internal_damping_time_s", |s| &mut s.internal_damping_secs, 1e6),
        ];
        for (name, field, most) in properties {
            let check = |value: f64| {
                let mut strand = strand();
                *field(&mut strand) = value;
                Groom { strands: vec![strand], assumed: Vec::new() }.check()
            };
            check(most).unwrap();
            for bad in [most * 1.01, 1e150, f64::INFINITY, f64::NAN, -1.0] {
                let error = check(bad).unwrap_err().to_string();
                assert!(error.contains(&format!("strand a: found {name} = {bad}")), "{error}");
            }
        }
    }
}
