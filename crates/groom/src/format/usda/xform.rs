//! A prim's own transform, from its `xformOpOrder`.
//!
//! Source: `UsdGeomXformable`. The first operation named is the outermost; matrices are written for row vectors.

use nalgebra::{Matrix4, Quaternion, UnitQuaternion, Vector3};

use super::bad;
use super::layer::{Prim, Value};
use crate::error::GroomReadError;

/// From a prim's space to its parent's.
pub(super) struct Local {
    pub(super) matrix: Matrix4<f64>,
    /// Whether the transforms above do not count.
    pub(super) resets: bool,
}

/// A prim's transform; the identity for one that names no operations.
pub(super) fn local(prim: &Prim, path: &str) -> Result<Local, GroomReadError> {
    let mut local = Local { matrix: Matrix4::identity(), resets: false };
    let order = match prim.value("xformOpOrder") {
        Some(Value::Texts(order)) => order.as_slice(),
        _ => &[],
    };
    for name in order {
        if name == "!resetXformStack!" {
            local = Local { matrix: Matrix4::identity(), resets: true };
            continue;
        }
        let (name, inverted) = match name.strip_prefix("!invert!") {
            Some(name) => (name, true),
            None => (name.as_str(), false),
        };
        let matrix = operation(prim, name).ok_or_else(|| {
            bad(
                path.to_owned(),
                &format!("{name} without a value that fits"),
                "an operation of UsdGeomXformOp",
            )
        })?;
        local.matrix *= match (inverted, matrix.try_inverse()) {
            (false, _) => matrix,
            (true, Some(inverse)) => inverse,
            (true, None) => {
                return Err(bad(path.to_owned(), &format!("!invert!{name} of no inverse"), "one"));
            }
        };
    }
    match local.matrix.iter().all(|x| x.is_finite()) {
        true => Ok(local),
        false => Err(bad(path.to_owned(), "a transform that is not finite", "finite numbers")),
    }
}

/// The matrix of `xformOp:KIND[:suffix]`, for column vectors.
fn operation(prim: &Prim, name: &str) -> Option<Matrix4<f64>> {
    let kind = name.strip_prefix("xformOp:")?.split(':').next()?;
    let v = prim.numbers(name)?;
    let axis = |k: usize, x: f64, other: f64| {
        let mut all = Vector3::repeat(other);
        all[k] = x;
        all
    };
    Some(match (kind, v) {
        ("transform", v) if v.len() == 16 => Matrix4::from_column_slice(v),
        ("translate", &[x, y, z]) => Matrix4::new_translation(&Vector3::new(x, y, z)),
        ("translateX", &[x]) => Matrix4::new_translation(&axis(0, x, 0.0)),
        ("translateY", &[y]) => Matrix4::new_translation(&axis(1, y, 0.0)),
        ("translateZ", &[z]) => Matrix4::new_translation(&axis(2, z, 0.0)),
        ("scale", &[x, y, z]) => Matrix4::new_nonuniform_scaling(&Vector3::new(x, y, z)),
        ("scaleX", &[x]) => Matrix4::new_nonuniform_scaling(&axis(0, x, 1.0)),
        ("scaleY", &[y]) => Matrix4::new_nonuniform_scaling(&axis(1, y, 1.0)),
        ("scaleZ", &[z]) => Matrix4::new_nonuniform_scaling(&axis(2, z, 1.0)),
        // Real part first.
        ("orient", &[w, x, y, z]) => {
            UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-9)?.to_homogeneous()
        }
        ("rotateX", &[angle]) => turn(0, angle),
        ("rotateY", &[angle]) => turn(1, angle),
        ("rotateZ", &[angle]) => turn(2, angle),
        (kind, &[x, y, z]) => {
            let order = kind.strip_prefix("rotate").filter(|o| ROTATION_ORDERS.contains(o))?;
            // XYZ turns about x first, so x is the innermost factor.
            order.bytes().fold(Matrix4::identity(), |all, axis| {
                let axis = usize::from(axis - b'X');
                turn(axis, [x, y, z][axis]) * all
            })
        }
        _ => return None,
    })
}

const ROTATION_ORDERS: [&str; 6] = ["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"];

/// A turn about an axis, degrees.
fn turn(axis: usize, degrees: f64) -> Matrix4<f64> {
    let (sin, cos) = libm::sincos(degrees.to_radians());
    let mut matrix = Matrix4::identity();
    let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
    matrix[(a, a)] = cos;
    matrix[(b, b)] = cos;
    matrix[(b, a)] = sin;
    matrix[(a, b)] = -sin;
    matrix
}

#[cfg(test)]
mod tests {
    use super::super::parser::parse;
    use super::*;
    use nalgebra::Point3;

    /// Where a prim's transform takes (1, 2, 3).
    fn moved(body: &str) -> Result<Point3<f64>, GroomReadError> {
        let layer = parse(&format!("def Xform \"a\" {{ {body} }}"))?;
        let local = local(&layer.prims[0], "/a")?;
        Ok(local.matrix.transform_point(&Point3::new(1.0, 2.0, 3.0)))
    }

    #[test]
    fn operations_by_hand() {
        for (body, expected) in [
            ("", [1.0, 2.0, 3.0]),
            ("double3 xformOp:translate = (5, 0, 0)", [1.0, 2.0, 3.0]), // not in the order: does not count
            (
                "double3 xformOp:translate = (5, 0, 0) float3 xformOp:scale = (2, 2, 2) \
                 uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:scale\"]",
                [7.0, 4.0, 6.0],
            ),
            (
                "double3 xformOp:translate:pivot = (1, 2, 0) float xformOp:rotateZ = 90 uniform token[] xformOpOrder \
                 = [\"xformOp:translate:pivot\", \"xformOp:rotateZ\", \"!invert!xformOp:translate:pivot\"]",
                [1.0, 2.0, 3.0],
            ),
            (
                "matrix4d xformOp:transform = ((0, 1, 0, 0), (-1, 0, 0, 0), (0, 0, 1, 0), (10, 0, 0, 1)) \
                 uniform token[] xformOpOrder = [\"xformOp:transform\"]",
                [8.0, 1.0, 3.0],
            ),
            // About x first: (1, -3, 2), then about z: (3, 1, 2).
            (
                "float3 xformOp:rotateXYZ = (90, 0, 90) uniform token[] xformOpOrder = [\"xformOp:rotateXYZ\"]",
                [3.0, 1.0, 2.0],
            ),
            // About z first: (-2, 1, 3), then about x: (-2, -3, 1).
            (
                "float3 xformOp:rotateZXY = (90, 0, 90) uniform token[] xformOpOrder = [\"xformOp:rotateZXY\"]",
                [-2.0, -3.0, 1.0],
            ),
            (
                "quatf xformOp:orient = (0, 0, 0, 2) uniform token[] xformOpOrder = [\"xformOp:orient\"]",
                [-1.0, -2.0, 3.0],
            ),
        ] {
            let found = moved(body).unwrap();
            assert!((found - Point3::from(expected)).norm() < 1e-12, "{body}: {found}");
        }
    }

    #[test]
    fn operations_that_cannot_be_done() {
        for body in [
            "uniform token[] xformOpOrder = [\"xformOp:translate\"]",
            "double xformOp:translate = 1 uniform token[] xformOpOrder = [\"xformOp:translate\"]",
            "float3 xformOp:rotateXXX = (1, 2, 3) uniform token[] xformOpOrder = [\"xformOp:rotateXXX\"]",
            "float3 xformOp:scale = (0, 1, 1) uniform token[] xformOpOrder = [\"!invert!xformOp:scale\"]",
            "float3 xformOp:scale = (inf, 1, 1) uniform token[] xformOpOrder = [\"xformOp:scale\"]",
        ] {
            assert!(moved(body).is_err(), "{body}");
        }
    }
}
