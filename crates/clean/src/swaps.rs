//! Two markers that exchange labels: found where both motions break and each goes on as the other.

use crate::gaps::gaps;
use crate::lock::Locks;
use crate::motion::{Continuity, least_cost};
use std::collections::BTreeSet;
use std::ops::Range;
use tousle_core::Track;

/// Labels exchanged in `frames` (from 0, the end excluded).
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Swap {
    pub markers: [usize; 2],
    pub frames: Range<usize>,
    pub jump_m: f64,
    pub confidence: f64,
}

/// From `frame` on, two tracks hold each other's samples.
#[derive(Clone, Debug)]
struct Exchange {
    markers: [usize; 2],
    frame: usize,
    jump_m: f64,
    confidence: f64,
}

/// Mends all exchanges of labels in place and says which.
///
/// For every break in a marker's motion, every other marker is asked whether both motions together are likelier
/// with their continuations exchanged: by more than the number of such questions in the capture, so that
/// `false_alarms` is how many wrong answers to expect. Which side of an exchange is the right one, the lengths
/// of the locks decide; also whether another exchange of the same pair hides in a gap of theirs, where no break shows.
pub(crate) fn mend_swaps(
    tracks: &mut [Track],
    continuity: &Continuity<'_>,
    locks: &Locks,
    false_alarms: f64,
) -> Vec<Swap> {
    let exchanges = exchanges(tracks, continuity, false_alarms);
    let mut pairs: Vec<[usize; 2]> = exchanges.iter().map(|e| e.markers).collect();
    pairs.sort_unstable();
    pairs.dedup();
    let mut swaps = Vec::new();
    for pair in pairs {
        let mut of_pair: Vec<Exchange> = exchanges.iter().filter(|e| e.markers == pair).cloned().collect();
        let (starts_swapped, hidden) = sides(tracks, pair, &of_pair, locks);
        if starts_swapped {
            exchange_from(tracks, pair, 0);
        }
        hidden.iter().for_each(|exchange| exchange_from(tracks, pair, exchange.frame));
        of_pair.extend(hidden);
        of_pair.sort_by_key(|exchange| exchange.frame);
        swaps.extend(spans(&of_pair, starts_swapped, tracks[0].n_frames()));
    }
    swaps
}

/// What it takes to believe that a pair changed sides in a gap, m times frames: that for a tenth of a second of 120 Hz the two
/// are a centimeter farther from where their locks can be.
const HIDDEN: f64 = 0.12;

/// Whether a pair starts on the wrong side, and where it changes sides unseen: at the ends of their gaps. The least sum of what
/// does not fit over the stretches between them (Viterbi's algorithm over the two sides).
fn sides(tracks: &[Track], pair: [usize; 2], seen: &[Exchange], locks: &Locks) -> (bool, Vec<Exchange>) {
    let n_frames = tracks[pair[0]].n_frames();
    let is_hidden = |frame: &usize| *frame < n_frames && seen.iter().all(|exchange| exchange.frame != *frame);
    let ends = pair.iter().flat_map(|&marker| gaps(&tracks[marker])).map(|gap| gap.end).filter(is_hidden);
    let starts: BTreeSet<usize> = ends.chain([0]).collect();
    let starts: Vec<usize> = starts.into_iter().collect();
    let ends = starts.iter().skip(1).copied().chain([n_frames]);
    let gain = |frames: Range<usize>| locks.better_swapped(tracks, pair, &frames) * frames.len() as f64;
    let gains: Vec<f64> = starts.iter().zip(ends).map(|(start, end)| gain(*start..end)).collect();
    // By stretch and side (as it is, exchanged): the least cost up to its end, and on which side the one before was.
    let mut costs = [0.0, -gains[0]];
    let mut came_from = vec![[0, 1]];
    for gain in &gains[1..] {
        let from =
            [0, 1].map(|side: usize| if costs[1 - side] + HIDDEN < costs[side] { 1 - side } else { side });
        let at =
            [0, 1].map(|side: usize| if from[side] == side { costs[side] } else { costs[1 - side] + HIDDEN });
        costs = [at[0], at[1] - gain];
        came_from.push(from);
    }
    let mut side = usize::from(costs[1] < costs[0]);
    let mut hidden = Vec::new();
    for k in (1..starts.len()).rev() {
        let before = came_from[k][side];
        if before != side {
            let gain = gains[k].abs();
            let jump_m = jump_m(tracks, pair, starts[k]);
            let confidence = gain / (gain + HIDDEN);
            hidden.push(Exchange { markers: pair, frame: starts[k], jump_m, confidence });
        }
        side = before;
    }
    (side == 1, hidden)
}

/// How far apart a pair is when one of them comes back, m: as far as both seem to jump.
fn jump_m(tracks: &[Track], [a, b]: [usize; 2], frame: usize) -> f64 {
    let seen = |track: &Track| (frame..track.n_frames()).find_map(|frame| track.at(frame));
    seen(&tracks[a]).zip(seen(&tracks[b])).map_or(0.0, |(p, q)| (p - q).norm())
}

/// Walks through the frames once, exchanging what follows wherever that is likelier.
fn exchanges(tracks: &mut [Track], continuity: &Continuity<'_>, false_alarms: f64) -> Vec<Exchange> {
    let n_frames = tracks.first().map_or(0, Track::n_frames);
    let questions = (tracks.len() * tracks.len() / 2 * n_frames).max(1) as f64;
    let least_gain = libm::log(questions / false_alarms);
    let mut found = Vec::new();
    for frame in 1..n_frames {
        // Each exchange makes the motion likelier by at least `least_gain`, so this ends.
        while let Some(exchange) = best_exchange(tracks, continuity, frame, least_gain) {
            exchange_from(tracks, exchange.markers, frame);
            found.push(exchange);
        }
    }
    found
}

/// The likeliest exchange at the break of a marker that comes back at `frame`.
fn best_exchange(
    tracks: &[Track],
    continuity: &Continuity<'_>,
    frame: usize,
    least_gain: f64,
) -> Option<Exchange> {
    let broken = |b: &usize| {
        // Asked first, as looking for the ends of a long gap in each of its frames would take the square of it.
        tracks[*b].at(frame)?;
        let ends = step_at(&tracks[*b], frame)?;
        Some(continuity.surprise(*b, &tracks[*b], ends)? > 3.0)
    };
    let broken: Vec<usize> = (0..tracks.len()).filter(|b| broken(b) == Some(true)).collect();
    if broken.is_empty() {
        return None;
    }
    let steps: Vec<Option<Step>> =
        (0..tracks.len()).map(|m| Step::of(tracks, continuity, frame, m)).collect();
    let mut best: Option<(f64, Exchange)> = None;
    for b in broken {
        let of_b = steps[b].as_ref()?;
        for (a, of_a) in steps.iter().enumerate().filter(|(a, _)| *a != b) {
            let gain = of_a.as_ref().and_then(|of_a| of_a.gain(of_b, tracks, continuity, least_gain));
            if let Some(gain) = gain.filter(|gain| best.as_ref().is_none_or(|(most, _)| gain > most)) {
                let jump_m = (tracks[b].at(frame)? - tracks[b].at(of_b.ends.0)?).norm();
                let odds = libm::exp((least_gain - gain).max(-50.0));
                let confidence = 1.0 / (1.0 + odds);
                best = Some((gain, Exchange { markers: [a.min(b), a.max(b)], frame, jump_m, confidence }));
            }
        }
    }
    best.map(|(_, exchange)| exchange)
}

/// More than rounding does to costs.
const ROUNDING: f64 = 1e-6;

/// A marker's motion at a frame as it is labeled.
struct Step {
    marker: usize,
    /// As [`step_at`] gives them.
    ends: (usize, usize),
    cost: f64,
}

impl Step {
    fn of(tracks: &[Track], continuity: &Continuity<'_>, frame: usize, marker: usize) -> Option<Self> {
        let track = &tracks[marker];
        let ends = step_at(track, frame)?;
        Some(Self { marker, ends, cost: continuity.cost(marker, track, track, ends)? })
    }

    /// By how much (in nats) both motions are likelier with their continuations exchanged, if by more than `least_gain`.
    fn gain(
        &self,
        other: &Self,
        tracks: &[Track],
        continuity: &Continuity<'_>,
        least_gain: f64,
    ) -> Option<f64> {
        let as_labeled = self.cost + other.cost;
        let ends = [(self.ends.0, other.ends.1), (other.ends.0, self.ends.1)];
        let (a, b) = (self.marker, other.marker);
        // Most are so far apart that it shows before any scale is asked for.
        let least =
            least_cost(&tracks[a], &tracks[b], ends[0])? + least_cost(&tracks[b], &tracks[a], ends[1])?;
        if as_labeled - least < least_gain - ROUNDING {
            return None;
        }
        let cost = |from: usize, to: usize, ends| continuity.cost(from, &tracks[from], &tracks[to], ends);
        let exchanged = cost(a, b, ends[0])? + cost(b, a, ends[1])?;
        Some(as_labeled - exchanged).filter(|gain| *gain > least_gain)
    }
}

/// The two neighboring seen frames with `start < frame <= end`.
fn step_at(track: &Track, frame: usize) -> Option<(usize, usize)> {
    let start = (0..frame).rev().find(|&f| track.at(f).is_some())?;
    let end = (frame..track.n_frames()).find(|&f| track.at(f).is_some())?;
    Some((start, end))
}

fn exchange_from(tracks: &mut [Track], [a, b]: [usize; 2], frame: usize) {
    for f in frame..tracks[a].n_frames() {
        let (at_a, at_b) = (tracks[a].at(f), tracks[b].at(f));
        tracks[a].set(f, at_b);
        tracks[b].set(f, at_a);
    }
}

/// The spans in which the file's labels were wrong.
fn spans(exchanges: &[Exchange], starts_swapped: bool, n_frames: usize) -> Vec<Swap> {
    let mut swaps = Vec::new();
    let mut open: Option<(usize, &Exchange)> = None;
    if starts_swapped {
        open = exchanges.first().map(|e| (0, e));
    }
    for exchange in exchanges {
        match open.take() {
            None => open = Some((exchange.frame, exchange)),
            Some((start, began)) => swaps.push(swap(began, start..exchange.frame, exchange.confidence)),
        }
    }
    if let Some((start, began)) = open {
        swaps.push(swap(began, start..n_frames, began.confidence));
    }
    swaps
}

fn swap(began: &Exchange, frames: Range<usize>, confidence: f64) -> Swap {
    let confidence = began.confidence.min(confidence);
    Swap { markers: began.markers, frames, jump_m: began.jump_m, confidence }
}
