//! The loop over steps and batches.

use crate::Precision;
use crate::extent::{Extent, Region};
use crate::frames::Places;
use crate::mechanics::Mechanics;
use crate::parts::Count;
use crate::prepared::Prepared;
use crate::stability::Limit;
use crate::timeline::Timeline;
use core::fmt::Debug;
use core::marker::PhantomData;
use core::ops::Range;
use pulp::NullaryFnOnce;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use tousle_core::Progress;
use tousle_field::{Reading, Sampler};
use tousle_lanes::{Lane, Registers, WithLanes};

/// Gets a frame, the strands of a batch, and their points in it without the roots, strand after strand.
pub(crate) type PutFrame<'a> = dyn FnMut(usize, &[usize], &[[f32; 3]]) + Send + 'a;

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
struct Lanes<M: Mechanics, L: Lane> {
    /// Index of the strand in each lane that is read, and how many sticks it has.
    strands: Vec<usize>,
    n_sticks: Vec<usize>,
    batch: M::Batch<L>,
    /// Where the strands asked the field, block after block, and of each strand after strand; empty if nobody wants to know.
    asked: Vec<Region>,
}

/// Steps that a batch runs before the next one's turn: enough to spread the cost of preparing what the world does. Few
/// batches stay in the nearest memory with all they need; with many, it is the laid-together fields that must stay there.
const BLOCK_OF_FEW: usize = 32;
const BLOCK_OF_MANY: usize = 3;

impl<M: Mechanics> Run<'_, M> {
    /// Moves strands from a frame to another, a block of steps at a time. `put` gets the frames of a block while the next one
    /// is stepped, so that one thread alone is at it while others do not wait.
    pub fn advance(
        &self,
        strands: &mut dyn Abreast<M>,
        (first, last): (usize, usize),
        progress: &dyn Progress,
        put: &mut PutFrame<'_>,
    ) {
        let per_frame = self.timeline.steps_per_frame;
        let indices = strands.indices();
        let n_points = strands.n_points();
        let n_strands: usize = indices.iter().map(Vec::len).sum();
        // What each batch moves through in a block, and what it moved through in the one before. Kept from block to block:
        // memory that is new each time costs more.
        let mut moving: Vec<Vec<[f32; 3]>> = vec![Vec::new(); indices.len()];
        let mut moved = moving.clone();
        let mut hand_out = |moved: &[Vec<[f32; 3]>], begin: usize| {
            for ((indices, n_points), points) in indices.iter().zip(&n_points).zip(moved) {
                for (k, points) in points.chunks_exact(*n_points).enumerate() {
                    put(begin / per_frame + 1 + k, indices, points);
                }
            }
        };
        let (done, total) = (AtomicU64::new(0), (n_strands * (last - first) * per_frame) as u64);
        let mut before = first * per_frame;
        for steps in self.blocks((first, last)) {
            let begin = steps.start;
            let world = |step| self.mechanics.world(&self.timeline, &self.sampler, self.reading, step);
            let worlds: Vec<M::World<'_>> = steps.clone().into_par_iter().map(world).collect();
            let block = Block { mechanics: &self.mechanics, begin, worlds: &worlds, per_frame };
            let step = || {
                strands.take_steps(&block, &mut moving, &|n_strands| {
                    let n = (n_strands * worlds.len()) as u64;
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
}

/// A block of steps.
pub(crate) struct Block<'a, 'w, M: Mechanics> {
    mechanics: &'a M,
    /// Its first step, and what the world does in each.
    begin: usize,
    worlds: &'a [M::World<'w>],
    per_frame: usize,
}

/// Strands on their way, some side by side in a batch. What a run asks of them whatever the lanes are: all that knows of
/// lanes is compiled for each kind of them, and nothing else need be.
pub(crate) trait Abreast<M: Mechanics>: Debug + Send + Sync {
    /// Index of every strand, batch after batch.
    fn indices(&self) -> Vec<Vec<usize>>;

    /// How many points each batch has, roots left out.
    fn n_points(&self) -> Vec<usize>;

    /// All batches through a block of steps. `points`: what becomes of each the points, roots left out, in every frame that
    /// these complete, strand after strand. `passed` hears of how many strands are through.
    fn take_steps(
        &mut self,
        block: &Block<'_, '_, M>,
        points: &mut [Vec<[f32; 3]>],
        passed: &(dyn Fn(usize) + Sync),
    );

    /// The points of each batch, roots left out, strand after strand.
    fn points(&self) -> Vec<Vec<[f32; 3]>>;

    /// From now on where the strands ask the field is kept, block of steps by block of steps.
    fn keep_asked(&mut self);

    /// Index of every strand, and where it asked the field, block after block.
    fn asked(&self) -> Vec<(usize, Vec<Region>)>;

    /// What their steps took.
    fn count(&self) -> Count;

    /// The first strand in all lanes of one batch, to be read so many times.
    fn variants(&self, n: usize) -> Box<dyn Abreast<M>>;

    /// The same strands, to go another way.
    fn fork(&self) -> Box<dyn Abreast<M>>;
}

/// Puts some strands, by index and in this order, where they are before their first step.
type AtRest<M, Shape> = fn(&M, &[Prepared<Shape>], &[usize]) -> Box<dyn Abreast<M>>;

/// How many strands are side by side, and what puts some there before their first step.
#[derive(Debug)]
pub(crate) struct SideBySide<M: Mechanics> {
    pub n: usize,
    pub at_rest: AtRest<M, <M as Mechanics>::Shape>,
}

impl<M: Mechanics> SideBySide<M> {
    /// As fits some registers.
    pub fn of(registers: Registers, precision: Precision) -> Self {
        struct Of<M>(PhantomData<M>);
        impl<M: Mechanics> WithLanes for Of<M> {
            type Output = SideBySide<M>;

            fn with<L: Lane>(self) -> SideBySide<M> {
                SideBySide { n: L::N, at_rest: all_at_rest::<M, L> }
            }
        }
        registers.with_lanes(precision, Of::<M>(PhantomData))
    }
}

/// Strands in the order given, as many side by side as there are lanes.
fn all_at_rest<M: Mechanics, L: Lane>(
    mechanics: &M,
    prepared: &[Prepared<M::Shape>],
    strands: &[usize],
) -> Box<dyn Abreast<M>> {
    let lanes = |some: &[usize]| Lanes::<M, L>::at_rest(mechanics, prepared, some);
    Box::new(strands.par_chunks(L::N).map(lanes).collect::<Vec<_>>())
}

impl<M: Mechanics, L: Lane> Abreast<M> for Vec<Lanes<M, L>> {
    fn indices(&self) -> Vec<Vec<usize>> {
        self.iter().map(|lanes| lanes.strands.clone()).collect()
    }

    fn n_points(&self) -> Vec<usize> {
        self.iter().map(Lanes::n_points).collect()
    }

    fn take_steps(
        &mut self,
        block: &Block<'_, '_, M>,
        points: &mut [Vec<[f32; 3]>],
        passed: &(dyn Fn(usize) + Sync),
    ) {
        self.par_iter_mut().zip(points).for_each_init(Vec::new, |work, (lanes, points)| {
            lanes.take_steps(block, work, points);
            passed(lanes.strands.len());
        });
    }

    fn points(&self) -> Vec<Vec<[f32; 3]>> {
        let of = |lanes: &Lanes<M, L>| {
            let mut points = vec![[0.0; 3]; lanes.n_points()];
            lanes.put_points(&mut points);
            points
        };
        self.iter().map(of).collect()
    }

    fn keep_asked(&mut self) {
        for lanes in self {
            *M::asked(&mut lanes.batch) = Some(Extent::nothing());
        }
    }

    fn asked(&self) -> Vec<(usize, Vec<Region>)> {
        let of = |lanes: &Lanes<M, L>| {
            let n = lanes.strands.len();
            let of_lane = |lane: usize| lanes.asked.iter().skip(lane).step_by(n).copied().collect();
            let each = |(lane, strand): (usize, &usize)| (*strand, of_lane(lane));
            lanes.strands.iter().enumerate().map(each).collect::<Vec<_>>()
        };
        self.iter().flat_map(of).collect()
    }

    fn count(&self) -> Count {
        self.iter().fold(Count::default(), |sum, lanes| sum.and(M::count(&lanes.batch)))
    }

    fn variants(&self, n: usize) -> Box<dyn Abreast<M>> {
        let Lanes { strands, n_sticks, batch, .. } = &self[0];
        let lanes = Lanes {
            strands: vec![strands[0]; n],
            n_sticks: vec![n_sticks[0]; n],
            batch: batch.clone(),
            asked: Vec::new(),
        };
        Box::new(vec![lanes])
    }

    fn fork(&self) -> Box<dyn Abreast<M>> {
        Box::new(self.clone())
    }
}

impl<M: Mechanics, L: Lane> Lanes<M, L> {
    /// Up to as many strands as there are lanes, before their first step.
    fn at_rest(mechanics: &M, prepared: &[Prepared<M::Shape>], strands: &[usize]) -> Self {
        let prepared: Vec<_> = strands.iter().map(|s| &prepared[*s]).collect();
        let n_sticks = prepared.iter().map(|p| p.lock.n_sticks()).collect();
        Self { strands: strands.to_vec(), n_sticks, batch: mechanics.batch(&prepared), asked: Vec::new() }
    }

    /// Through a block of steps. `points`: what becomes the points, roots left out, in every frame that these complete.
    fn take_steps(
        &mut self,
        block: &Block<'_, '_, M>,
        work: &mut Vec<M::Work<L>>,
        points: &mut Vec<[f32; 3]>,
    ) {
        let Block { mechanics, begin, worlds, per_frame } = block;
        let (n_points, steps) = (self.n_points(), *begin..begin + worlds.len());
        // In the first block alone it grows.
        points.resize((steps.end / per_frame - steps.start / per_frame) * n_points, [0.0; 3]);
        let mut frames = points.chunks_exact_mut(n_points);
        for (k, world) in worlds.iter().enumerate() {
            mechanics.step(&mut self.batch, work, world);
            if (begin + k + 1).is_multiple_of(*per_frame) {
                self.put_points(frames.next().expect("as many as frames end in these steps"));
            }
        }
        self.note_asked();
    }

    /// Ends a block.
    fn note_asked(&mut self) {
        if let Some(extent) = M::asked(&mut self.batch) {
            self.asked.extend((0..self.strands.len()).map(|lane| extent.of(lane)));
            *extent = Extent::nothing();
        }
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
