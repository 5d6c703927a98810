use serde::Serialize;

/// How E1 is stepped through time.
///
/// Both step the joints' rates half a step apart from their angles, so what joints do to one another is treated
/// the same forwards and backwards in time and feeds no energy into a swing. Both are of order 1: the air's
/// resistance and the contacts of a step see the rates of the step before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Integrator {
    /// Semi-implicit Euler: new rates from the old angles, then new angles from the new rates. Resistance is
    /// taken at the step's end, strength at its start: a step beyond 2 over a joint's frequency is refused.
    SemiImplicit,
    /// The exact solution of each joint's equation over the step, with what the other joints do to it held. No
    /// step is too long or too stiff for it.
    #[default]
    Exponential,
}

impl Integrator {
    /// Every integrator.
    pub const ALL: [Self; 2] = [Self::SemiImplicit, Self::Exponential];

    /// The name used on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::SemiImplicit => "semi-implicit",
            Self::Exponential => "exponential",
        }
    }

    /// The integrator of a name that [`Integrator::name`] gives.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|i| i.name() == name)
    }

    /// The order with which the error falls as the step shrinks.
    pub fn order(self) -> u32 {
        1
    }

    /// Whether a step can be too long for it.
    pub fn is_limited(self) -> bool {
        match self {
            Self::SemiImplicit => true,
            Self::Exponential => false,
        }
    }
}
