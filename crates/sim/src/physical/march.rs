//! The loop over steps and batches.

use super::adaptive::Pace;
use super::batch::{Batch, Count, Model};
use super::build::{Prepared, build};
use super::explicit::Swing;
use super::implicit::Formula;
use super::link::Work;
use super::scene::{Carry, Now};
use crate::Integrator;
use crate::frames::{Frames, put_ends, single};
use crate::lane::{F64x1, Lane};
use crate::parts::Part;
use crate::timeline::Timeline;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use tousle_core::{Groom, Progress};
use tousle_field::{Reading, Sampler};
use tousle_rod::DragLaw;

/// What a run is made of, whatever its numbers are.
pub(super) struct March<'a> {
    pub timeline: &'a Timeline<'a>,
    pub sampler: &'a Sampler<'a>,
    pub reading: Reading,
    pub model: Model,
    pub integrator: Integrator,
    /// [`Integrator::Adaptive`]: the most that a step may be off, m.
    pub tolerance_m: f64,
    pub groom: &'a Groom,
    /// The strands to be moved, in ascending order.
    pub strands: &'a [usize],
    /// All strands of the groom.
    pub prepared: &'a [Prepared],
    pub law: DragLaw,
    pub progress: &'a dyn Progress,
}

/// Steps that a batch runs before the next one's turn. Few batches stay in the nearest memory with all they need; with
/// many, it is the laid-together fields that must stay there.
const BLOCK_OF_FEW: usize = 32;
const BLOCK_OF_MANY: usize = 3;

/// What the world does in a step, and at its end.
struct World<'a> {
    carry: Option<Carry>,
    now: Now<'a>,
}

/// Strands in an order in which neighbors in a batch have as many sticks, and neighbors in the list grow close by.
pub(super) fn order(prepared: &[Prepared], strands: &[usize]) -> Vec<usize> {
    let mut order = strands.to_vec();
    let cell = |p: &Prepared| {
        let [x, y, z] = [0, 1, 2].map(|axis| ((p.lock.root_m[axis] + 0.5) * 50.0) as i64);
        (x, y, z)
    };
    order.sort_by_cached_key(|s| (prepared[*s].lock.n_sticks(), cell(&prepared[*s])));
    order
}

impl March<'_> {
    /// All strands from the first frame to the last.
    pub fn in_step<L: Lane>(&self) -> Part {
        let last = self.timeline.n_frames - 1;
        let mut frames = Frames::new(self.groom, self.strands, last + 1);
        let mut batches = self.batches::<L>();
        self.move_batches(&mut batches, (0, last), |frame, batch, points| {
            frames.put(frame, &batch.strands, points);
        });
        let count = batches.iter().fold(Count::default(), |sum, b| sum.and(b.count));
        Part { positions_m: frames.positions_m, count }
    }

    /// All strands, moved to a frame.
    pub fn hold<L: Lane>(&self, frame: usize) -> Vec<Batch<L>> {
        let mut batches = self.batches::<L>();
        self.move_batches(&mut batches, (0, frame), |_, _, _| ());
        batches
    }

    /// The positions of all strands, held at the first of two frames, from it to the other.
    pub fn go_on<L: Lane>(&self, mut batches: Vec<Batch<L>>, (first, last): (usize, usize)) -> Vec<[f32; 3]> {
        let mut frames = Frames::new(self.groom, self.strands, last - first + 1);
        batches.iter().for_each(|batch| frames.put(0, &batch.strands, &self.points(batch)));
        self.move_batches(&mut batches, (first, last), |frame, batch, points| {
            frames.put(frame - first, &batch.strands, points);
        });
        frames.positions_m
    }

    /// As [`March::go_on`], of variants of one strand: `held` has it in every lane. Each variant's positions.
    pub fn go_on_in_turn<L: Lane>(
        &self,
        held: &Batch<L>,
        n_variants: usize,
        (first, last): (usize, usize),
    ) -> Vec<Vec<[f32; 3]>> {
        let root = single(held.root.get(0));
        let mut batch = [Batch { strands: vec![held.strands[0]; n_variants], ..held.clone() }];
        let mut moved = vec![Vec::new(); n_variants];
        let mut put = |points: &[[f32; 3]]| {
            for (moved, points) in moved.iter_mut().zip(points.chunks_exact(held.links.len())) {
                moved.push(root);
                moved.extend_from_slice(points);
            }
        };
        put(&self.points(&batch[0]));
        self.move_batches(&mut batch, (first, last), |_, _, points| put(points));
        moved
    }

    /// Batches from a frame to another, a block of steps at a time. `put` gets the points of each batch in each frame.
    fn move_batches<L: Lane>(
        &self,
        batches: &mut [Batch<L>],
        (first, last): (usize, usize),
        mut put: impl FnMut(usize, &Batch<L>, &[[f32; 3]]),
    ) {
        let timeline = self.timeline;
        let block = if self.reading == Reading::Together { BLOCK_OF_MANY } else { BLOCK_OF_FEW };
        let (start, end) = (first * timeline.steps_per_frame, last * timeline.steps_per_frame);
        let done = AtomicU64::new(0);
        let total = (self.strands.len() * (end - start)) as u64;
        for begin in (start..end).step_by(block) {
            let steps = begin..(begin + block).min(end);
            let worlds: Vec<World<'_>> = steps.clone().map(|step| self.world(step)).collect();
            let blocks: Vec<Vec<[f32; 3]>> = batches
                .par_iter_mut()
                .map_init(Vec::new, |work, batch| {
                    let frames = self.move_batch(batch, work, begin, &worlds);
                    let n = (batch.strands.len() * steps.len()) as u64;
                    self.progress.at(done.fetch_add(n, Ordering::Relaxed) + n, total);
                    frames
                })
                .collect();
            let frame = begin / timeline.steps_per_frame + 1;
            for (batch, block) in batches.iter().zip(blocks) {
                for (k, points) in block.chunks_exact(self.n_points(batch)).enumerate() {
                    put(frame + k, batch, points);
                }
            }
        }
    }

    /// A batch through a block of steps. Out: its strands' points in every frame that these complete.
    fn move_batch<L: Lane>(
        &self,
        batch: &mut Batch<L>,
        work: &mut Vec<Work<L>>,
        begin: usize,
        worlds: &[World<'_>],
    ) -> Vec<[f32; 3]> {
        batch.make_room(work);
        let dt_secs = self.timeline.dt_secs();
        let formula = match self.integrator {
            Integrator::ImplicitEuler => Formula::euler(dt_secs),
            _ => Formula::bdf2(dt_secs, dt_secs),
        };
        let n_frames = worlds.len() / self.timeline.steps_per_frame + 1;
        let mut frames = Vec::with_capacity(n_frames * self.n_points(batch));
        for (k, world) in worlds.iter().enumerate() {
            batch.step_implicit(work, &self.model, &world.now, world.carry.as_ref(), formula);
            if (begin + k + 1).is_multiple_of(self.timeline.steps_per_frame) {
                self.put_points(batch, &mut frames);
            }
        }
        frames
    }

    /// Strand by strand through all steps of an explicit integrator.
    pub fn explicit(&self) -> Part {
        let dt_secs = self.timeline.dt_secs();
        let is_rk4 = self.integrator == Integrator::Rk4;
        let first = Now::new(self.timeline, self.sampler, self.secs(0), Reading::LaidOut);
        self.one_by_one(|batch, work, frame, swing: &mut Option<Swing<F64x1>>| {
            let swing = swing.get_or_insert_with(|| Swing::at_rest(batch, &first));
            for step in (frame - 1) * self.timeline.steps_per_frame..frame * self.timeline.steps_per_frame {
                let at = |share: f64| {
                    Now::new(self.timeline, self.sampler, self.secs(step) + share * dt_secs, Reading::LaidOut)
                };
                if is_rk4 {
                    let now = [at(0.0), at(0.5), at(1.0)];
                    batch.step_rk4(swing, work, &self.model, [&now[0], &now[1], &now[2]], dt_secs);
                } else {
                    batch.step_semi_implicit(swing, work, &self.model, &at(0.0), dt_secs);
                }
            }
        })
    }

    /// Every strand at its own pace.
    pub fn adaptive(&self) -> Part {
        self.one_by_one(|batch, work, frame, pace: &mut Option<Pace>| {
            let pace = pace.get_or_insert_with(Pace::new);
            let span = (self.timeline.frame_secs(frame - 1), self.timeline.frame_secs(frame));
            batch.advance(pace, work, &self.model, (self.timeline, self.sampler), span, self.tolerance_m);
        })
    }

    /// Every strand by itself. `to_frame` moves one from the frame before to a frame, with what it keeps between.
    fn one_by_one<K: Send>(
        &self,
        to_frame: impl Fn(&mut Batch<F64x1>, &mut [Work<F64x1>], usize, &mut Option<K>) + Sync,
    ) -> Part {
        let n_frames = self.timeline.n_frames;
        let mut frames = Frames::new(self.groom, self.strands, n_frames);
        let mut batches = self.batches::<F64x1>();
        let done = AtomicU64::new(0);
        let total = (batches.len() * (n_frames - 1)) as u64;
        let moved: Vec<Vec<[f32; 3]>> = batches
            .par_iter_mut()
            .map_init(Vec::new, |work, batch| {
                batch.make_room(work);
                let mut kept = None;
                let mut points = Vec::with_capacity((n_frames - 1) * self.n_points(batch));
                for frame in 1..n_frames {
                    to_frame(batch, work, frame, &mut kept);
                    self.progress.at(done.fetch_add(1, Ordering::Relaxed) + 1, total);
                    self.put_points(batch, &mut points);
                }
                points
            })
            .collect();
        for (batch, strand_frames) in batches.iter().zip(moved) {
            for (k, points) in strand_frames.chunks_exact(self.n_points(batch)).enumerate() {
                frames.put(k + 1, &batch.strands, points);
            }
        }
        let count = batches.iter().fold(Count::default(), |sum, b| sum.and(b.count));
        Part { positions_m: frames.positions_m, count }
    }

    fn batches<L: Lane>(&self) -> Vec<Batch<L>> {
        let n_colliders = self.timeline.body().colliders.len();
        let batch = |strands: &[usize]| {
            let strands: Vec<_> = strands.iter().map(|s| (*s, &self.prepared[*s])).collect();
            build(&strands, &self.law, n_colliders)
        };
        let mut batches: Vec<Batch<L>> = order(self.prepared, self.strands).chunks(L::N).map(batch).collect();
        // A head that is held otherwise than at rest sets its hair going.
        let hangs_still = self.timeline.tilt_at_start() == 0.0;
        batches.iter_mut().for_each(|batch| batch.at_rest = hangs_still);
        batches
    }

    /// Points of a batch's strands, roots left out.
    fn n_points<L: Lane>(&self, batch: &Batch<L>) -> usize {
        batch.strands.iter().map(|s| self.prepared[*s].lock.n_sticks()).sum()
    }

    fn points<L: Lane>(&self, batch: &Batch<L>) -> Vec<[f32; 3]> {
        let mut points = Vec::with_capacity(self.n_points(batch));
        self.put_points(batch, &mut points);
        points
    }

    /// Adds these points to others, strand after strand.
    fn put_points<L: Lane>(&self, batch: &Batch<L>, points: &mut Vec<[f32; 3]>) {
        let n_sticks: Vec<usize> = batch.strands.iter().map(|s| self.prepared[*s].lock.n_sticks()).collect();
        put_ends(batch.states.iter().map(|state| state.place), &n_sticks, points);
    }

    /// Time at which a step begins, s.
    fn secs(&self, step: usize) -> f64 {
        let (frame, within) = (step / self.timeline.steps_per_frame, step % self.timeline.steps_per_frame);
        self.timeline.frame_secs(frame) + within as f64 * self.timeline.dt_secs()
    }

    fn world(&self, step: usize) -> World<'_> {
        let (begin, end) = (self.secs(step), self.secs(step + 1));
        World {
            carry: Carry::new(self.timeline, begin, end),
            now: Now::new(self.timeline, self.sampler, end, self.reading),
        }
    }
}
