//! Whether any of many points lies in a surface, told in lanes.

use tousle_lanes::{Lane, MOST_LANES, Matrix, Vector};
use tousle_rod::{Surface, SurfaceShape};

/// Squares are compared with so much to spare: single precision is off by a hundredth of it.
const TO_SPARE: f64 = 1.0 + 1e-4;

/// A surface a hair's breadth larger than it is, the same for all lanes.
pub(crate) enum Outline<L> {
    Ellipsoid {
        center_m: Vector<L>,
        /// Takes it onto the unit sphere.
        to_sphere: Matrix<L>,
    },
    Capsule {
        a_m: Vector<L>,
        axis: Vector<L>,
        per_length2: L,
        far2_m2: L,
    },
    /// A mesh, which has its own way of telling: any point may be in it.
    Anywhere,
}

impl<L: Lane> Outline<L> {
    pub(crate) fn of(surface: &Surface) -> Self {
        match surface.shape() {
            SurfaceShape::Ellipsoid { center_m, to_sphere, .. } => Self::Ellipsoid {
                center_m: Vector::splat(*center_m),
                to_sphere: Matrix::same(L::zero(), to_sphere),
            },
            SurfaceShape::Capsule { a_m, axis, per_length2, radius_m } => Self::Capsule {
                a_m: Vector::splat(*a_m),
                axis: Vector::splat(*axis),
                per_length2: L::splat(*per_length2),
                far2_m2: L::splat(radius_m * radius_m * TO_SPARE),
            },
            SurfaceShape::Mesh { .. } => Self::Anywhere,
        }
    }

    /// Whether a point lies in any of these surfaces, or by so little outside that single precision cannot tell.
    #[inline(always)]
    pub(crate) fn any_entered(outlines: &[Self], like: L, points: &[[f32; 3]]) -> bool {
        points.chunks(L::N).any(|chunk| {
            // Where there are fewer points than lanes, the first again.
            let mut rows = chunk[0].map(|component| [component; MOST_LANES]);
            for (lane, point) in chunk.iter().enumerate() {
                (rows[0][lane], rows[1][lane], rows[2][lane]) = (point[0], point[1], point[2]);
            }
            let places = Vector::of_single(like, &rows, 0);
            outlines.iter().any(|outline| outline.is_entered(places))
        })
    }

    /// Whether any of these places lies within.
    #[inline(always)]
    fn is_entered(&self, places: Vector<L>) -> bool {
        match self {
            Self::Ellipsoid { center_m, to_sphere } => {
                let level2 = to_sphere.mul_vector(places - *center_m).norm_squared();
                !level2.all_above(level2.same(TO_SPARE))
            }
            Self::Capsule { a_m, axis, per_length2, far2_m2 } => {
                let from_a = places - *a_m;
                let share = from_a.dot(*axis) * *per_length2;
                let share = share.max(share.same(0.0)).min(share.same(1.0));
                let distance2 = (from_a - *axis * share).norm_squared();
                !distance2.all_above(*far2_m2)
            }
            Self::Anywhere => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;
    use tousle_core::{Pose, Shape, Vec3};
    use tousle_lanes::{Precision, Registers, WithLanes};

    struct Check;

    impl WithLanes for Check {
        type Output = ();

        fn with<L: Lane>(self) {
            check::<L>();
        }
    }

    /// What the surface says is in, is in; what is in and is not, is so by less than a tenth of a millimeter.
    #[test]
    fn an_outline_holds_what_its_surface_holds() {
        Registers::here().into_iter().for_each(|registers| registers.with_lanes(Precision::Single, Check));
    }

    fn check<L: Lane>() {
        let head = Shape::Ellipsoid {
            center_m: Vec3::new(0.01, 0.0, -0.02),
            half_axes_m: Vec3::new(0.095, 0.075, 0.1),
        };
        let neck = Shape::Capsule {
            a_m: Vec3::new(0.0, -0.05, 0.1),
            b_m: Vec3::new(0.02, 0.15, 0.0),
            radius_m: 0.07,
        };
        let pose = Pose::from_parts(
            Vec3::new(0.02, 0.01, -0.03).into(),
            UnitQuaternion::from_euler_angles(0.3, -0.7, 1.1),
        );
        for shape in [head, neck] {
            let surface = Surface::new(&shape).moved(&pose);
            let outline = [Outline::<L>::of(&surface)];
            let mut n_in = 0;
            for k in 0..20_000 {
                let digit =
                    |axis: usize| (libm::sin((3 * k + axis) as f64 * 78.233) * 43_758.547 % 1.0) as f32;
                let point = [0, 1, 2].map(|axis| 0.2 * digit(axis));
                let found = Outline::any_entered(&outline, L::zero(), &[[9.0; 3], point, [9.0; 3]]);
                let distance_m = surface.gap(Vec3::from(point.map(f64::from))).distance_m;
                assert!(if found { distance_m < 1e-4 } else { distance_m > 0.0 }, "{point:?}: {distance_m}");
                n_in += u32::from(found);
            }
            assert!((200..19_000).contains(&n_in), "{n_in}");
        }
    }
}
