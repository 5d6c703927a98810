//! What is prepared before the first step, and what is said after the last.

use crate::assumptions::assumptions;
use crate::frames::{Frames, Rooms};
use crate::mechanics::{Mechanics, Setting};
use crate::parts::{Count, Part, run_parts};
use crate::plan::plan;
use crate::prepared::{Prepared, order};
use crate::run::{Abreast, Run, SideBySide};
use crate::stability;
use crate::timeline::{Runs, Timeline};
use crate::touchable::{n_reaching, within_reach};
use crate::trace::Whereabouts;
use crate::{
    Frame, FrameSink, Integrator, Keeper, Precision, SimError, SimOptions, SimReport, Simulation, Steps,
};
use core::any::Any;
use core::fmt::Debug;
use rayon::prelude::*;
use std::sync::Arc;
use tousle_core::{NoProgress, Progress, StrandMotion};
use tousle_field::{FieldLayer, Sampler};
use tousle_lanes::Registers;

/// A run that is prepared, whatever its mechanics and however many strands are side by side.
pub(crate) trait Resident: Debug + Send + Sync {
    /// Time of every frame, s.
    fn times_secs(&self) -> Vec<f64>;

    /// All strands from the first frame to the last.
    fn run(
        &self,
        layers: &[FieldLayer],
        keeper: Option<&dyn Keeper>,
        progress: &dyn Progress,
        runs: Runs,
    ) -> Result<Simulation, SimError>;

    /// All strands from the first frame to the last, frame by frame into a sink.
    fn run_into(
        &self,
        layers: &[FieldLayer],
        sink: &mut FrameSink<'_>,
        progress: &dyn Progress,
        runs: Runs,
    ) -> Result<SimReport, SimError>;

    /// How a run is cut into steps.
    fn steps(&self, layers: &[FieldLayer]) -> Result<Steps, SimError>;

    /// Some strands, in ascending order, from the first frame to the last.
    fn run_some(&self, layers: &[FieldLayer], strands: &[usize]) -> Result<Vec<[f32; 3]>, SimError>;

    /// [`Resident::run_some`], and where the strands asked the field.
    fn trace(
        &self,
        layers: &[FieldLayer],
        strands: &[usize],
        progress: &dyn Progress,
    ) -> Result<(Vec<[f32; 3]>, Whereabouts), SimError>;

    /// Whether a layer changes only strands that come near it.
    fn is_local(&self) -> bool;

    /// Some strands, in ascending order, stopped at a frame.
    fn hold(&self, layers: &[FieldLayer], strands: &[usize], frame: usize) -> Result<Held, SimError>;

    /// Held strands, stopped again at a later frame.
    ///
    /// # Panics
    /// If they are those of other mechanics.
    fn hold_on(&self, held: &Held, layers: &[FieldLayer], frame: usize) -> Result<Held, SimError>;

    /// How many variants are stepped side by side.
    fn n_at_once(&self) -> usize;

    /// Held strands from their frame to another one, both included.
    ///
    /// # Panics
    /// If they are those of other mechanics.
    fn go_on(
        &self,
        held: &Held,
        layers: &[FieldLayer],
        strands: &[usize],
        frames: (usize, usize),
    ) -> Result<Vec<[f32; 3]>, SimError>;

    /// One held strand under each of some variants' layers beside the common ones, as by [`Resident::go_on`].
    fn variants(
        &self,
        held: &Held,
        layers: &[FieldLayer],
        variants: &[&[FieldLayer]],
        strand: usize,
        frames: (usize, usize),
    ) -> Result<Vec<Vec<[f32; 3]>>, SimError>;
}

/// The [`Stopped`] strands of some mechanics.
pub(crate) type Held = Arc<dyn Any + Send + Sync>;

/// Strands that were stopped at a frame.
struct Stopped<M: Mechanics> {
    frame: usize,
    strands: Box<dyn Abreast<M>>,
}

/// All that layers on the field do not change.
#[derive(Debug)]
pub(crate) struct Ready<'a, M: Mechanics> {
    setting: Setting<'a>,
    timeline: Timeline<'a>,
    sampler: Sampler<'a>,
    strands: Vec<Prepared<M::Shape>>,
    side_by_side: SideBySide<M>,
}

impl<'a, M: Mechanics> Ready<'a, M> {
    /// A run that is prepared for the registers of this machine.
    pub fn resident(setting: Setting<'a>) -> Result<Box<dyn Resident + 'a>, SimError> {
        let (registers, precision) = M::lanes(setting.options);
        Self::resident_in(setting, registers, precision)
    }

    /// A run that is prepared for some registers.
    pub fn resident_in(
        setting: Setting<'a>,
        registers: Registers,
        precision: Precision,
    ) -> Result<Box<dyn Resident + 'a>, SimError> {
        Ok(Box::new(Self::new(setting, SideBySide::of(registers, precision))?))
    }

    fn new(setting: Setting<'a>, side_by_side: SideBySide<M>) -> Result<Self, SimError> {
        let Setting { field, scene, options, .. } = setting;
        let mut timeline = Timeline::new(field, scene, options)?;
        timeline.cut(options.dt_secs, SimOptions::DEFAULT_DT_SECS)?;
        let (_, precision) = M::lanes(options);
        stability::check_digits(precision, timeline.dt_secs(), M::SHORTEST_SINGLE_SECS)?;
        let strands = M::prepare(&setting, &timeline);
        let sampler = within_reach(Sampler::new(field, M::is_solid(scene)), strands.iter().map(|p| &p.lock));
        Ok(Self { setting, timeline, sampler, strands, side_by_side })
    }

    /// The run under some layers, whose motion is held.
    fn held_under<'b>(&self, layers: &'b [FieldLayer], runs: Runs) -> Result<Run<'b, M>, SimError>
    where
        'a: 'b,
    {
        let Setting { groom, options, .. } = self.setting;
        self.timeline.check_held(options, groom.n_points())?;
        self.under(layers, runs)
    }

    /// The run under some layers.
    fn under<'b>(&self, layers: &'b [FieldLayer], runs: Runs) -> Result<Run<'b, M>, SimError>
    where
        'a: 'b,
    {
        let Setting { groom, options, .. } = self.setting;
        let mut timeline: Timeline<'b> = self.timeline.with_layers(layers);
        let is_limited = options.integrator().is_limited();
        let limit = if is_limited { M::limit(&self.setting, &timeline, &self.strands) } else { None };
        if let Some(limit) = &limit {
            limit.cut(&mut timeline, groom, options)?;
        }
        let mechanics = M::new(&self.setting, &timeline);
        let reading = timeline.reading(groom.n_points(), runs);
        Ok(Run { timeline, sampler: self.sampler.with_layers(layers), reading, mechanics, limit })
    }

    fn report(&self, run: &Run<'_, M>, count: Count) -> SimReport {
        let Setting { scene, groom, options, .. } = self.setting;
        let Run { timeline, limit, .. } = run;
        let integrator = options.integrator();
        let mut assumed = assumptions(groom, timeline, self.strands.iter().map(Prepared::deepest_m));
        assumed.extend(M::assumed(&self.strands));
        assumed.extend(limit.as_ref().and_then(|limit| limit.hope(integrator, groom, timeline.dt_secs())));
        let n_reaching = n_reaching(scene, &self.strands);
        SimReport {
            integrator,
            order: integrator.order(),
            limit: stability::in_words(limit.as_ref(), groom),
            dt_secs: run.mechanics.longest_secs(timeline),
            n_steps: count.steps,
            iterations_per_step: count.iterations as f64 / (count.steps - count.slept).max(1) as f64,
            slept_share: count.slept as f64 / count.steps.max(1) as f64,
            unsettled_steps: count.unsettled,
            unsettled_m: count.unsettled_m,
            plan: plan(&run.sampler, scene, timeline, &n_reaching),
            max_stretch: count.max_stretch,
            assumed,
        }
    }

    /// Refuses frames of some strands, from a number on, of which a point is nowhere.
    fn check_whole(
        &self,
        run: &Run<'_, M>,
        strands: &[usize],
        (first, positions_m): (usize, &[[f32; 3]]),
    ) -> Result<(), SimError> {
        let Setting { groom, options, .. } = self.setting;
        let is_nowhere = |point: &[f32; 3]| point.iter().any(|c| !c.is_finite());
        let Some(at) = positions_m.iter().position(is_nowhere) else { return Ok(()) };
        let n_points = |strand: usize| groom.strands[strand].rest_curve_m.len();
        let per_frame: usize = strands.iter().map(|s| n_points(*s)).sum();
        let (mut point, mut place) = (at % per_frame, 0);
        while point >= n_points(strands[place]) {
            point -= n_points(strands[place]);
            place += 1;
        }
        let strand = groom.strands[strands[place]].name.clone();
        let integrator = options.integrator().name();
        let secs = run.timeline.frame_secs(first + at / per_frame);
        Err(match run.limit {
            Some(_) => SimError::BlewUp { integrator, strand, secs, dt_secs: run.timeline.dt_secs() },
            None => SimError::Nowhere { integrator, strand, secs },
        })
    }

    fn at_rest(&self, run: &Run<'_, M>, strands: &[usize]) -> Box<dyn Abreast<M>> {
        (self.side_by_side.at_rest)(&run.mechanics, &self.strands, &order(&self.strands, strands))
    }

    /// Some strands from the first frame to the last, none of which may come to be nowhere.
    fn move_whole(
        &self,
        run: &Run<'_, M>,
        strands: &[usize],
        progress: &dyn Progress,
    ) -> Result<Part, SimError> {
        let mut moving = self.at_rest(run, strands);
        let positions_m = self.move_all(run, strands, moving.as_mut(), progress);
        if !moving.are_whole() {
            self.check_whole(run, strands, (0, &positions_m))?;
        }
        Ok(Part { positions_m, count: moving.count() })
    }

    /// Some strands that are at rest from the first frame to the last.
    fn move_all(
        &self,
        run: &Run<'_, M>,
        strands: &[usize],
        moving: &mut dyn Abreast<M>,
        progress: &dyn Progress,
    ) -> Vec<[f32; 3]> {
        let last = run.timeline.n_frames - 1;
        let mut frames = Frames::new(self.setting.groom, strands, last + 1);
        run.advance(moving, (0, last), progress, Some((&mut frames, 0)));
        frames.positions_m
    }
}

impl<M: Mechanics> Resident for Ready<'_, M> {
    fn times_secs(&self) -> Vec<f64> {
        let timeline = &self.timeline;
        (0..timeline.n_frames).map(|frame| timeline.frame_secs(frame)).collect()
    }

    fn run(
        &self,
        layers: &[FieldLayer],
        keeper: Option<&dyn Keeper>,
        progress: &dyn Progress,
        runs: Runs,
    ) -> Result<Simulation, SimError> {
        let groom = self.setting.groom;
        let run = self.held_under(layers, runs)?;
        let all: Vec<usize> = (0..self.strands.len()).collect();
        let spans = (run.timeline.n_frames, run.timeline.n_steps());
        let order = order(&self.strands, &all);
        let moved = run_parts(groom, &order, spans, keeper, progress, |strands, progress| {
            self.move_whole(&run, strands, progress)
        })?;
        let (counts, times_secs) = (groom.counts(), self.times_secs());
        let motion = StrandMotion { counts, times_secs, positions_m: moved.positions_m };
        let report = self.report(&run, moved.count);
        Ok(Simulation { motion, report })
    }

    fn run_into(
        &self,
        layers: &[FieldLayer],
        sink: &mut FrameSink<'_>,
        progress: &dyn Progress,
        runs: Runs,
    ) -> Result<SimReport, SimError> {
        let groom = self.setting.groom;
        let run = self.under(layers, runs)?;
        let all: Vec<usize> = (0..self.strands.len()).collect();
        let mut moving = self.at_rest(&run, &all);
        let mut frames = Frames::new(groom, &all, run.frames_per_block().min(run.timeline.n_frames));
        run.say_all(moving.as_mut(), &mut frames, progress, |moving, first, positions_m| {
            let are_whole = moving.are_whole();
            for (k, positions_m) in positions_m.chunks_exact(groom.n_points()).enumerate() {
                let number = first + k;
                if !are_whole {
                    self.check_whole(&run, &all, (number, positions_m))?;
                }
                let secs = run.timeline.frame_secs(number);
                sink(Frame { number, secs, positions_m }).map_err(SimError::Sink)?;
            }
            Ok(())
        })?;
        Ok(self.report(&run, moving.count()))
    }

    fn steps(&self, layers: &[FieldLayer]) -> Result<Steps, SimError> {
        let Self { setting, timeline, .. } = self;
        let run = self.under(layers, Runs::Once)?;
        Ok(Steps {
            per_second: 1.0 / run.timeline.dt_secs(),
            in_all: run.timeline.n_steps(),
            unlimited_per_second: 1.0 / timeline.dt_secs(),
            limit: stability::in_words(run.limit.as_ref(), setting.groom),
        })
    }

    fn run_some(&self, layers: &[FieldLayer], strands: &[usize]) -> Result<Vec<[f32; 3]>, SimError> {
        let run = self.held_under(layers, Runs::Again)?;
        let mut moving = self.at_rest(&run, strands);
        Ok(self.move_all(&run, strands, moving.as_mut(), &NoProgress))
    }

    fn trace(
        &self,
        layers: &[FieldLayer],
        strands: &[usize],
        progress: &dyn Progress,
    ) -> Result<(Vec<[f32; 3]>, Whereabouts), SimError> {
        let run = self.held_under(layers, Runs::Again)?;
        let mut moving = self.at_rest(&run, strands);
        moving.keep_asked();
        let positions_m = self.move_all(&run, strands, moving.as_mut(), progress);
        let mut asked = moving.asked();
        asked.sort_unstable_by_key(|(strand, _)| *strand);
        let spans =
            run.blocks((0, run.timeline.n_frames - 1)).map(|steps| run.timeline.wind_span_secs(&steps));
        let regions = asked.into_iter().flat_map(|(_, regions)| regions);
        Ok((positions_m, Whereabouts::new(spans.collect(), regions.collect())))
    }

    fn is_local(&self) -> bool {
        let Self { setting, timeline, sampler, .. } = self;
        let integrator = setting.options.integrator();
        // Hair that sleeps at first wakes as soon as wind blows anywhere, be it a layer's.
        let sleeps = timeline.wind_secs(timeline.step_secs(1)).is_none_or(|secs| sampler.is_still_at(secs));
        // An explicit integrator's steps are as long as all layers allow, and the adaptive one asks at times of its own.
        !integrator.is_limited() && integrator != Integrator::Adaptive && !sleeps
    }

    fn hold(&self, layers: &[FieldLayer], strands: &[usize], frame: usize) -> Result<Held, SimError> {
        let run = self.under(layers, Runs::Again)?;
        // An explicit integrator's steps are as long as all layers allow: it begins anew under others.
        let frame = if self.setting.options.integrator().is_limited() { 0 } else { frame };
        let mut strands = self.at_rest(&run, strands);
        run.advance(strands.as_mut(), (0, frame), &NoProgress, None);
        Ok(Arc::new(Stopped { frame, strands }))
    }

    fn hold_on(&self, held: &Held, layers: &[FieldLayer], frame: usize) -> Result<Held, SimError> {
        if self.setting.options.integrator().is_limited() {
            return Ok(held.clone());
        }
        let stopped = Stopped::<M>::of(held);
        let run = self.under(layers, Runs::Again)?;
        let mut strands = stopped.strands.fork();
        run.advance(strands.as_mut(), (stopped.frame, frame), &NoProgress, None);
        Ok(Arc::new(Stopped { frame, strands }))
    }

    fn n_at_once(&self) -> usize {
        // An explicit integrator's steps are as long as each variant allows.
        if self.setting.options.integrator().is_limited() { 1 } else { self.side_by_side.n }
    }

    fn go_on(
        &self,
        held: &Held,
        layers: &[FieldLayer],
        strands: &[usize],
        (first, last): (usize, usize),
    ) -> Result<Vec<[f32; 3]>, SimError> {
        let stopped = Stopped::<M>::of(held);
        let run = self.under(layers, Runs::Again)?;
        let mut frames = Frames::new(self.setting.groom, strands, last - first + 1);
        stopped.go_on(&run, stopped.strands.fork(), (first, last), &mut frames);
        Ok(frames.positions_m)
    }

    fn variants(
        &self,
        held: &Held,
        layers: &[FieldLayer],
        variants: &[&[FieldLayer]],
        strand: usize,
        frames: (usize, usize),
    ) -> Result<Vec<Vec<[f32; 3]>>, SimError> {
        let stopped = Stopped::<M>::of(held);
        let n_at_once = self.n_at_once();
        let some: Vec<_> = variants
            .par_chunks(n_at_once)
            .map(|variants| {
                let all = [&[layers], variants].concat().concat();
                // One a lane: where there are fewer variants, the last one runs again and is not read.
                let each: Vec<_> = (0..n_at_once).map(|k| variants[k.min(variants.len() - 1)]).collect();
                let sampler = self.sampler.with_variants(layers, &each);
                let run = Run { sampler, ..self.under(&all, Runs::Again)? };
                let strands = stopped.strands.variants(variants.len());
                let each = vec![strand; variants.len()];
                let mut moved = Frames::new(self.setting.groom, &each, frames.1 - frames.0 + 1);
                stopped.go_on(&run, strands, frames, &mut moved);
                Ok(moved.apart())
            })
            .collect::<Result<_, SimError>>()?;
        Ok(some.concat())
    }
}

impl<M: Mechanics> Stopped<M> {
    fn of(held: &Held) -> &Self {
        held.downcast_ref().expect("strands held by a simulator of this method")
    }

    /// What was stopped, or variants of it, on to the last of some frames.
    fn go_on(
        &self,
        run: &Run<'_, M>,
        mut strands: Box<dyn Abreast<M>>,
        (first, last): (usize, usize),
        frames: &mut Frames,
    ) {
        if self.frame == first {
            let seats = frames.seats(&strands.indices());
            strands.show(&mut frames.rooms(0, 0..1, &seats, Rooms::default()));
        }
        run.advance(strands.as_mut(), (self.frame, last), &NoProgress, Some((frames, first)));
    }
}
