/// The middle value; of an even number the mean of the two in the middle. `None` of nothing.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    let above = *values.get(n / 2)?;
    Some(if n % 2 == 1 { above } else { (values[n / 2 - 1] + above) / 2.0 })
}

/// The middle value; of an even number the higher of the two in the middle, so that it is one of the values. `None` of nothing.
pub fn median_high(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_number_has_two_in_the_middle() {
        for (values, mean, high) in [
            (vec![], None, None),
            (vec![7.0], Some(7.0), Some(7.0)),
            (vec![3.0, 1.0, 2.0], Some(2.0), Some(2.0)),
            (vec![4.0, 1.0, 3.0, 2.0], Some(2.5), Some(3.0)),
        ] {
            assert_eq!((median(values.clone()), median_high(values)), (mean, high));
        }
    }
}
