use nalgebra::{Matrix3, Vector3};
use tousle_core::Vec3;

/// The flow of a frictionless stream round an ellipsoid with its axes along the space's axes.
///
/// Source: Lamb, "Hydrodynamics", 6th edition, §114: the potential of a stream Uᵢ along axis i is
/// Uᵢ xᵢ (1 + Cᵢ αᵢ(λ)) with αᵢ(λ) = abc ∫ ds / ((aᵢ² + s) Δ(s)) from λ on, Cᵢ = 1/(2 − αᵢ(0)), and λ the ellipsoidal
/// coordinate of the point. It is exact; what a real head's flow has beyond it is a thin layer at the scalp and
/// a wake (`shelter`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PotentialFlow {
    center_m: Vec3,
    half_axes_m: Vec3,
    /// Cᵢ.
    strength: Vec3,
}

impl PotentialFlow {
    /// The flow round an ellipsoid.
    pub fn round(center_m: Vec3, half_axes_m: Vec3) -> Self {
        let alpha = alpha(half_axes_m, 0.0);
        Self { center_m, half_axes_m, strength: alpha.map(|a| 1.0 / (2.0 - a)) }
    }

    /// The matrix that turns the stream far away into the velocity at a point; inside, that at the surface.
    pub fn at(&self, point_m: Vec3) -> Matrix3<f64> {
        let from_center = point_m - self.center_m;
        let level = from_center.component_div(&self.half_axes_m).norm();
        let place = if level < 1.0 { from_center / level.max(1e-9) } else { from_center };
        let lambda = ellipsoidal_coordinate(self.half_axes_m, place);
        let shifted = self.half_axes_m.component_mul(&self.half_axes_m).map(|a2| a2 + lambda);
        let alpha = alpha(self.half_axes_m, lambda);
        let ratio = place.component_div(&shifted);
        let slope = ratio * (2.0 / ratio.norm_squared().max(1e-30));
        let product = self.half_axes_m.iter().product::<f64>() / shifted.iter().product::<f64>().sqrt();
        let mut matrix = Matrix3::identity();
        for axis in 0..3 {
            let fade = -product / shifted[axis];
            let strength = self.strength[axis];
            for component in 0..3 {
                matrix[(component, axis)] += strength * place[axis] * fade * slope[component];
            }
            matrix[(axis, axis)] += strength * alpha[axis];
        }
        matrix
    }
}

/// λ ≥ 0 with Σ xᵢ²/(aᵢ² + λ) = 1, by Newton's method from below on a convex falling function.
fn ellipsoidal_coordinate(half_axes_m: Vec3, point_m: Vec3) -> f64 {
    let squares = half_axes_m.component_mul(&half_axes_m);
    let least = half_axes_m.min();
    // On a sphere of the longest half axis this is exact, on the ellipsoid it is too small: Newton rises from it.
    let mut lambda = f64::max(0.0, point_m.norm_squared() - half_axes_m.max() * half_axes_m.max());
    for _ in 0..50 {
        let shifted = squares.map(|a2| a2 + lambda);
        let terms = point_m.component_mul(&point_m).component_div(&shifted);
        let excess = terms.sum() - 1.0;
        let slope = terms.component_div(&shifted).sum();
        let step = excess / slope;
        lambda = f64::max(lambda + step, 0.0);
        if step.abs() < 1e-12 * least * least {
            break;
        }
    }
    lambda
}

/// αᵢ(λ) for the three axes: 2/3 abc `R_D`, Carlson's integral ("Numerical computation of real or complex elliptic
/// integrals", 1995).
fn alpha(half_axes_m: Vec3, lambda: f64) -> Vec3 {
    let shifted = half_axes_m.component_mul(&half_axes_m).map(|a2| a2 + lambda);
    let product: f64 = half_axes_m.iter().product();
    let of_axis = |i: usize| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        2.0 / 3.0 * product * carlson_rd(shifted[j], shifted[k], shifted[i])
    };
    Vector3::new(of_axis(0), of_axis(1), of_axis(2))
}

/// `R_D(x, y, z)` by duplication, to about 1e-9.
fn carlson_rd(mut x: f64, mut y: f64, mut z: f64) -> f64 {
    let mut sum = 0.0;
    let mut power = 1.0;
    loop {
        let mean = (x + y + 3.0 * z) / 5.0;
        let (dx, dy) = ((mean - x) / mean, (mean - y) / mean);
        let dz = -(dx + dy) / 3.0;
        if dx.abs().max(dy.abs()).max(dz.abs()) < 0.02 {
            let xy = dx * dy;
            let z2 = dz * dz;
            let e2 = xy - 6.0 * z2;
            let e3 = (3.0 * xy - 8.0 * z2) * dz;
            let e4 = 3.0 * (xy - z2) * z2;
            let e5 = xy * z2 * dz;
            let series = 1.0 - 3.0 / 14.0 * e2 + e3 / 6.0 + 9.0 / 88.0 * e2 * e2
                - 3.0 / 22.0 * e4
                - 9.0 / 52.0 * e2 * e3
                + 3.0 / 26.0 * e5;
            return 3.0 * sum + power * series / (mean * mean.sqrt());
        }
        let (rx, ry, rz) = (x.sqrt(), y.sqrt(), z.sqrt());
        let shift = rx * ry + ry * rz + rz * rx;
        sum += power / (rz * (z + shift));
        power *= 0.25;
        x = 0.25 * (x + shift);
        y = 0.25 * (y + shift);
        z = 0.25 * (z + shift);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Round a sphere: 3/2 of the stream at its equator, none at its pole, and 1/2 (a/r)³ of a dipole elsewhere.
    #[test]
    fn round_a_sphere_it_is_the_textbooks() {
        let flow = PotentialFlow::round(Vec3::zeros(), Vec3::repeat(0.1));
        let stream = Vec3::x();
        assert!((flow.at(Vec3::y() * 0.1) * stream - Vec3::x() * 1.5).norm() < 1e-7);
        assert!((flow.at(Vec3::x() * 0.1) * stream).norm() < 1e-7);
        let point = Vec3::new(0.12, -0.2, 0.05);
        let (r, n) = (point.norm(), point.normalize());
        let dipole = (stream - n * (3.0 * n.dot(&stream))) * (0.5 * (0.1 / r) * (0.1 / r) * (0.1 / r));
        assert!((flow.at(point) * stream - stream - dipole).norm() < 1e-7);
    }

    /// Nothing flows through the surface, and far away the stream is undisturbed.
    #[test]
    fn round_a_head_nothing_flows_through_it() {
        let half_axes = Vec3::new(0.095, 0.075, 0.1);
        let center = Vec3::new(0.01, 0.0, -0.02);
        let flow = PotentialFlow::round(center, half_axes);
        let stream = Vec3::new(2.0, -1.0, 0.5);
        for direction in [Vec3::new(1.0, 2.0, 3.0), Vec3::new(-3.0, 0.1, 1.0), Vec3::new(0.2, -2.0, -0.7)] {
            let sphere = direction.normalize();
            let normal = sphere.component_div(&half_axes).normalize();
            let velocity = flow.at(center + sphere.component_mul(&half_axes)) * stream;
            assert!(velocity.dot(&normal).abs() < 1e-7 * stream.norm(), "{velocity}");
            assert!((flow.at(direction * 10.0) * stream - stream).norm() < 1e-5);
        }
    }

    /// The flow has no divergence and no curl.
    #[test]
    fn it_is_a_potential_flow() {
        let flow = PotentialFlow::round(Vec3::zeros(), Vec3::new(0.095, 0.075, 0.1));
        let stream = Vec3::new(1.0, 0.3, -2.0);
        let (p, h) = (Vec3::new(0.09, 0.06, -0.05), 1e-4);
        let gradient = Matrix3::from_fn(|r, c| {
            let mut step = Vec3::zeros();
            step[c] = h;
            ((flow.at(p + step) - flow.at(p - step)) * stream)[r] / (2.0 * h)
        });
        assert!(
            gradient.trace().abs() < 1e-3 && (gradient - gradient.transpose()).norm() < 1e-3,
            "{gradient}"
        );
    }
}
