//! A head's motion out of USD text.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use tousle_core::{Axis, HeadAxes, Vec3};
use tousle_usda::{PoseOptions, UsdaError, read_poses};

fn options() -> PoseOptions {
    PoseOptions::default()
}

fn layer(metadata: &str, prims: &str) -> Vec<u8> {
    format!("#usda 1.0\n({metadata})\n{prims}").into_bytes()
}

const Z_UP_METERS: &str = "metersPerUnit = 1 upAxis = \"Z\" timeCodesPerSecond = 30";

/// A head that walks and turns its nose from +x to the left, +y, as a Z-up stage in meters has it.
const WALK: &str = "def Xform \"World\" { def Xform \"Head\" {
    double3 xformOp:translate.timeSamples = { 10: (0, 0, 1.5), 11: (0.1, 0, 1.5), 12: (0.2, 0, 1.5) }
    float3 xformOp:rotateXYZ.timeSamples = { 10: (0, 0, 0), 12: (0, 0, 90) }
    uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:rotateXYZ\"] } }";

#[test]
fn unit_clock_and_chain() {
    let read = read_poses(&layer(Z_UP_METERS, WALK), &options()).unwrap();
    assert_eq!((read.prim.as_str(), read.start_code), ("/World/Head", 10.0));
    assert_eq!((read.poses.start_secs, read.poses.rate_hz, read.poses.poses.len()), (0.0, 30.0, 3));
    assert!(read.warnings.is_empty(), "{:?}", read.warnings);
    let [first, middle, last] = [0, 1, 2].map(|k| read.poses.poses[k]);
    assert!((middle.translation.vector - Vec3::new(0.1, 0.0, 1.5)).norm() < 1e-12);
    assert!((first.rotation * Vec3::x() - Vec3::x()).norm() < 1e-12);
    assert!((middle.rotation * Vec3::x() - Vec3::new(1.0, 1.0, 0.0).normalize()).norm() < 1e-12);
    assert!((last.rotation * Vec3::x() - Vec3::y()).norm() < 1e-12);
}

/// The same walk as a Y-up stage in centimeters has it, where characters look along z: the same poses.
#[test]
fn up_axis_and_unit_are_honoured() {
    let metadata = "metersPerUnit = 0.01 upAxis = \"Y\" framesPerSecond = 30 startTimeCode = 4";
    // Z up (x, y, z) is Y up (x, z, -y); a nose along z looks along -y of the Z-up world.
    let prims = "def Xform \"World\" {
        double3 xformOp:translate = (0, 100, 0) uniform token[] xformOpOrder = [\"xformOp:translate\"]
        def Xform \"Scaled\" { float3 xformOp:scale = (10, 10, 10) uniform token[] xformOpOrder = [\"xformOp:scale\"]
        def Xform \"Head\" {
        double3 xformOp:translate.timeSamples = { 10: (0, 5, 0), 11: (1, 5, 0), 12: (2, 5, 0) }
        quatf xformOp:orient.timeSamples = { 10: (0.70710678, 0, 0.70710678, 0), 12: (0, 0, 1, 0) }
        uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:orient\"] } } }";
    let read = read_poses(&layer(metadata, prims), &options()).unwrap();
    let expected = read_poses(&layer(Z_UP_METERS, WALK), &options()).unwrap();
    for (a, b) in read.poses.poses.iter().zip(&expected.poses.poses) {
        assert!((a.translation.vector - b.translation.vector).norm() < 1e-12, "{a} {b}");
        assert!(a.rotation.angle_to(&b.rotation) < 1e-6, "{a} {b}");
    }
    assert_eq!((read.start_code, read.poses.start_secs), (4.0, 0.2), "the stage starts 6 codes earlier");
    assert!(read.warnings[0].contains("scale of 10.0000"), "{:?}", read.warnings);
    let shifted = PoseOptions::default();
    let shifted = {
        let mut o = shifted;
        o.start_code = Some(11.0);
        o.start_secs = 2.0;
        o
    };
    let read = read_poses(&layer(metadata, prims), &shifted).unwrap();
    assert!((read.poses.start_secs - (2.0 - 1.0 / 30.0)).abs() < 1e-12);
}

/// A world whose up is y gets a Z-up stage turned.
#[test]
fn the_world_may_have_another_up() {
    let mut up = options();
    up.world_up = Vec3::y();
    let read = read_poses(&layer(Z_UP_METERS, WALK), &up).unwrap();
    let pose = read.poses.poses[0];
    assert!((pose.translation.vector - Vec3::new(0.0, 1.5, 0.0)).norm() < 1e-12, "{pose}");
    assert!((pose.rotation * Vec3::z() - Vec3::y()).norm() < 1e-12, "the head stays upright");
    up.world_up = -Vec3::z();
    let pose = read_poses(&layer(Z_UP_METERS, WALK), &up).unwrap().poses.poses[0];
    assert!((pose.rotation * Vec3::z() + Vec3::z()).norm() < 1e-12);
}

#[test]
fn the_heads_own_axes_can_be_given() {
    let mut axes = options();
    axes.axes = Some(HeadAxes { up: Axis::PlusY, forward: Axis::MinusZ });
    let read = read_poses(&layer(Z_UP_METERS, WALK), &axes).unwrap();
    let pose = read.poses.poses[0];
    assert!((pose.rotation * Vec3::z() - Vec3::y()).norm() < 1e-12);
    assert!((pose.rotation * Vec3::x() + Vec3::z()).norm() < 1e-12);
    axes.axes = Some(HeadAxes { up: Axis::PlusY, forward: Axis::PlusY });
    assert!(read_poses(&layer(Z_UP_METERS, WALK), &axes).is_err());
}

/// Matrices a frame apart, motion on the parent, half codes.
#[test]
fn matrices_parents_and_sub_frames() {
    let prims = "over \"A\" {
        matrix4d xformOp:transform.timeSamples = {
            0: ((1,0,0,0), (0,1,0,0), (0,0,1,0), (0,0,0,1)), 2: ((0,1,0,0), (-1,0,0,0), (0,0,1,0), (4,0,0,1)) }
        uniform token[] xformOpOrder = [\"xformOp:transform\"]
        over \"Head\" { double3 xformOp:translate = (0, 1, 0) double xformOp:translateZ:bob.timeSamples = { 0: 0, 0.5: 1 }
        uniform token[] xformOpOrder = [\"!resetXformStack!\", \"xformOp:translate\", \"xformOp:translateZ:bob\"] }
        over \"Hat\" { double3 xformOp:translate = (1, 0, 0) uniform token[] xformOpOrder = [\"xformOp:translate\"] } }";
    let mut named = options();
    named.prim = Some("/A/Hat".to_owned());
    let read = read_poses(&layer(Z_UP_METERS, prims), &named).unwrap();
    assert_eq!((read.poses.rate_hz, read.poses.poses.len()), (30.0, 3), "one pose a code at least");
    let middle = read.poses.poses[1];
    let s = libm::sqrt(0.5);
    assert!((middle.translation.vector - Vec3::new(2.0 + s, s, 0.0)).norm() < 1e-12, "{middle}");
    named.prim = Some("/A/Head".to_owned());
    let read = read_poses(&layer(Z_UP_METERS, prims), &named).unwrap();
    assert_eq!(read.poses.rate_hz, 60.0);
    assert!((read.poses.poses[1].translation.vector - Vec3::new(0.0, 1.0, 1.0)).norm() < 1e-12);
}

#[test]
fn a_head_that_cannot_be_found_or_used() {
    let error = |bytes: &[u8], prim: Option<&str>| -> UsdaError {
        let mut options = options();
        options.prim = prim.map(str::to_owned);
        read_poses(bytes, &options).unwrap_err()
    };
    let two = format!("{WALK} {}", WALK.replace("World", "Stage"));
    let flat = WALK
        .replace("uniform token[]", "float3 xformOp:scale = (1, 1, 2) uniform token[]")
        .replace("\"xformOp:rotateXYZ\"]", "\"xformOp:rotateXYZ\", \"xformOp:scale\"]");
    let far = WALK.replace("12:", "1e9:");
    for (bytes, prim, says) in [
        (b"PXR-USDC".to_vec(), None, "usdcat"),
        (layer(Z_UP_METERS, "def Xform \"A\" { }"), None, "nothing that is animated"),
        (layer(Z_UP_METERS, &two), None, "2 animated transforms: /World/Head, /Stage/Head"),
        (
            layer(Z_UP_METERS, WALK),
            Some("/World/Hed"),
            "no such prim, expected one of the layer's; animated are: /World/Head",
        ),
        (layer(Z_UP_METERS, &flat), None, "unevenly scaled"),
        (layer(Z_UP_METERS, &far), None, "at most a million poses"),
        (layer("metersPerUnit = 0", WALK), None, "metersPerUnit"),
        (layer("timeCodesPerSecond = -1", WALK), None, "timeCodesPerSecond"),
        (layer("upAxis = \"W\"", WALK), None, "upAxis"),
        (
            layer(Z_UP_METERS, &WALK.replace("11: (0.1, 0, 1.5)", "11: (0.1, 0)")),
            None,
            "xformOp:translate without a value",
        ),
    ] {
        let error = error(&bytes, prim).to_string();
        assert!(error.contains(says), "{says}: {error}");
    }
    let read = read_poses(&layer("", WALK), &options()).unwrap();
    assert_eq!(read.warnings.len(), 3, "what the layer does not say: {:?}", read.warnings);
    assert_eq!(read.poses.rate_hz, 24.0);
}

/// A stage that Pixar's library wrote (usd-core 26.11), and what its `XformCache` says of the head at some codes: the
/// images of x, y, z and the origin, Y up, cm. Three levels, a pivot, rotations in two forms, samples that do not meet.
#[test]
fn as_pixars_library_has_it() {
    let mut named = options();
    named.prim = Some("/World/Body/Head".to_owned());
    // The layer's own axes, so that nothing but the unit changes.
    named.world_up = Vec3::y();
    named.axes = Some(HeadAxes { up: Axis::PlusZ, forward: Axis::PlusX });
    let read = read_poses(include_bytes!("data/shot.usda"), &named).unwrap();
    assert_eq!((read.poses.rate_hz, read.poses.poses.len(), read.start_code), (48.0, 9, 1001.0));
    for (code, expected) in [
        (
            1001.0,
            [
                [0.925355726, 0.207120524, -0.317518297],
                [-0.166215461, 0.974425454, 0.151219892],
                [0.340718653, -0.087155743, 0.936116807],
                [12.214516745, 159.586320695, -13.915665247],
            ],
        ),
        (
            1002.0,
            [
                [0.092767701, 0.467055268, -0.879348356],
                [0.119022248, 0.871622469, 0.475508123],
                [0.988548359, -0.148773814, 0.025268445],
                [9.013637090, 161.012187943, -18.564859914],
            ],
        ),
        (
            1003.5,
            [
                [-0.689114895, 0.530818688, -0.493307390],
                [0.506267223, 0.839724283, 0.196358416],
                [0.518472911, -0.114431853, -0.847402615],
                [8.008296268, 162.101768407, -16.963541440],
            ],
        ),
        (
            1005.0,
            [
                [-0.778633329, 0.621098070, -0.089259886],
                [0.616262099, 0.730160345, -0.295104890],
                [-0.118115048, -0.284785987, -0.951286380],
                [17.928203230, 164.000000000, -22.267949192],
            ],
        ),
    ] {
        let pose = read.poses.poses[((code - 1001.0) * 2.0) as usize];
        let [x, y, z, origin] = expected.map(Vec3::from);
        for (axis, image) in [(Vec3::x(), x), (Vec3::y(), y), (Vec3::z(), z)] {
            assert!((pose.rotation * axis - image).norm() < 1e-6, "time code {code}");
        }
        assert!((pose.translation.vector - origin * 0.01).norm() < 1e-7, "time code {code}: {pose}");
    }
}
