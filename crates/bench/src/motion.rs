//! How far a predicted motion is from the true one.

use crate::stats::{mean, median, percentile};
use serde::Serialize;
use std::ops::Range;
use tousle_core::{StrandMotion, Vec3};

/// Where points on locks really went, head space.
#[derive(Clone, Debug, PartialEq)]
pub struct TrueMotion {
    /// Time of each frame, s.
    pub times_secs: Vec<f64>,
    /// Positions, head space, m: frame after frame, lock after lock, root side first.
    pub positions_m: Vec<[f32; 3]>,
    /// Name and points of each lock.
    pub locks: Vec<(String, usize)>,
    /// Whether the first point of each lock is its root: held by the scalp, so not scored.
    pub starts_at_root: bool,
}

/// How far a predicted motion is from the true one, from [`SCORED_FROM_SECS`] to the end.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MotionScore {
    /// All points but the roots.
    pub points: PointScore,
    /// The last point of each lock.
    pub tips: PointScore,
    /// Lock by lock; `None` if no lock moved.
    pub locks: Option<LockScore>,
    /// Share of predicted samples that were NaN; they count as staying at rest.
    pub missing_fraction: f64,
    /// True frames after the prediction's end; there its last frame is held.
    pub frames_beyond_prediction: usize,
}

/// Errors over a set of points and all scored frames.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PointScore {
    /// Mean distance to the truth, mm.
    pub mean_mm: f64,
    /// The distance that 95 % stay below, mm.
    pub p95_mm: f64,
    /// Root mean square distance to the truth, mm.
    pub rms_mm: f64,
    /// Root mean square of the true displacement from rest, mm.
    pub disp_rms_mm: f64,
    /// 1 − rms error / rms displacement: 0 is as good as never moving, 1 exact.
    pub explained_motion: f64,
    /// The same after each point's own time mean is taken off both: does it swing at the right moments?
    pub explained_fluctuation: f64,
}

/// Explained motion lock by lock, over the locks that moved more than 10 mm rms: one lock that slips off the
/// other side of a shoulder ruins an rms over everything, and cannot spoil a median.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LockScore {
    /// How many locks moved more than 10 mm rms.
    pub moved_over_10mm: usize,
    /// Explained motion of the median lock.
    pub explained_median: f64,
    /// Explained motion that nine locks in ten exceed.
    pub explained_10pct: f64,
    /// Share of locks above 0.5.
    pub share_over_half: f64,
    /// The five worst, worst first.
    pub worst: Vec<(String, f64)>,
}

/// What keeps a motion from being scored.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScoreError {
    /// The prediction is of other locks.
    #[error("lock {lock}: found {found} points in the prediction, expected {expected}")]
    OtherPoints {
        /// Index of the first lock that differs.
        lock: usize,
        /// Points in the prediction; 0 past its last lock.
        found: usize,
        /// Points in the truth; 0 past its last lock.
        expected: usize,
    },
    /// There is no frame to compare.
    #[error("found {what}, expected at least one frame")]
    NoFrames {
        /// Where they lack.
        what: &'static str,
    },
    /// Times must increase.
    #[error("frame {frame} of the prediction is not later than the one before")]
    NotIncreasing {
        /// Index of the frame, from 0.
        frame: usize,
    },
    /// The prediction does not start with the truth.
    #[error("the prediction starts at {found} s, expected 0 s")]
    StartsLate {
        /// Time of its first frame, s.
        found: f64,
    },
}

/// The wind is on from here, and motions are scored from here, s.
pub const SCORED_FROM_SECS: f64 = 1.0;

/// What comes before is rest, s: positions are averaged over it.
const REST_UNTIL_SECS: f64 = 0.9;

/// Displacement above which a lock has a score of its own, m rms. Below it noise is compared with noise.
const MOVED_M: f64 = 0.010;

/// The rate of a prediction of a single frame, which has none of its own, Hz.
const STYLE_B_RATE_HZ: f64 = 60.0;

/// Scores a predicted motion against the true one.
///
/// A rate other than the truth's is resampled linearly from 0 s; a point that is NaN counts as staying at rest.
/// Definitions: `score/score.py` beside the captures; the two agree to rounding.
///
/// # Errors
/// [`ScoreError`] if the points of the two do not match or there is nothing to compare.
pub fn score_motion(predicted: &StrandMotion, truth: &TrueMotion) -> Result<MotionScore, ScoreError> {
    check(predicted, truth)?;
    let rest = truth.rest_m();
    let resampled = resample(predicted, truth, &rest);
    let scored: Vec<usize> =
        (0..truth.times_secs.len()).filter(|&k| truth.times_secs[k] >= SCORED_FROM_SECS).collect();
    if scored.is_empty() {
        return Err(ScoreError::NoFrames { what: "no true frame from 1 s on" });
    }
    let paths = Paths::new(&resampled.positions, truth, &rest, &scored);
    let all: Vec<usize> = truth.ranges().into_iter().flatten().collect();
    let tips: Vec<usize> = truth.ranges().iter().filter_map(|r| r.clone().last()).collect();
    Ok(MotionScore {
        points: paths.point_score(&all),
        tips: paths.point_score(&tips),
        locks: paths.lock_score(truth),
        missing_fraction: resampled.missing_fraction,
        frames_beyond_prediction: resampled.frames_beyond,
    })
}

impl TrueMotion {
    /// Points in each frame.
    pub fn n_points(&self) -> usize {
        self.locks.iter().map(|(_, n)| n).sum()
    }

    /// Every point's mean position while the hair is still, m.
    pub fn rest_m(&self) -> Vec<Vec3> {
        let n = self.n_points();
        let still = self.times_secs.iter().filter(|t| **t < REST_UNTIL_SECS).count();
        let mean_of = |p: usize| (0..still).map(|k| self.at(k, p)).sum::<Vec3>() / still as f64;
        (0..n).map(mean_of).collect()
    }

    fn at(&self, frame: usize, point: usize) -> Vec3 {
        Vec3::from(self.positions_m[frame * self.n_points() + point].map(f64::from))
    }

    /// The scored points of each lock.
    fn ranges(&self) -> Vec<Range<usize>> {
        let mut first = 0;
        let mut ranges = Vec::with_capacity(self.locks.len());
        for (_, n) in &self.locks {
            ranges.push(first + usize::from(self.starts_at_root)..first + n);
            first += n;
        }
        ranges
    }
}

fn check(predicted: &StrandMotion, truth: &TrueMotion) -> Result<(), ScoreError> {
    for lock in 0..predicted.counts.len().max(truth.locks.len()) {
        let found = predicted.counts.get(lock).copied().unwrap_or(0);
        let expected = truth.locks.get(lock).map_or(0, |(_, n)| *n);
        if found != expected {
            return Err(ScoreError::OtherPoints { lock, found, expected });
        }
    }
    let times = &predicted.times_secs;
    let Some(&start) = times.first() else {
        return Err(ScoreError::NoFrames { what: "an empty prediction" });
    };
    if predicted.positions_m.len() != times.len() * predicted.n_points() {
        return Err(ScoreError::NoFrames { what: "frames without positions" });
    }
    if start.is_nan() || start.abs() > 1e-6 {
        return Err(ScoreError::StartsLate { found: start });
    }
    match times.windows(2).position(|pair| pair[0].total_cmp(&pair[1]).is_ge()) {
        Some(frame) => Err(ScoreError::NotIncreasing { frame: frame + 1 }),
        None => Ok(()),
    }
}

/// A prediction at the truth's times.
struct Resampled {
    positions: Vec<Vec3>,
    missing_fraction: f64,
    frames_beyond: usize,
}

fn resample(predicted: &StrandMotion, truth: &TrueMotion, rest: &[Vec3]) -> Resampled {
    let n = rest.len();
    let mut missing = 0usize;
    let filled: Vec<Vec3> = predicted
        .positions_m
        .iter()
        .enumerate()
        .map(|(i, p)| {
            let lost = p.iter().any(|c| c.is_nan());
            missing += usize::from(lost);
            if lost { rest[i % n] } else { Vec3::from(p.map(f64::from)) }
        })
        .collect();
    let last = predicted.times_secs.len() - 1;
    let rate_hz = if last > 0 {
        last as f64 / (predicted.times_secs[last] - predicted.times_secs[0])
    } else {
        STYLE_B_RATE_HZ
    };
    let end_secs = last as f64 / rate_hz;
    let mut positions = Vec::with_capacity(truth.times_secs.len() * n);
    for &time in &truth.times_secs {
        // A frame that is at this very time must be taken whole; a floor of the product can fall just short.
        let mut before = ((time * rate_hz + 1e-9).floor().max(0.0) as usize).min(last);
        while before > 0 && before as f64 / rate_hz > time {
            before -= 1;
        }
        let after = (before + 1).min(last);
        let share = ((time - before as f64 / rate_hz) * rate_hz).clamp(0.0, 1.0);
        for p in 0..n {
            positions.push(filled[before * n + p] * (1.0 - share) + filled[after * n + p] * share);
        }
    }
    Resampled {
        positions,
        missing_fraction: missing as f64 / filled.len().max(1) as f64,
        frames_beyond: truth.times_secs.iter().filter(|t| **t > end_secs + 0.5 / rate_hz).count(),
    }
}

/// Error and true displacement of every point in every scored frame, m.
struct Paths {
    n_points: usize,
    n_frames: usize,
    errors: Vec<Vec3>,
    displacements: Vec<Vec3>,
}

impl Paths {
    fn new(positions: &[Vec3], truth: &TrueMotion, rest: &[Vec3], scored: &[usize]) -> Self {
        let n = rest.len();
        let places = || scored.iter().flat_map(move |&k| (0..n).map(move |p| (k, p)));
        Self {
            n_points: n,
            n_frames: scored.len(),
            errors: places().map(|(k, p)| positions[k * n + p] - truth.at(k, p)).collect(),
            displacements: places().map(|(k, p)| truth.at(k, p) - rest[p]).collect(),
        }
    }

    fn point_score(&self, points: &[usize]) -> PointScore {
        let mut distances_mm: Vec<f64> =
            self.series(&self.errors, points).map(|error| error.norm() * 1e3).collect();
        let (rms, disp_rms) = self.rms_of_both(points);
        let fluctuation = |of: &[Vec3]| {
            let squares = points.iter().map(|&p| {
                let own = || self.series(of, std::slice::from_ref(&p));
                let center = own().sum::<Vec3>() / self.n_frames as f64;
                own().map(|v| (v - center).norm_squared()).sum::<f64>()
            });
            (squares.sum::<f64>() / (points.len() * self.n_frames) as f64).sqrt()
        };
        PointScore {
            mean_mm: mean(&distances_mm),
            p95_mm: percentile(&mut distances_mm, 95.0),
            rms_mm: rms * 1e3,
            disp_rms_mm: disp_rms * 1e3,
            explained_motion: 1.0 - rms / disp_rms,
            explained_fluctuation: 1.0 - fluctuation(&self.errors) / fluctuation(&self.displacements),
        }
    }

    fn lock_score(&self, truth: &TrueMotion) -> Option<LockScore> {
        let mut by_lock = Vec::new();
        for ((name, _), range) in truth.locks.iter().zip(truth.ranges()) {
            let (rms, disp_rms) = self.rms_of_both(&range.collect::<Vec<_>>());
            if disp_rms > MOVED_M {
                by_lock.push((name.clone(), 1.0 - rms / disp_rms));
            }
        }
        let mut explained: Vec<f64> = by_lock.iter().map(|(_, e)| *e).collect();
        by_lock.sort_by(|a, b| a.1.total_cmp(&b.1));
        by_lock.truncate(5);
        (!explained.is_empty()).then(|| LockScore {
            moved_over_10mm: explained.len(),
            explained_median: median(&mut explained),
            explained_10pct: percentile(&mut explained, 10.0),
            share_over_half: explained.iter().filter(|e| **e > 0.5).count() as f64 / explained.len() as f64,
            worst: by_lock,
        })
    }

    fn rms_of_both(&self, points: &[usize]) -> (f64, f64) {
        let rms = |of: &[Vec3]| {
            let sum: f64 = self.series(of, points).map(Vec3::norm_squared).sum();
            (sum / (points.len() * self.n_frames) as f64).sqrt()
        };
        (rms(&self.errors), rms(&self.displacements))
    }

    /// The vectors of these points, frame after frame.
    fn series<'a>(&self, of: &'a [Vec3], points: &'a [usize]) -> impl Iterator<Item = &'a Vec3> {
        let n = self.n_points;
        (0..self.n_frames).flat_map(move |k| points.iter().map(move |p| &of[k * n + p]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One lock of root and tip at 10 Hz; from 1.0 s on the tip is 30 mm off its rest, in x, then in −x, ...
    fn truth() -> TrueMotion {
        let times_secs: Vec<f64> = (0..14).map(|k| f64::from(k) / 10.0).collect();
        let mut positions_m = Vec::new();
        for k in 0..14 {
            let x = if k < 10 { 0.0 } else { 0.03 * (1 - 2 * (k % 2)) as f32 };
            positions_m.extend([[0.0; 3], [x, 0.0, -0.1]]);
        }
        TrueMotion { times_secs, positions_m, locks: vec![("A".into(), 2)], starts_at_root: true }
    }

    fn prediction(change: impl Fn(usize, &mut [f32; 3])) -> StrandMotion {
        let truth = truth();
        let mut positions_m = truth.positions_m;
        for k in 0..14 {
            change(k, &mut positions_m[2 * k + 1]);
        }
        StrandMotion { counts: vec![2], times_secs: truth.times_secs, positions_m }
    }

    #[test]
    fn exact_is_one_and_never_moving_is_zero() {
        let exact = score_motion(&prediction(|_, _| {}), &truth()).unwrap();
        assert_eq!(exact.points.mean_mm, 0.0);
        assert_eq!(exact.points.explained_motion, 1.0);
        let still = score_motion(&prediction(|_, p| p[0] = 0.0), &truth()).unwrap();
        assert!((still.tips.rms_mm - 30.0).abs() < 1e-5);
        assert!(still.points.explained_motion.abs() < 1e-12);
        assert!(still.points.explained_fluctuation.abs() < 1e-12);
        assert_eq!(still.locks.unwrap().moved_over_10mm, 1);
    }

    /// 15 mm too far in y all the time: half the displacement is lost, none of the fluctuation.
    #[test]
    fn a_constant_error_costs_no_fluctuation() {
        let score = score_motion(&prediction(|_, p| p[1] = 0.015), &truth()).unwrap();
        assert!((score.points.explained_motion - 0.5).abs() < 1e-6);
        assert!((score.points.explained_fluctuation - 1.0).abs() < 1e-6);
        assert!((score.points.p95_mm - 15.0).abs() < 1e-5);
    }

    #[test]
    fn what_is_missing_counts_as_rest_and_is_said() {
        let score = score_motion(&prediction(|k, p| p[2] = if k == 12 { f32::NAN } else { p[2] }), &truth());
        let score = score.unwrap();
        assert!((score.missing_fraction - 1.0 / 28.0).abs() < 1e-12);
        assert!((score.points.mean_mm - 30.0 / 4.0).abs() < 1e-5);
    }

    #[test]
    fn a_prediction_that_ends_early_is_held_and_said() {
        let mut short = prediction(|_, _| {});
        short.times_secs.truncate(12);
        short.positions_m.truncate(24);
        let score = score_motion(&short, &truth()).unwrap();
        assert_eq!(score.frames_beyond_prediction, 2);
        // Held at −30 mm, true at +30 and −30 mm.
        assert!((score.points.mean_mm - 60.0 / 4.0).abs() < 1e-4);
    }

    #[test]
    fn another_rate_is_linear_between_its_frames() {
        let coarse = StrandMotion {
            counts: vec![2],
            times_secs: vec![0.0, 2.0],
            positions_m: vec![[0.0; 3], [0.0, 0.0, -0.1], [0.0; 3], [0.2, 0.0, -0.1]],
        };
        // At 1.0, 1.1, 1.2, 1.3 s: 100, 110, 120, 130 mm against 30, −30, 30, −30 mm.
        let score = score_motion(&coarse, &truth()).unwrap();
        assert!((score.points.mean_mm - (70.0 + 140.0 + 90.0 + 160.0) / 4.0).abs() < 1e-4);
    }

    #[test]
    fn other_points_are_refused() {
        let mut other = prediction(|_, _| {});
        other.counts = vec![1, 1];
        let error = score_motion(&other, &truth()).unwrap_err();
        assert_eq!(error.to_string(), "lock 0: found 1 points in the prediction, expected 2");
    }
}
