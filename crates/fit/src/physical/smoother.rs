//! The most likely course of a state over time, from what is likely before and what every step says.

use nalgebra::{DMatrix, DVector};

/// What is likely before anything is measured: each number wanders by itself about a mean.
///
/// From step to step its distance from the mean shrinks by `keeps` and gets a fresh part of precision `fresh`; beside that
/// each step may know it directly, by `known` with precision `sure`.
pub(crate) struct Wander {
    pub(crate) keeps: DVector<f64>,
    pub(crate) fresh: DVector<f64>,
    pub(crate) mean: DVector<f64>,
    /// By step.
    pub(crate) known: Vec<DVector<f64>>,
    /// By step.
    pub(crate) sure: Vec<DVector<f64>>,
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
        let mut right = &said_now.vector + wander.sure[k].component_mul(&wander.known[k]);
        for i in 0..n {
            block[(i, i)] += wander.sure[k][i];
            if k > 0 {
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
