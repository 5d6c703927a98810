//! Order statistics as NumPy defines them by default, so that figures agree with those of other programs.

/// The value below which `percent` of the values lie, linear between neighbors; NaN of nothing.
///
/// Reorders `values`. NumPy's `percentile` with its default method.
pub(crate) fn percentile(values: &mut [f64], percent: f64) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let place = percent / 100.0 * (values.len() - 1) as f64;
    let below = place.floor() as usize;
    let share = place - below as f64;
    let (_, &mut low, above) = values.select_nth_unstable_by(below, f64::total_cmp);
    let high = above.iter().copied().min_by(f64::total_cmp).unwrap_or(low);
    low + (high - low) * share
}

/// The middle value, or the mean of the two middle ones; NaN of nothing. Reorders `values`.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    percentile(values, 50.0)
}

/// The mean; NaN of nothing.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_linear_between_neighbors() {
        let values = [40.0, 10.0, 30.0, 20.0];
        for (percent, expected) in [(0.0, 10.0), (50.0, 25.0), (95.0, 38.5), (100.0, 40.0)] {
            assert_eq!(percentile(&mut values.clone(), percent), expected, "{percent}");
        }
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
        assert!(median(&mut []).is_nan());
    }
}
