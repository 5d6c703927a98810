//! How far points are from a surface, and from being near it.

use tousle_lanes::{Lane, Matrix, Vector};
use tousle_rod::{Surface, SurfaceShape};

/// The square of a length that is none, m².
pub(crate) const TINY2: f64 = 1e-24;

/// Distance of points from a surface, m, and the way out, for many strands ([`Surface::gap`]).
#[inline(always)]
pub(crate) fn gaps<L: Lane>(surface: &Surface, place: Vector<L>) -> (L, Vector<L>) {
    match surface.shape() {
        SurfaceShape::Ellipsoid { center_m, to_sphere, shortest_half_axis_m, .. } => {
            let to_sphere = Matrix::same(place.x, to_sphere);
            let scaled = to_sphere.mul_vector(place - Vector::same(place.x, *center_m));
            let level = scaled.norm_squared().sqrt();
            let gradient = to_sphere.transpose_mul(scaled);
            let flattest = 1e-9 / *shortest_half_axis_m;
            let per_slope = gradient.norm_squared().max(place.x.same(flattest * flattest)).per_sqrt();
            // (level − 1) / |∇level|, and ∇level = gradient / level.
            ((level - place.x.same(1.0)) * level * per_slope, gradient * per_slope)
        }
        SurfaceShape::Capsule { a_m, axis, per_length2, radius_m } => {
            let from_a = place - Vector::same(place.x, *a_m);
            let axis = Vector::same(place.x, *axis);
            let share =
                (from_a.dot(axis) * place.x.same(*per_length2)).max(place.x.same(0.0)).min(place.x.same(1.0));
            let away = from_a - axis * share;
            let distance2 = away.norm_squared();
            let per_distance = distance2.max(place.x.same(TINY2)).per_sqrt();
            (distance2 * per_distance - place.x.same(*radius_m), away * per_distance)
        }
        SurfaceShape::Mesh { .. } => looked_up(surface, place),
    }
}

/// [`gaps`] of a mesh: every point looks at nodes of its own, so they are asked one by one.
#[inline(never)]
fn looked_up<L: Lane>(surface: &Surface, place: Vector<L>) -> (L, Vector<L>) {
    let (mut distances, mut normals) = (L::zero(), Vector::zero());
    for lane in 0..L::N {
        let gap = surface.gap(place.get(lane));
        distances.set(lane, gap.distance_m);
        normals.set(lane, gap.normal);
    }
    (distances, normals)
}

/// What is inside a surface and tells with little effort which points are far from it: whoever is farther from its spine than its
/// radius and some distance is farther than that distance from the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Core<L> {
    spine: Spine<L>,
    radius_m: L,
}

#[derive(Clone, Copy, Debug)]
enum Spine<L> {
    /// The origin, to where a map takes points that makes no way longer.
    Origin { map: Matrix<L>, shift_m: Vector<L> },
    /// A line segment.
    Segment { a_m: Vector<L>, axis: Vector<L>, per_length2: L },
}

/// More than rounding takes from or adds to a length in single precision, as a share of it.
const ROUNDING: f64 = 1e-5;

impl<L: Lane> Core<L> {
    /// Of a surface; a mesh has none.
    #[inline(always)]
    pub fn of(surface: &Surface, like: L) -> Option<Self> {
        match surface.shape() {
            // The ball that its shortest half axis makes of it.
            SurfaceShape::Ellipsoid { center_m, to_sphere, shortest_half_axis_m, .. } => {
                let map = to_sphere * *shortest_half_axis_m;
                let shift_m = Vector::same(like, -(map * center_m));
                let spine = Spine::Origin { map: Matrix::same(like, &map), shift_m };
                Some(Self { spine, radius_m: like.same(*shortest_half_axis_m) })
            }
            SurfaceShape::Capsule { a_m, axis, per_length2, radius_m } => {
                let (a_m, axis) = (Vector::same(like, *a_m), Vector::same(like, *axis));
                let spine = Spine::Segment { a_m, axis, per_length2: like.same(*per_length2) };
                Some(Self { spine, radius_m: like.same(*radius_m) })
            }
            SurfaceShape::Mesh { .. } => None,
        }
    }

    /// How far points are from the spine, squared, m².
    #[inline(always)]
    pub fn away2(&self, place: Vector<L>) -> L {
        match &self.spine {
            Spine::Origin { map, shift_m } => map.mul_vector_add(place, *shift_m).norm_squared(),
            Spine::Segment { a_m, axis, per_length2 } => {
                let (from_a, nothing) = (place - *a_m, per_length2.same(0.0));
                let share = (from_a.dot(*axis) * *per_length2).max(nothing).min(nothing.same(1.0));
                axis.mul_add(-share, from_a).norm_squared()
            }
        }
    }

    /// [`Core::away2`] beyond which a point is farther than a distance from the surface, m².
    #[inline(always)]
    pub fn far2(&self, distance_m: L) -> L {
        let away_m = (self.radius_m + distance_m).max(distance_m.same(0.0)) * distance_m.same(1.0 + ROUNDING);
        away_m * away_m
    }

    /// How far a point with some [`Core::away2`] is from the surface at least, m.
    #[inline(always)]
    pub fn least_m(&self, away2: L) -> L {
        away2.sqrt() * away2.same(1.0 - ROUNDING) - self.radius_m
    }
}

/// Where a point was looked at last, and how far it may go from there before it has to be looked at again.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen<L> {
    pub place: Vector<L>,
    pub room_m: L,
}

/// How fast a distance shrinks at least that is gone by, over how fast the point moves: between a grid's nodes a mesh's may be
/// √3 times as steep as a true one.
const STEEP: f64 = 2.0;

/// How far a point may go before it can be nearer to a surface than it may come, m.
#[inline(always)]
pub(crate) fn room<L: Lane>(surface: &Surface, gap: L, clearance_m: L) -> L {
    let never = gap.same(f64::NEG_INFINITY);
    let per_meter = 1.0 / f64::max(surface.steepness(), STEEP);
    let room_m = (gap - clearance_m.max(gap.same(0.0))) * gap.same(per_meter);
    clearance_m.above(never, room_m, gap.same(f64::INFINITY))
}

impl<L: Lane> Seen<L> {
    /// Not looked at yet.
    pub fn not_yet() -> Self {
        Self { place: Vector::zero(), room_m: L::zero() }
    }

    /// Whether no strand's point can have come within a margin of anything, now that it is at a place.
    #[inline(always)]
    pub fn is_far(&self, place: Vector<L>, margin_m: L) -> bool {
        !margin_m.same(1.0).any_above(self.far(place, margin_m))
    }

    /// How much is left of the room, now that the point is at a place, m.
    #[inline(always)]
    pub fn left_m(&self, place: Vector<L>) -> L {
        self.room_m - (place - self.place).norm_squared().sqrt()
    }

    /// 1 for a strand whose point cannot have come within a margin of anything, now that it is at a place; 0 for others.
    #[inline(always)]
    pub fn far(&self, place: Vector<L>, margin_m: L) -> L {
        let room_m = (self.room_m - margin_m).max(margin_m.same(0.0));
        let went2 = (place - self.place).norm_squared();
        (room_m * room_m).above(went2, margin_m.same(1.0), margin_m.same(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;
    use tousle_core::{Pose, Shape, Vec3};
    use tousle_lanes::F64x1;
    use tousle_rod::Gap;

    /// [`Gap`] of one point.
    fn gap_of(surface: &Surface, place: Vec3) -> Gap {
        let (distance, normal) = gaps::<F64x1>(surface, Vector::splat(place));
        Gap { distance_m: distance.get(0), normal: normal.get(0) }
    }

    fn surfaces() -> [Surface; 4] {
        let ellipsoid = |x: f64, y: f64, z: f64| Shape::Ellipsoid {
            center_m: Vec3::zeros(),
            half_axes_m: Vec3::new(x, y, z),
        };
        let pose = Pose::from_parts(
            Vec3::new(0.02, -0.01, 0.03).into(),
            UnitQuaternion::from_euler_angles(0.3, -0.7, 1.1),
        );
        [
            ellipsoid(0.095, 0.075, 0.1),
            ellipsoid(0.1, 0.03, 0.1),
            ellipsoid(0.1, 0.01, 0.01),
            Shape::Capsule {
                a_m: Vec3::new(0.0, -0.15, 0.0),
                b_m: Vec3::new(0.0, 0.15, 0.0),
                radius_m: 0.07,
            },
        ]
        .map(|shape| Surface::new(&shape).moved(&pose))
    }

    #[test]
    fn gaps_are_those_of_the_surface() {
        for surface in surfaces() {
            for point in [Vec3::new(0.1, 0.02, 0.05), Vec3::new(-0.03, 0.2, 0.01), Vec3::new(0.03, 0.02, 0.0)]
            {
                let (found, expected) = (gap_of(&surface, point), surface.gap(point));
                assert!((found.distance_m - expected.distance_m).abs() < 1e-12, "{found:?} {expected:?}");
                assert!((found.normal - expected.normal).norm() < 1e-12, "{found:?} {expected:?}");
            }
        }
    }

    /// Who is far from the core is far from the surface.
    #[test]
    fn a_core_tells_who_is_far() {
        for surface in surfaces() {
            let core = Core::of(&surface, F64x1::zero()).unwrap();
            let mut n_far = 0;
            for k in 0..11 * 11 * 11 {
                let at = Vec3::new(f64::from(k % 11), f64::from(k / 11 % 11), f64::from(k / 121));
                let place = (at / 5.0 - Vec3::repeat(1.0)) * 0.3;
                let gap_m = surface.gap(place).distance_m;
                let away2 = core.away2(Vector::splat(place));
                assert!(core.least_m(away2).get(0) <= gap_m.max(0.0), "{surface:?} {place}");
                for distance_m in [0.0, 0.01, 0.1] {
                    let is_far = away2.get(0) > core.far2(F64x1::splat(distance_m)).get(0);
                    assert!(!is_far || gap_m > distance_m, "{surface:?} {place}: {gap_m}");
                    n_far += usize::from(is_far);
                }
            }
            assert!(n_far > 1000, "{surface:?}: {n_far} far");
            let nowhere = core.far2(F64x1::splat(f64::NEG_INFINITY)).get(0);
            assert_eq!(nowhere, 0.0, "who cannot touch is far everywhere");
        }
    }

    /// Whoever has gone no farther than the room there was is still outside.
    #[test]
    fn who_stays_within_the_room_comes_no_nearer() {
        let on_cube =
            |k: i32, n: i32| Vec3::new(f64::from(k % n), f64::from(k / n % n), f64::from(k / n / n));
        for surface in surfaces() {
            for k in 0..9 * 9 * 9 {
                let from = (on_cube(k, 9) / 4.0 - Vec3::repeat(1.0)) * 0.3;
                let clearance_m = 0.004;
                let room_m = room(
                    &surface,
                    F64x1::splat(gap_of(&surface, from).distance_m),
                    F64x1::splat(clearance_m),
                );
                let seen = Seen { place: Vector::splat(from), room_m };
                for way in 0..27 {
                    let way = (on_cube(way, 3) - Vec3::repeat(1.0)) * (room_m.get(0).max(0.0) * 0.577);
                    let there = Vector::splat(from + way);
                    if seen.is_far(there, F64x1::zero()) {
                        let gap_m = gap_of(&surface, from + way).distance_m;
                        assert!(gap_m > clearance_m, "{from} {way}: {gap_m}");
                    }
                }
            }
        }
    }
}
