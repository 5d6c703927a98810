//! The commands as a user meets them, one after the other.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::Room;
use std::process::Command;

/// Convert, validate, inspect, simulate, edit, export, import: each on what the one before wrote.
#[test]
fn the_whole_road() {
    let room = Room::new();
    room.run("convert gusts.c3d --method paper --session session.json -o f.eff.mcap --voxel-mm 50").ended(0);
    let validation = room.run("validate f.eff.mcap --json").ended(0);
    let validation: serde_json::Value = serde_json::from_str(&validation.out).unwrap();
    assert_eq!((&validation[0]["kind"], &validation[0]["is_sound"]), (&"field".into(), &true.into()));

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
    let residual = &edit["effects"]["edits"][0]["keys"][0]["residual_mm"];
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
    assert!(table.contains("assumed  friction"), "what the session leaves out is told: {table}");
    room.run("inspect gusts.c3d --report q.html").ended(2);
    room.run(&format!("{inspect} --report q.pdf")).ended(2);
    let convert = "convert gusts.c3d --method paper --session session.json --voxel-mm 100 -o f.eff.mcap --no-clean --json";
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
    let room = Room::with_field();
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
    assert!(page.contains("The edit is by the method physical: the smallest and smoothest extra wind"));
    let files = page.split("<h3>Files</h3>").nth(1).and_then(|rest| rest.split("</table>").next()).unwrap();
    let cells = files.split("<td><code>").skip(1).filter_map(|cell| cell.split('<').next());
    let mut listed: Vec<String> = cells.chain(["index.html"]).map(str::to_owned).collect();
    listed.sort();
    assert_eq!(listed, room.files_in("demo"), "files on the page (left) and in the folder (right)");
    room.run("simulate demo/gusts.eff.mcap --groom demo/bob.json -o bob.npz -o bob.usda --shape both")
        .ended(0);
    for file in ["bob.npz", "bob.usda"] {
        assert!(
            room.read(file) == room.read(&format!("demo/{file}")),
            "{file}, by the command that the page names"
        );
    }
    // The edits that the documentation shows are for the demo's field.
    for page in [include_str!("../../../docs/direct.md"), include_str!("../../../docs/equations.md")] {
        let example = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
        room.write("edits.toml", example);
        let edit = "edit demo/lifted.eff.mcap --groom demo/bob.json --edits edits.toml -o e.eff.mcap";
        room.run(edit).ended(0);
    }
}

#[test]
fn a_cut_field_gives_back_its_whole_steps() {
    let room = Room::with_field();
    let bytes = room.read("f.eff.mcap");
    room.write("cut.eff.mcap", &bytes[..bytes.len() / 2]);
    room.run("validate cut.eff.mcap").ended(1);
    let run = room.run("recover cut.eff.mcap -o saved.eff.mcap").ended(3);
    assert!(run.out.contains("of 120 steps"), "{}", run.out);
    room.run("validate saved.eff.mcap").ended(0);
    room.run("recover f.eff.mcap -o whole.eff.mcap").ended(0);
    // Bytes that came in between cost all behind them, as the README says; bytes that changed cost the step they are in.
    let half = bytes.len() / 2;
    let n_whole = |name: &str, bytes: &[u8]| {
        room.write(name, bytes);
        let run = room.run(&format!("recover {name} -o saved.eff.mcap --json")).ended(3);
        let told: serde_json::Value = serde_json::from_str(&run.out).unwrap();
        let n_bridged = told["bridged"].as_array().unwrap().len() as u64;
        told["n_steps"].as_u64().unwrap() - n_bridged
    };
    let n_cut = n_whole("cut.eff.mcap", &bytes[..half]);
    assert_eq!(n_whole("more.eff.mcap", &[&bytes[..half], b"x", &bytes[half..]].concat()), n_cut);
    assert_eq!(n_whole("less.eff.mcap", &[&bytes[..half], &bytes[half + 1..]].concat()), n_cut);
    assert_eq!(
        n_whole("other.eff.mcap", &[&bytes[..half], &[!bytes[half]], &bytes[half + 1..]].concat()),
        119
    );
}

#[test]
fn a_lossy_encoding_is_smaller_and_says_its_bound() {
    let room = Room::with_field();
    let convert = "convert gusts.c3d --method paper --session session.json --voxel-mm 50";
    room.run(&format!("{convert} -o fixed.eff.mcap --encoding fixed --max-error 0.001")).ended(0);
    assert!(room.read("fixed.eff.mcap").len() < room.read("f.eff.mcap").len() / 2);
    room.run("validate fixed.eff.mcap").ended(0);
    room.run(&format!("{convert} -o g.eff.mcap --encoding fixed")).ended(2);
}

/// However a field is packed, editing it copies its voxels.
#[test]
fn an_edited_field_stays_packed_as_it_was() {
    let room = Room::new();
    let pack = "--encoding fixed --max-error 0.01";
    room.run(&format!(
        "convert gusts.c3d --method paper --session session.json -o f.eff.mcap --voxel-mm 50 {pack}"
    ))
    .ended(0);
    room.run("edit f.eff.mcap --groom bob.json --edits lift.toml -o e.eff.mcap").ended(0);
    room.run("validate e.eff.mcap").ended(0);
    let fields = ["f", "e"].map(|name| {
        tousle_eff::read(&room.read(&format!("{name}.eff.mcap"))[..], &tousle_eff::ReadOptions::default())
            .unwrap()
    });
    let [before, after] = fields;
    assert_eq!(after.field.steps, before.field.steps);
    assert_eq!((after.samples, after.attachments), (before.samples, before.attachments));
    assert_eq!((before.field.layers.len(), after.field.layers.len()), (0, 1));
    let encoding = room.run("inspect e.eff.mcap --json").ended(0);
    assert!(encoding.out.contains("\"fixed\""), "{}", encoding.out);
}

/// What `export` writes as OpenVDB, `import` takes in: the same voxels, bit for bit.
#[test]
fn a_field_goes_out_and_in_as_openvdb() {
    let room = Room::with_field();
    room.run("export f.eff.mcap -o f.vdb").ended(0);
    room.run("import f.vdb --session session.json -o g.eff.mcap").ended(0);
    let [out, back] = ["f", "g"].map(|name| {
        let bytes = room.read(&format!("{name}.eff.mcap"));
        tousle_eff::read(&bytes[..], &tousle_eff::ReadOptions::default()).unwrap().field
    });
    assert_eq!(back, out);
    // Some of them, in any order, are a shorter field.
    room.run("import f.0007.vdb f.0006.vdb f.0008.vdb --session session.json -o h.eff.mcap").ended(0);
    let inspection = room.run("inspect h.eff.mcap").ended(0);
    assert!(inspection.out.contains("0.200 to 0.267 s"), "{}", inspection.out);
    room.run("import f.0000.vdb f.0002.vdb f.0003.vdb --session session.json -o i.eff.mcap")
        .ended(1)
        .says(&["step 1", "even steps"]);
    room.run("import none.vdb --session session.json -o i.eff.mcap").ended(1).says(&["none.0000.vdb"]);
    assert!(!room.path("i.eff.mcap").exists());
}

/// Told by the file itself, or impossible: wrong arguments, and no wind is blamed.
#[test]
fn imports_refuse_options_that_would_do_nothing() {
    let room = Room::with_field();
    room.run("export f.eff.mcap -o f.npz").ended(0);
    room.run("export f.eff.mcap -o f.vdb").ended(0);
    let before = room.files();
    for (words, says) in [
        ("f.npz f.npz", "found 2 files, expected one .npz"),
        ("f.npz f.0000.vdb", "found 2 files, expected one .npz"),
        ("f.npz --extent-mm 400", "--extent-mm: found with f.npz, which has `origin` and `edge`"),
        ("f.vdb --rate-hz 12", "--rate-hz: found with .vdb files that say when they are"),
        ("f.npz --extent-mm 0", "expected a number above 0"),
        ("f.npz --extent-mm=-5", "expected a number above 0"),
        ("f.npz --extent-mm nan", "expected a number above 0"),
        ("f.vdb --rate-hz 0", "expected a number above 0"),
    ] {
        let run = room.run(&format!("import {words} --session session.json -o g.eff.mcap"));
        assert_eq!(run.code, Some(2), "{words}: {}{}", run.out, run.err);
        run.says(&[says]);
    }
    assert_eq!(room.files(), before);
}

/// Wind from elsewhere gets the head's poses from elsewhere, too.
#[test]
fn imported_wind_takes_the_heads_poses() {
    let room = Room::with_field();
    room.run("export f.eff.mcap -o f.npz").ended(0);
    let bytes = room.read("f.eff.mcap");
    let mut eff = tousle_eff::read(&bytes[..], &tousle_eff::ReadOptions::default()).unwrap();
    let poses = &mut eff.scene.poses;
    let first = poses.poses[0];
    poses.poses =
        (0..10).map(|k| tousle_core::Pose::translation(0.01 * f64::from(k), 0.0, 0.0) * first).collect();
    poses.rate_hz = 30.0;
    let mut npz = std::io::Cursor::new(Vec::new());
    tousle_export::write_poses_npz(poses, &mut npz).unwrap();
    room.write("head.npz", npz.get_ref());
    room.run("import f.npz --session session.json --head head.npz -o g.eff.mcap").ended(0);
    let back = tousle_eff::read(&room.read("g.eff.mcap")[..], &tousle_eff::ReadOptions::default()).unwrap();
    assert_eq!(back.scene.poses.poses.len(), 10);
    let off = back.scene.poses.poses[9].translation.vector - first.translation.vector;
    assert!((off.x - 0.09).abs() < 1e-9 && off.yz().norm() < 1e-9, "{off}");
}

/// Channels for viewers: in the file if they are wanted, checked, and skipped by all who read the field.
#[test]
fn previews_are_there_if_they_are_wanted() {
    let room = Room::with_field();
    let convert = "convert gusts.c3d --method paper --session session.json --voxel-mm 50";
    room.run(&format!("{convert} -o shown.eff.mcap --preview")).ended(0);
    let validation = room.run("validate shown.eff.mcap --json").ended(0);
    assert!(validation.out.contains("\"findings\": []"), "{}", validation.out);
    let [plain, shown] = ["f", "shown"].map(|name| {
        tousle_eff::read(&room.read(&format!("{name}.eff.mcap"))[..], &tousle_eff::ReadOptions::default())
            .unwrap()
    });
    assert_eq!(plain, shown);
    let inspection = room.run("inspect shown.eff.mcap").ended(0);
    assert!(inspection.out.contains("/preview/wind"), "{}", inspection.out);
}

/// Whoever writes a file with previews again makes them again, of what it then holds.
#[test]
fn previews_stay_when_a_file_is_written_again() {
    let room = Room::new();
    let convert = "convert gusts.c3d --method paper --session session.json --voxel-mm 50";
    room.run(&format!("{convert} -o shown.eff.mcap --preview")).ended(0);
    room.run("recover shown.eff.mcap -o saved.eff.mcap").ended(0);
    room.run("migrate shown.eff.mcap -o migrated.eff.mcap").ended(0);
    let shown = room.read("shown.eff.mcap");
    assert!(room.read("saved.eff.mcap") == shown && room.read("migrated.eff.mcap") == shown);
    room.run("edit shown.eff.mcap --groom bob.json --edits lift.toml -o edited.eff.mcap").ended(0);
    let edited = room.read("edited.eff.mcap");
    let eff = tousle_eff::read(&edited[..], &tousle_eff::ReadOptions::default()).unwrap();
    assert!(!eff.field.layers.is_empty());
    let mut whole = Vec::new();
    let options = tousle_eff::WriteOptions::default().with_preview();
    tousle_eff::write(&eff, &mut whole, &options, &tousle_core::NoProgress).unwrap();
    assert!(edited == whole, "{} bytes instead of {}", edited.len(), whole.len());
}

/// Sessions, grooms and edits: all that is wrong, at once, and what is sound is said to be.
#[test]
fn files_that_people_write_are_validated() {
    let room = Room::new();
    room.run("validate session.json bob.json lift.toml").ended(0);
    let session = String::from_utf8(room.read("session.json")).unwrap();
    room.write(
        "bad.json",
        session.replacen("\"length_mm\": 175.0", "\"length_mm\": -1", 1).replace("\"Z\"", "\"up\""),
    );
    let lift = String::from_utf8(room.read("lift.toml")).unwrap();
    room.write("bad.toml", lift.replace("reach_m = 0.06", "reach_m = 6"));
    let run = room.run("validate bad.json lift.toml bad.toml --json").ended(1);
    let verdicts: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    let whats = |k: usize| {
        let findings = verdicts[k]["findings"].as_array().unwrap();
        findings.iter().map(|f| f["what"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(whats(0), ["strands[0]", "up_axis"], "{}", run.out);
    assert_eq!(
        (verdicts[0]["kind"].as_str(), verdicts[1]["is_sound"].as_bool()),
        (Some("session"), Some(true))
    );
    assert_eq!(whats(2), ["edit[0]"], "{}", run.out);
    assert!(verdicts.as_array().unwrap().iter().all(|verdict| verdict["n_more"] == 0), "{}", run.out);
}

#[test]
fn an_old_field_becomes_a_new_one() {
    let room = Room::new();
    let old = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/eff/v0/good/small.eff.mcap");
    let run = room.run(&format!("migrate {old} -o new.eff.mcap")).ended(0);
    assert!(run.out.contains("from version 0 to 1"), "{}", run.out);
    room.run("validate new.eff.mcap").ended(0);
    let extended = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/eff/v1/good/extended.eff.mcap");
    let run = room.run(&format!("migrate {extended} -o new.eff.mcap")).ended(3);
    assert!(run.err.starts_with("loss: fields from number 1000 on"), "{}", run.err);
}

/// The editor's window is a program of its own; where it is not built, one is told how to.
#[test]
fn a_studio_that_is_not_there_is_told_how_to_get() {
    let room = Room::new();
    let alone = room.path("tousle");
    std::fs::copy(env!("CARGO_BIN_EXE_tousle"), &alone).unwrap();
    let mut command = Command::new(&alone);
    command.args(["studio", "f.eff.mcap", "--groom", "bob.json"]).env("PATH", "");
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("cargo build --release -p tousle-studio"), "{said}");
    // Who asks what it is has no error to be told of.
    for help in ["--help", "-h"] {
        let output = Command::new(&alone).args(["studio", help]).env("PATH", "").output().unwrap();
        let said = String::from_utf8(output.stdout).unwrap();
        assert_eq!(output.status.code(), Some(0), "{said}");
        assert!(said.contains("Usage: tousle studio FIELD --groom GROOM"), "{said}");
        assert!(said.contains("cargo build --release -p tousle-studio"), "{said}");
    }
}
