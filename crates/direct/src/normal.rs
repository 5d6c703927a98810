//! Least squares, damped.

use nalgebra::{Cholesky, DMatrix, DVector};
use tousle_core::Vec3;

/// Rows that shall become least, in the linear picture.
pub(crate) struct Normal {
    /// The rows that change with anything. Most do not: they are of peaks that are far from what they may be.
    felt: Vec<usize>,
    /// `J` of these rows, weighed.
    weighed: DMatrix<f64>,
    /// What they count.
    weights: DVector<f64>,
    /// `JᵀJ`.
    matrix: DMatrix<f64>,
    /// `Jᵀ rows`.
    gradient: DVector<f64>,
}

impl Normal {
    /// Of rows that count by weights, and how they change.
    pub(crate) fn new(jacobian: &DMatrix<f64>, rows: &DVector<f64>, weights: &DVector<f64>) -> Self {
        // Sums of absolute values hear of a number that is none, and are made side by side.
        let mut changes = vec![0.0; jacobian.nrows()];
        for column in jacobian.column_iter() {
            changes.iter_mut().zip(column.iter()).for_each(|(sum, change)| *sum += change.abs());
        }
        let felt: Vec<usize> = (0..jacobian.nrows()).filter(|row| changes[*row] != 0.0).collect();
        let weights = weights.select_rows(&felt);
        // Column by column, as they lie in memory.
        let columns = jacobian.column_iter().flat_map(|column| {
            felt.iter().zip(weights.iter()).map(move |(row, weight)| column[*row] * weight)
        });
        let weighed = DMatrix::from_iterator(felt.len(), jacobian.ncols(), columns);
        let gradient = weighed.tr_mul(&rows.select_rows(&felt).component_mul(&weights));
        // By the library's blocked product, which its `tr_mul` is not.
        let matrix = weighed.transpose() * &weighed;
        Self { felt, weighed, weights, matrix, gradient }
    }

    /// The step that makes the rows least: `−(JᵀJ + λ diag JᵀJ)⁻¹ Jᵀ rows` (Marquardt 1963).
    ///
    /// Zero if the normal matrix has no inverse even so.
    pub(crate) fn step(&self, damping: f64) -> DVector<f64> {
        self.solve(damping, &self.gradient)
    }

    /// What is added to a step to stay on the curve on which rows change along it: `−½ (JᵀJ + λ diag JᵀJ)⁻¹ Jᵀ second`, no
    /// longer than the step.
    ///
    /// `second`: the second derivative of the rows along the step. Source: geodesic acceleration (Transtrum and Sethna 2012).
    pub(crate) fn curve(&self, damping: f64, step: &DVector<f64>, second: &DVector<f64>) -> DVector<f64> {
        let added = self.solve(
            damping,
            &self.weighed.tr_mul(&second.select_rows(&self.felt).component_mul(&self.weights)),
        ) * 0.5;
        let most = step.norm();
        if added.norm() > most { added.normalize() * most } else { added }
    }

    fn solve(&self, damping: f64, gradient: &DVector<f64>) -> DVector<f64> {
        let mut normal = self.matrix.clone();
        let largest = normal.diagonal().max();
        for k in 0..normal.nrows() {
            // What nothing depends on stays where it is.
            normal[(k, k)] += damping * normal[(k, k)] + 1e-12 * largest;
        }
        let nothing = || DVector::zeros(gradient.len());
        Cholesky::new(normal).map_or_else(nothing, |normal| -normal.solve(gradient))
    }
}

/// A Jacobian that says of a step what it did to the rows, and of steps across it what it said before (Broyden 1965).
pub(crate) fn updated(mut jacobian: DMatrix<f64>, step: &DVector<f64>, did: &DVector<f64>) -> DMatrix<f64> {
    let unforeseen = did - &jacobian * step;
    jacobian.ger(1.0 / step.norm_squared().max(f64::MIN_POSITIVE), &unforeseen, step, 1.0);
    jacobian
}

/// The way from some vectors to others, component after component.
pub(crate) fn between(before: &[Vec3], after: &[Vec3]) -> DVector<f64> {
    let moved = after.iter().zip(before).flat_map(|(a, b)| <[f64; 3]>::from(a - b));
    DVector::from_iterator(3 * before.len(), moved)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line through (0, 1), (1, 3), (2, 5) from (0, 0): 1 and 2, at once.
    #[test]
    fn a_line_is_found_in_one_step() {
        let jacobian = DMatrix::from_row_slice(3, 2, &[1.0, 0.0, 1.0, 1.0, 1.0, 2.0]);
        let found =
            Normal::new(&jacobian, &DVector::from_vec(vec![-1.0, -3.0, -5.0]), &DVector::repeat(3, 2.0))
                .step(0.0);
        assert!((found - DVector::from_vec(vec![1.0, 2.0])).norm() < 1e-9);
    }

    /// Of x² − 4 the step from 1 is 1.5, which goes too far; 1 would be right.
    #[test]
    fn a_curve_is_followed() {
        let (jacobian, rows) = (DMatrix::from_element(1, 1, 2.0), DVector::from_element(1, -3.0));
        let normal = Normal::new(&jacobian, &rows, &DVector::repeat(1, 3.0));
        let step = normal.step(0.0);
        assert!((step[0] - 1.5).abs() < 1e-9, "{step}");
        let second = DVector::from_element(1, 2.0 * step[0] * step[0]);
        let added = normal.curve(0.0, &step, &second);
        assert!((added[0] + 0.5 * second[0] / 2.0).abs() < 1e-9, "{added}");
    }

    /// A row that is nowhere is not left out as if nothing changed it: it leads to no step.
    #[test]
    fn what_is_no_number_leads_nowhere() {
        let jacobian = DMatrix::from_row_slice(2, 1, &[1.0, f64::NAN]);
        let normal = Normal::new(&jacobian, &DVector::from_element(2, 1.0), &DVector::repeat(2, 1.0));
        assert_eq!(normal.step(1e-3), DVector::zeros(1));
    }

    #[test]
    fn an_update_foretells_the_step_that_was_made() {
        let jacobian = DMatrix::from_row_slice(2, 3, &[1.0, 0.0, 2.0, 0.0, 1.0, 0.0]);
        let (step, did) = (between(&[Vec3::x()], &[Vec3::y()]), DVector::from_vec(vec![3.0, -1.0]));
        let updated = updated(jacobian.clone(), &step, &did);
        assert!((&updated * step - did).norm() < 1e-12);
        let across = DVector::from_vec(vec![2.0, 2.0, 5.0]);
        assert!((updated * &across - jacobian * across).norm() < 1e-12);
    }
}
