use crate::TrueWind;
use serde::Serialize;
use tousle_field::FieldSequence;

/// How honest a field's standard deviations are: the share of components whose true value lies within so many of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Calibration {
    /// Where hair was, nearby, elsewhere: a share for each of [`Calibration::TIMES`].
    pub within: [Vec<f64>; 3],
}

impl Calibration {
    /// Multiples of the standard deviation.
    pub const TIMES: [f64; 6] = [0.5, 1.0, 1.5, 2.0, 2.5, 3.0];

    /// What a bell has within these: erf(z/√2).
    pub fn of_a_bell() -> Vec<f64> {
        Self::TIMES.iter().map(|z| libm::erf(z / core::f64::consts::SQRT_2)).collect()
    }

    /// A field's against the true wind; `None` where it states none or lies on another grid.
    pub fn of(field: &FieldSequence, truth: &TrueWind) -> Option<Self> {
        let ratios = truth.errors_over_sd(field)?;
        let share = |ratios: &Vec<f32>| {
            let within = |z: &f64| ratios.iter().filter(|r| f64::from(**r) <= *z).count() as f64;
            Self::TIMES.iter().map(|z| within(z) / ratios.len().max(1) as f64).collect()
        };
        Some(Self { within: [share(&ratios[0]), share(&ratios[1]), share(&ratios[2])] })
    }

    /// The shares within twice the standard deviation.
    pub fn within_two(&self) -> [f64; 3] {
        [0, 1, 2].map(|region| self.within[region][3])
    }
}
