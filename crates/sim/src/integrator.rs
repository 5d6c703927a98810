use crate::Method;
use serde::Serialize;

/// How the equations are stepped through time.
///
/// What each is for, its order and its limit depend on the method; see [`Integrator::of`] for those a method has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Integrator {
    /// Semi-implicit Euler: stiffness at the step's start, resistance at its end, places from the new rates. A step
    /// beyond 2 over the fastest joint's frequency is refused.
    SemiImplicit,
    /// Method `paper` only: the exact solution of each joint's equation over the step, with what the other joints do
    /// to it held. No step is too long or too stiff for it.
    Exponential,
    /// Method `physical`: the backward differentiation formula of order 2 (BDF2), all joints, air and surfaces at the
    /// step's end. No step is too long or too stiff for it.
    Implicit,
    /// Method `physical`: backward Euler. As [`Integrator::Implicit`], of order 1: it damps swings.
    ImplicitEuler,
    /// Method `physical`: BDF2 with steps chosen for each strand so that every step errs by less than a tolerance.
    Adaptive,
    /// Method `physical`, for comparison: the classical Runge-Kutta method of order 4. Everything explicit; steps
    /// beyond what internal damping stands are refused.
    Rk4,
}

impl Integrator {
    /// Every integrator.
    pub const ALL: [Self; 6] = [
        Self::SemiImplicit,
        Self::Exponential,
        Self::Implicit,
        Self::ImplicitEuler,
        Self::Adaptive,
        Self::Rk4,
    ];

    /// Those that a method has, its default first.
    pub fn of(method: Method) -> &'static [Self] {
        match method {
            Method::Paper => &[Self::Exponential, Self::SemiImplicit],
            Method::Physical => {
                &[Self::Implicit, Self::ImplicitEuler, Self::Adaptive, Self::SemiImplicit, Self::Rk4]
            }
        }
    }

    /// The name used on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::SemiImplicit => "semi-implicit",
            Self::Exponential => "exponential",
            Self::Implicit => "implicit",
            Self::ImplicitEuler => "implicit-euler",
            Self::Adaptive => "adaptive",
            Self::Rk4 => "rk4",
        }
    }

    /// The integrator of a name that [`Integrator::name`] gives.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|i| i.name() == name)
    }

    /// The order with which the error falls as the step shrinks.
    pub fn order(self) -> u32 {
        match self {
            Self::SemiImplicit | Self::Exponential | Self::ImplicitEuler => 1,
            Self::Implicit | Self::Adaptive => 2,
            Self::Rk4 => 4,
        }
    }

    /// Whether a step can be too long for it.
    pub fn is_limited(self) -> bool {
        matches!(self, Self::SemiImplicit | Self::Rk4)
    }
}
