//! Properties that change along a strand.

use crate::raw::RawStrand;
use tousle_core::Along;

/// The thinnest that a strand is taken to be anywhere, over its mean width. Renderers draw strands down to nothing; a
/// tip without mass would be wherever the air is.
const THINNEST: f64 = 0.1;

/// The lightest and softest: a hundredth of the hairs.
const LIGHTEST: f64 = 0.01;

/// The mean of the values at a strand's points, and how many times the mean each is: none where all are alike, or
/// where the mean is no width or weight.
pub(crate) fn mean_and_shares(values: &[f64]) -> (f64, Vec<f64>) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let all_alike = values.iter().all(|v| *v == values[0]);
    let shares = if all_alike || !(mean.is_finite() && mean > 0.0) {
        Vec::new()
    } else {
        values.iter().map(|v| v / mean).collect()
    };
    (mean, shares)
}

/// Values at `n` points from values evenly along a strand.
pub(crate) fn spread(values: &[f64], n: usize) -> Vec<f64> {
    let at = |k: usize| {
        let place = k as f64 * (values.len() - 1) as f64 / (n.max(2) - 1) as f64;
        let left = place as usize;
        let right = (left + 1).min(values.len() - 1);
        values[left] + (values[right] - values[left]) * (place - left as f64)
    };
    (0..n).map(at).collect()
}

/// How a strand of a known width changes along its length.
///
/// A lock is a bundle of hairs of one thickness. Where nobody says how its mass runs, there are as many hairs as the
/// square of its width has room for, so that it gets lighter where it is drawn thinner; its stiffness goes with
/// its mass. What is given as one number stays one number.
pub(crate) fn complete(raw: &RawStrand, knows_width: bool) -> Along {
    let at_least = |least: f64, shares: &[f64]| shares.iter().map(|s| s.max(least)).collect::<Vec<_>>();
    let width = if knows_width { at_least(THINNEST, &raw.along.width) } else { Vec::new() };
    let hairs: Vec<f64> = match (&raw.along.linear_density, raw.linear_density_kg_per_m) {
        (given, _) if !given.is_empty() => at_least(LIGHTEST, given),
        (_, Some(_)) => Vec::new(),
        (_, None) => width.iter().map(|w| w * w).collect(),
    };
    let bending_stiffness = match (&raw.along.bending_stiffness, raw.bending_stiffness_n_m2) {
        (given, _) if !given.is_empty() => at_least(LIGHTEST, given),
        (_, Some(_)) => Vec::new(),
        (_, None) => hairs.clone(),
    };
    Along { width, linear_density: hairs, bending_stiffness }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_and_what_is_spread() {
        assert_eq!(mean_and_shares(&[1.0, 2.0, 3.0]), (2.0, vec![0.5, 1.0, 1.5]));
        assert_eq!(mean_and_shares(&[2.0, 2.0]), (2.0, Vec::new()));
        assert_eq!(mean_and_shares(&[0.0, -1.0]).1, Vec::<f64>::new());
        assert_eq!(spread(&[1.0, 3.0], 3), [1.0, 2.0, 3.0]);
        assert_eq!(spread(&[5.0], 2), [5.0, 5.0]);
        assert_eq!(spread(&[1.0, 2.0, 4.0], 3), [1.0, 2.0, 4.0]);
    }

    #[test]
    fn a_thinner_tip_holds_fewer_hairs_unless_someone_says_otherwise() {
        let mut raw = RawStrand::default();
        raw.along.width = vec![1.5, 1.0, 0.5];
        let along = complete(&raw, true);
        assert_eq!(along.linear_density, [2.25, 1.0, 0.25]);
        assert_eq!(along.bending_stiffness, along.linear_density);
        assert_eq!(complete(&raw, false), Along::default());
        raw.linear_density_kg_per_m = Some(1e-3);
        let along = complete(&raw, true);
        assert_eq!(along.width, raw.along.width);
        assert!(along.linear_density.is_empty() && along.bending_stiffness.is_empty());
        raw.along.linear_density = vec![1.0, 2.0, 0.0];
        raw.bending_stiffness_n_m2 = Some(1e-6);
        let along = complete(&raw, true);
        assert_eq!(along.linear_density, [1.0, 2.0, 0.01], "a tip has some mass");
        assert!(along.bending_stiffness.is_empty());
    }
}
