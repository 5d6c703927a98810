//! An object's own transform: operations in `.ops`, their numbers in `.vals`.

use nalgebra::{Matrix4, Unit, Vector3};

use super::bad;
use super::ogawa::Archive;
use super::properties::Compound;
use crate::error::GroomReadError;

/// From an object's space to its parent's.
pub(super) struct Local {
    pub(super) matrix: Matrix4<f64>,
    /// Whether the transforms above count too.
    pub(super) inherits: bool,
    /// Whether a later sample differs.
    pub(super) changes: bool,
}

pub(super) fn read(archive: &Archive<'_>, xform: &Compound, path: &str) -> Result<Local, GroomReadError> {
    let mut changes = false;
    let mut numbers = |name: &str| -> Result<Vec<f64>, GroomReadError> {
        let Some(values) = xform.numbers(archive, name, path)? else { return Ok(Vec::new()) };
        changes |= values.changes;
        Ok(values.numbers)
    };
    let (ops, values) = (numbers(".ops")?, numbers(".vals")?);
    let mut rest = values.as_slice();
    let mut matrix: Matrix4<f64> = Matrix4::identity();
    for op in &ops {
        // The lower bits are a hint for editors.
        let kind = *op as u8 >> 4;
        let n = match kind {
            0 | 1 => 3,
            2 => 4,
            3 => 16,
            4..=6 => 1,
            _ => return Err(bad(path, &format!("a transform operation {kind}"), "0 to 6")),
        };
        let Some((these, others)) = rest.split_at_checked(n) else {
            return Err(bad(path, &format!("{} values for its transform", values.len()), "more"));
        };
        rest = others;
        // The first operation is the outermost.
        matrix *= operation(kind, these);
    }
    if !matrix.iter().all(|x| x.is_finite()) {
        return Err(bad(path, "a transform that is not finite", "finite numbers"));
    }
    let inherits = numbers(".inherits")?.first().is_none_or(|x| *x != 0.0);
    Ok(Local { matrix, inherits, changes })
}

/// The matrix of an operation, for column vectors.
fn operation(kind: u8, v: &[f64]) -> Matrix4<f64> {
    let turn = |axis: Vector3<f64>, degrees: f64| match Unit::try_new(axis, 1e-12) {
        Some(axis) => turn(axis, degrees.to_radians()),
        None => Matrix4::identity(),
    };
    match kind {
        0 => Matrix4::new_nonuniform_scaling(&Vector3::new(v[0], v[1], v[2])),
        1 => Matrix4::new_translation(&Vector3::new(v[0], v[1], v[2])),
        2 => turn(Vector3::new(v[0], v[1], v[2]), v[3]),
        // Written row after row for row vectors.
        3 => Matrix4::from_column_slice(v),
        4 => turn(Vector3::x(), v[0]),
        5 => turn(Vector3::y(), v[0]),
        _ => turn(Vector3::z(), v[0]),
    }
}

/// A turn about an axis, rad (Rodrigues).
fn turn(axis: Unit<Vector3<f64>>, angle: f64) -> Matrix4<f64> {
    let (sin, cos) = libm::sincos(angle);
    let cross = axis.cross_matrix();
    let rotation = nalgebra::Matrix3::identity() + cross * sin + cross * cross * (1.0 - cos);
    rotation.to_homogeneous()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    #[test]
    fn operations_by_hand() {
        let matrix = [0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 10.0, 0.0, 0.0, 1.0];
        for (kind, values, expected) in [
            (0, &[2.0, 3.0, 4.0][..], [2.0, 6.0, 12.0]),
            (1, &[1.0, 1.0, 1.0], [2.0, 3.0, 4.0]),
            (2, &[0.0, 0.0, 5.0, 90.0], [-2.0, 1.0, 3.0]),
            (3, &matrix, [8.0, 1.0, 3.0]),
            (4, &[90.0], [1.0, -3.0, 2.0]),
            (5, &[90.0], [3.0, 2.0, -1.0]),
            (6, &[90.0], [-2.0, 1.0, 3.0]),
        ] {
            let found = operation(kind, values).transform_point(&Point3::new(1.0, 2.0, 3.0));
            assert!((found - Point3::from(expected)).norm() < 1e-12, "{kind}: {found}");
        }
    }
}
