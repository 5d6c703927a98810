//! Whether any of many points lies in a surface, told in whole registers.

use tousle_core::Vec3;
use tousle_rod::{Surface, SurfaceShape};

/// Points looked at together.
const LANES: usize = 8;

/// Squares are compared with so much to spare: single precision is off by a hundredth of it.
const TO_SPARE: f32 = 1.0 + 1e-4;

type Lanes = [f32; LANES];

/// A surface in single precision, a hair's breadth larger than it is.
pub(crate) enum Outline {
    Ellipsoid {
        center_m: [f32; 3],
        /// Rows of the matrix that takes it onto the unit sphere.
        to_sphere: [[f32; 3]; 3],
    },
    Capsule {
        a_m: [f32; 3],
        axis: [f32; 3],
        per_length2: f32,
        far2_m2: f32,
    },
    /// A mesh, which has its own way of telling: any point may be in it.
    Anywhere,
}

impl Outline {
    pub(crate) fn of(surface: &Surface) -> Self {
        let single = |v: &Vec3| v.map(|c| c as f32).into();
        match surface.shape() {
            SurfaceShape::Ellipsoid { center_m, to_sphere, .. } => Self::Ellipsoid {
                center_m: single(center_m),
                to_sphere: [0, 1, 2].map(|row| single(&to_sphere.row(row).transpose())),
            },
            SurfaceShape::Capsule { a_m, axis, per_length2, radius_m } => Self::Capsule {
                a_m: single(a_m),
                axis: single(axis),
                per_length2: *per_length2 as f32,
                far2_m2: (radius_m * radius_m) as f32 * TO_SPARE,
            },
            SurfaceShape::Mesh { .. } => Self::Anywhere,
        }
    }

    /// Whether a point lies in any of these surfaces, or by so little outside that single precision cannot tell.
    pub(crate) fn any_entered(outlines: &[Self], points: &[[f32; 3]]) -> bool {
        points.chunks(LANES).any(|chunk| {
            let last = chunk.len() - 1;
            let axis = |axis: usize| -> Lanes { std::array::from_fn(|k| chunk[k.min(last)][axis]) };
            let [x, y, z] = [axis(0), axis(1), axis(2)];
            outlines.iter().any(|outline| outline.entered(&x, &y, &z))
        })
    }

    fn entered(&self, x: &Lanes, y: &Lanes, z: &Lanes) -> bool {
        let mut least = f32::INFINITY;
        match self {
            Self::Ellipsoid { center_m: [cx, cy, cz], to_sphere: [a, b, c] } => {
                let mut level2: Lanes = [0.0; LANES];
                for k in 0..LANES {
                    let (x, y, z) = (x[k] - cx, y[k] - cy, z[k] - cz);
                    let along = |row: &[f32; 3]| row[0] * x + row[1] * y + row[2] * z;
                    let (a, b, c) = (along(a), along(b), along(c));
                    level2[k] = a * a + b * b + c * c;
                }
                level2.iter().for_each(|l| least = least.min(*l));
                least <= TO_SPARE
            }
            Self::Capsule { a_m: [ax, ay, az], axis: [ux, uy, uz], per_length2, far2_m2 } => {
                let mut distance2: Lanes = [0.0; LANES];
                for k in 0..LANES {
                    let (x, y, z) = (x[k] - ax, y[k] - ay, z[k] - az);
                    let share = ((x * ux + y * uy + z * uz) * per_length2).clamp(0.0, 1.0);
                    let (x, y, z) = (x - ux * share, y - uy * share, z - uz * share);
                    distance2[k] = x * x + y * y + z * z;
                }
                distance2.iter().for_each(|d| least = least.min(*d));
                least <= *far2_m2
            }
            Self::Anywhere => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;
    use tousle_core::{Pose, Shape};

    /// What the surface says is in, is in; what is in and is not, is so by less than a tenth of a millimeter.
    #[test]
    fn an_outline_holds_what_its_surface_holds() {
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
            let outline = [Outline::of(&surface)];
            let mut n_in = 0;
            for k in 0..20_000 {
                let digit =
                    |axis: usize| (libm::sin((3 * k + axis) as f64 * 78.233) * 43_758.547 % 1.0) as f32;
                let point = [0, 1, 2].map(|axis| 0.2 * digit(axis));
                let found = Outline::any_entered(&outline, &[[9.0; 3], point, [9.0; 3]]);
                let distance_m = surface.gap(Vec3::from(point.map(f64::from))).distance_m;
                assert!(if found { distance_m < 1e-4 } else { distance_m > 0.0 }, "{point:?}: {distance_m}");
                n_in += u32::from(found);
            }
            assert!((200..19_000).contains(&n_in), "{n_in}");
        }
    }
}
