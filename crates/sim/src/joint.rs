use crate::Integrator;
use core::f64::consts::FRAC_PI_2;
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

/// What one step does with a joint's rate: `rate_per_rate Φ′ + rate_per_torque H`.
///
/// A rate here is the mean rate over a step: the turn is the new rate times the step, whatever the integrator.
/// So a contact that bounds the rates bounds the angles too.
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
            _ => Self::exponential(joint, dt_secs),
        }
    }

    fn semi_implicit(joint: JointEquation, dt_secs: f64) -> Self {
        let inertia = joint.inertia + dt_secs * joint.resistance;
        Self { rate_per_rate: joint.inertia / inertia, rate_per_torque: dt_secs / inertia }
    }

    /// The exact solution under a constant H, seen once a step.
    ///
    /// Three angles of a damped oscillation, a step apart, obey Φ₊ − (λ₁ + λ₂) Φ + λ₁ λ₂ Φ₋ = (1 − λ₁)(1 − λ₂) H/τ
    /// with λ = exp(μ dt), μ the roots of I1 μ² + I2 μ + τ. In mean rates, Φ₊ − Φ = dt · rate, that is
    /// ```text
    /// rate₊ = λ₁ λ₂ rate + (1 − λ₁)(1 − λ₂) / (dt τ) · (H − τ Φ)
    /// ```
    ///
    /// and `H − τ Φ` is the torque at the present angle. Written with (1 − λ)/(−μ dt), which tends to 1, it has
    /// no case of its own for a joint without strength or without resistance.
    ///
    /// A swing that is seen less than four times a period is given a period of four steps: half a period from
    /// one step to the next, the angles alone would not tell how fast it swings, and it could grow unseen. So no
    /// step is too long: a joint swings by at most 1 + √2 times the angle at which it would balance the torque.
    fn exponential(joint: JointEquation, dt_secs: f64) -> Self {
        let fade = 0.5 * joint.resistance / joint.inertia * dt_secs;
        let phase2 = joint.strength / joint.inertia * dt_secs * dt_secs;
        let free = dt_secs / joint.inertia;
        let faded = libm::expm1(-fade);
        let remains = 1.0 + faded;
        let share = if phase2 > fade * fade {
            // |1 − exp(−fade + iω)|², as a sum of squares.
            let phase = (phase2 - fade * fade).sqrt();
            let sin = libm::sin(0.5 * phase.min(FRAC_PI_2));
            (faded * faded + 4.0 * remains * sin * sin) / phase2
        } else {
            let fast = fade + (fade * fade - phase2).sqrt();
            // The slow root from the product of both: their difference would cancel.
            let slow = if fast > 0.0 { phase2 / fast } else { 0.0 };
            mean_fade(fast) * mean_fade(slow)
        };
        Self { rate_per_rate: remains * remains, rate_per_torque: free * share }
    }

    /// The rate after the step, under a torque that leaves out the joint's own resistance.
    pub fn rate(&self, rate: Vec3, torque: Vec3) -> Vec3 {
        rate * self.rate_per_rate + torque * self.rate_per_torque
    }
}

/// (1 − e^(−x)) / x: the mean of what is left while it fades.
fn mean_fade(x: f64) -> f64 {
    if x < 1e-8 { 1.0 - 0.5 * x } else { -libm::expm1(-x) / x }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joint(resistance: f64, strength: f64) -> JointEquation {
        JointEquation { inertia: 2.0, resistance, strength }
    }

    /// Angles after each of `n` steps under H = 1, from angle 0 and a mean rate before it.
    fn angles(integrator: Integrator, joint: JointEquation, n: usize, dt_secs: f64, rate: f64) -> Vec<f64> {
        let step = JointStep::new(integrator, joint, dt_secs);
        let (mut phi, mut rate) = (0.0, rate);
        (0..n)
            .map(|_| {
                let torque = 1.0 - joint.strength * phi;
                rate = step.rate_per_rate * rate + step.rate_per_torque * torque;
                phi += dt_secs * rate;
                phi
            })
            .collect()
    }

    /// I = 2, c = 0.8, k = 10: β = 0.2, ω = √(5 − 0.04), and Φ = (1 − e^(−βt)(cos ωt + β/ω sin ωt)) / 10 from
    /// rest. With the mean rate that this has before t = 0, long steps meet it to rounding.
    #[test]
    fn an_exponential_step_is_exact() {
        let dt = 0.6;
        let omega = libm::sqrt(4.96);
        let exact = |t: f64| {
            let (sin, cos) = libm::sincos(omega * t);
            (1.0 - libm::exp(-0.2 * t) * (cos + 0.2 / omega * sin)) / 10.0
        };
        let found = angles(Integrator::Exponential, joint(0.8, 10.0), 8, dt, -exact(-dt) / dt);
        for (k, phi) in found.iter().enumerate() {
            assert!((phi - exact(dt * (k + 1) as f64)).abs() < 1e-14, "{k}: {phi}");
        }
    }

    /// Without strength a rate fades as e^(−ct/I): c = 2, I = 2.
    #[test]
    fn resistance_alone_fades_a_rate() {
        let step = JointStep::new(Integrator::Exponential, joint(2.0, 0.0), 0.7);
        assert!((step.rate_per_rate - libm::exp(-0.7)).abs() < 1e-15);
        assert!((step.rate_per_torque - 0.5 * (1.0 - libm::exp(-0.7))).abs() < 1e-15);
        let free = JointStep::new(Integrator::Exponential, joint(0.0, 0.0), 0.7);
        assert_eq!(free, JointStep { rate_per_rate: 1.0, rate_per_torque: 0.35 });
    }

    /// Just under and just over critical damping, and around no strength, the coefficients meet.
    #[test]
    fn the_branches_meet() {
        for (a, b) in [((4.0, 2.0 - 1e-9), (4.0, 2.0 + 1e-9)), ((1e-3, 0.0), (1e-3, 1e-12))] {
            let [a, b] = [a, b]
                .map(|(c, k)| JointStep::new(Integrator::Exponential, joint(c, k), 0.3).rate_per_torque);
            assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
    }

    /// However stiff, an undamped joint swings about its rest angle by at most √2 times that, for ever.
    #[test]
    fn no_joint_is_too_stiff_for_the_exponential_step() {
        for strength in [1.0, 1e3, 1e10, 1e16] {
            let found = angles(Integrator::Exponential, joint(0.0, strength), 10_000, 1.0, 0.0);
            assert!(found.iter().all(|phi| (phi * strength - 1.0).abs() < 1.415), "{strength}");
        }
    }

    /// Semi-implicit Euler keeps to its limit: bounded at 0.99 of 2/ω, lost at 1.01 of it.
    #[test]
    fn the_limit_of_semi_implicit_euler_is_two_over_omega() {
        // I = 2, k = 8: ω = 2.
        let largest = |dt: f64| {
            let found = angles(Integrator::SemiImplicit, joint(0.0, 8.0), 1000, dt, 0.0);
            found.iter().fold(0.0, |a: f64, b| a.max(b.abs()))
        };
        assert!(largest(0.99) < 10.0);
        assert!(largest(1.01) > 1e10);
    }
}
