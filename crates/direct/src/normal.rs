//! Least squares, damped.

use nalgebra::{Cholesky, DMatrix, DVector};

/// The step that makes the rows least, in the linear picture: `−(JᵀJ + λ diag JᵀJ)⁻¹ Jᵀ rows` (Marquardt 1963).
///
/// Zero if the normal matrix has no inverse even so.
pub(crate) fn step(jacobian: &DMatrix<f64>, rows: &DVector<f64>, damping: f64) -> DVector<f64> {
    let mut normal = jacobian.tr_mul(jacobian);
    let largest = normal.diagonal().max();
    for k in 0..normal.nrows() {
        // What nothing depends on stays where it is.
        normal[(k, k)] += damping * normal[(k, k)] + 1e-12 * largest;
    }
    let gradient = jacobian.tr_mul(rows);
    Cholesky::new(normal).map_or_else(|| DVector::zeros(gradient.len()), |normal| -normal.solve(&gradient))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line through (0, 1), (1, 3), (2, 5) from (0, 0): 1 and 2, at once.
    #[test]
    fn a_line_is_found_in_one_step() {
        let jacobian = DMatrix::from_row_slice(3, 2, &[1.0, 0.0, 1.0, 1.0, 1.0, 2.0]);
        let found = step(&jacobian, &DVector::from_vec(vec![-1.0, -3.0, -5.0]), 0.0);
        assert!((found - DVector::from_vec(vec![1.0, 2.0])).norm() < 1e-9);
    }
}
