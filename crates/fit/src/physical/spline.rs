//! A lock's curve between its markers.

use nalgebra::DMatrix;

/// The cubic spline through the root and markers at known places along a lock, as weights: row by place asked for, column
/// by what it hangs on: the root, the direction in which the lock leaves it, and each marker.
///
/// It leaves the root in the given direction and ends unbent; beyond the last marker it runs straight on. `knots_m` are the
/// markers' distances from the root, rising.
pub(crate) fn spline_weights(knots_m: &[f64], places_m: &[f64]) -> DMatrix<f64> {
    let knots: Vec<f64> = core::iter::once(0.0).chain(knots_m.iter().copied()).collect();
    let n = knots.len();
    let n_columns = n + 1;
    // Column of a knot's position; the direction is column 1.
    let column = |knot: usize| if knot == 0 { 0 } else { knot + 1 };
    let bends = bends(&knots, n_columns, &column);
    let mut weights = DMatrix::zeros(places_m.len(), n_columns);
    for (row, place) in places_m.iter().enumerate() {
        let interval = (1..n - 1).take_while(|k| knots[*k] < *place).count();
        let (a, h) = (knots[interval], knots[interval + 1] - knots[interval]);
        let beyond = f64::max(place - knots[n - 1], 0.0);
        let t = ((place - a) / h).min(1.0);
        let s = 1.0 - t;
        weights[(row, column(interval))] += s;
        weights[(row, column(interval + 1))] += t;
        let (low, high) = (h * h / 6.0 * (s * s * s - s), h * h / 6.0 * (t * t * t - t));
        for c in 0..n_columns {
            weights[(row, c)] += low * bends[(interval, c)] + high * bends[(interval + 1, c)];
        }
        if beyond > 0.0 {
            // The slope at the last knot.
            weights[(row, column(interval))] -= beyond / h;
            weights[(row, column(interval + 1))] += beyond / h;
            for c in 0..n_columns {
                weights[(row, c)] +=
                    beyond * h / 6.0 * (bends[(interval, c)] + 2.0 * bends[(interval + 1, c)]);
            }
        }
    }
    weights
}

/// The second derivatives at the knots, as weights.
fn bends(knots: &[f64], n_columns: usize, column: &dyn Fn(usize) -> usize) -> DMatrix<f64> {
    let n = knots.len();
    let mut system = DMatrix::zeros(n, n);
    let mut right = DMatrix::zeros(n, n_columns);
    let h = |k: usize| knots[k + 1] - knots[k];
    // The clamped start.
    system[(0, 0)] = 2.0 * h(0);
    system[(0, 1)] = h(0);
    right[(0, column(1))] += 6.0 / h(0);
    right[(0, column(0))] -= 6.0 / h(0);
    right[(0, 1)] -= 6.0;
    for k in 1..n - 1 {
        system[(k, k - 1)] = h(k - 1);
        system[(k, k)] = 2.0 * (h(k - 1) + h(k));
        system[(k, k + 1)] = h(k);
        right[(k, column(k + 1))] += 6.0 / h(k);
        right[(k, column(k))] -= 6.0 / h(k) + 6.0 / h(k - 1);
        right[(k, column(k - 1))] += 6.0 / h(k - 1);
    }
    // The free end.
    system[(n - 1, n - 1)] = 1.0;
    system.lu().solve(&right).unwrap_or_else(|| DMatrix::zeros(n, n_columns))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight lock stays straight, before, between and beyond its markers.
    #[test]
    fn straight_stays_straight() {
        let weights = spline_weights(&[0.05, 0.11, 0.2], &[0.0, 0.03, 0.07, 0.15, 0.2, 0.23]);
        for (row, place) in [0.0, 0.03, 0.07, 0.15, 0.2, 0.23].iter().enumerate() {
            let values = [1.0, 2.0, 1.0 + 0.1, 1.0 + 0.22, 1.0 + 0.4];
            let found: f64 = values.iter().enumerate().map(|(c, v)| weights[(row, c)] * v).sum();
            assert!((found - (1.0 + 2.0 * place)).abs() < 1e-12, "{place}: {found}");
        }
    }

    /// A smooth curve is met to fourth order far from its free end, and the markers exactly.
    #[test]
    fn a_curve_is_met() {
        let knots = [0.1, 0.2, 0.3, 0.4, 0.5];
        let curve = |s: f64| libm::sin(2.0 * s);
        let mut values = vec![0.0, 2.0];
        values.extend(knots.iter().map(|s| curve(*s)));
        let weights = spline_weights(&knots, &[0.05, 0.1, 0.15, 0.2]);
        for (row, place) in [0.05, 0.1, 0.15, 0.2].iter().enumerate() {
            let found: f64 = values.iter().enumerate().map(|(c, v)| weights[(row, c)] * v).sum();
            assert!((found - curve(*place)).abs() < 1e-4, "{place}: {found}");
        }
    }
}
