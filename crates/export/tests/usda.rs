//! Motions as USD text: what a reader finds in it.

#![allow(clippy::unwrap_used, reason = "a helper of tests may panic as a test may")]

use nalgebra::UnitQuaternion;
use tousle_core::{
    Attachment, Body, Collider, Groom, Pose, PoseTrack, Shape, Strand, StrandMotion, UpAxis, Vec3,
};
use tousle_export::{CurveType, ExportError, HairGeometry, UsdOptions, write_motion_usda};
use tousle_field::Scene;

fn groom() -> Groom {
    let strand = |name: &str, n: u8| Strand {
        name: name.into(),
        rest_curve_m: (0..n).map(|k| Vec3::new(-0.125, 0.0, 0.0 - 0.0625 * f64::from(k))).collect(),
        length_m: 0.1,
        linear_density_kg_per_m: 1e-3,
        lock_width_m: 0.0078125,
        bending_stiffness_n_m2: 1e-6,
        internal_damping_secs: 0.0,
        along: tousle_core::Along::default(),
        holds_style: false,
    };
    Groom { strands: vec![strand("A", 2), strand("B", 3)], assumed: Vec::new() }
}

fn motion() -> StrandMotion {
    let rest: Vec<[f32; 3]> = groom()
        .strands
        .iter()
        .flat_map(|s| &s.rest_curve_m)
        .map(|p| [p.x as f32, p.y as f32, p.z as f32])
        .collect();
    let moved = rest.iter().map(|p| [p[0], p[1] + 0.5 * p[2], p[2]]);
    let positions_m = rest.iter().copied().chain(moved).collect();
    StrandMotion { counts: vec![2, 3], times_secs: vec![0.5, 0.5 + 1.0 / 60.0], positions_m }
}

fn scene() -> Scene {
    let turned = Pose::from_parts(
        Vec3::new(1.0, 2.0, 1.5).into(),
        UnitQuaternion::from_euler_angles(0.0, 0.0, std::f64::consts::FRAC_PI_2),
    );
    let capsule = Shape::Capsule { a_m: Vec3::zeros(), b_m: Vec3::new(0.0, 0.0, 0.5), radius_m: 0.25 };
    let ellipsoid = Shape::Ellipsoid { center_m: Vec3::zeros(), half_axes_m: Vec3::new(0.125, 0.25, 0.5) };
    Scene {
        poses: PoseTrack::still(turned),
        rest_pose: turned,
        gravity_world: Vec3::new(0.0, 0.0, -9.81),
        air_density: 1.2,
        body: Body {
            colliders: vec![
                Collider { name: "head".into(), shape: ellipsoid, attachment: Attachment::Head },
                Collider { name: "neck".into(), shape: capsule, attachment: Attachment::Torso },
            ],
            pivot_m: Vec3::zeros(),
            friction: 0.0,
        },
    }
}

fn usda(motion: &StrandMotion, options: &UsdOptions<'_>) -> Result<String, ExportError> {
    let mut out = Vec::new();
    write_motion_usda(motion, &groom(), options, &mut out)?;
    Ok(String::from_utf8(out).unwrap())
}

/// Asserts that the text holds these lines, in this order, blanks at line starts aside.
fn check(text: &str, lines: &[&str]) {
    let mut rest = text.lines().map(str::trim);
    for line in lines {
        assert!(rest.any(|found| found == *line), "missing, or out of order: {line}\n{text}");
    }
}

#[test]
fn curves_carry_counts_widths_and_a_sample_a_frame() {
    let text = usda(&motion(), &UsdOptions::default()).unwrap();
    let frame_0 = "30: [(-0.125, 0, 0), (-0.125, 0, -0.0625), (-0.125, 0, 0), (-0.125, 0, -0.0625), (-0.125, 0, -0.125)],";
    let frame_1 = "31: [(-0.125, 0, 0), (-0.125, -0.03125, -0.0625), (-0.125, 0, 0), (-0.125, -0.03125, -0.0625), \
                   (-0.125, -0.0625, -0.125)],";
    check(
        &text,
        &[
            "#usda 1.0",
            "defaultPrim = \"Hair\"",
            "startTimeCode = 30",
            "endTimeCode = 31",
            "timeCodesPerSecond = 60",
            "metersPerUnit = 1",
            "upAxis = \"Z\"",
            "def BasisCurves \"Curves\"",
            "uniform token type = \"linear\"",
            "int[] curveVertexCounts = [2, 3]",
            "float[] widths = [0.0078125, 0.0078125, 0.0078125, 0.0078125, 0.0078125] (interpolation = \"vertex\")",
            "float3[] extent.timeSamples = {",
            "30: [(-0.12890625, -0.00390625, -0.12890625), (-0.12109375, 0.00390625, 0.00390625)],",
            "point3f[] points.timeSamples = {",
            frame_0,
            frame_1,
        ],
    );
    assert!(!text.contains("xformOp"), "in head space nothing is carried");
}

#[test]
fn splines_reach_their_ends() {
    let mut options = UsdOptions::default();
    options.curve_type = CurveType::CatmullRom;
    let text = usda(&motion(), &options).unwrap();
    check(&text, &["uniform token basis = \"catmullRom\"", "uniform token wrap = \"pinned\""]);
}

#[test]
fn reeds_are_leaves_of_quadrilaterals_with_a_pointed_tip() {
    let mut options = UsdOptions::default();
    options.geometry = HairGeometry::Reeds;
    let text = usda(&motion(), &options).unwrap();
    assert!(!text.contains("BasisCurves"));
    check(
        &text,
        &[
            "def Mesh \"Reeds\"",
            "int[] faceVertexCounts = [3, 4, 3]",
            "int[] faceVertexIndices = [0, 1, 2, 3, 4, 6, 5, 5, 6, 7]",
            "int[] primvars:id = [0, 1, 1] (interpolation = \"uniform\")",
            "texCoord2f[] primvars:st = [(0, 0), (1, 0), (0.5, 1), (0, 0), (1, 0), (0, 0.5), (1, 0.5), (0.5, 1)] \
             (interpolation = \"vertex\")",
            "normal3f[] normals.timeSamples = {",
            "30: [(-1, 0, 0), (-1, 0, 0), (-1, 0, 0), (-1, 0, 0), (-1, 0, 0), (-1, 0, 0), (-1, 0, 0), (-1, 0, 0)],",
        ],
    );
}

#[test]
fn in_the_world_the_head_carries_the_hair_and_the_body_is_a_guide() {
    let scene = scene();
    let mut options = UsdOptions::default();
    options.scene = Some(&scene);
    options.in_world = true;
    options.with_body = true;
    options.world_up = UpAxis::Y;
    let text = usda(&motion(), &options).unwrap();
    // A quarter turn about z takes x to y; USD's matrices work on rows.
    let carried = text.lines().find(|l| l.trim().starts_with("matrix4d xformOp:transform =")).unwrap();
    assert!(carried.contains(", 1, 0, 0), (-1, "), "{carried}");
    assert!(carried.ends_with("(1, 2, 1.5, 1) )"), "{carried}");
    check(
        &text,
        &[
            "upAxis = \"Y\"",
            "uniform token purpose = \"guide\"",
            "def Sphere \"head_0\"",
            "matrix4d xformOp:transform = ( (0.125, 0, 0, 0), (0, 0.25, 0, 0), (0, 0, 0.5, 0), (0, 0, 0, 1) )",
            "def Xform \"Torso\"",
            "def Capsule \"neck_0\"",
            "double height = 0.5",
            "double radius = 0.25",
            "float3[] extent = [(-0.25, -0.25, -0.5), (0.25, 0.25, 0.5)]",
            "matrix4d xformOp:transform = ( (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0.25, 1) )",
        ],
    );
}

#[test]
fn what_cannot_be_written_says_why() {
    let options = UsdOptions::default();
    let mut other = motion();
    other.counts = vec![3, 2];
    let error = usda(&other, &options).unwrap_err().to_string();
    assert!(error.contains("strand 0 of 3 points, expected the groom's 2"), "{error}");
    let none = StrandMotion { times_secs: Vec::new(), positions_m: Vec::new(), ..motion() };
    assert!(usda(&none, &options).unwrap_err().to_string().contains("no frames"));
    let mut in_world = options;
    in_world.in_world = true;
    assert!(matches!(usda(&motion(), &in_world), Err(ExportError::BadOptions { .. })));
    let scene = scene();
    in_world.scene = Some(&scene);
    in_world.world_up = UpAxis::X;
    assert!(usda(&motion(), &in_world).unwrap_err().to_string().contains("x up"));
    let mut thin = options;
    thin.width_scale = 0.0;
    assert!(usda(&motion(), &thin).unwrap_err().to_string().contains("width scale of 0"));
}
