//! Where a dragged strand will be, before it is known: its unedited way, and more and more of what is asked.

use tousle_core::{StrandMotion, Vec3};
use tousle_edit::{FoundKey, StrandPath, drag};

/// The way that a strand will take, roughly.
pub(crate) struct Guess<'a> {
    path: StrandPath<'a>,
    first_secs: f64,
    last_secs: f64,
    /// For each time at which the strand has keys, how far each of its points should be moved, m.
    moves: Vec<(f64, Vec<Vec3>)>,
}

impl<'a> Guess<'a> {
    /// A strand, the first of a motion, moved to its keys, which are in order of time.
    pub(crate) fn new(
        motion: &'a StrandMotion,
        keys: &[&FoundKey],
        (first_secs, last_secs): (f64, f64),
    ) -> Self {
        let path = StrandPath::new(motion, 0);
        let mut moves: Vec<(f64, Vec<Vec3>)> = Vec::new();
        let mut times: Vec<f64> = keys.iter().map(|key| key.secs).collect();
        times.dedup();
        for secs in times {
            let from = path.points_at(secs);
            let mut at_once: Vec<_> = keys.iter().filter(|key| key.secs == secs).collect();
            at_once.sort_by_key(|key| key.control_point);
            let to = at_once
                .iter()
                .fold(from.clone(), |points, key| drag(&points, key.control_point, key.target_m).points_m);
            moves.push((secs, to.iter().zip(&from).map(|(to, from)| to - from).collect()));
        }
        Self { path, first_secs, last_secs, moves }
    }

    /// The way that a strand takes already: nothing is added.
    pub(crate) fn known(motion: &'a StrandMotion, (first_secs, last_secs): (f64, f64)) -> Self {
        Self { path: StrandPath::new(motion, 0), first_secs, last_secs, moves: Vec::new() }
    }

    /// The strand's points at a time, m.
    pub(crate) fn points_at(&self, secs: f64) -> Vec<Vec3> {
        let mut points = self.path.points_at(secs);
        let after = self.moves.partition_point(|(t, _)| *t <= secs);
        let (from_secs, from) = match after {
            0 => (self.first_secs, None),
            k => (self.moves[k - 1].0, Some(&self.moves[k - 1].1)),
        };
        let (to_secs, to) = self.moves.get(after).map_or((self.last_secs, None), |(t, m)| (*t, Some(m)));
        let x = ((secs - from_secs) / (to_secs - from_secs).max(1e-9)).clamp(0.0, 1.0);
        let share = x * x * (3.0 - 2.0 * x);
        for (k, point) in points.iter_mut().enumerate() {
            *point += from.map_or_else(Vec3::zeros, |m| m[k]) * (1.0 - share)
                + to.map_or_else(Vec3::zeros, |m| m[k]) * share;
        }
        points
    }
}
