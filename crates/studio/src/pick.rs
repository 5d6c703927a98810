//! Which strand lies under the pointer. On the CPU: a few thousand points are nothing.

use crate::camera::{Eye, Pixel};
use crate::instant::single;
use tousle_core::{Body, Shape, Vec3};

/// How near the pointer must be to a strand, points.
const REACH: f64 = 12.0;
/// Of strands that are nearly as near as the nearest, by so many points, the one in front is meant.
const SLACK: f64 = 4.0;

/// The strand under a place on the picture, if one is there and the head does not hide it.
///
/// In: all control points at this time, strand after strand, head space, m.
pub fn strand_at(
    eye: &Eye,
    at: Pixel,
    counts: &[usize],
    points_m: &[[f32; 3]],
    body: &Body,
) -> Option<usize> {
    let mut found: Vec<(usize, f64, f64)> = Vec::new();
    let mut first = 0;
    for (strand_idx, n) in counts.iter().enumerate() {
        let strand = &points_m[first..first + n];
        first += n;
        let near = strand.windows(2).filter_map(|stick| near(eye, at, stick, body));
        if let Some((distance, depth)) = near.min_by(|a, b| a.0.total_cmp(&b.0)) {
            found.push((strand_idx, distance, depth));
        }
    }
    let nearest = found.iter().map(|f| f.1).fold(REACH, f64::min);
    let meant = found.into_iter().filter(|f| f.1 <= f64::min(nearest + SLACK, REACH));
    meant.min_by(|a, b| a.2.total_cmp(&b.2)).map(|f| f.0)
}

/// How far a stick passes from a place on the picture, points, and how deep it lies there, m.
fn near(eye: &Eye, at: Pixel, stick: &[[f32; 3]], body: &Body) -> Option<(f64, f64)> {
    let [a_m, b_m] = [single(stick[0]), single(stick[1])];
    let (a, b) = (eye.project(a_m)?, eye.project(b_m)?);
    let along = b - a;
    let length2 = along.norm_squared();
    let share = if length2 > 0.0 { ((at - a).dot(&along) / length2).clamp(0.0, 1.0) } else { 0.0 };
    let distance = (at - a - along * share).norm();
    let point_m = a_m.lerp(&b_m, share);
    (distance <= REACH && !is_hidden(eye.position_m, point_m, body)).then(|| (distance, eye.depth_m(point_m)))
}

/// Whether an ellipsoid of the body stands between the camera and a point.
///
/// Hair that lies on the head dips into it by a little, so the ellipsoid counts as a tenth smaller.
pub fn is_hidden(from_m: Vec3, point_m: Vec3, body: &Body) -> bool {
    const SMALLER: f64 = 0.9;
    body.colliders.iter().any(|collider| {
        let Shape::Ellipsoid { center_m, half_axes_m } = &collider.shape else { return false };
        let scaled = |p: Vec3| (p - center_m).component_div(&(*half_axes_m * SMALLER));
        let (from, to) = (scaled(from_m), scaled(point_m));
        let way = to - from;
        // The nearest that the line of sight comes to the middle of what is now the unit sphere.
        let share = (-from.dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
        (from + way * share).norm() < 1.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use crate::testing;
    use tousle_core::{Attachment, Collider, Pose};

    /// The test groom's rest curves seen from the front.
    fn scene() -> (Eye, Vec<usize>, Vec<[f32; 3]>) {
        let groom = testing::groom();
        let points = groom.strands.iter().flat_map(|s| &s.rest_curve_m).map(|p| p.map(|c| c as f32).into());
        let camera = Camera { yaw: 0.0, pitch: 0.0, ..Camera::default() };
        (camera.eye(&Pose::identity(), Pixel::new(800.0, 600.0)), groom.counts(), points.collect())
    }

    #[test]
    fn the_strand_under_the_pointer_is_found() {
        let (eye, counts, points) = scene();
        let body = Body::none();
        for (y, expected) in [(0.001, Some(0)), (0.039, Some(1)), (0.2, None)] {
            let at = eye.project(Vec3::new(0.1, y, -0.06)).unwrap();
            assert_eq!(strand_at(&eye, at, &counts, &points, &body), expected, "{y}");
        }
    }

    #[test]
    fn what_the_head_hides_is_not() {
        let (eye, counts, points) = scene();
        let ball = |x: f64| Body {
            colliders: vec![Collider {
                name: "head".into(),
                shape: Shape::Ellipsoid {
                    center_m: Vec3::new(x, 0.0, -0.05),
                    half_axes_m: Vec3::repeat(0.08),
                },
                attachment: Attachment::Head,
            }],
            ..Body::none()
        };
        let at = eye.project(Vec3::new(0.1, 0.0, -0.06)).unwrap();
        assert_eq!(strand_at(&eye, at, &counts, &points, &ball(0.4)), None);
        assert_eq!(strand_at(&eye, at, &counts, &points, &ball(-0.1)), Some(0));
    }
}
