//! What all locks say of the air at every step, with errors that last.

use super::PhysicalOptions;
use super::constants::{ConstantsAt, N_CONSTANTS};
use super::moments::DragSlope;
use super::noise::counted_as_one;
use super::smoother::Said;
use super::solve::{Problem, Surroundings};
use super::triangle::Triangle;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use tousle_flow::AirFlow;

/// What all locks say at a step.
pub(crate) struct StepSaid {
    pub(crate) of_air: Said,
    pub(crate) of_constants: ConstantsAt,
    pub(crate) of_locks: Vec<LockSaid>,
}

/// What a lock at a step says of itself.
#[derive(Clone, Copy, Default)]
pub(crate) struct LockSaid {
    /// Of its moments, each over its expected error.
    pub(crate) square: f64,
    /// Whether the body pushes it.
    pub(crate) touches: bool,
}

/// How long errors last that do not ([`PhysicalOptions::fleeting_share`]), s: smoothed tracks say nothing new in less.
const FLEETING_SECS: f64 = 1.0 / 30.0;

/// Steps that are asked side by side, before the next are.
const ASKED_TOGETHER: usize = 50;

/// What the locks say at all steps, made linear in the state of the air.
pub(crate) fn ask(
    problem: &Problem<'_>,
    around: &Surroundings,
    air: &AirFlow,
    slope: DragSlope,
) -> Vec<StepSaid> {
    let n_steps = problem.clock.n_steps;
    let counts = Counts::of_steps(1.0 / problem.clock.rate_hz, problem.options);
    let mut said = Vec::with_capacity(n_steps);
    // What the steps from `from` on say by themselves.
    let (mut from, mut all): (usize, Vec<Statements>) = (0, Vec::new());
    for first in (0..n_steps).step_by(ASKED_TOGETHER) {
        let end = (first + ASKED_TOGETHER).min(n_steps);
        let before = first.saturating_sub(1);
        all.drain(..before - from);
        from = before;
        let asked = |step| Statements::of(problem, around, air, step, slope);
        let new = from + all.len()..(end + 1).min(n_steps);
        all.extend(new.into_par_iter().map(asked).collect::<Vec<_>>());
        let of_step = |step: usize| {
            let at = step - from;
            let before = at.checked_sub(1).map(|k| &all[k]);
            let of_locks = all[at].locks.iter().map(|lock| lock.unwrap_or_default()).collect();
            let (of_air, of_constants) =
                all[at].said(before, all.get(at + 1), &counts, problem.options.locks_differ);
            StepSaid { of_locks, of_air, of_constants }
        };
        said.extend((first..end).into_par_iter().map(of_step).collect::<Vec<_>>());
    }
    said
}

/// How much a statement counts if its error lasts.
///
/// An error z of variance 1 of which a share `a` is left at the next step has the precision (z − a z₋)² / (1 − a²). As
/// (z − a z₋)² = a (z − z₋)² + (1 − a) (z² − a z₋²), that is (1 − a) / (1 + a) for every step's own, and for every change from step to
/// step all but what it varies by.
struct Counts {
    own: f64,
    change: f64,
}

impl Counts {
    fn of_steps(step_secs: f64, options: &PhysicalOptions) -> Self {
        let left = libm::exp(-step_secs / options.errors_last_secs);
        let fleeting = options.fleeting_share;
        let of_change = 2.0 * (1.0 - left) * (1.0 - fleeting) + 2.0 * fleeting;
        let as_one = counted_as_one(step_secs);
        Self {
            own: as_one * (1.0 - left) / (1.0 + left),
            change: as_one * f64::min(step_secs / FLEETING_SECS, 1.0) / of_change,
        }
    }
}

/// What all locks say at a step, one statement below the other.
struct Statements {
    /// By lock; `None` if it says nothing.
    locks: Vec<Option<LockSaid>>,
    /// How many statements each lock makes.
    n_rows: Vec<usize>,
    /// How much each lock counts: 1, or less for an outlier.
    weights: Vec<f64>,
    by_state: DMatrix<f64>,
    /// Each lock's by its own constants.
    by_constants: DMatrix<f64>,
    /// What `by_state` times the state and `by_constants` times the constants should be together.
    target: DVector<f64>,
}

impl Statements {
    fn of(
        problem: &Problem<'_>,
        around: &Surroundings,
        air: &AirFlow,
        step: usize,
        slope: DragSlope,
    ) -> Self {
        let (now, values) = (air.now(step), &air.states[step].values);
        let n_rows: Vec<usize> = problem.locks.iter().map(|seen| 2 * seen.lock.n_sticks()).collect();
        let n_all = n_rows.iter().sum();
        // All below one another: one product of large matrices is several times as quick as many of small ones.
        let mut said = Self {
            locks: Vec::with_capacity(n_rows.len()),
            weights: Vec::with_capacity(n_rows.len()),
            by_state: DMatrix::zeros(n_all, values.len()),
            by_constants: DMatrix::zeros(n_all, N_CONSTANTS),
            target: DVector::zeros(n_all),
            n_rows,
        };
        let mut first = 0;
        for (lock, n) in said.n_rows.iter().enumerate() {
            let balance = around.balance(problem, lock, step);
            let station = &around.stations[step][lock];
            let evidence = station.evidence(&balance, air, &now, slope, problem.session.body.friction);
            if let Some(evidence) = &evidence {
                let mut rows = said.by_state.rows_mut(first, *n);
                rows.gemm(1.0, &evidence.by_wind, &evidence.winds_by_state, 0.0);
                said.by_constants.rows_mut(first, *n).copy_from(&evidence.by_constants);
                let mut target = said.target.rows_mut(first, *n);
                target.gemv(
                    1.0,
                    &evidence.by_constants,
                    &DVector::from_column_slice(&balance.constants),
                    0.0,
                );
                target -= &evidence.moments;
            }
            said.weights.push(evidence.as_ref().map_or(0.0, |evidence| evidence.weight));
            said.locks.push(evidence.map(|evidence| LockSaid {
                square: evidence.moments.norm_squared(),
                touches: evidence.n_pushing > 0,
            }));
            first += n;
        }
        said.target.gemv(1.0, &said.by_state, values, 1.0);
        said
    }

    /// A number for each statement from one for each lock.
    fn by_row(&self, of_lock: impl Fn(usize) -> f64) -> DVector<f64> {
        let rows = self.n_rows.iter().enumerate();
        let repeated = rows.flat_map(|(lock, n)| core::iter::repeat_n(of_lock(lock), *n));
        DVector::from_iterator(self.target.len(), repeated)
    }

    /// What each says by itself.
    fn own(&self, counts: &Counts) -> Weighed {
        Weighed {
            weights: self.by_row(|lock| counts.own * self.weights[lock]),
            by_constants: self.by_constants.clone(),
            target: self.target.clone(),
        }
    }

    /// What its change to another step says: nothing where the body pushes, as that comes and goes.
    fn change(&self, other: &Self, counts: &Counts) -> Weighed {
        let weight = |lock: usize| match (&self.locks[lock], &other.locks[lock]) {
            (Some(a), Some(b)) if !a.touches && !b.touches => {
                counts.change * f64::min(self.weights[lock], other.weights[lock])
            }
            _ => 0.0,
        };
        Weighed {
            weights: self.by_row(weight),
            by_constants: &self.by_constants - &other.by_constants,
            target: &self.target - &other.target,
        }
    }

    /// What they say of the air, with their changes from the step before and to the one after; and of the constants, if locks differ.
    fn said(
        &self,
        before: Option<&Self>,
        after: Option<&Self>,
        counts: &Counts,
        locks_differ: bool,
    ) -> (Said, ConstantsAt) {
        let own = self.own(counts);
        let from_before = before.map(|before| self.change(before, counts));
        let to_after = after.map(|after| self.change(after, counts));
        let (mut weights, mut pull) = (own.weights.clone(), own.weights.component_mul(&own.target));
        for change in [&from_before, &to_after].into_iter().flatten() {
            weights += &change.weights;
            pull += change.weights.component_mul(&change.target);
        }
        // What is multiplied is turned first: the library's products of turned matrices are several times as slow.
        let turned = self.by_state.transpose();
        let with_before = before.zip(from_before.as_ref());
        let with_before =
            with_before.map(|(before, change)| weighed(&turned, &change.weights) * &before.by_state);
        let information = Triangle::of(&(weighed(&turned, &weights) * &self.by_state));
        let of_air = Said { information, vector: self.by_state.tr_mul(&pull), with_before };
        let of_constants = if locks_differ {
            self.of_constants(&turned, &own, from_before.as_ref(), to_after.as_ref())
        } else {
            ConstantsAt::default()
        };
        (of_air, of_constants)
    }

    /// What they say of the constants. A change between two steps is said of them by the later one, of them with the air by both.
    /// `by_state`: that of all statements, turned.
    fn of_constants(
        &self,
        by_state: &DMatrix<f64>,
        own: &Weighed,
        from_before: Option<&Weighed>,
        to_after: Option<&Weighed>,
    ) -> ConstantsAt {
        let n_all = self.n_rows.len() * N_CONSTANTS;
        let mut said = ConstantsAt {
            information: Vec::with_capacity(self.n_rows.len()),
            vector: DVector::zeros(n_all),
            with_air: DMatrix::zeros(by_state.nrows(), n_all),
        };
        let mut first = 0;
        for (lock, n) in self.n_rows.iter().enumerate() {
            let (mut information, at) = (DMatrix::zeros(N_CONSTANTS, N_CONSTANTS), lock * N_CONSTANTS);
            let mut with_state = DMatrix::zeros(*n, N_CONSTANTS);
            for term in [Some(own), from_before].into_iter().flatten() {
                let rows = term.by_constants.rows(first, *n);
                let counted = term.counted_constants(first, *n);
                information.gemm(1.0, &counted.transpose(), &rows, 1.0);
                let target = term.target.rows(first, *n);
                said.vector.rows_mut(at, N_CONSTANTS).gemv_tr(1.0, &counted, &target, 1.0);
                with_state += counted;
            }
            if let Some(term) = to_after {
                with_state += term.counted_constants(first, *n);
            }
            said.information.push(information);
            let by_state = by_state.columns(first, *n);
            said.with_air.columns_mut(at, N_CONSTANTS).gemm(1.0, &by_state, &with_state, 0.0);
            first += n;
        }
        said
    }
}

/// Statements, or their changes from one step to another.
struct Weighed {
    /// How much each counts.
    weights: DVector<f64>,
    by_constants: DMatrix<f64>,
    target: DVector<f64>,
}

impl Weighed {
    /// How some of them change with the constants, by how much they count.
    fn counted_constants(&self, first: usize, n: usize) -> DMatrix<f64> {
        let mut counted = self.by_constants.rows(first, n).into_owned();
        let weights = self.weights.rows(first, n);
        counted.column_iter_mut().for_each(|mut column| column.component_mul_assign(&weights));
        counted
    }
}

/// A matrix with its columns times some numbers.
fn weighed(matrix: &DMatrix<f64>, weights: &DVector<f64>) -> DMatrix<f64> {
    let mut weighed = matrix.clone();
    weighed.column_iter_mut().zip(weights).for_each(|(mut column, weight)| column *= *weight);
    weighed
}
