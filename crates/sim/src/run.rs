//! The loop over steps and batches.

use crate::extent::{Extent, Region};
use crate::frames::Places;
use crate::lane::Lane;
use crate::mechanics::Mechanics;
use crate::prepared::Prepared;
use crate::stability::Limit;
use crate::timeline::Timeline;
use core::ops::Range;
use pulp::NullaryFnOnce;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use tousle_core::Progress;
use tousle_field::{Reading, Sampler};

/// A run under some layers: what the world does, and by which mechanics strands move in it.
pub(crate) struct Run<'a, M> {
    pub timeline: Timeline<'a>,
    pub sampler: Sampler<'a>,
    pub reading: Reading,
    pub mechanics: M,
    /// The longest step of an explicit integrator.
    pub limit: Option<Limit>,
}

/// Strands side by side, one a lane.
#[derive(Clone, Debug)]
pub(crate) struct Lanes<M: Mechanics, L: Lane> {
    /// Index of the strand in each lane that is read, and how many sticks it has.
    strands: Vec<usize>,
    n_sticks: Vec<usize>,
    pub batch: M::Batch<L>,
    /// Where the strands asked the field, block after block, and of each strand after strand; empty if nobody wants to know.
    asked: Vec<Region>,
}

/// Steps that a batch runs before the next one's turn: enough to spread the cost of preparing what the world does. Few
/// batches stay in the nearest memory with all they need; with many, it is the laid-together fields that must stay there.
const BLOCK_OF_FEW: usize = 32;
const BLOCK_OF_MANY: usize = 3;

impl<M: Mechanics> Run<'_, M> {
    /// Moves batches from a frame to another, a block of steps at a time. `put` gets each frame, the strands of each
    /// batch, and their points without the roots: those of a block while the next one is stepped, so that one thread alone
    /// is at it while others do not wait.
    pub fn advance<L: Lane>(
        &self,
        batches: &mut [Lanes<M, L>],
        (first, last): (usize, usize),
        progress: &dyn Progress,
        mut put: impl FnMut(usize, &[usize], &[[f32; 3]]) + Send,
    ) {
        let per_frame = self.timeline.steps_per_frame;
        let strands: Vec<Vec<usize>> = batches.iter().map(|lanes| lanes.strands.clone()).collect();
        let n_points: Vec<usize> = batches.iter().map(Lanes::n_points).collect();
        let n_strands: usize = strands.iter().map(Vec::len).sum();
        // What each batch moves through in a block, and what it moved through in the one before. Kept from block to block:
        // memory that is new each time costs more.
        let mut moving: Vec<Vec<[f32; 3]>> = vec![Vec::new(); batches.len()];
        let mut moved = moving.clone();
        let mut hand_out = |moved: &[Vec<[f32; 3]>], begin: usize| {
            for ((strands, n_points), points) in strands.iter().zip(&n_points).zip(moved) {
                for (k, points) in points.chunks_exact(*n_points).enumerate() {
                    put(begin / per_frame + 1 + k, strands, points);
                }
            }
        };
        let (done, total) = (AtomicU64::new(0), (n_strands * (last - first) * per_frame) as u64);
        let mut before = first * per_frame;
        for steps in self.blocks((first, last)) {
            let begin = steps.start;
            let world = |step| self.mechanics.world(&self.timeline, &self.sampler, self.reading, step);
            let worlds: Vec<M::World<'_>> = steps.clone().into_par_iter().map(world).collect();
            let step = || {
                batches.par_iter_mut().zip(&mut moving).for_each_init(Vec::new, |work, (lanes, points)| {
                    self.take_steps(lanes, work, begin, &worlds, points);
                    let n = (lanes.strands.len() * steps.len()) as u64;
                    progress.at(done.fetch_add(n, Ordering::Relaxed) + n, total);
                });
            };
            rayon::join(step, || hand_out(&moved, before));
            core::mem::swap(&mut moving, &mut moved);
            before = begin;
        }
        hand_out(&moved, before);
    }

    /// The steps from a frame to another, block by block.
    pub fn blocks(&self, (first, last): (usize, usize)) -> impl Iterator<Item = Range<usize>> {
        let per_frame = self.timeline.steps_per_frame;
        let block = if self.reading == Reading::Together { BLOCK_OF_MANY } else { BLOCK_OF_FEW };
        let (start, end) = (first * per_frame, last * per_frame);
        (start..end).step_by(block).map(move |begin| begin..(begin + block).min(end))
    }

    /// A batch through a block of steps. `points`: what becomes its points, roots left out, in every frame that these
    /// complete.
    fn take_steps<L: Lane>(
        &self,
        lanes: &mut Lanes<M, L>,
        work: &mut Vec<M::Work<L>>,
        begin: usize,
        worlds: &[M::World<'_>],
        points: &mut Vec<[f32; 3]>,
    ) {
        let per_frame = self.timeline.steps_per_frame;
        let (n_points, steps) = (lanes.n_points(), begin..begin + worlds.len());
        // In the first block alone it grows.
        points.resize((steps.end / per_frame - steps.start / per_frame) * n_points, [0.0; 3]);
        let mut frames = points.chunks_exact_mut(n_points);
        for (k, world) in worlds.iter().enumerate() {
            self.mechanics.step(&mut lanes.batch, work, world);
            if (begin + k + 1).is_multiple_of(per_frame) {
                lanes.put_points(frames.next().expect("as many as frames end in these steps"));
            }
        }
        lanes.note_asked();
    }
}

impl<M: Mechanics, L: Lane> Lanes<M, L> {
    /// Up to as many strands as there are lanes, before their first step.
    pub fn at_rest(mechanics: &M, prepared: &[Prepared<M::Shape>], strands: &[usize]) -> Self {
        let prepared: Vec<_> = strands.iter().map(|s| &prepared[*s]).collect();
        let n_sticks = prepared.iter().map(|p| p.lock.n_sticks()).collect();
        Self { strands: strands.to_vec(), n_sticks, batch: mechanics.batch(&prepared), asked: Vec::new() }
    }

    /// From now on where the strands ask the field is kept, block of steps by block of steps.
    pub fn keep_asked(&mut self) {
        *M::asked(&mut self.batch) = Some(Extent::nothing());
    }

    /// Ends a block.
    fn note_asked(&mut self) {
        if let Some(extent) = M::asked(&mut self.batch) {
            self.asked.extend((0..self.strands.len()).map(|lane| extent.of(lane)));
            *extent = Extent::nothing();
        }
    }

    /// Where each strand asked the field, block after block.
    pub fn asked(&self) -> impl Iterator<Item = (usize, impl Iterator<Item = Region>)> {
        let n = self.strands.len();
        let of_lane = move |lane: usize| self.asked.iter().skip(lane).step_by(n).copied();
        self.strands.iter().enumerate().map(move |(lane, strand)| (*strand, of_lane(lane)))
    }

    /// The first strand, which is in all lanes, to be read so many times.
    pub fn variants(&self, n: usize) -> Self {
        let (strand, n_sticks) = (self.strands[0], self.n_sticks[0]);
        Self {
            strands: vec![strand; n],
            n_sticks: vec![n_sticks; n],
            batch: self.batch.clone(),
            asked: Vec::new(),
        }
    }

    /// Points, roots left out, strand after strand.
    pub fn points(&self) -> Vec<[f32; 3]> {
        let mut points = vec![[0.0; 3]; self.n_points()];
        self.put_points(&mut points);
        points
    }

    /// The strands of the lanes that are read.
    pub fn strands(&self) -> &[usize] {
        &self.strands
    }

    fn n_points(&self) -> usize {
        self.n_sticks.iter().sum()
    }

    /// Puts the points into as many.
    fn put_points(&self, points: &mut [[f32; 3]]) {
        L::dispatch(PutPoints::<M, L> { batch: &self.batch, places: Places::new(&self.n_sticks, points) });
    }
}

/// [`Lanes::put_points`], compiled for the lanes' registers.
struct PutPoints<'a, M: Mechanics, L: Lane> {
    batch: &'a M::Batch<L>,
    places: Places<'a>,
}

impl<M: Mechanics, L: Lane> NullaryFnOnce for PutPoints<'_, M, L> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { batch, mut places } = self;
        M::show_ends_m(batch, |stick, ends| places.put(stick, ends));
    }
}
