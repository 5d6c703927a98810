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
            ("length_m", self.length_m),
            ("linear_density_kg_per_m", self.linear_density_kg_per_m),
            ("lock_width_m", self.lock_width_m),
        ];
        for (property, found) in above_zero {
            if !(found.is_finite() && found > 0.0) {
                return Err(GroomError::BadProperty {
                    strand: strand(),
                    property,
                    found,
                    expected: "a number above 0",
                });
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
            ("bending_stiffness_N_m2", self.bending_stiffness_n_m2),
            ("internal_damping_time_s", self.internal_damping_secs),
        ];
        for (property, found) in not_negative {
            if !(found.is_finite() && found >= 0.0) {
                return Err(GroomError::BadProperty {
                    strand: strand(),
                    property,
                    found,
                    expected: "0 or a number above",
                });
            }
        }
        Ok(())
    }
}
