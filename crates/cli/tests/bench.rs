//! `tousle bench`: all parts, whatever becomes of one of them.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::Room;

fn text(room: &Room, file: &str) -> String {
    String::from_utf8(room.read(file)).unwrap()
}

/// A capture of which nothing is there but that it has a truth: `wind` fails, and `file`, though asked for later, has run.
#[test]
fn a_part_that_fails_is_named_and_the_others_run() {
    let room = Room::with_field();
    std::fs::create_dir_all(room.path("captures/empty/truth")).unwrap();
    room.write(
        "captures/empty/truth/truth.json",
        r#"{"name": "empty", "marker_strand": [],
            "reference_lock": {"lock_width_m": 0.01, "linear_density_kg_per_m": 0.001},
            "air": {"density_kg_m3": 1.2, "kinematic_viscosity_m2_s": 1.5e-5}}"#,
    );
    let parts = "--part wind --captures captures --part file --field f.eff.mcap";
    let run = room.run(&format!("bench {parts} -o out")).ended(1);
    let run = run.says(&["file: done", "wind: failed: capture empty", "error: 1 of 2 parts failed: wind"]);
    assert!(run.out.contains("A field in a file"), "{}", run.out);
    let index = text(&room, "out/index.html");
    assert!(index.contains("href=\"file.html\"") && index.contains("href=\"file.csv\""), "{index}");
    assert!(index.contains("wind: failed") && index.contains("capture empty"), "{index}");
    assert!(text(&room, "out/file.csv").starts_with("field,written as,"));
    assert!(text(&room, "out/file.html").contains("eff f16"));
    assert!(!room.path("out/wind.html").exists());
}

/// Told before any work: a part that needs captures and has none, captures that are not there, options before a part.
#[test]
fn what_cannot_be_run_is_told_before_the_work() {
    let room = Room::new();
    let before = room.files();
    room.run("bench --part file --part wind -o out").ended(2).says(&["--part wind", "--captures"]);
    room.run("bench all --captures nowhere -o out").ended(1).says(&["cannot list the captures in nowhere"]);
    room.run("bench --capture gusts_left -o out").ended(2).says(&["--captures"]);
    room.run("bench -o out file f.eff.mcap").ended(2).says(&["options before the part"]);
    room.run("bench -q file nowhere.eff.mcap").ended(1).says(&["nowhere.eff.mcap"]);
    assert_eq!(room.files(), before);
}
