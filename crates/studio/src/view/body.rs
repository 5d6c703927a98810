//! The body as triangles.

use nalgebra::Vector3;
use tousle_core::{Attachment, Body, Shape, Solid, Vec3};

/// Two vectors a vertex: place and whether it stays with the torso (1) or moves with the head (0); normal.
pub fn mesh(body: &Body) -> Vec<[f32; 4]> {
    body.colliders
        .iter()
        .flat_map(|collider| {
            let torso = f32::from(u8::from(collider.attachment == Attachment::Torso));
            match &collider.shape {
                Shape::Ellipsoid { center_m, half_axes_m } => {
                    let has_face = collider.attachment == Attachment::Head;
                    let scale = |d: Vec3| if has_face { 1.0 + face(d) } else { 1.0 };
                    surface(torso, |d| *center_m + half_axes_m.component_mul(&d) * scale(d))
                }
                Shape::Capsule { a_m, b_m, radius_m } => {
                    let along = (b_m - a_m).try_normalize(1e-9).unwrap_or_else(Vec3::z);
                    let turn = nalgebra::Rotation3::rotation_between(&Vec3::z(), &along)
                        .unwrap_or_else(|| nalgebra::Rotation3::from_axis_angle(&Vec3::x_axis(), PI));
                    surface(torso, move |d| {
                        let end = if d.z >= 0.0 { b_m } else { a_m };
                        *end + turn * d * *radius_m
                    })
                }
                Shape::Mesh(solid) => triangles(torso, solid),
            }
        })
        .collect()
}

const PI: f64 = std::f64::consts::PI;

/// Rings and segments of a closed surface.
const N_RINGS: usize = 48;
const N_SEGMENTS: usize = 64;

/// The hint of a nose and of eyes, so that one sees where a head faces: how far the surface stands out in a
/// direction, as a share. Hair is not pushed by it.
fn face(d: Vec3) -> f64 {
    if d.x <= 0.0 {
        return 0.0;
    }
    let bump = |y: f64, z: f64, wide: f64, high: f64| {
        let (y, z) = ((d.y - y) / wide, (d.z - z) / high);
        libm::exp(-(y * y + z * z))
    };
    0.13 * bump(0.0, -0.22, 0.11, 0.16) + 0.06 * bump(0.0, -0.02, 0.09, 0.22)
        - 0.035 * (bump(0.36, 0.02, 0.2, 0.14) + bump(-0.36, 0.02, 0.2, 0.14))
        + 0.02 * bump(0.0, -0.55, 0.25, 0.08)
}

/// A vertex's two vectors.
fn vertex(torso: f32, place: Vec3, normal: Vec3) -> [[f32; 4]; 2] {
    let single = |v: Vec3, w: f32| {
        let v: Vector3<f32> = v.map(|c| c as f32);
        [v.x, v.y, v.z, w]
    };
    [single(place, torso), single(normal, 0.0)]
}

/// Triangles of a mesh, each as flat as it is.
fn triangles(torso: f32, solid: &Solid) -> Vec<[f32; 4]> {
    let of_triangle = |corners: &[u32; 3]| {
        let corners = corners.map(|corner| solid.points_m[corner as usize]);
        let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
        let normal = normal.try_normalize(1e-12).unwrap_or_else(Vec3::z);
        corners.into_iter().flat_map(move |corner| vertex(torso, corner, normal))
    };
    solid.triangles.iter().flat_map(of_triangle).collect()
}

/// Triangles of a closed surface around its middle, from the place in each direction.
fn surface(torso: f32, place: impl Fn(Vec3) -> Vec3) -> Vec<[f32; 4]> {
    let at = |ring: usize, segment: usize| {
        let (sin_ring, cos_ring) = libm::sincos(PI * ring as f64 / N_RINGS as f64);
        let (sin, cos) = libm::sincos(2.0 * PI * (segment % N_SEGMENTS) as f64 / N_SEGMENTS as f64);
        place(Vec3::new(sin_ring * cos, sin_ring * sin, cos_ring))
    };
    // Normals of neighboring triangles are averaged, so that the surface looks smooth.
    let normal = |ring: usize, segment: usize| {
        let (above, below) = (ring.saturating_sub(1), (ring + 1).min(N_RINGS));
        let down = at(below, segment) - at(above, segment);
        let around = at(ring.clamp(1, N_RINGS - 1), segment + 1)
            - at(ring.clamp(1, N_RINGS - 1), segment + N_SEGMENTS - 1);
        match ring {
            0 => at(0, 0) - at(1, 0).lerp(&at(1, N_SEGMENTS / 2), 0.5),
            N_RINGS => at(N_RINGS, 0) - at(N_RINGS - 1, 0).lerp(&at(N_RINGS - 1, N_SEGMENTS / 2), 0.5),
            _ => down.cross(&around),
        }
        .try_normalize(1e-12)
        .unwrap_or_else(Vec3::z)
    };
    let vertex_at = |(ring, segment): (usize, usize)| vertex(torso, at(ring, segment), normal(ring, segment));
    let mut vertices = Vec::with_capacity(12 * N_RINGS * N_SEGMENTS);
    for ring in 0..N_RINGS {
        for segment in 0..N_SEGMENTS {
            let [a, b] = [(ring, segment), (ring, segment + 1)];
            let [c, d] = [(ring + 1, segment), (ring + 1, segment + 1)];
            vertices.extend([a, c, b, b, c, d].into_iter().flat_map(vertex_at));
        }
    }
    vertices
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::Collider;

    #[test]
    fn normals_point_outwards() {
        let capsule = Collider {
            name: "neck".into(),
            shape: Shape::Capsule { a_m: Vec3::zeros(), b_m: Vec3::new(0.0, 0.1, -0.1), radius_m: 0.05 },
            attachment: Attachment::Torso,
        };
        let ball = Collider {
            name: "head".into(),
            shape: Shape::Ellipsoid { center_m: Vec3::zeros(), half_axes_m: Vec3::new(0.1, 0.08, 0.12) },
            attachment: Attachment::Head,
        };
        for (collider, middle) in [(capsule, Vector3::new(0.0, 0.05, -0.05)), (ball, Vector3::zeros())] {
            let mesh = mesh(&Body { colliders: vec![collider], ..Body::none() });
            assert_eq!(mesh.len(), 12 * N_RINGS * N_SEGMENTS);
            for vertex in mesh.chunks_exact(2) {
                let [place, normal] = [vertex[0], vertex[1]].map(|v| Vector3::new(v[0], v[1], v[2]));
                assert!((place - middle).dot(&normal) > 0.0, "{place} {normal}");
            }
        }
    }
}
