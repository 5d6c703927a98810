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

/// Steps that are asked together: of those at either end neighbors are asked as well.
const ASKED_TOGETHER: usize = 12;

/// What the locks say at all steps, made linear in the state of the air.
pub(crate) fn ask(
    problem: &Problem<'_>,
    around: &Surroundings,
    air: &AirFlow,
    slope: DragSlope,
) -> Vec<StepSaid> {
    let n_steps = problem.clock.n_steps;
    let counts = Counts::of_steps(1.0 / problem.clock.rate_hz, problem.options);
    let of_chunk = |chunk: usize| {
        let first = chunk * ASKED_TOGETHER;
        let end = (first + ASKED_TOGETHER).min(n_steps);
        let from = first.saturating_sub(1);
        let all: Vec<Statements> = (from..(end + 1).min(n_steps))
            .map(|step| Statements::of(problem, around, air, step, slope))
            .collect();
        let said = |step: usize| {
            let at = step - from;
            let before = at.checked_sub(1).map(|k| &all[k]);
            let of_locks = all[at].locks.iter().map(|lock| lock.unwrap_or_default()).collect();
            let (of_air, constants) = all[at].said(before, all.get(at + 1), &counts);
            let of_constants = if problem.options.locks_differ {
                all[at].of_constants(before, &counts, &constants)
            } else {
                ConstantsAt::default()
            };
            StepSaid { of_locks, of_air, of_constants }
        };
        (first..end).map(said).collect::<Vec<_>>()
    };
    (0..n_steps.div_ceil(ASKED_TOGETHER)).into_par_iter().flat_map_iter(of_chunk).collect()
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

    /// How much the changes to another step count: nothing where the body pushes, as that comes and goes.
    fn changes(&self, other: &Self, counts: &Counts) -> DVector<f64> {
        self.by_row(|lock| match (&self.locks[lock], &other.locks[lock]) {
            (Some(a), Some(b)) if !a.touches && !b.touches => {
                counts.change * f64::min(self.weights[lock], other.weights[lock])
            }
            _ => 0.0,
        })
    }

    /// What they say of the air, with their changes from the step before and to the one after; and how each statement's constants
    /// stand with this step's state.
    fn said(&self, before: Option<&Self>, after: Option<&Self>, counts: &Counts) -> (Said, DMatrix<f64>) {
        let mut weights = self.by_row(|lock| counts.own * self.weights[lock]);
        let mut pull = weights.component_mul(&self.target);
        let mut constants = scaled(&self.by_constants, &weights);
        let mut add = |other: &Self| {
            let changes = self.changes(other, counts);
            pull += changes.component_mul(&(&self.target - &other.target));
            constants += scaled(&(&self.by_constants - &other.by_constants), &changes);
            weights += &changes;
            changes
        };
        let with_before =
            before.map(|before| scaled(&self.by_state, &add(before)).transpose() * &before.by_state);
        if let Some(after) = after {
            add(after);
        }
        let turned = scaled(&self.by_state, &weights).transpose();
        let information = Triangle::of(&(turned * &self.by_state));
        let of_air = Said { information, vector: self.by_state.tr_mul(&pull), with_before };
        (of_air, constants)
    }

    /// What they say of the constants, with their changes from the step before. `weighted`: as [`Self::said`] tells.
    fn of_constants(&self, before: Option<&Self>, counts: &Counts, weighted: &DMatrix<f64>) -> ConstantsAt {
        let n_all = self.n_rows.len() * N_CONSTANTS;
        let mut said = ConstantsAt {
            information: Vec::with_capacity(self.n_rows.len()),
            vector: DVector::zeros(n_all),
            with_air: DMatrix::zeros(self.by_state.ncols(), n_all),
        };
        let own = self.by_row(|lock| counts.own * self.weights[lock]);
        let changes = before.map(|before| {
            let (by_constants, target) =
                (&self.by_constants - &before.by_constants, &self.target - &before.target);
            (by_constants, target, self.changes(before, counts))
        });
        let terms =
            [Some((&self.by_constants, &self.target, &own)), changes.as_ref().map(|(b, t, w)| (b, t, w))];
        let mut first = 0;
        for (lock, n) in self.n_rows.iter().enumerate() {
            let (mut information, at) = (DMatrix::zeros(N_CONSTANTS, N_CONSTANTS), lock * N_CONSTANTS);
            for (by_constants, target, weights) in terms.iter().flatten() {
                let rows = by_constants.rows(first, *n);
                let turned = scaled(&rows.into_owned(), &weights.rows(first, *n).into_owned()).transpose();
                information.gemm(1.0, &turned, &rows, 1.0);
                said.vector.rows_mut(at, N_CONSTANTS).gemv(1.0, &turned, &target.rows(first, *n), 1.0);
            }
            said.information.push(information);
            let (by_state, weighted) = (self.by_state.rows(first, *n), weighted.rows(first, *n));
            said.with_air.columns_mut(at, N_CONSTANTS).gemm_tr(1.0, &by_state, &weighted, 0.0);
            first += n;
        }
        said
    }
}

/// A matrix with its rows times some numbers.
fn scaled(matrix: &DMatrix<f64>, by_row: &DVector<f64>) -> DMatrix<f64> {
    let mut scaled = matrix.clone();
    scaled.column_iter_mut().for_each(|mut column| column.component_mul_assign(by_row));
    scaled
}
