//! What is told: of files that a command is not for, of damage, of motion, in which unit.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::Room;

/// A field of one step, one pose, in voxels of 200 mm, of version 0.
const SMALL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/eff/v0/good/small.eff.mcap");

#[test]
fn the_help_says_what_it_is_for() {
    let run = Room::new().run("--help").ended(0);
    assert!(run.out.starts_with("Hair in the wind, measured once"), "{}", run.out);
}

/// A field that cannot be used is named, not the output, and where it was cut, so is what saves the rest.
#[test]
fn a_cut_field_is_named_and_what_saves_it() {
    let room = Room::with_field();
    let bytes = room.read("f.eff.mcap");
    room.write("cut.eff.mcap", &bytes[..bytes.len() / 2]);
    let before = room.files();
    for words in [
        "migrate cut.eff.mcap -o g.eff.mcap",
        "export cut.eff.mcap -o g.npz",
        "simulate cut.eff.mcap --groom bob.json -o g.npz",
    ] {
        let run = room.run(words).ended(1);
        run.says(&["cannot use the field cut.eff.mcap", "`tousle recover` saves the whole steps"]);
    }
    room.run("inspect cut.eff.mcap").ended(1).says(&["cannot inspect cut.eff.mcap (`tousle recover` saves"]);
    let run = room.run("validate cut.eff.mcap").ended(1);
    assert!(run.out.contains("`tousle recover` saves the whole steps"), "{}", run.out);
    // There is nothing to be saved of what is no field.
    for command in ["recover", "migrate"] {
        let run = room.run(&format!("{command} bob.json -o g.eff.mcap")).ended(1);
        let run = run.says(&["cannot use the field bob.json (`tousle validate` lists all that is wrong)"]);
        assert!(!run.err.contains("tousle recover"), "{}", run.err);
    }
    room.run("merge cut.eff.mcap f.eff.mcap -o g.eff.mcap").ended(1).says(&["the field cut.eff.mcap"]);
    assert_eq!(room.files(), before);
}

/// What `validate` and `inspect` are not for they tell, and which command is.
#[test]
fn a_file_for_another_command_is_told_which() {
    let room = Room::with_field();
    room.run("export f.eff.mcap -o f.npz").ended(0);
    room.run("export f.eff.mcap -o f.vdb").ended(0);
    for (file, kind, found, command) in [
        ("gusts.c3d", "capture", "a capture (c3d)", "`tousle inspect`"),
        ("f.npz", "npz", "NumPy arrays (.npz)", "`tousle import`"),
        ("f.0000.vdb", "vdb", "OpenVDB grids (.vdb)", "`tousle import`"),
    ] {
        let told = room.run(&format!("validate {file} --json")).ended(1).out;
        let told: serde_json::Value = serde_json::from_str(&told).unwrap();
        assert_eq!((&told[0]["kind"], &told[0]["is_sound"]), (&kind.into(), &false.into()));
        let message = told[0]["findings"][0]["message"].as_str().unwrap();
        assert!(
            message.contains(&format!("found {found}, expected")) && message.contains(command),
            "{message}"
        );
        if kind != "capture" {
            room.run(&format!("inspect {file}")).ended(1).says(&[found, command]);
        }
    }
    room.run("inspect lift.toml").ended(1).says(&["found edits", "`tousle validate` checks edits"]);
    room.run("inspect session.json").ended(1).says(&["found a session", "`tousle validate` checks sessions"]);
}

/// A pipe can be read once, from its beginning to its end: some can do with that, the others say so.
#[test]
#[cfg(target_os = "linux")]
fn a_pipe_is_read_or_refused() {
    let room = Room::with_field();
    let run = room.shell("$TOUSLE validate <(cat f.eff.mcap) <(cat lift.toml)").ended(0);
    assert_eq!(run.out.matches(": sound").count(), 2, "{}", run.out);
    let refused = ["found a pipe, expected a file that can be read in any order"];
    room.shell("$TOUSLE simulate <(cat f.eff.mcap) --groom bob.json -o m.npz").ended(1).says(&refused);
    room.shell("$TOUSLE merge f.eff.mcap <(cat f.eff.mcap) -o g.eff.mcap").ended(1).says(&refused);
}

/// Any name that the system has is one.
#[test]
#[cfg(target_os = "linux")]
fn a_head_of_any_name() {
    let room = Room::with_field();
    let prim = "#usda 1.0\n( upAxis = \"Z\" metersPerUnit = 1 )\ndef Xform \"Head\" {\n\
                double3 xformOp:translate.timeSamples = { 0: (0, 0, 1.6), 24: (0, 0, 1.6) }\n\
                uniform token[] xformOpOrder = [\"xformOp:translate\"]\n}\n";
    room.write("head.usda", prim);
    let simulate = "$TOUSLE simulate f.eff.mcap --groom bob.json --duration-secs 0.1";
    let line = format!("mv head.usda $'h\\xff.usda' && {simulate} --head $'h\\xff.usda:/Head' -o m.npz");
    room.shell(&line).ended(0);
}

/// What a `--time` is about is not in the motion: it is warned of, and does nothing.
#[test]
fn a_time_that_changes_nothing_is_warned_of() {
    let room = Room::with_field();
    let simulate = "simulate f.eff.mcap --groom bob.json";
    room.run(&format!("{simulate} -o once.npz")).ended(0);
    let run = room.run(&format!("{simulate} --time hold -o hold.npz")).ended(0);
    run.says(&["warning: --time hold: found a motion that ends at 3.967 s", "--duration-secs"]);
    assert!(room.read("once.npz") == room.read("hold.npz"));
    room.run(&format!("{simulate} --time loop --duration-secs 1 -o m.npz"))
        .ended(0)
        .says(&["warning: --time"]);
    let run = room.run(&format!("{simulate} --time hold --duration-secs 4.2 -o m.npz")).ended(0);
    assert_eq!(run.err, "");
}

/// An edit that moves nothing is not said to move some strand by nothing.
#[test]
fn nothing_moved_is_said_so() {
    let room = Room::with_field();
    let edit = |field: &str, edits: &str| {
        room.write("e.toml", edits);
        room.run(&format!("edit {field} --groom bob.json --edits e.toml -o g.eff.mcap")).ended(0).out
    };
    let told = edit("f.eff.mcap", "version = 1\n");
    assert!(told.contains("nothing moved") && !told.contains("0.00 mm"), "{told}");
    room.run("edit f.eff.mcap --groom bob.json --edits lift.toml -o lifted.eff.mcap").ended(0);
    let rename = "[[change]]\nkind = \"rename\"\nedit = \"lift-a-lock\"\nname = \"lifted\"\n";
    let told = edit("lifted.eff.mcap", rename);
    assert!(told.contains("nothing moved") && !told.contains("0.00 mm"), "{told}");
}

/// Lengths and strengths have units, one is one, and nothing has digits that nobody measured.
#[test]
fn numbers_are_told_with_their_units() {
    let room = Room::with_field();
    let told = room.run(&format!("inspect {SMALL}")).ended(0).out;
    assert!(told.contains("voxels of 200 mm"), "{told}");
    assert!(!told.contains(" 1 poses") && !told.contains(" 1 messages"), "{told}");
    let told = room.run("inspect f.eff.mcap").ended(0).out;
    assert!(told.contains(" m/s² in the mean where measured, "), "{told}");
    let told = room.run("simulate f.eff.mcap --groom bob.json --duration-secs 0 -o m.npz").ended(0).out;
    assert!(told.contains(" 1 frame;"), "{told}");
    let told = room.run("edit f.eff.mcap --groom bob.json --edits lift.toml -o g.eff.mcap").ended(0).out;
    assert!(!told.contains(" 1 handles"), "{told}");
    let told = room.run("inspect f.eff.mcap --json").ended(0).out;
    let told: serde_json::Value = serde_json::from_str(&told).unwrap();
    let gravity = told["manifest"]["scene"]["gravity_world"].to_string();
    assert_eq!(gravity, "[0.0,0.0,-9.81]");
}
