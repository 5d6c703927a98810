//! The loop over steps and strands, and what is reported of it.

use super::build::Prepared;
use super::{Batch, PaperModel, Work};
use crate::assumptions::assumptions;
use crate::frames::{Frames, max_stretch, put_ends};
use crate::lane::{Lane, Registers, WithLanes};
use crate::parts::{Count, Part, run_parts};
use crate::plan::plan;
use crate::stability::limit;
use crate::timeline::{Runs, StepScene, Timeline};
use crate::touchable::{n_reaching, touchable, within_reach};
use crate::{Keeper, SimError, SimOptions, SimReport, Simulation};
use core::fmt::Debug;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use tousle_core::{Groom, NoProgress, Pose, Progress, StrandMotion};
use tousle_field::{FieldLayer, FieldSequence, Reading, Sampler, Scene};
use tousle_rod::{DragLaw, Likely, Lock, Surface, Twist, rest_state};

/// Steps that a strand runs before the next one's turn: enough to spread the cost of preparing what the world
/// does, few enough that it is prepared in little memory and progress is seen.
const BLOCK_STEPS: usize = 32;

/// Strands side by side, somewhere on their way.
#[derive(Clone, Debug)]
pub(crate) struct Held(Arc<dyn SideBySide>);

/// Batches, however many strands are side by side.
trait SideBySide: Debug + Send + Sync {
    /// [`Ready::go_on`].
    fn go_on(
        &self,
        ready: &Ready<'_>,
        layered: &Layered<'_>,
        strands: &[usize],
        frames: (usize, usize),
    ) -> Vec<[f32; 3]>;
}

impl<L: Lane> SideBySide for Vec<Batch<L>> {
    fn go_on(
        &self,
        ready: &Ready<'_>,
        layered: &Layered<'_>,
        strands: &[usize],
        frames: (usize, usize),
    ) -> Vec<[f32; 3]> {
        ready.move_on(layered, self.clone(), strands, frames)
    }
}

/// Strands from the first frame to the last.
struct MoveAll<'a> {
    ready: &'a Ready<'a>,
    layered: &'a Layered<'a>,
    strands: &'a [usize],
    progress: &'a dyn Progress,
}

impl WithLanes for MoveAll<'_> {
    type Output = Vec<[f32; 3]>;

    fn with<L: Lane>(self) -> Vec<[f32; 3]> {
        self.ready.move_all::<L>(self.layered, self.strands, self.progress)
    }
}

/// Strands moved to a frame.
struct Hold<'a> {
    ready: &'a Ready<'a>,
    layered: &'a Layered<'a>,
    strands: &'a [usize],
    frame: usize,
}

impl WithLanes for Hold<'_> {
    type Output = Held;

    fn with<L: Lane>(self) -> Held {
        Held(Arc::new(self.ready.hold_batches::<L>(self.layered, self.strands, self.frame)))
    }
}

/// A run that is prepared: all that layers on the field do not change.
#[derive(Debug)]
pub(crate) struct Ready<'a> {
    field: &'a FieldSequence,
    scene: &'a Scene,
    groom: &'a Groom,
    options: &'a SimOptions,
    pub registers: Registers,
    timeline: Timeline<'a>,
    sampler: Sampler<'a>,
    drag: DragLaw,
    strands: Vec<Prepared>,
}

/// What layers on the field make of it.
struct Layered<'a> {
    timeline: Timeline<'a>,
    sampler: Sampler<'a>,
    reading: Reading,
    model: PaperModel,
    /// The integrator's limit for this groom, in words.
    limit: String,
}

impl<'a> Ready<'a> {
    pub fn new(
        field: &'a FieldSequence,
        scene: &'a Scene,
        groom: &'a Groom,
        options: &'a SimOptions,
    ) -> Result<Self, SimError> {
        let timeline = Timeline::new(field, scene, options, groom.n_points())?;
        let strands = prepare(scene, groom, &timeline);
        let drag = DragLaw::in_air(scene.air_density);
        let sampler = within_reach(Sampler::new(field, |_| false), strands.iter().map(|s| &s.lock));
        let registers = Registers::widest();
        Ok(Self { field, scene, groom, options, registers, timeline, sampler, drag, strands })
    }

    pub fn run(
        &self,
        layers: &[FieldLayer],
        keeper: Option<&dyn Keeper>,
        progress: &dyn Progress,
        runs: Runs,
    ) -> Result<Simulation, SimError> {
        let layered = self.layered(layers, runs)?;
        let timeline = &layered.timeline;
        let order: Vec<usize> = (0..self.strands.len()).collect();
        let spans = (timeline.n_frames, timeline.n_steps());
        let moved = run_parts(self.groom, &order, spans, keeper, progress, |some, progress| Part {
            positions_m: self.move_strands(&layered, some, progress),
            count: Count::default(),
        })?;
        let (counts, times_secs) = (self.groom.counts(), self.times_secs());
        let motion = StrandMotion { counts, times_secs, positions_m: moved.positions_m };
        let report = self.report(&layered, &motion);
        Ok(Simulation { motion, report })
    }

    /// Time of every frame, s.
    pub fn times_secs(&self) -> Vec<f64> {
        (0..self.timeline.n_frames).map(|frame| self.timeline.frame_secs(frame)).collect()
    }

    /// Some strands, in ascending order, from the first frame to the last.
    pub fn run_some(&self, layers: &[FieldLayer], strands: &[usize]) -> Result<Vec<[f32; 3]>, SimError> {
        Ok(self.move_strands(&self.layered(layers, Runs::Again)?, strands, &NoProgress))
    }

    /// Some strands, in ascending order, moved to a frame.
    pub fn hold(&self, layers: &[FieldLayer], strands: &[usize], frame: usize) -> Result<Held, SimError> {
        let layered = self.layered(layers, Runs::Again)?;
        let hold = Hold { ready: self, layered: &layered, strands, frame };
        Ok(self.registers.with_lanes(self.options.precision, hold))
    }

    fn hold_batches<L: Lane>(&self, layered: &Layered<'_>, strands: &[usize], frame: usize) -> Vec<Batch<L>> {
        let mut batches = self.at_rest(strands);
        self.move_to(layered, &mut batches, (0, frame), &NoProgress, |_, _, _| ());
        batches
    }

    /// Held strands from their frame to another one, both included.
    pub fn go_on(
        &self,
        held: &Held,
        layers: &[FieldLayer],
        strands: &[usize],
        frames: (usize, usize),
    ) -> Result<Vec<[f32; 3]>, SimError> {
        let layered = self.layered(layers, Runs::Again)?;
        Ok(held.0.go_on(self, &layered, strands, frames))
    }

    fn move_on<L: Lane>(
        &self,
        layered: &Layered<'_>,
        mut batches: Vec<Batch<L>>,
        strands: &[usize],
        (first, last): (usize, usize),
    ) -> Vec<[f32; 3]> {
        let mut frames = Frames::new(self.groom, strands, last - first + 1);
        for batch in &batches {
            let mut points = Vec::new();
            self.put_points(batch, &mut points);
            frames.put(0, &batch.strands, &points);
        }
        self.move_to(layered, &mut batches, (first, last), &NoProgress, |frame, strands, points| {
            frames.put(frame - first, strands, points);
        });
        frames.positions_m
    }

    /// One held strand under each of some variants' layers beside the common ones, as by [`Ready::go_on`].
    pub fn variants(
        &self,
        held: &Held,
        layers: &[FieldLayer],
        variants: &[&[FieldLayer]],
        strand: usize,
        frames: (usize, usize),
    ) -> Result<Vec<Vec<[f32; 3]>>, SimError> {
        let variant = |own: &&[FieldLayer]| self.go_on(held, &[layers, own].concat(), &[strand], frames);
        variants.par_iter().map(variant).collect()
    }

    fn layered<'b>(&self, layers: &'b [FieldLayer], runs: Runs) -> Result<Layered<'b>, SimError>
    where
        'a: 'b,
    {
        let mut timeline: Timeline<'b> = self.timeline.with_layers(layers);
        let limit = cut_into_steps(&mut timeline, self.field, self.groom, self.options, &self.drag)?;
        let model = PaperModel {
            integrator: self.options.integrator(),
            terms: timeline.terms,
            friction: self.scene.body.friction,
        };
        let reading = timeline.reading(self.groom.n_points(), runs);
        Ok(Layered { timeline, sampler: self.sampler.with_layers(layers), reading, model, limit })
    }

    /// Strands of as many sticks side by side.
    fn at_rest<L: Lane>(&self, strands: &[usize]) -> Vec<Batch<L>> {
        let mut order = strands.to_vec();
        order.sort_by_key(|s| self.strands[*s].lock.n_sticks());
        let batch = |strands: &[usize]| {
            let strands: Vec<_> = strands.iter().map(|s| (*s, &self.strands[*s])).collect();
            Batch::new(&strands, &self.drag)
        };
        order.chunks(L::N).map(batch).collect()
    }

    fn move_strands(&self, layered: &Layered<'_>, some: &[usize], progress: &dyn Progress) -> Vec<[f32; 3]> {
        let all = MoveAll { ready: self, layered, strands: some, progress };
        self.registers.with_lanes(self.options.precision, all)
    }

    fn move_all<L: Lane>(
        &self,
        layered: &Layered<'_>,
        some: &[usize],
        progress: &dyn Progress,
    ) -> Vec<[f32; 3]> {
        let n_frames = layered.timeline.n_frames;
        let mut frames = Frames::new(self.groom, some, n_frames);
        let mut batches: Vec<Batch<L>> = self.at_rest(some);
        self.move_to(layered, &mut batches, (0, n_frames - 1), progress, |frame, strands, points| {
            frames.put(frame, strands, points);
        });
        frames.positions_m
    }

    fn report(&self, layered: &Layered<'_>, motion: &StrandMotion) -> SimReport {
        let timeline = &layered.timeline;
        let n_reaching = n_reaching(self.scene, self.strands.iter().map(|s| &s.touchable[..]));
        SimReport {
            integrator: self.options.integrator(),
            order: self.options.integrator().order(),
            limit: layered.limit.clone(),
            dt_secs: timeline.dt_secs(),
            n_steps: timeline.n_steps() as u64,
            iterations_per_step: 1.0,
            slept_share: 0.0,
            unsettled_steps: 0,
            unsettled_m: 0.0,
            plan: plan(&layered.sampler, self.scene, timeline, &n_reaching),
            max_stretch: max_stretch(motion),
            assumed: assumptions(self.groom, timeline, self.strands.iter().map(Prepared::deepest_m)),
        }
    }

    /// Moves batches from a frame to another. `put` gets the frame, some strands, and their points without the roots.
    fn move_to<L: Lane>(
        &self,
        layered: &Layered<'_>,
        batches: &mut [Batch<L>],
        (first, last): (usize, usize),
        progress: &dyn Progress,
        mut put: impl FnMut(usize, &[usize], &[[f32; 3]]),
    ) {
        let per_frame = layered.timeline.steps_per_frame;
        let (start, end) = (first * per_frame, last * per_frame);
        let n_strands: usize = batches.iter().map(|b| b.strands.len()).sum();
        let total = (n_strands * (end - start)) as u64;
        let done = AtomicU64::new(0);
        for begin in (start..end).step_by(BLOCK_STEPS) {
            let steps = begin..(begin + BLOCK_STEPS).min(end);
            let scene = |step: usize| layered.timeline.step_scene(step, &layered.sampler, layered.reading);
            let scenes: Vec<_> = steps.clone().map(scene).collect();
            let blocks: Vec<Vec<[f32; 3]>> = batches
                .par_iter_mut()
                .map_init(Vec::new, |work, batch| {
                    let frames = self.move_batch(layered, batch, work, begin, &scenes);
                    let n = (batch.strands.len() * steps.len()) as u64;
                    progress.at(done.fetch_add(n, Ordering::Relaxed) + n, total);
                    frames
                })
                .collect();
            for (batch, block) in batches.iter().zip(blocks) {
                for (k, points) in block.chunks_exact(self.n_points(batch)).enumerate() {
                    put(begin / per_frame + 1 + k, &batch.strands, points);
                }
            }
        }
    }

    /// Runs a batch through some steps. Out: its points, roots left out, in every frame that these complete.
    fn move_batch<L: Lane>(
        &self,
        layered: &Layered<'_>,
        batch: &mut Batch<L>,
        work: &mut Vec<Work<L>>,
        begin: usize,
        scenes: &[StepScene<'_>],
    ) -> Vec<[f32; 3]> {
        let per_frame = layered.timeline.steps_per_frame;
        let mut frames = Vec::with_capacity((scenes.len() / per_frame + 1) * self.n_points(batch));
        for (k, scene) in scenes.iter().enumerate() {
            batch.step(work, &layered.model, scene);
            if (begin + k + 1).is_multiple_of(per_frame) {
                self.put_points(batch, &mut frames);
            }
        }
        frames
    }

    /// Points of a batch's strands, roots left out.
    fn n_points<L: Lane>(&self, batch: &Batch<L>) -> usize {
        batch.strands.iter().map(|s| self.strands[*s].lock.n_sticks()).sum()
    }

    /// Adds these points to others, strand after strand.
    fn put_points<L: Lane>(&self, batch: &Batch<L>, points: &mut Vec<[f32; 3]>) {
        let n_sticks: Vec<usize> = batch.strands.iter().map(|s| self.strands[*s].lock.n_sticks()).collect();
        put_ends(batch.ends_m(), &n_sticks, points);
    }
}

/// Chooses the step. Out: the integrator's limit for this groom, in words.
fn cut_into_steps(
    timeline: &mut Timeline<'_>,
    field: &FieldSequence,
    groom: &Groom,
    options: &SimOptions,
    drag: &DragLaw,
) -> Result<String, SimError> {
    let limit = if options.integrator().is_limited() { limit(field, groom, timeline, drag) } else { None };
    let Some(limit) = limit else {
        timeline.cut(options.dt_secs.unwrap_or(SimOptions::DEFAULT_DT_SECS))?;
        return Ok("none: no step is too long or too stiff".to_owned());
    };
    let strand = &groom.strands[limit.strand_idx].name;
    let default_secs = f64::min(SimOptions::DEFAULT_DT_SECS, limit.dt_secs);
    timeline.cut(options.dt_secs.unwrap_or(default_secs))?;
    if timeline.dt_secs() > limit.dt_secs {
        return Err(SimError::Unstable {
            integrator: options.integrator().name(),
            dt_secs: timeline.dt_secs(),
            limit_secs: limit.dt_secs,
            strand: strand.clone(),
            point: Some(limit.point),
        });
    }
    Ok(format!("{:.3e} s, set by strand {strand}, control point {}", limit.dt_secs, limit.point))
}

fn prepare(scene: &Scene, groom: &Groom, timeline: &Timeline<'_>) -> Vec<Prepared> {
    let gravity = timeline.gravity_at_rest();
    let surfaces = Surface::of_body(&scene.body, &Pose::identity());
    let prepare = |strand: &tousle_core::Strand| {
        let lock = Lock::new(strand);
        let rest = rest_state(&lock, gravity, &scene.body, &Likely::smooth(&lock, Twist::Free));
        let touchable = touchable(scene, timeline, &surfaces, &lock, &rest);
        Prepared { lock, rest, touchable }
    };
    groom.strands.par_iter().map(prepare).collect()
}
