//! The most likely course of a state over time, from what is likely before and what every step says.

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
    /// How the first numbers, which are about nothing, come to each step from the one before; the first step's is not used.
    pub(crate) carried: Vec<Carried>,
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
    pub(crate) information: DMatrix<f64>,
    pub(crate) vector: DVector<f64>,
    /// Minus the block that joins the step's state (rows) to that of the step before; `None` if nothing does.
    pub(crate) with_before: Option<DMatrix<f64>>,
}

/// The most likely states and, if they were asked for, their covariances, by step.
pub(crate) struct Likely {
    pub(crate) states: Vec<DVector<f64>>,
    pub(crate) covariances: Vec<DMatrix<f64>>,
}

impl Wander {
    /// What a step's measurements say and what is likely, together.
    fn with(&self, step: usize, n_steps: usize, said: &Said) -> Said {
        let n_carried = self.n_carried();
        let (mut block, mut right) = (said.information.clone(), said.vector.clone());
        let mut carried = block.view_mut((0, 0), (n_carried, n_carried));
        if step == 0 {
            (0..n_carried).for_each(|i| carried[(i, i)] += self.first[i]);
        } else {
            carried += &self.carried[step].fresh;
        }
        if let Some(Carried { by, passed, .. }) = self.carried.get(step + 1) {
            carried += by.transpose() * passed;
        }
        for i in n_carried..self.mean.len() {
            let drift = self.mean[i] * (1.0 - self.keeps[i]);
            let (precision, about) =
                if step == 0 { (self.first[i], self.mean[i]) } else { (self.fresh[i], drift) };
            block[(i, i)] += precision;
            right[i] += precision * about;
            if step + 1 < n_steps {
                let passed = self.keeps[i] * self.fresh[i];
                block[(i, i)] += self.keeps[i] * passed;
                right[i] -= passed * drift;
            }
        }
        Said { information: block, vector: right, with_before: None }
    }

    /// −(off-diagonal): what the step before passes on to a step.
    fn passed(&self, step: usize) -> DMatrix<f64> {
        let n_carried = self.n_carried();
        let mut passed = DMatrix::from_diagonal(&self.keeps.component_mul(&self.fresh));
        if n_carried > 0 {
            passed.view_mut((0, 0), (n_carried, n_carried)).copy_from(&self.carried[step].passed);
        }
        passed
    }

    fn n_carried(&self) -> usize {
        self.carried.first().map_or(0, |carried| carried.by.nrows())
    }
}

/// The most likely states, and their covariances if asked for.
///
/// The sum of all terms is a quadratic form whose matrix is block-tridiagonal. What the steps before a step say of it, and what
/// those after it say, are found by two sweeps at once, each by block Cholesky factors: the two-filter smoother (D. C. Fraser and
/// J. E. Potter, "The optimum linear smoother as a combination of two optimum linear filters", *IEEE Transactions on Automatic
/// Control* 14, 1969). `None` if a block is not positive.
pub(crate) fn most_likely(wander: &Wander, said: &[Said], with_covariance: bool) -> Option<Likely> {
    let n_steps = said.len();
    let own: Vec<Said> =
        (0..n_steps).into_par_iter().map(|step| wander.with(step, n_steps, &said[step])).collect();
    let joined = |step: usize| match &said[step].with_before {
        Some(with_before) => wander.passed(step) + with_before,
        None => wander.passed(step),
    };
    let (from_before, from_after) = rayon::join(
        || swept(&own, 0..n_steps, |step| joined(step + 1).transpose()),
        || swept(&own, (0..n_steps).rev(), joined),
    );
    let (from_before, mut from_after) = (from_before?, from_after?);
    from_after.reverse();
    let of_step = |((own, before), after): ((&Said, &Said), &Said)| {
        let factor = (&own.information - &before.information - &after.information).cholesky()?;
        let state = factor.solve(&(&own.vector + &before.vector + &after.vector));
        Some((state, with_covariance.then(|| factor.inverse())))
    };
    let found: Option<Vec<_>> = own.par_iter().zip(&from_before).zip(&from_after).map(of_step).collect();
    let (states, covariances): (Vec<_>, Vec<_>) = found?.into_iter().unzip();
    Some(Likely { states, covariances: covariances.into_iter().flatten().collect() })
}

/// What is passed on to each step, in the order of `steps`, by all steps before it in that order: information to be taken off its
/// own, and a vector to be added. `link` is minus the block that joins a step (rows) to the next (columns).
fn swept(
    own: &[Said],
    steps: impl Iterator<Item = usize>,
    link: impl Fn(usize) -> DMatrix<f64>,
) -> Option<Vec<Said>> {
    let n = own.first()?.vector.len();
    let mut passed =
        vec![Said { information: DMatrix::zeros(n, n), vector: DVector::zeros(n), with_before: None }];
    for step in steps.take(own.len() - 1) {
        let (own, come) = (&own[step], passed.last()?);
        let factor = (&own.information - &come.information).cholesky()?;
        let lower = factor.l_dirty();
        let gain = lower.solve_lower_triangular(&link(step))?;
        let vector = lower.solve_lower_triangular(&(&own.vector + &come.vector))?;
        let turned = gain.transpose();
        passed.push(Said { information: &turned * gain, vector: turned * vector, with_before: None });
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
            carried: vec![carried(), carried(), carried()],
        };
        let said = |k: f64| Said {
            information: DMatrix::from_row_slice(3, 3, &[2.0 + k, 0.7, 0.1, 0.7, 1.0, 0.2, 0.1, 0.2, 0.6]),
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
            add((k, k), &said.information);
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
        let Some(found) = most_likely(&wander, &said, true) else { panic!("expected an answer") };
        for k in 0..3 {
            let off = &found.states[k] - expected.rows(3 * k, 3);
            let off_spread = &found.covariances[k] - covariance.view((3 * k, 3 * k), (3, 3));
            assert!(off.amax() < 1e-12 && off_spread.amax() < 1e-12, "{off} {off_spread}");
        }
    }
}
