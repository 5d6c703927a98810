//! The lower half of a square matrix.

use core::ops::{AddAssign, Range, SubAssign};
use nalgebra::{DMatrix, DVector};

/// A lower triangle, row after row up to the diagonal: of a symmetric matrix all that is to be kept, of a factor all there is.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Triangle {
    n: usize,
    rows: Vec<f64>,
}

/// Columns of a symmetric product that are found at once: above their diagonal half a band is found in vain.
const BAND: usize = 32;

/// Columns that are solved for at once.
const TOGETHER: usize = 8;

/// The inverse of the lower Cholesky factor of a matrix, whose upper half is not read; `None` if it is not positive.
///
/// Its own turned self times it is the matrix's inverse. By halves, so that nearly all of it is products of matrices, and what is
/// solved with the factor is one more: they fill the processor's registers, solving number by number does not.
pub(crate) fn inverse_factor(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = matrix.nrows();
    if n <= WHOLE {
        let factor = matrix.clone().cholesky()?;
        return Some(Triangle::of(factor.l_dirty()).solve(&DMatrix::identity(n, n)));
    }
    let half = n.div_ceil(2).next_multiple_of(8);
    let upper = inverse_factor(&matrix.view_range(..half, ..half).into_owned())?;
    let between = matrix.view_range(half.., ..half) * upper.transpose();
    let mut left = matrix.view_range(half.., half..).into_owned();
    left.gemm(-1.0, &between, &between.transpose(), 1.0);
    let lower = inverse_factor(&left)?;
    let mut inverse = DMatrix::zeros(n, n);
    inverse.view_range_mut(half.., ..half).gemm(-1.0, &lower, &(between * &upper), 0.0);
    inverse.view_range_mut(..half, ..half).copy_from(&upper);
    inverse.view_range_mut(half.., half..).copy_from(&lower);
    Some(inverse)
}

/// Numbers up to which a factor is found as a whole.
const WHOLE: usize = 32;

fn bands(n: usize) -> impl Iterator<Item = Range<usize>> {
    (0..n).step_by(BAND).map(move |first| first..(first + BAND).min(n))
}

impl Triangle {
    pub(crate) fn zeros(n: usize) -> Self {
        Self { n, rows: vec![0.0; n * (n + 1) / 2] }
    }

    /// That of a square matrix; what is above is not read.
    pub(crate) fn of(matrix: &DMatrix<f64>) -> Self {
        let n = matrix.nrows();
        let rows = (0..n).flat_map(|r| (0..=r).map(move |c| matrix[(r, c)])).collect();
        Self { n, rows }
    }

    /// That of a product which is symmetric.
    pub(crate) fn of_product(left: &DMatrix<f64>, right: &DMatrix<f64>) -> Self {
        let n = left.nrows();
        let mut product = DMatrix::zeros(n, n);
        for band in bands(n) {
            let (left, right) = (left.rows_range(band.start..), right.columns_range(band.clone()));
            product.view_range_mut(band.start.., band).gemm(1.0, &left, &right, 0.0);
        }
        Self::of(&product)
    }

    /// Of a lower triangle: that of itself, turned, times itself.
    pub(crate) fn of_square(lower: &DMatrix<f64>) -> Self {
        let n = lower.nrows();
        let mut square = DMatrix::zeros(n, n);
        for band in bands(n) {
            // Rows above the band's have nothing in its columns.
            let below = lower.rows_range(band.start..);
            let turned = below.columns_range(band.start..).transpose();
            let below = below.columns_range(band.clone());
            square.view_range_mut(band.start.., band).gemm(1.0, &turned, &below, 0.0);
        }
        Self::of(&square)
    }

    /// The symmetric matrix.
    pub(crate) fn symmetric(&self) -> DMatrix<f64> {
        let mut matrix = self.matrix();
        matrix.fill_upper_triangle_with_lower_triangle();
        matrix
    }

    /// The matrix, with zeros above.
    pub(crate) fn matrix(&self) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.n, self.n);
        for r in 0..self.n {
            for (c, value) in self.row(r).iter().enumerate() {
                matrix[(r, c)] = *value;
            }
        }
        matrix
    }

    /// Adds to a number; none is above the diagonal.
    pub(crate) fn add(&mut self, row: usize, column: usize, value: f64) {
        self.rows[row * (row + 1) / 2..][..=row][column] += value;
    }

    /// A factor's inverse times some columns.
    pub(crate) fn solve(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        self.solved(columns, false)
    }

    /// The inverse of a factor, turned, times some columns.
    pub(crate) fn solve_turned(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        self.solved(columns, true)
    }

    /// A factor's inverse times a column.
    pub(crate) fn solve_column(&self, column: &DVector<f64>) -> DVector<f64> {
        let mut solved = column.clone();
        self.solve_beside::<1>(solved.as_mut_slice(), false);
        solved
    }

    fn solved(&self, columns: &DMatrix<f64>, is_turned: bool) -> DMatrix<f64> {
        let mut solved = columns.clone();
        for some in solved.as_mut_slice().chunks_mut(TOGETHER * self.n.max(1)) {
            match some.len() / self.n {
                ..3 => self.solve_beside::<2>(some, is_turned),
                _ => self.solve_beside::<TOGETHER>(some, is_turned),
            }
        }
        solved
    }

    /// Solves for at most `N` columns, which follow one another. Beside one another each number of the factor is read once for
    /// all of them; each column's own sums are taken in the same order, however many are beside it.
    fn solve_beside<const N: usize>(&self, columns: &mut [f64], is_turned: bool) {
        let mut beside = vec![[0.0; N]; self.n];
        for (k, column) in columns.chunks_exact(self.n).enumerate() {
            beside.iter_mut().zip(column).for_each(|(row, value)| row[k] = *value);
        }
        if is_turned {
            self.last_to_first(&mut beside);
        } else {
            self.first_to_last(&mut beside);
        }
        for (k, column) in columns.chunks_exact_mut(self.n).enumerate() {
            beside.iter().zip(column).for_each(|(row, value)| *value = row[k]);
        }
    }

    fn first_to_last<const N: usize>(&self, beside: &mut [[f64; N]]) {
        // Before the first number there is nothing to take off.
        let first = beside.iter().position(|row| *row != [0.0; N]).unwrap_or(self.n);
        for r in first..self.n {
            let (solved, rest) = beside.split_at_mut(r);
            let (row, mut left) = (self.row(r), rest[0]);
            for (factor, solved) in row[first..].iter().zip(&solved[first..]) {
                left.iter_mut().zip(solved).for_each(|(left, solved)| *left -= factor * *solved);
            }
            rest[0] = left.map(|left| left / row[r]);
        }
    }

    fn last_to_first<const N: usize>(&self, beside: &mut [[f64; N]]) {
        for r in (0..self.n).rev() {
            let (rest, solved) = beside.split_at_mut(r);
            let row = self.row(r);
            let own = solved[0].map(|left| left / row[r]);
            solved[0] = own;
            for (factor, rest) in row.iter().zip(rest) {
                rest.iter_mut().zip(own).for_each(|(left, own)| *left -= factor * own);
            }
        }
    }

    /// A factor times a column.
    pub(crate) fn times(&self, column: &DVector<f64>) -> DVector<f64> {
        let product = |r: usize| self.row(r).iter().zip(column).fold(0.0, |sum, (f, v)| sum + f * v);
        DVector::from_fn(self.n, |r, _| product(r))
    }

    fn row(&self, r: usize) -> &[f64] {
        &self.rows[r * (r + 1) / 2..][..=r]
    }
}

/// One of fewer rows is added to the first ones.
impl AddAssign<&Self> for Triangle {
    fn add_assign(&mut self, other: &Self) {
        self.rows.iter_mut().zip(&other.rows).for_each(|(value, more)| *value += more);
    }
}

impl SubAssign<&Self> for Triangle {
    fn sub_assign(&mut self, other: &Self) {
        self.rows.iter_mut().zip(&other.rows).for_each(|(value, less)| *value -= less);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> DMatrix<f64> {
        DMatrix::from_fn(5, 5, |r, c| if r == c { 3.0 } else { 0.1 * (r + 2 * c) as f64 })
    }

    /// The lower half comes back, with what was added to it.
    #[test]
    fn it_is_the_lower_half() {
        let mut triangle = Triangle::of(&square());
        assert_eq!(triangle.matrix(), square().lower_triangle());
        triangle += &Triangle::of(&DMatrix::from_element(2, 2, 1.0));
        triangle.add(4, 3, 1.0);
        let mut expected = square().lower_triangle();
        for (r, c) in [(0, 0), (1, 0), (1, 1), (4, 3)] {
            expected[(r, c)] += 1.0;
        }
        assert_eq!(triangle.matrix(), expected);
        triangle -= &Triangle::of(&expected);
        assert_eq!(triangle, Triangle::zeros(5));
    }

    /// However many columns are solved for at once, the answers are the ones of the whole matrix, to the last digit.
    #[test]
    fn it_solves_as_the_whole_matrix_does() {
        let triangle = Triangle::of(&square());
        let columns = DMatrix::from_fn(5, 19, |r, c| (7 * r + 3 * c) as f64 / 11.0 - 1.0);
        let expected = square().solve_lower_triangular(&columns).unwrap();
        assert_eq!(triangle.solve(&columns), expected);
        for n_columns in 1..19 {
            let some = columns.columns(0, n_columns).into_owned();
            assert_eq!(triangle.solve(&some), expected.columns(0, n_columns));
        }
        for (column, expected) in columns.column_iter().zip(expected.column_iter()) {
            let solved = triangle.solve_column(&column.into_owned());
            assert_eq!(solved, expected);
            assert!((triangle.times(&solved) - column).amax() < 1e-12);
        }
    }

    #[test]
    fn it_solves_turned_as_the_whole_matrix_does() {
        let columns = DMatrix::from_fn(5, 11, |r, c| (7 * r + 3 * c) as f64 / 11.0 - 1.0);
        let expected = square().tr_solve_lower_triangular(&columns).unwrap();
        for n_columns in 1..=11 {
            let some = columns.columns(0, n_columns).into_owned();
            let off = Triangle::of(&square()).solve_turned(&some) - expected.columns(0, n_columns);
            assert!(off.amax() < 1e-13, "{off}");
        }
    }

    /// A matrix of so many numbers with a known factor.
    fn lower(n: usize) -> DMatrix<f64> {
        DMatrix::from_fn(
            n,
            n,
            |r, c| if r == c { 2.0 + (r % 3) as f64 } else { 0.1 * ((r + 2 * c) % 7) as f64 },
        )
        .lower_triangle()
    }

    #[test]
    fn a_factor_is_inverted_whatever_its_size() {
        for n in [1, WHOLE, WHOLE + 1, 2 * WHOLE + 9, 105] {
            let lower = lower(n);
            let inverse = inverse_factor(&(&lower * lower.transpose()).lower_triangle()).unwrap();
            let off = &inverse * &lower - DMatrix::identity(n, n);
            assert!(off.amax() < 1e-11, "{n}: {}", off.amax());
            assert_eq!(inverse, inverse.lower_triangle());
        }
        let mut not_positive = DMatrix::identity(50, 50);
        not_positive[(44, 44)] = -1.0;
        assert_eq!(inverse_factor(&not_positive), None);
    }

    #[test]
    fn symmetric_products_are_the_whole_ones() {
        for n in [3, BAND, 2 * BAND + 5] {
            let (lower, full) =
                (lower(n), DMatrix::from_fn(n, n, |r, c| (3 * r + c) as f64 / n as f64 - 1.0));
            let square = Triangle::of_square(&lower).symmetric() - lower.tr_mul(&lower);
            let product =
                Triangle::of_product(&full, &full.transpose()).symmetric() - &full * full.transpose();
            assert!(square.amax() < 1e-11 && product.amax() < 1e-11, "{n}: {square} {product}");
        }
    }
}
