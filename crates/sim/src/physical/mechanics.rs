//! The method `physical` as a run asks for it.

use super::adaptive::{Pace, Precise};
use super::batch::{Batch, Model};
use super::build::{Prepared, Shape, build, contact_stiffness};
use super::explicit::Swing;
use super::implicit::Formula;
use super::link::Work;
use super::scene::{Carry, Now, at_end_of_step};
use super::stability;
use crate::extent::Extent;
use crate::mechanics::{Mechanics, Setting};
use crate::parts::Count;
use crate::stability::Limit;
use crate::timeline::Timeline;
use crate::touchable::touchable;
use crate::{Integrator, Precision, SimOptions};
use rayon::prelude::*;
use tousle_core::{Assumption, Attachment, Groom, HeadMotion, Pose, Quantity, Strand, Vec3};
use tousle_field::{Reading, Sampler, Scene};
use tousle_lanes::{Lane, Registers, Vector};
use tousle_rod::{DragLaw, Lock, Natural, Style, Support, Surface, hold_rest, rest_state};

/// What all strands of a run share, and how they are stepped.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Physical {
    model: Model,
    integrator: Integrator,
    formula: Formula,
    /// Of [`Integrator::Adaptive`].
    precise: Precise,
    law: DragLaw,
    /// Whether the hair hangs at the start as it does at rest. A head that is held otherwise sets it going.
    hangs_still: bool,
    /// The head at the start, along with which the hair then goes; `None` if it never moves.
    head: Option<HeadMotion>,
}

/// What the world does in a step.
pub(crate) enum World<'a> {
    /// At its end, and on the way there; and the formula that it is taken by.
    Implicit { now: Now<'a>, carry: Option<Carry>, formula: Formula },
    /// At its start.
    SemiImplicit(Now<'a>),
    /// At its start, middle and end.
    Rk4(Box<[Now<'a>; 3]>),
    /// At all times; and from when to when the frame is that the step completes, if it does: strands that choose their
    /// own steps go through all of it then.
    Adaptive(&'a Timeline<'a>, &'a Sampler<'a>, Option<(f64, f64)>),
}

/// Strands, and what their integrator knows of them beside their states.
#[derive(Clone, Debug)]
pub(crate) struct Moving<L> {
    strands: Batch<L>,
    /// Of the explicit integrators only.
    swing: Swing<L>,
    /// Of the adaptive one only.
    pace: Pace,
}

impl Mechanics for Physical {
    type Shape = Shape;
    type Batch<L: Lane> = Moving<L>;
    type Work<L: Lane> = Work<L>;
    type World<'a> = World<'a>;

    /// At its own pace a strand can only be stepped alone; and explicit integrators do not stand the sticks without mass
    /// that follow a shorter strand's tip.
    fn lanes(options: &SimOptions) -> (Registers, Precision) {
        if options.has_single() {
            (Registers::widest(), options.precision)
        } else {
            (Registers::Scalar, Precision::Double)
        }
    }

    /// What an iteration leaves over in single precision, half a micrometer, acts like an acceleration of it over the square
    /// of the step: here a hundredth of gravity.
    const SHORTEST_SINGLE_SECS: f64 = 1.0 / 480.0;

    /// In the head's own shapes.
    fn is_solid(scene: &Scene) -> impl Fn(Vec3) -> bool {
        let of_head = scene.body.colliders.iter().filter(|c| c.attachment == Attachment::Head);
        let solids: Vec<Surface> = of_head.map(|c| Surface::new(&c.shape)).collect();
        move |point_m| solids.iter().any(|s| s.gap(point_m).distance_m < 0.0)
    }

    fn prepare(setting: &Setting<'_>, timeline: &Timeline<'_>) -> Vec<Prepared> {
        let Setting { scene, groom, whole, options, .. } = setting;
        let (gravity, law) = (timeline.gravity_at_rest(), setting.law());
        let locks_of = |groom: &Groom| -> Vec<Lock> { groom.strands.par_iter().map(Lock::new).collect() };
        let style_of = |locks: &[Lock], all: &Groom| {
            Style::of(locks, |i| !all.strands[i].holds_style, gravity, &scene.body)
        };
        let locks = locks_of(groom);
        let style = whole.map_or_else(|| style_of(&locks, groom), |whole| style_of(&locks_of(whole), whole));
        let surfaces = Surface::of_body(&scene.body, &Pose::identity());
        let prepare = |(mut lock, strand): (Lock, &Strand)| {
            let rest = rest_state(&lock, gravity, &scene.body, &style.likely(&lock, &scene.body));
            let stiffened = if strand.holds_style {
                let support = Support { surfaces: &surfaces, stiffness: contact_stiffness(&lock) };
                hold_rest(&mut lock, &rest, gravity, &support)
            } else {
                1.0
            };
            let touchable = touchable(scene, timeline, &surfaces, &lock, &rest);
            let shape = Shape::new(&lock, &rest, stiffened);
            let mut prepared = Prepared { lock, rest, touchable, shape };
            if options.integrator().is_limited() {
                prepared.shape.stiffest = stability::stiffest(&prepared, &law);
            }
            prepared
        };
        locks.into_par_iter().zip(&groom.strands).map(prepare).collect()
    }

    fn limit(setting: &Setting<'_>, timeline: &Timeline<'_>, strands: &[Prepared]) -> Option<Limit> {
        stability::limit(setting, timeline, strands)
    }

    fn new(setting: &Setting<'_>, timeline: &Timeline<'_>) -> Self {
        let Setting { scene, options, .. } = setting;
        let (terms, law, dt_secs) = (timeline.terms, setting.law(), timeline.dt_secs());
        let is_force = terms.quantity == Quantity::ForcePerMass;
        let model = Model {
            along: core::f64::consts::PI * DragLaw::ALONG,
            air: terms.air,
            pushes: terms.wind && is_force && !terms.air,
            force_law: (is_force && terms.air).then_some(law),
            friction: scene.body.friction,
            resolution_m: if options.precision == Precision::Single { 5e-7 } else { 1e-14 },
        };
        let integrator = options.integrator();
        let formula = match integrator {
            Integrator::ImplicitEuler => Formula::euler(dt_secs),
            _ => Formula::bdf2(dt_secs, dt_secs),
        };
        let head = timeline.head_at(timeline.step_secs(0));
        Self {
            model,
            integrator,
            formula,
            precise: Precise::of(options),
            law,
            hangs_still: timeline.tilt_at_start() == 0.0,
            head: terms.head_movement.then_some(head),
        }
    }

    fn batch<L: Lane>(&self, strands: &[&Prepared]) -> Moving<L> {
        let mut strands = Batch { at_rest: self.hangs_still, ..build(strands, &self.law) };
        if let Some(head) = &self.head {
            strands.go_along(head);
        }
        let spin = self.head.map_or_else(Vec3::zeros, |head| head.angular_velocity);
        let swing = match self.integrator {
            Integrator::SemiImplicit | Integrator::Rk4 => Swing::at_rest(&strands, spin),
            _ => Swing::none(),
        };
        Moving { strands, swing, pace: Pace::new() }
    }

    fn world<'a>(
        &self,
        timeline: &'a Timeline<'a>,
        sampler: &'a Sampler<'a>,
        reading: Reading,
        step: usize,
    ) -> World<'a> {
        let begin = timeline.step_secs(step);
        let at = |secs: f64| Now::new(timeline, sampler, secs, reading);
        match self.integrator {
            Integrator::Adaptive => {
                let (frame, steps) = (step / timeline.steps_per_frame, step + 1);
                let span = || (timeline.frame_secs(frame), timeline.frame_secs(frame + 1));
                World::Adaptive(timeline, sampler, steps.is_multiple_of(timeline.steps_per_frame).then(span))
            }
            Integrator::SemiImplicit => World::SemiImplicit(at(begin)),
            Integrator::Rk4 => {
                World::Rk4(Box::new([0.0, 0.5, 1.0].map(|share| at(begin + share * self.formula.dt_secs))))
            }
            _ => {
                let secs = [step.saturating_sub(1), step, step + 1].map(|step| timeline.step_secs(step));
                let (now, carry) = at_end_of_step(timeline, sampler, reading, secs);
                // Before the first step nothing is known but how all goes then.
                let formula = if step == 0 { Formula::euler(self.formula.dt_secs) } else { self.formula };
                World::Implicit { now, carry, formula }
            }
        }
    }

    fn step<L: Lane>(&self, moving: &mut Moving<L>, work: &mut Vec<Work<L>>, world: &World<'_>) {
        let Self { model, formula: Formula { dt_secs, .. }, .. } = self;
        let Moving { strands, swing, pace } = moving;
        strands.make_room(work);
        match world {
            World::Implicit { now, carry, formula } => {
                strands.step_implicit(work, model, now, carry.as_ref(), *formula);
            }
            // The others get no lanes but these (`Physical::lanes`), so nothing of them is compiled for any.
            _ if const { !L::IS_ONE_DOUBLE } => unreachable!("{:?} steps one strand alone", self.integrator),
            World::SemiImplicit(now) => {
                strands.step_semi_implicit(swing, work, model, now, *dt_secs);
            }
            World::Rk4(now) => strands.step_rk4(swing, work, model, now, *dt_secs),
            World::Adaptive(_, _, None) => (),
            World::Adaptive(timeline, sampler, Some(span)) => {
                strands.advance(pace, work, model, (timeline, sampler), *span, self.precise);
            }
        }
    }

    #[inline(always)]
    fn root_m<L: Lane>(moving: &Moving<L>) -> Vector<L> {
        moving.strands.root
    }

    #[inline(always)]
    fn show_ends_m<L: Lane>(moving: &Moving<L>, mut show: impl FnMut(usize, Vector<L>)) {
        for (k, state) in moving.strands.states.iter().enumerate() {
            show(k, state.place);
        }
    }

    fn asked<L: Lane>(moving: &mut Moving<L>) -> &mut Option<Extent<L>> {
        &mut moving.strands.asked
    }

    fn count<L: Lane>(moving: &Moving<L>) -> Count {
        moving.strands.count
    }

    fn longest_secs(&self, timeline: &Timeline<'_>) -> f64 {
        match self.integrator {
            Integrator::Adaptive => self.precise.longest_secs().min(timeline.frame_span_secs()),
            _ => timeline.dt_secs(),
        }
    }

    /// What the body bears, and that styles stay up.
    fn assumed(strands: &[Prepared]) -> Vec<Assumption> {
        borne_as(strands).into_iter().chain(stiffened(strands)).collect()
    }
}

/// What was taken for likely of the strands that the body bears.
fn borne_as(strands: &[Prepared]) -> Option<Assumption> {
    let borne: Vec<&Prepared> = strands.iter().filter(|p| !p.rest.bearings.is_empty()).collect();
    let value = match borne.first()?.rest.likely {
        Natural::Falling(fall) => format!(
            "by itself their hair bends down as that of the free strands: {:.1}/m times the sine of its angle with the \
             vertical, give or take curls of {:.1}/m",
            fall.rate_per_m, fall.curl_per_m
        ),
        Natural::Straight(_) => "their hair is as likely straight by itself as it is without load".to_owned(),
    };
    Some(Assumption {
        what: format!("what the body bears of {} of {} strands", borne.len(), strands.len()),
        value,
        why: "how a strand rests does not say how hard it lies on the body".to_owned(),
    })
}

/// By how much joints were made stiffer so that styles stay up.
fn stiffened(strands: &[Prepared]) -> Option<Assumption> {
    let times = strands.iter().map(|p| p.shape.stiffened);
    let mut stiffened: Vec<f64> = times.filter(|times| *times > 1.0).collect();
    stiffened.sort_by(f64::total_cmp);
    let (n, most) = (stiffened.len(), *stiffened.last()?);
    Some(Assumption {
        what: format!("bending stiffness of {n} of {} strands, where they lean out", strands.len()),
        value: format!(
            "up to {:.0} times that of their hairs in the median strand, {most:.0} in any",
            stiffened[n / 2]
        ),
        why: "their style would fall by itself: in life it rests on neighbors, which are not felt here"
            .to_owned(),
    })
}
