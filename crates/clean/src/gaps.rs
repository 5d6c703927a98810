//! Gaps filled from the lock's own shape, each with the error that the same fill makes where the truth is seen.

use crate::interpolate::{End, carry};
use crate::learned::Learned;
use crate::lock::Locks;
use crate::report::FillMethod;
use crate::shape::{Coefficients, ShapeModel, neighbors};
use std::ops::Range;
use tousle_core::{Track, Vec3, runs};

/// Trials of each method for each gap. More would tell the error closer and take longer.
const MOST_TRIALS: usize = 32;
/// Fewer tell nothing.
const LEAST_TRIALS: usize = 4;

/// What filling looks at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scene<'a> {
    pub locks: &'a Locks,
    pub tracks: &'a [Track],
    /// First and last still frame (from 0, both included): how hair hangs says nothing of how it flies.
    pub still: Option<(usize, usize)>,
}

/// A filled gap, or the part of it in which the same neighbors are seen.
#[derive(Clone, Debug)]
pub(crate) struct Fill {
    pub frames: Range<usize>,
    pub positions: Vec<Vec3>,
    /// Expected error a frame, m; `None` if no trial could be made.
    pub errors_m: Option<Vec<f64>>,
    pub method: FillMethod,
    pub expected_error_m: f64,
    pub trials: usize,
    pub shortened_frames: usize,
}

/// The frames in which a track has no sample, in order.
pub(crate) fn gaps(track: &Track) -> Vec<Range<usize>> {
    runs(track.n_frames(), |f| track.at(f).is_none())
}

/// Fills one gap of one marker, part by part, where parts hold some of the `wanted` frames; empty if the marker was never seen.
pub(crate) fn fill_gap(
    scene: Scene<'_>,
    target: usize,
    gap: &Range<usize>,
    wanted: &Range<usize>,
) -> Vec<Fill> {
    let lock = scene.locks.lock_of(target);
    let seen_at = |f: usize| -> Vec<usize> {
        lock.clone().filter(|&n| n != target && scene.tracks[n].at(f).is_some()).collect()
    };
    let mut learned = Learned::round(scene, target, gap);
    let mut fills = Vec::new();
    let mut start = gap.start;
    while start < gap.end.min(wanted.end) {
        let seen = seen_at(start);
        let end = (start..gap.end).find(|&f| seen_at(f) != seen).unwrap_or(gap.end);
        if end > wanted.start {
            fills.extend(fill_run(&mut learned, start..end, &seen));
        }
        start = end;
    }
    fills
}

fn fill_run(learned: &mut Learned<'_>, run: Range<usize>, seen: &[usize]) -> Option<Fill> {
    let [nearest, more] = [1, 2].map(|per_side| neighbors(learned.target, seen, per_side));
    learned.learn(&nearest);
    learned.learn(&more);
    let mut fill = best_fill(learned, run, [&nearest, &more])?;
    fill.shortened_frames = hold_to_length(learned, &fill.frames, seen, &mut fill.positions);
    Some(fill)
}

/// What the best of all methods fills a run with, tried where the marker is seen.
fn best_fill(learned: &Learned<'_>, run: Range<usize>, [nearest, more]: [&[usize]; 2]) -> Option<Fill> {
    // Where there are no more neighbors than the nearest, both models are the same.
    let near = if nearest == more { None } else { learned.model(nearest) };
    let wide = learned.model(more);
    // Of methods that nowhere can be tried, the first one is taken: it never runs away.
    let by_model = [
        (wide.map(Some), [(FillMethod::Lock, LINE), (FillMethod::LockCubic, CUBIC)]),
        (near.map(Some), [(FillMethod::NeighborsCubic, CUBIC), (FillMethod::Neighbors, LINE)]),
        (Some(None), [(FillMethod::Cubic, CUBIC), (FillMethod::Line, LINE)]),
    ];
    let mut best: Option<(Trials, Filler<'_>, FillMethod, usize)> = None;
    for (model, methods) in by_model {
        let filler = model.and_then(|model| Filler::new(learned, run.clone(), model));
        let Some(filler) = filler else { continue };
        let trials = filler.trials();
        for (method, shape) in methods {
            if best.as_ref().is_none_or(|(least, ..)| trials[shape].better_than(least)) {
                best = Some((trials[shape].clone(), filler.clone(), method, shape));
            }
        }
    }
    let (trials, filler, method, shape) = best?;
    let coefficients = filler.learn(0..0);
    let fill = filler.moved(coefficients.as_ref(), 0)?;
    let positions = run.clone().map(|f| Some(fill.at(f)?[shape])).collect::<Option<_>>()?;
    // The lock was where it never was in the trials: they tell too little, by as much as the regression says.
    let novelty = filler.novelty(coefficients.as_ref(), run.clone());
    let strange = if novelty > trials.novelty() { (novelty / trials.novelty()).sqrt() } else { 1.0 };
    Some(Fill {
        frames: run,
        positions,
        expected_error_m: trials.rms().map_or(f64::NAN, |rms| rms * strange),
        errors_m: trials.per_frame().map(|errors| errors.into_iter().map(|e| e * strange).collect()),
        method,
        trials: trials.n,
        shortened_frames: 0,
    })
}

/// Draws positions to where the lock's length lets the marker be; how many frames it had to.
fn hold_to_length(
    learned: &mut Learned<'_>,
    run: &Range<usize>,
    seen: &[usize],
    positions: &mut [Vec3],
) -> usize {
    let (scene, target) = (learned.scene, learned.target);
    let nearest = [seen.iter().rev().find(|n| **n < target), seen.iter().find(|n| **n > target)];
    let mut limits: Vec<(Option<usize>, f64)> =
        nearest.into_iter().flatten().map(|&n| (Some(n), learned.reach_m(Some(n)))).collect();
    limits.push((None, learned.reach_m(None)));
    let mut n_shortened = 0;
    for (f, p) in run.clone().zip(positions) {
        let before = *p;
        // Three rounds bring a point within all three spheres to a hundredth of what it was outside.
        for (other, reach_m) in limits.iter().cycle().take(3 * limits.len()) {
            let anchor = other.map_or(Some(scene.locks.root_m(target)), |n| scene.tracks[n].at(f));
            let Some(anchor) = anchor else { continue };
            let arm = *p - anchor;
            if arm.norm() > *reach_m {
                *p = anchor + arm * (reach_m / arm.norm());
            }
        }
        n_shortened += usize::from(*p != before);
    }
    n_shortened
}

/// What is carried over a run goes on a line or as a cubic: where of two answers either is.
const LINE: usize = 0;
const CUBIC: usize = 1;

/// What fills one run of frames, on a line and as a cubic, and can be tried at other times.
#[derive(Clone)]
struct Filler<'a> {
    scene: Scene<'a>,
    target: usize,
    run: Range<usize>,
    /// Where it may be tried.
    within: Range<usize>,
    model: Option<&'a ShapeModel<'a>>,
    left: Option<usize>,
    right: Option<usize>,
}

impl<'a> Filler<'a> {
    /// `None` without a seen frame on either side.
    fn new(learned: &'a Learned<'_>, run: Range<usize>, model: Option<&'a ShapeModel<'a>>) -> Option<Self> {
        let Learned { scene, target, .. } = *learned;
        let track = &scene.tracks[target];
        let anchor = |f: &usize| track.at(*f).is_some() && model.is_none_or(|m| m.applies(*f));
        let left = (0..run.start).rev().find(anchor);
        let right = (run.end..track.n_frames()).find(anchor);
        left.or(right)?;
        Some(Self { scene, target, run, within: learned.frames.clone(), model, left, right })
    }

    /// What the neighbors tell, learned without the frames in `hidden`.
    fn learn(&self, hidden: Range<usize>) -> Option<Coefficients> {
        self.model?.without(&hidden)
    }

    /// The fill, all of it moved in time by `shift`; `None` where an end is missing.
    fn moved<'b>(&'b self, coefficients: Option<&'b Coefficients>, shift: isize) -> Option<Moved<'b>> {
        let fill = Moved { filler: self, coefficients, shift, left: None, right: None };
        let end = |anchor: Option<usize>, before| match anchor {
            Some(anchor) => fill.end(anchor, before).map(Some),
            None => Some(None),
        };
        let (left, right) = (end(self.left, true)?, end(self.right, false)?);
        Some(Moved { left, right, ..fill })
    }

    /// Whether a frame can be compared when the fill is tried there: the marker and what the model needs are seen.
    fn can_be_tried(&self, frame: usize) -> bool {
        self.scene.tracks[self.target].at(frame).is_some() && self.model.is_none_or(|m| m.applies(frame))
    }

    /// Mean novelty of the lock's shape in some frames; 0 for methods that do not look at it.
    fn novelty(&self, coefficients: Option<&Coefficients>, frames: Range<usize>) -> f64 {
        self.model.zip(coefficients).map_or(0.0, |(model, coefficients)| model.novelty(coefficients, frames))
    }

    /// The same fill at other times, where the marker was seen, compared with what was seen.
    ///
    /// Runs in the still interval are tried there, others elsewhere, and everywhere if that is too little to
    /// tell; what is to be filled is learned without. Whatever goes as a line is tried as a cubic in the same places.
    fn trials(&self) -> [Trials; 2] {
        let first = self.left.unwrap_or(self.run.start);
        let last = self.right.unwrap_or(self.run.end - 1);
        let n_shifts = self.within.len() - (last - first);
        // Twice as many places are looked at as trials are wanted, as half of them may be hidden.
        let n_places = n_shifts.min(2 * MOST_TRIALS);
        let shifts =
            (0..n_places).map(|k| (self.within.start + k * n_shifts / n_places) as isize - first as isize);
        let moved = |f: usize, shift: isize| f.saturating_add_signed(shift);
        let (like, unlike): (Vec<isize>, Vec<isize>) = shifts
            .filter(|s| {
                moved(self.run.start, *s) >= self.run.end || moved(self.run.end, *s) <= self.run.start
            })
            .partition(|s| {
                self.is_still(&(moved(self.run.start, *s)..moved(self.run.end, *s)))
                    == self.is_still(&self.run)
            });
        let mut trials = [LINE, CUBIC].map(|_| Trials::new(self.run.len()));
        for (shifts, enough) in [(like, MOST_TRIALS), (unlike, LEAST_TRIALS)] {
            for shift in shifts {
                if trials[LINE].n < enough {
                    self.try_at(shift, moved(self.run.start, shift)..moved(self.run.end, shift), &mut trials);
                }
            }
        }
        trials
    }

    fn is_still(&self, run: &Range<usize>) -> bool {
        self.scene.still.is_some_and(|(first, last)| first <= run.start && run.end <= last + 1)
    }

    fn try_at(&self, shift: isize, moved_run: Range<usize>, trials: &mut [Trials; 2]) {
        // A trial of which most is hidden is none; nor is one without an end.
        let n_seen = moved_run.clone().filter(|f| self.can_be_tried(*f)).count();
        let ends = [self.left, self.right].into_iter().flatten();
        let has_ends = || {
            let mut moved = ends.map(|anchor| anchor.checked_add_signed(shift));
            moved.all(|f| f.is_some_and(|f| self.can_be_tried(f)))
        };
        if 2 * n_seen <= moved_run.len() || !has_ends() {
            return;
        }
        let coefficients = self.learn(moved_run.clone());
        let Some(fill) = self.moved(coefficients.as_ref(), shift) else { return };
        let novelty = self.novelty(coefficients.as_ref(), moved_run.clone());
        trials.iter_mut().for_each(|trials| trials.begin(novelty));
        for (k, (frame, moved)) in self.run.clone().zip(moved_run).enumerate() {
            let seen = self.scene.tracks[self.target].at(moved);
            let Some((seen, told)) = seen.and_then(|seen| Some((seen, fill.at(frame)?))) else { continue };
            for (trials, told) in trials.iter_mut().zip(told) {
                trials.add(k, (told - seen).norm_squared());
            }
        }
    }
}

/// A fill at another time.
struct Moved<'a> {
    filler: &'a Filler<'a>,
    coefficients: Option<&'a Coefficients>,
    shift: isize,
    left: Option<End>,
    right: Option<End>,
}

impl Moved<'_> {
    /// The fill in a frame of the run, on a line and as a cubic; `None` where something is missing.
    fn at(&self, frame: usize) -> Option<[Vec3; 2]> {
        let f = frame.checked_add_signed(self.shift)?;
        let told = self.told(f)?;
        Some([told + carry(self.left, self.right, f, false)?, told + carry(self.left, self.right, f, true)?])
    }

    /// What the neighbors tell.
    fn told(&self, f: usize) -> Option<Vec3> {
        match self.filler.model {
            Some(model) => model.predict(self.coefficients?, f),
            None => Some(Vec3::zeros()),
        }
    }

    /// By how much they miss where the marker is seen, at an end of the run.
    fn end(&self, anchor: usize, before: bool) -> Option<End> {
        let miss = |f: usize| Some(self.filler.scene.tracks[self.filler.target].at(f)? - self.told(f)?);
        let f = anchor.checked_add_signed(self.shift)?;
        let value = miss(f)?;
        // Two frames away: half the noise of one frame, and still of the moment.
        let away = if before { f.checked_sub(2) } else { f.checked_add(2) };
        let slope = away.and_then(miss).map_or(Vec3::zeros(), |other| {
            if before { (value - other) / 2.0 } else { (other - value) / 2.0 }
        });
        Some(End { frame: f, value, slope })
    }
}

/// Squared errors of trials, frame by frame.
#[derive(Clone, Debug)]
struct Trials {
    n: usize,
    sums: Vec<f64>,
    counts: Vec<f64>,
    novelties: f64,
}

impl Trials {
    fn new(n_frames: usize) -> Self {
        Self { n: 0, sums: vec![0.0; n_frames], counts: vec![0.0; n_frames], novelties: 0.0 }
    }

    /// Begins another one.
    fn begin(&mut self, novelty: f64) {
        self.n += 1;
        self.novelties += novelty;
    }

    /// Adds what it is off by in frame `k` of the run.
    fn add(&mut self, k: usize, square: f64) {
        self.sums[k] += square;
        self.counts[k] += 1.0;
    }

    /// Mean novelty of the lock's shape over the trials.
    fn novelty(&self) -> f64 {
        self.novelties / self.n.max(1) as f64
    }

    fn rms(&self) -> Option<f64> {
        let count: f64 = self.counts.iter().sum();
        (self.n >= LEAST_TRIALS).then(|| (self.sums.iter().sum::<f64>() / count).sqrt())
    }

    /// Expected error in each frame, m: that frame's own, with the whole run's counted in as four trials.
    fn per_frame(&self) -> Option<Vec<f64>> {
        let whole = self.rms()?;
        let weight = LEAST_TRIALS as f64;
        let frame = |(sum, n): (&f64, &f64)| ((sum + weight * whole * whole) / (n + weight)).sqrt();
        Some(self.sums.iter().zip(&self.counts).map(frame).collect())
    }

    /// A method that could be tried is preferred to one that could not.
    fn better_than(&self, other: &Self) -> bool {
        match (self.rms(), other.rms()) {
            (Some(a), Some(b)) => a < b,
            (a, b) => a.is_some() && b.is_none(),
        }
    }
}
