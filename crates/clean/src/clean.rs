use crate::counter::Counter;
use crate::far::{Far, refuse_far, refuse_foreign};
use crate::gaps::{Fill, Scene, fill_gap, gaps};
use crate::lock::Locks;
use crate::motion::{Continuity, white_noise};
use crate::pieces::{Piece, Verdict, judge, pieces, surest, volume_m3};
use crate::report::{
    CleanReport, FarRefused, GapFilled, GhostRefused, MarkerTimeline, PieceGivenBack, SpikeCut, SwapMended,
    Unfilled,
};
use crate::shape::{ShapeModel, neighbors};
use crate::spikes::cut_spikes;
use crate::swaps::{Swap, mend_swaps};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::ops::Range;
use tousle_core::{
    FrameSpan, HeadCapture, Progress, Sample, SampleKind, Session, StrandTracks, Track, UnlabeledTrack,
    median_high, runs,
};

/// How tracks are cleaned.
#[derive(Clone, Debug, PartialEq)]
pub struct CleanOptions {
    /// How many wrongly mended swaps a capture may be expected to have, > 0. Lowered, swaps of markers that are
    /// near each other are missed.
    pub false_alarms: f64,
    /// A nameless piece is given back if it is that marker's with at least this probability.
    pub least_confidence: f64,
    /// The most frames of a spike; what lasts longer is taken for motion.
    pub longest_spike_frames: usize,
    /// How many times higher than anything nearby a spike stands. White noise in 20 frames does not reach 3.
    pub spike_ratio: f64,
}

impl Default for CleanOptions {
    fn default() -> Self {
        Self { false_alarms: 0.01, least_confidence: 0.9, longest_spike_frames: 3, spike_ratio: 4.0 }
    }
}

/// A capture whose tracks have no holes where they could be filled, and what was changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Cleaned {
    /// The cleaned capture. What is left of `unlabeled` was refused.
    pub head: HeadCapture,
    /// Where each sample comes from and how far it can be trusted, `[strand][marker][frame]`.
    pub samples: Vec<Vec<Vec<Sample>>>,
    /// Every change.
    pub report: CleanReport,
}

/// Why a capture cannot be cleaned.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CleanError {
    /// Capture and session tell of different locks.
    #[error("lock {strand_idx} of the capture: found {found} markers, expected {expected} as in the session")]
    Markers {
        /// The lock, from 0.
        strand_idx: usize,
        /// Markers in the capture.
        found: usize,
        /// Markers in the session.
        expected: usize,
    },
    /// Capture and session tell of different numbers of locks.
    #[error("found {found} locks in the capture, expected {expected} as in the session")]
    Locks {
        /// Locks in the capture.
        found: usize,
        /// Locks in the session.
        expected: usize,
    },
    /// A track is not as long as the capture.
    #[error("lock {strand_idx}: found a track of {found} frames, expected {expected} as there are poses")]
    Frames {
        /// The lock, from 0.
        strand_idx: usize,
        /// Frames of the track.
        found: usize,
        /// Frames of the capture.
        expected: usize,
    },
}

/// Mends, cuts, gives back and fills the tracks of the locks' markers.
///
/// In: head-space positions, m, with gaps. Out: the same tracks with as few gaps as possible; for each sample
/// where it comes from and its expected error, m; a list of every change. `progress` hears of pieces that are judged, then of gaps
/// that are filled.
///
/// In this order, each step seeing what the last one mended: samples that are too far off to be any lock's,
/// exchanged labels (two motions break in one frame and each goes on as the other), samples that are farther from
/// their own lock's root than hair lets their marker be, spikes (samples that leave the motion and come back), nameless pieces (near
/// where the lock says the marker is, by how far off that usually is), gaps (from the seen neighbors on the lock
/// and the offset at both ends; each method is tried on frames that were seen, and the best one fills). The
/// paper does not say how it cleaned.
///
/// # Errors
/// [`CleanError`] if capture and session do not tell of the same locks.
pub fn clean(
    head: &HeadCapture,
    session: &Session,
    options: &CleanOptions,
    progress: &dyn Progress,
) -> Result<Cleaned, CleanError> {
    check(head, session)?;
    let n_markers: Vec<usize> = head.strands.iter().map(|s| s.markers.len()).collect();
    let locks = Locks::of(session, &n_markers);
    let mut tracks: Vec<Track> = head.strands.iter().flat_map(|s| s.markers.iter().cloned()).collect();
    let foreign = refuse_foreign(&mut tracks, &locks);
    let mut work = Work::new(head, session, locks, tracks);
    work.mend_swaps(options);
    work.refuse_far(foreign);
    work.cut_spikes(options);
    let unlabeled = work.give_back(head, options, progress);
    work.fill_gaps(progress);
    Ok(work.finish(head, unlabeled, &n_markers))
}

fn check(head: &HeadCapture, session: &Session) -> Result<(), CleanError> {
    let (found, expected) = (head.strands.len(), session.strands.len());
    if found != expected {
        return Err(CleanError::Locks { found, expected });
    }
    for (strand_idx, (strand, spec)) in head.strands.iter().zip(&session.strands).enumerate() {
        let (found, expected) = (strand.markers.len(), spec.markers.len());
        if found != expected {
            return Err(CleanError::Markers { strand_idx, found, expected });
        }
        let expected = head.n_frames();
        if let Some(found) = strand.markers.iter().map(Track::n_frames).find(|n| *n != expected) {
            return Err(CleanError::Frames { strand_idx, found, expected });
        }
    }
    Ok(())
}

/// The tracks as they become clean, one flat row of markers.
struct Work {
    locks: Locks,
    first_frame: i64,
    still: Option<(usize, usize)>,
    tracks: Vec<Track>,
    samples: Vec<Vec<Sample>>,
    noise_m: Vec<Option<f64>>,
    usual_noise_m: f64,
    report: CleanReport,
}

impl Work {
    fn new(head: &HeadCapture, session: &Session, locks: Locks, tracks: Vec<Track>) -> Self {
        let still = session.still_range(head.first_frame, head.n_frames());
        let noise_m: Vec<Option<f64>> = tracks.par_iter().map(|t| white_noise(t, still)).collect();
        let usual_noise_m = median_high(noise_m.iter().flatten().copied().collect()).unwrap_or(0.0);
        let sample = |p: Option<_>| match p {
            Some(_) => Sample { kind: SampleKind::Seen, error_m: 0.0 },
            None => Sample { kind: SampleKind::Missing, error_m: f64::INFINITY },
        };
        let samples = tracks.iter().map(|t| t.iter().map(sample).collect()).collect();
        let (first_frame, report) = (head.first_frame, CleanReport::default());
        Self { locks, first_frame, still, tracks, samples, noise_m, usual_noise_m, report }
    }

    fn scene(&self) -> Scene<'_> {
        Scene { locks: &self.locks, tracks: &self.tracks, still: self.still }
    }

    fn span(&self, frames: &Range<usize>) -> FrameSpan {
        FrameSpan::of(self.first_frame, frames)
    }

    fn label(&self, marker: usize) -> String {
        self.locks.markers[marker].label.clone()
    }

    fn mend_swaps(&mut self, options: &CleanOptions) {
        let as_read = self.tracks.clone();
        let continuity = Continuity::new(&as_read, self.usual_noise_m);
        let swaps = mend_swaps(&mut self.tracks, &continuity, &self.locks, options.false_alarms);
        for Swap { markers, frames, jump_m, confidence } in swaps {
            let mended = SwapMended {
                markers: markers.map(|m| self.label(m)),
                span: self.span(&frames),
                jump_m,
                confidence,
            };
            self.report.swaps.push(mended);
            for f in frames {
                for m in markers {
                    self.samples[m][f] = match self.tracks[m].at(f) {
                        Some(_) => Sample { kind: SampleKind::Mended, error_m: 0.0 },
                        None => Sample { kind: SampleKind::Missing, error_m: f64::INFINITY },
                    };
                }
            }
        }
    }

    /// Takes out what is too far from its own lock, and lists it with what was foreign to all of them.
    fn refuse_far(&mut self, foreign: Vec<Far>) {
        let mut refused = refuse_far(&mut self.tracks, &self.locks);
        refused.extend(foreign);
        refused.sort_by_key(|far| (far.marker, far.frames.start));
        for Far { marker, frames, distance_m } in refused {
            for f in frames.clone() {
                self.samples[marker][f] = Sample { kind: SampleKind::Missing, error_m: f64::INFINITY };
            }
            self.report.far.push(FarRefused {
                strand: self.locks.strand_name(marker).to_owned(),
                marker: self.label(marker),
                span: self.span(&frames),
                distance_m,
                reach_m: self.locks.farthest_m(marker),
            });
        }
    }

    fn cut_spikes(&mut self, options: &CleanOptions) {
        for m in 0..self.tracks.len() {
            let noise_m = self.noise_m[m].unwrap_or(self.usual_noise_m);
            let longest = options.longest_spike_frames;
            for spike in cut_spikes(&mut self.tracks[m], noise_m, longest, options.spike_ratio) {
                for f in spike.frames.clone() {
                    self.samples[m][f] = Sample { kind: SampleKind::Missing, error_m: f64::INFINITY };
                }
                self.report.spikes.push(SpikeCut {
                    marker: self.label(m),
                    span: self.span(&spike.frames),
                    height_m: spike.height_m,
                    // At the ratio asked for it is as likely as not, and surer with the square of the excess.
                    confidence: 1.0
                        / (1.0 + (options.spike_ratio / spike.ratio) * (options.spike_ratio / spike.ratio)),
                });
            }
        }
    }

    /// Gives pieces back in rounds, as each makes the next gap shorter and tells of its neighbors; what is left is refused.
    fn give_back(
        &mut self,
        head: &HeadCapture,
        options: &CleanOptions,
        progress: &dyn Progress,
    ) -> Vec<UnlabeledTrack> {
        let mut left = head.unlabeled.clone();
        let volume = volume_m3(&self.tracks);
        let open = pieces(&head.unlabeled);
        let done = Counter::new(open.len(), progress);
        let judge_first = |piece: &Piece<'_>| done.after(judge(self.scene(), piece, volume));
        let mut open: Vec<(Verdict, Piece<'_>)> =
            open.into_par_iter().map(|piece| (judge_first(&piece), piece)).collect();
        loop {
            let sure = surest(&open, &self.locks, options.least_confidence);
            if sure.is_empty() {
                open.iter().for_each(|(verdict, piece)| self.refuse(piece, verdict));
                left.retain(|u| u.track.n_valid() > 0);
                return left;
            }
            let mut changed = BTreeSet::new();
            for &(k, marker) in &sure {
                let (verdict, piece) = &open[k];
                self.give(piece, marker, verdict);
                changed.insert(self.locks.markers[marker].strand_idx);
                let given = &mut left[piece.unlabeled_idx].track;
                piece.frames.clone().for_each(|f| given.set(f, None));
            }
            let mut given: Vec<usize> = sure.into_iter().map(|(k, _)| k).collect();
            given.sort_unstable();
            for k in given.into_iter().rev() {
                open.remove(k);
            }
            let is_stale = |verdict: &Verdict| verdict.locks.iter().any(|lock| changed.contains(lock));
            open.par_iter_mut()
                .filter(|(verdict, _)| is_stale(verdict))
                .for_each(|(verdict, piece)| *verdict = judge(self.scene(), piece, volume));
        }
    }

    fn give(&mut self, piece: &Piece<'_>, marker: usize, verdict: &Verdict) {
        for f in piece.frames.clone() {
            self.tracks[marker].set(f, piece.track.at(f));
            self.samples[marker][f] = Sample { kind: SampleKind::GivenBack, error_m: 0.0 };
        }
        self.report.given_back.push(PieceGivenBack {
            piece: piece.label.to_owned(),
            marker: self.label(marker),
            span: self.span(&piece.frames),
            distance_m: verdict.distance_m,
            expected_m: verdict.expected_m,
            confidence: verdict.confidence,
        });
    }

    fn refuse(&mut self, piece: &Piece<'_>, verdict: &Verdict) {
        self.report.ghosts.push(GhostRefused {
            piece: piece.label.to_owned(),
            span: self.span(&piece.frames),
            nearest_marker: verdict.marker.map(|m| self.label(m)),
            confidence: 1.0 - verdict.confidence,
        });
    }

    /// Fills every gap from what was seen: no fill leans on another.
    fn fill_gaps(&mut self, progress: &dyn Progress) {
        let gaps: Vec<(usize, Range<usize>)> = (0..self.tracks.len())
            .flat_map(|m| gaps(&self.tracks[m]).into_iter().map(move |gap| (m, gap)))
            .collect();
        let (scene, done) = (self.scene(), Counter::new(gaps.len(), progress));
        let fill = |marker, gap: &Range<usize>| done.after(fill_gap(scene, marker, gap, gap));
        let fills: Vec<(usize, Range<usize>, Vec<Fill>)> =
            gaps.into_par_iter().map(|(m, gap)| (m, gap.clone(), fill(m, &gap))).collect();
        let borrowed = fills.iter().flat_map(|(_, _, f)| f).map(|f| f.expected_error_m);
        let borrowed = borrowed.filter(|e| e.is_finite()).fold(self.usual_noise_m, f64::max);
        for (marker, gap, parts) in fills {
            if parts.is_empty() {
                let why = "the marker was never seen";
                let unfilled = Unfilled { marker: self.label(marker), span: self.span(&gap), why };
                self.report.unfilled.push(unfilled);
            }
            for fill in parts {
                self.fill(marker, &fill, borrowed);
            }
        }
    }

    /// A fill that could not be tried anywhere borrows the worst error of all others.
    fn fill(&mut self, marker: usize, fill: &Fill, borrowed_m: f64) {
        let known = fill.errors_m.is_some();
        for (k, f) in fill.frames.clone().enumerate() {
            let error_m = fill.errors_m.as_ref().map_or(borrowed_m, |errors| errors[k]);
            self.tracks[marker].set(f, Some(fill.positions[k]));
            self.samples[marker][f] = Sample { kind: SampleKind::Filled, error_m };
        }
        self.report.gaps.push(GapFilled {
            strand: self.locks.strand_name(marker).to_owned(),
            marker: self.label(marker),
            span: self.span(&fill.frames),
            method: fill.method,
            expected_error_m: if known { fill.expected_error_m } else { borrowed_m },
            trials: if known { fill.trials } else { 0 },
            shortened_frames: fill.shortened_frames,
        });
    }

    fn finish(mut self, head: &HeadCapture, unlabeled: Vec<UnlabeledTrack>, n_markers: &[usize]) -> Cleaned {
        for m in 0..self.tracks.len() {
            let seen_error_m = self.noise_m[m].unwrap_or(self.usual_noise_m) * 3f64.sqrt();
            for (s, pose) in self.samples[m].iter_mut().zip(&head.poses) {
                if !matches!(s.kind, SampleKind::Missing | SampleKind::Filled) {
                    let of_pose_m = pose.as_ref().map_or(0.0, |pose| pose.expected_error_m);
                    s.error_m = libm::hypot(seen_error_m, of_pose_m);
                }
            }
        }
        self.report.markers = (0..self.tracks.len()).into_par_iter().map(|m| self.timeline(m)).collect();
        let (mut tracks, mut samples) = (self.tracks.into_iter(), self.samples.into_iter());
        let strands = head.strands.iter().zip(n_markers).map(|(strand, n)| StrandTracks {
            strand_idx: strand.strand_idx,
            markers: tracks.by_ref().take(*n).collect(),
        });
        let strands = strands.collect();
        let head = HeadCapture { strands, unlabeled, poses: head.poses.clone(), ..*head };
        let samples = n_markers.iter().map(|n| samples.by_ref().take(*n).collect()).collect();
        Cleaned { head, samples, report: self.report }
    }

    fn timeline(&self, marker: usize) -> MarkerTimeline {
        let spans = |kind: SampleKind| -> Vec<FrameSpan> {
            let of_kind = |f: usize| self.samples[marker][f].kind == kind;
            runs(self.samples[marker].len(), of_kind).iter().map(|run| self.span(run)).collect()
        };
        MarkerTimeline {
            strand: self.locks.strand_name(marker).to_owned(),
            marker: self.label(marker),
            noise_m: self.noise_m[marker],
            shape_residual_m: self.shape_residual_m(marker),
            seen: spans(SampleKind::Seen),
            mended: spans(SampleKind::Mended),
            given_back: spans(SampleKind::GivenBack),
            filled: spans(SampleKind::Filled),
        }
    }

    fn shape_residual_m(&self, marker: usize) -> Option<f64> {
        let others: Vec<usize> = self.locks.lock_of(marker).filter(|n| *n != marker).collect();
        let (nearest, frames) = (neighbors(marker, &others, 1), 0..self.tracks[marker].n_frames());
        let model = ShapeModel::new(&self.locks, &self.tracks, marker, nearest, frames)?;
        let coefficients = model.without(&(0..0))?;
        let miss =
            |f: usize| Some((model.predict(&coefficients, f)? - self.tracks[marker].at(f)?).norm_squared());
        let squares: Vec<f64> = (0..self.tracks[marker].n_frames())
            .filter(|f| self.samples[marker][*f].kind != SampleKind::Filled)
            .filter_map(miss)
            .collect();
        Some((squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt())
    }
}
