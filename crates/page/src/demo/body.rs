use crate::Packed;
use serde::Serialize;
use tousle_core::{Attachment, Collider, Session, Shape};
use tousle_field::Scene;

/// What the hair hangs on, as the page's script gets it.
///
/// The page draws in torso space (head space at rest), where the shoulders stand still and the head turns about
/// the pivot: `p_torso = pivot + turn * (p_head - pivot)`.
#[derive(Serialize)]
pub(super) struct BodyData {
    /// Away from gravity, torso space, unit length.
    up: [f64; 3],
    pivot_m: [f64; 3],
    shapes: Vec<ShapeData>,
    /// Where the session's head markers sit, head space, m.
    head_markers_m: Vec<[f64; 3]>,
    /// How the head turns; `None` if it does not.
    turn: Option<TurnData>,
}

#[derive(Serialize)]
struct ShapeData {
    name: String,
    /// Whether it turns with the head; otherwise it stays with the torso.
    on_head: bool,
    #[serde(flatten)]
    form: Form,
}

#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Form {
    Ellipsoid { center_m: [f64; 3], half_axes_m: [f64; 3] },
    Capsule { a_m: [f64; 3], b_m: [f64; 3], radius_m: f64 },
}

/// `torso_from_head` over time: unit quaternions x y z w in 32,767ths.
#[derive(Serialize)]
struct TurnData {
    start_secs: f64,
    rate_hz: f64,
    n: usize,
    quaternions: Packed,
}

/// Turns a second that are kept, and turns in all.
const TURN_RATE_HZ: f64 = 60.0;
const MAX_TURNS: f64 = 3_600.0;

/// Turns below this are no motion to the eye, rad.
const STILL_RAD: f64 = 1e-4;

/// What the page draws the hair on.
pub(super) fn body_data(
    scene: &Scene,
    session: &Session,
    span_secs: [f64; 2],
    blobs: &mut Vec<Packed>,
) -> BodyData {
    let gravity = scene.rest_pose.rotation.inverse() * scene.gravity_world;
    let up = (-gravity).try_normalize(1e-9).unwrap_or_else(tousle_core::Vec3::z);
    BodyData {
        up: up.into(),
        pivot_m: scene.body.pivot_m.into(),
        shapes: scene.body.colliders.iter().filter_map(shape_data).collect(),
        head_markers_m: session.head_markers.iter().map(|m| m.position_m.into()).collect(),
        turn: turn_data(scene, span_secs, blobs),
    }
}

/// A shape of a field's body; a mesh, which no field has, is not drawn.
fn shape_data(collider: &Collider) -> Option<ShapeData> {
    let form = match &collider.shape {
        Shape::Ellipsoid { center_m, half_axes_m } => {
            Form::Ellipsoid { center_m: (*center_m).into(), half_axes_m: (*half_axes_m).into() }
        }
        Shape::Capsule { a_m, b_m, radius_m } => {
            Form::Capsule { a_m: (*a_m).into(), b_m: (*b_m).into(), radius_m: *radius_m }
        }
        Shape::Mesh(_) => return None,
    };
    let on_head = collider.attachment == Attachment::Head;
    Some(ShapeData { name: collider.name.clone(), on_head, form })
}

fn turn_data(scene: &Scene, [first, last]: [f64; 2], blobs: &mut Vec<Packed>) -> Option<TurnData> {
    let rate_hz = f64::min(TURN_RATE_HZ, MAX_TURNS / (last - first).max(1e-9));
    let n = ((last - first) * rate_hz).ceil() as usize + 1;
    let turns: Vec<_> = (0..n)
        .map(|k| scene.poses.motion_at(first + k as f64 / rate_hz).world_from_head.rotation)
        .map(|rotation| scene.rest_pose.rotation.inverse() * rotation)
        .collect();
    if turns.iter().all(|turn| turn.angle() < STILL_RAD) {
        return None;
    }
    let mut previous = turns[0].coords;
    let mut values = Vec::with_capacity(4 * n);
    for turn in &turns {
        // A quaternion and its negative are the same turn; neighbors must be near each other to be interpolated.
        let coords = if turn.coords.dot(&previous) < 0.0 { -turn.coords } else { turn.coords };
        values.extend(coords.iter().map(|c| (c * f64::from(i16::MAX)).round() as i16));
        previous = coords;
    }
    let quaternions = Packed::new("head-turn", &values, &[&[4], &[4, 4]]);
    blobs.push(quaternions.clone());
    Some(TurnData { start_secs: first, rate_hz, n, quaternions })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;
    use tousle_core::{Body, Pose, PoseTrack, Vec3};

    /// Torso space must agree with `Body::head_from_torso`, which the simulator uses.
    #[test]
    fn the_turn_is_the_inverse_of_what_the_simulator_uses() {
        let pose = |yaw: f64| {
            Pose::from_parts(
                Vec3::new(1.0, 2.0, 1.5).into(),
                UnitQuaternion::from_euler_angles(0.1, 0.2, yaw),
            )
        };
        let body = Body { pivot_m: Vec3::new(-0.02, 0.0, -0.11), ..Body::none() };
        let (rest, turned) = (pose(0.3), pose(1.1));
        let torso_from_head = body.head_from_torso(&turned, &rest).inverse();
        let turn = rest.rotation.inverse() * turned.rotation;
        let point = Vec3::new(0.1, 0.05, 0.07);
        let drawn = body.pivot_m + turn * (point - body.pivot_m);
        assert!((drawn - (torso_from_head * nalgebra::Point3::from(point)).coords).norm() < 1e-12);
    }

    #[test]
    fn a_still_head_carries_no_turns() {
        let rest_pose = Pose::identity();
        let scene = Scene {
            poses: PoseTrack::still(rest_pose),
            rest_pose,
            gravity_world: Vec3::new(0.0, 0.0, -9.81),
            air_density: 1.2,
            body: Body::none(),
        };
        let mut blobs = Vec::new();
        assert!(turn_data(&scene, [0.0, 5.0], &mut blobs).is_none());
        assert!(blobs.is_empty());
    }
}
