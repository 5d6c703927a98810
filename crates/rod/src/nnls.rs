use nalgebra::{DMatrix, DVector};

/// The x ≥ 0 that makes ½ xᵀGx − bᵀx least, for a positive semidefinite G.
///
/// Lawson and Hanson's active-set method on the normal equations ("Solving Least Squares Problems", 1974,
/// ch. 23): exact after finitely many steps; cut off after `3 n` of them, when x is still ≥ 0. A ridge of 1e-10
/// of the largest diagonal entry picks one answer where several are least.
pub fn nonnegative_least_squares(g: &DMatrix<f64>, b: &DVector<f64>) -> DVector<f64> {
    let n = b.len();
    let largest = (0..n).map(|i| g[(i, i)]).fold(0.0, f64::max);
    let ridged = g + DMatrix::identity(n, n) * (1e-10 * largest);
    let tolerance = 1e-10 * b.amax();
    let mut x = DVector::zeros(n);
    let mut free: Vec<usize> = Vec::new();
    for _ in 0..3 * n {
        let gradient = b - &ridged * &x;
        let steepest = (0..n)
            .filter(|i| !free.contains(i) && gradient[*i] > tolerance)
            .max_by(|i, j| gradient[*i].total_cmp(&gradient[*j]));
        let Some(steepest) = steepest else { break };
        free.push(steepest);
        if !settle(&ridged, b, &mut free, &mut x) {
            break;
        }
    }
    x
}

/// Moves x to the least over the free entries, freeing fewer until none is negative. `false`: no answer.
fn settle(g: &DMatrix<f64>, b: &DVector<f64>, free: &mut Vec<usize>, x: &mut DVector<f64>) -> bool {
    loop {
        let small = DMatrix::from_fn(free.len(), free.len(), |r, c| g[(free[r], free[c])]);
        let right = DVector::from_fn(free.len(), |r, _| b[free[r]]);
        let Some(cholesky) = small.cholesky() else { return false };
        let goal = cholesky.solve(&right);
        // How far towards the goal x can go before an entry would turn negative.
        let mut share = 1.0;
        for (r, i) in free.iter().enumerate() {
            if goal[r] <= 0.0 {
                share = f64::min(share, x[*i] / (x[*i] - goal[r]));
            }
        }
        if !(0.0..=1.0).contains(&share) {
            share = 0.0;
        }
        for (r, i) in free.iter().enumerate() {
            x[*i] = if share == 1.0 { goal[r] } else { f64::max(x[*i] + (goal[r] - x[*i]) * share, 0.0) };
        }
        if share == 1.0 {
            return true;
        }
        let before = free.len();
        free.retain(|i| {
            let stays = x[*i] > 0.0;
            if !stays {
                x[*i] = 0.0;
            }
            stays
        });
        if free.len() == before || free.is_empty() {
            return false;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Least of ½|x|² − (1, −1)·x over x ≥ 0 is (1, 0).
    #[test]
    fn a_negative_wish_stays_at_zero() {
        let x = nonnegative_least_squares(&DMatrix::identity(2, 2), &DVector::from_vec(vec![1.0, -1.0]));
        assert!((x[0] - 1.0).abs() < 1e-9 && x[1] == 0.0);
    }

    /// The conditions of Karush, Kuhn and Tucker hold on a full case.
    #[test]
    fn the_answer_is_least() {
        let a = DMatrix::from_fn(12, 6, |r, c| libm::sin((3 * r + 7 * c + r * c) as f64));
        let y = DVector::from_fn(12, |r, _| libm::cos((5 * r) as f64));
        let (g, b) = (a.transpose() * &a, a.transpose() * &y);
        let x = nonnegative_least_squares(&g, &b);
        let gradient = &b - &g * &x;
        assert!(x.iter().any(|v| *v > 0.0) && x.iter().any(|v| *v == 0.0));
        for i in 0..6 {
            assert!(x[i] >= 0.0 && gradient[i] < 1e-7 && (x[i] * gradient[i]).abs() < 1e-7);
        }
    }
}
