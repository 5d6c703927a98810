//! The search itself.

use super::problem::{Problem, Weights};
use super::{Answer, Run, Solver, Steps};
use crate::DirectError;
use crate::normal::{Normal, between, updated};
use nalgebra::{DMatrix, DVector};
use tousle_core::Vec3;

/// How often the derivatives are taken in one descent, and steps that are tried, at most.
const MAX_JACOBIANS: usize = 12;
const MAX_STEPS: usize = 40;

/// Steps of how much more damping are tried side by side: from bold to careful.
const DAMPINGS: [f64; 4] = [0.03, 1.0, 30.0, 1000.0];

/// What damping begins with, its least and its most, what derivatives that were taken anew begin with at the most, and
/// what it grows by where none of the steps helps: past all that were tried.
const FIRST_DAMPING: f64 = 1e-2;
const DAMPING: (f64, f64) = (1e-9, 1e6);
const FRESH_DAMPING: f64 = 1.0;
const MORE_DAMPING: f64 = 1e6;

/// At the end a tolerance's distance from a key counts so much, as the whole of what makes an answer smooth counts some:
/// that only chooses among answers. Where a key is unmet even so, it counts [`KEYS_MOST`].
const KEYS_LAST: f64 = 30.0;
const KEYS_MOST: f64 = 1000.0;

/// At the beginning the whole way to the keys counts so much, and with every step so many times more, after one that did
/// other than was foretold less: the answer comes from smooth ones that go part of the way, not from any that gets there.
const KEYS_FIRST: f64 = 10.0;
const KEYS_GROW: (f64, f64) = (4.0, 2.0);

/// A key counts as met well when it is met to this share of the tolerance.
const WELL_MET: f64 = 0.1;

/// A step that makes the squares less by no more than this share is the last: with keys met well, and without.
const TOO_LITTLE: (f64, f64) = (0.1, 1e-2);

/// How rows curve along a step is seen from this share of it, forth and back.
const AROUND: f64 = 0.25;

/// Derivatives that foretold so much of what a step gained are brought up to date by what it did; others are taken anew,
/// and so they are at the end if a step leaves more than that of the squares.
const FORETOLD: f64 = 0.6;
const GAINED_LITTLE: f64 = 0.9;

/// Where a search is.
struct Descent<'p, 'a> {
    problem: &'p Problem<'a>,
    vectors: Vec<Vec3>,
    run: Run,
    jacobian: DMatrix<f64>,
    /// Whether the derivatives were taken here.
    is_fresh: bool,
    damping: f64,
    weights: Weights,
    steps: Steps,
    n_runs: usize,
}

/// What became of a step.
struct Stepped {
    /// What is left of the squares, as a share; 1 if no step helped.
    left: f64,
    is_foretold: bool,
}

impl<'a> Solver<'a> {
    /// Makes the squares of a problem least, from that of some starts that is nearest to the keys.
    ///
    /// Levenberg and Marquardt's method with Broyden's updates. What keys count grows on the way, from what `least` says or
    /// where the start is that far off: see [`KEYS_FIRST`].
    pub(super) fn descend(
        &mut self,
        problem: Problem<'a>,
        starts: Vec<Vec<Vec3>>,
        least: Weights,
        steps: Steps,
    ) -> Result<Answer<'a>, DirectError> {
        let mut descent = Descent::new(&problem, starts, least, steps)?;
        let (mut keys_last, mut n_jacobians) = (KEYS_LAST, 1);
        for _ in 0..MAX_STEPS {
            let was_fresh = descent.is_fresh;
            let Stepped { left, is_foretold } = descent.step()?;
            let (is_better, is_last) = (left < 1.0, descent.weights.keys >= keys_last);
            let too_little = if descent.run.miss <= WELL_MET { TOO_LITTLE.0 } else { TOO_LITTLE.1 };
            let is_settled = is_better && is_last && left > 1.0 - too_little;
            if self.is_hurried && is_last && descent.run.miss <= WELL_MET {
                break;
            }
            if was_fresh && (is_settled || descent.damping > DAMPING.1) {
                if descent.run.is_met() || keys_last == KEYS_MOST {
                    break;
                }
                (keys_last, descent.damping) = (KEYS_MOST, FIRST_DAMPING);
            }
            if is_better {
                let grow = if is_foretold { KEYS_GROW.0 } else { KEYS_GROW.1 };
                descent.weights.keys = (descent.weights.keys * grow).min(keys_last);
            }
            let is_off = is_better && (!is_foretold || (is_last && left > GAINED_LITTLE));
            if is_off || (!is_better && !was_fresh) {
                if n_jacobians == MAX_JACOBIANS {
                    break;
                }
                descent.refresh()?;
                n_jacobians += 1;
            }
        }
        let Descent { vectors, run, n_runs, .. } = descent;
        self.n_runs += n_runs;
        let ratios = problem.ratios(&vectors)?;
        Ok(Answer { problem, vectors, run, ratios })
    }
}

impl<'p, 'a> Descent<'p, 'a> {
    /// At that of some starts that is nearest to the keys.
    fn new(
        problem: &'p Problem<'a>,
        mut starts: Vec<Vec<Vec3>>,
        least: Weights,
        steps: Steps,
    ) -> Result<Self, DirectError> {
        let n_runs = starts.len() + 3 * problem.n();
        let mut runs = problem.run(&starts)?;
        let misses = runs.iter().map(|run| run.miss).enumerate();
        let (k, miss) = misses.min_by(|a, b| a.1.total_cmp(&b.1)).expect("some starts");
        let (vectors, run) = (starts.swap_remove(k), runs.swap_remove(k));
        let keys = f64::max(least.keys, KEYS_FIRST / miss.max(1e-9)).min(KEYS_LAST);
        let jacobian = problem.jacobian(&vectors, &run)?;
        let weights = Weights { keys, ..least };
        let (is_fresh, damping) = (true, FIRST_DAMPING);
        Ok(Self { problem, vectors, run, jacobian, is_fresh, damping, weights, steps, n_runs })
    }

    /// Goes the best of some steps, if one helps; else the next will be more careful.
    fn step(&mut self) -> Result<Stepped, DirectError> {
        let weights = self.run.weights(self.weights);
        let cost = |rows: &DVector<f64>| rows.component_mul(&weights).norm_squared();
        let normal = Normal::new(&self.jacobian, &self.run.rows, &weights);
        let mut steps = DAMPINGS.map(|times| normal.step(times * self.damping)).to_vec();
        if self.steps == Steps::Curved {
            steps.extend(self.curved(&normal, &steps)?);
        }
        let mut tried: Vec<Vec<Vec3>> =
            steps.iter().map(|step| self.problem.moved(&self.vectors, step)).collect();
        self.n_runs += tried.len();
        let mut runs = self.problem.run(&tried)?;
        let costs = runs.iter().map(|run| cost(&run.rows)).enumerate();
        let (k, after) = costs.min_by(|a, b| a.1.total_cmp(&b.1)).expect("some steps");
        let before = cost(&self.run.rows);
        if after >= before {
            self.damping *= MORE_DAMPING;
            return Ok(Stepped { left: 1.0, is_foretold: false });
        }
        let (next, vectors) = (runs.swap_remove(k), tried.swap_remove(k));
        let moved = between(&self.vectors, &vectors);
        let foretold = before - cost(&(&self.run.rows + &self.jacobian * &moved));
        let did = &next.rows - &self.run.rows;
        // Nothing is copied: a Jacobian may have some thousand rows.
        self.jacobian = updated(std::mem::take(&mut self.jacobian), &moved, &did);
        self.is_fresh = false;
        self.damping = (self.damping * DAMPINGS[k % DAMPINGS.len()]).max(DAMPING.0);
        (self.vectors, self.run) = (vectors, next);
        Ok(Stepped { left: after / before, is_foretold: before - after > FORETOLD * foretold })
    }

    /// Steps of all the dampings that follow the curves on which rows change: see [`Normal::curve`].
    fn curved(&mut self, normal: &Normal, steps: &[DVector<f64>]) -> Result<Vec<DVector<f64>>, DirectError> {
        let around = [-AROUND, AROUND].map(|share| {
            steps.iter().map(move |step| step * share).map(|step| self.problem.moved(&self.vectors, &step))
        });
        let around: Vec<Vec<Vec3>> = around.into_iter().flatten().collect();
        self.n_runs += around.len();
        let runs = self.problem.run(&around)?;
        let (back, forth) = runs.split_at(steps.len());
        let curved = |(k, step): (usize, &DVector<f64>)| {
            let second = (&back[k].rows - &self.run.rows * 2.0 + &forth[k].rows) / (AROUND * AROUND);
            step + normal.curve(DAMPINGS[k] * self.damping, step, &second)
        };
        Ok(steps.iter().enumerate().map(curved).collect())
    }

    /// Takes the derivatives anew.
    fn refresh(&mut self) -> Result<(), DirectError> {
        self.n_runs += 3 * self.problem.n();
        self.jacobian = self.problem.jacobian(&self.vectors, &self.run)?;
        self.is_fresh = true;
        self.damping = self.damping.min(FRESH_DAMPING);
        Ok(())
    }
}
