//! What is prepared before the first step, and what is said after the last.

use super::batch::{Batch, Count, Model};
use super::build::{Prepared, build, contact_stiffness};
use super::march::{March, order};
use super::stability::{Limit, limit};
use crate::assumptions::assumptions;
use crate::frames::max_stretch;
use crate::lane::{F64x1, Lane, Registers, WithLanes};
use crate::parts::{Part, run_parts};
use crate::plan::plan;
use crate::timeline::{Runs, Timeline};
use crate::touchable::{n_reaching, touchable, within_reach};
use crate::{Integrator, Keeper, Precision, SimError, SimOptions, SimReport, Simulation};
use core::fmt::Debug;
use rayon::prelude::*;
use std::sync::Arc;
use tousle_core::{
    Assumption, Attachment, Groom, NoProgress, Pose, Progress, Quantity, Strand, StrandMotion,
};
use tousle_field::{FieldLayer, FieldSequence, Reading, Sampler, Scene};
use tousle_rod::{DragLaw, Likely, Lock, Support, Surface, Touch, hold_rest, rest_state};

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
    law: DragLaw,
    prepared: Vec<Prepared>,
}

/// What layers on the field make of it.
struct Layered<'a> {
    timeline: Timeline<'a>,
    sampler: Sampler<'a>,
    reading: Reading,
    model: Model,
    /// The longest step of an explicit integrator.
    limit: Option<Limit>,
}

/// Some strands stopped at a frame, side by side. `None` of an integrator that moves strands one by one: nothing is kept,
/// they run again from the start.
#[derive(Clone, Debug)]
pub(crate) struct Held(Option<Arc<dyn SideBySide>>);

/// Batches, however many strands are side by side.
trait SideBySide: Debug + Send + Sync {
    fn n_lanes(&self) -> usize;

    /// [`March::go_on`].
    fn go_on(&self, march: &March<'_>, frames: (usize, usize)) -> Vec<[f32; 3]>;

    /// [`March::go_on_in_turn`].
    fn go_on_in_turn(
        &self,
        march: &March<'_>,
        n_variants: usize,
        frames: (usize, usize),
    ) -> Vec<Vec<[f32; 3]>>;
}

impl<L: Lane> SideBySide for Vec<Batch<L>> {
    fn n_lanes(&self) -> usize {
        L::N
    }

    fn go_on(&self, march: &March<'_>, frames: (usize, usize)) -> Vec<[f32; 3]> {
        march.go_on(self.clone(), frames)
    }

    fn go_on_in_turn(
        &self,
        march: &March<'_>,
        n_variants: usize,
        frames: (usize, usize),
    ) -> Vec<Vec<[f32; 3]>> {
        march.go_on_in_turn(&self[0], n_variants, frames)
    }
}

/// [`March::in_step`].
struct InStep<'a>(March<'a>);

impl WithLanes for InStep<'_> {
    type Output = Part;

    fn with<L: Lane>(self) -> Part {
        self.0.in_step::<L>()
    }
}

/// [`March::hold`].
struct Hold<'a>(March<'a>, usize);

impl WithLanes for Hold<'_> {
    type Output = Arc<dyn SideBySide>;

    fn with<L: Lane>(self) -> Arc<dyn SideBySide> {
        Arc::new(self.0.hold::<L>(self.1))
    }
}

impl<'a> Ready<'a> {
    pub fn new(
        field: &'a FieldSequence,
        scene: &'a Scene,
        groom: &'a Groom,
        options: &'a SimOptions,
    ) -> Result<Self, SimError> {
        let mut timeline = Timeline::new(field, scene, options, groom.n_points())?;
        let law = DragLaw::in_air(scene.air_density);
        let locks: Vec<Lock> = groom.strands.iter().map(Lock::new).collect();
        let touch = Touch::by_rest(&locks, &scene.body);
        let prepared = prepare(scene, &timeline, groom, locks, touch);
        let in_head = solids(scene);
        let sampler = Sampler::new(field, |p| in_head.iter().any(|s| s.gap(p).distance_m < 0.0));
        let sampler = within_reach(sampler, prepared.iter().map(|p| &p.lock));
        timeline.cut(options.dt_secs.unwrap_or(SimOptions::DEFAULT_DT_SECS))?;
        let registers = Registers::widest();
        Ok(Self { field, scene, groom, options, registers, timeline, sampler, law, prepared })
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
        let all: Vec<usize> = (0..self.prepared.len()).collect();
        let spans = (timeline.n_frames, timeline.n_steps());
        let order = order(&self.prepared, &all);
        let moved = run_parts(self.groom, &order, spans, keeper, progress, |strands, progress| {
            self.move_strands(&layered, strands, progress)
        })?;
        let (counts, times_secs) = (self.groom.counts(), self.times_secs());
        let motion = StrandMotion { counts, times_secs, positions_m: moved.positions_m };
        if layered.limit.is_some() {
            self.check_whole(&motion, timeline.dt_secs())?;
        }
        let report = self.report(&layered, &motion, &moved.count);
        Ok(Simulation { motion, report })
    }

    /// Refuses a motion of which a point is nowhere.
    fn check_whole(&self, motion: &StrandMotion, dt_secs: f64) -> Result<(), SimError> {
        let is_nowhere = |point: &[f32; 3]| point.iter().any(|c| !c.is_finite());
        let Some(at) = motion.positions_m.iter().position(is_nowhere) else { return Ok(()) };
        let (frame, mut point) = (at / motion.n_points(), at % motion.n_points());
        let mut strand_idx = 0;
        while point >= motion.counts[strand_idx] {
            point -= motion.counts[strand_idx];
            strand_idx += 1;
        }
        Err(SimError::BlewUp {
            integrator: self.options.integrator().name(),
            strand: self.groom.strands[strand_idx].name.clone(),
            secs: motion.times_secs[frame],
            dt_secs,
        })
    }

    /// Time of every frame, s.
    pub fn times_secs(&self) -> Vec<f64> {
        (0..self.timeline.n_frames).map(|frame| self.timeline.frame_secs(frame)).collect()
    }

    /// Some strands, in ascending order, from the first frame to the last.
    pub fn run_some(&self, layers: &[FieldLayer], strands: &[usize]) -> Result<Vec<[f32; 3]>, SimError> {
        Ok(self.move_strands(&self.layered(layers, Runs::Again)?, strands, &NoProgress).positions_m)
    }

    /// Some strands, in ascending order, moved to a frame.
    pub fn hold(&self, layers: &[FieldLayer], strands: &[usize], frame: usize) -> Result<Held, SimError> {
        let layered = self.layered(layers, Runs::Again)?;
        let march = self.march(&layered, strands, &NoProgress);
        let is_in_step = self.options.integrator().is_in_step();
        let hold = || self.registers.with_lanes(self.options.precision, Hold(march, frame));
        Ok(Held(is_in_step.then(hold)))
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
        let march = self.march(&layered, strands, &NoProgress);
        Ok(match &held.0 {
            Some(batches) => batches.go_on(&march, frames),
            None => cut(&self.move_strands(&layered, strands, &NoProgress).positions_m, frames, &layered),
        })
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
        let n_at_once = held.0.as_ref().map_or(1, |batches| batches.n_lanes());
        let some: Vec<_> = variants
            .par_chunks(n_at_once)
            .map(|variants| {
                let all = [&[layers], variants].concat().concat();
                let layered = self.layered(&all, Runs::Again)?;
                // One a lane: where there are fewer variants, the last one runs again and is not read.
                let lanes: Vec<_> = (0..n_at_once).map(|k| variants[k.min(variants.len() - 1)]).collect();
                let sampler = self.sampler.with_variants(layers, &lanes);
                let march = March { sampler: &sampler, ..self.march(&layered, &[], &NoProgress) };
                Ok(match &held.0 {
                    Some(batches) => batches.go_on_in_turn(&march, variants.len(), frames),
                    None => {
                        let part = self.move_strands(&layered, &[strand], &NoProgress);
                        vec![cut(&part.positions_m, frames, &layered)]
                    }
                })
            })
            .collect::<Result<_, SimError>>()?;
        Ok(some.concat())
    }

    fn layered<'b>(&self, layers: &'b [FieldLayer], runs: Runs) -> Result<Layered<'b>, SimError>
    where
        'a: 'b,
    {
        let (options, integrator) = (self.options, self.options.integrator());
        let mut timeline: Timeline<'b> = self.timeline.with_layers(layers);
        let limit = explicit_limit(&timeline, self.field, &self.prepared, &self.law, integrator);
        if let Some(limit) = &limit {
            timeline.cut(options.dt_secs.unwrap_or(f64::min(SimOptions::DEFAULT_DT_SECS, limit.dt_secs)))?;
            if timeline.dt_secs() > limit.dt_secs {
                return Err(SimError::Unstable {
                    integrator: integrator.name(),
                    dt_secs: timeline.dt_secs(),
                    limit_secs: limit.dt_secs,
                    strand: self.groom.strands[limit.strand_idx].name.clone(),
                    point: None,
                });
            }
        }
        let terms = timeline.terms;
        let is_force = terms.quantity == Quantity::ForcePerMass;
        let model = Model {
            along: core::f64::consts::PI * DragLaw::ALONG,
            air: terms.air,
            pushes: terms.wind && is_force && !terms.air,
            force_law: (is_force && terms.air).then_some(self.law),
            friction: self.scene.body.friction,
            resolution_m: if options.precision == Precision::Single { 5e-7 } else { 0.0 },
        };
        let reading = timeline.reading(self.groom.n_points(), runs);
        Ok(Layered { timeline, sampler: self.sampler.with_layers(layers), reading, model, limit })
    }

    fn march<'b>(
        &'b self,
        layered: &'b Layered<'b>,
        strands: &'b [usize],
        progress: &'b dyn Progress,
    ) -> March<'b> {
        March {
            timeline: &layered.timeline,
            sampler: &layered.sampler,
            reading: layered.reading,
            model: layered.model,
            integrator: self.options.integrator(),
            tolerance_m: self.options.tolerance_m,
            groom: self.groom,
            strands,
            prepared: &self.prepared,
            law: self.law,
            progress,
        }
    }

    fn move_strands(&self, layered: &Layered<'_>, strands: &[usize], progress: &dyn Progress) -> Part {
        let march = self.march(layered, strands, progress);
        match self.options.integrator() {
            Integrator::Adaptive => march.adaptive(),
            Integrator::SemiImplicit | Integrator::Rk4 => march.explicit(),
            _ => self.registers.with_lanes(self.options.precision, InStep(march)),
        }
    }

    fn report(&self, layered: &Layered<'_>, motion: &StrandMotion, count: &Count) -> SimReport {
        let Layered { timeline, limit, .. } = layered;
        let name = |strand_idx: &usize| &self.groom.strands[*strand_idx].name;
        let limp = limit.as_ref().and_then(|limit| limit.limp_idx.as_ref()).map(name);
        let limit = match limit {
            Some(Limit { dt_secs, strand_idx, .. }) => {
                format!("{dt_secs:.3e} s, set by strand {}", name(strand_idx))
            }
            None => "none: no step is too long or too stiff".to_owned(),
        };
        let mut assumed = assumptions(self.groom, timeline, self.prepared.iter().map(Prepared::deepest_m));
        assumed.extend(held_styles(&self.prepared));
        assumed.extend(limp.map(|strand| stays_whole(self.options.integrator(), strand, timeline.dt_secs())));
        let n_reaching = n_reaching(self.scene, self.prepared.iter().map(|p| &p.reaches[..]));
        let integrator = self.options.integrator();
        SimReport {
            integrator,
            order: integrator.order(),
            limit,
            dt_secs: timeline.dt_secs(),
            n_steps: count.steps,
            iterations_per_step: count.iterations as f64 / (count.steps - count.slept).max(1) as f64,
            slept_share: count.slept as f64 / count.steps.max(1) as f64,
            unsettled_steps: count.unsettled,
            unsettled_m: count.unsettled_m,
            plan: plan(&layered.sampler, self.scene, timeline, &n_reaching),
            max_stretch: max_stretch(motion),
            assumed,
        }
    }
}

/// Some frames of positions of all frames, both included.
fn cut(positions_m: &[[f32; 3]], frames: (usize, usize), layered: &Layered<'_>) -> Vec<[f32; 3]> {
    let n_points = positions_m.len() / layered.timeline.n_frames;
    positions_m[frames.0 * n_points..(frames.1 + 1) * n_points].to_vec()
}

/// The head's own shapes: no air is in them.
fn solids(scene: &Scene) -> Vec<Surface> {
    let of_head = scene.body.colliders.iter().filter(|c| c.attachment == Attachment::Head);
    of_head.map(|c| Surface::new(&c.shape)).collect()
}

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
        let likely = Likely::hair(&lock, &scene.body);
        let likely = Likely { touch: touch.unwrap_or(likely.touch), ..likely };
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

/// What was assumed of hair that may crack like a whip.
fn stays_whole(integrator: Integrator, strand: &str, dt_secs: f64) -> Assumption {
    Assumption {
        what: format!("stability of {}", integrator.name()),
        value: format!("steps of {dt_secs:.3e} s hold"),
        why: format!(
            "{strand} is limp: when it cracks like a whip no explicit step is sure to be short enough"
        ),
    }
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
    let strongest = crate::stability::strongest_vector(field, timeline.layers());
    let mut work = Vec::new();
    let limits = prepared.iter().enumerate().map(|(k, p)| {
        let batch: Batch<F64x1> = build(&[(k, p)], law, timeline.body().colliders.len());
        batch.make_room(&mut work);
        let lock = &p.lock;
        let per_mass = |(w, d): (&f64, &f64)| law.across(*w, strongest) * strongest / d;
        let air = lock.widths_m.iter().zip(&lock.linear_densities_kg_per_m).map(per_mass).fold(0.0, f64::max);
        let pull = head.acceleration + head.per_meter * (lock.root_m.norm() + lock.reach_m()) + air;
        limit(&batch, &mut work, integrator == Integrator::Rk4, pull)
    });
    limits.reduce(Limit::and)
}
