//! The loop over steps and strands, and what is reported of it.

use crate::frames::{max_stretch, single};
use crate::paper::{PaperModel, PaperStrand, Touchable};
use crate::plan::plan;
use crate::stability::limit;
use crate::timeline::{StepScene, Timeline};
use crate::{SimError, SimOptions, SimReport, Simulation};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use tousle_core::{Assumption, Attachment, Groom, Pose, Progress, StrandMotion, Vec3};
use tousle_field::{FieldSequence, Scene};
use tousle_rod::{DragLaw, Likely, Lock, Rest, Surface, Twist, rest_state};

/// Steps that a strand runs before the next one's turn: enough to spread the cost of preparing what the world
/// does, few enough that it is prepared in little memory and progress is seen.
const BLOCK_STEPS: usize = 32;

/// A strand on its way, its rest curve and how it hangs there.
struct Prepared<'a> {
    strand: PaperStrand,
    rest_curve_m: &'a [Vec3],
    touchable: Vec<Touchable>,
    /// Deepest that its rest curve lies in the body, m.
    deepest_m: f64,
}

pub(crate) fn run(
    field: &FieldSequence,
    scene: &Scene,
    groom: &Groom,
    options: &SimOptions,
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
    let n_reaching = n_reaching(scene, &strands);
    let plan = plan(field, scene, &timeline, &n_reaching);
    let assumed = assumptions(groom, &timeline, strands.iter().map(|s| s.deepest_m));
    let motion = move_strands(&mut strands, &model, &timeline, groom.counts(), progress);
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

fn prepare<'a>(scene: &Scene, groom: &'a Groom, timeline: &Timeline<'_>) -> Vec<Prepared<'a>> {
    let gravity = timeline.gravity_at_rest();
    let surfaces = Surface::of_body(&scene.body, &Pose::identity());
    let prepare = |strand: &'a tousle_core::Strand| {
        let lock = Lock::new(strand);
        let rest = rest_state(&lock, gravity, &scene.body, &Likely::smooth(&lock, Twist::Free));
        let touchable = touchable(scene, timeline, &surfaces, &lock, &rest);
        let deepest_m = -rest.clearances_m.iter().copied().fold(0.0, f64::min);
        let strand_in_motion = PaperStrand::new(lock, &rest, &touchable);
        Prepared { strand: strand_in_motion, rest_curve_m: &strand.rest_curve_m, touchable, deepest_m }
    };
    groom.strands.par_iter().map(prepare).collect()
}

/// The colliders that a strand can reach. The torso's, once the head turns, may come to it.
pub(crate) fn touchable(
    scene: &Scene,
    timeline: &Timeline<'_>,
    surfaces: &[Surface],
    lock: &Lock,
    rest: &Rest,
) -> Vec<Touchable> {
    let n = lock.n_sticks();
    let nearest =
        |collider: usize| rest.clearances_m[collider * n..][..n].iter().copied().fold(0.0, f64::max);
    (0..surfaces.len())
        .map(|collider| Touchable {
            collider,
            on_torso: scene.body.colliders[collider].attachment == Attachment::Torso,
        })
        .filter(|t| {
            let comes = t.on_torso && timeline.terms.head_movement;
            // An ellipsoid's distance is of first order: it may say up to twice too much.
            let distance = 0.5 * surfaces[t.collider].gap(lock.root_m).distance_m;
            comes || distance <= lock.reach_m() + nearest(t.collider)
        })
        .collect()
}

fn n_reaching(scene: &Scene, strands: &[Prepared<'_>]) -> Vec<usize> {
    let reaches = |s: &Prepared<'_>, collider: usize| s.touchable.iter().any(|t| t.collider == collider);
    (0..scene.body.colliders.len()).map(|c| strands.iter().filter(|s| reaches(s, c)).count()).collect()
}

fn move_strands(
    strands: &mut [Prepared<'_>],
    model: &PaperModel,
    timeline: &Timeline<'_>,
    counts: Vec<usize>,
    progress: &dyn Progress,
) -> StrandMotion {
    let rest_frame = strands.iter().flat_map(|s| s.rest_curve_m).copied().map(single);
    let mut positions_m: Vec<[f32; 3]> = rest_frame.collect();
    let total = (strands.len() * timeline.n_steps()) as u64;
    let done = AtomicU64::new(0);
    for first in (0..timeline.n_steps()).step_by(BLOCK_STEPS) {
        let steps = first..(first + BLOCK_STEPS).min(timeline.n_steps());
        let scenes: Vec<_> = steps.clone().map(|step| timeline.step_scene(step)).collect();
        let blocks: Vec<Vec<[f32; 3]>> = strands
            .par_iter_mut()
            .map(|strand| {
                let frames = move_strand(strand, model, timeline, first, &scenes);
                let n = steps.len() as u64;
                progress.at(done.fetch_add(n, Ordering::Relaxed) + n, total);
                frames
            })
            .collect();
        let n_frames = steps.end / timeline.steps_per_frame - first / timeline.steps_per_frame;
        for frame in 0..n_frames {
            for (block, n) in blocks.iter().zip(&counts) {
                positions_m.extend_from_slice(&block[frame * n..(frame + 1) * n]);
            }
        }
    }
    let times_secs = (0..timeline.n_frames).map(|frame| timeline.frame_secs(frame)).collect();
    StrandMotion { counts, times_secs, positions_m }
}

/// Runs a strand through some steps. Out: its points in every frame that these complete.
fn move_strand(
    prepared: &mut Prepared<'_>,
    model: &PaperModel,
    timeline: &Timeline<'_>,
    first: usize,
    scenes: &[StepScene<'_>],
) -> Vec<[f32; 3]> {
    let mut frames = Vec::new();
    for (k, scene) in scenes.iter().enumerate() {
        prepared.strand.step(model, scene);
        if (first + k + 1).is_multiple_of(timeline.steps_per_frame) {
            frames.push(single(prepared.rest_curve_m[0]));
            frames.extend(prepared.strand.ends_m().iter().copied().map(single));
        }
    }
    frames
}

/// What the groom's reader assumed, and what this run did.
pub(crate) fn assumptions(
    groom: &Groom,
    timeline: &Timeline<'_>,
    deepest_m: impl Iterator<Item = f64>,
) -> Vec<Assumption> {
    let mut assumed = groom.assumed.clone();
    if timeline.has_shot_head() {
        assumed.push(Assumption {
            what: "torso".to_owned(),
            value: "faces where the head faces in the shot's first pose".to_owned(),
            why: "a pose track says nothing of the shoulders".to_owned(),
        });
    }
    let tilt = timeline.tilt_at_start();
    if tilt > 1e-3 {
        assumed.push(Assumption {
            what: "start".to_owned(),
            value: format!("from the rest curves, with the head tilted by {:.1}°", tilt.to_degrees()),
            why: "the groom says how it hangs in the rest pose only; it settles in the first second"
                .to_owned(),
        });
    }
    let inside: Vec<f64> = deepest_m.filter(|deepest| *deepest > 0.0).collect();
    let deepest_mm = 1e3 * inside.iter().copied().fold(0.0, f64::max);
    if deepest_mm > 0.0 {
        let n = inside.len();
        assumed.push(Assumption {
            what: format!("collision of {n} strands"),
            value: format!("allowed as deep as they rest, up to {deepest_mm:.1} mm"),
            why: "their rest curves lie inside the body, and pushing them out would make them jump"
                .to_owned(),
        });
    }
    assumed
}
