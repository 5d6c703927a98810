//! The commands as a user meets them, one after the other.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::Room;

/// Convert, validate, inspect, simulate, edit, export, import: each on what the one before wrote.
#[test]
fn the_whole_road() {
    let room = Room::new();
    room.run("convert gusts.c3d --session session.json -o f.eff.mcap --voxel-mm 50").ended(0);
    let validation = room.run("validate f.eff.mcap --json").ended(0);
    assert!(validation.out.contains("\"is_sound\": true"), "{}", validation.out);

    let field = room.run("inspect f.eff.mcap --json").ended(0);
    let field: serde_json::Value = serde_json::from_str(&field.out).unwrap();
    assert_eq!(field["kind"], "field");

    let run =
        room.run("simulate f.eff.mcap --groom bob.json -o m.npz -o m.usda --shape both --explain").ended(0);
    assert!(run.out.contains("head movement"), "{}", run.out);
    assert!(run.err.is_empty(), "no bars where there is no terminal: {}", run.err);
    assert!(room.read("m.usda").starts_with(b"#usda 1.0"));

    let edit = room.run("edit f.eff.mcap --groom bob.json --edits lift.toml -o e.eff.mcap --json").ended(0);
    let edit: serde_json::Value = serde_json::from_str(&edit.out).unwrap();
    let residual = &edit["effects"]["edits"][0]["residual_mm"];
    let (before, after) = (residual["before"].as_f64().unwrap(), residual["after"].as_f64().unwrap());
    assert!(after < before, "the strand moves towards its target: {before} mm, then {after} mm");
    let edited = room.run("inspect e.eff.mcap").ended(0);
    assert!(edited.out.contains("lift a lock"), "{}", edited.out);

    room.run("export f.eff.mcap -o f.npz").ended(0);
    room.run("export f.eff.mcap -o f.vdb").ended(0);
    assert!(room.read("f.0119.vdb").len() > 1000);
    room.run("import f.npz --session session.json -o g.eff.mcap").ended(0);
    room.run("validate f.eff.mcap e.eff.mcap g.eff.mcap").ended(0);
}

#[test]
fn captures_and_grooms_can_be_inspected() {
    let room = Room::new();
    let capture = room.run("inspect gusts.c3d --json").ended(0);
    let capture: serde_json::Value = serde_json::from_str(&capture.out).unwrap();
    assert_eq!(capture["kind"], "capture");
    assert_eq!(capture["frames"], 480);
    assert_eq!(capture["unit"], "mm");
    assert_eq!(capture["labels"][0], "Wig:LFHD");
    let groom = room.run("inspect bob.json --json").ended(0);
    let groom: serde_json::Value = serde_json::from_str(&groom.out).unwrap();
    assert_eq!((&groom["kind"], &groom["strands"]), (&"groom".into(), &60.into()));
    room.run("inspect gusts.c3d").ended(0);
    room.run("inspect bob.json").ended(0);
}

#[test]
fn a_capture_with_its_session_tells_its_quality() {
    let room = Room::new();
    let inspect = "inspect gusts.c3d --session session.json";
    let run = room.run(&format!("{inspect} --report q.html --report q.json --json")).ended(0);
    let told: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!((&told["kind"], &told["frames"]), (&"capture".into(), &480.into()));
    let report: serde_json::Value = serde_json::from_slice(&room.read("q.json")).unwrap();
    assert_eq!(told["quality"], report);
    assert_eq!(report["head"]["frames"]["n_used"].as_array().unwrap().len(), 480);
    assert!(!report["clean"]["markers"].as_array().unwrap().is_empty());
    let page = String::from_utf8(room.read("q.html")).unwrap();
    assert!(page.contains("gusts.c3d") && page.ends_with("</html>\n"));
    let table = room.run(&format!("{inspect} --no-clean")).ended(0).out;
    assert!(
        table.contains("subjects   Wig")
            && table.contains("longest")
            && table.contains("as the file has them")
    );
    room.run("inspect gusts.c3d --report q.html").ended(2);
    room.run(&format!("{inspect} --report q.pdf")).ended(1);
    let convert = "convert gusts.c3d --session session.json --voxel-mm 100 -o f.eff.mcap --no-clean --json";
    let told: serde_json::Value = serde_json::from_str(&room.run(convert).ended(0).out).unwrap();
    assert!(told["clean"].is_null());
}

#[test]
fn the_same_motion_for_any_number_of_threads() {
    let room = Room::new();
    room.run("convert gusts.c3d --session session.json -o f.eff.mcap --voxel-mm 50 --threads 1").ended(0);
    room.run("convert gusts.c3d --session session.json -o g.eff.mcap --voxel-mm 50 --threads 2").ended(0);
    assert!(room.read("f.eff.mcap") == room.read("g.eff.mcap"), "fields");
    room.run("simulate f.eff.mcap --groom bob.json -o one.npz --threads 1").ended(0);
    room.run("simulate f.eff.mcap --groom bob.json -o two.npz --threads 2").ended(0);
    assert!(room.read("one.npz") == room.read("two.npz"), "motions");
}

/// An edit does nothing before its first key, to the bit.
#[test]
fn before_the_first_key_nothing_moves() {
    let room = Room::new();
    room.run("convert gusts.c3d --session session.json -o f.eff.mcap --voxel-mm 50").ended(0);
    let edit = room.run("edit f.eff.mcap --groom bob.json --edits lift.toml -o e.eff.mcap --json").ended(0);
    let edit: serde_json::Value = serde_json::from_str(&edit.out).unwrap();
    let first_change = edit["effects"]["first_change_secs"].as_f64().unwrap();
    assert!(first_change > 2.0, "the first key is at 2.0 s, the first change at {first_change} s");
}

#[test]
fn the_demo_writes_a_page_and_all_it_names() {
    let room = Room::new();
    let run = room.run("demo -o demo").ended(0);
    assert!(run.out.contains("index.html"), "{}", run.out);
    let page = String::from_utf8(room.read("demo/index.html")).unwrap();
    assert!(page.starts_with("<!doctype html>") || page.starts_with("<!DOCTYPE html>"));
    for file in ["gusts.eff.mcap", "gusts.npz", "bob.npz", "bob.usda", "lifted.eff.mcap", "session.json"] {
        assert!(!room.read(&format!("demo/{file}")).is_empty());
        assert!(page.contains(file), "the page names {file}");
    }
    room.run("validate demo/gusts.eff.mcap demo/lifted.eff.mcap").ended(0);
}

#[test]
fn a_cut_field_gives_back_its_whole_steps() {
    let room = Room::new();
    room.run("convert gusts.c3d --session session.json -o f.eff.mcap --voxel-mm 50").ended(0);
    let bytes = room.read("f.eff.mcap");
    room.write("cut.eff.mcap", &bytes[..bytes.len() / 2]);
    room.run("validate cut.eff.mcap").ended(1);
    let run = room.run("recover cut.eff.mcap -o saved.eff.mcap").ended(3);
    assert!(run.out.contains("of 120 steps"), "{}", run.out);
    room.run("validate saved.eff.mcap").ended(0);
    room.run("recover f.eff.mcap -o whole.eff.mcap").ended(0);
}

#[test]
fn a_lossy_encoding_is_smaller_and_says_its_bound() {
    let room = Room::new();
    let convert = "convert gusts.c3d --session session.json --voxel-mm 50";
    room.run(&format!("{convert} -o f32.eff.mcap")).ended(0);
    room.run(&format!("{convert} -o fixed.eff.mcap --encoding fixed --max-error 0.001")).ended(0);
    assert!(room.read("fixed.eff.mcap").len() < room.read("f32.eff.mcap").len() / 2);
    room.run("validate fixed.eff.mcap").ended(0);
    room.run(&format!("{convert} -o g.eff.mcap --encoding fixed")).ended(2);
}

#[test]
fn an_old_field_becomes_a_new_one() {
    let room = Room::new();
    let old = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/eff/v0/good/small.eff.mcap");
    let run = room.run(&format!("migrate {old} -o new.eff.mcap")).ended(0);
    assert!(run.out.contains("from version 0 to 1"), "{}", run.out);
    room.run("validate new.eff.mcap").ended(0);
}
