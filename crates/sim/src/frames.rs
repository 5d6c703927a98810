//! What a run hands out: frames of single-precision positions, and where strands put theirs.

use core::ops::Range;
use rayon::prelude::*;
use tousle_core::{Groom, Vec3};
use tousle_lanes::{Lane, MOST_LANES, Vector};

/// A point as the result holds it.
pub(crate) fn single(point: Vec3) -> [f32; 3] {
    point.map(|c| c as f32).into()
}

/// Where a strand puts its points in a frame, root first; `None` for what is not read.
pub(crate) type Room<'a> = Option<&'a mut [[f32; 3]]>;

/// Room for what batches show in some frames: of each frame batch after batch, as many rooms a batch as there are lanes.
#[derive(Default)]
pub(crate) struct Rooms<'a> {
    /// Frames that pass before the first that is wanted.
    skipped: usize,
    n_lanes: usize,
    frames: Vec<Vec<Room<'a>>>,
}

impl<'a> Rooms<'a> {
    /// Those of each of so many batches.
    pub fn of_batches(&mut self, n_batches: usize) -> Vec<BatchRooms<'_, 'a>> {
        let Self { skipped, n_lanes, frames } = self;
        let mut each: Vec<_> = frames.iter_mut().map(|rooms| rooms.chunks_mut((*n_lanes).max(1))).collect();
        let mut of_next = || each.iter_mut().filter_map(Iterator::next).collect();
        (0..n_batches).map(|_| BatchRooms { skipped: *skipped, frames: of_next() }).collect()
    }

    /// Nothing but their memory, for rooms elsewhere: new memory in every block of steps costs more than what is put into it.
    pub fn emptied<'b>(self) -> Rooms<'b> {
        let emptied = |mut rooms: Vec<Room<'a>>| -> Vec<Room<'b>> {
            rooms.clear();
            // Collected where they were.
            rooms.into_iter().map(|_| None).collect()
        };
        Rooms { frames: self.frames.into_iter().map(emptied).collect(), ..Rooms::default() }
    }
}

/// One batch's part of some [`Rooms`].
pub(crate) struct BatchRooms<'r, 'a> {
    skipped: usize,
    /// As many rooms as there are lanes, of each frame that is wanted.
    frames: Vec<&'r mut [Room<'a>]>,
}

impl<'a> BatchRooms<'_, 'a> {
    /// Of the `k`-th frame that passes, if it is wanted.
    pub fn of_frame(&mut self, k: usize) -> Option<&mut [Room<'a>]> {
        self.frames.get_mut(k.checked_sub(self.skipped)?).map(|rooms| &mut **rooms)
    }
}

/// Lets the processor fetch the memory of some rooms while it does something else.
pub(crate) fn fetch(rooms: &[Room<'_>]) {
    for room in rooms {
        let Some(room) = room else { continue };
        let mut next = 0;
        while let Some(point) = room.get(next) {
            fetch_point(point);
            next += POINTS_IN_LINE;
        }
    }
}

/// How many points lie in what a processor fetches at once, 64 bytes.
const POINTS_IN_LINE: usize = 5;

/// Lets the processor fetch what a point is written over.
#[inline(always)]
fn fetch_point(point: &[f32; 3]) {
    #[cfg(target_arch = "x86_64")]
    safe_arch::prefetch_et0(point);
    // No library offers it for others.
    #[cfg(not(target_arch = "x86_64"))]
    let _ = point;
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

    /// Rooms of some frames, before which so many pass that are not wanted; in the memory of others, emptied.
    pub fn rooms<'a>(
        &'a mut self,
        skipped: usize,
        frames: Range<usize>,
        seats: &Seats,
        memory: Rooms<'a>,
    ) -> Rooms<'a> {
        let n_lanes = seats.n_lanes;
        let mut rooms = memory;
        rooms.frames.resize_with(frames.len(), Vec::new);
        let wanted = &mut self.positions_m[frames.start * self.n_points..frames.end * self.n_points];
        let counts = &self.counts;
        let each = rooms.frames.par_iter_mut().zip(wanted.par_chunks_exact_mut(self.n_points.max(1)));
        each.for_each(|(rooms, mut frame)| {
            rooms.resize_with(seats.n_batches * n_lanes, || None);
            for (n, (batch, lane)) in counts.iter().zip(&seats.seats) {
                let (own, others) = frame.split_at_mut(*n);
                rooms[batch * n_lanes + lane] = Some(own);
                frame = others;
            }
        });
        Rooms { skipped, n_lanes, ..rooms }
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
