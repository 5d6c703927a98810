//! What is prepared before the first step, and what is said after the last.

use super::batch::{Batch, Model};
use super::build::{Prepared, build, contact_stiffness};
use super::march::{March, order};
use super::stability::{Limit, limit};
use crate::assumptions::assumptions;
use crate::frames::max_stretch;
use crate::lane::{Wide1, Wide4, Wide8};
use crate::parts::run_parts;
use crate::plan::plan;
use crate::timeline::Timeline;
use crate::touchable::{n_reaching, touchable};
use crate::{Integrator, Keeper, Precision, SimError, SimOptions, SimReport, Simulation};
use rayon::prelude::*;
use tousle_core::{Assumption, Attachment, Groom, Pose, Progress, Quantity, Strand, StrandMotion};
use tousle_field::{FieldSequence, Sampler, Scene};
use tousle_rod::{DragLaw, Likely, Lock, Support, Surface, Touch, Twist, hold_rest, rest_state};

pub(crate) fn run(
    field: &FieldSequence,
    scene: &Scene,
    groom: &Groom,
    options: &SimOptions,
    keeper: Option<&dyn Keeper>,
    progress: &dyn Progress,
) -> Result<Simulation, SimError> {
    let integrator = options.integrator();
    let mut timeline = Timeline::new(field, scene, options, groom.n_points())?;
    let law = DragLaw::in_air(scene.air_density);
    let locks: Vec<Lock> = groom.strands.iter().map(Lock::new).collect();
    let touch = Touch::by_rest(&locks, &scene.body);
    let prepared = prepare(scene, &timeline, groom, locks, touch);
    let in_head = solids(scene);
    let sampler = Sampler::new(field, |p| in_head.iter().any(|s| s.gap(p).distance_m < 0.0));
    timeline.cut(options.dt_secs.unwrap_or(SimOptions::DEFAULT_DT_SECS))?;
    let limit = explicit_limit(&timeline, field, &prepared, &law, integrator);
    if let Some(limit) = limit {
        timeline.cut(options.dt_secs.unwrap_or(f64::min(SimOptions::DEFAULT_DT_SECS, limit.dt_secs)))?;
        if timeline.dt_secs() > limit.dt_secs {
            return Err(SimError::Unstable {
                integrator: integrator.name(),
                dt_secs: timeline.dt_secs(),
                limit_secs: limit.dt_secs,
                strand: groom.strands[limit.strand_idx].name.clone(),
                point: None,
            });
        }
    }
    let is_force = timeline.terms.quantity == Quantity::ForcePerMass;
    let model = Model {
        along: core::f64::consts::PI * DragLaw::ALONG,
        air: timeline.terms.air,
        pushes: timeline.terms.wind && is_force && !timeline.terms.air,
        force_law: (is_force && timeline.terms.air).then_some(law),
        friction: scene.body.friction,
        resolution_m: if options.precision == Precision::Single { 5e-7 } else { 0.0 },
    };
    let all: Vec<usize> = (0..prepared.len()).collect();
    let spans = (timeline.n_frames, timeline.n_steps());
    let order = order(&prepared, &all);
    let moved = run_parts(groom, &order, spans, keeper, progress, |strands, progress| {
        let march = March {
            timeline: &timeline,
            sampler: &sampler,
            model,
            integrator,
            tolerance_m: options.tolerance_m,
            groom,
            strands,
            prepared: &prepared,
            law,
            progress,
        };
        match (integrator, options.precision) {
            (Integrator::Adaptive, _) => march.adaptive(),
            (Integrator::SemiImplicit | Integrator::Rk4, _) => march.explicit(),
            (_, Precision::Double) => march.in_step::<Wide4>(),
            (_, Precision::Single) => march.in_step::<Wide8>(),
        }
    })?;
    let n_reaching = n_reaching(scene, prepared.iter().map(|p| &p.reaches[..]));
    let times_secs = (0..timeline.n_frames).map(|frame| timeline.frame_secs(frame)).collect();
    let motion = StrandMotion { counts: groom.counts(), times_secs, positions_m: moved.positions_m };
    let limit_words = match limit {
        Some(limit) => {
            format!("{:.3e} s, set by strand {}", limit.dt_secs, groom.strands[limit.strand_idx].name)
        }
        None => "none: no step is too long or too stiff".to_owned(),
    };
    let mut assumed = assumptions(groom, &timeline, prepared.iter().map(Prepared::deepest_m));
    assumed.extend(held_styles(&prepared));
    let report = SimReport {
        integrator,
        order: integrator.order(),
        limit: limit_words,
        dt_secs: timeline.dt_secs(),
        n_steps: moved.count.steps,
        iterations_per_step: moved.count.iterations as f64
            / (moved.count.steps - moved.count.slept).max(1) as f64,
        slept_share: moved.count.slept as f64 / moved.count.steps.max(1) as f64,
        unsettled_steps: moved.count.unsettled,
        unsettled_m: moved.count.unsettled_m,
        plan: plan(field, scene, &timeline, &n_reaching),
        max_stretch: max_stretch(&motion),
        assumed,
    };
    Ok(Simulation { motion, report })
}

/// The head's own shapes: no air is in them.
fn solids(scene: &Scene) -> Vec<Surface> {
    let of_head = scene.body.colliders.iter().filter(|c| c.attachment == Attachment::Head);
    of_head.map(|c| Surface::new(&c.shape)).collect()
}

/// Of what a rest curve leaves open: a natural shape without bends is as likely as joints without load. On the
/// development captures anything from 0.3 to 0.7 scores alike, and better than 0 or 1.
const STRAIGHTNESS: f64 = 0.5;

fn prepare(
    scene: &Scene,
    timeline: &Timeline<'_>,
    groom: &Groom,
    locks: Vec<Lock>,
    touch: Option<Touch>,
) -> Vec<Prepared> {
    let gravity = timeline.gravity_at_rest();
    let surfaces = Surface::of_body(&scene.body, &Pose::identity());
    let prepare = |(mut lock, strand): (Lock, &Strand)| {
        let likely = Likely {
            twist: Twist::Held,
            touch: touch.unwrap_or_else(|| Touch::by_width(&lock)),
            friction: scene.body.friction,
            straightness: STRAIGHTNESS,
        };
        let rest = rest_state(&lock, gravity, &scene.body, &likely);
        let stiffened = if strand.holds_style {
            let support = Support { surfaces: &surfaces, stiffness: contact_stiffness(&lock) };
            hold_rest(&mut lock, &rest, gravity, &support)
        } else {
            1.0
        };
        let reaches = touchable(scene, timeline, &surfaces, &lock, &rest);
        Prepared::new(lock, rest, reaches, stiffened)
    };
    locks.into_par_iter().zip(&groom.strands).map(prepare).collect()
}

/// What was assumed so that styles stay up.
fn held_styles(prepared: &[Prepared]) -> Option<Assumption> {
    let mut stiffened: Vec<f64> = prepared.iter().map(|p| p.stiffened).filter(|times| *times > 1.0).collect();
    stiffened.sort_by(f64::total_cmp);
    let (n, most) = (stiffened.len(), *stiffened.last()?);
    Some(Assumption {
        what: format!("bending stiffness of {n} of {} strands, where they lean out", prepared.len()),
        value: format!(
            "up to {:.0} times that of their hairs in the median strand, {most:.0} in any",
            stiffened[n / 2]
        ),
        why: "their style would fall by itself: in life it rests on neighbors, which are not felt here"
            .to_owned(),
    })
}

/// The longest step of an explicit integrator; `None` for the others.
fn explicit_limit(
    timeline: &Timeline<'_>,
    field: &FieldSequence,
    prepared: &[Prepared],
    law: &DragLaw,
    integrator: Integrator,
) -> Option<Limit> {
    if !integrator.is_limited() {
        return None;
    }
    let head = timeline.strongest_pull();
    let strongest = crate::stability::strongest_vector(field);
    let mut work = Vec::new();
    let limits = prepared.iter().enumerate().map(|(k, p)| {
        let batch: Batch<Wide1> = build(&[(k, p)], law, timeline.body().colliders.len());
        batch.make_room(&mut work);
        let lock = &p.lock;
        let per_mass = |(w, d): (&f64, &f64)| law.across(*w, strongest) * strongest / d;
        let air = lock.widths_m.iter().zip(&lock.linear_densities_kg_per_m).map(per_mass).fold(0.0, f64::max);
        let pull = head.acceleration + head.per_meter * (lock.root_m.norm() + lock.reach_m()) + air;
        limit(&batch, &mut work, integrator == Integrator::Rk4, pull)
    });
    limits.min_by(|a, b| a.dt_secs.total_cmp(&b.dt_secs))
}
