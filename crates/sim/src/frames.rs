//! What a run hands out: frames of single-precision positions, and what they say of stretch.

use rayon::prelude::*;
use tousle_core::{Groom, StrandMotion, Vec3};

/// A point as the result holds it.
pub(crate) fn single(point: Vec3) -> [f32; 3] {
    point.map(|c| c as f32).into()
}

/// The largest change of any stick's length, as a share of it, over all frames.
pub(crate) fn max_stretch(motion: &StrandMotion) -> f64 {
    let n_points = motion.n_points();
    let lengths = |frame: &[[f32; 3]]| -> Vec<f64> {
        let mut lengths = Vec::with_capacity(n_points);
        let mut strand = frame;
        for n in &motion.counts {
            let (points, rest) = strand.split_at(*n);
            let length =
                |p: &[[f32; 3]]| (Vec3::from(p[1].map(f64::from)) - Vec3::from(p[0].map(f64::from))).norm();
            lengths.extend(points.windows(2).map(length));
            strand = rest;
        }
        lengths
    };
    let at_rest = lengths(&motion.positions_m[..n_points]);
    let stretch = |frame: &[[f32; 3]]| {
        let changes = lengths(frame).into_iter().zip(&at_rest).map(|(now, rest)| (now / rest - 1.0).abs());
        changes.fold(0.0, f64::max)
    };
    motion.positions_m.par_chunks_exact(n_points).map(stretch).reduce(|| 0.0, f64::max)
}

/// The positions of all frames, to be filled strand by strand.
pub(crate) struct Frames {
    pub positions_m: Vec<[f32; 3]>,
    n_points: usize,
    /// Where each strand's first point is within a frame.
    offsets: Vec<usize>,
    counts: Vec<usize>,
}

impl Frames {
    /// All frames as the strands hang at rest.
    pub fn new(groom: &Groom, n_frames: usize) -> Self {
        let rest: Vec<[f32; 3]> =
            groom.strands.iter().flat_map(|s| &s.rest_curve_m).copied().map(single).collect();
        let counts = groom.counts();
        let offsets = counts.iter().scan(0, |at, n| {
            let here = *at;
            *at += n;
            Some(here)
        });
        Self { positions_m: rest.repeat(n_frames), n_points: rest.len(), offsets: offsets.collect(), counts }
    }

    /// Puts the points of some strands, roots left out, into a frame.
    pub fn put(&mut self, frame: usize, strands: &[usize], points: &[[f32; 3]]) {
        let mut points = points;
        for s in strands {
            let (own, others) = points.split_at(self.counts[*s] - 1);
            let at = frame * self.n_points + self.offsets[*s] + 1;
            self.positions_m[at..at + own.len()].copy_from_slice(own);
            points = others;
        }
    }
}
