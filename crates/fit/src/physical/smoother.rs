//! The most likely course of a state over time, from what is likely before and what every step says.

use super::constants::ConstantsSaid;
use super::triangle::{Triangle, inverse_factor};
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
    /// Precision of what is added anew.
    fresh: Triangle,
    /// `fresh` times what they become.
    passed: DMatrix<f64>,
    /// What they become, turned, times `passed`.
    kept: Triangle,
}

impl Carried {
    /// `by`: what they become. `unmixed`: the inverse of the lower factor of the covariance of what is added anew.
    pub(crate) fn new(by: &DMatrix<f64>, unmixed: &DMatrix<f64>) -> Self {
        let (turned, became) = (unmixed.transpose(), unmixed * by);
        Self {
            fresh: Triangle::of_square(unmixed),
            kept: Triangle::of_product(&became.transpose(), &became),
            passed: turned * became,
        }
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
            let Carried { fresh, passed, kept } = carried(step);
            said.information += &fresh;
            self.join(said, &passed);
            Some(kept)
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

/// The most likely states, and their covariances if asked for, by step; and the most likely constants beside them, if there are any.
///
/// The sum of all terms is a quadratic form whose matrix is block-tridiagonal, bordered by the constants. What the steps before a
/// step say of it, and what those after it say, are found by two sweeps at once, each by block Cholesky factors: the two-filter
/// smoother (D. C. Fraser and J. E. Potter, "The optimum linear smoother as a combination of two optimum linear filters", *IEEE
/// Transactions on Automatic Control* 14, 1969). The constants follow from what is left of them when all states are eliminated
/// (Schur's complement), and move the states. `None` if a block is not positive. `carried` tells how numbers come to a step, of all
/// but the first.
///
/// All that is kept of a long capture is here at once, so it is kept once, and by halves where it is symmetric.
pub(crate) fn most_likely(
    wander: &Wander,
    carried: impl Fn(usize) -> Carried + Sync,
    mut said: Vec<Said>,
    constants: Option<ConstantsSaid>,
    with_covariance: bool,
) -> Option<(Vec<Likely>, Option<DVector<f64>>)> {
    wander.add_to(&mut said, carried);
    let n_steps = said.len();
    let mut eliminated = Vec::with_capacity(n_steps);
    let (from_before, from_after) = rayon::join(
        || {
            let link = |step: usize| said[step + 1].with_before.as_ref().map(DMatrix::transpose);
            swept(&said, 0..n_steps, link, |of_step| eliminated.push(of_step))
        },
        || swept(&said, (0..n_steps).rev(), |step| said[step].with_before.clone(), drop),
    );
    let (from_before, mut from_after) = (from_before?, from_after?);
    from_after.reverse();
    let of_step = |((mut own, before), after): ((Said, Said), Said)| {
        own.information -= &before.information;
        own.information -= &after.information;
        let unmixed = inverse_factor(&own.information.matrix())?;
        let state = unmixed.tr_mul(&(&unmixed * (own.vector + before.vector + after.vector)));
        let covariance = with_covariance.then(|| Triangle::of_square(&unmixed).symmetric());
        Some(Likely { state, covariance })
    };
    let likely = said.into_par_iter().zip(from_before).zip(from_after).map(of_step);
    let mut likely: Vec<Likely> = likely.collect::<Option<_>>()?;
    let constants = match constants {
        Some(said) => Some(with_constants(&mut likely, &eliminated, said)?),
        None => None,
    };
    Some((likely, constants))
}

/// What is left of a step's state when it is eliminated, those before it first.
struct Eliminated {
    /// The inverse of its information's lower factor.
    unmixed: Triangle,
    /// That times what joins it to the next step; `None` of the last.
    to_next: Option<DMatrix<f64>>,
}

/// What is passed on to each step, in the order of `steps`, by all steps before it in that order: information to be taken off its
/// own, and a vector to be added. `link` is minus the block that joins a step (rows) to the next (columns). `eliminated` is told of
/// every step, in that order.
fn swept(
    own: &[Said],
    steps: impl Iterator<Item = usize>,
    link: impl Fn(usize) -> Option<DMatrix<f64>>,
    mut eliminated: impl FnMut(Eliminated),
) -> Option<Vec<Said>> {
    let n = own.first()?.vector.len();
    let mut passed =
        vec![Said { information: Triangle::zeros(n), vector: DVector::zeros(n), with_before: None }];
    for (k, step) in steps.enumerate() {
        let (own_said, come) = (&own[step], passed.last()?);
        let mut information = own_said.information.clone();
        information -= &come.information;
        let factor = inverse_factor(&information.matrix())?;
        let unmixed = Triangle::of(&factor);
        if k + 1 == own.len() {
            eliminated(Eliminated { unmixed, to_next: None });
            break;
        }
        let gain = &factor * link(step)?;
        let turned = gain.transpose();
        let vector = &turned * (factor * (&own_said.vector + &come.vector));
        let information = Triangle::of_product(&turned, &gain);
        passed.push(Said { information, vector, with_before: None });
        eliminated(Eliminated { unmixed, to_next: Some(gain) });
    }
    Some(passed)
}

/// Constants whose columns are solved for side by side with those of others.
const CONSTANTS_TOGETHER: usize = 32;

/// Steps that are summed up side by side with others.
const STEPS_TOGETHER: usize = 64;

/// Finds the constants beside states that are most likely where all constants are zero, and moves the states along.
fn with_constants(
    likely: &mut [Likely],
    eliminated: &[Eliminated],
    said: ConstantsSaid,
) -> Option<DVector<f64>> {
    let ConstantsSaid { mut information, mut vector, mut with_air, means_off } = said;
    for (likely, with_air) in likely.iter().zip(&with_air) {
        vector.gemv_tr(-1.0, with_air, &likely.state, 1.0);
    }
    forward(eliminated, &mut with_air);
    let forwards = with_air;
    let products = forwards.par_chunks(STEPS_TOGETHER).map(|steps| {
        let mut sum = Triangle::zeros(vector.len());
        for step in steps {
            sum += &Triangle::of_product(&step.transpose(), step);
        }
        sum
    });
    for product in products.collect::<Vec<_>>() {
        information -= product.symmetric();
    }
    let unmixed = inverse_factor(&information)?;
    let solved = |columns: &DMatrix<f64>| unmixed.transpose() * (&unmixed * columns);
    let constants = solved(&DMatrix::from_columns(&[vector]));
    // How far constants, a column for each choice of them, move each step's state; those that no row is given for are zero.
    let moved_by = |constants: &DMatrix<f64>| -> Vec<DMatrix<f64>> {
        let of_step = |step: &DMatrix<f64>| step.columns_range(..constants.nrows()) * constants;
        let mut moved: Vec<_> = forwards.iter().map(of_step).collect();
        backward(eliminated, &mut moved);
        moved
    };
    for (likely, moved) in likely.iter_mut().zip(moved_by(&constants)) {
        likely.state -= moved.column(0);
    }
    if let Some(means_off) = means_off {
        add_unknown(likely, &unmixed, &solved(&means_off), moved_by);
    }
    Some(constants.column(0).into_owned())
}

/// Adds to the states' covariances what comes of the constants' own, of whose information `unmixed` is the inverse of a lower factor,
/// and of what is held of them, which moves them by `means_off`. `moved_by` tells how far constants move each step's state.
fn add_unknown(
    likely: &mut [Likely],
    unmixed: &DMatrix<f64>,
    means_off: &DMatrix<f64>,
    moved_by: impl Fn(&DMatrix<f64>) -> Vec<DMatrix<f64>> + Sync,
) {
    let n = unmixed.nrows();
    // Independent unknowns of variance 1 in place of the constants: each hangs on those before it.
    let some = |first: usize| {
        let end = (first + CONSTANTS_TOGETHER).min(n);
        unmixed.view_range(first..end, ..end).transpose()
    };
    let mut causes: Vec<DMatrix<f64>> = (0..n).step_by(CONSTANTS_TOGETHER).map(some).collect();
    causes.push(means_off.clone());
    // Not all at once: of a long capture that would be as much again as all that is kept of it.
    for causes in causes.chunks(2) {
        let moved: Vec<Vec<DMatrix<f64>>> = causes.par_iter().map(&moved_by).collect();
        likely.par_iter_mut().enumerate().for_each(|(step, likely)| {
            let Some(covariance) = &mut likely.covariance else { return };
            for of_cause in &moved {
                let moved = &of_cause[step];
                *covariance += Triangle::of_product(moved, &moved.transpose()).symmetric();
            }
        });
    }
}

/// The inverse of the eliminated steps' lower factor times columns of every step, in their place.
fn forward(eliminated: &[Eliminated], columns: &mut [DMatrix<f64>]) {
    let mut before: Option<(&DMatrix<f64>, DMatrix<f64>)> = None;
    for (of_step, own) in eliminated.iter().zip(columns) {
        let (n, unmixed) = (own.nrows(), of_step.unmixed.matrix());
        let to_this = before.as_ref().map(|(to_this, solved)| (to_this.transpose(), solved));
        let of_some = |(k, some): (usize, &mut [f64])| {
            let mut own = DMatrix::from_column_slice(n, some.len() / n, some);
            if let Some((to_this, solved)) = &to_this {
                let solved = solved.columns(k * CONSTANTS_TOGETHER, own.ncols());
                own.gemm(1.0, to_this, &solved, 1.0);
            }
            some.copy_from_slice((&unmixed * own).as_slice());
        };
        own.as_mut_slice().par_chunks_mut(n * CONSTANTS_TOGETHER).enumerate().for_each(of_some);
        before = of_step.to_next.as_ref().map(|to_next| (to_next, own.clone()));
    }
}

/// The inverse of that factor, turned, times columns of every step, in their place.
fn backward(eliminated: &[Eliminated], columns: &mut [DMatrix<f64>]) {
    for (step, of_step) in eliminated.iter().enumerate().rev() {
        let (own, after) = columns.split_at_mut(step + 1);
        if let (Some(to_next), Some(after)) = (&of_step.to_next, after.first()) {
            own[step].gemm(1.0, to_next, after, 1.0);
        }
        own[step] = of_step.unmixed.matrix().transpose() * &own[step];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of some constants and of them together with three steps of three numbers.
    fn constants(n: usize) -> ConstantsSaid {
        let with_air =
            (0..3).map(|k| DMatrix::from_fn(3, n, |r, c| 0.3 - 0.1 * ((r + 2 * c + k) % 5) as f64));
        ConstantsSaid {
            information: DMatrix::from_fn(n, n, |r, c| if r == c { 4.0 } else { 0.02 }),
            vector: DVector::from_fn(n, |i, _| 0.4 - 0.2 * i as f64),
            with_air: with_air.collect(),
            means_off: Some(DMatrix::from_fn(n, 2, |i, mean| if i % 3 == mean { 0.3 } else { 0.0 })),
        }
    }

    /// Three steps of three numbers, of which two are carried, and more constants than are solved for at once, against the same
    /// least squares solved as one dense system.
    #[test]
    fn it_is_the_dense_answer() {
        let carried_by = DMatrix::from_row_slice(2, 2, &[0.7, 0.2, -0.1, 0.5]);
        let carried_fresh = DMatrix::from_row_slice(2, 2, &[3.0, 0.4, 0.4, 2.0]);
        let unmixed = inverse_factor(&carried_fresh.clone().try_inverse().unwrap()).unwrap();
        let carried = |_| Carried::new(&carried_by, &unmixed);
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
        by.view_mut((0, 0), (2, 2)).copy_from(&carried_by);
        let mut fresh = DMatrix::from_diagonal(&wander.fresh);
        fresh.view_mut((0, 0), (2, 2)).copy_from(&carried_fresh);
        let drift = &wander.mean - &by * &wander.mean;
        let n_constants = CONSTANTS_TOGETHER + 5;
        let n = 9 + n_constants;
        let mut dense = DMatrix::zeros(n, n);
        let mut right = DVector::zeros(n);
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
        let beside = constants(n_constants);
        dense.view_mut((9, 9), (n_constants, n_constants)).copy_from(&beside.information);
        right.rows_mut(9, n_constants).copy_from(&beside.vector);
        for (k, with_air) in beside.with_air.iter().enumerate() {
            dense.view_mut((3 * k, 9), (3, n_constants)).copy_from(with_air);
            dense.view_mut((9, 3 * k), (n_constants, 3)).copy_from(&with_air.transpose());
        }
        let covariance: DMatrix<f64> = dense.try_inverse().unwrap_or_else(|| DMatrix::zeros(n, n));
        let expected: DVector<f64> = &covariance * right;
        let mut means_off = DMatrix::zeros(n, 2);
        means_off.rows_mut(9, n_constants).copy_from(beside.means_off.as_ref().unwrap());
        let means_off = &covariance * means_off;
        let covariance = covariance + &means_off * means_off.transpose();
        let Some((found, found_constants)) = most_likely(&wander, carried, said.into(), Some(beside), true)
        else {
            panic!("expected an answer")
        };
        let off = found_constants.unwrap() - expected.rows(9, n_constants);
        assert!(off.amax() < 1e-12, "{off}");
        for (k, found) in found.iter().enumerate() {
            let off = &found.state - expected.rows(3 * k, 3);
            let Some(spread) = &found.covariance else { panic!("expected a covariance") };
            let off_spread = spread - covariance.view((3 * k, 3 * k), (3, 3));
            assert!(off.amax() < 1e-12 && off_spread.amax() < 1e-12, "{off} {off_spread}");
        }
    }
}
