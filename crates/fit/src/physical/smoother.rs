//! The most likely course of a state over time, from what is likely before and what every step says.

use super::triangle::Triangle;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// What is likely before anything is measured: the first numbers are carried over from step to step, each of the others wanders
/// by itself about a mean.
pub(crate) struct Wander {
    pub(crate) mean: DVector<f64>,
    /// Precision of the first step about the mean.
    pub(crate) first: DVector<f64>,
    /// What is left of the distance from the mean from step to step.
    pub(crate) keeps: DVector<f64>,
    /// Precision of what is added to it anew.
    pub(crate) fresh: DVector<f64>,
    /// How many numbers are carried, which are about nothing.
    pub(crate) n_carried: usize,
}

/// How some numbers come to a step from the one before.
pub(crate) struct Carried {
    /// What they become.
    by: DMatrix<f64>,
    /// Precision of what is added anew.
    fresh: DMatrix<f64>,
    /// `fresh` times `by`.
    passed: DMatrix<f64>,
}

impl Carried {
    pub(crate) fn new(by: DMatrix<f64>, fresh: DMatrix<f64>) -> Self {
        Self { passed: &fresh * &by, by, fresh }
    }
}

/// What a step's measurements say: ½ xᵀ `information` x − `vector`ᵀ x is least where they are met best.
#[derive(Default)]
pub(crate) struct Said {
    /// Symmetric: its lower half.
    pub(crate) information: Triangle,
    pub(crate) vector: DVector<f64>,
    /// Minus the block that joins the step's state (rows) to that of the step before; `None` if nothing does.
    pub(crate) with_before: Option<DMatrix<f64>>,
}

/// A step's most likely state and, if it was asked for, its covariance.
pub(crate) struct Likely {
    pub(crate) state: DVector<f64>,
    pub(crate) covariance: Option<DMatrix<f64>>,
}

impl Wander {
    /// Adds to what the steps say what is likely before they are asked. `carried` tells how numbers come to a step.
    fn add_to(&self, said: &mut [Said], carried: impl Fn(usize) -> Carried + Sync) {
        let n_steps = said.len();
        let come = |(step, said): (usize, &mut Said)| {
            self.add_others(said, step == 0, step + 1 == n_steps);
            if step == 0 {
                (0..self.n_carried).for_each(|i| said.information.add(i, i, self.first[i]));
                return None;
            }
            let Carried { by, fresh, passed } = carried(step);
            said.information += &Triangle::of(&fresh);
            self.join(said, &passed);
            Some(Triangle::of(&(by.transpose() * passed)))
        };
        let of_before: Vec<Option<Triangle>> = said.par_iter_mut().enumerate().map(come).collect();
        for (said, passed) in said.iter_mut().zip(of_before.into_iter().skip(1).flatten()) {
            said.information += &passed;
        }
    }

    /// Adds what is likely of the numbers that wander by themselves.
    fn add_others(&self, said: &mut Said, is_first: bool, is_last: bool) {
        for i in self.n_carried..self.mean.len() {
            let drift = self.mean[i] * (1.0 - self.keeps[i]);
            let (precision, about) =
                if is_first { (self.first[i], self.mean[i]) } else { (self.fresh[i], drift) };
            said.information.add(i, i, precision);
            said.vector[i] += precision * about;
            if !is_last {
                let passed = self.keeps[i] * self.fresh[i];
                said.information.add(i, i, self.keeps[i] * passed);
                said.vector[i] -= passed * drift;
            }
        }
    }

    /// Joins a step to the one before, which passes on to it what is carried so and what the others keep.
    fn join(&self, said: &mut Said, passed: &DMatrix<f64>) {
        let n = self.mean.len();
        let joined = said.with_before.get_or_insert_with(|| DMatrix::zeros(n, n));
        let mut carried = joined.view_mut((0, 0), passed.shape());
        carried += passed;
        for i in self.n_carried..n {
            joined[(i, i)] += self.keeps[i] * self.fresh[i];
        }
    }
}

/// The most likely states, and their covariances if asked for, by step.
///
/// The sum of all terms is a quadratic form whose matrix is block-tridiagonal. What the steps before a step say of it, and what
/// those after it say, are found by two sweeps at once, each by block Cholesky factors: the two-filter smoother (D. C. Fraser and
/// J. E. Potter, "The optimum linear smoother as a combination of two optimum linear filters", *IEEE Transactions on Automatic
/// Control* 14, 1969). `None` if a block is not positive. `carried` tells how numbers come to a step, of all but the first.
///
/// All that is kept of a long capture is here at once, so it is kept once, and by halves where it is symmetric.
pub(crate) fn most_likely(
    wander: &Wander,
    carried: impl Fn(usize) -> Carried + Sync,
    mut said: Vec<Said>,
    with_covariance: bool,
) -> Option<Vec<Likely>> {
    wander.add_to(&mut said, carried);
    let n_steps = said.len();
    let (from_before, from_after) = rayon::join(
        || swept(&said, 0..n_steps, |step| said[step + 1].with_before.as_ref().map(DMatrix::transpose)),
        || swept(&said, (0..n_steps).rev(), |step| said[step].with_before.clone()),
    );
    let (from_before, mut from_after) = (from_before?, from_after?);
    from_after.reverse();
    let of_step = |((mut own, before), after): ((Said, Said), Said)| {
        own.information -= &before.information;
        own.information -= &after.information;
        let factor = own.information.matrix().cholesky()?;
        let state = factor.solve(&(own.vector + before.vector + after.vector));
        Some(Likely { state, covariance: with_covariance.then(|| Triangle::inverse(&factor)) })
    };
    said.into_par_iter().zip(from_before).zip(from_after).map(of_step).collect()
}

/// What is passed on to each step, in the order of `steps`, by all steps before it in that order: information to be taken off its
/// own, and a vector to be added. `link` is minus the block that joins a step (rows) to the next (columns).
fn swept(
    own: &[Said],
    steps: impl Iterator<Item = usize>,
    link: impl Fn(usize) -> Option<DMatrix<f64>>,
) -> Option<Vec<Said>> {
    let n = own.first()?.vector.len();
    let mut passed =
        vec![Said { information: Triangle::zeros(n), vector: DVector::zeros(n), with_before: None }];
    for step in steps.take(own.len() - 1) {
        let (own, come) = (&own[step], passed.last()?);
        let mut information = own.information.clone();
        information -= &come.information;
        let lower = Triangle::of(information.matrix().cholesky()?.l_dirty());
        let gain = lower.solve(&link(step)?);
        let vector = lower.solve_column(&(&own.vector + &come.vector));
        let turned = gain.transpose();
        let information = Triangle::of(&(&turned * gain));
        passed.push(Said { information, vector: turned * vector, with_before: None });
    }
    Some(passed)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three steps of three numbers, of which two are carried, against the same least squares solved as one dense system.
    #[test]
    fn it_is_the_dense_answer() {
        let carried = || {
            Carried::new(
                DMatrix::from_row_slice(2, 2, &[0.7, 0.2, -0.1, 0.5]),
                DMatrix::from_row_slice(2, 2, &[3.0, 0.4, 0.4, 2.0]),
            )
        };
        let wander = Wander {
            keeps: DVector::from_vec(vec![0.0, 0.0, 0.8]),
            fresh: DVector::from_vec(vec![0.0, 0.0, 2.0]),
            mean: DVector::from_vec(vec![0.0, 0.0, 0.5]),
            first: DVector::from_vec(vec![1.0, 0.5, 0.7]),
            n_carried: 2,
        };
        let information =
            |k: f64| DMatrix::from_row_slice(3, 3, &[2.0 + k, 0.7, 0.1, 0.7, 1.0, 0.2, 0.1, 0.2, 0.6]);
        let said = |k: f64| Said {
            information: Triangle::of(&information(k)),
            vector: DVector::from_vec(vec![1.0, -k, 0.3]),
            with_before: (k > 0.0)
                .then(|| DMatrix::from_row_slice(3, 3, &[0.3, 0.1, 0.0, 0.2, 0.1, 0.1, 0.0, 0.0, 0.2])),
        };
        let said = [said(0.0), said(1.0), said(2.0)];
        let mut by = DMatrix::from_diagonal(&wander.keeps);
        by.view_mut((0, 0), (2, 2)).copy_from(&carried().by);
        let mut fresh = DMatrix::from_diagonal(&wander.fresh);
        fresh.view_mut((0, 0), (2, 2)).copy_from(&carried().fresh);
        let drift = &wander.mean - &by * &wander.mean;
        let mut dense = DMatrix::zeros(9, 9);
        let mut right = DVector::zeros(9);
        let mut add = |at: (usize, usize), block: &DMatrix<f64>| {
            let mut view = dense.view_mut((3 * at.0, 3 * at.1), (3, 3));
            view += block;
        };
        let mut pull = |at: usize, part: &DVector<f64>| {
            let mut rows = right.rows_mut(3 * at, 3);
            rows += part;
        };
        for (k, said) in said.iter().enumerate() {
            add((k, k), &information(k as f64));
            pull(k, &said.vector);
            if k == 0 {
                add((0, 0), &DMatrix::from_diagonal(&wander.first));
                pull(0, &wander.first.component_mul(&wander.mean));
            } else {
                // (x − A x₋ − drift)ᵀ fresh (x − A x₋ − drift) / 2.
                add((k, k), &fresh);
                add((k - 1, k - 1), &(by.transpose() * &fresh * &by));
                add((k, k - 1), &-(&fresh * &by));
                add((k - 1, k), &-(by.transpose() * &fresh));
                let with_before = said.with_before.clone().unwrap_or_else(|| DMatrix::zeros(3, 3));
                add((k, k - 1), &-&with_before);
                add((k - 1, k), &-with_before.transpose());
                pull(k, &(&fresh * &drift));
                pull(k - 1, &-(by.transpose() * &fresh * &drift));
            }
        }
        let covariance: DMatrix<f64> = dense.try_inverse().unwrap_or_else(|| DMatrix::zeros(9, 9));
        let expected: DVector<f64> = &covariance * right;
        let Some(found) = most_likely(&wander, |_| carried(), said.into(), true) else {
            panic!("expected an answer")
        };
        for (k, found) in found.iter().enumerate() {
            let off = &found.state - expected.rows(3 * k, 3);
            let Some(spread) = &found.covariance else { panic!("expected a covariance") };
            let off_spread = spread - covariance.view((3 * k, 3 * k), (3, 3));
            assert!(off.amax() < 1e-12 && off_spread.amax() < 1e-12, "{off} {off_spread}");
        }
    }
}
