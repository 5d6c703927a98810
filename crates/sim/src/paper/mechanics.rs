//! The method `paper` as a run asks for it.

use super::{Batch, Paper, Work, stability};
use crate::extent::Extent;
use crate::mechanics::{Mechanics, Setting};
use crate::parts::Count;
use crate::prepared::Prepared;
use crate::stability::Limit;
use crate::timeline::{StepScene, Timeline};
use crate::touchable::touchable;
use rayon::prelude::*;
use tousle_core::{Pose, Strand, Vec3};
use tousle_field::{Reading, Sampler, Scene};
use tousle_lanes::{Lane, Vector};
use tousle_rod::{Likely, Lock, Surface, Twist, rest_state};

impl Mechanics for Paper {
    type Shape = ();
    type Batch<L: Lane> = Batch<L>;
    type Work<L: Lane> = Work<L>;
    type World<'a> = StepScene<'a>;

    fn is_solid(_: &Scene) -> impl Fn(Vec3) -> bool {
        |_| false
    }

    fn prepare(setting: &Setting<'_>, timeline: &Timeline<'_>) -> Vec<Prepared<()>> {
        let scene = setting.scene;
        let gravity = timeline.gravity_at_rest();
        let surfaces = Surface::of_body(&scene.body, &Pose::identity());
        let prepare = |strand: &Strand| {
            let lock = Lock::new(strand);
            let rest = rest_state(&lock, gravity, &scene.body, &Likely::smooth(&lock, Twist::Free));
            let touchable = touchable(scene, timeline, &surfaces, &lock, &rest);
            Prepared { lock, rest, touchable, shape: () }
        };
        setting.groom.strands.par_iter().map(prepare).collect()
    }

    fn limit(setting: &Setting<'_>, timeline: &Timeline<'_>, strands: &[Prepared<()>]) -> Option<Limit> {
        stability::limit(setting, timeline, strands)
    }

    fn new(setting: &Setting<'_>, timeline: &Timeline<'_>) -> Self {
        Self {
            integrator: setting.options.integrator(),
            terms: timeline.terms,
            friction: setting.scene.body.friction,
            law: setting.law(),
        }
    }

    fn batch<L: Lane>(&self, strands: &[&Prepared<()>]) -> Batch<L> {
        Batch::new(strands, &self.law)
    }

    fn world<'a>(
        &self,
        timeline: &'a Timeline<'a>,
        sampler: &'a Sampler<'a>,
        reading: Reading,
        step: usize,
    ) -> StepScene<'a> {
        timeline.step_scene(step, sampler, reading)
    }

    fn step<L: Lane>(&self, batch: &mut Batch<L>, work: &mut Vec<Work<L>>, scene: &StepScene<'_>) {
        batch.step(work, self, scene);
    }

    #[inline(always)]
    fn root_m<L: Lane>(batch: &Batch<L>) -> Vector<L> {
        batch.root
    }

    #[inline(always)]
    fn show_ends_m<L: Lane>(batch: &Batch<L>, show: impl FnMut(usize, Vector<L>)) {
        batch.show_ends_m(show);
    }

    fn asked<L: Lane>(batch: &mut Batch<L>) -> &mut Option<Extent<L>> {
        &mut batch.asked
    }

    fn count<L: Lane>(batch: &Batch<L>) -> Count {
        let steps = batch.n_strands * batch.n_steps;
        Count { steps, iterations: steps, ..Count::default() }
    }
}
