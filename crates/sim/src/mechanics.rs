//! What a method must say of itself so that it can be run.

use crate::extent::Extent;
use crate::parts::Count;
use crate::prepared::Prepared;
use crate::stability::Limit;
use crate::timeline::Timeline;
use crate::{Precision, SimOptions};
use core::fmt::Debug;
use tousle_core::{Assumption, Groom, Vec3};
use tousle_field::{FieldSequence, Reading, Sampler, Scene};
use tousle_lanes::{Lane, Registers, Vector};
use tousle_rod::DragLaw;

/// What is simulated, and how.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setting<'a> {
    pub field: &'a FieldSequence,
    pub scene: &'a Scene,
    pub groom: &'a Groom,
    /// The hairstyle that the groom is a part of, unless it is all there is: what strands tell of one another is asked of all.
    pub whole: Option<&'a Groom>,
    pub options: &'a SimOptions,
}

impl Setting<'_> {
    /// The drag law of the scene's air.
    pub fn law(&self) -> DragLaw {
        DragLaw::in_air(self.scene.air_density)
    }
}

/// The mechanics of a [`Method`](crate::Method). A value is what all strands of one run share.
pub(crate) trait Mechanics: Copy + Debug + Send + Sync + 'static {
    /// What it makes of a strand's rest before the first step.
    type Shape: Debug + Send + Sync;
    /// Strands side by side, somewhere on their way. Where one has fewer sticks than the longest, sticks without mass
    /// follow its tip; where there are fewer strands than lanes, the last one runs again and is not read.
    type Batch<L: Lane>: Clone + Debug + Send + Sync;
    /// What a step writes and reads again for each stick.
    type Work<L: Lane>;
    /// What the world does in a step.
    type World<'a>: Send + Sync;

    /// Registers and digits that an integrator is stepped with.
    fn lanes(options: &SimOptions) -> (Registers, Precision) {
        (Registers::widest(), options.precision)
    }

    /// The shortest step that single precision stands, s.
    const SHORTEST_SINGLE_SECS: f64 = 0.0;

    /// Says whether a point of head space, m, is where no air can be.
    fn is_solid(scene: &Scene) -> impl Fn(Vec3) -> bool;

    /// All strands of the groom as they hang at rest.
    fn prepare(setting: &Setting<'_>, timeline: &Timeline<'_>) -> Vec<Prepared<Self::Shape>>;

    /// The longest step of an integrator that has one, under the timeline's layers; `None` if it stands any.
    fn limit(
        setting: &Setting<'_>,
        timeline: &Timeline<'_>,
        strands: &[Prepared<Self::Shape>],
    ) -> Option<Limit>;

    /// The mechanics of a run.
    fn new(setting: &Setting<'_>, timeline: &Timeline<'_>) -> Self;

    /// Up to as many strands as there are lanes, before their first step.
    fn batch<L: Lane>(&self, strands: &[&Prepared<Self::Shape>]) -> Self::Batch<L>;

    /// What the world does in a step, from 0.
    fn world<'a>(
        &self,
        timeline: &'a Timeline<'a>,
        sampler: &'a Sampler<'a>,
        reading: Reading,
        step: usize,
    ) -> Self::World<'a>;

    /// Takes a step. `work` is room for it.
    fn step<L: Lane>(
        &self,
        batch: &mut Self::Batch<L>,
        work: &mut Vec<Self::Work<L>>,
        world: &Self::World<'_>,
    );

    /// Where the strands grow, head space, m.
    fn root_m<L: Lane>(batch: &Self::Batch<L>) -> Vector<L>;

    /// Shows the far end of every stick and its number, from the root, head space, m. Shows at one place alone, so that what is
    /// shown to becomes a part of it.
    fn show_ends_m<L: Lane>(batch: &Self::Batch<L>, show: impl FnMut(usize, Vector<L>));

    /// Where the strands have asked the field since this was set to a box around nothing; nothing is kept of it while it is
    /// `None`, as at first.
    fn asked<L: Lane>(batch: &mut Self::Batch<L>) -> &mut Option<Extent<L>>;

    /// What the steps of a batch took.
    fn count<L: Lane>(batch: &Self::Batch<L>) -> Count;

    /// The longest step that is taken, s.
    fn longest_secs(&self, timeline: &Timeline<'_>) -> f64 {
        timeline.dt_secs()
    }

    /// What was assumed so that the strands hang as they do.
    fn assumed(_strands: &[Prepared<Self::Shape>]) -> Vec<Assumption> {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Method;
    use crate::paper::Paper;
    use crate::physical::Physical;
    use crate::ready::Ready;
    use crate::timeline::Runs;
    use tousle_bench::worlds::{gusts, mannequin, wig};
    use tousle_core::NoProgress;

    /// A strand does not know how many are stepped beside it, nor in which registers.
    #[test]
    fn strands_move_the_same_in_all_registers() {
        let (field, scene, groom) = (gusts(), mannequin(), wig(21, 9));
        let here = Registers::here();
        for method in [Method::Paper, Method::Physical] {
            for precision in [Precision::Double, Precision::Single] {
                let options = SimOptions { precision, duration_secs: Some(0.15), ..SimOptions::of(method) };
                let setting =
                    Setting { field: &field, scene: &scene, groom: &groom, whole: None, options: &options };
                let run = |registers: &Registers| {
                    let ready = match method {
                        Method::Paper => Ready::<Paper>::resident_in(setting, *registers, precision),
                        Method::Physical => Ready::<Physical>::resident_in(setting, *registers, precision),
                    };
                    let simulation = ready.unwrap().run(&[], None, &NoProgress, Runs::Again);
                    simulation.unwrap().motion.positions_m
                };
                let moved: Vec<_> = here.iter().map(run).collect();
                assert!(moved.iter().all(|m| *m == moved[0]), "{method:?}, {precision:?}, {here:?}");
            }
        }
    }
}
