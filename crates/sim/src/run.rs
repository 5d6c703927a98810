use crate::paper::{PaperModel, PaperStrand, Touchable};
use crate::plan::Terms;
use crate::timeline::{StepScene, Timeline};
use crate::{SimError, SimOptions, SimReport, Simulation};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use tousle_core::{Groom, Progress, StrandMotion, Vec3};
use tousle_field::{FieldSequence, Scene};
use tousle_rod::{DragLaw, Lock, rest_state};

/// Frames that a strand runs through before the next strand's turn: enough to spread the cost of preparing a
/// step's scene, few enough that progress is seen and the scenes stay in cache.
const BLOCK_FRAMES: usize = 8;

pub(crate) fn run(
    field: &FieldSequence,
    scene: &Scene,
    groom: &Groom,
    options: &SimOptions,
    progress: &dyn Progress,
) -> Result<Simulation, SimError> {
    let dt_secs = options.dt_secs.unwrap_or(1.0 / 240.0);
    let timeline = Timeline::new(field, scene, options, dt_secs, groom.n_points())?;
    let model = PaperModel {
        integrator: options.integrator,
        terms: Terms { quantity: field.quantity, head_movement: !timeline.head_is_still() },
        drag: DragLaw::in_air(scene.air_density),
    };
    let gravity = timeline.gravity_at_rest();
    let mut strands: Vec<PaperStrand> = groom
        .strands
        .par_iter()
        .map(|strand| {
            let lock = Lock::new(strand);
            let rest = rest_state(&lock, gravity, &scene.body);
            let touchable: Vec<Touchable> =
                (0..scene.body.colliders.len()).map(|collider| Touchable { collider }).collect();
            PaperStrand::new(lock, &rest, &touchable)
        })
        .collect();
    let n_points = groom.n_points();
    let mut positions_m = Vec::with_capacity(n_points * timeline.n_frames);
    positions_m.extend(
        groom.strands.iter().flat_map(|s| &s.rest_curve_m).map(|p| <[f32; 3]>::from(p.map(|c| c as f32))),
    );
    let done = AtomicU64::new(0);
    let total = (strands.len() * (timeline.n_frames - 1)) as u64;
    let mut frame = 0;
    while frame + 1 < timeline.n_frames {
        let n = BLOCK_FRAMES.min(timeline.n_frames - 1 - frame);
        let scenes: Vec<StepScene<'_>> = (0..n * timeline.steps_per_frame)
            .map(|k| timeline.step_scene(frame + k / timeline.steps_per_frame, k % timeline.steps_per_frame))
            .collect();
        let blocks: Vec<Vec<[f32; 3]>> = strands
            .par_iter_mut()
            .zip(&groom.strands)
            .map(|(strand, rest)| {
                let mut out = Vec::with_capacity(n * rest.rest_curve_m.len());
                let mut ends = vec![Vec3::zeros(); rest.rest_curve_m.len() - 1];
                for steps in scenes.chunks(timeline.steps_per_frame) {
                    for step in steps {
                        strand.step(&model, step);
                    }
                    strand.place(&mut ends);
                    out.push(rest.rest_curve_m[0].map(|c| c as f32).into());
                    out.extend(ends.iter().map(|p| <[f32; 3]>::from(p.map(|c| c as f32))));
                }
                progress.at(done.fetch_add(n as u64, Ordering::Relaxed) + n as u64, total);
                out
            })
            .collect();
        for k in 0..n {
            for (block, strand) in blocks.iter().zip(&groom.strands) {
                let p = strand.rest_curve_m.len();
                positions_m.extend_from_slice(&block[k * p..(k + 1) * p]);
            }
        }
        frame += n;
    }
    let motion = StrandMotion {
        counts: groom.counts(),
        times_secs: (0..timeline.n_frames).map(|f| timeline.frame_secs(f)).collect(),
        positions_m,
    };
    let report = SimReport {
        integrator: options.integrator,
        order: options.integrator.order(),
        limit: options.integrator.limit().to_owned(),
        dt_secs: timeline.dt_secs,
        n_steps: ((timeline.n_frames - 1) * timeline.steps_per_frame) as u64,
        plan: Vec::new(),
        max_stretch: 0.0,
        assumed: groom.assumed.clone(),
    };
    let _ = timeline.tilt_at_start();
    Ok(Simulation { motion, report })
}
