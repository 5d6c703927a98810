//! The loop over steps and strands, and what is reported of it.

use super::{PaperModel, PaperStrand};
use crate::assumptions::assumptions;
use crate::frames::{Frames, max_stretch, single};
use crate::parts::{Count, Part, run_parts};
use crate::plan::plan;
use crate::stability::limit;
use crate::timeline::{StepScene, Timeline};
use crate::touchable::{Touchable, n_reaching, touchable};
use crate::{Keeper, SimError, SimOptions, SimReport, Simulation};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use tousle_core::{Groom, NoProgress, Pose, Progress, StrandMotion};
use tousle_field::{FieldLayer, FieldSequence, Scene};
use tousle_rod::{DragLaw, Likely, Lock, Surface, Twist, rest_state};

/// Steps that a strand runs before the next one's turn: enough to spread the cost of preparing what the world
/// does, few enough that it is prepared in little memory and progress is seen.
const BLOCK_STEPS: usize = 32;

/// A strand on its way, and how it hangs at rest.
#[derive(Clone, Debug)]
pub(crate) struct Prepared {
    strand: PaperStrand,
    touchable: Vec<Touchable>,
    /// Deepest that its rest curve lies in the body, m.
    deepest_m: f64,
}

/// A run that is prepared: all that layers on the field do not change.
#[derive(Debug)]
pub(crate) struct Ready<'a> {
    field: &'a FieldSequence,
    scene: &'a Scene,
    groom: &'a Groom,
    options: &'a SimOptions,
    timeline: Timeline<'a>,
    drag: DragLaw,
    strands: Vec<Prepared>,
}

/// What layers on the field make of it.
struct Layered<'a> {
    timeline: Timeline<'a>,
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
        Ok(Self { field, scene, groom, options, timeline, drag, strands })
    }

    pub fn run(
        &self,
        layers: &[FieldLayer],
        keeper: Option<&dyn Keeper>,
        progress: &dyn Progress,
    ) -> Result<Simulation, SimError> {
        let layered = self.layered(layers)?;
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
        Ok(self.move_strands(&self.layered(layers)?, strands, &NoProgress))
    }

    /// Some strands, in ascending order, moved to a frame.
    pub fn hold(
        &self,
        layers: &[FieldLayer],
        strands: &[usize],
        frame: usize,
    ) -> Result<Vec<Prepared>, SimError> {
        let layered = self.layered(layers)?;
        let mut held = self.at_rest(strands);
        layered.move_to(&mut held, (0, frame), &NoProgress, |_, _, _| ());
        Ok(held)
    }

    /// Held strands from their frame to another one, both included.
    pub fn go_on(
        &self,
        held: &[Prepared],
        layers: &[FieldLayer],
        strands: &[usize],
        (first, last): (usize, usize),
    ) -> Result<Vec<[f32; 3]>, SimError> {
        let layered = self.layered(layers)?;
        let mut frames = Frames::new(self.groom, strands, last - first + 1);
        let mut held = held.to_vec();
        for (strand, s) in held.iter_mut().zip(strands) {
            frames.put(0, &[*s], &strand.points());
        }
        layered.move_to(&mut held, (first, last), &NoProgress, |k, frame, points| {
            frames.put(frame - first, &[strands[k]], points);
        });
        Ok(frames.positions_m)
    }

    /// One held strand under each of some variants' layers beside the common ones, as by [`Ready::go_on`].
    pub fn variants(
        &self,
        held: &[Prepared],
        layers: &[FieldLayer],
        variants: &[&[FieldLayer]],
        strand: usize,
        frames: (usize, usize),
    ) -> Result<Vec<Vec<[f32; 3]>>, SimError> {
        let variant = |own: &&[FieldLayer]| self.go_on(held, &[layers, own].concat(), &[strand], frames);
        variants.par_iter().map(variant).collect()
    }

    fn layered<'b>(&self, layers: &'b [FieldLayer]) -> Result<Layered<'b>, SimError>
    where
        'a: 'b,
    {
        let mut timeline: Timeline<'b> = self.timeline.with_layers(layers);
        let limit = cut_into_steps(&mut timeline, self.field, self.groom, self.options, &self.drag)?;
        let model = PaperModel {
            integrator: self.options.integrator(),
            terms: timeline.terms,
            drag: self.drag,
            friction: self.scene.body.friction,
        };
        Ok(Layered { timeline, model, limit })
    }

    fn at_rest(&self, strands: &[usize]) -> Vec<Prepared> {
        strands.iter().map(|s| self.strands[*s].clone()).collect()
    }

    fn move_strands(&self, layered: &Layered<'_>, some: &[usize], progress: &dyn Progress) -> Vec<[f32; 3]> {
        let n_frames = layered.timeline.n_frames;
        let mut frames = Frames::new(self.groom, some, n_frames);
        let mut strands = self.at_rest(some);
        layered.move_to(&mut strands, (0, n_frames - 1), progress, |k, frame, points| {
            frames.put(frame, &[some[k]], points);
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
            plan: plan(self.field, self.scene, timeline, &n_reaching),
            max_stretch: max_stretch(motion),
            assumed: assumptions(self.groom, timeline, self.strands.iter().map(|s| s.deepest_m)),
        }
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
        let deepest_m = -rest.clearances_m.iter().copied().fold(0.0, f64::min);
        Prepared { strand: PaperStrand::new(lock, &rest, &touchable), touchable, deepest_m }
    };
    groom.strands.par_iter().map(prepare).collect()
}

impl Layered<'_> {
    /// Moves strands from a frame to another. `put` gets which one it is, the frame, and its points without the root.
    fn move_to(
        &self,
        strands: &mut [Prepared],
        (first, last): (usize, usize),
        progress: &dyn Progress,
        mut put: impl FnMut(usize, usize, &[[f32; 3]]),
    ) {
        let per_frame = self.timeline.steps_per_frame;
        let (start, end) = (first * per_frame, last * per_frame);
        let total = (strands.len() * (end - start)) as u64;
        let done = AtomicU64::new(0);
        for begin in (start..end).step_by(BLOCK_STEPS) {
            let steps = begin..(begin + BLOCK_STEPS).min(end);
            let scenes: Vec<_> = steps.clone().map(|step| self.timeline.step_scene(step)).collect();
            let blocks: Vec<Vec<Vec<[f32; 3]>>> = strands
                .par_iter_mut()
                .map(|strand| {
                    let frames = self.move_strand(strand, begin, &scenes);
                    let n = steps.len() as u64;
                    progress.at(done.fetch_add(n, Ordering::Relaxed) + n, total);
                    frames
                })
                .collect();
            for (s, block) in blocks.into_iter().enumerate() {
                for (k, points) in block.into_iter().enumerate() {
                    put(s, begin / per_frame + 1 + k, &points);
                }
            }
        }
    }

    /// Runs a strand through some steps. Out: its points, the root left out, in every frame that these complete.
    fn move_strand(
        &self,
        prepared: &mut Prepared,
        begin: usize,
        scenes: &[StepScene<'_>],
    ) -> Vec<Vec<[f32; 3]>> {
        let mut frames = Vec::new();
        for (k, scene) in scenes.iter().enumerate() {
            prepared.strand.step(&self.model, scene);
            if (begin + k + 1).is_multiple_of(self.timeline.steps_per_frame) {
                frames.push(prepared.points());
            }
        }
        frames
    }
}

impl Prepared {
    /// The points as the result holds them, the root left out.
    fn points(&mut self) -> Vec<[f32; 3]> {
        self.strand.ends_m().iter().copied().map(single).collect()
    }
}
