//! Samples that are farther from their lock's root than its hair lets a marker be.

use crate::lock::Locks;
use std::ops::Range;
use tousle_core::{Track, Vec3, runs};

/// Samples in a row that were taken out of one track.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Far {
    pub marker: usize,
    pub frames: Range<usize>,
    /// From the lock's root, that of the farthest, m.
    pub distance_m: f64,
}

/// Takes out what no marker of the wig can be: no exchange of labels explains it, and nothing is to be learned from it.
pub(crate) fn refuse_foreign(tracks: &mut [Track], locks: &Locks) -> Vec<Far> {
    refuse(tracks, locks, |place_m| locks.is_within_reach_of_any(place_m))
}

/// Takes out what a marker cannot be itself, once labels are its own again.
pub(crate) fn refuse_far(tracks: &mut [Track], locks: &Locks) -> Vec<Far> {
    refuse(tracks, locks, |_| false)
}

/// Takes out what its own marker cannot be, unless it `is_someone`.
fn refuse(tracks: &mut [Track], locks: &Locks, is_someone: impl Fn(Vec3) -> bool) -> Vec<Far> {
    let mut refused = Vec::new();
    for (marker, track) in tracks.iter_mut().enumerate() {
        let distance_m = |place_m: Vec3| (place_m - locks.root_m(marker)).norm();
        let is_far = |place_m: Vec3| distance_m(place_m) > locks.farthest_m(marker) && !is_someone(place_m);
        for frames in runs(track.n_frames(), |f| track.at(f).is_some_and(is_far)) {
            let distances_m = frames.clone().filter_map(|f| track.at(f)).map(distance_m);
            let distance_m = distances_m.fold(0.0, f64::max);
            frames.clone().for_each(|f| track.set(f, None));
            refused.push(Far { marker, frames, distance_m });
        }
    }
    refused
}
