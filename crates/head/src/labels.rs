//! Head markers that carry each other's labels, told by where they sit on the head.

use crate::registration::{Pair, Registration, register};
use crate::shape::HeadShape;
use tousle_core::{Pose, Track, Vec3};

/// In a frame, the sample under one label is where another label's marker sits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Mislabeled {
    /// Index of the label that carries the sample.
    pub label: usize,
    /// Index of the marker that it is.
    pub is: usize,
    /// The frame, from 0.
    pub frame: usize,
}

/// So many markers make a pose that the next frames may be told by: with three, labels exchanged on a face that
/// is nearly the same left and right can agree on a head turned about.
const SURE: usize = 4;

/// Gives samples of the head's markers to the marker whose place they are at. Says which, and what the mended
/// markers agree on in each frame.
///
/// Two heads are asked in each frame: the one that most labels agree on, on whose places the others must lie to
/// within the tolerance; and the last sure one, from which a head has not gone far, so that each sample is the
/// marker's whose place is nearest. What either says is believed if then more markers agree on a pose than by
/// their labels alone. A neck that turns less than the head does not come to lie on another's place.
pub(crate) fn mend_labels(
    tracks: &mut [Track],
    shape: &HeadShape,
    by_labels: &[Option<Registration>],
    tolerance_m: f64,
) -> (Vec<Mislabeled>, Vec<Option<Registration>>) {
    let reach_m = half_the_least_distance(&shape.places_m);
    let mut found = Vec::new();
    let mut agreed = Vec::with_capacity(by_labels.len());
    let mut last_sure: Option<Pose> = None;
    for (frame, by_labels) in by_labels.iter().enumerate() {
        let seen: Vec<(usize, Vec3)> =
            tracks.iter().enumerate().filter_map(|(k, t)| Some((k, t.at(frame)?))).collect();
        let mut best = by_labels.clone();
        let mut moves: Vec<(usize, usize)> = Vec::new();
        let of_labels = by_labels.as_ref().map(|r| (r.world_from_head, tolerance_m));
        let of_motion = last_sure.map(|pose| (pose, reach_m));
        for (pose, reach_m) in of_labels.into_iter().chain(of_motion) {
            let asked = relabeled(&seen, &pose, &shape.places_m, reach_m);
            if asked.iter().all(|(label, is)| label == is) {
                continue;
            }
            let Some(registration) = register_as(&seen, &asked, shape, tolerance_m) else { continue };
            if best.as_ref().is_none_or(|b| registration.used.len() > b.used.len()) {
                best = Some(registration);
                moves = asked.into_iter().filter(|(label, is)| label != is).collect();
            }
        }
        let positions: Vec<Option<Vec3>> = moves.iter().map(|(label, _)| tracks[*label].at(frame)).collect();
        moves.iter().for_each(|(label, _)| tracks[*label].set(frame, None));
        for (&(label, is), position) in moves.iter().zip(positions) {
            tracks[is].set(frame, position);
            found.push(Mislabeled { label, is, frame });
        }
        let sure = best.as_ref().filter(|b| b.used.len() >= SURE);
        last_sure = sure.map(|b| b.world_from_head).or(last_sure);
        agreed.push(best);
    }
    (found, agreed)
}

/// For each sample the marker it is: that whose place on this head is nearest, if it is the nearest sample to
/// that place too and no farther than `reach_m`; its label's own otherwise, unless that has found a sample.
fn relabeled(seen: &[(usize, Vec3)], pose: &Pose, places_m: &[Vec3], reach_m: f64) -> Vec<(usize, usize)> {
    let distance = |p: &Vec3, k: usize| (pose.rotation * places_m[k] + pose.translation.vector - p).norm();
    let by_distance = |a: f64, b: f64| a.total_cmp(&b);
    let nearest_place =
        |p: &Vec3| (0..places_m.len()).min_by(|&a, &b| by_distance(distance(p, a), distance(p, b)));
    let nearest_sample = |k: usize| {
        seen.iter().min_by(|a, b| by_distance(distance(&a.1, k), distance(&b.1, k))).map(|(label, _)| *label)
    };
    let place = |(label, p): &(usize, Vec3)| {
        nearest_place(p).filter(|&k| distance(p, k) < reach_m && nearest_sample(k) == Some(*label))
    };
    let placed: Vec<(usize, Option<usize>)> = seen.iter().map(|sample| (sample.0, place(sample))).collect();
    let is_taken = |k: usize| placed.iter().any(|(_, is)| *is == Some(k));
    placed
        .iter()
        .filter_map(|&(label, is)| Some((label, is.or((!is_taken(label)).then_some(label))?)))
        .collect()
}

fn register_as(
    seen: &[(usize, Vec3)],
    asked: &[(usize, usize)],
    shape: &HeadShape,
    tolerance_m: f64,
) -> Option<Registration> {
    let position = |label: usize| seen.iter().find(|(k, _)| *k == label).map(|(_, p)| *p);
    let pairs: Vec<Pair> = asked
        .iter()
        .filter_map(|&(label, is)| {
            Some(Pair { marker: is, place_m: shape.places_m[is], seen_m: position(label)? })
        })
        .collect();
    let mut registration = register(&pairs, &vec![1.0; shape.places_m.len()], tolerance_m)?;
    for k in &mut registration.used {
        *k = pairs[*k].marker;
    }
    Some(registration)
}

fn half_the_least_distance(places_m: &[Vec3]) -> f64 {
    let mut least = f64::INFINITY;
    for (k, a) in places_m.iter().enumerate() {
        for b in &places_m[k + 1..] {
            least = least.min((a - b).norm());
        }
    }
    least / 2.0
}
