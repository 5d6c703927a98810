use nalgebra::{Unit, UnitQuaternion};
use tousle_core::Vec3;

/// Vectors that are opposite but for a smaller angle, rad, count as opposite.
const LEAST_SINE: f64 = 1e-8;

/// The rotation vector of the shortest turn from one unit vector to another: its axis times its angle, 0 to π.
///
/// Unlike two angles it has no pole. Between opposite vectors every axis is shortest; one is chosen that
/// depends on the vectors alone.
pub fn shortest_turn(from: Vec3, to: Vec3) -> Vec3 {
    let cross = from.cross(&to);
    let sin2 = cross.norm_squared();
    let cos = from.dot(&to);
    if cos > 0.0 && sin2 < 0.03 {
        return cross * angle_over_sine(sin2);
    }
    let sin = sin2.sqrt();
    if sin > LEAST_SINE {
        cross * (libm::atan2(sin, cos) / sin)
    } else {
        any_perpendicular(from) * core::f64::consts::PI
    }
}

/// Coefficients of arcsin(s)/s in s², the constant first: below 0.03 the first term left out is below 1e-13.
pub const ANGLE_OVER_SINE: [f64; 8] = [
    1.0,
    1.0 / 6.0,
    3.0 / 40.0,
    15.0 / 336.0,
    105.0 / 3456.0,
    945.0 / 42_240.0,
    10_395.0 / 599_040.0,
    135_135.0 / 9_676_800.0,
];

fn angle_over_sine(sin2: f64) -> f64 {
    ANGLE_OVER_SINE.iter().rev().fold(0.0, |sum, term| sum * sin2 + term)
}

/// The rotation of the shortest turn from one unit vector to another.
pub fn shortest_rotation(from: Vec3, to: Vec3) -> UnitQuaternion<f64> {
    let (cos, cross) = (from.dot(&to), from.cross(&to));
    if cos > 0.0 || cross.norm() > LEAST_SINE {
        // Half-angle identities give the quaternion without a trigonometric function.
        let quaternion = nalgebra::Quaternion::new(1.0 + cos, cross.x, cross.y, cross.z);
        UnitQuaternion::new_normalize(quaternion)
    } else {
        UnitQuaternion::from_axis_angle(&Unit::new_unchecked(any_perpendicular(from)), core::f64::consts::PI)
    }
}

/// The y, N·m, for which y · c has the gradient `torque` by a small turn of a joint's outer stick, c = 4 tan(θ/4) along the axis of the
/// joint's turn by θ: `bend` as it stands.
///
/// The map from y to the gradient is (1 + σ²) times a rotation, σ = c/4, so its inverse is its transpose over (1 + σ²)².
pub fn torque_to_load(bend: Vec3, torque: Vec3) -> Vec3 {
    let sigma = bend * 0.25;
    let s2 = sigma.norm_squared();
    let transposed = torque * (1.0 - s2) - sigma.cross(&torque) * 2.0 + sigma * (2.0 * sigma.dot(&torque));
    transposed / ((1.0 + s2) * (1.0 + s2))
}

/// A vector turned by a rotation vector that is at right angles to it (Rodrigues, without the third term).
pub fn turned(vector: Vec3, turn: Vec3) -> Vec3 {
    let angle2 = turn.norm_squared();
    if angle2 < 1e-8 {
        // To fourth order: the error is below 1e-18.
        return vector * (1.0 - 0.5 * angle2) + turn.cross(&vector) * (1.0 - angle2 / 6.0);
    }
    let angle = angle2.sqrt();
    let (sin, cos) = libm::sincos(angle);
    vector * cos + turn.cross(&vector) * (sin / angle)
}

/// A unit vector at right angles to a vector.
pub(crate) fn any_perpendicular(vector: Vec3) -> Vec3 {
    let axis = if vector.x.abs() < 0.6 * vector.norm() { Vec3::x() } else { Vec3::y() };
    vector.cross(&axis).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_meet_their_target() {
        let a = Vec3::new(0.3, -0.4, 0.87).normalize();
        for b in [a, -a, Vec3::x(), -Vec3::y(), (a + Vec3::x() * 1e-5).normalize()] {
            let turn = shortest_turn(a, b);
            assert!(turn.dot(&a).abs() < 1e-12);
            assert!((turned(a, turn) - b).norm() < 1e-9, "{b}");
            assert!((shortest_rotation(a, b) * a - b).norm() < 1e-8, "{b}");
        }
    }

    /// Where the series ends and the arc tangent begins, both give the same.
    #[test]
    fn small_and_large_turns_meet() {
        for angle in [1e-9_f64, 1e-3, 0.17, 0.175] {
            let (sin, cos) = libm::sincos(angle);
            let turn = shortest_turn(Vec3::x(), Vec3::new(cos, sin, 0.0));
            assert!((turn.z / angle - 1.0).abs() < 1e-12, "{angle}: {}", turn.z);
        }
    }

    /// A quarter turn about z carries x to y.
    #[test]
    fn a_quarter_turn() {
        let turn = shortest_turn(Vec3::x(), Vec3::y());
        assert!((turn - Vec3::z() * core::f64::consts::FRAC_PI_2).norm() < 1e-15);
    }
}
