use super::*;

const JSON: &str = r#"{
  "name": "wig", "subject": "Wig", "units": "mm", "up_axis": "Z", "rate_hz": 120, "still_frames": [1, 120],
  "head_markers_mm_in_head_frame": {"NOSE": [113, 1, -18], "Wig:LFHD": [84, 29, 43], "RFHD": [83.5, -30, 42.5]},
  "colliders": {
    "head_ellipsoid_half_axes_mm": [95, 75, 100],
    "neck_capsule_mm": {"a": [-15, 0, -70], "b": [-20, 0, -190], "radius": 55},
    "note": "prose"
  },
  "fans": [{"from_azimuth_deg": 90, "speed_mps": 2, "blows_towards_world": [0, 0, -2]}],
  "strands": [{
    "strand": "S01", "length_mm": 175, "linear_density_g_per_m": 3.25, "lock_width_mm": 7.1,
    "root_mm": [-15, 74, -25], "markers": ["S01_1", "S01_2"], "marker_distance_from_root_mm": [33, 61],
    "marker_mass_mg": 22
  }],
  "operator": "Ann"
}"#;

fn what(session: &Session) -> Vec<&str> {
    session.assumed.iter().map(|a| a.what.as_str()).collect()
}

fn error_with(from: &str, to: &str) -> String {
    assert!(JSON.contains(from), "{from}");
    read_session(JSON.replacen(from, to, 1).as_bytes()).unwrap_err().to_string()
}

#[test]
fn lengths_become_meters_and_defaults_are_listed() {
    let session = read_session(JSON.as_bytes()).unwrap();
    assert_eq!(session.unit, Some(LengthUnit::Millimeter));
    assert_eq!(session.up_axis, Some(UpAxis::Z));
    assert_eq!(session.still_frames, Some((1, 120)));
    let labels: Vec<&str> = session.head_markers.iter().map(|m| m.label.as_str()).collect();
    assert_eq!(labels, ["NOSE", "LFHD", "RFHD"]);
    assert_eq!(session.head_markers[0].position_m, Vec3::new(0.113, 0.001, -0.018));
    let strand = &session.strands[0];
    assert!((strand.linear_density_kg_per_m - 3.25e-3).abs() < 1e-15);
    assert_eq!(strand.markers[1].distance_from_root_m, Some(0.061));
    assert!((strand.markers[0].mass_kg - 22e-6).abs() < 1e-15);
    assert_eq!(session.fans[0].blows_towards_world, Some(-Vec3::z()));
    assert!((session.fans[0].from_azimuth_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    assert_eq!(session.body.colliders.len(), 2);
    assert_eq!(
        what(&session),
        ["head_pivot_mm", "friction", "fans[0].from_elevation_deg", "air_density_kg_m3"]
    );
}

#[test]
fn what_is_meant_for_json_is_not_called_bad_toml() {
    let error = |text: String| read_session(text.as_bytes()).unwrap_err().to_string();
    let expected = "expected a session in JSON or TOML";
    for comment in ["// by Ann\n", "\n/* by Ann */ "] {
        let found = error(format!("{comment}{JSON}"));
        assert_eq!(
            found,
            format!("found a comment with a slash, which neither JSON nor TOML has, {expected}")
        );
    }
    assert_eq!(error(format!("[{JSON}]")), format!("found a JSON list, {expected}"));
    assert_eq!(error("[ ]".to_owned()), format!("found a JSON list, {expected}"));
}

#[test]
fn errors_say_where() {
    assert_eq!(
        error_with("\"length_mm\": 175", "\"length_mm\": -175"),
        "strands[0].length_mm (lock S01): found -175, expected a number > 0"
    );
    assert_eq!(
        error_with("\"lock_width_mm\"", "\"lock_widht_mm\""),
        "strands[0].lock_widht_mm: found a field of that name, expected `lock_width_mm`"
    );
    assert_eq!(
        error_with("\"S01_2\"", "\"NOSE\""),
        "strands[S01].markers: found \"NOSE\" again, expected each marker once"
    );
    assert_eq!(
        error_with("\"length_mm\": 175", "\"length_mm\": \"long\""),
        "line 11, column 40: invalid type: string \"long\", expected f64"
    );
    assert_eq!(
        error_with("\"units\": \"mm\"", "\"units\": \"furlong\""),
        "units: found \"furlong\", expected mm, cm, m or in"
    );
    assert_eq!(
        error_with("\"head_markers_mm_in_head_frame\"", "\"head_markers_mm\""),
        "line 16, column 1: missing field `head_markers_mm_in_head_frame`"
    );
}

/// The same session as [`JSON`], as a hand would rather write it.
const TOML: &str = r#"
# The wig on its stand.
name = "wig"
subject = "Wig"
units = "mm"
up_axis = "Z"
rate_hz = 120
still_frames = [1, 120]

[head_markers_mm_in_head_frame]
NOSE = [113, 1, -18]
"Wig:LFHD" = [84, 29, 43]
RFHD = [83.5, -30, 42.5]

[colliders]
head_ellipsoid_half_axes_mm = [95, 75, 100]
neck_capsule_mm = { a = [-15, 0, -70], b = [-20, 0, -190], radius = 55 }

[[fans]]
from_azimuth_deg = 90
speed_mps = 2
blows_towards_world = [0, 0, -2]

[[strands]]
strand = "S01"
length_mm = 175
linear_density_g_per_m = 3.25
lock_width_mm = 7.1
root_mm = [-15, 74, -25]
markers = ["S01_1", "S01_2"]
marker_distance_from_root_mm = [33, 61]
marker_mass_mg = [22, 22]
"#;

#[test]
fn toml_says_the_same() {
    assert_eq!(read_session(TOML.as_bytes()).unwrap(), read_session(JSON.as_bytes()).unwrap());
    let with_mark = [b"\xEF\xBB\xBF", TOML.as_bytes()].concat();
    assert_eq!(read_session(&with_mark).unwrap(), read_session(JSON.as_bytes()).unwrap());
    let error = |text: &str| read_session(text.as_bytes()).unwrap_err().to_string();
    assert_eq!(
        error(&TOML.replace("length_mm = 175", "length_mm = \"long\"")),
        "line 26, column 13: invalid type: string \"long\", expected f64"
    );
    assert!(error(&TOML.replace("[[strands]]", "[[strands]")).starts_with("line 24, column "));
}

#[test]
fn a_bare_session_gets_defaults_that_are_all_listed() {
    let session = read_session(
        br#"{
        "head_markers_mm_in_head_frame": {"A": [100, 0, 0], "B": [0, 80, 0], "C": [-100, 0, 0]},
        "strands": [
            {"strand": "S1", "length_mm": 200, "root_mm": [0, 0, 110], "markers": ["a"]},
            {"strand": "S2", "length_mm": 200, "root_mm": [0, 0, 110], "markers": ["b"], "lock_width_mm": 10,
             "marker_mass_mg": 0, "marker_distance_from_root_mm": [205]}
        ]}"#,
    )
    .unwrap();
    assert_eq!(
        what(&session),
        [
            "strands[1].length_mm (lock S2)",
            "strands[*].linear_density_g_per_m",
            "strands[S1].lock_width_mm",
            "strands[S1].marker_mass_mg",
            "colliders",
            "head_pivot_mm",
            "friction",
            "name",
            "fans",
            "air_density_kg_m3",
        ]
    );
    assert_eq!((session.unit, session.up_axis, session.still_frames), (None, None, None));
    let names: Vec<&str> = session.body.colliders.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["head", "neck", "shoulders"]);
    assert_eq!(session.strands[0].lock_width_m, 0.005);
    assert!((session.strands[1].linear_density_kg_per_m - 0.008).abs() < 1e-12, "four times the area");
    assert_eq!(session.strands[1].length_m, 0.205, "as long as its last marker is far");
    assert_eq!(session.strands[0].markers[0].distance_from_root_m, None);
}

/// Who says when the wind starts says when hair hung still; but which frames these are the capture must tell.
#[test]
fn the_start_of_the_wind_gives_no_still_frames_without_a_capture() {
    for start in [121, i64::MIN, i64::MAX] {
        let start_at = format!("\"wind_starts_about_frame\": {start},");
        let session =
            read_session(JSON.replace("\"still_frames\": [1, 120],", &start_at).as_bytes()).unwrap();
        assert_eq!((session.still_frames, session.wind_start_frame), (None, Some(start)));
        assert!(session.assumed.iter().all(|assumption| assumption.what != "still_frames"));
    }
}

#[test]
fn what_cannot_be_is_refused() {
    for (from, to, expected) in [
        ("[113, 1, -18]", "[113, 1, -18000]", "head_markers_mm_in_head_frame.NOSE: found"),
        ("[113, 1, -18]", "[113, 1]", "line 3, column"),
        ("[83.5, -30, 42.5]", "[55, 57, 104]", "head_markers_mm_in_head_frame: found 3 markers within 10 mm"),
        ("\"RFHD\"", "\"NOSE\"", "line 3, column"),
        ("[1, 120]", "[120, 1]", "still_frames: found [120, 1]"),
        ("[95, 75, 100]", "[95, 0, 100]", "colliders.head_ellipsoid_half_axes_mm: found 0"),
        ("\"radius\": 55", "\"radius\": -1", "colliders.neck_capsule_mm.radius: found -1"),
        ("[0, 0, -2]", "[0, 0, 0]", "fans[0].blows_towards_world: found [0.0, 0.0, 0.0]"),
        ("\"speed_mps\": 2", "\"speed_mps\": 0", "fans[0].speed_mps: found 0"),
        ("[33, 61]", "[61, 33]", "strands[0].marker_distance_from_root_mm (lock S01): found 33 after 61"),
        ("[33, 61]", "[33]", "strands[0].marker_distance_from_root_mm (lock S01): found 1 numbers"),
        ("[33, 61]", "[33, 261]", "strands[0].marker_distance_from_root_mm (lock S01): found 261 mm"),
        (
            "\"marker_mass_mg\": 22",
            "\"marker_mass_mg\": [22]",
            "strands[0].marker_mass_mg (lock S01): found 1",
        ),
        ("\"marker_mass_mg\": 22", "\"marker_mass_mg\": true", "line 14, column"),
        ("[\"S01_1\", \"S01_2\"]", "[]", "strands[0].markers (lock S01): found none"),
    ] {
        let error = error_with(from, to);
        assert!(error.starts_with(expected), "{error}");
    }
}

#[test]
fn what_is_no_session_is_named() {
    let error = |bytes: &[u8]| read_session(bytes).unwrap_err().to_string();
    assert_eq!(error(b" \n"), "found an empty file, expected a session in JSON or TOML");
    assert_eq!(
        error(b"Trajectories\n100\n,,A,,\nFrame,Sub Frame,X,Y,Z\n"),
        "found a capture (vicon-csv), expected a session in JSON or TOML"
    );
    assert_eq!(
        error(b"{\"name\": \"\xFF\"}"),
        "byte 10: found bytes that are not UTF-8, expected a session in JSON or TOML"
    );
    assert!(error(b"{\"name\": ").starts_with("line 1, column 9: EOF"));
}

/// Every field has its place on the page on inputs, and of its example nothing is assumed.
#[test]
fn the_page_on_inputs_names_every_field() {
    let page = include_str!("../../../../docs/inputs.md");
    let fields = include_str!("file.rs").lines().filter_map(|line| line.strip_prefix("    pub "));
    let names = fields.filter_map(|field| Some(field.split_once(": ")?.0)).filter(|name| !name.contains(' '));
    let names: Vec<&str> = names.collect();
    assert!(names.contains(&"still_frames") && names.contains(&"marker_mass_mg"), "{names:?}");
    for name in names {
        assert!(page.contains(&format!("`{name}`")), "{name}");
    }
    let example = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    assert_eq!(what(&read_session(example.as_bytes()).unwrap()), [""; 0]);
}
