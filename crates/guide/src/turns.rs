//! How far each stick of a strand has turned since it hung still.

use nalgebra::Matrix3;
use tousle_core::Vec3;

/// A strand's sticks at rest, and from what they turn.
pub(crate) struct AtRest {
    /// Directions of the sticks.
    directions: Vec<Vec3>,
    /// From each stick to the next, at rest, the other way round.
    back: Vec<Matrix3<f64>>,
}

impl AtRest {
    pub(crate) fn new(curve: &[Vec3]) -> Self {
        let directions = directions(curve);
        let back = directions.windows(2).map(|pair| turn(&pair[1], &pair[0])).collect();
        Self { directions, back }
    }

    /// The rotation of each stick from rest to where `curve` has it, without twist along the strand.
    ///
    /// A cross carried from stick to stick by the smallest turns, from the root on (Bishop 1975: parallel
    /// transport), turns as the material of a round rod without twist does. Comparing it with the same at rest
    /// gives for each stick a rotation R with R · rest direction = direction, that changes smoothly in time
    /// wherever the stick points, also straight against its rest direction. It does not where a joint folds by
    /// 180°, nor where the stick at the root turns against its own rest direction: into the scalp.
    pub(crate) fn turns(&self, curve: &[Vec3], out: &mut Vec<Matrix3<f64>>) {
        let now = directions(curve);
        let mut rotation = turn(&self.directions[0], &now[0]);
        out.push(rotation);
        for (pair, back) in now.windows(2).zip(&self.back) {
            rotation = turn(&pair[0], &pair[1]) * rotation * back;
            out.push(rotation);
        }
    }
}

/// Directions of a polyline's sticks. A stick without length points as the one before.
fn directions(curve: &[Vec3]) -> Vec<Vec3> {
    let mut last = -Vec3::z();
    let direction = |pair: &[Vec3]| {
        last = (pair[1] - pair[0]).try_normalize(1e-12).unwrap_or(last);
        last
    };
    curve.windows(2).map(direction).collect()
}

/// The smallest rotation that takes one unit vector to another; between opposite ones some half turn.
fn turn(from: &Vec3, to: &Vec3) -> Matrix3<f64> {
    let cos = from.dot(to);
    if cos < -1.0 + 1e-9 {
        let across = from.cross(&Vec3::ith(from.iamin(), 1.0)).normalize();
        return across * across.transpose() * 2.0 - Matrix3::identity();
    }
    let cross = from.cross(to).cross_matrix();
    Matrix3::identity() + cross + cross * cross / (1.0 + cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smallest_turns() {
        let (x, y) = (Vec3::x(), Vec3::y());
        let quarter = turn(&x, &y);
        assert!((quarter * x - y).norm() < 1e-15 && (quarter * Vec3::z() - Vec3::z()).norm() < 1e-15);
        let half = turn(&x, &-x);
        assert!((half * x + x).norm() < 1e-15 && (half.determinant() - 1.0).abs() < 1e-15);
    }

    /// A helix at rest, all of it turned by a rotation about its root's direction: no stick knows of it but by its
    /// own direction, and every stick has turned by exactly that rotation or one that takes it to the same place.
    #[test]
    fn turns_take_each_stick_where_it_is() {
        let helix = |phase: f64| -> Vec<Vec3> {
            (0..30)
                .map(|k| {
                    let a = 0.4 * f64::from(k) + phase;
                    Vec3::new(0.02 * libm::cos(a), 0.02 * libm::sin(a), -0.005 * f64::from(k))
                })
                .collect()
        };
        let (rest, now) = (helix(0.0), helix(1.0));
        let mut turns = Vec::new();
        AtRest::new(&rest).turns(&now, &mut turns);
        for ((rest, now), turn) in directions(&rest).iter().zip(&directions(&now)).zip(&turns) {
            assert!((turn * rest - now).norm() < 1e-13);
            assert!((turn * turn.transpose() - Matrix3::identity()).amax() < 1e-13);
        }
        turns.clear();
        AtRest::new(&rest).turns(&rest, &mut turns);
        assert!(turns.iter().all(|t| (t - Matrix3::identity()).amax() < 1e-13), "at rest nothing has turned");
    }
}
