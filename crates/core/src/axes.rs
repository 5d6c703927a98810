use crate::{UpAxis, Vec3};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion};

/// How a head's own axes lie in those of a file, unit vectors across one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadAxes {
    /// Up along the head.
    pub up: Vec3,
    /// Where the nose points.
    pub forward: Vec3,
}

impl HeadAxes {
    /// The axes of a file whose up axis this is, if nobody says otherwise: the nose along x where z is up (as in head
    /// space), along z where y is up (as in most character tools).
    pub fn usual(up: UpAxis) -> Self {
        let forward = match up {
            UpAxis::X => Vec3::y(),
            UpAxis::Y => Vec3::z(),
            UpAxis::Z => Vec3::x(),
        };
        Self { up: up.vector(), forward }
    }

    /// From head axes (x forward, y left, z up) to the file's; `None` if the two are not across one another.
    pub fn file_from_head(&self) -> Option<UnitQuaternion<f64>> {
        if self.up.dot(&self.forward).abs() > 1e-6 {
            return None;
        }
        let matrix = Matrix3::from_columns(&[self.forward, self.up.cross(&self.forward), self.up]);
        Some(UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nose_of_a_file_with_y_up_points_along_z() {
        let file_from_head = HeadAxes::usual(UpAxis::Y).file_from_head().unwrap();
        assert!((file_from_head * Vec3::x() - Vec3::z()).norm() < 1e-12);
        assert!((file_from_head * Vec3::y() - Vec3::x()).norm() < 1e-12);
        assert!((file_from_head * Vec3::z() - Vec3::y()).norm() < 1e-12);
        assert_eq!(HeadAxes { up: Vec3::z(), forward: Vec3::z() }.file_from_head(), None);
    }
}
