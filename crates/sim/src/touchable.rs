//! What a strand can touch, and where it can get.

use crate::prepared::Prepared;
use crate::timeline::Timeline;
use tousle_core::{Attachment, Vec3};
use tousle_field::{Sampler, Scene};
use tousle_rod::{Lock, Rest, Surface};

/// A collider that a strand can reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Touchable {
    /// Index in the body.
    pub collider: usize,
    /// Whether the torso carries it.
    pub on_torso: bool,
}

/// Rounding may make a strand longer, but not by as much, as a share of it.
const STRETCH: f64 = 1e-3;

/// The colliders that a strand can reach. The torso's, once the head turns, may come to it.
pub(crate) fn touchable(
    scene: &Scene,
    timeline: &Timeline<'_>,
    surfaces: &[Surface],
    lock: &Lock,
    rest: &Rest,
) -> Vec<Touchable> {
    let n = lock.n_sticks();
    let largest_clearance_m =
        |collider: usize| rest.clearances_m[collider * n..][..n].iter().copied().fold(0.0, f64::max);
    (0..surfaces.len())
        .map(|collider| Touchable {
            collider,
            on_torso: scene.body.colliders[collider].attachment == Attachment::Torso,
        })
        .filter(|t| {
            let comes = t.on_torso && timeline.terms.head_movement;
            let distance_m = surfaces[t.collider].gap(lock.root_m).distance_m;
            // An ellipsoid's distance is of first order, never too large: what comes near is felt somewhat farther out.
            comes || distance_m <= lock.reach_m() + 2.0 * largest_clearance_m(t.collider)
        })
        .collect()
}

/// The colliders that some strands can reach, in the body's order.
pub(crate) fn reached<S>(strands: &[&Prepared<S>]) -> Vec<Touchable> {
    let mut reached: Vec<Touchable> = strands.iter().flat_map(|p| &p.touchable).copied().collect();
    reached.sort_unstable();
    reached.dedup();
    reached
}

/// How many strands can reach each of a body's colliders.
pub(crate) fn n_reaching<S>(scene: &Scene, strands: &[Prepared<S>]) -> Vec<usize> {
    let mut n_reaching = vec![0; scene.body.colliders.len()];
    strands.iter().flat_map(|p| &p.touchable).for_each(|touchable| n_reaching[touchable.collider] += 1);
    n_reaching
}

/// A sampler for all places where strands can get: none is farther from its root than it is long.
pub(crate) fn within_reach<'a, 'b>(
    sampler: Sampler<'a>,
    locks: impl Iterator<Item = &'b Lock>,
) -> Sampler<'a> {
    let nowhere = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    let (low_m, high_m) = locks.fold(nowhere, |(low, high), lock| {
        let reach = Vec3::repeat(lock.reach_m() * (1.0 + STRETCH));
        (low.inf(&(lock.root_m - reach)), high.sup(&(lock.root_m + reach)))
    });
    sampler.within(low_m, high_m)
}
