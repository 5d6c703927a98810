//! Strands as smooth curves with a direction outwards.

use crate::instant::single;
use tousle_core::{Groom, Vec3};

/// Samples of a strand, evenly along its control points.
pub const N_SAMPLES: usize = 28;

/// How a strand is tinted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Tint {
    /// As hair.
    #[default]
    Plain,
    /// It is chosen.
    Chosen,
    /// The pointer is over it.
    Hovered,
}

/// Two vectors a sample, strand after strand, [`N_SAMPLES`] each: place and half the width, m; outward normal and
/// tint.
///
/// In: all control points at one time, head space, m; a tint for each strand.
pub fn samples(groom: &Groom, points_m: &[[f32; 3]], tint: impl Fn(usize) -> Tint) -> Vec<[f32; 4]> {
    let mut samples = Vec::with_capacity(2 * N_SAMPLES * groom.strands.len());
    let mut first = 0;
    for (strand_idx, strand) in groom.strands.iter().enumerate() {
        let n = strand.rest_curve_m.len();
        let points: Vec<Vec3> = points_m[first..first + n].iter().copied().map(single).collect();
        first += n;
        let places: Vec<Vec3> = (0..N_SAMPLES).map(|k| curve(&points, share(k))).collect();
        let tint = f32::from(tint(strand_idx) as u8);
        for (k, (place, normal)) in places.iter().zip(normals(&places)).enumerate() {
            let width = strand.lock_width_m * width_factor(&strand.along.width, share(k));
            let [p, n] = [place, &normal].map(|v| v.map(|c| c as f32));
            samples.push([p.x, p.y, p.z, (width / 2.0) as f32]);
            samples.push([n.x, n.y, n.z, tint]);
        }
    }
    samples
}

/// How far along its strand a sample is, 0 to 1.
fn share(sample: usize) -> f64 {
    sample as f64 / (N_SAMPLES - 1) as f64
}

/// A point of the Catmull-Rom curve through control points, at a share of their number.
fn curve(points: &[Vec3], share: f64) -> Vec3 {
    let last = points.len() - 1;
    let place = share * last as f64;
    let k = (place as usize).min(last - 1);
    let t = place - k as f64;
    let (b, c) = (points[k], points[k + 1]);
    // Beyond its ends a strand goes on straight.
    let a = if k > 0 { points[k - 1] } else { b * 2.0 - c };
    let d = points.get(k + 2).copied().unwrap_or(c * 2.0 - b);
    let (t2, t3) = (t * t, t * t * t);
    ((b * 2.0) + (c - a) * t + (a * 2.0 - b * 5.0 + c * 4.0 - d) * t2 + (b * 3.0 - a - c * 3.0 + d) * t3)
        / 2.0
}

/// Outward normals along a curve: away from the head's center at the root, from there carried along without twist,
/// so that a lock does not flip where it is blown straight away from the head.
fn normals(places: &[Vec3]) -> Vec<Vec3> {
    let across = |v: Vec3, tangent: Vec3| (v - tangent * v.dot(&tangent)).try_normalize(1e-9);
    let tangent = |k: usize| {
        let (before, after) = (places[k.saturating_sub(1)], places[(k + 1).min(places.len() - 1)]);
        (after - before).try_normalize(1e-12).unwrap_or_else(Vec3::z)
    };
    let at_root = tangent(0);
    let mut normal =
        across(places[0], at_root).or_else(|| across(Vec3::x(), at_root)).unwrap_or_else(Vec3::y);
    (0..places.len())
        .map(|k| {
            normal = across(normal, tangent(k)).unwrap_or(normal);
            normal
        })
        .collect()
}

/// How many times a strand's own width it is wide at a share of its control points.
fn width_factor(factors: &[f64], share: f64) -> f64 {
    let Some(last) = factors.len().checked_sub(1) else { return 1.0 };
    let place = share * last as f64;
    let k = place as usize;
    let after = factors[(k + 1).min(last)];
    factors[k] + (after - factors[k]) * (place - k as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    #[test]
    fn samples_follow_the_control_points() {
        let groom = testing::groom();
        let points: Vec<[f32; 3]> =
            groom.strands.iter().flat_map(|s| &s.rest_curve_m).map(|p| p.map(|c| c as f32).into()).collect();
        let tint = |strand| if strand == 1 { Tint::Chosen } else { Tint::Plain };
        let samples = samples(&groom, &points, tint);
        assert_eq!(samples.len(), 2 * 2 * N_SAMPLES);
        assert_eq!(samples[0], [0.1, 0.0, 0.0, 0.0025]);
        let tip = samples[2 * (N_SAMPLES - 1)];
        assert!((tip[2] + 0.1).abs() < 1e-6);
        // The strand hangs in front of the head: outwards is forwards.
        assert!((samples[1][0] - 1.0).abs() < 1e-6 && samples[1][3] == 0.0);
        assert_eq!(samples[2 * N_SAMPLES + 1][3], 1.0);
    }
}
