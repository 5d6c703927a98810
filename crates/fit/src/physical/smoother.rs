//! The most likely course of a state over time, from what is likely before and what every step says.

use nalgebra::{DMatrix, DVector};

/// What is likely before anything is measured: each number wanders by itself about a mean.
pub(crate) struct Wander {
    pub(crate) mean: DVector<f64>,
    /// Precision of the first step about the mean.
    pub(crate) first: DVector<f64>,
    /// What is left of the distance from the mean from step to step.
    pub(crate) keeps: DVector<f64>,
    /// Precision of what is added to it anew.
    pub(crate) fresh: DVector<f64>,
}

/// What a step's measurements say: ½ xᵀ `information` x − `vector`ᵀ x is least where they are met best.
#[derive(Default)]
pub(crate) struct Said {
    pub(crate) information: DMatrix<f64>,
    pub(crate) vector: DVector<f64>,
}

/// The most likely states and, if they were asked for, their covariances, by step.
pub(crate) struct Likely {
    pub(crate) states: Vec<DVector<f64>>,
    pub(crate) covariances: Vec<DMatrix<f64>>,
}

/// The most likely states, and their covariances if asked for.
///
/// The sum of all terms is a quadratic form whose matrix is block-tridiagonal: a block Cholesky factor forwards, the
/// solution backwards, as in the Kalman smoother of Rauch, Tung and Striebel (1965). `None` if a block is not positive.
pub(crate) fn most_likely(wander: &Wander, said: &[Said], with_covariance: bool) -> Option<Likely> {
    let n_steps = said.len();
    let n = wander.mean.len();
    // −(off-diagonal): what a step passes on to the next, and the drift towards the mean.
    let passed = wander.keeps.component_mul(&wander.fresh);
    let drift = wander.mean.component_mul(&wander.keeps.map(|a| 1.0 - a));
    let mut inverses: Vec<DMatrix<f64>> = Vec::with_capacity(n_steps);
    let mut rights: Vec<DVector<f64>> = Vec::with_capacity(n_steps);
    for (k, said_now) in said.iter().enumerate() {
        let mut block = said_now.information.clone();
        let mut right = said_now.vector.clone();
        for i in 0..n {
            if k == 0 {
                block[(i, i)] += wander.first[i];
                right[i] += wander.first[i] * wander.mean[i];
            } else {
                block[(i, i)] += wander.fresh[i];
                right[i] += wander.fresh[i] * drift[i];
            }
            if k + 1 < n_steps {
                block[(i, i)] += wander.keeps[i] * passed[i];
                right[i] -= passed[i] * drift[i];
            }
        }
        if k > 0 {
            let before = &inverses[k - 1];
            for c in 0..n {
                for r in 0..n {
                    block[(r, c)] -= passed[r] * before[(r, c)] * passed[c];
                }
            }
            right += passed.component_mul(&(before * &rights[k - 1]));
        }
        inverses.push(block.cholesky()?.inverse());
        rights.push(right);
    }
    let mut states = vec![DVector::zeros(n); n_steps];
    let mut covariances: Vec<DMatrix<f64>> = Vec::new();
    for k in (0..n_steps).rev() {
        let mut right = rights[k].clone();
        if k + 1 < n_steps {
            right += passed.component_mul(&states[k + 1]);
        }
        states[k] = &inverses[k] * right;
        if with_covariance {
            let mut covariance = inverses[k].clone();
            if let Some(after) = covariances.last() {
                // P = S⁻¹ + S⁻¹ B P₊ B S⁻¹ with B = diag(passed).
                let mut gain = inverses[k].clone();
                for c in 0..n {
                    gain.column_mut(c).scale_mut(passed[c]);
                }
                covariance += &gain * after * gain.transpose();
            }
            covariances.push(covariance);
        }
    }
    covariances.reverse();
    Some(Likely { states, covariances })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three steps of two numbers, against the same least squares solved as one dense system.
    #[test]
    fn it_is_the_dense_answer() {
        let wander = Wander {
            keeps: DVector::from_vec(vec![0.8, 1.0]),
            fresh: DVector::from_vec(vec![2.0, 3.0]),
            mean: DVector::from_vec(vec![0.5, 0.0]),
            first: DVector::from_vec(vec![1.0, 0.5]),
        };
        let said = |k: f64| Said {
            information: DMatrix::from_row_slice(2, 2, &[2.0 + k, 0.7, 0.7, 1.0]),
            vector: DVector::from_vec(vec![1.0, -k]),
        };
        let said = [said(0.0), said(1.0), said(2.0)];
        let mut dense = DMatrix::zeros(6, 6);
        let mut right = DVector::zeros(6);
        for k in 0..3 {
            for r in 0..2 {
                right[2 * k + r] += said[k].vector[r];
                for c in 0..2 {
                    dense[(2 * k + r, 2 * k + c)] += said[k].information[(r, c)];
                }
                if k == 0 {
                    right[r] += wander.first[r] * wander.mean[r];
                    dense[(r, r)] += wander.first[r];
                } else {
                    // fresh/2 (x − a x₋ − (1 − a) m)².
                    let (now, before, a, q) = (2 * k + r, 2 * k - 2 + r, wander.keeps[r], wander.fresh[r]);
                    let drift = (1.0 - a) * wander.mean[r];
                    dense[(now, now)] += q;
                    dense[(before, before)] += a * a * q;
                    dense[(now, before)] -= a * q;
                    dense[(before, now)] -= a * q;
                    right[now] += q * drift;
                    right[before] -= a * q * drift;
                }
            }
        }
        let covariance: DMatrix<f64> = dense.try_inverse().unwrap_or_else(|| DMatrix::zeros(6, 6));
        let expected: DVector<f64> = &covariance * right;
        let Some(found) = most_likely(&wander, &said, true) else { panic!("expected an answer") };
        for k in 0..3 {
            for r in 0..2 {
                assert!((found.states[k][r] - expected[2 * k + r]).abs() < 1e-12);
                for c in 0..2 {
                    assert!(
                        (found.covariances[k][(r, c)] - covariance[(2 * k + r, 2 * k + c)]).abs() < 1e-12
                    );
                }
            }
        }
    }
}
