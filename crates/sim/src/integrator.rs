use serde::Serialize;

/// How E1 is stepped through time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Integrator {
    /// Symplectic Euler: first the rates from the old angles, then the angles from the new rates.
    SemiImplicit,
    /// Linearly implicit Euler: the joint's own strength and air resistance at the end of the step.
    Implicit,
    /// The exact solution of the joint's linear equation over the step, with everything else held.
    #[default]
    Exponential,
}

impl Integrator {
    /// Every integrator, in the order of their cost to the user's trust: the default last.
    pub const ALL: [Self; 3] = [Self::SemiImplicit, Self::Implicit, Self::Exponential];

    /// The name used on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::SemiImplicit => "semi-implicit",
            Self::Implicit => "implicit",
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

    /// Its stability limit in words.
    pub fn limit(self) -> &'static str {
        match self {
            Self::SemiImplicit => "step below 2 / the highest frequency of a joint; beyond it refused",
            Self::Implicit | Self::Exponential => "none: stable for every step",
        }
    }
}
