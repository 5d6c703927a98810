//! What all locks say of the air at every step, with errors that last.

use super::PhysicalOptions;
use super::constants::{ConstantsAt, N_CONSTANTS};
use super::evidence::Evidence;
use super::lock::SeenLock;
use super::moments::DragSlope;
use super::smoother::Said;
use super::solve::{Problem, Surroundings};
use super::triangle::Triangle;
use core::ops::Range;
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

/// How much a statement counts, as its error lasts: every step's own, and every change from step to step.
///
/// Of an error of variance 1 the share `f` is fleeting; of the rest a share `a` is left at the next step. In what stays the same it has
/// the power `s = (1 − f)(1 + a)/(1 − a) + f`, in what goes to and fro at every step `q = (1 − f)(1 − a)/(1 + a) + f`. Of the former a
/// statement's changes tell nothing, and of the latter they are twice its size: so each counts as it should if own ones count `1/s` and
/// changes `(1/q − 1/s)/4`. Without fleeting errors that is the precision matrix itself; with them what is in between counts less than it
/// could, by some two thirds at most. (Changes that count one and a half times or twice as much find the same wind.)
struct Counts {
    own: f64,
    change: f64,
}

impl Counts {
    fn of_steps(step_secs: f64, options: &PhysicalOptions) -> Self {
        let left = libm::exp(-step_secs / options.errors_last_secs);
        let lasting = 1.0 - options.fleeting_share;
        // Finer steps share what is fleeting, so that of each of them has to be larger.
        let fleeting = options.fleeting_share * f64::max(FLEETING_SECS / step_secs, 1.0);
        let slow = lasting * (1.0 + left) / (1.0 - left) + fleeting;
        let quick = lasting * (1.0 - left) / (1.0 + left) + fleeting;
        Self { own: 1.0 / slow, change: 0.25 * (1.0 / quick - 1.0 / slow) }
    }
}

/// What all locks say at a step, one statement below the other.
///
/// A lock's statements hang on the state by way of the wind at its places, which are fewer than they: so locks are summed up by
/// place, not by statement.
struct Statements {
    /// By lock; `None` if it says nothing.
    locks: Vec<Option<LockSaid>>,
    /// Where each lock's statements and winds stand.
    spans: Vec<Span>,
    /// How much each lock counts: 1, or less for an outlier.
    weights: Vec<f64>,
    /// By lock: how its statements change with the wind at its places.
    by_wind: Vec<DMatrix<f64>>,
    /// How all these winds change with the state, turned: a column for each wind.
    by_state: DMatrix<f64>,
    /// Each lock's by its own constants.
    by_constants: DMatrix<f64>,
    /// What `by_wind` times the winds and `by_constants` times the constants should be together.
    target: DVector<f64>,
}

/// What of a list is one lock's.
#[derive(Clone)]
struct Span {
    rows: Range<usize>,
    /// Three numbers for each of its wind places.
    winds: Range<usize>,
}

impl Span {
    /// Those of all locks.
    fn all(locks: &[SeenLock]) -> Vec<Self> {
        let (mut row, mut wind) = (0, 0);
        let span = |seen: &SeenLock| {
            let (rows, winds) =
                (row..row + 2 * seen.lock.n_sticks(), wind..wind + 3 * seen.wind_places_m.len());
            (row, wind) = (rows.end, winds.end);
            Self { rows, winds }
        };
        locks.iter().map(span).collect()
    }
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
        // Made anew each round: of a long capture those of all steps are as large as half of what the states need.
        let stations = around.stations_at(problem, &air.stream, step);
        let spans = Span::all(problem.locks);
        let (n_rows, n_winds) = spans.last().map_or((0, 0), |last| (last.rows.end, last.winds.end));
        let mut said = Self {
            locks: Vec::with_capacity(spans.len()),
            weights: Vec::with_capacity(spans.len()),
            by_wind: Vec::with_capacity(spans.len()),
            by_state: DMatrix::zeros(values.len(), n_winds),
            by_constants: DMatrix::zeros(n_rows, N_CONSTANTS),
            target: DVector::zeros(n_rows),
            spans,
        };
        for (lock, span) in said.spans.iter().enumerate() {
            let balance = around.balance(problem, lock, step);
            let station = &stations[lock];
            let n = values.len();
            let by_state = &mut said.by_state.as_mut_slice()[span.winds.start * n..span.winds.end * n];
            let evidence =
                station.evidence(&balance, air, &now, slope, problem.session.body.friction, by_state);
            let Some(Evidence { moments, by_wind, by_constants, weight, n_pushing }) = evidence else {
                // What it does not say may not be a number.
                said.by_state.columns_range_mut(span.winds.clone()).fill(0.0);
                said.by_wind.push(DMatrix::zeros(span.rows.len(), span.winds.len()));
                said.weights.push(0.0);
                said.locks.push(None);
                continue;
            };
            let mut target = said.target.rows_range_mut(span.rows.clone());
            target.gemv(1.0, &by_constants, &DVector::from_column_slice(&balance.constants), 0.0);
            target -= &moments;
            let by_state = said.by_state.columns_range(span.winds.clone());
            target.gemv(1.0, &by_wind, &by_state.tr_mul(values), 1.0);
            said.by_constants.rows_range_mut(span.rows.clone()).copy_from(&by_constants);
            said.by_wind.push(by_wind);
            said.weights.push(weight);
            said.locks.push(Some(LockSaid { square: moments.norm_squared(), touches: n_pushing > 0 }));
        }
        said
    }

    /// What each says by itself.
    fn own(&self, counts: &Counts) -> Weighed {
        Weighed {
            weights: self.weights.iter().map(|weight| counts.own * weight).collect(),
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
            weights: (0..self.locks.len()).map(weight).collect(),
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
        let mut weights = own.weights.clone();
        let mut pull = DVector::zeros(self.by_state.ncols());
        for (lock, span) in self.spans.iter().enumerate() {
            let mut of_lock = own.target.rows_range(span.rows.clone()) * own.weights[lock];
            for change in [&from_before, &to_after].into_iter().flatten() {
                weights[lock] += change.weights[lock];
                of_lock.axpy(change.weights[lock], &change.target.rows_range(span.rows.clone()), 1.0);
            }
            pull.rows_range_mut(span.winds.clone()).gemv_tr(1.0, &self.by_wind[lock], &of_lock, 0.0);
        }
        let with_before = before.zip(from_before.as_ref());
        let with_before =
            with_before.map(|(before, change)| &self.by_state * self.counted(before, &change.weights));
        let information = Triangle::of_product(&self.by_state, &self.counted(self, &weights));
        let of_air = Said { information, vector: &self.by_state * pull, with_before };
        let of_constants = if locks_differ {
            self.of_constants(&own, from_before.as_ref(), to_after.as_ref())
        } else {
            ConstantsAt::default()
        };
        (of_air, of_constants)
    }

    /// The statements' change with their winds, turned, times another's with the state, by how much locks count.
    fn counted(&self, other: &Self, weights: &[f64]) -> DMatrix<f64> {
        let mut counted = DMatrix::zeros(self.by_state.ncols(), self.by_state.nrows());
        // The library's products of turned matrices are several times as slow.
        let by_state = other.by_state.transpose();
        for (lock, span) in self.spans.iter().enumerate() {
            let of_winds = self.by_wind[lock].transpose() * &other.by_wind[lock];
            let by_state = by_state.rows_range(span.winds.clone());
            counted.rows_range_mut(span.winds.clone()).gemm(weights[lock], &of_winds, &by_state, 0.0);
        }
        counted
    }

    /// What they say of the constants. A change between two steps is said of them by the later one, of them with the air by both.
    fn of_constants(
        &self,
        own: &Weighed,
        from_before: Option<&Weighed>,
        to_after: Option<&Weighed>,
    ) -> ConstantsAt {
        let n_all = self.spans.len() * N_CONSTANTS;
        let mut said = ConstantsAt {
            information: Vec::with_capacity(self.spans.len()),
            vector: DVector::zeros(n_all),
            with_air: DMatrix::zeros(self.by_state.nrows(), n_all),
        };
        for (lock, Span { rows, winds }) in self.spans.iter().enumerate() {
            let (mut information, at) = (DMatrix::zeros(N_CONSTANTS, N_CONSTANTS), lock * N_CONSTANTS);
            let mut with_winds = DMatrix::zeros(rows.len(), N_CONSTANTS);
            for term in [Some(own), from_before].into_iter().flatten() {
                let by_constants = term.by_constants.rows_range(rows.clone());
                let counted = by_constants * term.weights[lock];
                information.gemm(1.0, &counted.transpose(), &by_constants, 1.0);
                let target = term.target.rows_range(rows.clone());
                said.vector.rows_mut(at, N_CONSTANTS).gemv_tr(1.0, &counted, &target, 1.0);
                with_winds += counted;
            }
            if let Some(term) = to_after {
                with_winds += term.by_constants.rows_range(rows.clone()) * term.weights[lock];
            }
            said.information.push(information);
            let by_state = self.by_state.columns_range(winds.clone());
            let with_winds = self.by_wind[lock].transpose() * with_winds;
            said.with_air.columns_mut(at, N_CONSTANTS).gemm(1.0, &by_state, &with_winds, 0.0);
        }
        said
    }
}

/// Statements, or their changes from one step to another.
struct Weighed {
    /// How much each lock's count.
    weights: Vec<f64>,
    by_constants: DMatrix<f64>,
    target: DVector<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    const N_STEPS: usize = 240;

    /// The precision with which errors of these options tell what has this shape over time, from their covariance.
    fn told(options: &PhysicalOptions, step_secs: f64, shape: impl Fn(usize) -> f64) -> f64 {
        let covariance = DMatrix::from_fn(N_STEPS, N_STEPS, |a, b| {
            let lasts = libm::exp(-(a.abs_diff(b) as f64) * step_secs / options.errors_last_secs);
            let fleeting = if a == b { options.fleeting_share } else { 0.0 };
            (1.0 - options.fleeting_share) * lasts + fleeting
        });
        let shape = DVector::from_fn(N_STEPS, |k, _| shape(k));
        covariance.cholesky().unwrap().solve(&shape).dot(&shape)
    }

    /// What stays, and what goes to and fro, counts as by the covariance of the errors, and what is between never more.
    #[test]
    fn statements_count_as_their_errors_last() {
        for (step_secs, fleeting_share) in
            [(0.1, 0.5), (1.0 / 30.0, 0.5), (1.0 / 30.0, 0.3), (1.0 / 30.0, 0.0)]
        {
            let options = PhysicalOptions { fleeting_share, ..PhysicalOptions::default() };
            let counts = Counts::of_steps(step_secs, &options);
            let counted = |shape: &dyn Fn(usize) -> f64| {
                let own: f64 = (0..N_STEPS).map(|k| shape(k).powi(2)).sum();
                let change: f64 = (1..N_STEPS).map(|k| (shape(k) - shape(k - 1)).powi(2)).sum();
                (counts.own * own + counts.change * change) / told(&options, step_secs, shape)
            };
            let share = 1.0 / N_STEPS as f64;
            let slow = counted(&|k| libm::sin(core::f64::consts::PI * k as f64 * share));
            let quick = counted(&|k| if k % 2 == 0 { 1.0 } else { -1.0 });
            let between = counted(&|k| libm::sin(0.6 * k as f64));
            assert!((slow - 1.0).abs() < 0.05 && (quick - 1.0).abs() < 0.05, "{slow} {quick}");
            let least = if fleeting_share > 0.0 { 0.3 } else { 0.98 };
            assert!((least..1.02).contains(&between), "{between} with {fleeting_share}");
        }
    }

    /// Errors that last count as much in a tenth of a second of fine steps as of coarse ones.
    #[test]
    fn finer_steps_tell_no_more_of_what_lasts() {
        let told = |rate_hz: f64| {
            let counts = Counts::of_steps(1.0 / rate_hz, &PhysicalOptions::default());
            counts.own * rate_hz
        };
        assert!((told(120.0) / told(30.0) - 1.0).abs() < 0.05, "{} {}", told(30.0), told(120.0));
    }
}
