//! Whether fields are of one wig in one wind: what a simulator gets with them must be the same.

use crate::{Input, MergeError, MergeOptions};
use std::fmt::Debug;
use tousle_core::{Collider, Pose, Shape, Vec3};

/// How far gravity may be from that of the first field, m/s²: half a degree of tilt.
const GRAVITY_TOLERANCE: f64 = 0.1;
/// How far the density of the air may be from that of the first, as a share: five degrees of temperature.
const DENSITY_TOLERANCE: f64 = 0.02;
/// How far friction may be from that of the first. It is a choice and no measurement: in effect, the same.
const FRICTION_TOLERANCE: f64 = 1e-3;

/// Checks that a field can be merged with the first one, between two times of the common clock.
///
/// # Errors
/// [`MergeError::Differ`] with the first thing that differs.
pub(crate) fn check(
    first: &Input<'_>,
    input: &Input<'_>,
    span_secs: [f64; 2],
    options: &MergeOptions,
) -> Result<(), MergeError> {
    let pair = Pair { first, input };
    if first.quantity != input.quantity {
        return Err(pair.differ("quantity", input.quantity.name(), first.quantity.name()));
    }
    let (a, b) = (first.scene, input.scene);
    if (a.gravity_world - b.gravity_world).norm() > GRAVITY_TOLERANCE {
        return Err(pair.differ("gravity", vector(b.gravity_world), vector(a.gravity_world)));
    }
    if (a.air_density - b.air_density).abs() > DENSITY_TOLERANCE * a.air_density {
        return Err(pair.differ("density of the air", b.air_density.to_string(), a.air_density.to_string()));
    }
    body(&pair, options)?;
    poses(&pair, span_secs, options)
}

/// A field and the first one.
struct Pair<'a> {
    first: &'a Input<'a>,
    input: &'a Input<'a>,
}

impl Pair<'_> {
    fn differ(
        &self,
        what: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> MergeError {
        MergeError::Differ {
            what: what.into(),
            name: self.input.name.to_owned(),
            found: found.into(),
            first: self.first.name.to_owned(),
            expected: expected.into(),
        }
    }
}

fn vector(v: Vec3) -> String {
    format!("({:.3}, {:.3}, {:.3})", v.x, v.y, v.z)
}

fn body(pair: &Pair<'_>, options: &MergeOptions) -> Result<(), MergeError> {
    let (a, b) = (&pair.first.scene.body, &pair.input.scene.body);
    let names = |colliders: &[Collider]| {
        let name = |c: &Collider| format!("{} ({:?})", c.name, c.attachment);
        colliders.iter().map(name).collect::<Vec<_>>().join(", ")
    };
    let (expected, found) = (names(&a.colliders), names(&b.colliders));
    if expected != found {
        return Err(pair.differ("colliders", found, expected));
    }
    for (a, b) in a.colliders.iter().zip(&b.colliders) {
        let off = numbers(&a.shape).into_iter().zip(numbers(&b.shape)).map(|(a, b)| (a - b).abs());
        let is_same_kind = std::mem::discriminant(&a.shape) == std::mem::discriminant(&b.shape);
        if !is_same_kind || off.fold(0.0, f64::max) > options.tolerance_m {
            return Err(pair.differ(format!("collider {:?}", a.name), shape(&b.shape), shape(&a.shape)));
        }
    }
    if (a.pivot_m - b.pivot_m).norm() > options.tolerance_m {
        return Err(pair.differ("the head's pivot", vector(b.pivot_m), vector(a.pivot_m)));
    }
    if (a.friction - b.friction).abs() > FRICTION_TOLERANCE {
        return Err(pair.differ("friction", b.friction.to_string(), a.friction.to_string()));
    }
    Ok(())
}

fn shape(shape: &(impl Debug + ?Sized)) -> String {
    format!("{shape:?}")
}

fn numbers(shape: &Shape) -> Vec<f64> {
    match shape {
        Shape::Ellipsoid { center_m, half_axes_m } => {
            center_m.iter().chain(half_axes_m.iter()).copied().collect()
        }
        Shape::Capsule { a_m, b_m, radius_m } => {
            a_m.iter().chain(b_m.iter()).copied().chain([*radius_m]).collect()
        }
        Shape::Mesh(solid) => solid.points_m.iter().flat_map(|p| p.iter().copied()).collect(),
    }
}

/// Heads must be turned alike at all times, and go the same way from where they rested. Where in the room they
/// rested is no matter: a field knows nothing of the room.
fn poses(pair: &Pair<'_>, [from, to]: [f64; 2], options: &MergeOptions) -> Result<(), MergeError> {
    let (first, input) = (pair.first, pair.input);
    let turn = |a: &Pose, b: &Pose| a.rotation.angle_to(&b.rotation);
    let degrees = |radians: f64| format!("{:.2} degrees off", radians.to_degrees());
    let within = format!("at most {:.2} degrees", options.tolerance_rad.to_degrees());
    let rest = turn(&first.scene.rest_pose, &input.scene.rest_pose);
    if rest > options.tolerance_rad {
        return Err(pair.differ("the head's turn at rest", degrees(rest), within));
    }
    let rate_hz = f64::max(first.scene.poses.rate_hz, input.scene.poses.rate_hz);
    let is_still = first.scene.poses.poses.len() == 1 && input.scene.poses.poses.len() == 1;
    let n = if is_still { 0 } else { ((to - from) * rate_hz).ceil().clamp(0.0, 1e8) as u64 };
    for k in 0..=n {
        let secs = from + k as f64 / rate_hz;
        let pose = |input: &Input<'_>| input.scene.poses.motion_at(secs - input.offset_secs).world_from_head;
        let (a, b) = (pose(first), pose(input));
        let off = turn(&a, &b);
        if off > options.tolerance_rad {
            return Err(pair.differ(format!("the head's turn at {secs:.3} s"), degrees(off), within));
        }
        let went = |pose: &Pose, input: &Input<'_>| {
            pose.translation.vector - input.scene.rest_pose.translation.vector
        };
        let off = (went(&a, first) - went(&b, input)).norm();
        if off > options.tolerance_m {
            let found = format!("{:.1} mm off", off * 1e3);
            let expected = format!("at most {:.1} mm", options.tolerance_m * 1e3);
            return Err(pair.differ(format!("the head's way from rest at {secs:.3} s"), found, expected));
        }
    }
    Ok(())
}
