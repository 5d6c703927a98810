//! A cubic curve: points evenly along it.
//!
//! Source: `UsdGeomBasisCurves` for how control points make segments, and for what `pinned` means.

use tousle_core::Vec3;

/// How four control points make a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Basis {
    Bezier,
    Bspline,
    CatmullRom,
}

/// Positions at which a segment is looked at to measure its length. At 16 a bend of 90 degrees over one segment is
/// 0.2 % too short, and points are that little off from even.
const PARTS: usize = 16;

/// `n` points evenly along the curve, from its start to its end. `None` if the control points make no segment.
pub(super) fn evenly(basis: Basis, pinned: bool, control: &[Vec3], n: usize) -> Option<Vec<Vec3>> {
    let control = if pinned { with_phantoms(basis, control)? } else { control.to_vec() };
    let step = if basis == Basis::Bezier { 3 } else { 1 };
    if control.len() < 4 || (control.len() - 4) % step != 0 || n < 2 {
        return None;
    }
    let mut along = Vec::new();
    for segment in control.windows(4).step_by(step) {
        along.extend((0..PARTS).map(|k| at(basis, segment, k as f64 / PARTS as f64)));
    }
    along.push(at(basis, &control[control.len() - 4..], 1.0));
    Some(resample(&along, n))
}

/// Control points with one more at each end, which make the curve run from the first to the last.
fn with_phantoms(basis: Basis, control: &[Vec3]) -> Option<Vec<Vec3>> {
    if basis == Basis::Bezier {
        return Some(control.to_vec());
    }
    let [a, b, ..] = control else { return None };
    let [.., y, z] = control else { return None };
    let mut all = vec![2.0 * a - b];
    all.extend(control);
    all.push(2.0 * z - y);
    Some(all)
}

/// The segment's point at share `t`.
fn at(basis: Basis, p: &[Vec3], t: f64) -> Vec3 {
    let (t2, t3) = (t * t, t * t * t);
    let r = 1.0 - t;
    let weights = match basis {
        Basis::Bezier => [r * r * r, 3.0 * t * r * r, 3.0 * t2 * r, t3],
        Basis::Bspline => [
            r * r * r / 6.0,
            (3.0 * t3 - 6.0 * t2 + 4.0) / 6.0,
            (-3.0 * t3 + 3.0 * t2 + 3.0 * t + 1.0) / 6.0,
            t3 / 6.0,
        ],
        Basis::CatmullRom => [
            (-t3 + 2.0 * t2 - t) / 2.0,
            (3.0 * t3 - 5.0 * t2 + 2.0) / 2.0,
            (-3.0 * t3 + 4.0 * t2 + t) / 2.0,
            (t3 - t2) / 2.0,
        ],
    };
    p.iter().zip(weights).map(|(p, w)| p * w).sum()
}

/// `n` points at even distances along a polyline, its ends included.
fn resample(line: &[Vec3], n: usize) -> Vec<Vec3> {
    let mut lengths = vec![0.0];
    for pair in line.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + (pair[1] - pair[0]).norm());
    }
    let total = lengths[lengths.len() - 1];
    let mut k = 0;
    let point = |i: usize| {
        let wanted = total * i as f64 / (n - 1) as f64;
        while k + 2 < line.len() && lengths[k + 1] < wanted {
            k += 1;
        }
        let span = lengths[k + 1] - lengths[k];
        let share = if span > 0.0 { (wanted - lengths[k]) / span } else { 0.0 };
        line[k].lerp(&line[k + 1], share.clamp(0.0, 1.0))
    };
    (0..n).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(n: u8) -> Vec<Vec3> {
        (0..n).map(|k| Vec3::new(f64::from(k), 0.0, 0.0)).collect()
    }

    fn check(found: &[Vec3], expected: &[f64]) {
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - Vec3::new(*expected, 0.0, 0.0)).norm() < 1e-12, "{found}");
        }
    }

    /// Even control points on a line give a line: from the second to the last but one, or from end to end if the
    /// ends are pinned.
    #[test]
    fn straight_curves() {
        for basis in [Basis::Bspline, Basis::CatmullRom] {
            check(&evenly(basis, false, &line(5), 5).unwrap(), &[1.0, 1.5, 2.0, 2.5, 3.0]);
            check(&evenly(basis, true, &line(5), 5).unwrap(), &[0.0, 1.0, 2.0, 3.0, 4.0]);
        }
        check(&evenly(Basis::Bezier, false, &line(7), 4).unwrap(), &[0.0, 2.0, 4.0, 6.0]);
        check(&evenly(Basis::CatmullRom, true, &line(2), 3).unwrap(), &[0.0, 0.5, 1.0]);
    }

    /// Three-fold ends, as Houdini writes them, pin a B-spline to its ends.
    #[test]
    fn repeated_ends() {
        let ends: Vec<Vec3> = [0.0, 0.0, 0.0, 3.0, 3.0, 3.0].map(|x| Vec3::new(x, 0.0, 0.0)).to_vec();
        check(&evenly(Basis::Bspline, false, &ends, 4).unwrap(), &[0.0, 1.0, 2.0, 3.0]);
    }

    #[test]
    fn points_are_even_on_a_bend() {
        let control = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [2.0, 0.0]];
        let control: Vec<Vec3> = control.iter().map(|p| Vec3::new(p[0], p[1], 0.0)).collect();
        let points = evenly(Basis::CatmullRom, true, &control, 40).unwrap();
        let steps: Vec<f64> = points.windows(2).map(|p| (p[1] - p[0]).norm()).collect();
        let mean = steps.iter().sum::<f64>() / steps.len() as f64;
        assert!(steps.iter().all(|s| (s / mean - 1.0).abs() < 0.02), "{steps:?}");
    }

    #[test]
    fn too_few_control_points_make_no_curve() {
        assert_eq!(evenly(Basis::Bspline, false, &line(3), 3), None);
        assert_eq!(evenly(Basis::CatmullRom, true, &line(1), 3), None);
        assert_eq!(evenly(Basis::Bezier, false, &line(5), 3), None);
        assert_eq!(evenly(Basis::Bezier, false, &line(4), 1), None);
    }
}
