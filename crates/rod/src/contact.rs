use tousle_core::{Attachment, Body, Pose, Shape, Vec3};

/// How far a point is from a surface, and which way is out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Distance from the surface, m; negative inside.
    pub distance_m: f64,
    /// Away from the shape, unit length.
    pub normal: Vec3,
}

/// The gap between a point and a shape, both in the shape's own space, m.
///
/// Exact for capsules. For ellipsoids the first-order distance (f − 1)/|∇f| with f = |x/a|: exact on the
/// surface, its relative error elsewhere about half the distance over the radius of curvature (3 % at 5 mm from
/// a head). In the middle of a shape, where no direction is nearest, the way out is upwards or sideways.
pub fn gap(shape: &Shape, point_m: Vec3) -> Gap {
    match shape {
        Shape::Ellipsoid { center_m, half_axes_m } => ellipsoid_gap(point_m - center_m, half_axes_m),
        Shape::Capsule { a_m, b_m, radius_m } => {
            let axis = b_m - a_m;
            let length2 = axis.norm_squared();
            let share =
                if length2 > 0.0 { ((point_m - a_m).dot(&axis) / length2).clamp(0.0, 1.0) } else { 0.0 };
            let away = point_m - a_m - axis * share;
            let distance = away.norm();
            let normal = if distance > 1e-12 { away / distance } else { sideways(axis) };
            Gap { distance_m: distance - radius_m, normal }
        }
    }
}

fn ellipsoid_gap(from_center: Vec3, half_axes_m: &Vec3) -> Gap {
    let scaled = from_center.component_div(half_axes_m);
    let level = scaled.norm();
    if level < 1e-9 {
        return Gap { distance_m: -half_axes_m.z, normal: Vec3::z() };
    }
    let gradient = scaled.component_div(half_axes_m) / level;
    let slope = gradient.norm();
    Gap { distance_m: (level - 1.0) / slope, normal: gradient / slope }
}

fn sideways(axis: Vec3) -> Vec3 {
    let out = axis.cross(&Vec3::x());
    if out.norm() > 1e-9 * axis.norm() { out.normalize() } else { Vec3::z() }
}

/// The gap to one collider of a body whose torso is at `head_from_torso`; point and normal in head space.
pub fn collider_gap(body: &Body, collider: usize, head_from_torso: &Pose, point_m: Vec3) -> Gap {
    let collider = &body.colliders[collider];
    match collider.attachment {
        Attachment::Head => gap(&collider.shape, point_m),
        Attachment::Torso => {
            let inside = head_from_torso.inverse_transform_point(&point_m.into());
            let gap = gap(&collider.shape, inside.coords);
            Gap { normal: head_from_torso.rotation * gap.normal, ..gap }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: Shape =
        Shape::Ellipsoid { center_m: Vec3::new(0.0, 0.0, 0.0), half_axes_m: Vec3::new(0.095, 0.075, 0.1) };

    #[test]
    fn on_the_axes_an_ellipsoids_gap_is_exact() {
        for (point, distance, normal) in [
            (Vec3::new(0.1, 0.0, 0.0), 0.005, Vec3::x()),
            (Vec3::new(0.0, -0.08, 0.0), 0.005, -Vec3::y()),
            (Vec3::new(0.0, 0.0, 0.09), -0.01, Vec3::z()),
        ] {
            let found = gap(&HEAD, point);
            assert!((found.distance_m - distance).abs() < 1e-15);
            assert!((found.normal - normal).norm() < 1e-12);
        }
        assert!(gap(&HEAD, Vec3::zeros()).distance_m < -0.05);
    }

    #[test]
    fn a_capsules_gap_is_exact() {
        let capsule = Shape::Capsule {
            a_m: Vec3::new(0.0, -0.15, 0.0),
            b_m: Vec3::new(0.0, 0.15, 0.0),
            radius_m: 0.07,
        };
        let side = gap(&capsule, Vec3::new(0.06, 0.1, 0.08));
        assert!((side.distance_m - 0.03).abs() < 1e-15);
        assert!((side.normal - Vec3::new(0.6, 0.0, 0.8)).norm() < 1e-12);
        let end = gap(&capsule, Vec3::new(0.0, 0.25, 0.0));
        assert!((end.distance_m - 0.03).abs() < 1e-15);
        let middle = gap(&capsule, Vec3::zeros());
        assert!((middle.distance_m + 0.07).abs() < 1e-15 && (middle.normal.norm() - 1.0).abs() < 1e-12);
    }
}
