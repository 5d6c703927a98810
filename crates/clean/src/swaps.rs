//! Two markers that exchange labels: found where both motions break and each goes on as the other.

use crate::lock::Locks;
use crate::motion::Continuity;
use rayon::prelude::*;
use tousle_core::Track;

/// Labels exchanged in `frames` (from 0, the end excluded).
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Swap {
    pub markers: [usize; 2],
    pub frames: std::ops::Range<usize>,
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
/// of the locks decide.
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
        let of_pair: Vec<&Exchange> = exchanges.iter().filter(|e| e.markers == pair).collect();
        let starts_swapped = locks.misfit_swapped(tracks, pair) < locks.misfit(tracks, pair);
        if starts_swapped {
            exchange_from(tracks, pair, 0);
        }
        swaps.extend(spans(&of_pair, starts_swapped, tracks[0].n_frames()));
    }
    swaps
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
    let mut best: Option<(f64, Exchange)> = None;
    for b in (0..tracks.len()).filter(|b| broken(b) == Some(true)) {
        let gain = |a: usize| if a == b { None } else { gain(tracks, continuity, frame, a, b) };
        let gains: Vec<Option<f64>> = (0..tracks.len()).into_par_iter().map(gain).collect();
        for (a, gain) in gains.into_iter().enumerate() {
            let Some(gain) = gain else { continue };
            if gain > least_gain && best.as_ref().is_none_or(|(g, _)| gain > *g) {
                let jump_m = (tracks[b].at(frame)? - tracks[b].at(step_at(&tracks[b], frame)?.0)?).norm();
                let odds = libm::exp((least_gain - gain).max(-50.0));
                let confidence = 1.0 / (1.0 + odds);
                best = Some((gain, Exchange { markers: [a.min(b), a.max(b)], frame, jump_m, confidence }));
            }
        }
    }
    best.map(|(_, exchange)| exchange)
}

/// By how much (in nats) both motions are likelier with their continuations exchanged.
fn gain(tracks: &[Track], continuity: &Continuity<'_>, frame: usize, a: usize, b: usize) -> Option<f64> {
    let (ends_a, ends_b) = (step_at(&tracks[a], frame)?, step_at(&tracks[b], frame)?);
    let cost = |from: usize, to: usize, ends| continuity.cost(from, &tracks[from], &tracks[to], ends);
    let as_labeled = cost(a, a, ends_a)? + cost(b, b, ends_b)?;
    let exchanged = cost(a, b, (ends_a.0, ends_b.1))? + cost(b, a, (ends_b.0, ends_a.1))?;
    Some(as_labeled - exchanged)
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
fn spans(exchanges: &[&Exchange], starts_swapped: bool, n_frames: usize) -> Vec<Swap> {
    let mut swaps = Vec::new();
    let mut open: Option<(usize, &Exchange)> = None;
    if starts_swapped {
        open = exchanges.first().map(|e| (0, *e));
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

fn swap(began: &Exchange, frames: std::ops::Range<usize>, confidence: f64) -> Swap {
    let confidence = began.confidence.min(confidence);
    Swap { markers: began.markers, frames, jump_m: began.jump_m, confidence }
}
