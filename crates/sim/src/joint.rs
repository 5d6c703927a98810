use crate::Integrator;
use tousle_core::Vec3;

/// E1 of one joint over one step: I1 Φ″ + I2 Φ′ + τ Φ = H, Φ counted from where the stick is now.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointEquation {
    /// I1, kg·m².
    pub inertia: f64,
    /// I2, N·m·s.
    pub resistance: f64,
    /// τ, N·m.
    pub strength: f64,
}

/// What one step does with a joint's rate: `rate = rate_per_rate Φ′ + rate_per_torque H`. The turn is the new
/// rate times the step: a rate here is the mean over the step before.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct JointStep {
    pub rate_per_rate: f64,
    pub rate_per_torque: f64,
}

impl JointStep {
    /// The step of an integrator.
    pub fn new(integrator: Integrator, joint: JointEquation, dt_secs: f64) -> Self {
        match integrator {
            Integrator::SemiImplicit => Self::semi_implicit(joint, dt_secs),
            Integrator::Implicit => Self::implicit(joint, dt_secs),
            Integrator::Exponential => Self::exponential(joint, dt_secs),
        }
    }

    fn semi_implicit(joint: JointEquation, dt_secs: f64) -> Self {
        let all = joint.inertia + dt_secs * joint.resistance;
        Self { rate_per_rate: joint.inertia / all, rate_per_torque: dt_secs / all }
    }
    fn implicit(joint: JointEquation, dt_secs: f64) -> Self {
        let all = joint.inertia + dt_secs * joint.resistance + dt_secs * dt_secs * joint.strength;
        Self { rate_per_rate: 1.0 - dt_secs * joint.resistance / all, rate_per_torque: dt_secs / all }
    }

    fn exponential(joint: JointEquation, dt_secs: f64) -> Self {
        let decay = 0.5 * joint.resistance / joint.inertia;
        let stiffness = joint.strength / joint.inertia;
        let fade = decay * dt_secs;
        let free = dt_secs / joint.inertia;
        let phase2 = stiffness * dt_secs * dt_secs;
        let rate_per_rate = libm::exp(-2.0 * fade);
        let share = if phase2 > fade * fade {
            let half = libm::sin(0.5 * (phase2 - fade * fade).sqrt());
            let e = libm::expm1(-fade);
            (e * e + 4.0 * (1.0 + e) * half * half) / phase2
        } else {
            let fast = fade + (fade * fade - phase2).sqrt();
            let slow = if fast > 0.0 { phase2 / fast } else { 0.0 };
            faded(fast) * faded(slow)
        };
        Self { rate_per_rate, rate_per_torque: free * share }
    }

    pub fn rate(&self, rate: Vec3, torque: Vec3) -> Vec3 {
        rate * self.rate_per_rate + torque * self.rate_per_torque
    }
}

fn faded(x: f64) -> f64 {
    if x < 1e-8 { 1.0 - 0.5 * x } else { -libm::expm1(-x) / x }
}
