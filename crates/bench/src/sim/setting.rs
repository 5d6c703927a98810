use crate::Way;
use tousle_sim::{Integrator, SimOptions};

/// How finely a way is run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Setting {
    /// So many steps a second.
    Rate(f64),
    /// No step errs by more than this, m.
    Tolerance(f64),
}

/// Tolerances of an integrator that chooses its steps, m.
const TOLERANCES_M: [f64; 5] = [1e-3, 3e-4, 1e-4, 3e-5, 1e-5];

/// Where an explicit integrator needs more steps a second than this, it is not run.
pub(super) const MAX_RATE_HZ: f64 = 12_000.0;

impl Setting {
    /// The settings of a way: those rates, or what stands for them. `limit_secs`: the longest step that it stands.
    pub fn of(way: Way, rates_hz: &[f64], limit_secs: Option<f64>) -> Vec<Self> {
        match limit_secs {
            _ if way.integrator == Integrator::Adaptive => TOLERANCES_M.map(Self::Tolerance).to_vec(),
            None => rates_hz.iter().copied().map(Self::Rate).collect(),
            Some(limit_secs) => {
                // Whole steps a frame are taken: the next multiple of the frames' rate.
                let least = (1.0 / limit_secs / rates_hz[0]).ceil() * rates_hz[0];
                let rates = [1.0, 2.0, 4.0].map(|times| times * least).into_iter();
                rates.filter(|rate| *rate <= MAX_RATE_HZ).map(Self::Rate).collect()
            }
        }
    }

    /// Options with this setting.
    pub fn apply(self, options: SimOptions) -> SimOptions {
        match self {
            Self::Rate(rate_hz) => SimOptions { dt_secs: Some(1.0 / rate_hz), ..options },
            Self::Tolerance(tolerance_m) => SimOptions { tolerance_m, ..options },
        }
    }
}

impl std::fmt::Display for Setting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Rate(rate_hz) => write!(f, "{rate_hz:.0}/s"),
            Self::Tolerance(tolerance_m) => write!(f, "{} mm", tousle_page::short(1e3 * tolerance_m, 6)),
        }
    }
}
