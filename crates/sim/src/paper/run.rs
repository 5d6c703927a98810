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
use tousle_core::{Groom, Pose, Progress, StrandMotion};
use tousle_field::{FieldSequence, Scene};
use tousle_rod::{DragLaw, Likely, Lock, Surface, Twist, rest_state};

/// Steps that a strand runs before the next one's turn: enough to spread the cost of preparing what the world
/// does, few enough that it is prepared in little memory and progress is seen.
const BLOCK_STEPS: usize = 32;

/// A strand on its way, and how it hangs at rest.
struct Prepared {
    strand: PaperStrand,
    touchable: Vec<Touchable>,
    /// Deepest that its rest curve lies in the body, m.
    deepest_m: f64,
}

pub(crate) fn run(
    field: &FieldSequence,
    scene: &Scene,
    groom: &Groom,
    options: &SimOptions,
    keeper: Option<&dyn Keeper>,
    progress: &dyn Progress,
) -> Result<Simulation, SimError> {
    let mut timeline = Timeline::new(field, scene, options, groom.n_points())?;
    let drag = DragLaw::in_air(scene.air_density);
    let limit = cut_into_steps(&mut timeline, field, groom, options, &drag)?;
    let model = PaperModel {
        integrator: options.integrator(),
        terms: timeline.terms,
        drag,
        friction: scene.body.friction,
    };
    let mut strands = prepare(scene, groom, &timeline);
    let n_reaching = n_reaching(scene, strands.iter().map(|s| &s.touchable[..]));
    let plan = plan(field, scene, &timeline, &n_reaching);
    let assumed = assumptions(groom, &timeline, strands.iter().map(|s| s.deepest_m));
    let order: Vec<usize> = (0..strands.len()).collect();
    let spans = (timeline.n_frames, timeline.n_steps());
    let moved = run_parts(groom, &order, spans, keeper, progress, |some, progress| {
        let positions_m = move_strands(&mut strands, some, &model, &timeline, groom, progress);
        Part { positions_m, count: Count::default() }
    })?;
    let times_secs = (0..timeline.n_frames).map(|frame| timeline.frame_secs(frame)).collect();
    let motion = StrandMotion { counts: groom.counts(), times_secs, positions_m: moved.positions_m };
    let report = SimReport {
        integrator: options.integrator(),
        order: options.integrator().order(),
        limit,
        dt_secs: timeline.dt_secs(),
        n_steps: timeline.n_steps() as u64,
        iterations_per_step: 1.0,
        slept_share: 0.0,
        unsettled_steps: 0,
        unsettled_m: 0.0,
        plan,
        max_stretch: max_stretch(&motion),
        assumed,
    };
    Ok(Simulation { motion, report })
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

/// Moves some strands, in ascending order, from the first frame to the last.
fn move_strands(
    strands: &mut [Prepared],
    some: &[usize],
    model: &PaperModel,
    timeline: &Timeline<'_>,
    groom: &Groom,
    progress: &dyn Progress,
) -> Vec<[f32; 3]> {
    let mut frames = Frames::new(groom, some, timeline.n_frames);
    let total = (some.len() * timeline.n_steps()) as u64;
    let done = AtomicU64::new(0);
    for first in (0..timeline.n_steps()).step_by(BLOCK_STEPS) {
        let steps = first..(first + BLOCK_STEPS).min(timeline.n_steps());
        let scenes: Vec<_> = steps.clone().map(|step| timeline.step_scene(step)).collect();
        let blocks: Vec<(usize, Vec<Vec<[f32; 3]>>)> = strands
            .par_iter_mut()
            .enumerate()
            .filter(|(s, _)| some.binary_search(s).is_ok())
            .map(|(s, strand)| {
                let frames = move_strand(strand, model, timeline, first, &scenes);
                let n = steps.len() as u64;
                progress.at(done.fetch_add(n, Ordering::Relaxed) + n, total);
                (s, frames)
            })
            .collect();
        let frame = first / timeline.steps_per_frame + 1;
        for (s, block) in blocks {
            for (k, points) in block.into_iter().enumerate() {
                frames.put(frame + k, &[s], &points);
            }
        }
    }
    frames.positions_m
}

/// Runs a strand through some steps. Out: its points, the root left out, in every frame that these complete.
fn move_strand(
    prepared: &mut Prepared,
    model: &PaperModel,
    timeline: &Timeline<'_>,
    first: usize,
    scenes: &[StepScene<'_>],
) -> Vec<Vec<[f32; 3]>> {
    let mut frames = Vec::new();
    for (k, scene) in scenes.iter().enumerate() {
        prepared.strand.step(model, scene);
        if (first + k + 1).is_multiple_of(timeline.steps_per_frame) {
            frames.push(prepared.strand.ends_m().iter().copied().map(single).collect());
        }
    }
    frames
}
