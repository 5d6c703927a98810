//! What a run hands out: frames of single-precision positions, and what they say of stretch.

use pulp::NullaryFnOnce;
use rayon::prelude::*;
use tousle_core::{Groom, StrandMotion, Vec3};
use tousle_lanes::{Lane, MOST_LANES, Vector};

/// A point as the result holds it.
pub(crate) fn single(point: Vec3) -> [f32; 3] {
    point.map(|c| c as f32).into()
}

/// Where the points of strands side by side go, strand after strand: of each as many as it has sticks.
pub(crate) struct Places<'a> {
    /// Where each strand's points begin, and how many it has; none in lanes that are not read.
    strands: [(usize, usize); MOST_LANES],
    points: &'a mut [[f32; 3]],
}

impl<'a> Places<'a> {
    /// Places in as many points as the strands have sticks.
    pub fn new(n_sticks: &[usize], points: &'a mut [[f32; 3]]) -> Self {
        let mut strands = [(0, 0); MOST_LANES];
        let mut first = 0;
        for (strand, n) in strands.iter_mut().zip(n_sticks) {
            *strand = (first, *n);
            first += n;
        }
        Self { strands, points }
    }

    /// Puts the far ends of a stick of every strand that has it.
    #[inline(always)]
    pub fn put<L: Lane>(&mut self, stick: usize, ends: Vector<L>) {
        let mut rows = [[0.0; MOST_LANES]; 3];
        ends.put_single(&mut rows, 0);
        for (lane, (first, n)) in self.strands[..L::N].iter().enumerate() {
            if stick < *n {
                // Written out: `map` would be a call for each point.
                self.points[first + stick] = [rows[0][lane], rows[1][lane], rows[2][lane]];
            }
        }
    }
}

/// The largest change of any stick's length from the first frame's, as a share of it, over all frames.
pub fn max_stretch(motion: &StrandMotion) -> f64 {
    let n_points = motion.n_points();
    let first = motion.frame(0);
    // Of the stick that begins at each point; there is none at a tip.
    let mut per_rest2 = vec![f32::NAN; n_points];
    let mut tip = 0;
    for n in &motion.counts {
        let root = tip;
        tip += n;
        for point in root..tip.saturating_sub(1) {
            per_rest2[point] = 1.0 / length2(first[point], first[point + 1]);
        }
    }
    let arch = pulp::Arch::new();
    let stretch = |frame| arch.dispatch(Shares { frame, per_rest2: &per_rest2 });
    let wider = |a: (f32, f32), b: (f32, f32)| (a.0.min(b.0), a.1.max(b.1));
    let frames = motion.positions_m.par_chunks_exact(n_points.max(1));
    let (least, most) = frames.map(stretch).reduce(|| (1.0, 1.0), wider);
    f64::max(1.0 - f64::from(least).sqrt(), f64::from(most).sqrt() - 1.0)
}

#[inline(always)]
fn length2([from_x, from_y, from_z]: [f32; 3], [x, y, z]: [f32; 3]) -> f32 {
    let (x, y, z) = (x - from_x, y - from_y, z - from_z);
    x * x + y * y + z * z
}

/// The least and the most that a stick's squared length is of what it was, in a frame; of 1 and these.
struct Shares<'a> {
    frame: &'a [[f32; 3]],
    /// One over what it was; nobody hears of a NaN.
    per_rest2: &'a [f32],
}

impl NullaryFnOnce for Shares<'_> {
    type Output = (f32, f32);

    #[inline(always)]
    fn call(self) -> (f32, f32) {
        /// Sticks side by side.
        const N: usize = 16;
        let (mut least, mut most) = ([1.0; N], [1.0; N]);
        let mut hear = |k: usize, share: f32| {
            least[k] = if share < least[k] { share } else { least[k] };
            most[k] = if share > most[k] { share } else { most[k] };
        };
        let n_sticks = self.frame.len().saturating_sub(1);
        let whole = n_sticks - n_sticks % N;
        for first in (0..whole).step_by(N) {
            // Slices of one length: only so the compiler makes vector instructions of the loop.
            let (from, to) = (&self.frame[first..first + N], &self.frame[first + 1..first + 1 + N]);
            let per_rest2 = &self.per_rest2[first..first + N];
            for k in 0..N {
                hear(k, length2(from[k], to[k]) * per_rest2[k]);
            }
        }
        for k in whole..n_sticks {
            hear(k % N, length2(self.frame[k], self.frame[k + 1]) * self.per_rest2[k]);
        }
        (least.into_iter().fold(1.0, f32::min), most.into_iter().fold(1.0, f32::max))
    }
}

/// The positions of some strands in all frames, to be filled strand by strand.
pub(crate) struct Frames {
    pub positions_m: Vec<[f32; 3]>,
    n_points: usize,
    /// For each strand of the groom: where its first point is within a frame, and how many it has.
    places: Vec<(usize, usize)>,
    /// The first point of each strand of the groom.
    roots_m: Vec<[f32; 3]>,
}

impl Frames {
    /// Frames of some of a groom's strands, in this order: the first as they hang at rest, the others to be filled.
    pub fn new(groom: &Groom, strands: &[usize], n_frames: usize) -> Self {
        let mut places = vec![(0, 0); groom.strands.len()];
        let mut rest: Vec<[f32; 3]> = Vec::new();
        for s in strands {
            let curve = &groom.strands[*s].rest_curve_m;
            places[*s] = (rest.len(), curve.len());
            rest.extend(curve.iter().copied().map(single));
        }
        // Zeros cost nothing until they are written over.
        let mut positions_m = vec![[0.0; 3]; rest.len() * n_frames];
        positions_m[..rest.len()].copy_from_slice(&rest);
        let roots_m = groom.strands.iter().map(|strand| single(strand.rest_curve_m[0])).collect();
        Self { positions_m, n_points: rest.len(), places, roots_m }
    }

    /// Frames of all of a groom's strands, filled already.
    pub fn filled(groom: &Groom, positions_m: Vec<[f32; 3]>) -> Self {
        let all: Vec<usize> = (0..groom.strands.len()).collect();
        Self { positions_m, ..Self::new(groom, &all, 1) }
    }

    /// Puts the points of some strands, roots left out, into a frame.
    pub fn put(&mut self, frame: usize, strands: &[usize], points: &[[f32; 3]]) {
        let mut points = points;
        for s in strands {
            let (first, n) = self.places[*s];
            let (own, others) = points.split_at(n - 1);
            let at = frame * self.n_points + first;
            self.positions_m[at] = self.roots_m[*s];
            self.positions_m[at + 1..at + n].copy_from_slice(own);
            points = others;
        }
    }

    /// Puts all frames of some strands, roots included. `None` if these are not as many points as the strands have.
    pub fn put_all(&mut self, strands: &[usize], points: &[[f32; 3]]) -> Option<()> {
        let n_points: usize = strands.iter().map(|s| self.places[*s].1).sum();
        let n_frames = self.positions_m.len() / self.n_points;
        if points.len() != n_frames * n_points {
            return None;
        }
        for (frame, points) in points.chunks_exact(n_points).enumerate() {
            let mut points = points;
            for s in strands {
                let (first, n) = self.places[*s];
                let (own, others) = points.split_at(n);
                let at = frame * self.n_points + first;
                self.positions_m[at..at + n].copy_from_slice(own);
                points = others;
            }
        }
        Some(())
    }
}
