//! What a run hands out: frames of single-precision positions, and what they say of stretch.

use core::ops::Range;
use pulp::NullaryFnOnce;
use rayon::prelude::*;
use tousle_core::{Groom, StrandMotion, Vec3};
use tousle_lanes::{Lane, MOST_LANES, Vector};

/// A point as the result holds it.
pub(crate) fn single(point: Vec3) -> [f32; 3] {
    point.map(|c| c as f32).into()
}

/// Where a strand puts its points in a frame, root first; `None` for what is not read.
pub(crate) type Room<'a> = Option<&'a mut [[f32; 3]]>;

/// Room for what a batch shows in some frames, as many rooms a frame as there are lanes.
pub(crate) struct Rooms<'r, 'a> {
    /// Frames that pass before the first that is wanted.
    pub skipped: usize,
    pub n_lanes: usize,
    pub rooms: &'r mut [Room<'a>],
}

impl<'a> Rooms<'_, 'a> {
    /// Of the `k`-th frame that passes, if it is wanted.
    pub fn of_frame(&mut self, k: usize) -> Option<&mut [Room<'a>]> {
        let first = k.checked_sub(self.skipped)? * self.n_lanes;
        self.rooms.get_mut(first..first + self.n_lanes)
    }
}

/// The numbers of a batch's rooms, one room a lane; none for what is not read.
pub(crate) struct Numbers<'r> {
    rooms: [&'r mut [f32]; MOST_LANES],
    /// How many every lane has room for.
    shortest: usize,
}

impl<'r> Numbers<'r> {
    pub fn of<L: Lane>(rooms: &'r mut [Room<'_>]) -> Self {
        let mut rooms = rooms.iter_mut();
        let rooms: [&mut [f32]; MOST_LANES] = core::array::from_fn(|_| match rooms.next() {
            Some(Some(room)) => room.as_flattened_mut(),
            _ => &mut [],
        });
        let shortest = rooms[..L::N].iter().map(|room| room.len()).min().unwrap_or(0);
        Self { rooms, shortest }
    }

    /// Puts the `k`-th points of strands side by side.
    #[inline(always)]
    pub fn put<L: Lane>(&mut self, k: usize, points: Vector<L>) {
        let first = 3 * k;
        if first + 4 <= self.shortest {
            L::each_point([points.x, points.y, points.z], |lane, point| {
                // Four are written at once: where the next point's x will be there is no harm in it.
                self.rooms[lane][first..first + 4].copy_from_slice(&point);
            });
        } else {
            let mut rows = [[0.0; MOST_LANES]; 3];
            points.put_single(&mut rows, 0);
            self.put_last(first, &rows);
        }
    }

    /// Puts points that are the last of some strands, or that only some have.
    #[cold]
    #[inline(never)]
    fn put_last(&mut self, first: usize, rows: &[[f32; MOST_LANES]; 3]) {
        for (lane, room) in self.rooms.iter_mut().enumerate() {
            if let Some(place) = room.get_mut(first..first + 3) {
                place.copy_from_slice(&[rows[0][lane], rows[1][lane], rows[2][lane]]);
            }
        }
    }
}

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

/// The positions of some strands in all frames, to be filled strand by strand.
pub(crate) struct Frames {
    pub positions_m: Vec<[f32; 3]>,
    n_points: usize,
    /// How many points each strand has, in the order in which they lie in a frame.
    counts: Vec<usize>,
    /// For each strand of the groom: which of these it is, and where its first point is within a frame.
    places: Vec<(usize, usize)>,
}

/// Where the strands of batches are.
pub(crate) struct Seats {
    n_lanes: usize,
    n_batches: usize,
    /// For each strand of some [`Frames`], in their order: its batch and its lane.
    seats: Vec<(usize, usize)>,
}

impl Frames {
    /// Frames of some of a groom's strands, in this order: the first as they hang at rest, the others to be filled. A strand
    /// that comes several times does so in succession.
    pub fn new(groom: &Groom, strands: &[usize], n_frames: usize) -> Self {
        let mut places = vec![(0, 0); groom.strands.len()];
        let mut rest: Vec<[f32; 3]> = Vec::new();
        for (k, s) in strands.iter().enumerate().rev() {
            places[*s].0 = k;
        }
        for s in strands {
            let curve = &groom.strands[*s].rest_curve_m;
            places[*s].1 = rest.len();
            rest.extend(curve.iter().copied().map(single));
        }
        // Zeros cost nothing until they are written over.
        let mut positions_m = vec![[0.0; 3]; rest.len() * n_frames];
        positions_m[..rest.len()].copy_from_slice(&rest);
        let counts = strands.iter().map(|s| groom.strands[*s].rest_curve_m.len()).collect();
        Self { positions_m, n_points: rest.len(), counts, places }
    }

    /// Frames of all of a groom's strands, filled already.
    pub fn filled(groom: &Groom, positions_m: Vec<[f32; 3]>) -> Self {
        let all: Vec<usize> = (0..groom.strands.len()).collect();
        Self { positions_m, ..Self::new(groom, &all, 1) }
    }

    /// The positions of the first of the frames.
    pub fn first(&self, n_frames: usize) -> &[[f32; 3]] {
        &self.positions_m[..n_frames * self.n_points]
    }

    /// Where the frames' strands are in some batches of them, each given by its strands' indices; all but the last are full.
    pub fn seats(&self, batches: &[Vec<usize>]) -> Seats {
        let mut next: Vec<usize> = self.places.iter().map(|place| place.0).collect();
        let mut seats = vec![(0, 0); self.counts.len()];
        for (batch, strands) in batches.iter().enumerate() {
            for (lane, strand) in strands.iter().enumerate() {
                seats[next[*strand]] = (batch, lane);
                next[*strand] += 1;
            }
        }
        Seats { n_lanes: batches.first().map_or(1, Vec::len), n_batches: batches.len(), seats }
    }

    /// Rooms of some frames: batch after batch, of each frame after frame.
    pub fn rooms(&mut self, frames: Range<usize>, seats: &Seats) -> Vec<Room<'_>> {
        let (n_frames, n_lanes) = (frames.len(), seats.n_lanes);
        let mut rooms: Vec<Room<'_>> = Vec::new();
        rooms.resize_with(seats.n_batches * n_frames * n_lanes, || None);
        let wanted = &mut self.positions_m[frames.start * self.n_points..frames.end * self.n_points];
        for (k, mut frame) in wanted.chunks_exact_mut(self.n_points.max(1)).enumerate() {
            for (n, (batch, lane)) in self.counts.iter().zip(&seats.seats) {
                let (own, others) = frame.split_at_mut(*n);
                rooms[(batch * n_frames + k) * n_lanes + lane] = Some(own);
                frame = others;
            }
        }
        rooms
    }

    /// Puts all frames of some strands, roots included. `None` if these are not as many points as the strands have.
    pub fn put_all(&mut self, strands: &[usize], points: &[[f32; 3]]) -> Option<()> {
        let place = |strand: usize| {
            let (k, first) = self.places[strand];
            (first, self.counts[k])
        };
        let n_points: usize = strands.iter().map(|s| place(*s).1).sum();
        let n_frames = self.positions_m.len() / self.n_points;
        if points.len() != n_frames * n_points {
            return None;
        }
        for (frame, points) in points.chunks_exact(n_points).enumerate() {
            let mut points = points;
            for s in strands {
                let (first, n) = place(*s);
                let (own, others) = points.split_at(n);
                let at = frame * self.n_points + first;
                self.positions_m[at..at + n].copy_from_slice(own);
                points = others;
            }
        }
        Some(())
    }

    /// The frames of each strand by itself.
    pub fn apart(&self) -> Vec<Vec<[f32; 3]>> {
        let mut apart = vec![Vec::new(); self.counts.len()];
        for frame in self.positions_m.chunks_exact(self.n_points.max(1)) {
            let mut points = frame;
            for (n, strand) in self.counts.iter().zip(&mut apart) {
                let (own, others) = points.split_at(*n);
                strand.extend_from_slice(own);
                points = others;
            }
        }
        apart
    }
}
