//! The crate's door: formats told apart, placement, and an answer for any bytes.

#![allow(clippy::unwrap_used, reason = "a helper of tests may panic as a test may")]

use tousle_core::{Axis, LengthUnit, Vec3};
use tousle_groom::{GroomFormat, GroomOptions, GroomReadError, inspect_groom, read_groom};

const JSON: &str = r#"{"strands": [{"name": "a", "rest_curve_m": [[0, 0, 0.1], [0, 0.01, 0.09], [0, 0.02, 0.05]]},
    {"name": "b", "lock_width_m": 0.003, "rest_curve_m": [[0.1, 0, 0], [0.1, 0, -0.2]]}]}"#;

const USDA: &str = r#"#usda 1.0
( metersPerUnit = 0.01
  upAxis = "Y" )
def Xform "groom" {
    double3 xformOp:translate = (1, 2, 3)
    uniform token[] xformOpOrder = ["xformOp:translate"]
    def BasisCurves "hair" {
        int[] curveVertexCounts = [2, 3]
        point3f[] points = [(0, 0, 0), (0, 0, 1), (1, 0, 0), (1, 1, 0), (1, 2, 0)]
        float[] widths = [0.5] (interpolation = "constant")
        uniform token type = "linear"
    }
}"#;

/// Strands of 2 and 3 points in each binary format: x counts up, y and z are 10 and −x.
fn binary(format: GroomFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut x = 0.0_f32;
    let mut point = |bytes: &mut Vec<u8>| {
        x += 1.0;
        bytes.extend([x, 10.0, -x].iter().flat_map(|v| v.to_le_bytes()));
    };
    match format {
        GroomFormat::Hair => {
            bytes.extend(b"HAIR");
            bytes.extend([2_u32, 5, 3, 0].iter().flat_map(|v| v.to_le_bytes()));
            bytes.resize(128, 0);
            bytes.extend([1, 0, 2, 0]);
            (0..5).for_each(|_| point(&mut bytes));
        }
        GroomFormat::Ply => {
            bytes.extend(b"ply\nformat binary_little_endian 1.0\nelement vertex 5\nproperty float x\n");
            bytes.extend(
                b"property float y\nproperty float z\nelement strand 2\nproperty uchar nsegs\nend_header\n",
            );
            (0..5).for_each(|_| point(&mut bytes));
            bytes.extend([1, 2]);
        }
        GroomFormat::Alembic => bytes = alembic(),
        _ => {
            bytes.extend(2_i32.to_le_bytes());
            for n in [2_i32, 3] {
                bytes.extend(n.to_le_bytes());
                for _ in 0..n {
                    point(&mut bytes);
                    bytes.extend(vec![0; if format == GroomFormat::Bin { 16 } else { 0 }]);
                }
            }
        }
    }
    bytes
}

const BINARY: [GroomFormat; 5] =
    [GroomFormat::Hair, GroomFormat::Data, GroomFormat::Bin, GroomFormat::Ply, GroomFormat::Alembic];

/// Puts data or a group behind what is there; gives the offset that a parent holds.
fn put(archive: &mut Vec<u8>, count: usize, body: &[u8], is_data: bool) -> u64 {
    let offset = archive.len() as u64;
    archive.extend((count as u64).to_le_bytes());
    archive.extend(body);
    if is_data { offset | 1 << 63 } else { offset }
}

fn put_data(archive: &mut Vec<u8>, body: &[u8]) -> u64 {
    put(archive, body.len(), body, true)
}

fn put_group(archive: &mut Vec<u8>, children: &[u64]) -> u64 {
    let body: Vec<u8> = children.iter().flat_map(|c| c.to_le_bytes()).collect();
    put(archive, children.len(), &body, false)
}

/// A property with one sample: its group, and its header with a one-byte name length.
fn put_property(
    archive: &mut Vec<u8>,
    name: &str,
    is_array: bool,
    pod: u32,
    values: &[u8],
) -> (u64, Vec<u8>) {
    let data = put_data(archive, &[&[0; 16], values].concat());
    // An array's sample has dimensions of its own; none means as many as there are values.
    let group = if is_array { put_group(archive, &[data, 1 << 63]) } else { put_group(archive, &[data]) };
    let bits = (if is_array { 2 } else { 1 }) | pod << 4 | 1 << 20;
    let mut header = bits.to_le_bytes().to_vec();
    header.extend([1, name.len() as u8]);
    header.extend(name.as_bytes());
    (group, header)
}

/// A compound of properties, and its header.
fn put_compound(archive: &mut Vec<u8>, name: &str, properties: Vec<(u64, Vec<u8>)>) -> (u64, Vec<u8>) {
    let (mut children, headers): (Vec<u64>, Vec<Vec<u8>>) = properties.into_iter().unzip();
    children.push(put_data(archive, &headers.concat()));
    let group = put_group(archive, &children);
    let header = [&(1_u32 << 20).to_le_bytes()[..], &[name.len() as u8], name.as_bytes()].concat();
    (group, header)
}

/// An object of one compound and some named children.
fn put_object(archive: &mut Vec<u8>, properties: (u64, Vec<u8>), objects: &[(&str, u64)]) -> u64 {
    let (top, _) = put_compound(archive, "", vec![properties]);
    let mut names = Vec::new();
    let mut children = vec![top];
    for (name, object) in objects {
        names.extend((name.len() as u32).to_le_bytes());
        names.extend(name.as_bytes());
        names.push(1);
        children.push(*object);
    }
    names.extend([0; 32]);
    children.push(put_data(archive, &names));
    put_group(archive, &children)
}

/// The curves of [`binary`], written 1 lower along x, under a transform that moves them back.
fn alembic() -> Vec<u8> {
    let floats = |v: &[f32]| v.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let points: Vec<f32> = (1..=5_u8).flat_map(|k| [f32::from(k) - 1.0, 10.0, -f32::from(k)]).collect();
    let mut archive = b"Ogawa\xff\x00\x01\0\0\0\0\0\0\0\0".to_vec();
    let geometry = vec![
        put_property(&mut archive, "P", true, 10, &floats(&points)),
        put_property(&mut archive, "nVertices", true, 6, &[2, 0, 0, 0, 3, 0, 0, 0]),
        put_property(&mut archive, "curveBasisAndType", false, 1, &[1, 0, 0, 0]),
    ];
    let geometry = put_compound(&mut archive, ".geom", geometry);
    let curves = put_object(&mut archive, geometry, &[]);
    let moved: Vec<u8> = [1.0_f64, 0.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let xform = vec![
        put_property(&mut archive, ".ops", false, 1, &[1 << 4]),
        put_property(&mut archive, ".vals", false, 11, &moved),
    ];
    let xform = put_compound(&mut archive, ".xform", xform);
    let parent = put_object(&mut archive, xform, &[("hair", curves)]);
    let nothing = put_compound(&mut archive, ".other", Vec::new());
    let top = put_object(&mut archive, nothing, &[("head", parent)]);
    let root = put_group(&mut archive, &[1 << 63, 1 << 63, top, 1 << 63, 1 << 63, 1 << 63]);
    archive[8..16].copy_from_slice(&root.to_le_bytes());
    archive
}

fn told(unit: LengthUnit, up: Axis, forward: Axis) -> GroomOptions {
    let mut options = GroomOptions::default();
    options.unit = Some(unit);
    options.up_axis = Some(up);
    options.forward = Some(forward);
    options
}

#[test]
fn binary_formats_are_told_apart_and_read_the_same() {
    for format in BINARY {
        let bytes = binary(format);
        let read = read_groom(&bytes, &told(LengthUnit::Centimeter, Axis::PlusZ, Axis::MinusY)).unwrap();
        assert_eq!(read.format, format);
        assert_eq!(read.groom.counts(), [2, 3]);
        // Forward is −y, so the subject's left is +x: (3, 10, −3) cm becomes (−0.1, 0.03, −0.03) m.
        let root = read.groom.strands[1].rest_curve_m[0];
        assert!((root - Vec3::new(-0.1, 0.03, -0.03)).norm() < 1e-12, "{root}");
        assert!(!read.groom.assumed.iter().any(|a| a.what == "forward axis"));
        let names: Vec<&str> = read.groom.strands.iter().map(|s| s.name.as_str()).collect();
        assert_eq!(names, ["1", "2"]);
    }
}

#[test]
fn json_is_in_head_space() {
    let read = read_groom(JSON.as_bytes(), &GroomOptions::default()).unwrap();
    assert_eq!(read.format, GroomFormat::Json);
    assert_eq!(read.groom.strands[0].rest_curve_m[2], Vec3::new(0.0, 0.02, 0.05));
    assert_eq!(read.groom.strands[1].lock_width_m, 0.003);
    let what: Vec<&str> = read.groom.assumed.iter().map(|a| a.what.as_str()).collect();
    assert!(what.contains(&"lock_width_m of 1 of 2 strands"), "{what:?}");
    let with_mark = [b"\xef\xbb\xbf", JSON.as_bytes()].concat();
    assert_eq!(read_groom(&with_mark, &GroomOptions::default()).unwrap(), read);
}

#[test]
fn usd_states_unit_and_up_axis() {
    let read = read_groom(USDA.as_bytes(), &GroomOptions::default()).unwrap();
    assert_eq!(read.format, GroomFormat::Usda);
    // (1, 2, 4) cm with y up: z is forward and x is left.
    let tip = read.groom.strands[0].rest_curve_m[1];
    assert!((tip - Vec3::new(0.04, 0.01, 0.02)).norm() < 1e-12, "{tip}");
    assert!((read.groom.strands[0].lock_width_m - 0.005).abs() < 1e-12);
    assert_eq!(read.groom.assumed[0].what, "forward axis");
    let read = read_groom(USDA.as_bytes(), &told(LengthUnit::Meter, Axis::PlusY, Axis::PlusZ)).unwrap();
    assert_eq!(read.warnings[0], "the file's unit is 0.01 m; the given 1 m holds");
}

#[test]
fn inspect_tells_what_it_can() {
    let summary = inspect_groom(&binary(GroomFormat::Hair), &GroomOptions::default()).unwrap();
    let json = serde_json::to_value(&summary).unwrap();
    assert_eq!(json["kind"], "groom");
    assert_eq!(json["format"], "hair");
    assert_eq!((&json["strands"], &json["points"]), (&2.into(), &5.into()));
    assert_eq!(json["counts"], serde_json::json!([2, 3]));
    assert!(json["bounds_m"].is_null());
    assert_eq!(json["bounds_in_file"], serde_json::json!([[1.0, 10.0, -5.0], [5.0, 10.0, -1.0]]));
    assert_eq!(
        json["warnings"][0],
        "a groom in .hair states no up axis: pass the file's up axis (x, y, z, -x, -y or -z)"
    );
    let summary = inspect_groom(JSON.as_bytes(), &GroomOptions::default()).unwrap();
    assert_eq!(summary.bounds_m, Some([[0.0, 0.0, -0.2], [0.1, 0.02, 0.1]]));
}

/// USD's own programs do not see what is not active; what they see and do not draw is told.
#[test]
fn usd_prims_that_are_not_active_are_left_out() {
    let curves = |head: &str, body: &str| {
        format!(
            "#usda 1.0\n(\n    upAxis = \"Z\"\n    metersPerUnit = 1\n)\ndef BasisCurves \"c\" {head} {{\n{body}\
             int[] curveVertexCounts = [2]\npoint3f[] points = [(0, 0, 0), (0, 0, 0.1)]\n\
             uniform token type = \"linear\"\n}}\n"
        )
    };
    let read = |text: String| read_groom(text.as_bytes(), &GroomOptions::default());
    assert_eq!(read(curves("", "")).unwrap().groom.strands.len(), 1);
    let error = read(curves("(active = false)", "")).unwrap_err().to_string();
    assert!(error.contains("/c: it is not active"), "{error}");
    let warnings = read(curves("", "token visibility = \"invisible\"\n")).unwrap().warnings;
    assert!(warnings.iter().any(|warning| warning.contains("/c: it is invisible")), "{warnings:?}");
}

/// What Pixar's library has of these layers at their earliest time.
#[test]
fn of_what_changes_over_time_the_first_sample_counts() {
    let read = |over: &str, body: &str| {
        let text = format!(
            "#usda 1.0\n( upAxis = \"Z\" metersPerUnit = 1 )\ndef Xform \"x\" {{ {over} uniform token[] xformOpOrder = \
             [\"xformOp:translate\"] def BasisCurves \"c\" {{ uniform token type = \"linear\" int[] curveVertexCounts = [2] \
             point3f[] points = [(0, 0, 1), (0, 0, 2)] {body} }} }}"
        );
        read_groom(text.as_bytes(), &GroomOptions::default()).unwrap()
    };
    let still = "double3 xformOp:translate = (0, 1, 0)";
    let moving = "double3 xformOp:translate.timeSamples = { 20: (0, 0, 0), 1: (0, 5, 0) }";
    let samples = "point3f[] points.timeSamples = { 5: [(0, 0, 5), (0, 0, 6)], 3: [(0, 0, 3), (0, 0, 4)] }";
    let (curves, transforms) = ("animated curves: the first", "animated transforms: the first");
    for (over, body, root, says) in [
        (still, "", [0.0, 1.0, 1.0], vec![]),
        (still, samples, [0.0, 1.0, 3.0], vec![curves]),
        (&format!("{still} {moving}"), "", [0.0, 5.0, 1.0], vec![transforms]),
        (moving, "token[] xformOpOrder = [\"!resetXformStack!\"]", [0.0, 0.0, 1.0], vec![]),
    ] {
        let read = read(over, body);
        assert_eq!(read.groom.strands[0].rest_curve_m[0], Vec3::from(root), "{over} {body}");
        assert_eq!(read.warnings.len(), says.len(), "{:?}", read.warnings);
        assert!(read.warnings.iter().zip(&says).all(|(warning, says)| warning.starts_with(says)));
    }
    let mut bytes = alembic();
    let name = bytes.windows(5).position(|name| name == b".vals").unwrap();
    bytes[name - 2] = 2; // samples
    let warnings = inspect_groom(&bytes, &GroomOptions::default()).unwrap().warnings;
    assert!(warnings.iter().any(|warning| warning.starts_with(transforms)), "{warnings:?}");
}

#[test]
fn what_is_no_groom_says_so() {
    let mut nan = binary(GroomFormat::Data);
    nan[12..16].copy_from_slice(&f32::NAN.to_le_bytes());
    for (bytes, says) in [
        (&b""[..], "expected a groom: JSON"),
        (b"hello, hair", "found bytes that start with \"hello, hair\""),
        (b"PXR-USDC........", "usdcat FILE -o FILE.usda"),
        (b"PK\x03\x04....", "unpack it"),
        (b"\x89HDF\r\n\x1a\n....", "export the curves as .usda"),
        (b"Ogawa\xff\x00\x01", "Alembic groom, the header: found 8 bytes"),
        (b"#usda 1.0\n", "no BasisCurves"),
        (b"{\"strands\": []}", "found no strands in the groom, expected one"),
        (b"{\"strands\": [{\"rest_curve_m\": [[0,0,0]]}]}", "1 of 1 strands have no segment"),
        (
            b"{\"strands\": [{\"rest_curve_m\": [[0,0,0],[0,0,1]], \"lock_width_m\": -1}]}",
            "lock_width_m = -1",
        ),
        (&nan, ".data groom, strand 1, point 0: found [1.0, NaN, -1.0], expected finite numbers"),
    ] {
        let error = read_groom(bytes, &told(LengthUnit::Meter, Axis::PlusZ, Axis::PlusX)).unwrap_err();
        assert!(error.to_string().contains(says), "{says}\n{error}");
    }
    let error = read_groom(&binary(GroomFormat::Data), &GroomOptions::default()).unwrap_err();
    assert!(matches!(error, GroomReadError::NotStated { what: "up axis", .. }));
}

/// Bytes cut, changed, doubled and taken out at random: there is always an answer, and what is read is finite.
#[test]
fn any_bytes_have_an_answer() {
    let mut seeds: Vec<Vec<u8>> = BINARY.map(binary).to_vec();
    seeds.extend([JSON, USDA].map(|text| text.as_bytes().to_vec()));
    let mut state = 1_u64;
    let mut random = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n.max(1)
    };
    let odd =
        [0x00, 0x01, 0x7f, 0x80, 0xff, b'"', b'{', b'}', b'(', b'[', b'-', b'9', b'.', b'e', b'\n', b'#'];
    let options = told(LengthUnit::Meter, Axis::PlusZ, Axis::PlusX);
    let mut n_read = 0;
    for seed in &seeds {
        for _ in 0..3000 {
            let mut bytes = seed.clone();
            for _ in 0..=random(4) {
                let at = random(bytes.len());
                match random(5) {
                    0 => bytes.truncate(at),
                    1 => bytes[at..].iter_mut().take(1).for_each(|b| *b = odd[random(odd.len())]),
                    2 => bytes[at..].iter_mut().take(1).for_each(|b| *b ^= 1 << random(8)),
                    3 => drop(bytes.drain(at..(at + random(9)).min(bytes.len()))),
                    _ => {
                        let again = bytes[at..(at + random(40)).min(bytes.len())].to_vec();
                        bytes.splice(at..at, again);
                    }
                }
            }
            if let Ok(read) = read_groom(&bytes, &options) {
                read.groom.check().unwrap();
                n_read += 1;
            }
        }
    }
    assert!(n_read > 100, "mutations this small leave some grooms whole: {n_read}");
}

/// Of the example on the page on inputs nothing is assumed.
#[test]
fn the_groom_in_the_documentation_is_read() {
    let page = include_str!("../../../docs/inputs.md");
    let example = page.split("```json\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let read = read_groom(example.as_bytes(), &GroomOptions::default()).unwrap();
    assert_eq!(read.groom.counts(), [3]);
    assert!(read.groom.assumed.is_empty() && read.warnings.is_empty(), "{read:?}");
}
