//! What stands for physical properties that a groom file does not give.
//!
//! A strand is taken for a wisp of hairs that move as one: its mass per length, its stiffness and its width all
//! follow from how many hairs it holds. Any one that is given gives the others; where none is, the hairs of a
//! head are shared out among the strands. Numbers are those of adult scalp hair (Robbins, "Chemical and Physical
//! Behavior of Human Hair", 5th edition, chapters 8 and 9).

use std::f64::consts::PI;

use tousle_core::{Assumption, Groom, Strand};

use crate::along;
use crate::placement::Placed;
use crate::raw::RawStrand;

/// Diameter of a hair, m; 50 to 100 µm are common.
const HAIR_DIAMETER_M: f64 = 70e-6;

/// Density of keratin, kg/m³.
const HAIR_DENSITY: f64 = 1320.0;

/// Elastic modulus of a hair in bending, Pa.
const HAIR_MODULUS: f64 = 3.8e9;

/// Hairs on a head.
const HAIRS_ON_A_HEAD: f64 = 100_000.0;

/// The most hairs that move as one: with more, a groom of few guides would get locks as heavy as ropes.
const MOST_HAIRS_A_STRAND: f64 = 300.0;

/// Share of a loose lock's cross-section that is hair; the rest is air. If it rises, strands of the same mass get
/// thinner and the wind moves them less.
const PACKING: f64 = 0.07;

/// Internal damping over stiffness, s: a loss tangent of 0.1 at one swing a second.
const INTERNAL_DAMPING_SECS: f64 = 0.016;

/// Drawn widths outside this range, m, are a renderer's setting and no lock's width.
const PLAUSIBLE_WIDTH_M: std::ops::RangeInclusive<f64> = 50e-6..=0.03;

/// Mass per length of one hair, kg/m.
fn hair_linear_density() -> f64 {
    HAIR_DENSITY * PI / 4.0 * HAIR_DIAMETER_M * HAIR_DIAMETER_M
}

/// Resistance of one hair to bending, N·m²: hairs in a wisp slide on one another, so theirs add up.
fn hair_stiffness() -> f64 {
    let squared = HAIR_DIAMETER_M * HAIR_DIAMETER_M;
    HAIR_MODULUS * PI / 64.0 * squared * squared
}

/// How many hairs a lock of this width holds: one at least, which has no air in it.
fn hairs_of_width(width_m: f64) -> f64 {
    let across = width_m / HAIR_DIAMETER_M;
    f64::max(PACKING * across * across, 1.0)
}

/// How wide a lock of so many hairs is, m.
fn width_of_hairs(n_hairs: f64) -> f64 {
    HAIR_DIAMETER_M * libm::sqrt(n_hairs / PACKING)
}

/// Makes a groom of placed curves, each value that is missing from what is known, and lists those.
pub(crate) fn with_defaults(placed: Placed, warnings: &mut Vec<String>) -> Groom {
    let Placed { raw, mut assumed } = placed;
    let n_strands = raw.strands.len();
    let shared = (HAIRS_ON_A_HEAD / n_strands.max(1) as f64).clamp(1.0, MOST_HAIRS_A_STRAND);
    // Nameless strands are called by their numbers in the file, whichever were left out.
    let n_digits =
        raw.strands.last().and_then(|last| last.number).map_or(n_strands, |k| k + 1).to_string().len();
    let mut notes = Notes::default();
    let strands = raw.strands.into_iter().enumerate();
    let strands = strands.map(|(k, strand)| complete(strand, k, n_digits, shared, &mut notes)).collect();
    notes.report(n_strands, &mut assumed, warnings);
    Groom { strands, assumed }
}

fn complete(raw: RawStrand, index: usize, n_digits: usize, shared_hairs: f64, notes: &mut Notes) -> Strand {
    let along = raw.points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
    let length_m = raw.length.unwrap_or(along);
    // A polyline cuts corners: it can be shorter than its curve, never longer.
    notes.too_long += usize::from(along > 1.01 * length_m);
    notes.too_short += usize::from(length_m > 2.0 * along);
    let drawn = raw.drawn_width.filter(|w| PLAUSIBLE_WIDTH_M.contains(w));
    notes.implausible += usize::from(raw.drawn_width.is_some() && drawn.is_none());
    let known_width = raw.lock_width_m.or(drawn);
    let n_hairs = match (raw.linear_density_kg_per_m, known_width) {
        (Some(density), _) => density / hair_linear_density(),
        (None, Some(width)) => hairs_of_width(width),
        (None, None) => shared_hairs,
    };
    let along = along::complete(&raw, known_width.is_some());
    let follows = |given: &[f64], list: &[f64]| given.is_empty() && !list.is_empty();
    notes.along += usize::from(
        follows(&raw.along.linear_density, &along.linear_density)
            || follows(&raw.along.bending_stiffness, &along.bending_stiffness),
    );
    Strand {
        along,
        // Where nobody knows how stiff it is, its style is all that says so.
        holds_style: raw.bending_stiffness_n_m2.is_none(),
        name: raw.name.unwrap_or_else(|| format!("{:0n_digits$}", raw.number.unwrap_or(index) + 1)),
        length_m,
        linear_density_kg_per_m: notes
            .density
            .or(raw.linear_density_kg_per_m, n_hairs * hair_linear_density()),
        lock_width_m: match (raw.lock_width_m, drawn) {
            (None, Some(drawn)) => notes.drawn_width.or(None, drawn),
            (given, _) => notes.width.or(given, width_of_hairs(n_hairs)),
        },
        bending_stiffness_n_m2: notes.stiffness.or(raw.bending_stiffness_n_m2, n_hairs * hair_stiffness()),
        internal_damping_secs: notes.damping.or(raw.internal_damping_secs, INTERNAL_DAMPING_SECS),
        rest_curve_m: raw.points,
    }
}

/// What was put in, over all strands.
#[derive(Default)]
struct Notes {
    density: Range,
    width: Range,
    drawn_width: Range,
    stiffness: Range,
    damping: Range,
    along: usize,
    too_long: usize,
    too_short: usize,
    implausible: usize,
}

/// How often a value was put in, and from where to where it ran.
#[derive(Default)]
struct Range {
    n: usize,
    low: f64,
    high: f64,
}

impl Range {
    /// The given value, or the one that stands for it, which is counted.
    fn or(&mut self, given: Option<f64>, otherwise: f64) -> f64 {
        given.unwrap_or_else(|| {
            self.low = if self.n == 0 { otherwise } else { self.low.min(otherwise) };
            self.high = if self.n == 0 { otherwise } else { self.high.max(otherwise) };
            self.n += 1;
            otherwise
        })
    }
}

impl Notes {
    fn report(&self, n_strands: usize, assumed: &mut Vec<Assumption>, warnings: &mut Vec<String>) {
        let wisp = "hairs of 70 µm that move as one: as many as the strand's width or mass says, else its share \
                    of 100,000 on a head, at most 300";
        let drawn = "the width the strand is drawn with";
        let damping = "a loss tangent of 0.1 at one swing a second";
        for (what, range, unit, why) in [
            ("linear_density_kg_per_m", &self.density, "kg/m", wisp),
            ("lock_width_m", &self.width, "m", wisp),
            ("lock_width_m", &self.drawn_width, "m", drawn),
            ("bending_stiffness_N_m2", &self.stiffness, "N·m²", wisp),
            ("internal_damping_time_s", &self.damping, "s", damping),
        ] {
            if range.n > 0 {
                let to =
                    if range.high > range.low { format!(" to {:.3e}", range.high) } else { String::new() };
                assumed.push(Assumption {
                    what: format!("{what} of {} of {n_strands} strands", range.n),
                    value: format!("{:.3e}{to} {unit}", range.low),
                    why: why.to_owned(),
                });
            }
        }
        if self.along > 0 {
            assumed.push(Assumption {
                what: format!("mass and stiffness along {} of {n_strands} strands", self.along),
                value: "as many hairs at each point as the square of the width there has room for".to_owned(),
                why: "their width changes from root to tip, and hairs are of one thickness".to_owned(),
            });
        }
        if self.too_long > 0 {
            let n = self.too_long;
            warnings
                .push(format!("{n} strands are given shorter (length_m) than their rest curve by over 1 %"));
        }
        if self.too_short > 0 {
            let n = self.too_short;
            warnings.push(format!(
                "{n} strands are given over twice as long (length_m) as their rest curve: is it in meters?"
            ));
        }
        if self.implausible > 0 {
            let n = self.implausible;
            warnings.push(format!(
                "{n} strands are drawn thinner than 0.05 mm, wider than 30 mm or with a width that is no number: width not used"
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raw::RawGroom;
    use tousle_core::Vec3;

    fn strand() -> RawStrand {
        RawStrand::of_points(vec![Vec3::zeros(), Vec3::new(0.0, 0.0, -0.1)])
    }

    fn groom(strands: Vec<RawStrand>) -> (Groom, Vec<String>) {
        let mut warnings = Vec::new();
        let raw = RawGroom { strands, ..RawGroom::default() };
        (with_defaults(Placed { raw, assumed: Vec::new() }, &mut warnings), warnings)
    }

    /// 1,000 strands hold 100 hairs each: 100 x 1320 x π/4 x (70e-6)² = 5.08e-4 kg/m, and so on.
    #[test]
    fn strands_share_the_hairs_of_a_head() {
        let (groom, warnings) = groom((0..1000).map(|_| strand()).collect());
        let first = &groom.strands[0];
        assert_eq!(first.name, "0001");
        assert!((first.linear_density_kg_per_m - 5.080e-4).abs() < 1e-7);
        assert!((first.lock_width_m - 70e-6 * libm::sqrt(100.0 / 0.07)).abs() < 1e-9);
        assert!((first.bending_stiffness_n_m2 - 4.479e-7).abs() < 1e-10);
        assert_eq!(first.length_m, 0.1);
        assert_eq!(groom.assumed.len(), 4);
        assert_eq!(groom.assumed[0].what, "linear_density_kg_per_m of 1000 of 1000 strands");
        assert_eq!(groom.assumed[0].value, "5.080e-4 kg/m");
        assert!(warnings.is_empty());
    }

    #[test]
    fn what_is_given_gives_the_rest() {
        let by_mass = RawStrand { linear_density_kg_per_m: Some(2.54e-3), ..strand() };
        let by_width = RawStrand { lock_width_m: Some(width_of_hairs(500.0)), ..strand() };
        let drawn = RawStrand { drawn_width: Some(width_of_hairs(500.0)), ..strand() };
        let (groom, _) = groom(vec![by_mass, by_width, drawn]);
        for strand in &groom.strands {
            assert!((strand.linear_density_kg_per_m / 2.54e-3 - 1.0).abs() < 1e-3);
            assert!((strand.lock_width_m / width_of_hairs(500.0) - 1.0).abs() < 1e-3);
            assert!((strand.bending_stiffness_n_m2 / (500.0 * hair_stiffness()) - 1.0).abs() < 1e-3);
        }
        let what: Vec<&str> = groom.assumed.iter().map(|a| a.what.as_str()).collect();
        let expected = [
            "linear_density_kg_per_m of 2 of 3 strands",
            "lock_width_m of 1 of 3 strands",
            "lock_width_m of 1 of 3 strands",
            "bending_stiffness_N_m2 of 3 of 3 strands",
            "internal_damping_time_s of 3 of 3 strands",
        ];
        assert_eq!(what, expected);
    }

    #[test]
    fn a_strand_is_one_hair_at_least() {
        let thin = RawStrand { drawn_width: Some(60e-6), ..strand() };
        let (groom, _) = groom(vec![thin]);
        assert_eq!(groom.strands[0].lock_width_m, 60e-6);
        assert_eq!(groom.strands[0].linear_density_kg_per_m, hair_linear_density());
    }

    #[test]
    fn what_cannot_be_is_said() {
        let short = RawStrand { length: Some(0.09), ..strand() };
        let thick = RawStrand { drawn_width: Some(1.0), ..strand() };
        let none = RawStrand { drawn_width: Some(f64::NAN), ..strand() };
        let (groom, warnings) = groom(vec![short, thick, none]);
        assert_eq!(groom.strands[0].length_m, 0.09, "what is given holds");
        assert_eq!(warnings.len(), 2, "{warnings:?}");
        assert!(warnings[1].starts_with("2 strands are drawn"), "{warnings:?}");
    }
}
