//! Nameless trajectories: pieces of a marker during its own gap, or ghosts.

use crate::gaps::{Fill, Scene, fill_gap};
use crate::lock::Locks;
use rayon::prelude::*;
use std::ops::Range;
use tousle_core::{Track, UnlabeledTrack, Vec3, runs};

/// Degrees of freedom of the tails of a fill's error: it is no Gaussian.
const TAIL: f64 = 3.0;

/// A stretch of a nameless trajectory without a gap.
#[derive(Clone, Debug)]
pub(crate) struct Piece<'a> {
    /// Which of the nameless trajectories it is of: labels of two subjects may be the same.
    pub unlabeled_idx: usize,
    pub label: &'a str,
    pub track: &'a Track,
    pub frames: Range<usize>,
}

/// What is thought of a piece.
#[derive(Clone, Debug)]
pub(crate) struct Verdict {
    /// The likeliest marker among those that were in a gap all the while.
    pub marker: Option<usize>,
    /// Root mean square distance from that marker's fill, m.
    pub distance_m: f64,
    /// Expected, m.
    pub expected_m: f64,
    /// Probability that it is that marker.
    pub confidence: f64,
    /// The locks whose markers were asked: only what is given to one of them can change this verdict.
    pub locks: Vec<usize>,
}

/// All pieces of the nameless trajectories, in order.
pub(crate) fn pieces(unlabeled: &[UnlabeledTrack]) -> Vec<Piece<'_>> {
    unlabeled.iter().enumerate().flat_map(pieces_of).collect()
}

fn pieces_of(
    (unlabeled_idx, UnlabeledTrack { label, track }): (usize, &UnlabeledTrack),
) -> impl Iterator<Item = Piece<'_>> {
    let seen = runs(track.n_frames(), |f| track.at(f).is_some());
    seen.into_iter().map(move |frames| Piece { unlabeled_idx, label, track, frames })
}

/// Whose the piece is: the fill of each marker's gap, with its expected error, against a ghost anywhere in the
/// hair.
pub(crate) fn judge(scene: Scene<'_>, piece: &Piece<'_>, volume_m3: f64) -> Verdict {
    let missing: Vec<(usize, Range<usize>)> = (0..scene.tracks.len())
        .filter_map(|marker| Some((marker, gap_round(&scene.tracks[marker], &piece.frames)?)))
        .collect();
    let mut locks: Vec<usize> = missing.iter().map(|(m, _)| scene.locks.markers[*m].strand_idx).collect();
    locks.dedup();
    let candidates: Vec<(usize, Fit)> = missing
        .into_par_iter()
        .filter_map(|(marker, gap)| {
            Some((marker, Fit::of(piece, &fill_gap(scene, marker, &gap, &piece.frames))?))
        })
        .collect();
    // As many markers as are in a gap may have lost it; a ghost is as likely as all of them together.
    let prior = -libm::log(candidates.len().max(1) as f64);
    let ghost = -libm::log(volume_m3);
    let evidence = |fit: &Fit| libm::exp((prior + fit.log_density - ghost).min(300.0));
    let total: f64 = 1.0 + candidates.iter().map(|(_, fit)| evidence(fit)).sum::<f64>();
    let best = candidates.iter().max_by(|a, b| a.1.log_density.total_cmp(&b.1.log_density));
    let Some((marker, fit)) = best else {
        return Verdict { marker: None, distance_m: f64::NAN, expected_m: f64::NAN, confidence: 0.0, locks };
    };
    Verdict {
        marker: Some(*marker),
        distance_m: fit.distance_m,
        expected_m: fit.expected_m,
        confidence: evidence(fit) / total,
        locks,
    }
}

/// Which pieces are surely whose, the surest first. Of those that are one lock's in the same frames only the first: once that is
/// given, where the lock is there is told anew.
pub(crate) fn surest(
    judged: &[(Verdict, Piece<'_>)],
    locks: &Locks,
    least_confidence: f64,
) -> Vec<(usize, usize)> {
    let mut order: Vec<usize> =
        (0..judged.len()).filter(|k| judged[*k].0.confidence >= least_confidence).collect();
    order.sort_by(|a, b| judged[*b].0.confidence.total_cmp(&judged[*a].0.confidence));
    let mut sure: Vec<(usize, usize)> = Vec::new();
    for k in order {
        let (Verdict { marker: Some(marker), .. }, Piece { frames, .. }) = &judged[k] else { continue };
        let lock = locks.lock_of(*marker);
        let competes = |&(other, of): &(usize, usize)| {
            let others = &judged[other].1.frames;
            lock.contains(&of) && others.start < frames.end && frames.start < others.end
        };
        if !sure.iter().any(competes) {
            sure.push((k, *marker));
        }
    }
    sure
}

/// The gap that holds all of these frames.
fn gap_round(track: &Track, frames: &Range<usize>) -> Option<Range<usize>> {
    let is_missing = |f: &usize| track.at(*f).is_none();
    if !frames.clone().all(|f| is_missing(&f)) {
        return None;
    }
    let n_before = (0..frames.start).rev().take_while(is_missing).count();
    let n_after = (frames.end..track.n_frames()).take_while(is_missing).count();
    Some(frames.start - n_before..frames.end + n_after)
}

/// How well a piece fits a marker's fill.
#[derive(Clone, Debug)]
struct Fit {
    distance_m: f64,
    expected_m: f64,
    /// Log of the density at the piece's place, 1/m³.
    log_density: f64,
}

impl Fit {
    /// `None` if the fill does not cover the piece, or its error is unknown.
    ///
    /// Errors of a fill last for many frames: the whole piece is one observation of one place, and the mean over
    /// its frames keeps that observation's variance.
    fn of(piece: &Piece<'_>, fills: &[Fill]) -> Option<Self> {
        let (mut squares, mut in_errors, mut logs, mut errors, mut n) = (0.0, 0.0, 0.0, 0.0, 0usize);
        for fill in fills {
            let errors_m = fill.errors_m.as_ref()?;
            for ((f, told), error_m) in fill.frames.clone().zip(&fill.positions).zip(errors_m) {
                if !piece.frames.contains(&f) {
                    continue;
                }
                let square = (piece.track.at(f)? - told).norm_squared();
                squares += square;
                in_errors += 3.0 * square / (error_m * error_m);
                logs += libm::log(error_m / 3f64.sqrt());
                errors += error_m * error_m;
                n += 1;
            }
        }
        if n < piece.frames.len() {
            return None;
        }
        let n = n as f64;
        // Student's t in three dimensions with three degrees of freedom: Γ(3) / (Γ(3/2) (3π)^(3/2)) at its peak.
        let peak = libm::log(2.0 / (0.886_226_925 * 28.934_8));
        let tails = (TAIL + 3.0) / 2.0 * libm::log1p(in_errors / n / TAIL);
        Some(Self {
            distance_m: (squares / n).sqrt(),
            expected_m: (errors / n).sqrt(),
            log_density: peak - tails - 3.0 * logs / n,
        })
    }
}

/// The volume in which hair was seen, m³: the box round all samples.
pub(crate) fn volume_m3(tracks: &[Track]) -> f64 {
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    for p in tracks.iter().flat_map(Track::iter).flatten() {
        low = low.inf(&p);
        high = high.sup(&p);
    }
    let size = high - low;
    if size.iter().all(|s| s.is_finite()) { size.iter().map(|s| s.max(1e-2)).product() } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::{Session, StrandMarker, StrandSpec};

    /// Two locks of two markers.
    fn locks() -> Locks {
        let marker = |k: usize, m: usize| StrandMarker {
            label: format!("S{k}_{m}"),
            distance_from_root_m: None,
            mass_kg: 1e-5,
        };
        let strand = |k: usize| StrandSpec {
            name: format!("S{k}"),
            length_m: 0.1,
            linear_density_kg_per_m: 3e-3,
            lock_width_m: 7e-3,
            root_m: Vec3::zeros(),
            markers: (1..=2).map(|m| marker(k, m)).collect(),
        };
        let session = Session { strands: (0..2).map(strand).collect(), ..Session::unknown("two locks") };
        Locks::of(&session, &[2, 2])
    }

    #[test]
    fn of_one_locks_pieces_in_the_same_frames_only_the_surest_is_given() {
        let track = Track::missing(0);
        let judged = |(marker, frames, confidence): (usize, Range<usize>, f64)| {
            let verdict = Verdict {
                marker: Some(marker),
                distance_m: 0.0,
                expected_m: 0.0,
                confidence,
                locks: Vec::new(),
            };
            (verdict, Piece { unlabeled_idx: 0, label: "*1", track: &track, frames })
        };
        let pieces = [
            (0, 10..20, 0.95),
            (1, 19..30, 0.99),
            (0, 30..40, 0.98),
            (2, 10..20, 0.97),
            (3, 50..60, 0.5),
            (0, 12..15, 0.96),
        ];
        let judged: Vec<_> = pieces.map(judged).into();
        assert_eq!(surest(&judged, &locks(), 0.9), [(1, 1), (2, 0), (3, 2), (5, 0)]);
    }
}
