//! What frames say of the strands that they show: how far sticks stretch, and whether all points are somewhere.

use pulp::NullaryFnOnce;
use rayon::prelude::*;
use tousle_core::StrandMotion;
use tousle_lanes::{Lane, Vector};

/// What frames say of the strands of a batch: by how much sticks are longer or shorter than they are, and whether all points
/// are somewhere.
#[derive(Clone, Debug)]
pub(crate) struct Lengths<L> {
    /// One over every stick's squared length, 1/m²; NaN, of which nobody hears, where a strand has none.
    per_rest2: Vec<L>,
    heard: Heard<L>,
}

#[derive(Clone, Copy, Debug)]
struct Heard<L> {
    /// The least and the most that a squared length was of what it is.
    least: L,
    most: L,
    /// 0, and NaN once a point of a strand is nowhere.
    nowhere: L,
}

impl<L: Lane> Lengths<L> {
    /// Of strands whose sticks are so long, m, one a lane, before their first frame.
    pub fn new(lengths_m: &[&[f64]]) -> Self {
        let n_sticks = lengths_m.iter().map(|lengths| lengths.len()).max().unwrap_or(0);
        let per_rest2 = |lane: usize, stick: usize| {
            let lengths = lengths_m[lane.min(lengths_m.len() - 1)];
            lengths.get(stick).map_or(f64::NAN, |length| 1.0 / (length * length))
        };
        Self {
            per_rest2: (0..n_sticks).map(|stick| L::from_fn(|lane| per_rest2(lane, stick))).collect(),
            heard: Heard { least: L::one(), most: L::one(), nowhere: L::zero() },
        }
    }

    /// Hears of a frame's points as it holds them, from the root.
    #[inline(always)]
    pub fn listen(&mut self) -> Listener<'_, L> {
        Listener { heard: self.heard, lengths: self }
    }

    /// Whether all points were somewhere.
    pub fn are_whole(&self) -> bool {
        self.heard.nowhere.largest() == 0.0
    }

    /// The largest change of any stick's length, as a share of it.
    pub fn max_stretch(&self) -> f64 {
        let Heard { least, most, .. } = self.heard;
        f64::max(1.0 - (-(-least).largest()).sqrt(), most.largest().sqrt() - 1.0)
    }
}

/// One who hears of a frame for some [`Lengths`].
pub(crate) struct Listener<'a, L> {
    lengths: &'a mut Lengths<L>,
    heard: Heard<L>,
}

impl<L: Lane> Listener<'_, L> {
    /// Hears of the ends of a stick.
    #[inline(always)]
    pub fn hear(&mut self, stick: usize, (from, to): (Vector<L>, Vector<L>)) {
        let Heard { least, most, nowhere } = &mut self.heard;
        let share = (to - from).norm_squared() * self.lengths.per_rest2[stick];
        *least = share.min(*least);
        *most = share.max(*most);
        *nowhere = (to.x + to.y + to.z).mul_add(least.same(0.0), *nowhere);
    }

    /// The frame is over.
    #[inline(always)]
    pub fn end(self) {
        self.lengths.heard = self.heard;
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
