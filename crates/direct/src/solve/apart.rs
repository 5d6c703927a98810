//! Strands that are dragged together, each solved for alone first: most feel nothing of one another's layers.

use super::problem::Problem;
use super::{Answer, Drag, Ground, Solver};
use crate::DirectError;
use crate::basis::Basis;
use crate::target::Aim;
use rayon::prelude::*;
use tousle_core::{StrandMotion, Vec3};
use tousle_field::LayerKey;

/// One strand of a drag.
struct Part {
    ground: Ground,
    drag: Drag,
    keys: Vec<LayerKey>,
    aims: Vec<Aim>,
}

/// What was found for it alone.
struct Found {
    basis: Basis,
    vectors: Vec<Vec3>,
    motion: StrandMotion,
    n_runs: usize,
}

impl<'a> Solver<'a> {
    /// The answers of all strands alone, put together; where strands feel one another's layers, brought nearer to the keys
    /// from there, and if that is not enough solved for together.
    pub(super) fn best_of_several(&mut self, aims: &[Aim]) -> Result<Answer<'a>, DirectError> {
        let parts = (0..self.ground.strands.len()).map(|strand| Part::of(self, aims, strand));
        let parts: Vec<Part> = parts.collect();
        let found: Vec<Found> = parts.par_iter().map(|part| part.solve(self)).collect::<Result<_, _>>()?;
        let alone: Vec<StrandMotion> = found.iter().map(|found| found.motion.clone()).collect();
        let mut best = self.together(aims, found)?;
        if is_same(&best.run.motions, &alone) || best.is_good(self.options) {
            return Ok(best);
        }
        let [steps, _] = self.steps();
        let mended = self.search(best.problem.clone(), vec![best.vectors.clone()], steps)?;
        if mended.is_better_than(&best) {
            best = mended;
        }
        if best.is_good(self.options) {
            return Ok(best);
        }
        let anew = self.best_at_once(aims, None)?;
        Ok(if anew.is_better_than(&best) { anew } else { best })
    }

    /// What the strands' own answers do together.
    fn together(&mut self, aims: &[Aim], found: Vec<Found>) -> Result<Answer<'a>, DirectError> {
        self.n_runs += 1 + found.iter().map(|found| found.n_runs).sum::<usize>();
        let vectors: Vec<Vec3> = found.iter().flat_map(|found| found.vectors.clone()).collect();
        let basis = Basis::joined(found.into_iter().map(|found| found.basis));
        let problem =
            Problem::new(self.stage, self.ground, self.drag, self.keys, aims.to_vec(), basis, self.options);
        let run = problem.run(std::slice::from_ref(&vectors))?.swap_remove(0);
        let ratios = problem.ratios(&vectors)?;
        Ok(Answer { problem, vectors, run, ratios })
    }
}

/// Whether strands move the same to the bit, as long as both are known.
fn is_same(some: &[StrandMotion], others: &[StrandMotion]) -> bool {
    some.iter().zip(others).all(|(a, b)| a.positions_m.iter().zip(&b.positions_m).all(|(a, b)| a == b))
}

impl Part {
    /// The keys of one of the strands.
    fn of(whole: &Solver<'_>, aims: &[Aim], strand: usize) -> Self {
        let own = |key: &usize| whole.ground.index(&whole.drag.keys[*key]) == strand;
        let own: Vec<usize> = (0..aims.len()).filter(own).collect();
        let keys = own.iter().map(|key| whole.drag.keys[*key].clone()).collect();
        Self {
            ground: whole.ground.only(strand),
            drag: Drag { keys, ..whole.drag.clone() },
            keys: own.iter().map(|key| whole.keys[*key].clone()).collect(),
            aims: own.iter().map(|key| aims[*key].clone()).collect(),
        }
    }

    fn solve(&self, whole: &Solver<'_>) -> Result<Found, DirectError> {
        let Solver { stage, options, times, .. } = whole;
        let Self { ground, drag, keys, .. } = self;
        let mut solver = Solver::new(stage, ground, (drag, keys), options, times.clone());
        let Answer { problem, vectors, mut run, .. } = solver.best_at_once(&self.aims, None)?;
        Ok(Found { basis: problem.basis, vectors, motion: run.motions.swap_remove(0), n_runs: solver.n_runs })
    }
}
