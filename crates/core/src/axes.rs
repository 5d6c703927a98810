use crate::{UpAxis, Vec3};
use core::fmt;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion};

/// An axis with a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// +x.
    PlusX,
    /// −x.
    MinusX,
    /// +y.
    PlusY,
    /// −y.
    MinusY,
    /// +z.
    PlusZ,
    /// −z.
    MinusZ,
}

/// How a head's own axes lie in those of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HeadAxes {
    /// Up along the head.
    pub up: Axis,
    /// Where the nose points.
    pub forward: Axis,
}

impl Axis {
    /// The unit vector along the axis.
    pub fn vector(self) -> Vec3 {
        match self {
            Self::PlusX => Vec3::x(),
            Self::MinusX => -Vec3::x(),
            Self::PlusY => Vec3::y(),
            Self::MinusY => -Vec3::y(),
            Self::PlusZ => Vec3::z(),
            Self::MinusZ => -Vec3::z(),
        }
    }

    /// Reads `x`, `+x`, `-x` and so on, in either case; `None` for anything else.
    pub fn from_name(name: &str) -> Option<Self> {
        match name.trim().to_ascii_lowercase().as_str() {
            "x" | "+x" => Some(Self::PlusX),
            "-x" => Some(Self::MinusX),
            "y" | "+y" => Some(Self::PlusY),
            "-y" => Some(Self::MinusY),
            "z" | "+z" => Some(Self::PlusZ),
            "-z" => Some(Self::MinusZ),
            _ => None,
        }
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::PlusX => "x",
            Self::MinusX => "-x",
            Self::PlusY => "y",
            Self::MinusY => "-y",
            Self::PlusZ => "z",
            Self::MinusZ => "-z",
        })
    }
}

impl From<UpAxis> for Axis {
    fn from(up: UpAxis) -> Self {
        match up {
            UpAxis::X => Self::PlusX,
            UpAxis::Y => Self::PlusY,
            UpAxis::Z => Self::PlusZ,
        }
    }
}

impl HeadAxes {
    /// The axes of a file whose up axis this is, if nobody says otherwise: the nose along x where z is up (as in head
    /// space), along z where y is up (as in most character tools), along y where x is up; the same where it is down.
    pub fn usual(up: impl Into<Axis>) -> Self {
        let up = up.into();
        let forward = match up {
            Axis::PlusX | Axis::MinusX => Axis::PlusY,
            Axis::PlusY | Axis::MinusY => Axis::PlusZ,
            Axis::PlusZ | Axis::MinusZ => Axis::PlusX,
        };
        Self { up, forward }
    }

    /// From the file's axes to the head's (x forward, y left, z up), a rotation of zeros and ones; `None` if the two are
    /// not across one another.
    pub fn head_from_file(&self) -> Option<Matrix3<f64>> {
        let (up, forward) = (self.up.vector(), self.forward.vector());
        let rows = [forward.transpose(), up.cross(&forward).transpose(), up.transpose()];
        (up.dot(&forward) == 0.0).then(|| Matrix3::from_rows(&rows))
    }

    /// The inverse of [`HeadAxes::head_from_file`].
    pub fn file_from_head(&self) -> Option<UnitQuaternion<f64>> {
        let file_from_head = Rotation3::from_matrix_unchecked(self.head_from_file()?.transpose());
        Some(UnitQuaternion::from_rotation_matrix(&file_from_head))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nose_of_a_file_with_y_up_points_along_z() {
        let axes = HeadAxes::usual(UpAxis::Y);
        let (head_from_file, file_from_head) =
            (axes.head_from_file().unwrap(), axes.file_from_head().unwrap());
        assert_eq!(head_from_file * Vec3::y(), Vec3::z(), "up is up");
        assert_eq!(head_from_file * Vec3::z(), Vec3::x(), "the nose points along z");
        assert_eq!(head_from_file * Vec3::x(), Vec3::y(), "and x is left");
        assert!((file_from_head * Vec3::x() - Vec3::z()).norm() < 1e-12);
        assert!((file_from_head * Vec3::y() - Vec3::x()).norm() < 1e-12);
    }

    #[test]
    fn axes_of_either_direction_turn_and_never_mirror() {
        let all = ["x", "-x", "y", "-Y", "Z", "-z"].map(|name| Axis::from_name(name).unwrap());
        for up in all {
            let across = all.map(|forward| HeadAxes { up, forward }.head_from_file());
            assert_eq!(across.iter().flatten().count(), 4, "{up}");
            assert!(across.iter().flatten().all(|turn| turn.determinant() == 1.0), "{up}");
            assert_eq!(HeadAxes::usual(up).head_from_file().unwrap() * up.vector(), Vec3::z());
            assert_eq!(Axis::from_name(&up.to_string()), Some(up));
        }
        assert_eq!(Axis::from_name("w"), None);
    }
}
