//! Samples that leave the motion and come back to it.

use std::ops::Range;
use tousle_core::Track;

/// Frames on either side whose own heights a spike is compared with.
const NEARBY: usize = 10;

/// An outlier of one track.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spike {
    pub frames: Range<usize>,
    pub height_m: f64,
    /// How many times the greatest height nearby.
    pub ratio: f64,
}

/// Cuts out what stands `least_ratio` times higher than anything nearby, of at most `longest` frames.
///
/// Height is how far samples lie from *both* lines that the motion before and after draws through them; at the
/// kink of a lock that hits something one of the two lines holds, so that its height is nil.
pub(crate) fn cut_spikes(track: &mut Track, noise_m: f64, longest: usize, least_ratio: f64) -> Vec<Spike> {
    let mut spikes = Vec::new();
    for n in 1..=longest {
        for start in 2..track.n_frames().saturating_sub(n + 1) {
            let Some(spike) = spike(track, start..start + n, noise_m).filter(|s| s.ratio > least_ratio)
            else {
                continue;
            };
            for f in spike.frames.clone() {
                track.set(f, None);
            }
            spikes.push(spike);
        }
    }
    spikes.sort_by_key(|s| s.frames.start);
    spikes
}

fn spike(track: &Track, frames: Range<usize>, noise_m: f64) -> Option<Spike> {
    let n = frames.len();
    let height_m = height(track, frames.clone())?;
    // A line through two samples, carried on by n frames, has about (1 + n) times their noise.
    let floor_m = noise_m * (1 + n) as f64;
    if height_m <= floor_m {
        return None;
    }
    let first = frames.start.saturating_sub(NEARBY + n);
    let apart = |s: &usize| s + n + 2 <= frames.start || *s >= frames.end + 2;
    let nearby: Vec<f64> =
        (first..frames.end + NEARBY).filter(apart).filter_map(|s| reach(track, s..s + n)).collect();
    if nearby.len() < NEARBY {
        return None;
    }
    let ratio = height_m / nearby.into_iter().fold(floor_m, f64::max);
    Some(Spike { frames, height_m, ratio })
}

/// The least distance of any of the samples from either line, m; 0 if they lie between the lines, or if the
/// lines do not meet.
fn height(track: &Track, frames: Range<usize>) -> Option<f64> {
    let mut least = f64::INFINITY;
    for f in frames.clone() {
        let (left, right) = distances(track, &frames, f)?;
        let apart = (left - right).norm();
        let near = left.norm().min(right.norm());
        least = least.min(if left.dot(&right) > 0.0 && apart < near / 2.0 { near } else { 0.0 });
    }
    Some(least)
}

/// The greatest distance of any of the samples from either line, m.
fn reach(track: &Track, frames: Range<usize>) -> Option<f64> {
    let mut most: f64 = 0.0;
    for f in frames.clone() {
        let (left, right) = distances(track, &frames, f)?;
        most = most.max(left.norm().min(right.norm()));
    }
    Some(most)
}

/// From the line through the two samples before `frames`, and from that through the two after, to sample `f`.
fn distances(
    track: &Track,
    frames: &Range<usize>,
    f: usize,
) -> Option<(tousle_core::Vec3, tousle_core::Vec3)> {
    let p = track.at(f)?;
    let start = frames.start.checked_sub(2)?;
    let (a, b) = (track.at(start)?, track.at(start + 1)?);
    let (c, d) = (track.at(frames.end)?, track.at(frames.end + 1)?);
    let left = b + (b - a) * (f - start - 1) as f64;
    let right = c - (d - c) * (frames.end - f) as f64;
    Some((p - left, p - right))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::Vec3;

    /// A swing of 3 cm at 2 Hz with a kink (a hit) in frame 45.
    fn swing() -> Track {
        let x = |f: i32| 0.03 * libm::sin(f64::from(f) / 120.0 * 12.57) + 4e-3 * f64::from((f - 45).max(0));
        (0..90).map(|f| Some(Vec3::new(x(f), 0.0, 1e-4 * f64::from(f * 7919 % 5)))).collect()
    }

    #[test]
    fn a_hit_is_no_spike_but_a_spike_is() {
        let mut track = swing();
        assert_eq!(cut_spikes(&mut track, 2e-4, 3, 4.0), []);
        for f in [20, 21] {
            track.set(f, swing().at(f).map(|p| p + Vec3::new(0.0, 0.02, 0.0)));
        }
        let spikes = cut_spikes(&mut track, 2e-4, 3, 4.0);
        assert_eq!(spikes.len(), 1);
        assert_eq!(spikes[0].frames, 20..22);
        assert!((spikes[0].height_m - 0.02).abs() < 2e-3);
        assert_eq!(track.n_valid(), 88);
    }
}
