//! Tracks over time: a smooth curve through noisy, weighted samples, and its derivatives.

use tousle_core::Vec3;

/// Smooths a sampled curve: least Σ wᵢ |xᵢ − yᵢ|² + penalty Σ |Δ³x|².
///
/// A sample of weight 0 is bridged. Three samples with weight are needed; with fewer there is no answer.
/// Source: Whittaker and Henderson's graduation of third order.
pub(crate) fn smooth(samples: &[Vec3], weights: &[f64], penalty: f64) -> Option<Vec<Vec3>> {
    let n = samples.len();
    if n < 4 || weights.iter().filter(|w| **w > 0.0).count() < 3 {
        return None;
    }
    // Rows of the lower band: entry d of row i is A[i][i - d].
    let mut band: Vec<[f64; 4]> = weights.iter().map(|w| [*w, 0.0, 0.0, 0.0]).collect();
    const DIFFERENCE: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];
    for first in 0..n - 3 {
        for a in 0..4 {
            for b in 0..=a {
                band[first + a][a - b] += penalty * DIFFERENCE[a] * DIFFERENCE[b];
            }
        }
    }
    let mut right: Vec<Vec3> = samples.iter().zip(weights).map(|(y, w)| y * *w).collect();
    // A banded factor L D Lᵀ, and the right side taken along.
    for i in 0..n {
        for d in (1..4.min(i + 1)).rev() {
            let j = i - d;
            let mut sum = band[i][d];
            for e in d + 1..4.min(i + 1) {
                // A[i][i-e] and A[j][i-e].
                if e - d < 4 {
                    sum -= band[i][e] * band[i - e][0] * band[j][e - d];
                }
            }
            band[i][d] = sum / band[j][0];
        }
        for d in 1..4.min(i + 1) {
            band[i][0] -= band[i][d] * band[i][d] * band[i - d][0];
            let before = right[i - d];
            right[i] -= before * band[i][d];
        }
    }
    for i in (0..n).rev() {
        right[i] /= band[i][0];
        for d in 1..4.min(n - i) {
            let after = right[i + d];
            right[i] -= after * band[i + d][d];
        }
    }
    Some(right)
}

/// The penalty that leaves half of a swing at a frequency, for samples of weight 1.
pub(crate) fn penalty(cutoff_hz: f64, rate_hz: f64) -> f64 {
    let per_sample = 2.0 * libm::sin(core::f64::consts::PI * f64::min(cutoff_hz / rate_hz, 0.5));
    libm::pow(per_sample, -6.0)
}

/// What [`smooth`] leaves of noise that is another in each sample, over it: the root of the share of all frequencies that pass,
/// where a swing of f is left to 1 / (1 + (f / cutoff)⁶). What was filled in between samples errs alike from frame to frame, and passes.
pub(crate) fn noise_left(cutoff_hz: f64, rate_hz: f64) -> f64 {
    // ∫ (1 + x⁶)⁻² dx from 0 on is 5 π / 18.
    let passes = 5.0 * core::f64::consts::PI / 18.0 * cutoff_hz;
    (passes / (0.5 * rate_hz)).min(1.0).sqrt()
}

/// Position, velocity and acceleration of a curve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Motion {
    pub(crate) position: Vec3,
    pub(crate) velocity: Vec3,
    pub(crate) acceleration: Vec3,
}

/// A smooth curve's motion at a time, by differences of neighboring frames, linear between frames.
pub(crate) fn motion_at(curve: &[Vec3], rate_hz: f64, time_secs: f64) -> Motion {
    let place = (time_secs * rate_hz).clamp(0.0, (curve.len() - 1) as f64);
    let before = (place + 1e-6) as usize;
    let share = (place - before as f64).max(0.0);
    let (a, b) =
        (at_frame(curve, rate_hz, before), at_frame(curve, rate_hz, (before + 1).min(curve.len() - 1)));
    let between = |a: Vec3, b: Vec3| a + (b - a) * share;
    Motion {
        position: between(a.position, b.position),
        velocity: between(a.velocity, b.velocity),
        acceleration: between(a.acceleration, b.acceleration),
    }
}

fn at_frame(curve: &[Vec3], rate_hz: f64, frame: usize) -> Motion {
    let middle = frame.clamp(1, curve.len() - 2);
    let (a, b, c) = (curve[middle - 1], curve[middle], curve[middle + 1]);
    let acceleration = (a - b * 2.0 + c) * (rate_hz * rate_hz);
    let velocity = (c - a) * (0.5 * rate_hz) + acceleration * ((frame as f64 - middle as f64) / rate_hz);
    Motion { position: curve[frame], velocity, acceleration }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A parabola has no third difference: it is kept to the last digit, through a gap as well.
    #[test]
    fn a_parabola_is_kept() {
        let curve: Vec<Vec3> = (0..40).map(|i| Vec3::new(1.0, 0.5, -0.1) * f64::from(i * i) * 1e-3).collect();
        let mut samples = curve.clone();
        let mut weights = vec![1.0; 40];
        for i in 10..20 {
            weights[i] = 0.0;
            samples[i] = Vec3::repeat(9.0);
        }
        let smoothed = smooth(&samples, &weights, 1e4).unwrap();
        assert!(smoothed.iter().zip(&curve).all(|(a, b)| (a - b).norm() < 1e-9));
        let motion = motion_at(&smoothed, 100.0, 0.155);
        assert!((motion.acceleration - Vec3::new(20.0, 10.0, -2.0)).norm() < 1e-6, "{motion:?}");
        assert!((motion.velocity - Vec3::new(1.0, 0.5, -0.1) * 3.1).norm() < 1e-6, "{motion:?}");
    }

    /// Half of a swing at the cutoff is left.
    #[test]
    fn the_cutoff_is_where_half_is_left() {
        let wave: Vec<Vec3> = (0..400)
            .map(|i| Vec3::x() * libm::sin(2.0 * core::f64::consts::PI * 8.0 * f64::from(i) / 120.0))
            .collect();
        let smoothed = smooth(&wave, &[1.0; 400], penalty(8.0, 120.0)).unwrap();
        let most = smoothed[100..300].iter().map(|p| p.x.abs()).fold(0.0, f64::max);
        assert!((most - 0.5).abs() < 0.01, "{most}");
    }

    /// Of noise that is another in each sample as much is left as is said: the root of the sum of squares of what one sample moves.
    #[test]
    fn what_is_left_of_noise() {
        let mut one = vec![Vec3::zeros(); 400];
        one[200] = Vec3::x();
        for cutoff_hz in [4.0, 9.0, 12.0] {
            let moved = smooth(&one, &[1.0; 400], penalty(cutoff_hz, 120.0)).unwrap();
            let left = moved.iter().map(Vec3::norm_squared).sum::<f64>().sqrt();
            let said = noise_left(cutoff_hz, 120.0);
            assert!((left / said - 1.0).abs() < 0.05, "{cutoff_hz} Hz: {left} {said}");
        }
    }
}
