//! How markers move from frame to frame, as the capture itself shows it.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use tousle_core::{Track, Vec3, median_high};

/// Degrees of freedom of the tails: hair is whipped and caught, so jumps of many times the usual occur.
const TAIL: f64 = 3.0;

/// How well the end of one piece of motion meets the beginning of another.
#[derive(Debug)]
pub(crate) struct Continuity<'a> {
    /// The tracks the scale is taken from, one a marker, as they came.
    tracks: &'a [Track],
    /// White noise of a coordinate, m: nothing is smoother than that.
    noise_m: f64,
    /// By marker, what was asked for: by frames from an end to the other.
    scales: Vec<Mutex<BTreeMap<usize, f64>>>,
}

impl<'a> Continuity<'a> {
    pub(crate) fn new(tracks: &'a [Track], noise_m: f64) -> Self {
        Self { tracks, noise_m, scales: tracks.iter().map(|_| Mutex::default()).collect() }
    }

    /// Negative log likelihood that `after`, first seen at `end`, goes on where `before`, last seen at
    /// `start`, stopped; `marker` lends the scale. `None` if either is not seen.
    pub(crate) fn cost(
        &self,
        marker: usize,
        before: &Track,
        after: &Track,
        ends: (usize, usize),
    ) -> Option<f64> {
        let miss = mismatch(before, after, ends)?;
        let scale = self.scale(marker, ends.1 - ends.0);
        let tails = (TAIL + 3.0) / 2.0 * libm::log1p(miss.norm_squared() / (TAIL * scale * scale));
        Some(tails + 3.0 * libm::log(scale))
    }

    /// How far apart, in units of the usual, the two ends are.
    pub(crate) fn surprise(&self, marker: usize, track: &Track, ends: (usize, usize)) -> Option<f64> {
        Some(mismatch(track, track, ends)?.norm() / self.scale(marker, ends.1 - ends.0))
    }

    /// Scale of the mismatch per coordinate over `n_frames`, m: such that two thirds of this marker's own are
    /// within it. A swapped label here and there does not move that.
    fn scale(&self, marker: usize, n_frames: usize) -> f64 {
        let mut scales = self.scales[marker].lock().unwrap_or_else(PoisonError::into_inner);
        *scales.entry(n_frames).or_insert_with(|| {
            let track = &self.tracks[marker];
            let starts = 0..track.n_frames().saturating_sub(n_frames);
            let mut misses: Vec<f64> =
                starts.filter_map(|f| Some(mismatch(track, track, (f, f + n_frames))?.norm())).collect();
            let at = misses.len() * 68 / 100;
            // |x| of three coordinates at scale 1 has its 68 % point at 1.87.
            let usual =
                (!misses.is_empty()).then(|| *misses.select_nth_unstable_by(at, f64::total_cmp).1 / 1.87);
            // Never smoother than noise; a marker never seen that long apart is judged by its whole wander.
            usual.unwrap_or_else(|| self.wander(marker)).max(self.noise_m).max(1e-6)
        })
    }

    fn wander(&self, marker: usize) -> f64 {
        let track = &self.tracks[marker];
        let Some(mean) = track.mean() else { return 1.0 };
        let squares: f64 = track.iter().flatten().map(|p| (p - mean).norm_squared()).sum();
        (squares / (3 * track.n_valid()) as f64).sqrt()
    }
}

/// The least that [`Continuity::cost`] of two ends can be, whatever the scale: that at √3 times smaller a scale than they are apart.
/// `None` if either is not seen.
pub(crate) fn least_cost(before: &Track, after: &Track, ends: (usize, usize)) -> Option<f64> {
    let scale = mismatch(before, after, ends)?.norm() / 3f64.sqrt();
    Some((TAIL + 3.0) / 2.0 * libm::log1p(3.0 / TAIL) + 3.0 * libm::log(scale))
}

/// Both ends carried on to the middle of what lies between, at the velocity each has: the distance there, m.
fn mismatch(before: &Track, after: &Track, (start, end): (usize, usize)) -> Option<Vec3> {
    let half = (end.checked_sub(start)?) as f64 / 2.0;
    let left = before.at(start)? + half * velocity_before(before, start);
    let right = after.at(end)? - half * velocity_after(after, end);
    Some(right - left)
}

/// Velocity at the last frame of a piece, m a frame, from at most two frames back; 0 for a single frame.
pub(crate) fn velocity_before(track: &Track, frame: usize) -> Vec3 {
    let one = |n: usize| Some((track.at(frame)? - track.at(frame.checked_sub(n)?)?) / n as f64);
    one(1).map_or(Vec3::zeros(), |v| one(2).unwrap_or(v))
}

/// Velocity at the first frame of a piece, m a frame, from at most two frames on; 0 for a single frame.
pub(crate) fn velocity_after(track: &Track, frame: usize) -> Vec3 {
    let one = |n: usize| Some((track.at(frame + n)? - track.at(frame)?) / n as f64);
    one(1).map_or(Vec3::zeros(), |v| one(2).unwrap_or(v))
}

/// White noise of one coordinate, m: third differences over the still frames (or all), by their median.
///
/// Third differences of white noise have √20 times its deviation, and slow motion has none. `None` below 8.
pub(crate) fn white_noise(track: &Track, still: Option<(usize, usize)>) -> Option<f64> {
    let (first, last) = still.unwrap_or((0, track.n_frames().saturating_sub(1)));
    let third = |f: usize| {
        let p = |n: usize| track.at(f + n).filter(|_| f + n <= last);
        Some(p(3)? - 3.0 * p(2)? + 3.0 * p(1)? - p(0)?)
    };
    let sizes: Vec<f64> =
        (first..=last).filter_map(third).flat_map(|d| [d.x.abs(), d.y.abs(), d.z.abs()]).collect();
    if sizes.len() < 24 {
        return None;
    }
    Some(1.4826 * median_high(sizes)? / 20f64.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line() -> Track {
        (0..40).map(|f| Some(Vec3::new(0.001 * f64::from(f), 0.0, 0.0))).collect()
    }

    #[test]
    fn uniform_motion_meets_itself_across_a_gap() {
        let miss = mismatch(&line(), &line(), (10, 17)).unwrap();
        assert!(miss.norm() < 1e-15);
    }

    #[test]
    fn no_scale_makes_it_cheaper() {
        let mut jumped = line();
        (20..40).for_each(|f| jumped.set(f, line().at(f).map(|p| p + Vec3::new(0.0, 0.01, 0.0))));
        let least = least_cost(&line(), &jumped, (19, 20)).unwrap();
        let cost =
            |noise_m: f64| Continuity::new(&[line()], noise_m).cost(0, &line(), &jumped, (19, 20)).unwrap();
        assert!((cost(0.01 / 3f64.sqrt()) - least).abs() < 1e-9);
        assert!([1e-5, 1e-3, 5e-3, 6e-3, 0.1].into_iter().all(|noise_m| cost(noise_m) > least));
    }

    #[test]
    fn a_jump_of_a_centimeter_surprises() {
        let mut jumped = line();
        for f in 20..40 {
            jumped.set(f, line().at(f).map(|p| p + Vec3::new(0.0, 0.01, 0.0)));
        }
        let tracks = [line()];
        let continuity = Continuity::new(&tracks, 1e-4);
        assert!(continuity.surprise(0, &jumped, (19, 20)).unwrap() > 50.0);
        assert!(continuity.surprise(0, &jumped, (24, 25)).unwrap() < 1e-6);
    }
}
