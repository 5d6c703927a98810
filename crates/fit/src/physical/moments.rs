//! The balance of moments at a lock's joints, and how it changes with the wind along the lock.

use super::constants::{Constants, N_CONSTANTS, bend_column, bend_places, bend_share};
use super::lock::{LockAt, SeenLock};
use super::taught::{DefectAt, Scales};
use nalgebra::{DMatrix, DVector, Matrix3};
use tousle_core::Vec3;
use tousle_rod::{DragLaw, Rest};

/// What is not balanced at a lock's joints in a given wind: two numbers a joint, across its stick, N·m.
pub(crate) struct Imbalance {
    /// By joint, root first.
    pub(crate) moments: DVector<f64>,
    /// Its change with the wind at the lock's wind places, three columns each, N·m per m/s.
    pub(crate) by_wind: DMatrix<f64>,
    /// Its change with the lock's constants.
    pub(crate) by_constants: DMatrix<f64>,
}

/// How drag follows the wind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum DragSlope {
    /// By the law itself.
    Tangent,
    /// As if it were that of a wind at least so fast, m/s, and grew in proportion: for a first guess from nowhere.
    Secant(f64),
}

/// Two unit vectors across a direction.
pub(crate) fn across(direction: Vec3) -> [Vec3; 2] {
    let axis = if direction.x.abs() < 0.6 { Vec3::x() } else { Vec3::y() };
    let first = direction.cross(&axis).normalize();
    [first, direction.cross(&first)]
}

/// A lock at a step, with its mechanics.
pub(crate) struct Balance<'a> {
    pub(crate) seen: &'a SeenLock,
    pub(crate) step: usize,
    /// Time from step to step, s.
    pub(crate) step_secs: f64,
    /// What its joints hold at rest; `None` where nobody saw it at rest.
    pub(crate) rest: Option<&'a Rest>,
    pub(crate) law: &'a DragLaw,
    pub(crate) scales: Scales,
    /// What it is off by, as far as is known.
    pub(crate) constants: Constants,
    /// How many times as stiff as is likely it is for what errors of its bends make of its moments.
    pub(crate) error_stiffness: f64,
    /// Error of a joint's bend, rad.
    pub(crate) bend_error_rad: f64,
    /// What the balance is known to leave over.
    pub(crate) defect: Option<&'a DefectAt>,
}

impl Balance<'_> {
    /// The imbalance in the wind `winds`, head axes, m/s, one for each stick's middle.
    ///
    /// For each joint the moments about it of everything further out add up to nothing: weight less inertia, drag, and what
    /// the joint itself holds. There is no tension in it, and no derivative along the lock but the joint's own bend.
    pub(crate) fn imbalance(&self, winds: &[Vec3], slope: DragSlope) -> Imbalance {
        let &Self { seen, step, step_secs, rest, law, scales, defect, ref constants, .. } = self;
        let (lock, at) = (&seen.lock, &seen.steps[step]);
        let n = lock.n_sticks();
        let mut moments = DVector::zeros(2 * n);
        let mut by_wind = DMatrix::zeros(2 * n, 3 * seen.wind_places_m.len());
        let mut by_constants = DMatrix::zeros(2 * n, N_CONSTANTS);
        // By wind place, the change of the moment about the joint and of the pull on it.
        let n_places = seen.wind_places_m.len();
        let mut moment_by_wind = vec![Matrix3::zeros(); n_places];
        let mut pull_by_wind = vec![Matrix3::zeros(); n_places];
        let (mut moment, mut pull) = (Vec3::zeros(), Vec3::zeros());
        // Of the drag alone.
        let (mut drag_moment, mut drag_pull) = (Vec3::zeros(), Vec3::zeros());
        for j in (0..n).rev() {
            let lever = at.directions[j] * lock.lengths_m[j];
            pull += at.pulls[j] * lock.masses_kg[j];
            moment += lever.cross(&pull);
            drag_moment += lever.cross(&drag_pull);
            let crossing = lever.cross_matrix();
            for (m, p) in moment_by_wind.iter_mut().zip(&pull_by_wind) {
                *m += crossing * p;
            }
            let (drag, change) = drag(seen, at, j, law, winds[j], slope);
            let (drag, change) = (drag * scales.drag, change * scales.drag);
            let drags = (lever * 0.5).cross(&drag);
            moment += drags;
            pull += drag;
            drag_moment += drags;
            drag_pull += drag;
            let middle_m = lock.arcs_m[j] - 0.5 * lock.lengths_m[j];
            for (place, share) in seen.wind_share(middle_m) {
                moment_by_wind[place] += crossing * change * (0.5 * share);
                pull_by_wind[place] += change * share;
            }
            let bending = bending(seen, step, j, step_secs) * scales.stiffness;
            let at_rest = rest.map_or_else(Vec3::zeros, |rest| at.turned[j] * rest.torques[j]);
            let defect = defect.map_or_else(Vec3::zeros, |defect| defect.at(j, at.directions[j]));
            let total = moment + at_rest + bending - defect;
            let stiffness = lock.joint_stiffness[j] * scales.stiffness;
            let share = (lock.arcs_m[j] - lock.lengths_m[j]) / lock.arcs_m[n - 1];
            for (row, axis) in at.across[j].iter().enumerate() {
                let row_of = 2 * j + row;
                by_constants[(row_of, 0)] = axis.dot(&bending);
                by_constants[(row_of, 1)] = axis.dot(&drag_moment);
                for place in bend_places() {
                    by_constants[(row_of, bend_column(place, row))] = stiffness * bend_share(place, share);
                }
                moments[row_of] = axis.dot(&total);
                for (place, m) in moment_by_wind.iter().enumerate() {
                    let change = m.tr_mul(axis);
                    for c in 0..3 {
                        by_wind[(row_of, 3 * place + c)] = change[c];
                    }
                }
            }
        }
        moments += &by_constants * DVector::from_column_slice(constants);
        Imbalance { moments, by_wind, by_constants }
    }
}

/// The air's force on a stick and its change with the wind.
fn drag(
    seen: &SeenLock,
    at: &LockAt,
    j: usize,
    law: &DragLaw,
    wind: Vec3,
    slope: DragSlope,
) -> (Vec3, Matrix3<f64>) {
    let (width, length, tangent) = (seen.lock.width_m, seen.lock.hair_lengths_m[j], at.directions[j]);
    let relative = wind - at.velocities[j];
    match slope {
        DragSlope::Tangent => {
            let drag = law.at(width, tangent, relative);
            // In still air a lock is pushed by nothing and by nothing's change: a breath lets the solver leave it.
            let breath = law.across(width, 0.2);
            let columns = [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| drag.change(tangent, axis) * length);
            let mut change = Matrix3::from_columns(&columns);
            if drag.across < breath {
                change +=
                    (Matrix3::identity() - tangent * tangent.transpose()) * ((breath - drag.across) * length);
            }
            (drag.force * length, change)
        }
        DragSlope::Secant(least) => {
            let along = tangent * relative.dot(&tangent);
            let across = law.across(width, f64::max((relative - along).norm(), least));
            let change = (Matrix3::identity() - tangent * tangent.transpose()) * (across * length);
            (change * relative, change)
        }
    }
}

/// What a joint does against being bent since rest, and against its rate.
fn bending(seen: &SeenLock, step: usize, j: usize, step_secs: f64) -> Vec3 {
    let (lock, at) = (&seen.lock, &seen.steps[step]);
    let (before, after) = (step.saturating_sub(1), (step + 1).min(seen.steps.len() - 1));
    let span_secs = step_secs * (after - before).max(1) as f64;
    // A bend that goes round with what the joint hangs on has no rate.
    let carried = |k: usize| at.turned[j] * (seen.steps[k].turned[j].inverse() * seen.steps[k].bends[j]);
    let rate = (carried(after) - carried(before)) / span_secs;
    (at.bends[j] + rate * lock.damping_secs) * -lock.joint_stiffness[j]
}
