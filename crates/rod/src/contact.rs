use nalgebra::{Matrix3, Point3};
use std::sync::Arc;
use tousle_core::{Attachment, Body, Pose, Shape, Solid, Vec3};

/// How far a point is from a surface, and which way is out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Distance from the surface, m; negative inside.
    pub distance_m: f64,
    /// Away from the shape, unit length.
    pub normal: Vec3,
}

/// The surface of a collider where it is at one time, head space, ready to be asked for many points.
///
/// Capsules are exact. Ellipsoids give the first-order distance (f − 1)/|∇f| with f = |x/a|: exact on the
/// surface; elsewhere its relative error is about half the distance over the radius of curvature (3 % at 5 mm
/// from a head). Meshes are as exact as their grid ([`tousle_core::DistanceGrid`]). In the middle of a shape, where no
/// direction is nearest, one across it is taken.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface(SurfaceShape);

/// What a [`Surface`] is made of, for those who ask for many points at once.
#[derive(Clone, Debug, PartialEq)]
pub enum SurfaceShape {
    /// All points that a matrix takes onto the unit sphere.
    Ellipsoid {
        /// The center, m.
        center_m: Vec3,
        /// Takes a point about the center to where the ellipsoid is the unit sphere.
        to_sphere: Matrix3<f64>,
        /// The shortest half axis, m.
        shortest_half_axis_m: f64,
        /// How flat it is: [`Surface::steepness`].
        steepness: f64,
    },
    /// All points at a distance from a line segment.
    Capsule {
        /// One end of the segment, m.
        a_m: Vec3,
        /// From there to the other end, m.
        axis: Vec3,
        /// 1 / |axis|², or 0 for a sphere.
        per_length2: f64,
        /// The distance, m.
        radius_m: f64,
    },
    /// What a mesh encloses.
    Mesh {
        /// The mesh in its own space.
        solid: Arc<Solid>,
        /// From head space to the mesh's own.
        solid_from_head: Pose,
    },
}

impl Surface {
    /// What it is made of.
    pub fn shape(&self) -> &SurfaceShape {
        &self.0
    }

    /// The surface of a shape in its own space.
    pub fn new(shape: &Shape) -> Self {
        Self(match shape {
            Shape::Ellipsoid { center_m, half_axes_m } => SurfaceShape::Ellipsoid {
                center_m: *center_m,
                to_sphere: Matrix3::from_diagonal(&half_axes_m.map(|a| 1.0 / a)),
                shortest_half_axis_m: half_axes_m.min(),
                steepness: steepness(half_axes_m.max() / half_axes_m.min()),
            },
            Shape::Capsule { a_m, b_m, radius_m } => {
                let axis = b_m - a_m;
                let length2 = axis.norm_squared();
                let per_length2 = if length2 > 0.0 { 1.0 / length2 } else { 0.0 };
                SurfaceShape::Capsule { a_m: *a_m, axis, per_length2, radius_m: *radius_m }
            }
            Shape::Mesh(solid) => {
                SurfaceShape::Mesh { solid: Arc::clone(solid), solid_from_head: Pose::identity() }
            }
        })
    }

    /// The surfaces of a body whose torso is at `head_from_torso`, in the body's order, head space.
    pub fn of_body(body: &Body, head_from_torso: &Pose) -> Vec<Self> {
        let place = |collider: &tousle_core::Collider| match collider.attachment {
            Attachment::Head => Self::new(&collider.shape),
            Attachment::Torso => Self::new(&collider.shape).moved(head_from_torso),
        };
        body.colliders.iter().map(place).collect()
    }

    /// The same surface carried along by a pose.
    pub fn moved(&self, pose: &Pose) -> Self {
        Self(match &self.0 {
            SurfaceShape::Ellipsoid { center_m, to_sphere, shortest_half_axis_m, steepness } => {
                SurfaceShape::Ellipsoid {
                    center_m: (pose * Point3::from(*center_m)).coords,
                    to_sphere: to_sphere * pose.rotation.inverse().to_rotation_matrix().matrix(),
                    shortest_half_axis_m: *shortest_half_axis_m,
                    steepness: *steepness,
                }
            }
            SurfaceShape::Capsule { a_m, axis, per_length2, radius_m } => SurfaceShape::Capsule {
                a_m: (pose * Point3::from(*a_m)).coords,
                axis: pose.rotation * axis,
                per_length2: *per_length2,
                radius_m: *radius_m,
            },
            SurfaceShape::Mesh { solid, solid_from_head } => SurfaceShape::Mesh {
                solid: Arc::clone(solid),
                solid_from_head: solid_from_head * pose.inverse(),
            },
        })
    }

    /// The most that the distance shrinks by for each meter that a point outside goes, ≥ 1: 1 for a true distance, as capsules
    /// and, but for what their grid leaves out, meshes have it, and for ellipsoids no flatter than a head.
    pub fn steepness(&self) -> f64 {
        match &self.0 {
            SurfaceShape::Ellipsoid { steepness, .. } => *steepness,
            SurfaceShape::Capsule { .. } | SurfaceShape::Mesh { .. } => 1.0,
        }
    }

    /// The gap between a point and the surface.
    pub fn gap(&self, point_m: Vec3) -> Gap {
        self.gap_within(point_m, f64::INFINITY)
            .unwrap_or(Gap { distance_m: f64::INFINITY, normal: Vec3::z() })
    }

    /// The gap between a point and the surface if it is at most `limit_m`, ≥ 0. Far points are told cheaply.
    #[inline]
    pub fn gap_within(&self, point_m: Vec3, limit_m: f64) -> Option<Gap> {
        let gap = match &self.0 {
            SurfaceShape::Ellipsoid { center_m, to_sphere, shortest_half_axis_m, .. } => {
                let scaled = to_sphere * (point_m - center_m);
                let level2 = scaled.norm_squared();
                // |∇f| is at most one over the shortest half axis.
                let far = 1.0 + limit_m / shortest_half_axis_m;
                if level2 > far * far {
                    return None;
                }
                let level = level2.sqrt();
                if level < 1e-9 {
                    return Some(Gap { distance_m: -shortest_half_axis_m, normal: Vec3::z() });
                }
                let gradient = to_sphere.tr_mul(&scaled) / level;
                let slope = gradient.norm();
                Gap { distance_m: (level - 1.0) / slope, normal: gradient / slope }
            }
            SurfaceShape::Capsule { a_m, axis, per_length2, radius_m } => {
                let from_a = point_m - a_m;
                let share = (from_a.dot(axis) * per_length2).clamp(0.0, 1.0);
                let away = from_a - axis * share;
                let distance2 = away.norm_squared();
                let far = radius_m + limit_m;
                if distance2 > far * far {
                    return None;
                }
                let distance = distance2.sqrt();
                let normal = if distance > 1e-12 { away / distance } else { sideways(axis) };
                Gap { distance_m: distance - radius_m, normal }
            }
            SurfaceShape::Mesh { solid, solid_from_head } => mesh_gap(solid, solid_from_head, point_m),
        };
        (gap.distance_m <= limit_m).then_some(gap)
    }
}

/// [`Surface::steepness`] of an ellipsoid, from its longest half axis over its shortest; at most 8 % too large.
fn steepness(longest_over_shortest: f64) -> f64 {
    // With B = diag(1/a), f = |Bx|, u = Bx/f, g = |Bu| and t = (f − 1)/f, between 0 and 1 outside, the distance is (f − 1)/g and
    // its gradient (1 + t) Bu/g − t B³u/g³. The length of that is convex in t, so largest at one end: 1 on the surface, and far
    // out the root of Σ p (2 − q)² with p = (Bu)²/g² and q = B²/g², axis by axis. The p add up to 1 and so do the p/q, so
    // g² = 1 / Σ p/B². While g is held the sum is linear in p under two conditions, so it is largest where two axes share it. With
    // p the share of the shorter one, whose B² is k times the other's, it is
    // 1 + p (1 − p) (k − 1)² ((1 − p) (k − 2)/k − p (2k − 1)/k²): 1 at most up to k = 2; beyond, p (1 − p)² ≤ 4/27 bounds it, and
    // the bound grows with k.
    let k = longest_over_shortest * longest_over_shortest;
    (1.0 + 4.0 / 27.0 * (k - 1.0) * (k - 1.0) * f64::max(k - 2.0, 0.0) / k).sqrt()
}

/// The gap between a point of head space and what a mesh encloses.
fn mesh_gap(solid: &Solid, solid_from_head: &Pose, point_m: Vec3) -> Gap {
    let (distance_m, out) = solid.distances.gap((solid_from_head * Point3::from(point_m)).coords);
    Gap { distance_m, normal: solid_from_head.rotation.inverse() * out }
}

fn sideways(axis: &Vec3) -> Vec3 {
    let out = axis.cross(&Vec3::x());
    if out.norm() > 1e-9 * axis.norm() { out.normalize() } else { Vec3::z() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;
    use std::f64::consts::FRAC_PI_2;

    const HEAD: Shape =
        Shape::Ellipsoid { center_m: Vec3::new(0.0, 0.0, 0.0), half_axes_m: Vec3::new(0.095, 0.075, 0.1) };
    const CAPSULE: Shape =
        Shape::Capsule { a_m: Vec3::new(0.0, -0.15, 0.0), b_m: Vec3::new(0.0, 0.15, 0.0), radius_m: 0.07 };

    #[test]
    fn on_the_axes_an_ellipsoids_gap_is_exact() {
        let head = Surface::new(&HEAD);
        for (point, distance, normal) in [
            (Vec3::new(0.1, 0.0, 0.0), 0.005, Vec3::x()),
            (Vec3::new(0.0, -0.08, 0.0), 0.005, -Vec3::y()),
            (Vec3::new(0.0, 0.0, 0.09), -0.01, Vec3::z()),
        ] {
            let found = head.gap(point);
            assert!((found.distance_m - distance).abs() < 1e-15);
            assert!((found.normal - normal).norm() < 1e-12);
        }
        assert!(head.gap(Vec3::zeros()).distance_m < -0.05);
    }

    /// The distance's slope at many points outside, by differences: never steeper than it is said to be, and nearly so somewhere.
    #[test]
    fn an_ellipsoids_distance_is_as_steep_as_it_is_said_to_be() {
        const N: u16 = 40;
        for half_axes_m in [
            Vec3::new(0.095, 0.075, 0.1),
            Vec3::repeat(0.1),
            Vec3::new(0.1, 0.071, 0.08),
            Vec3::new(0.1, 0.05, 0.1),
            Vec3::new(0.1, 0.03, 0.1),
            Vec3::new(0.02, 0.1, 0.02),
            Vec3::new(0.1, 0.04, 0.005),
        ] {
            let surface = Surface::new(&Shape::Ellipsoid { center_m: Vec3::zeros(), half_axes_m });
            let mut steepest: f64 = 0.0;
            for k in 0..N * N * 8 {
                let turn = |k: u16| libm::sincos(f64::from(k % N) / f64::from(N - 1) * FRAC_PI_2);
                let ((sin, cos), (up, level)) = (turn(k), turn(k / N));
                let out = 1.01 * libm::pow(3.0, f64::from(k / (N * N)));
                let point: Vec3 = Vec3::new(cos * level, sin * level, up).component_mul(&half_axes_m) * out;
                let step = 1e-6 * point.norm();
                let rise = |way: Vec3| {
                    surface.gap(point + way * step).distance_m - surface.gap(point - way * step).distance_m
                };
                let slope = Vec3::new(rise(Vec3::x()), rise(Vec3::y()), rise(Vec3::z())) / (2.0 * step);
                steepest = steepest.max(slope.norm());
            }
            let said = surface.steepness();
            assert!(steepest < said + 1e-6, "{half_axes_m}: {steepest}, said to be {said}");
            assert!(steepest > 0.9 * said, "{half_axes_m}: {steepest}, said to be {said}");
        }
    }

    #[test]
    fn a_capsules_gap_is_exact() {
        let capsule = Surface::new(&CAPSULE);
        let side = capsule.gap(Vec3::new(0.06, 0.1, 0.08));
        assert!((side.distance_m - 0.03).abs() < 1e-15);
        assert!((side.normal - Vec3::new(0.6, 0.0, 0.8)).norm() < 1e-12);
        let end = capsule.gap(Vec3::new(0.0, 0.25, 0.0));
        assert!((end.distance_m - 0.03).abs() < 1e-15);
        let middle = capsule.gap(Vec3::zeros());
        assert!((middle.distance_m + 0.07).abs() < 1e-15 && (middle.normal.norm() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_carried_surface_meets_carried_points() {
        let pose = Pose::from_parts(
            Vec3::new(0.1, -0.2, 0.3).into(),
            UnitQuaternion::from_euler_angles(0.3, -0.7, 1.1),
        );
        let point = Vec3::new(0.05, 0.08, 0.06);
        for shape in [HEAD, CAPSULE] {
            let here = Surface::new(&shape).gap(point);
            let there = Surface::new(&shape).moved(&pose).gap((pose * Point3::from(point)).coords);
            assert!((here.distance_m - there.distance_m).abs() < 1e-14);
            assert!((pose.rotation * here.normal - there.normal).norm() < 1e-12);
        }
    }

    #[test]
    fn far_points_are_left_out_and_near_ones_are_not() {
        let head = Surface::new(&HEAD);
        assert!(head.gap_within(Vec3::new(0.0, 0.0, 0.104), 0.005).is_some());
        assert!(head.gap_within(Vec3::new(0.0, 0.0, 0.106), 0.005).is_none());
        assert!(Surface::new(&CAPSULE).gap_within(Vec3::new(0.1, 0.0, 0.0), 0.02).is_none());
    }
}
