//! What is learned of a marker to fill one of its gaps.

use crate::gaps::Scene;
use crate::shape::ShapeModel;
use std::collections::BTreeMap;
use std::ops::Range;
use tousle_core::Track;

/// In how many frames round a gap a marker is looked at, those in which it is seen: ten seconds of 120 Hz. More would tell little
/// that is new of how its lock bends, and a long capture would take the square of its length.
const LEARNED_FRAMES: usize = 1200;

/// A marker round one of its gaps: how it follows its neighbors there, and how far from them it gets.
pub(crate) struct Learned<'a> {
    pub scene: Scene<'a>,
    pub target: usize,
    /// The gap, and what lies round it.
    pub frames: Range<usize>,
    /// By neighbors; `None` of those that are seen together too rarely.
    models: BTreeMap<Vec<usize>, Option<ShapeModel<'a>>>,
    /// By the other marker (none is the root), m.
    reaches_m: BTreeMap<Option<usize>, f64>,
}

impl<'a> Learned<'a> {
    pub(crate) fn round(scene: Scene<'a>, target: usize, gap: &Range<usize>) -> Self {
        let frames = frames_round(&scene.tracks[target], gap, LEARNED_FRAMES);
        Self { scene, target, frames, models: BTreeMap::new(), reaches_m: BTreeMap::new() }
    }

    /// Learns how the marker follows some neighbors, if it is not known yet.
    pub(crate) fn learn(&mut self, neighbors: &[usize]) {
        if !self.models.contains_key(neighbors) {
            let Scene { locks, tracks, .. } = self.scene;
            let own = neighbors.to_vec();
            let model = ShapeModel::new(locks, tracks, self.target, own, self.frames.clone());
            self.models.insert(neighbors.to_vec(), model);
        }
    }

    /// What was learned of some neighbors.
    pub(crate) fn model(&self, neighbors: &[usize]) -> Option<&ShapeModel<'a>> {
        self.models.get(neighbors)?.as_ref()
    }

    /// The greatest distance from another marker of the lock, or from the root, m.
    pub(crate) fn reach_m(&mut self, other: Option<usize>) -> f64 {
        let Scene { locks, tracks, .. } = self.scene;
        let (target, frames) = (self.target, self.frames.clone());
        *self.reaches_m.entry(other).or_insert_with(|| locks.reach_m(tracks, target, other, frames))
    }
}

/// A gap and the frames round it, until a track is seen in `n` of them: in as many before as after, or in more on one side where the
/// capture ends on the other.
fn frames_round(track: &Track, gap: &Range<usize>, n: usize) -> Range<usize> {
    let is_seen = |f: &usize| track.at(*f).is_some();
    let before: Vec<usize> = (0..gap.start).rev().filter(is_seen).take(n + 1).collect();
    let after: Vec<usize> = (gap.end..track.n_frames()).filter(is_seen).take(n + 1).collect();
    let [n_before, n_after] = [&after, &before].map(|other| (n / 2).max(n.saturating_sub(other.len())));
    let start = before.get(n_before).map_or(0, |f| f + 1);
    start..after.get(n_after).copied().unwrap_or(track.n_frames())
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::Vec3;

    #[test]
    fn a_gap_is_learned_from_what_is_seen_round_it() {
        let is_seen = |f: usize| !(40..50).contains(&f) && !(52..60).contains(&f);
        let track: Track = (0..100).map(|f| is_seen(f).then(Vec3::zeros)).collect();
        assert_eq!(frames_round(&track, &(40..50), 20), 30..68);
        assert_eq!(frames_round(&track, &(40..50), 200), 0..100);
        assert_eq!(frames_round(&track, &(0..0), 20), 0..20);
        assert_eq!(frames_round(&track, &(96..100), 20), 76..100);
    }
}
