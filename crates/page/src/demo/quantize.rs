use serde::Serialize;

/// How positions became 16-bit integers: `position = center + step * integer`, on each axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Quantization {
    /// The middle of the positions' bounding box, m.
    pub center_m: [f64; 3],
    /// The step, m; a position is off by half of it at most.
    pub step_m: f64,
}

/// The step wherever it reaches: an error of 0.025 mm is a tenth of the cameras' noise and far below a pixel,
/// and 32,767 such steps are 1.6 m to either side. A finer one costs half a byte a coordinate for each halving.
pub(super) const STEP_M: f64 = 5e-5;

/// The integer that stands for a missing position (in x; y and z repeat it).
pub(super) const MISSING: i16 = i16::MIN;

/// Quantizes positions, m; `None` becomes [`MISSING`].
pub(super) fn quantize(positions: &[Option<[f64; 3]>]) -> (Quantization, Vec<i16>) {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for position in positions.iter().flatten() {
        for axis in 0..3 {
            low[axis] = low[axis].min(position[axis]);
            high[axis] = high[axis].max(position[axis]);
        }
    }
    let seen = low[0] <= high[0];
    let center_m = [0, 1, 2].map(|a| if seen { (low[a] + high[a]) / 2.0 } else { 0.0 });
    let reach = (0..3).map(|a| if seen { (high[a] - low[a]) / 2.0 } else { 0.0 }).fold(0.0, f64::max);
    let step_m = STEP_M.max(reach / f64::from(i16::MAX));
    let quantization = Quantization { center_m, step_m };
    let values = positions.iter().flat_map(|p| quantization.integers(*p)).collect();
    (quantization, values)
}

impl Quantization {
    fn integers(&self, position: Option<[f64; 3]>) -> [i16; 3] {
        let Some(position) = position else { return [MISSING; 3] };
        [0, 1, 2].map(|axis| {
            let steps = ((position[axis] - self.center_m[axis]) / self.step_m).round();
            // Rounding in `reach` can lift an extreme one step beyond the largest integer.
            steps.clamp(-f64::from(i16::MAX), f64::from(i16::MAX)) as i16
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worst(positions: &[Option<[f64; 3]>]) -> (f64, f64) {
        let (q, values) = quantize(positions);
        let mut worst: f64 = 0.0;
        for (position, integers) in positions.iter().zip(values.chunks(3)) {
            match position {
                None => assert_eq!(integers, [MISSING; 3]),
                Some(p) => {
                    for axis in 0..3 {
                        let back = q.center_m[axis] + q.step_m * f64::from(integers[axis]);
                        worst = worst.max((back - p[axis]).abs());
                    }
                }
            }
        }
        (worst, q.step_m)
    }

    #[test]
    fn near_positions_are_off_by_a_fortieth_of_a_millimeter_at_most() {
        let spread = (0..999).map(|k| Some([0.001_37 * f64::from(k), -0.3, 0.000_9 * f64::from(k) - 0.4]));
        let (worst, step_m) = worst(&spread.chain([None]).collect::<Vec<_>>());
        assert_eq!(step_m, STEP_M);
        assert!(worst <= 2.500_001e-5, "{worst}");
    }

    #[test]
    fn a_far_ghost_coarsens_the_step_and_nothing_overflows() {
        let (worst, step_m) = worst(&[Some([-40.0, 0.0, 0.0]), Some([60.0, 1e-3, 0.0])]);
        assert!((step_m - 50.0 / 32_767.0).abs() < 1e-12);
        assert!(worst <= step_m / 2.0 + 1e-12);
    }

    #[test]
    fn nothing_seen_is_no_panic() {
        let (q, values) = quantize(&[None, None]);
        assert_eq!((q.step_m, values.as_slice()), (STEP_M, &[MISSING; 6][..]));
    }
}
