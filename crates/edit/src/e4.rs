//! E4: the extra force that carries a control point from where it would be to where it should be.

use crate::{EditError, PaperSpan};
use nalgebra::{Cholesky, DMatrix};
use tousle_core::Vec3;
use tousle_field::{Ease, Handle};

/// What E4 must know besides the places of a control point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pull {
    /// Time between the keys, s.
    pub(crate) span_secs: f64,
    /// How the layer comes and goes between them.
    pub(crate) ease: Ease,
    /// Which time E4 counts.
    pub(crate) span: PaperSpan,
    /// Strength of gravity, m/s².
    pub(crate) gravity: f64,
}

impl Pull {
    /// The extra acceleration of a control point `length_m` along the lock when the layer is fully there, m/s².
    ///
    /// α = 2 (target − current) / s². `current` is where the unedited motion has the point at the second key.
    /// The sign is that of E3, towards the target; as printed it points away. s² is that of [`PaperSpan`], in
    /// which the time between the keys is shortened by as much as the layer takes to come and go
    /// (`docs/equations.md`).
    pub(crate) fn acceleration(&self, current_m: Vec3, target_m: Vec3, length_m: f64) -> Vec3 {
        let between_keys = self.span_secs * self.span_secs * gain(self.ease);
        // The root does not move: 0 of 0 must be none.
        let swings = self.span == PaperSpan::FreeFall && length_m * self.gravity > 0.0;
        let free_fall = if swings { 2.0 * length_m / self.gravity } else { f64::INFINITY };
        2.0 * (target_m - current_m) / f64::min(between_keys, free_fall)
    }
}

/// How far a free particle gets under a force that comes and goes by `ease`, over how far it would get under the
/// full force all the time: 2 ∫ (1 − x) presence(x) dx over the span, from 5/28 to 1.
fn gain(ease: Ease) -> f64 {
    let Ease { rise, fall } = ease;
    1.0 - rise + 2.0 / 7.0 * (rise * rise - fall * fall)
}

/// How much of its way a free particle has made at `n + 1` even times of the span, 0 to 1.
pub(crate) fn progress(ease: Ease, n: usize) -> Vec<f64> {
    const FINE: usize = 16;
    let (mut place, mut speed) = (0.0, 0.0);
    let mut places = vec![0.0];
    for step in 1..=n * FINE {
        speed += ease.presence((step as f64 - 0.5) / (n * FINE) as f64);
        place += speed;
        if step % FINE == 0 {
            places.push(place);
        }
    }
    places.iter().map(|p| p / place).collect()
}

/// A control point's way from the first key to the second, and what is added along it.
#[derive(Clone, Debug)]
pub struct Way {
    /// Its places at even times, m, first key first.
    pub places_m: Vec<Vec3>,
    /// What is added there, in the field's quantity.
    pub extra: Vec3,
}

/// The most handles a layer may have: sampling a layer costs by handle.
const MAX_HANDLES: usize = 512;

/// Distance between neighboring handles, as a share of their reach. Below 0.5 their weights add up to 1 or more
/// between any two of them; if it falls, there are more handles and nothing else.
const SPACING: f64 = 0.4;

/// Handles along the ways of a strand's control points, the dragged one's first, thinned to where they overlap.
///
/// Between two control points what is added is linear. At each handle's center the layer adds what the way asks
/// there, although handles overlap and are averaged.
///
/// # Errors
/// What was found and expected, if the reach is too small for the ways.
pub fn handles(ways: &[Way], dragged: usize, reach_m: f64) -> Result<Vec<Handle>, String> {
    let spacing_m = SPACING * reach_m;
    let mut kept: Vec<Handle> = Vec::new();
    let mut order: Vec<usize> = (0..ways.len()).collect();
    order.sort_by_key(|k| k.abs_diff(dragged));
    for k in order {
        let neighbor = if k < dragged { k + 1 } else { k.saturating_sub(1) };
        let cuts = if k == dragged { 1 } else { cuts_between(&ways[k], &ways[neighbor], spacing_m) };
        for cut in 0..cuts {
            let share = cut as f64 / cuts as f64;
            let extra = ways[k].extra.lerp(&ways[neighbor].extra, share);
            // Both ends of the way before what lies between: beyond an end no neighbor helps.
            let last = ways[k].places_m.len() - 1;
            for instant in [last, 0].into_iter().chain((1..last).rev()) {
                let (place, other) = (ways[k].places_m[instant], ways[neighbor].places_m[instant]);
                let center_m = place.lerp(&other, share);
                if kept.iter().all(|h| (h.center_m - center_m).norm() >= spacing_m) {
                    kept.push(Handle { center_m, reach_m, extra });
                }
                if kept.len() > MAX_HANDLES {
                    return Err(format!(
                        "found a reach of {} mm, too small for the strand's way: it would take over {MAX_HANDLES} \
                         handles, expected a larger one",
                        reach_m * 1e3
                    ));
                }
            }
        }
    }
    interpolate(&mut kept)?;
    Ok(kept)
}

/// Changes the handles' vectors so that the layer, which averages them where they overlap, adds at each center
/// what the vector there was before.
///
/// Without this a tip would be pulled by a quarter less than asked, because all its neighbors are pulled less.
/// The weights between centers of one reach are a positive definite matrix (Wendland 1995), so there is one
/// answer.
fn interpolate(handles: &mut [Handle]) -> Result<(), String> {
    let n = handles.len();
    let weights = DMatrix::from_fn(n, n, |i, j| handles[j].weight(handles[i].center_m));
    let asked =
        DMatrix::from_fn(n, 3, |i, axis| handles[i].extra[axis] * f64::max(weights.row(i).sum(), 1.0));
    let solved =
        Cholesky::new(weights).ok_or("found handles that lie on one another, expected a larger reach")?;
    let extras = solved.solve(&asked);
    for (i, handle) in handles.iter_mut().enumerate() {
        handle.extra = Vec3::new(extras[(i, 0)], extras[(i, 1)], extras[(i, 2)]);
    }
    Ok(())
}

/// Into how many pieces the stick between two control points is cut, so that handles on it overlap.
fn cuts_between(a: &Way, b: &Way, spacing_m: f64) -> usize {
    let longest = a.places_m.iter().zip(&b.places_m).map(|(p, q)| (q - p).norm()).fold(0.0, f64::max);
    pieces(longest, spacing_m)
}

/// How many even pieces of a length are no longer than half the spacing of handles; at most twice as many as
/// there may be handles.
pub(crate) fn pieces(length_m: f64, spacing_m: f64) -> usize {
    ((2.0 * length_m / spacing_m).ceil() as usize).clamp(1, 2 * MAX_HANDLES)
}

/// Into how many even steps of time the ways are cut, so that handles along them overlap.
pub(crate) fn n_instants(longest_way_m: f64, reach_m: f64) -> usize {
    pieces(longest_way_m, SPACING * reach_m)
}

/// Turns a problem into an error of the edit it is about.
pub(crate) fn of_edit(number: usize, name: &str) -> impl Fn(String) -> EditError {
    move |problem| EditError::BadEdit { number, name: name.to_owned(), problem }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::layer;
    use tousle_field::FieldLayer;

    const EASES: [Ease; 4] = [
        Ease { rise: 0.0, fall: 0.0 },
        Ease { rise: 0.5, fall: 0.5 },
        Ease { rise: 0.2, fall: 0.7 },
        Ease { rise: 1.0, fall: 0.0 },
    ];

    fn pull(ease: Ease, span: PaperSpan) -> Pull {
        Pull { span_secs: 0.5, ease, span, gravity: 10.0 }
    }

    /// 0.1 m in 0.5 s from rest takes 0.8 m/s²; with a force that comes and goes by halves, twice that.
    #[test]
    fn a_free_particle_is_where_it_should_be() {
        let target = Vec3::new(0.1, 0.0, 0.0);
        for (ease, expected) in [(EASES[0], 0.8), (EASES[1], 1.6)] {
            let found = pull(ease, PaperSpan::Keys).acceleration(Vec3::zeros(), target, 0.2);
            assert!((found.x - expected).abs() < 1e-12, "{found}");
        }
    }

    /// A pendulum of 0.2 m that leans by 0.1 m is held there by half its weight: 5 of 10 m/s².
    #[test]
    fn a_pendulum_is_held_where_it_should_be() {
        let free_fall = pull(EASES[1], PaperSpan::FreeFall);
        let target = Vec3::new(0.1, 0.0, 0.0);
        assert!((free_fall.acceleration(Vec3::zeros(), target, 0.2).x - 5.0).abs() < 1e-12);
        // A lock so long that it swings slower than the keys follow one another is thrown there, not held.
        assert!((free_fall.acceleration(Vec3::zeros(), target, 2.0).x - 1.6).abs() < 1e-12);
        assert_eq!(free_fall.acceleration(Vec3::zeros(), Vec3::zeros(), 0.0), Vec3::zeros());
    }

    /// The layer's own presence, integrated twice, against the closed form of the gain.
    #[test]
    fn the_gain_is_what_the_presence_gives() {
        for ease in EASES {
            let n = 100_000;
            let dt = 1.0 / f64::from(n);
            let (mut place, mut speed) = (0.0, 0.0);
            for k in 0..n {
                place += speed * dt;
                speed += ease.presence((f64::from(k) + 0.5) * dt) * dt;
            }
            assert!((2.0 * place - gain(ease)).abs() < 1e-4, "{ease:?}: {} {}", 2.0 * place, gain(ease));
        }
    }

    #[test]
    fn progress_runs_from_0_to_1() {
        for ease in EASES {
            let progress = progress(ease, 10);
            assert_eq!((progress.len(), progress[0], progress[10]), (11, 0.0, 1.0));
            assert!(progress.is_sorted());
        }
        // Under a constant force, by the square of time.
        assert!((progress(EASES[0], 10)[5] - 0.25).abs() < 0.01);
    }

    /// A strand of 200 mm along x whose tip half is pulled up by 1 and whose root not at all.
    fn ways() -> Vec<Way> {
        let way = |k: u8| Way {
            places_m: (0..=20)
                .map(|i| Vec3::new(0.05 * f64::from(k), 0.0, 0.001 * f64::from(i * k)))
                .collect(),
            extra: Vec3::z() * f64::from(k) / 4.0,
        };
        (0..5).map(way).collect()
    }

    #[test]
    fn handles_cover_the_way_and_the_dragged_point_comes_first() {
        let ways = ways();
        let handles = handles(&ways, 4, 0.06).unwrap();
        assert_eq!(handles[0].center_m, ways[4].places_m[20]);
        let layer = FieldLayer { handles, ease: EASES[0], ..layer("1") };
        for way in &ways {
            for place in &way.places_m {
                let extra = layer.extra_at(*place);
                assert!((extra - way.extra).norm() < 0.05, "{place}: {extra} for {}", way.extra);
            }
        }
        assert!((layer.extra_at(ways[4].places_m[20]) - Vec3::z()).norm() < 1e-12);
        assert_eq!(layer.extra_at(Vec3::new(0.2, 0.1, 0.0)), Vec3::zeros());
    }

    #[test]
    fn a_reach_too_small_for_the_way_is_refused() {
        let way =
            Way { places_m: (0..=1000).map(|i| Vec3::x() * f64::from(i) * 0.01).collect(), extra: Vec3::z() };
        assert!(handles(&[way], 0, 0.005).unwrap_err().starts_with("found a reach of 5 mm"));
    }
}
