//! What a strand can touch.

use crate::timeline::Timeline;
use tousle_core::Attachment;
use tousle_field::Scene;
use tousle_rod::{Lock, Rest, Surface};

/// A collider that a strand can reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Touchable {
    /// Index in the body.
    pub collider: usize,
    /// Whether the torso carries it.
    pub on_torso: bool,
}

/// The colliders that a strand can reach. The torso's, once the head turns, may come to it.
pub(crate) fn touchable(
    scene: &Scene,
    timeline: &Timeline<'_>,
    surfaces: &[Surface],
    lock: &Lock,
    rest: &Rest,
) -> Vec<Touchable> {
    let n = lock.n_sticks();
    let nearest =
        |collider: usize| rest.clearances_m[collider * n..][..n].iter().copied().fold(0.0, f64::max);
    (0..surfaces.len())
        .map(|collider| Touchable {
            collider,
            on_torso: scene.body.colliders[collider].attachment == Attachment::Torso,
        })
        .filter(|t| {
            let comes = t.on_torso && timeline.terms.head_movement;
            // An ellipsoid's distance is of first order: it may say up to twice too much.
            let distance = 0.5 * surfaces[t.collider].gap(lock.root_m).distance_m;
            comes || distance <= lock.reach_m() + nearest(t.collider)
        })
        .collect()
}

/// How many strands can reach each of a body's colliders.
pub(crate) fn n_reaching<'a>(scene: &Scene, reached: impl Iterator<Item = &'a [Touchable]>) -> Vec<usize> {
    let mut n_reaching = vec![0; scene.body.colliders.len()];
    reached.flatten().for_each(|touchable| n_reaching[touchable.collider] += 1);
    n_reaching
}
