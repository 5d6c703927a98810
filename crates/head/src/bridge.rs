//! Poses of frames in which the head was not seen, told from those around them, and how far that can be trusted: gaps as
//! long are pretended where the head was seen.

use crate::smooth::distance2;
use nalgebra::{Cholesky, SMatrix, SVector, UnitQuaternion};
use std::collections::BTreeMap;
use std::ops::Range;
use tousle_core::{Pose, Vec3, runs};

/// Frames without a pose between two that have one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bridge {
    pub(crate) frames: Range<usize>,
    pub(crate) poses: Vec<Pose>,
    /// How far off hair is seen from them (root mean square over pretended gaps), m; infinite if none could be pretended.
    pub(crate) expected_error_m: f64,
}

/// A curve that is laid through the poses on both sides of a gap.
#[derive(Clone, Copy, Debug)]
struct Curve {
    degree: usize,
    /// How many seconds of poses on either side it goes by.
    reach_secs: f64,
}

/// The most coefficients of a curve.
const MOST_COEFFICIENTS: usize = 6;

/// Curves to choose from. The first is for a gap with nothing to try it on: three poses on either side, and no more bends than
/// a nod has.
const CURVES: [Curve; 5] = [
    Curve { degree: 2, reach_secs: 0.0 },
    Curve { degree: 3, reach_secs: 0.05 },
    Curve { degree: 3, reach_secs: 0.1 },
    Curve { degree: 5, reach_secs: 0.1 },
    Curve { degree: 5, reach_secs: 0.2 },
];

/// How long before and after a gap others are pretended, s: a head that nods now may have been still before.
const PRETENDED_WITHIN_SECS: f64 = 1.0;

/// How many gaps are pretended at most.
const PRETENDED: usize = 40;

/// Bridges all gaps between the first and the last pose. `known`: frames with a pose, in order.
pub(crate) fn bridges(known: &[(usize, Pose)], rate_hz: f64) -> Vec<Bridge> {
    let Some((last, _)) = known.last() else { return Vec::new() };
    let mut has_pose = vec![false; last + 1];
    known.iter().for_each(|(frame, _)| has_pose[*frame] = true);
    let gaps = runs(last + 1, |frame| !has_pose[frame]);
    // Gaps as long in the same second have the same trials: a capture may miss every other frame for minutes.
    let mut tried: BTreeMap<(usize, usize), (Curve, f64)> = BTreeMap::new();
    let mut bridge = |gap: Range<usize>| {
        let second = (gap.start as f64 / rate_hz) as usize;
        let (curve, expected_error_m) =
            *tried.entry((second, gap.len())).or_insert_with(|| best_curve(known, &has_pose, &gap, rate_hz));
        let poses = foretold(known, &gap, curve, rate_hz);
        Bridge { frames: gap, poses, expected_error_m }
    };
    gaps.into_iter().filter(|gap| gap.start > 0).map(&mut bridge).collect()
}

/// The curve that bridges pretended gaps best, and how far off it is there, m.
fn best_curve(known: &[(usize, Pose)], has_pose: &[bool], gap: &Range<usize>, rate_hz: f64) -> (Curve, f64) {
    let trials = pretended(has_pose, gap, rate_hz);
    let errors = CURVES.map(|curve| error_m(known, &trials, curve, rate_hz).unwrap_or(f64::INFINITY));
    let best = (0..CURVES.len()).min_by(|&a, &b| errors[a].total_cmp(&errors[b])).unwrap_or(0);
    (CURVES[best], errors[best])
}

/// Gaps of the same length in which the head was seen, near in time.
fn pretended(has_pose: &[bool], gap: &Range<usize>, rate_hz: f64) -> Vec<Range<usize>> {
    let near = (PRETENDED_WITHIN_SECS * rate_hz) as usize;
    // As the gap itself, each has a pose before it.
    let first = has_pose.iter().position(|has| *has).map_or(has_pose.len(), |first| first + 1);
    let starts = gap.start.saturating_sub(near + gap.len()).max(first)..=gap.end + near;
    let all: Vec<_> = starts
        .map(|start| start..start + gap.len())
        .filter(|pretended| {
            pretended.end < has_pose.len() && has_pose[pretended.clone()].iter().all(|has| *has)
        })
        .collect();
    let stride = all.len() / PRETENDED + 1;
    all.into_iter().step_by(stride).collect()
}

/// How far a curve is off in gaps that are pretended, m; `None` if there is none.
fn error_m(known: &[(usize, Pose)], trials: &[Range<usize>], curve: Curve, rate_hz: f64) -> Option<f64> {
    let (mut sum2, mut n) = (0.0, 0);
    for trial in trials {
        let poses = foretold(known, trial, curve, rate_hz);
        let from = known.partition_point(|(frame, _)| *frame < trial.start);
        for (pose, (_, seen)) in poses.iter().zip(&known[from..]) {
            sum2 += distance2(pose, seen);
            n += 1;
        }
    }
    (n > 0).then(|| (sum2 / f64::from(n)).sqrt())
}

/// The poses of a gap by a curve: least squares over the poses in its reach on either side, three at least. Position, and
/// rotation vector about the pose before.
fn foretold(known: &[(usize, Pose)], gap: &Range<usize>, curve: Curve, rate_hz: f64) -> Vec<Pose> {
    let n_side = ((curve.reach_secs * rate_hz).round() as usize).max(3);
    let before = known.partition_point(|(frame, _)| *frame < gap.start);
    let after = known.partition_point(|(frame, _)| *frame < gap.end);
    let sides = known[before.saturating_sub(n_side)..before].iter().chain(known[after..].iter().take(n_side));
    let sides: Vec<&(usize, Pose)> = sides.collect();
    let base = known[before.saturating_sub(1)].1.rotation;
    let middle = (gap.start + gap.end - 1) as f64 / 2.0;
    let half = sides.iter().map(|(frame, _)| (*frame as f64 - middle).abs()).fold(1.0, f64::max);
    let n = (curve.degree + 1).min(sides.len());
    let powers = |frame: usize| powers((frame as f64 - middle) / half, n);
    let mut normal = SMatrix::<f64, MOST_COEFFICIENTS, MOST_COEFFICIENTS>::identity();
    normal.view_mut((0, 0), (n, n)).fill(0.0);
    let mut right = SMatrix::<f64, MOST_COEFFICIENTS, 6>::zeros();
    for (frame, pose) in sides {
        let powers = powers(*frame);
        let turn = (base.inverse() * pose.rotation).scaled_axis();
        let (p, r) = (pose.translation.vector, turn);
        normal += powers * powers.transpose();
        right += powers * SVector::<f64, 6>::new(p.x, p.y, p.z, r.x, r.y, r.z).transpose();
    }
    let Some(factor) = Cholesky::new(normal) else { return vec![known[after].1; gap.len()] };
    let coefficients = factor.solve(&right);
    let pose = |frame: usize| {
        let v = coefficients.transpose() * powers(frame);
        let turn = UnitQuaternion::from_scaled_axis(Vec3::new(v[3], v[4], v[5]));
        Pose::from_parts(Vec3::new(v[0], v[1], v[2]).into(), base * turn)
    };
    gap.clone().map(pose).collect()
}

/// The first `n` powers of a number, from 0 on.
fn powers(x: f64, n: usize) -> SVector<f64, MOST_COEFFICIENTS> {
    let mut power = 1.0;
    SVector::from_fn(|k, _| {
        let this = power;
        power *= x;
        if k < n { this } else { 0.0 }
    })
}
