use crate::Integrator;
use core::f64::consts::FRAC_PI_2;
use tousle_lanes::{Lane, Vector, fade, squared_chord};

/// E1 of one joint over one step: I1 Φ″ + I2 Φ′ + τ Φ = H, Φ counted from where the stick is now.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointEquation<L> {
    /// 1 / I1, 1/(kg·m²).
    pub per_inertia: L,
    /// I2, N·m·s.
    pub resistance: L,
    /// τ, N·m.
    pub strength: L,
}

/// What one step does with a joint's rate: `rate_per_rate Φ′ + rate_per_torque H`.
///
/// A rate here is the mean rate over a step: the turn is the new rate times the step, whatever the integrator.
/// So a contact that bounds the rates bounds the angles too.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointStep<L> {
    pub rate_per_rate: L,
    pub rate_per_torque: L,
}

impl<L: Lane> JointStep<L> {
    /// The step of an integrator.
    #[inline(always)]
    pub fn new(integrator: Integrator, joint: JointEquation<L>, dt_secs: f64) -> Self {
        match integrator {
            Integrator::SemiImplicit => Self::semi_implicit(joint, dt_secs),
            _ => Self::exponential(joint, dt_secs),
        }
    }

    #[inline(always)]
    fn semi_implicit(joint: JointEquation<L>, dt_secs: f64) -> Self {
        let one = joint.strength.same(1.0);
        let free = joint.per_inertia * joint.strength.same(dt_secs);
        let rate_per_rate = one / free.mul_add(joint.resistance, one);
        Self { rate_per_rate, rate_per_torque: free * rate_per_rate }
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
    #[inline(always)]
    fn exponential(joint: JointEquation<L>, dt_secs: f64) -> Self {
        let JointEquation { per_inertia, resistance, strength } = joint;
        let (zero, half, dt) = (strength.same(0.0), strength.same(0.5), strength.same(dt_secs));
        let free = per_inertia * dt;
        let fades = resistance * free * half;
        let phase2 = strength * free * dt;
        let faded = fade(fades);
        let remains = strength.same(1.0) + faded;
        let swing2 = phase2 - fades * fades;
        // |1 − exp(−fade + iω)|², as a sum of squares.
        let phase2_seen = swing2.max(zero).min(strength.same(FRAC_PI_2 * FRAC_PI_2));
        let mut share = (faded * faded + remains * squared_chord(phase2_seen)) / phase2;
        if !swing2.all_above(zero) {
            let fast = fades + (-swing2).max(zero).sqrt();
            // The slow root from the product of both: their difference would cancel.
            let slow = fast.above(zero, phase2 / fast, zero);
            share = swing2.above(zero, share, mean_fade(fast) * mean_fade(slow));
        }
        Self { rate_per_rate: remains * remains, rate_per_torque: free * share }
    }

    /// The rate after the step, under a torque that leaves out the joint's own resistance.
    #[inline(always)]
    pub fn rate(&self, rate: Vector<L>, torque: Vector<L>) -> Vector<L> {
        rate.mul_add(self.rate_per_rate, torque * self.rate_per_torque)
    }
}

/// (1 − e^(−x)) / x: the mean of what is left while it fades.
#[inline(always)]
fn mean_fade<L: Lane>(x: L) -> L {
    let small = x.same(1e-8);
    x.above(small, -fade(x) / x.max(small), x.same(-0.5).mul_add(x, x.same(1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_lanes::F64x1;

    /// A joint with I = 2.
    fn joint(resistance: f64, strength: f64) -> JointEquation<F64x1> {
        let [resistance, strength] = [resistance, strength].map(F64x1::splat);
        JointEquation { per_inertia: F64x1::splat(0.5), resistance, strength }
    }

    /// What a step does with a rate and with a torque.
    fn step(integrator: Integrator, joint: JointEquation<F64x1>, dt_secs: f64) -> (f64, f64) {
        let step = JointStep::new(integrator, joint, dt_secs);
        (step.rate_per_rate.get(0), step.rate_per_torque.get(0))
    }

    /// Angles after each of `n` steps under H = 1, from angle 0 and a mean rate before it.
    fn angles(
        integrator: Integrator,
        joint: JointEquation<F64x1>,
        n: usize,
        dt_secs: f64,
        rate: f64,
    ) -> Vec<f64> {
        let (per_rate, per_torque) = step(integrator, joint, dt_secs);
        let strength = joint.strength.get(0);
        let (mut phi, mut rate) = (0.0, rate);
        (0..n)
            .map(|_| {
                let torque = 1.0 - strength * phi;
                rate = per_rate * rate + per_torque * torque;
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
        let (per_rate, per_torque) = step(Integrator::Exponential, joint(2.0, 0.0), 0.7);
        assert!((per_rate - libm::exp(-0.7)).abs() < 1e-15);
        assert!((per_torque - 0.5 * (1.0 - libm::exp(-0.7))).abs() < 1e-15);
        assert_eq!(step(Integrator::Exponential, joint(0.0, 0.0), 0.7), (1.0, 0.35));
    }

    /// Just under and just over critical damping, and around no strength, the coefficients meet.
    #[test]
    fn the_branches_meet() {
        for (a, b) in [((4.0, 2.0 - 1e-9), (4.0, 2.0 + 1e-9)), ((1e-3, 0.0), (1e-3, 1e-12))] {
            let [a, b] = [a, b].map(|(c, k)| step(Integrator::Exponential, joint(c, k), 0.3).1);
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
