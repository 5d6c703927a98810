//! The loop over steps and batches.

use crate::extent::{Extent, Region};
use crate::frames::{BatchRooms, Frames, Numbers, Room, Rooms, Seats, fetch};
use crate::lengths::Lengths;
use crate::mechanics::Mechanics;
use crate::parts::Count;
use crate::prepared::Prepared;
use crate::stability::Limit;
use crate::timeline::Timeline;
use crate::{Precision, SimError};
use core::fmt::Debug;
use core::iter::zip;
use core::marker::PhantomData;
use core::ops::Range;
use pulp::NullaryFnOnce;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use tousle_core::Progress;
use tousle_field::{Reading, Sampler};
use tousle_lanes::{Lane, Registers, WithLanes};

/// Where frames are put, and the number of the first that is.
pub(crate) type Wanted<'a> = Option<(&'a mut Frames, usize)>;

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
    /// Index of the strand in each lane that is read.
    strands: Vec<usize>,
    batch: M::Batch<L>,
    /// What the frames say that it has shown.
    lengths: Lengths<L>,
    /// Where the strands asked the field, block after block, and of each strand after strand; empty if nobody wants to know.
    asked: Vec<Region>,
}

/// Steps that a batch runs before the next one's turn: enough to spread the cost of preparing what the world does. Few
/// batches stay in the nearest memory with all they need; with many, it is the laid-together fields that must stay there.
const BLOCK_OF_FEW: usize = 32;
const BLOCK_OF_MANY: usize = 6;

impl<M: Mechanics> Run<'_, M> {
    /// Moves strands from a frame to another, a block of steps at a time, and puts what is wanted of the frames between.
    pub fn advance(
        &self,
        strands: &mut dyn Abreast<M>,
        span: (usize, usize),
        progress: &dyn Progress,
        mut wanted: Wanted<'_>,
    ) {
        let indices = strands.indices();
        let seats = wanted.as_ref().map(|(frames, _)| frames.seats(&indices));
        let clock = self.clock(&indices, span, progress);
        let mut memory = Rooms::default();
        for steps in self.blocks(span) {
            let into = wanted.as_mut().zip(seats.as_ref());
            let into = into.map(|((frames, from), seats)| (&mut **frames, seats, *from));
            memory = self.take(strands, &steps, into, memory, &clock);
        }
    }

    /// Moves strands that are at rest from the first frame to the last, and says each block of frames that is done, with
    /// the number of its first. They are put into `frames`, which has room for those of one block and holds the first of all.
    pub fn say_all(
        &self,
        strands: &mut dyn Abreast<M>,
        frames: &mut Frames,
        progress: &dyn Progress,
        mut say: impl FnMut(&dyn Abreast<M>, usize, &[[f32; 3]]) -> Result<(), SimError>,
    ) -> Result<(), SimError> {
        let span = (0, self.timeline.n_frames - 1);
        let indices = strands.indices();
        let seats = frames.seats(&indices);
        let clock = self.clock(&indices, span, progress);
        say(strands, 0, frames.first(1))?;
        let mut memory = Rooms::default();
        for steps in self.blocks(span) {
            let done = self.frames_of(&steps);
            memory = self.take(strands, &steps, Some((frames, &seats, done.start)), memory, &clock);
            say(strands, done.start, frames.first(done.len()))?;
        }
        Ok(())
    }

    /// How many frames a block of steps completes at most.
    pub fn frames_per_block(&self) -> usize {
        self.block().div_ceil(self.timeline.steps_per_frame)
    }

    fn clock<'p>(
        &self,
        indices: &[Vec<usize>],
        (first, last): (usize, usize),
        progress: &'p dyn Progress,
    ) -> Clock<'p> {
        let n_strands: usize = indices.iter().map(Vec::len).sum();
        let total = n_strands * (last - first) * self.timeline.steps_per_frame;
        Clock { done: AtomicU64::new(0), total: total as u64, progress }
    }

    /// The frames that a block of steps completes.
    fn frames_of(&self, steps: &Range<usize>) -> Range<usize> {
        let per_frame = self.timeline.steps_per_frame;
        steps.start / per_frame + 1..steps.end / per_frame + 1
    }

    /// Moves strands through a block of steps, and puts those frames that are wanted, from a number on. `memory` is that of the last
    /// block's rooms; out: that of this one's.
    fn take(
        &self,
        strands: &mut dyn Abreast<M>,
        steps: &Range<usize>,
        wanted: Option<(&mut Frames, &Seats, usize)>,
        memory: Rooms<'static>,
        clock: &Clock<'_>,
    ) -> Rooms<'static> {
        let world = |step| self.mechanics.world(&self.timeline, &self.sampler, self.reading, step);
        let worlds: Vec<M::World<'_>> = steps.clone().into_par_iter().map(world).collect();
        let per_frame = self.timeline.steps_per_frame;
        let block = Block { mechanics: &self.mechanics, begin: steps.start, worlds: &worlds, per_frame };
        let Range { start: next, end } = self.frames_of(steps);
        let mut rooms = match wanted {
            Some((frames, seats, from)) if from < end => {
                let begin = usize::max(next, from);
                frames.rooms(begin - next, begin - from..end - from, seats, memory)
            }
            _ => memory,
        };
        strands.take_steps(&block, &mut rooms, &|n_strands| clock.passed(n_strands * worlds.len()));
        rooms.emptied()
    }

    fn block(&self) -> usize {
        if self.reading == Reading::Together { BLOCK_OF_MANY } else { BLOCK_OF_FEW }
    }

    /// The steps from a frame to another, block by block.
    pub fn blocks(&self, (first, last): (usize, usize)) -> impl Iterator<Item = Range<usize>> {
        let (per_frame, block) = (self.timeline.steps_per_frame, self.block());
        let (start, end) = (first * per_frame, last * per_frame);
        (start..end).step_by(block).map(move |begin| begin..(begin + block).min(end))
    }
}

/// How many steps of strands are done.
struct Clock<'p> {
    done: AtomicU64,
    total: u64,
    progress: &'p dyn Progress,
}

impl Clock<'_> {
    fn passed(&self, n_steps: usize) {
        let n = n_steps as u64;
        self.progress.at(self.done.fetch_add(n, Ordering::Relaxed) + n, self.total);
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

    /// All batches through a block of steps, and the points of the frames that these complete into the rooms. `passed` hears of how
    /// many strands are through.
    fn take_steps(
        &mut self,
        block: &Block<'_, '_, M>,
        rooms: &mut Rooms<'_>,
        passed: &(dyn Fn(usize) + Sync),
    );

    /// Shows where the strands are, as the one frame of some rooms.
    fn show(&mut self, rooms: &mut Rooms<'_>);

    /// Whether every point that was shown was somewhere.
    fn are_whole(&self) -> bool;

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

    fn take_steps(
        &mut self,
        block: &Block<'_, '_, M>,
        rooms: &mut Rooms<'_>,
        passed: &(dyn Fn(usize) + Sync),
    ) {
        let rooms = rooms.of_batches(self.len());
        self.par_iter_mut().zip(rooms).for_each_init(Vec::new, |work, (lanes, mut rooms)| {
            lanes.take_steps(block, work, &mut rooms);
            passed(lanes.strands.len());
        });
    }

    fn show(&mut self, rooms: &mut Rooms<'_>) {
        let each = rooms.of_batches(self.len());
        for (lanes, mut rooms) in zip(self, each) {
            if let Some(rooms) = rooms.of_frame(0) {
                lanes.show(rooms);
            }
        }
    }

    fn are_whole(&self) -> bool {
        self.iter().all(|lanes| lanes.lengths.are_whole())
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
        let of = |lanes: &Lanes<M, L>| Count {
            max_stretch: lanes.lengths.max_stretch(),
            ..M::count(&lanes.batch)
        };
        self.iter().fold(Count::default(), |sum, lanes| sum.and(of(lanes)))
    }

    fn variants(&self, n: usize) -> Box<dyn Abreast<M>> {
        let Lanes { strands, batch, lengths, .. } = &self[0];
        let lanes = Lanes {
            strands: vec![strands[0]; n],
            batch: batch.clone(),
            lengths: lengths.clone(),
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
        let lengths_m: Vec<_> = prepared.iter().map(|p| &p.lock.lengths_m[..]).collect();
        Self {
            strands: strands.to_vec(),
            batch: mechanics.batch(&prepared),
            lengths: Lengths::new(&lengths_m),
            asked: Vec::new(),
        }
    }

    /// Through a block of steps, and into rooms what they show.
    fn take_steps(
        &mut self,
        block: &Block<'_, '_, M>,
        work: &mut Vec<M::Work<L>>,
        rooms: &mut BatchRooms<'_, '_>,
    ) {
        let Block { mechanics, begin, worlds, per_frame } = block;
        let mut n_frames = 0;
        for (k, world) in worlds.iter().enumerate() {
            let ends_frame = (begin + k + 1).is_multiple_of(*per_frame);
            if ends_frame && let Some(rooms) = rooms.of_frame(n_frames) {
                fetch(rooms);
            }
            mechanics.step(&mut self.batch, work, world);
            if ends_frame {
                if let Some(rooms) = rooms.of_frame(n_frames) {
                    self.show(rooms);
                }
                n_frames += 1;
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

    /// Puts the points into rooms, a lane each.
    fn show(&mut self, rooms: &mut [Room<'_>]) {
        L::dispatch(Show::<M, L> { batch: &self.batch, lengths: &mut self.lengths, rooms });
    }
}

/// [`Lanes::show`], compiled for the lanes' registers.
struct Show<'a, 'r, M: Mechanics, L: Lane> {
    batch: &'a M::Batch<L>,
    lengths: &'a mut Lengths<L>,
    rooms: &'a mut [Room<'r>],
}

impl<M: Mechanics, L: Lane> NullaryFnOnce for Show<'_, '_, M, L> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { batch, lengths, rooms } = self;
        let mut numbers = Numbers::of::<L>(rooms);
        let mut listener = lengths.listen();
        let mut before = M::root_m(batch).as_single();
        numbers.put(0, before);
        M::show_ends_m(batch, |stick, ends| {
            let ends = ends.as_single();
            listener.hear(stick, (before, ends));
            numbers.put(stick + 1, ends);
            before = ends;
        });
        listener.end();
    }
}
