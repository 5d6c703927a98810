//! Where a marker is, told from its neighbors on the lock.

use crate::lock::Locks;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use std::ops::Range;
use tousle_core::{Track, Vec3};

/// A linear prediction of one marker from some neighbors: the point that divides the hair between the nearest
/// two as the session says, plus an offset that depends linearly on where the neighbors are.
///
/// The offset's dependence is learned from the frames in which all of them are seen, by ridge regression: what
/// those frames do not tell stays near zero. Only some frames are looked at. Sums over frames are kept, so that leaving some out is cheap.
#[derive(Debug)]
pub(crate) struct ShapeModel<'a> {
    locks: &'a Locks,
    tracks: &'a [Track],
    target: usize,
    neighbors: Vec<usize>,
    /// The first of the frames that are looked at.
    first: usize,
    /// Column by column, where the neighbors are in each frame, less where they are on average, m; then 1. Nothing where one
    /// is not seen.
    features: DMatrix<f64>,
    /// By frame, what the session says of the target; `None` where a neighbor is not seen.
    frames: Vec<Option<Around>>,
    gram: DMatrix<f64>,
    cross: DMatrix<f64>,
    squares: f64,
    n_rows: usize,
}

/// What a [`ShapeModel`] sees of its target in a frame.
#[derive(Clone, Copy, Debug)]
struct Around {
    /// The point that the session's distances say, m.
    base_m: Vec3,
    /// How far the target is from there, m, if it is seen.
    offset_m: Option<Vec3>,
}

/// The learned offset.
#[derive(Clone, Debug)]
pub(crate) struct Coefficients {
    of_features: DMatrix<f64>,
    gram: Cholesky<f64, Dyn>,
}

/// At most `per_side` of the seen markers of a lock on either side of one of it, root to tip.
pub(crate) fn neighbors(target: usize, seen: &[usize], per_side: usize) -> Vec<usize> {
    let below = seen.iter().rev().copied().filter(|n| *n < target).take(per_side);
    let above = seen.iter().copied().filter(|n| *n > target).take(per_side);
    let mut neighbors: Vec<usize> = below.chain(above).collect();
    neighbors.sort_unstable();
    neighbors
}

impl<'a> ShapeModel<'a> {
    /// The model of `target` from some [`neighbors`] in some frames; `None` without any, or if they are seen together there too
    /// rarely.
    pub(crate) fn new(
        locks: &'a Locks,
        tracks: &'a [Track],
        target: usize,
        neighbors: Vec<usize>,
        frames: Range<usize>,
    ) -> Option<Self> {
        if neighbors.is_empty() {
            return None;
        }
        let width = 3 * neighbors.len() + 1;
        let mut model = Self {
            locks,
            tracks,
            target,
            neighbors,
            first: frames.start,
            features: DMatrix::zeros(width, frames.len()),
            frames: Vec::new(),
            gram: DMatrix::zeros(width, width),
            cross: DMatrix::zeros(width, 3),
            squares: 0.0,
            n_rows: 0,
        };
        model.learn();
        (model.n_rows > 2 * width).then_some(model)
    }

    fn learn(&mut self) {
        self.frames = (0..self.features.ncols()).map(|column| self.look(column)).collect();
        let seen: Vec<usize> = (0..self.frames.len()).filter(|c| self.frames[*c].is_some()).collect();
        let mut center = DVector::zeros(self.features.nrows());
        seen.iter().for_each(|c| center += self.features.column(*c));
        center /= seen.len().max(1) as f64;
        let last = center.len() - 1;
        center[last] = 0.0;
        for c in seen {
            let mut column = self.features.column_mut(c);
            column -= &center;
        }
        for (c, around) in self.frames.iter().enumerate() {
            let Some(y) = around.as_ref().and_then(|around| around.offset_m) else { continue };
            let x = self.features.column(c);
            self.gram.ger(1.0, &x, &x, 1.0);
            self.cross.ger(1.0, &x, &y, 1.0);
            self.squares += y.norm_squared();
            self.n_rows += 1;
        }
    }

    /// Notes where the neighbors are in the frame of a column.
    fn look(&mut self, column: usize) -> Option<Around> {
        let frame = self.first + column;
        let places_m = self.neighbors.iter().map(|n| self.tracks[*n].at(frame));
        if places_m.clone().any(|place_m| place_m.is_none()) {
            return None;
        }
        let mut column = self.features.column_mut(column);
        for (k, place_m) in places_m.flatten().enumerate() {
            column.fixed_rows_mut::<3>(3 * k).copy_from(&place_m);
        }
        column[3 * self.neighbors.len()] = 1.0;
        let base_m = self.base(frame)?;
        let offset_m = self.tracks[self.target].at(frame).map(|place_m| place_m - base_m);
        Some(Around { base_m, offset_m })
    }

    /// The offset of a frame to learn from.
    fn offset_m(&self, frame: usize) -> Option<Vec3> {
        self.around(frame)?.offset_m
    }

    /// Whether every neighbor is seen in a frame.
    pub(crate) fn applies(&self, frame: usize) -> bool {
        self.around(frame).is_some()
    }

    /// The offset learned from all frames but some.
    pub(crate) fn without(&self, hidden: &Range<usize>) -> Option<Coefficients> {
        let (mut gram, mut cross) = (self.gram.clone(), self.cross.clone());
        let (mut n, mut squares) = (self.n_rows, self.squares);
        for frame in hidden.clone() {
            let Some(y) = self.offset_m(frame) else { continue };
            let x = self.features.column(frame - self.first);
            gram.ger(-1.0, &x, &x, 1.0);
            cross.ger(-1.0, &x, &y, 1.0);
            squares -= y.norm_squared();
            n -= 1;
        }
        if n <= gram.nrows() {
            return None;
        }
        // A neighbor's displacement moves the offset by about as much, at most: coefficients of order one.
        // Against offsets of this variance that is a ridge of their variance a coefficient.
        let mean_square = cross.row(cross.nrows() - 1).norm_squared() / (n * n) as f64;
        let ridge = (squares / n as f64 - mean_square).max(1e-12) / 3.0;
        let width = gram.nrows();
        for k in 0..width {
            // The constant is not held back, or markers would be drawn to where hands measured them.
            gram[(k, k)] += if k + 1 == width { 1e-9 } else { ridge };
        }
        let gram = gram.cholesky()?;
        Some(Coefficients { of_features: gram.solve(&cross), gram })
    }

    /// Where the target is in a frame, head space, m; `None` if a neighbor is not seen.
    pub(crate) fn predict(&self, coefficients: &Coefficients, frame: usize) -> Option<Vec3> {
        let Around { base_m, .. } = self.around(frame)?;
        let features = self.features.column(frame - self.first);
        Some(base_m + Vec3::from_fn(|axis, _| coefficients.of_features.column(axis).dot(&features)))
    }

    /// How far the neighbors are in some frames from where they were in the frames that were learned from: the share
    /// of the offset's variance that this adds to a prediction, up to a factor (the regression's leverage), on average over the
    /// frames in which all are seen; 0 without any.
    pub(crate) fn novelty(&self, coefficients: &Coefficients, frames: Range<usize>) -> f64 {
        let features = self.features.columns_range(frames.start - self.first..frames.end - self.first);
        let mut solved = features.into_owned();
        coefficients.gram.solve_mut(&mut solved);
        let seen = frames.enumerate().filter(|(_, frame)| self.applies(*frame));
        let each: Vec<f64> = seen.map(|(k, _)| solved.column(k).dot(&features.column(k))).collect();
        each.iter().sum::<f64>() / each.len().max(1) as f64
    }

    fn around(&self, frame: usize) -> Option<Around> {
        *self.frames.get(frame.checked_sub(self.first)?)?
    }

    /// The point that divides the hair between the nearest neighbors (or the root and one, or carries the last
    /// two on beyond) as the session's distances say.
    fn base(&self, frame: usize) -> Option<Vec3> {
        let arc = |n: usize| self.locks.markers[n].arc_m;
        let below = self.neighbors.iter().rev().copied().filter(|n| *n < self.target);
        let above = self.neighbors.iter().copied().find(|n| *n > self.target);
        let seen = above.into_iter().chain(below).map(|n| Some((arc(n), self.tracks[n].at(frame)?)));
        let root = Some((0.0, self.locks.root_m(self.target)));
        let mut anchors = seen.chain(core::iter::once(root));
        let ((s0, p0), (s1, p1)) = (anchors.next()??, anchors.next()??);
        if (s0 - s1).abs() < 1e-6 {
            return Some(p0);
        }
        Some(p1 + (p0 - p1) * ((arc(self.target) - s1) / (s0 - s1)))
    }
}
