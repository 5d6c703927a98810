//! What a lock is to cleaning: markers in a row on something that bends but does not stretch.

use std::ops::Range;
use tousle_core::{Session, Track, Vec3};

/// How much farther from its root than its place along the lock a marker may seem: hands lay a tape along hair with an error of some
/// percent, and a root is told to some centimeters. Beyond that it is something else that bears the label.
const MOST_SEEN: f64 = 1.25;
const MEASURING_SLACK_M: f64 = 0.05;

/// One marker of one lock.
#[derive(Clone, Debug)]
pub(crate) struct Marker {
    pub label: String,
    pub strand_idx: usize,
    /// Distance from the root along the lock, m; by even spacing if it was not measured.
    pub arc_m: f64,
    /// The greatest distance from the root that it can be seen at, m.
    farthest_m: f64,
}

/// All locks, their markers in one flat row: lock after lock, root to tip.
#[derive(Clone, Debug)]
pub(crate) struct Locks {
    pub markers: Vec<Marker>,
    /// The flat indices of each lock's markers.
    pub members: Vec<Range<usize>>,
    roots_m: Vec<Vec3>,
    names: Vec<String>,
}

impl Locks {
    pub(crate) fn of(session: &Session, n_markers: &[usize]) -> Self {
        let mut locks =
            Self { markers: Vec::new(), members: Vec::new(), roots_m: Vec::new(), names: Vec::new() };
        for (strand_idx, (spec, n)) in session.strands.iter().zip(n_markers).enumerate() {
            let first = locks.markers.len();
            for (k, marker) in spec.markers.iter().take(*n).enumerate() {
                let even = spec.length_m * (k + 1) as f64 / *n as f64;
                let arc_m = marker.distance_from_root_m.unwrap_or(even);
                // A marker that nobody measured may be anywhere down to the tip.
                let hair_m = marker.distance_from_root_m.unwrap_or(spec.length_m);
                let farthest_m = MOST_SEEN * hair_m + MEASURING_SLACK_M;
                locks.markers.push(Marker { label: marker.label.clone(), strand_idx, arc_m, farthest_m });
            }
            locks.members.push(first..locks.markers.len());
            locks.roots_m.push(spec.root_m);
            locks.names.push(spec.name.clone());
        }
        locks
    }

    pub(crate) fn lock_of(&self, marker: usize) -> Range<usize> {
        self.members[self.markers[marker].strand_idx].clone()
    }

    pub(crate) fn root_m(&self, marker: usize) -> Vec3 {
        self.roots_m[self.markers[marker].strand_idx]
    }

    /// The greatest distance from its root at which a marker can be seen, m.
    pub(crate) fn farthest_m(&self, marker: usize) -> f64 {
        self.markers[marker].farthest_m
    }

    /// Whether some marker of some lock can be at a place.
    pub(crate) fn is_within_reach_of_any(&self, place_m: Vec3) -> bool {
        let can_be = |marker: usize| (place_m - self.root_m(marker)).norm() <= self.farthest_m(marker);
        (0..self.markers.len()).any(can_be)
    }

    pub(crate) fn strand_name(&self, marker: usize) -> &str {
        &self.names[self.markers[marker].strand_idx]
    }

    /// Hair between two markers of one lock, m.
    pub(crate) fn between_m(&self, i: usize, j: usize) -> f64 {
        (self.markers[i].arc_m - self.markers[j].arc_m).abs()
    }

    /// How much worse these two markers' tracks fit the lengths of their locks in some frames than exchanged: difference of mean
    /// excesses of distance over hair, m.
    pub(crate) fn better_swapped(&self, tracks: &[Track], [a, b]: [usize; 2], frames: &Range<usize>) -> f64 {
        let misfit = |marker: usize, track: usize| {
            self.misfit_of(tracks, marker, &tracks[track], &[a, b], frames.clone())
        };
        misfit(a, a) + misfit(b, b) - misfit(a, b) - misfit(b, a)
    }

    /// Over some frames, how much farther from (or nearer to) its neighbors a marker is than the hair between them says.
    ///
    /// Hair is nearly straight between two markers 3 cm apart: too near is as suspicious as too far.
    fn misfit_of(
        &self,
        tracks: &[Track],
        marker: usize,
        track: &Track,
        left_out: &[usize],
        frames: Range<usize>,
    ) -> f64 {
        let neighbors = self.lock_of(marker).filter(|n| n.abs_diff(marker) == 1 && !left_out.contains(n));
        let mut excess = [0.0; 2];
        for neighbor in neighbors {
            let between_m = self.between_m(marker, neighbor);
            for frame in frames.clone() {
                let (Some(p), Some(q)) = (track.at(frame), tracks[neighbor].at(frame)) else { continue };
                excess[0] += ((p - q).norm() - between_m).abs();
                excess[1] += 1.0;
            }
        }
        let from_root = (self.root_m(marker), self.markers[marker].arc_m);
        for p in frames.filter_map(|frame| track.at(frame)) {
            excess[0] += ((p - from_root.0).norm() - from_root.1).max(0.0);
            excess[1] += 1.0;
        }
        excess[0] / excess[1].max(1.0)
    }

    /// The greatest distance between two markers of a lock (or one and the root), m: the hair between them, or,
    /// as hands measure hair to a millimeter or two, what was seen in some frames, rare outliers aside.
    pub(crate) fn reach_m(
        &self,
        tracks: &[Track],
        marker: usize,
        other: Option<usize>,
        frames: Range<usize>,
    ) -> f64 {
        let anchor = |f: usize| other.map_or(Some(self.root_m(marker)), |other| tracks[other].at(f));
        let mut seen: Vec<f64> =
            frames.filter_map(|f| Some((tracks[marker].at(f)? - anchor(f)?).norm())).collect();
        let hair = other.map_or(self.markers[marker].arc_m, |other| self.between_m(marker, other));
        if seen.is_empty() {
            return hair;
        }
        let rare = (seen.len() - 1) * 99 / 100;
        seen.select_nth_unstable_by(rare, f64::total_cmp).1.max(hair)
    }
}
