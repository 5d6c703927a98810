//! A prim's own transform, from its `xformOpOrder`.
//!
//! Source: `UsdGeomXformable`. The first operation named is the outermost; matrices are written for row vectors.

use std::borrow::Cow;

use nalgebra::{Matrix3, Matrix4, Quaternion, Rotation3, UnitQuaternion, Vector3};

use crate::error::bad;
use crate::{Prim, UsdaError, Value};

/// From a prim's space to its parent's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local {
    /// For column vectors, the layer's unit.
    pub matrix: Matrix4<f64>,
    /// Whether the transforms above do not count.
    pub resets: bool,
}

/// A prim's transform at a time code, or without one its earliest; the identity for one that names no operations.
///
/// Between samples each operation goes evenly from one to the next, an `orient` and the rotation of a `transform`
/// on the shortest way. (USD itself mixes matrices entry by entry, which would shrink what turns.) Before the first
/// and after the last it is held.
///
/// # Errors
/// [`UsdaError`] with the prim's path: an operation that is none or has no value that fits, an inverse of something
/// flat, numbers that are not finite.
pub fn local(prim: &Prim, path: &str, code: Option<f64>) -> Result<Local, UsdaError> {
    let mut local = Local { matrix: Matrix4::identity(), resets: false };
    for name in order(prim) {
        if name == "!resetXformStack!" {
            local = Local { matrix: Matrix4::identity(), resets: true };
            continue;
        }
        let (name, inverted) = match name.strip_prefix("!invert!") {
            Some(name) => (name, true),
            None => (name.as_str(), false),
        };
        let matrix = operation(prim, name, code).ok_or_else(|| {
            bad(path, format!("{name} without a value that fits"), "an operation of UsdGeomXformOp")
        })?;
        local.matrix *= match (inverted, matrix.try_inverse()) {
            (false, _) => matrix,
            (true, Some(inverse)) => inverse,
            (true, None) => {
                return Err(bad(path, format!("!invert!{name} of no inverse"), "one"));
            }
        };
    }
    match local.matrix.iter().all(|x| x.is_finite()) {
        true => Ok(local),
        false => Err(bad(path, "a transform that is not finite", "finite numbers")),
    }
}

/// Names of a prim's operations as its order has them.
fn order(prim: &Prim) -> &[String] {
    match prim.value("xformOpOrder") {
        Some(Value::Texts(order)) => order,
        _ => &[],
    }
}

/// Codes at which a prim's transform has samples, of any of its operations, not in order.
pub(crate) fn codes(prim: &Prim) -> impl Iterator<Item = f64> {
    order(prim).iter().flat_map(|name| prim.codes(name.strip_prefix("!invert!").unwrap_or(name)))
}

/// Whether a prim's own transform changes over time.
pub fn is_animated(prim: &Prim) -> bool {
    order(prim).iter().any(|name| prim.is_animated(name.strip_prefix("!invert!").unwrap_or(name)))
}

/// An operation's numbers at a time code.
fn numbers_at<'a>(prim: &'a Prim, name: &str, kind: &str, code: Option<f64>) -> Option<Cow<'a, [f64]>> {
    let Some(([a, b], share)) = code.and_then(|code| prim.samples_around(name, code)) else {
        return prim.numbers(name).map(Cow::Borrowed);
    };
    if share == 0.0 {
        return Some(Cow::Borrowed(a));
    }
    let mixed = match (kind, a.len() == b.len()) {
        (_, false) => return None,
        ("orient", _) => {
            let turn = quaternion(a)?.try_slerp(&quaternion(b)?, share, 1e-9)?;
            vec![turn.w, turn.i, turn.j, turn.k]
        }
        ("transform", _) => mixed_matrix(a, b, share),
        _ => mixed(a, b, share),
    };
    Some(Cow::Owned(mixed))
}

fn mixed(a: &[f64], b: &[f64], share: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + (b - a) * share).collect()
}

/// Two rigid matrices, evenly scaled perhaps, mixed as such; others entry by entry.
fn mixed_matrix(a: &[f64], b: &[f64], share: f64) -> Vec<f64> {
    let entries = || mixed(a, b, share);
    let [Some(m), Some(n)] = [a, b].map(|v| (v.len() == 16).then(|| Matrix4::from_column_slice(v))) else {
        return entries();
    };
    let parts = |m: &Matrix4<f64>| rotation_and_scale(&m.fixed_view::<3, 3>(0, 0).into_owned());
    let (Some((turn_a, scale_a)), Some((turn_b, scale_b))) = (parts(&m), parts(&n)) else { return entries() };
    let Some(turn) = turn_a.try_slerp(&turn_b, share, 1e-9) else { return entries() };
    let mut out = Matrix4::from_column_slice(&entries());
    let linear = turn.to_rotation_matrix().into_inner() * (scale_a + (scale_b - scale_a) * share);
    out.fixed_view_mut::<3, 3>(0, 0).copy_from(&linear);
    out.iter().copied().collect()
}

/// How far a matrix may be from a rotation, as the largest entry of R Rᵀ − 1: five digits written by hand pass.
const ROTATION_TOLERANCE: f64 = 1e-3;

/// A rotation and an even scale; `None` for what is mirrored, flat, sheared or unevenly scaled.
pub(crate) fn rotation_and_scale(m: &Matrix3<f64>) -> Option<(UnitQuaternion<f64>, f64)> {
    let scale = libm::cbrt(m.determinant());
    let rotation = m / scale;
    let off = (rotation * rotation.transpose() - Matrix3::identity()).amax();
    let is_rotation = scale.is_finite() && scale > 0.0 && off <= ROTATION_TOLERANCE;
    // Not `Rotation3::from_matrix`, which iterates from no turn and gets stuck at a half turn.
    let near = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
    is_rotation.then(|| (UnitQuaternion::new_normalize(near.into_inner()), scale))
}

/// Real part first.
fn quaternion(v: &[f64]) -> Option<UnitQuaternion<f64>> {
    let &[w, x, y, z] = v else { return None };
    UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-9)
}

/// The matrix of `xformOp:KIND[:suffix]`, for column vectors.
fn operation(prim: &Prim, name: &str, code: Option<f64>) -> Option<Matrix4<f64>> {
    let kind = name.strip_prefix("xformOp:")?.split(':').next()?;
    let numbers = numbers_at(prim, name, kind, code)?;
    let v: &[f64] = &numbers;
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
        ("orient", v) => quaternion(v)?.to_homogeneous(),
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
    use super::*;
    use crate::parse;
    use nalgebra::Point3;

    /// Where a prim's transform takes (1, 2, 3).
    fn moved(body: &str) -> Result<Point3<f64>, UsdaError> {
        let layer = parse(format!("def Xform \"a\" {{ {body} }}").as_bytes())?;
        let local = local(&layer.prims[0], "/a", None)?;
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
    fn between_samples_nothing_shrinks() {
        for body in [
            "matrix4d xformOp:transform.timeSamples = { 0: ((1,0,0,0), (0,1,0,0), (0,0,1,0), (0,0,0,1)), \
             10: ((0,1,0,0), (-1,0,0,0), (0,0,1,0), (4,0,0,1)) } uniform token[] xformOpOrder = [\"xformOp:transform\"]",
            "quatf xformOp:orient.timeSamples = { 0: (1, 0, 0, 0), 10: (-0.70710678, 0, 0, -0.70710678) } \
             double xformOp:translateX.timeSamples = { 0: 0, 10: 4 } \
             uniform token[] xformOpOrder = [\"xformOp:translateX\", \"xformOp:orient\"]",
        ] {
            let layer = parse(format!("def Xform \"a\" {{ {body} }}").as_bytes()).unwrap();
            let at = |code| local(&layer.prims[0], "/a", Some(code)).unwrap().matrix;
            let half = at(5.0).transform_point(&Point3::new(1.0, 0.0, 0.0));
            let s = libm::sqrt(0.5);
            assert!((half - Point3::new(2.0 + s, s, 0.0)).norm() < 1e-7, "{half}");
            assert_eq!((at(-1.0), at(11.0)), (at(0.0), at(10.0)), "held");
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
