use std::ops::Range;

use rayon::prelude::*;
use tousle_core::{Groom, StrandMotion, Vec3};
use tousle_rod::Surface;

use crate::Guides;
use crate::follow::starts;
use crate::outline::Outline;

/// Times that a point is pushed out and its stick given back its length: on a body as round as a head, the second
/// leaves it within a tenth of a millimeter of the surface.
const ROUNDS: usize = 3;

/// Keeps the strands that follow out of a body.
///
/// In: the motion that [`follow`](crate::follow) gave; the body's surfaces at rest and at each of the motion's times, in
/// one order, head space. From the root on, a point that lies deeper in a surface than at rest is pushed out to it, and
/// its stick keeps its length; sticks further out keep their directions. Guides are left alone: what simulated them
/// has seen to it. Out: how many positions were moved.
///
/// Frames and strands do not depend on one another, so what was continuous in time stays so.
///
/// # Panics
/// If the groom, the guides and the motion do not belong together, or if there are surfaces for other times.
pub fn keep_out(
    groom: &Groom,
    guides: &Guides,
    motion: &mut StrandMotion,
    at_rest: &[Surface],
    at_times: &[Vec<Surface>],
) -> u64 {
    assert_eq!(motion.times_secs.len(), at_times.len(), "surfaces for each time");
    let depths_at_rest =
        |point: &Vec3| at_rest.iter().map(|s| s.gap(*point).distance_m.min(0.0)).collect::<Vec<_>>();
    let mut follows = vec![true; groom.strands.len()];
    guides.strands().iter().for_each(|guide| follows[*guide] = false);
    let strands: Vec<Follower> = (groom.strands.par_iter().zip(starts(&motion.counts)).zip(follows))
        .filter(|(_, follows)| *follows)
        .map(|((strand, first), _)| Follower {
            points: first..first + strand.rest_curve_m.len(),
            deepest_m: strand.rest_curve_m.iter().flat_map(depths_at_rest).collect(),
        })
        .collect();
    let n_points = motion.n_points();
    let frames = motion.positions_m.par_chunks_exact_mut(n_points).zip(at_times);
    frames
        .map(|(points, surfaces)| {
            let outlines: Vec<Outline> = surfaces.iter().map(Outline::of).collect();
            let entered = |points: &[[f32; 3]]| Outline::any_entered(&outlines, points);
            let mut n_moved = 0;
            for Follower { points: own, deepest_m } in &strands {
                let strand = &mut points[own.clone()];
                // Most enter nothing; to look at a whole strand takes less than to push one point.
                n_moved += if entered(&strand[1..]) { push_out(strand, surfaces, deepest_m) } else { 0 };
            }
            n_moved
        })
        .sum()
}

/// A strand that follows.
struct Follower {
    /// Its points among those of all.
    points: Range<usize>,
    /// How deep each of them lies in each surface at rest, ≤ 0, m: point after point.
    deepest_m: Vec<f64>,
}

/// Pushes a strand's points out of surfaces. Out: how many were moved.
fn push_out(points: &mut [[f32; 3]], surfaces: &[Surface], deepest_m: &[f64]) -> u64 {
    let double = |p: [f32; 3]| Vec3::from(p.map(f64::from));
    let mut n_moved = 0;
    let mut near_before = double(points[0]);
    let mut near = near_before;
    for (point, deepest_m) in points.iter_mut().zip(deepest_m.chunks_exact(surfaces.len())).skip(1) {
        let end_before = double(*point);
        let stick = end_before - near_before;
        let end = outside(near, near + stick, surfaces, deepest_m);
        let moved: [f32; 3] = end.map(|c| c as f32).into();
        n_moved += u64::from(moved != *point);
        *point = moved;
        (near_before, near) = (end_before, end);
    }
    n_moved
}

/// The end of a stick, turned about its near end until it is out.
fn outside(near: Vec3, end: Vec3, surfaces: &[Surface], deepest_m: &[f64]) -> Vec3 {
    let mut out = end;
    for _ in 0..ROUNDS {
        let before = out;
        for (surface, deepest) in surfaces.iter().zip(deepest_m) {
            if let Some(gap) = surface.gap_within(out, 0.0) {
                out += gap.normal * f64::max(deepest - gap.distance_m, 0.0);
            }
        }
        if out == before {
            break;
        }
        let length = (end - near).norm();
        let direction = (out - near).try_normalize(1e-9).unwrap_or_else(|| (end - near) / length);
        out = near + direction * length;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::Shape;

    /// A strand of eight sticks that is blown straight through a ball lies on it afterwards, as long as before.
    #[test]
    fn a_strand_goes_round_a_ball() {
        let ball =
            Surface::new(&Shape::Ellipsoid { center_m: Vec3::zeros(), half_axes_m: Vec3::repeat(0.1) });
        let through: Vec<[f32; 3]> = (0..9).map(|k| [0.03, 0.0, 0.1 - 0.02 * k as f32]).collect();
        let mut points = through.clone();
        assert_eq!(push_out(&mut points, std::slice::from_ref(&ball), &[0.0; 9]), 8);
        for pair in points.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|p| Vec3::from(p.map(f64::from)));
            assert!(((b - a).norm() - 0.02).abs() < 1e-7);
            assert!(ball.gap(b).distance_m > -2e-4, "{b}");
        }
        // One that lies as deep at rest is let be.
        let mut points = through.clone();
        assert_eq!(push_out(&mut points, &[ball], &[-1.0; 9]), 0);
        assert_eq!(points, through);
    }
}
