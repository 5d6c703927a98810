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

/// What one step does with a joint: its turn, and its rate afterwards, are linear in torque and rate.
///
/// `turn = turn_per_rate Φ′ + turn_per_torque T` and `rate = rate_per_rate Φ′ + rate_per_torque T`, where T is
/// the whole torque at the step's start, resistance and strength included.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct JointStep {
    pub turn_per_rate: f64,
    pub turn_per_torque: f64,
    pub rate_per_rate: f64,
    pub rate_per_torque: f64,
}

impl JointStep {
    /// The step of an integrator.
    pub fn new(integrator: Integrator, joint: JointEquation, dt_secs: f64) -> Self {
        match integrator {
            Integrator::SemiImplicit => Self::euler(joint.inertia + dt_secs * joint.resistance, dt_secs),
            Integrator::Implicit => {
                let stiff = dt_secs * dt_secs * joint.strength;
                Self::euler(joint.inertia + dt_secs * joint.resistance + stiff, dt_secs)
            }
            Integrator::Exponential => Self::exponential(joint, dt_secs),
        }
    }

    /// New rate from the torque over an inertia that stands for what is implicit; the turn from the new rate.
    fn euler(inertia: f64, dt_secs: f64) -> Self {
        let rate_per_torque = dt_secs / inertia;
        Self {
            turn_per_rate: dt_secs,
            turn_per_torque: dt_secs * rate_per_torque,
            rate_per_rate: 1.0,
            rate_per_torque,
        }
    }

    /// The exact solution with H frozen: a damped oscillation about the angle at which strength balances H.
    fn exponential(joint: JointEquation, dt_secs: f64) -> Self {
        let JointEquation { inertia, resistance, strength } = joint;
        let decay = 0.5 * resistance / inertia;
        let (cos, sin) = damped_cos_sin(decay, strength / inertia, dt_secs);
        // With T = H − I2 Φ′ at the step's start, H = T + I2 Φ′ drives the oscillation, which starts at rest angle 0.
        let rate_per_torque = sin / inertia;
        let turn_per_torque = if strength * dt_secs * dt_secs > 1e-4 * inertia {
            (1.0 - cos - decay * sin) / strength
        } else {
            soft_turn(joint, dt_secs)
        };
        Self {
            turn_per_rate: sin + resistance * turn_per_torque,
            turn_per_torque,
            rate_per_rate: cos + decay * sin,
            rate_per_torque,
        }
    }

    /// The turn over the step.
    pub fn turn(&self, rate: Vec3, torque: Vec3) -> Vec3 {
        rate * self.turn_per_rate + torque * self.turn_per_torque
    }

    /// The rate at the end of the step.
    pub fn rate(&self, rate: Vec3, torque: Vec3) -> Vec3 {
        rate * self.rate_per_rate + torque * self.rate_per_torque
    }
}

/// `e^(−βt) cos ωt` and `e^(−βt) sin(ωt)/ω` with ω² = stiffness − β², also where that is negative or near 0.
fn damped_cos_sin(decay: f64, stiffness: f64, t: f64) -> (f64, f64) {
    let omega2 = stiffness - decay * decay;
    let phase2 = omega2 * t * t;
    if phase2.abs() < 1e-6 {
        // cos x = 1 − x²/2, sin(x)/x = 1 − x²/6: the error is below 1e-13.
        let fade = libm::exp(-decay * t);
        (fade * (1.0 - 0.5 * phase2), fade * t * (1.0 - phase2 / 6.0))
    } else if omega2 > 0.0 {
        let omega = omega2.sqrt();
        let (sin, cos) = libm::sincos(omega * t);
        let fade = libm::exp(-decay * t);
        (fade * cos, fade * sin / omega)
    } else {
        let root = (-omega2).sqrt();
        // −β + √(β² − k) written without cancellation.
        let slow = libm::exp(-stiffness / (decay + root) * t);
        let fast = libm::exp(-(decay + root) * t);
        (0.5 * (slow + fast), 0.5 * (slow - fast) / root)
    }
}

/// `turn_per_torque` where strength hardly acts within the step: that of resistance alone, by its power series
/// where that is weak too. What is left out is below 1e-4 / 12 of it.
fn soft_turn(joint: JointEquation, dt_secs: f64) -> f64 {
    let x = joint.resistance / joint.inertia * dt_secs;
    let share = if x < 1e-2 {
        0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x / 120.0))
    } else {
        (x + libm::expm1(-x)) / (x * x)
    };
    // The oscillation's own first correction, −k t²/12 of the undamped turn, keeps both branches together.
    let strength = joint.strength * dt_secs * dt_secs / joint.inertia;
    share * dt_secs * dt_secs / joint.inertia * (1.0 - strength / 12.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joint(resistance: f64, strength: f64) -> JointEquation {
        JointEquation { inertia: 2.0, resistance, strength }
    }

    /// One exponential step of any length is the closed form of the damped oscillator.
    #[test]
    fn one_exponential_step_is_exact() {
        // I = 2, c = 0.8, k = 10: β = 0.2, ω = √(5 − 0.04). From rest under H = 10: Φ = 1 − e^(−βt)(cos + β/ω sin).
        let t = 1.7;
        let step = JointStep::new(Integrator::Exponential, joint(0.8, 10.0), t);
        let omega = libm::sqrt(4.96);
        let fade = libm::exp(-0.2 * t);
        let phi = 1.0 - fade * (libm::cos(omega * t) + 0.2 / omega * libm::sin(omega * t));
        assert!((step.turn_per_torque * 10.0 - phi).abs() < 1e-14);
        let rate = fade * 5.0 / omega * libm::sin(omega * t);
        assert!((step.rate_per_torque * 10.0 - rate).abs() < 1e-14);
    }

    /// Starting with a rate, T holds the resistance −c Φ′: 1 rad/s, c = 2, k = 0 slows to e^(−t).
    #[test]
    fn resistance_slows_exactly() {
        let step = JointStep::new(Integrator::Exponential, joint(2.0, 0.0), 0.7);
        let rate = step.rate_per_rate + step.rate_per_torque * -2.0;
        assert!((rate - libm::exp(-0.7)).abs() < 1e-15, "{rate}");
        let turn = step.turn_per_rate + step.turn_per_torque * -2.0;
        assert!((turn - (1.0 - libm::exp(-0.7))).abs() < 1e-14, "{turn}");
    }

    /// Halves of a step make the whole, for soft, stiff, weakly and strongly damped joints.
    #[test]
    fn two_halves_make_a_whole() {
        for strength in [0.0, 1e-5, 1e-3, 1.0, 1e4, 1e10] {
            for resistance in [0.0, 1e-3, 2.0, 1e3, 1e7] {
                let joint = joint(resistance, strength);
                let whole = run(joint, 1, 0.1);
                let halves = run(joint, 2, 0.05);
                for (a, b) in [(whole.0, halves.0), (whole.1, halves.1)] {
                    assert!((a - b).abs() < 2e-6 * (1.0 + a.abs()), "{strength} {resistance}: {a} {b}");
                }
            }
        }
    }

    /// Angle and rate after some steps under H = 1 from angle 0, rate 1.
    fn run(joint: JointEquation, n: usize, dt_secs: f64) -> (f64, f64) {
        let step = JointStep::new(Integrator::Exponential, joint, dt_secs);
        let (mut phi, mut rate) = (0.0, 1.0);
        for _ in 0..n {
            let torque = 1.0 - joint.resistance * rate - joint.strength * phi;
            let turn = step.turn_per_rate * rate + step.turn_per_torque * torque;
            rate = step.rate_per_rate * rate + step.rate_per_torque * torque;
            phi += turn;
        }
        (phi, rate)
    }

    #[test]
    fn no_step_is_too_stiff_for_the_implicit_ones() {
        for integrator in [Integrator::Implicit, Integrator::Exponential] {
            let joint = joint(0.1, 1e10);
            let step = JointStep::new(integrator, joint, 1.0);
            let (mut phi, mut rate) = (0.0_f64, 1.0_f64);
            for _ in 0..1000 {
                let torque = -joint.resistance * rate - joint.strength * phi;
                let turn = step.turn_per_rate * rate + step.turn_per_torque * torque;
                rate = step.rate_per_rate * rate + step.rate_per_torque * torque;
                phi += turn;
            }
            assert!(phi.abs() < 1.0 && rate.abs() < 1.1, "{integrator:?}: {phi} {rate}");
        }
    }
}
