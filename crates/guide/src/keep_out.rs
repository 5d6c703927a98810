use std::sync::OnceLock;

use rayon::prelude::*;
use tousle_core::{Groom, StrandMotion, Vec3};
use tousle_lanes::{Lane, NullaryFnOnce, Precision, Registers, WithLanes};
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
    let mut follows = vec![true; groom.strands.len()];
    guides.strands().iter().for_each(|guide| follows[*guide] = false);
    let strands: Vec<Follower> = (groom.strands.iter().zip(starts(&motion.counts)).zip(follows))
        .filter(|(_, follows)| *follows)
        .map(|((strand, first), _)| Follower {
            rest_curve_m: &strand.rest_curve_m,
            first_point: first,
            deepest_m: OnceLock::new(),
        })
        .collect();
    Registers::widest()
        .with_lanes(Precision::Single, Keeping { strands: &strands, motion, at_rest, at_times })
}

/// All frames, a few of a strand's points at once.
struct Keeping<'a> {
    strands: &'a [Follower<'a>],
    motion: &'a mut StrandMotion,
    at_rest: &'a [Surface],
    at_times: &'a [Vec<Surface>],
}

impl WithLanes for Keeping<'_> {
    type Output = u64;

    fn with<L: Lane>(self) -> u64 {
        let Self { strands, motion, at_rest, at_times } = self;
        let n_points = motion.n_points();
        let frames = motion.positions_m.par_chunks_exact_mut(n_points).zip(at_times);
        frames
            .map(|(points, surfaces)| {
                let outlines: Vec<Outline<L>> = surfaces.iter().map(Outline::of).collect();
                L::dispatch(Frame { strands, points, at_rest, surfaces, outlines: &outlines })
            })
            .sum()
    }
}

/// A frame.
struct Frame<'a, L> {
    strands: &'a [Follower<'a>],
    points: &'a mut [[f32; 3]],
    at_rest: &'a [Surface],
    surfaces: &'a [Surface],
    outlines: &'a [Outline<L>],
}

impl<L: Lane> NullaryFnOnce for Frame<'_, L> {
    type Output = u64;

    #[inline(always)]
    fn call(self) -> u64 {
        let Self { strands, points, at_rest, surfaces, outlines } = self;
        let like = L::zero();
        let mut n_moved = 0;
        for follower in strands {
            let strand = &mut points[follower.first_point..][..follower.rest_curve_m.len()];
            // Most enter nothing; to look at a whole strand takes less than to push one point.
            if Outline::any_entered(outlines, like, &strand[1..]) {
                n_moved += push_out(strand, surfaces, follower.deepest_m(at_rest));
            }
        }
        n_moved
    }
}

/// A strand that follows.
struct Follower<'a> {
    rest_curve_m: &'a [Vec3],
    /// Its first point among those of all.
    first_point: usize,
    /// [`Follower::deepest_m`], once it was asked for.
    deepest_m: OnceLock<Vec<f64>>,
}

impl Follower<'_> {
    /// How deep each of its points lies in each surface at rest, ≤ 0, m: point after point.
    fn deepest_m(&self, at_rest: &[Surface]) -> &[f64] {
        let depths =
            |point: &Vec3| at_rest.iter().map(|s| s.gap(*point).distance_m.min(0.0)).collect::<Vec<_>>();
        self.deepest_m.get_or_init(|| self.rest_curve_m.iter().flat_map(depths).collect())
    }
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
