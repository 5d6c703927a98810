//! How violently strands move, and how violently they must.

use tousle_core::{StrandMotion, Vec3};
use tousle_edit::{FoundKey, peak_acceleration, peak_jerk};

/// Peaks of a motion, or ratios of such.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Peaks {
    /// m/s².
    pub(super) acceleration: f64,
    /// m/s³.
    pub(super) jerk: f64,
}

impl Peaks {
    /// Those of a motion's first strand.
    pub(super) fn of(motion: &StrandMotion) -> Self {
        Self { acceleration: peak_acceleration(motion, 0), jerk: peak_jerk(motion, 0) }
    }

    /// Those of the way of least jerk to a key from where the point would be without the drag, from rest to rest (Flash and
    /// Hogan 1985): a distance d in a time t takes an acceleration of 5.77 d / t² and a jerk of 60 d / t³.
    pub(super) fn smooth(key: &FoundKey, first_secs: f64) -> Self {
        let (distance_m, secs) = ((key.target_m - key.unedited_m).norm().max(1e-3), key.secs - first_secs);
        let per2 = distance_m / (secs * secs);
        Self { acceleration: 5.77 * per2, jerk: 60.0 * per2 / secs }
    }

    /// The ratio to others.
    pub(super) fn over(self, others: Self) -> Self {
        Self {
            acceleration: self.acceleration / others.acceleration.max(1e-9),
            jerk: self.jerk / others.jerk.max(1e-9),
        }
    }

    /// The larger of each.
    pub(super) fn or(self, other: Self) -> Self {
        Self {
            acceleration: f64::max(self.acceleration, other.acceleration),
            jerk: f64::max(self.jerk, other.jerk),
        }
    }

    /// So many times these.
    pub(super) fn times(self, times: f64) -> Self {
        Self { acceleration: self.acceleration * times, jerk: self.jerk * times }
    }

    /// The larger of the two, of ratios.
    pub(super) fn largest(self) -> f64 {
        f64::max(self.acceleration, self.jerk)
    }
}

/// The least peaks with which a point can get from where it is at a frame to within a tolerance of its key, whatever
/// pulls it: those of an acceleration, or a jerk, that is the same all the way. Nothing if the motion has just begun.
///
/// Where frames are dt apart, n after one that is known with the two before it the point is at
///
/// ```text
/// x0 + n (x0 − x₋₁) + Σ (n + 1 − k) aₖ dt²,   or with the last known difference δ² besides
/// x0 + n (x0 − x₋₁) + ½ n (n + 1) δ² + Σ ½ (n + 1 − k) (n + 2 − k) jₖ dt³
/// ```
///
/// so for what is missing without the sums some aₖ must be at least that over their weights' sum, ½ n (n + 1), and some
/// jₖ over n (n + 1) (n + 2) / 6. These are differences of frames, as [`peak_acceleration`] and [`peak_jerk`] take them.
pub(super) fn least_peaks(unedited: &StrandMotion, frame: usize, key: &FoundKey, tolerance_m: f64) -> Peaks {
    if frame < 2 || frame + 1 >= unedited.times_secs.len() {
        return Peaks::default();
    }
    let at = |frame: usize| Vec3::from(unedited.strand(frame, 0)[key.control_point].map(f64::from));
    let speed = at(frame) - at(frame - 1);
    let bend = speed - (at(frame - 1) - at(frame - 2));
    let dt_secs = unedited.times_secs[frame + 1] - unedited.times_secs[frame];
    let n = (key.secs - unedited.times_secs[frame]) / dt_secs;
    // Between two frames a place is linear, and so is all the rest.
    let (whole, share) = (n.floor(), n - n.floor());
    let mixed = |of: &dyn Fn(f64) -> f64| of(whole) * (1.0 - share) + of(whole + 1.0) * share;
    let pairs = mixed(&|n| 0.5 * n * (n + 1.0));
    let triples = mixed(&|n| n * (n + 1.0) * (n + 2.0) / 6.0);
    let least = |foretold: Vec3, weights: f64| {
        let missing_m = (key.target_m - foretold).norm() - tolerance_m;
        if weights > 0.0 { f64::max(missing_m, 0.0) / weights } else { 0.0 }
    };
    let straight = at(frame) + speed * n;
    Peaks {
        acceleration: least(straight, pairs) / (dt_secs * dt_secs),
        jerk: least(straight + bend * pairs, triples) / (dt_secs * dt_secs * dt_secs),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tip that goes by `way`, at 10 Hz.
    fn motion(way: impl Fn(f64) -> f64) -> StrandMotion {
        let frame = |k: i32| [[0.0; 3], [way(f64::from(k)) as f32, 0.0, 0.0]];
        StrandMotion {
            counts: vec![2],
            times_secs: (0..21).map(|k| f64::from(k) / 10.0).collect(),
            positions_m: (0..21).flat_map(frame).collect(),
        }
    }

    fn key(secs: f64, target_m: f64) -> FoundKey {
        let target_m = Vec3::new(target_m, 0.0, 0.0);
        FoundKey { strand_idx: 0, control_point: 1, secs, target_m, unedited_m: Vec3::zeros() }
    }

    /// Still at first, then pulled all the same: such a motion's own peaks are the least that lead to where it gets.
    #[test]
    fn an_even_pull_is_the_least() {
        let still = motion(|_| 0.0);
        for frames in [3, 8] {
            let n = f64::from(frames);
            let pulled = motion(|k| 1e-3 * (k - 10.0).max(0.0) * (k - 9.0).max(0.0));
            let least = least_peaks(&still, 10, &key(1.0 + 0.1 * n, 1e-3 * n * (n + 1.0)), 0.0);
            assert!((least.acceleration / Peaks::of(&pulled).acceleration - 1.0).abs() < 1e-3, "{least:?}");
            let jerked = motion(|k| 1e-3 * ((k - 10.0) * (k - 9.0) * (k - 8.0)).max(0.0));
            let least = least_peaks(&still, 10, &key(1.0 + 0.1 * n, 1e-3 * n * (n + 1.0) * (n + 2.0)), 0.0);
            let to_there =
                StrandMotion { times_secs: jerked.times_secs[..11 + frames as usize].to_vec(), ..jerked };
            assert!((least.jerk / Peaks::of(&to_there).jerk - 1.0).abs() < 1e-3, "{least:?}");
        }
    }

    #[test]
    fn a_key_on_the_way_demands_nothing() {
        let moving = motion(|k| 0.01 * k);
        let least = least_peaks(&moving, 10, &key(1.55, 0.155), 1e-6);
        assert!(least.largest() < 1e-9, "{least:?}");
    }
}
