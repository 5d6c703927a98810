//! Where a marker is, told from its neighbors on the lock.

use crate::lock::Locks;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use std::ops::Range;
use tousle_core::{Track, Vec3};

/// A linear prediction of one marker from some neighbors: the point that divides the hair between the nearest
/// two as the session says, plus an offset that depends linearly on where the neighbors are.
///
/// The offset's dependence is learned from the frames in which all of them are seen, by ridge regression: what
/// those frames do not tell stays near zero. Sums over frames are kept, so that leaving some out is cheap.
#[derive(Debug)]
pub(crate) struct ShapeModel<'a> {
    locks: &'a Locks,
    tracks: &'a [Track],
    target: usize,
    neighbors: Vec<usize>,
    /// What the model goes by in each frame; `None` where a neighbor is not seen.
    frames: Vec<Option<Around>>,
    gram: DMatrix<f64>,
    cross: DMatrix<f64>,
    squares: f64,
    n_rows: usize,
}

/// What a [`ShapeModel`] sees of its target's neighbors in a frame.
#[derive(Debug)]
struct Around {
    /// Where they are, less where they are on average, m; then 1.
    features: DVector<f64>,
    /// The point that the session's distances say, m.
    base_m: Vec3,
    /// How far the target is from there, m, if it is seen.
    offset_m: Option<Vec3>,
}

impl Around {
    /// The features and the offset of a frame to learn from.
    fn row(&self) -> Option<(&DVector<f64>, Vec3)> {
        Some((&self.features, self.offset_m?))
    }
}

/// The learned offset.
#[derive(Clone, Debug)]
pub(crate) struct Coefficients {
    of_features: DMatrix<f64>,
    gram: Cholesky<f64, Dyn>,
}

impl<'a> ShapeModel<'a> {
    /// The model of `target` from at most `per_side` seen neighbors on either side; `None` without any, or if
    /// they are seen together too rarely.
    pub(crate) fn new(
        locks: &'a Locks,
        tracks: &'a [Track],
        target: usize,
        seen: &[usize],
        per_side: usize,
    ) -> Option<Self> {
        let below = seen.iter().rev().copied().filter(|n| *n < target).take(per_side);
        let above = seen.iter().copied().filter(|n| *n > target).take(per_side);
        let mut neighbors: Vec<usize> = below.chain(above).collect();
        neighbors.sort_unstable();
        if neighbors.is_empty() {
            return None;
        }
        let width = 3 * neighbors.len() + 1;
        let mut model = Self {
            locks,
            tracks,
            target,
            neighbors,
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
        let n_frames = self.tracks[self.target].n_frames();
        let features: Vec<Option<DVector<f64>>> = (0..n_frames).map(|f| self.raw_features(f)).collect();
        let n = features.iter().flatten().count().max(1) as f64;
        let mut center =
            features.iter().flatten().fold(DVector::zeros(self.cross.nrows()), |sum, x| sum + x) / n;
        let last = center.len() - 1;
        center[last] = 0.0;
        let around = |(frame, features): (usize, Option<DVector<f64>>)| {
            let base_m = self.base(frame)?;
            let offset_m = self.tracks[self.target].at(frame).map(|place_m| place_m - base_m);
            Some(Around { features: features? - &center, base_m, offset_m })
        };
        self.frames = features.into_iter().enumerate().map(around).collect();
        for (x, y) in self.frames.iter().flatten().filter_map(Around::row) {
            self.gram.ger(1.0, x, x, 1.0);
            self.cross.ger(1.0, x, &y, 1.0);
            self.squares += y.norm_squared();
            self.n_rows += 1;
        }
    }

    /// Whether every neighbor is seen in a frame.
    pub(crate) fn applies(&self, frame: usize) -> bool {
        self.around(frame).is_some()
    }

    /// The offset learned from all frames but some.
    pub(crate) fn without(&self, hidden: &Range<usize>) -> Option<Coefficients> {
        let (mut gram, mut cross) = (self.gram.clone(), self.cross.clone());
        let (mut n, mut squares) = (self.n_rows, self.squares);
        let within = hidden.start.min(self.frames.len())..hidden.end.min(self.frames.len());
        for (x, y) in self.frames[within].iter().flatten().filter_map(Around::row) {
            gram.ger(-1.0, x, x, 1.0);
            cross.ger(-1.0, x, &y, 1.0);
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
        let Around { features, base_m, .. } = self.around(frame)?;
        Some(base_m + Vec3::from_fn(|axis, _| coefficients.of_features.column(axis).dot(features)))
    }

    /// How far the neighbors in a frame are from where they were in the frames that were learned from: the share
    /// of the offset's variance that this adds to a prediction, up to a factor (the regression's leverage).
    pub(crate) fn novelty(&self, coefficients: &Coefficients, frame: usize) -> Option<f64> {
        let x = &self.around(frame)?.features;
        Some(coefficients.gram.solve(x).dot(x))
    }

    fn around(&self, frame: usize) -> Option<&Around> {
        self.frames.get(frame)?.as_ref()
    }

    fn raw_features(&self, frame: usize) -> Option<DVector<f64>> {
        let mut x = DVector::zeros(self.cross.nrows());
        for (k, n) in self.neighbors.iter().enumerate() {
            x.fixed_rows_mut::<3>(3 * k).copy_from(&self.tracks[*n].at(frame)?);
        }
        x[3 * self.neighbors.len()] = 1.0;
        Some(x)
    }

    /// The point that divides the hair between the nearest neighbors (or the root and one, or carries the last
    /// two on beyond) as the session's distances say.
    fn base(&self, frame: usize) -> Option<Vec3> {
        let arc = |n: usize| self.locks.markers[n].arc_m;
        let below = self.neighbors.iter().rev().copied().filter(|n| *n < self.target);
        let above = self.neighbors.iter().copied().find(|n| *n > self.target);
        let mut anchors: Vec<(f64, Vec3)> = Vec::with_capacity(3);
        for n in above.into_iter().chain(below) {
            anchors.push((arc(n), self.tracks[n].at(frame)?));
        }
        anchors.push((0.0, self.locks.root_m(self.target)));
        let [(s0, p0), (s1, p1)] = [anchors[0], anchors[1]];
        if (s0 - s1).abs() < 1e-6 {
            return Some(p0);
        }
        Some(p1 + (p0 - p1) * ((arc(self.target) - s1) / (s0 - s1)))
    }
}
