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
