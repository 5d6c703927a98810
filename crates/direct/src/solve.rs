//! Gauss and Newton's method through the simulator.

mod apart;
mod descend;
mod ground;
mod peaks;
mod problem;
mod push;

pub use ground::Ground;

use crate::basis::{Basis, Times};
use crate::target::{Aim, aim};
use crate::{DirectError, DirectOptions, KeyOutcome, SolvedOutcome, Stage};
use peaks::Peaks;
use problem::{Problem, Run, WATCHED_LONGER_SECS, WATCHED_SECS, Weights};
use std::sync::Arc;
use tousle_core::Vec3;
use tousle_edit::{Change, EditError, FoundKey, Unreachable};
use tousle_field::{FieldLayer, LayerKey};

/// A drag whose strands and times were found.
#[derive(Clone, Debug, PartialEq)]
pub struct Drag {
    /// A name for people.
    pub name: String,
    /// The edit's id, unlike those on the field.
    pub edit_id: String,
    /// Whether its layers should do nothing for now.
    pub muted: bool,
    /// Before this time nothing changes, s.
    pub first_secs: f64,
    /// What should be where, in order of time, all after that; at least one.
    pub keys: Vec<FoundKey>,
    /// Distance from a strand's way at which its extra vectors have fallen to 0, m.
    pub reach_m: f64,
}

/// A drag that was solved for.
#[derive(Clone, Debug)]
pub struct Solved {
    /// The layers to be put on top of those it was solved under.
    pub layers: Vec<FieldLayer>,
    /// How near the keys they bring the strands.
    pub outcome: SolvedOutcome,
    vectors: Vec<Vec3>,
    ground: Arc<Ground>,
}

/// Solves for the smallest and smoothest extra vectors with which some strands meet some keys.
///
/// In: what is simulated, the layers that are on its field already, and the drag. Out: more layers, and how near they
/// bring the strands to the keys. They are nothing before the first key, and have gone some tenths of a second after
/// the last. `before`: what was found for nearly the same keys, to begin from.
/// Source: Gauss and Newton's method with Marquardt's damping, the derivatives by finite differences through the
/// simulator (`docs/direct.md`).
///
/// # Errors
/// [`DirectError`] if a strand cannot be simulated or the reach is too small for its way. A key that cannot be met is
/// no error but [`KeyOutcome::unreachable`]: the strand is brought as near as was found.
///
/// # Panics
/// If there is no key, or the groom has no such strand or point.
pub fn solve(
    stage: &Stage<'_>,
    layers: &[FieldLayer],
    drag: &Drag,
    before: Option<&Solved>,
    options: &DirectOptions,
) -> Result<Solved, DirectError> {
    let ground = match before {
        Some(before) if before.ground.is_of(layers, drag) => before.ground.clone(),
        _ => Arc::new(Ground::new(stage, layers, drag)?),
    };
    let keys: Vec<LayerKey> = drag.keys.iter().map(|key| layer_key(stage, key)).collect();
    let aims: Vec<Aim> = drag.keys.iter().map(|key| aim(stage, key, &ground.points_at(key))).collect();
    let secs: Vec<f64> = keys.iter().map(|key| key.secs).collect();
    let times = Times::new(drag.first_secs, &secs);
    let mut solver = Solver::new(stage, &ground, (drag, &keys), options, times);
    solver.is_hurried = before.is_some();
    let best = solver.best(&aims, before.map(|before| &before.vectors[..]))?;
    let mut layers = best.problem.layers(&best.vectors);
    layers.iter_mut().for_each(|layer| layer.muted = drag.muted);
    let outcome = solver.outcome(&best, &layers, aims);
    Ok(Solved { layers, outcome, vectors: best.vectors, ground: ground.clone() })
}

fn layer_key(stage: &Stage<'_>, key: &FoundKey) -> LayerKey {
    LayerKey {
        strand: stage.groom.strands[key.strand_idx].name.clone(),
        control_point: key.control_point,
        secs: key.secs,
        target_m: key.target_m,
    }
}

/// An answer, good or not.
struct Answer<'a> {
    problem: Problem<'a>,
    vectors: Vec<Vec3>,
    run: Run,
    /// How much more violently the strands move than without the drag.
    ratios: Peaks,
}

struct Solver<'a> {
    stage: &'a Stage<'a>,
    ground: &'a Ground,
    drag: &'a Drag,
    keys: &'a [LayerKey],
    options: &'a DirectOptions,
    times: Times,
    /// Whether a hand moves: the next answer is worth more than a better one.
    is_hurried: bool,
    /// For how long strands are watched after their layers have gone, s.
    watched_secs: f64,
    n_runs: usize,
}

/// What a peak that is twice what it may be counts at first, and in the search for a calmer answer.
const CALM: f64 = 5.0;
const CALMER: f64 = 50.0;

/// What is tried until something meets its keys and is calm.
#[derive(Clone, Copy, Debug)]
enum Attempt {
    /// Handles along a guessed way, and a start from the nearest of some pushes.
    Guessed,
    /// Handles along the way that the last answer takes, and a start from there.
    Known,
    /// More vectors along the strand, and a start from nothing.
    Finer,
}

/// How one attempt goes to its answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Steps {
    /// Where the derivatives point.
    Straight,
    /// On the curve on which the rows change, or straight, whichever gets farther.
    Curved,
}

/// What is tried after the first attempt, one after another.
const ATTEMPTS: [Attempt; 3] = [Attempt::Known, Attempt::Known, Attempt::Finer];

/// How many of these while a hand moves, and only where keys are unmet.
const ATTEMPTS_OF_A_HAND: usize = 1;

impl<'a> Solver<'a> {
    fn new(
        stage: &'a Stage<'a>,
        ground: &'a Ground,
        (drag, keys): (&'a Drag, &'a [LayerKey]),
        options: &'a DirectOptions,
        times: Times,
    ) -> Self {
        let (is_hurried, watched_secs) = (false, WATCHED_SECS);
        Self { stage, ground, drag, keys, options, times, is_hurried, watched_secs, n_runs: 0 }
    }

    /// The best answer. `start`: where to begin, while a hand moves.
    fn best(&mut self, aims: &[Aim], start: Option<&[Vec3]>) -> Result<Answer<'a>, DirectError> {
        if self.ground.strands.len() > 1 && !self.is_hurried {
            return self.best_of_several(aims);
        }
        self.best_at_once(aims, start)
    }

    /// The best of attempts by straight steps, and where none is good also by curved ones; or the other way round.
    ///
    /// A straight piece of a strand comes no shorter, to first order, whatever its ends are pushed with: keys between
    /// which it must are neared by straight steps that grow ever smaller.
    fn best_at_once(&mut self, aims: &[Aim], start: Option<&[Vec3]>) -> Result<Answer<'a>, DirectError> {
        let steps = self.steps();
        let first = self.best_by(steps[0], aims, start)?;
        if first.is_good(self.options) || self.is_hurried {
            return Ok(first);
        }
        let second = self.best_by(steps[1], aims, None)?;
        Ok(if second.is_better_than(&first) { second } else { first })
    }

    /// The kinds of steps, in the order in which they are tried.
    fn steps(&self) -> [Steps; 2] {
        let has_several_keys_of_a_strand = self.ground.strands.len() < self.drag.keys.len();
        if has_several_keys_of_a_strand {
            [Steps::Curved, Steps::Straight]
        } else {
            [Steps::Straight, Steps::Curved]
        }
    }

    /// Attempts until one meets its keys and moves no more violently than it may; the best of them.
    fn best_by(
        &mut self,
        steps: Steps,
        aims: &[Aim],
        start: Option<&[Vec3]>,
    ) -> Result<Answer<'a>, DirectError> {
        let mut best = self.attempt(aims, Attempt::Guessed, steps, None, start)?;
        let n_attempts = if self.is_hurried { ATTEMPTS_OF_A_HAND } else { ATTEMPTS.len() };
        let mut was_in_vain = false;
        for kind in ATTEMPTS.into_iter().take(n_attempts) {
            if best.is_good(self.options) || (self.is_hurried && best.run.is_met()) {
                break;
            }
            if was_in_vain && matches!(kind, Attempt::Known) {
                // It would begin and end where the last one did.
                continue;
            }
            let next = self.attempt(aims, kind, steps, Some(&best), None)?;
            was_in_vain = !next.is_better_than(&best);
            if !was_in_vain {
                best = next;
            }
        }
        Ok(best)
    }

    /// One attempt.
    fn attempt(
        &mut self,
        aims: &[Aim],
        kind: Attempt,
        steps: Steps,
        last: Option<&Answer<'a>>,
        start: Option<&[Vec3]>,
    ) -> Result<Answer<'a>, DirectError> {
        let way = last.filter(|_| matches!(kind, Attempt::Known)).map(|last| &last.run.motions[..]);
        let is_finer = matches!(kind, Attempt::Finer);
        let strands = self.ground.dragged(&self.times, self.drag, aims, way, is_finer);
        let bad = |problem| EditError::BadEdit { number: 1, name: self.drag.name.clone(), problem };
        let basis = Basis::new(self.times.clone(), &strands, self.drag.reach_m).map_err(bad)?;
        let problem =
            Problem::new(self.stage, self.ground, self.drag, self.keys, aims.to_vec(), basis, self.options);
        let start = match kind {
            Attempt::Known => last.map(|last| &last.vectors[..]),
            _ => start,
        };
        let start = start.filter(|start| start.len() == problem.n());
        let starts = start.map_or_else(|| problem.starts(), |start| vec![start.to_vec()]);
        self.search(problem, starts, steps)
    }

    /// A descent, and where it meets its keys too violently a calmer one from there.
    fn search(
        &mut self,
        problem: Problem<'a>,
        starts: Vec<Vec<Vec3>>,
        steps: Steps,
    ) -> Result<Answer<'a>, DirectError> {
        let problem = problem.watched_for(self.watched_secs);
        let found = self.descend(problem, starts, Weights { keys: 0.0, peaks: CALM }, steps)?;
        if !found.run.is_met() || found.is_good(self.options) || self.is_hurried {
            return Ok(found);
        }
        self.watched_secs = WATCHED_LONGER_SECS;
        let problem = found.problem.clone().watched_for(self.watched_secs);
        let weights = Weights { keys: f64::INFINITY, peaks: CALMER };
        let calmer = self.descend(problem, vec![found.vectors.clone()], weights, steps)?;
        Ok(if calmer.is_better_than(&found) { calmer } else { found })
    }

    /// What an answer with these layers became.
    fn outcome(&self, best: &Answer<'_>, layers: &[FieldLayer], aims: Vec<Aim>) -> SolvedOutcome {
        let Self { ground, drag, options, .. } = self;
        let strongest = best.vectors.iter().map(Vec3::norm).fold(0.0, f64::max);
        let demanded = ground.demanded(&drag.keys, options.tolerance_m);
        let outcome = |((found, key), aim): ((&FoundKey, &LayerKey), Aim)| {
            let after = (best.run.place(ground, found) - found.target_m).norm() * 1e3;
            let residual_mm = Change { before: (found.unedited_m - found.target_m).norm() * 1e3, after };
            let is_met = after <= options.tolerance_m * 1e3;
            let by_wind = strongest >= 0.98 * options.limit;
            let found = if by_wind {
                Unreachable::TooWeak { by_mm: after, limit: options.limit }
            } else {
                Unreachable::NotFound { by_mm: after }
            };
            let unreachable = (!is_met).then(|| aim.why.unwrap_or(found));
            KeyOutcome { key: key.clone(), aimed_m: aim.place_m, residual_mm, unreachable }
        };
        SolvedOutcome {
            name: drag.name.clone(),
            edit_id: drag.edit_id.clone(),
            muted: drag.muted,
            first_secs: drag.first_secs,
            last_secs: best.problem.last_secs(),
            keys: drag.keys.iter().zip(self.keys).zip(aims).map(outcome).collect(),
            strongest,
            acceleration_ratio: best.ratios.acceleration,
            jerk_ratio: best.ratios.jerk,
            least_acceleration_ratio: demanded.acceleration,
            least_jerk_ratio: demanded.jerk,
            peaks_demanded: demanded.largest() > options.peak_ratio,
            n_runs: self.n_runs,
            n_layers: layers.len(),
            n_handles: layers.iter().map(|layer| layer.handles.len()).sum(),
        }
    }
}

impl Answer<'_> {
    /// Whether no other is looked for.
    fn is_good(&self, options: &DirectOptions) -> bool {
        self.run.is_met() && self.ratios.largest() <= options.peak_ratio
    }

    /// Nearer to the keys, or of two that are near enough the calmer one.
    fn is_better_than(&self, other: &Self) -> bool {
        if self.run.is_met() && other.run.is_met() {
            self.ratios.largest() < other.ratios.largest()
        } else {
            self.run.miss < other.run.miss
        }
    }
}
