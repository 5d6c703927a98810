//! What the hair touched, as guide geometry: not rendered, there for whoever wants to see it.

use std::io::{self, Write};

use nalgebra::{Matrix4, UnitQuaternion};
use tousle_core::{Attachment, Collider, Pose, Shape, Solid, Vec3};
use tousle_field::Scene;

use super::hair::Hair;
use super::text::Text;
use super::transform::{write_transform, write_transforms};

/// Writes the scene's colliders under `Body`, those of the torso under an `Xform` that moves as the head sees it.
pub(super) fn write_body<W: Write>(text: &mut Text<W>, hair: &Hair<'_>, scene: &Scene) -> io::Result<()> {
    let of = |attachment: Attachment| {
        scene.body.colliders.iter().filter(move |c| c.attachment == attachment).enumerate()
    };
    text.open_prim("Xform", "Body")?;
    text.line(format_args!("uniform token purpose = \"guide\""))?;
    for (k, collider) in of(Attachment::Head) {
        write_collider(text, collider, k)?;
    }
    if of(Attachment::Torso).next().is_some() {
        text.open_prim("Xform", "Torso")?;
        write_transforms(text, hair, scene.poses.is_still(), |t| {
            let world_from_head = scene.poses.motion_at(t).world_from_head;
            scene.body.head_from_torso(&world_from_head, &scene.rest_pose)
        })?;
        for (k, collider) in of(Attachment::Torso) {
            write_collider(text, collider, k)?;
        }
        text.close("}")?;
    }
    text.close("}")
}

fn write_collider<W: Write>(text: &mut Text<W>, collider: &Collider, index: usize) -> io::Result<()> {
    let name = prim_name(&collider.name, index);
    match &collider.shape {
        Shape::Ellipsoid { center_m, half_axes_m } => {
            text.open_prim("Sphere", &name)?;
            text.line(format_args!("double radius = 1"))?;
            text.line(format_args!("float3[] extent = [(-1, -1, -1), (1, 1, 1)]"))?;
            let place = Matrix4::new_translation(center_m) * Matrix4::new_nonuniform_scaling(half_axes_m);
            write_transform(text, &place)?;
        }
        Shape::Capsule { a_m, b_m, radius_m } => {
            let length = (b_m - a_m).norm();
            let half = length / 2.0 + radius_m;
            text.open_prim("Capsule", &name)?;
            text.line(format_args!("uniform token axis = \"Z\""))?;
            text.line(format_args!("double height = {length}"))?;
            text.line(format_args!("double radius = {radius_m}"))?;
            let corner = [*radius_m, *radius_m, half].map(|x| x as f32);
            text.array("float3[] extent", [corner.map(|x| -x), corner], Text::tuple, "")?;
            write_transform(text, &capsule_place(*a_m, *b_m).to_homogeneous())?;
        }
        Shape::Mesh(solid) => {
            text.open_prim("Mesh", &name)?;
            write_mesh(text, solid)?;
        }
    }
    text.close("}")
}

fn write_mesh<W: Write>(text: &mut Text<W>, solid: &Solid) -> io::Result<()> {
    let points = || solid.points_m.iter().map(|p| [p.x as f32, p.y as f32, p.z as f32]);
    let corner = |pick: fn(f32, f32) -> f32, start: f32| {
        points().fold([start; 3], |corner, p| [0, 1, 2].map(|axis| pick(corner[axis], p[axis])))
    };
    let extent = [corner(f32::min, f32::INFINITY), corner(f32::max, f32::NEG_INFINITY)];
    text.line(format_args!("uniform token subdivisionScheme = \"none\""))?;
    text.array("float3[] extent", extent, Text::tuple, "")?;
    let corners = solid.triangles.iter().flatten().map(|corner| *corner as usize);
    text.array("int[] faceVertexCounts", solid.triangles.iter().map(|_| 3), Text::usize, "")?;
    text.array("int[] faceVertexIndices", corners, Text::usize, "")?;
    text.array("point3f[] points", points(), Text::tuple, "")
}

/// The transform that takes a capsule along z about the origin to its ends.
fn capsule_place(a_m: Vec3, b_m: Vec3) -> Pose {
    let turn = UnitQuaternion::rotation_between(&Vec3::z(), &(b_m - a_m))
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vec3::x_axis(), std::f64::consts::PI));
    Pose::from_parts(((a_m + b_m) / 2.0).into(), turn)
}

/// A collider's name made fit for a path: letters, digits and underscores, and told apart by its index.
fn prim_name(name: &str, index: usize) -> String {
    let safe: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    format!("{}{safe}_{index}", if safe.starts_with(|c: char| c.is_ascii_digit()) { "_" } else { "" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_capsule_reaches_from_end_to_end() {
        for (a, b) in [
            (Vec3::new(0.0, -0.2, -0.2), Vec3::new(0.0, 0.2, -0.2)),
            (Vec3::new(0.1, 0.0, 0.3), Vec3::new(0.1, 0.0, -0.1)),
        ] {
            let tip = Vec3::new(0.0, 0.0, (b - a).norm() / 2.0);
            assert!(
                (capsule_place(a, b) * nalgebra::Point3::from(tip) - nalgebra::Point3::from(b)).norm()
                    < 1e-12
            );
        }
    }

    #[test]
    fn names_become_paths() {
        assert_eq!(prim_name("left shoulder", 0), "left_shoulder_0");
        assert_eq!(prim_name("2nd", 1), "_2nd_1");
        assert_eq!(prim_name("", 2), "_2");
    }
}
