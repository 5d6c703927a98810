//! Several captures of one wig become one field.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::Room;
use serde_json::Value;
use std::sync::LazyLock;

/// A room with the sessions of two captures of one wind: the demo's, and the same with every second lock unseen.
fn room_with_sessions() -> Room {
    let room = Room::new();
    let session: Value = serde_json::from_slice(&room.read("session.json")).unwrap();
    for (name, first) in [("even", 0), ("odd", 1)] {
        let mut session = session.clone();
        let locks = session["strands"].as_array_mut().unwrap();
        let kept: Vec<Value> = locks.iter().skip(first).step_by(2).cloned().collect();
        *locks = kept;
        session["name"] = name.into();
        room.write(&format!("{name}.json"), session.to_string());
    }
    room
}

/// Their fields, packed like this.
fn convert_both(room: &Room, pack: &str) {
    for name in ["even", "odd"] {
        let convert = format!("convert gusts.c3d --method paper --session {name}.json --voxel-mm 50 {pack}");
        room.run(&format!("{convert} -o {name}.eff.mcap")).ended(0);
    }
}

/// A room with both, converted once for all tests.
fn room() -> Room {
    static FIELDS: LazyLock<[Vec<u8>; 2]> = LazyLock::new(|| {
        let room = room_with_sessions();
        convert_both(&room, "");
        ["even", "odd"].map(|name| room.read(&format!("{name}.eff.mcap")))
    });
    let room = room_with_sessions();
    for (name, field) in ["even", "odd"].iter().zip(&*FIELDS) {
        room.write(&format!("{name}.eff.mcap"), field);
    }
    room
}

fn inspected(room: &Room, file: &str) -> Value {
    serde_json::from_str(&room.run(&format!("inspect {file} --json")).ended(0).out).unwrap()
}

#[test]
fn two_captures_are_richer_than_one() {
    let room = room();
    let run = room.run("merge even.eff.mcap odd.eff.mcap -o both.eff.mcap --json").ended(0);
    let report: Value = serde_json::from_str(&run.out).unwrap();
    assert!(report["n_measured_by_several"].as_u64().unwrap() > 0, "{report}");
    room.run("validate both.eff.mcap").ended(0);
    let measured = |file: &str| inspected(&room, file)["coverage"]["measured"].as_f64().unwrap();
    let [even, odd, both] = ["even", "odd", "both"].map(|f| measured(&format!("{f}.eff.mcap")));
    assert!(both > 1.2 * even.max(odd) && both <= even + odd, "{even} {odd} {both}");
    let all = inspected(&room, "both.eff.mcap");
    assert_eq!(all["manifest"]["name"], "even + odd");
    let names: Vec<&str> =
        all["attachments"].as_array().unwrap().iter().map(|a| a[0].as_str().unwrap()).collect();
    assert_eq!(
        names,
        [
            "merge.json",
            "inputs/1/session.json",
            "inputs/1/report.json",
            "inputs/2/session.json",
            "inputs/2/report.json"
        ]
    );
    // In the other order it is the same wind.
    room.run("merge odd.eff.mcap even.eff.mcap -o turned.eff.mcap").ended(0);
    room.run("export both.eff.mcap -o both.npz").ended(0);
    room.run("export turned.eff.mcap -o turned.npz").ended(0);
    assert_eq!(room.read("both.npz"), room.read("turned.npz"));
}

#[test]
fn the_packing_and_the_clock() {
    let room = room_with_sessions();
    convert_both(&room, "--encoding fixed --max-error 0.01");
    room.run("merge even.eff.mcap odd.eff.mcap -o late.eff.mcap --offset-secs 0,0.515 --span common")
        .ended(0);
    let late = inspected(&room, "late.eff.mcap");
    assert_eq!(late["manifest"]["field"]["encoding"]["kind"], "fixed");
    let span = |key: usize| late["field_span_secs"][key].as_f64().unwrap();
    assert!((span(0) - 0.515).abs() < 1e-9 && span(1) <= 4.0, "{}", late["field_span_secs"]);
    room.run("merge even.eff.mcap odd.eff.mcap -o a.eff.mcap --offset-secs 1")
        .ended(2)
        .says(&["--offset-secs", "2"]);
    room.run("merge even.eff.mcap odd.eff.mcap -o a.eff.mcap --offset-secs 0,-3")
        .ended(1)
        .says(&["odd.eff.mcap", "-3 s"]);
    room.run("merge even.eff.mcap odd.eff.mcap -o a.eff.mcap --offset-secs 0,1e25")
        .ended(1)
        .says(&["odd.eff.mcap ends at", "expected 1000000 s or earlier"]);
}

/// Two people called their edits the same: both are there, each can be taken out, and what became of the name is said.
#[test]
fn edits_of_one_name_stay_two() {
    let room = room();
    let lift = String::from_utf8(room.read("lift.toml")).unwrap();
    room.write("other.toml", lift.replace("0.08]", "0.05]"));
    for (field, edits) in [("even", "lift"), ("odd", "other")] {
        let edit = format!("edit {field}.eff.mcap --groom bob.json --edits {edits}.toml");
        room.run(&format!("{edit} -o {field}-{edits}.eff.mcap")).ended(0);
    }
    let run = room.run("merge even-lift.eff.mcap odd-other.eff.mcap -o both.eff.mcap").ended(0);
    run.says(&["warning: the edit `lift-a-lock` of odd-other.eff.mcap", "it is `lift-a-lock-2` now"]);
    room.write("rest.toml", "version = 1\n[[change]]\nkind = \"remove\"\nedit = \"lift-a-lock\"\n");
    room.run("edit both.eff.mcap --groom bob.json --edits rest.toml -o rest.eff.mcap").ended(0);
    let edits = |file: &str| inspected(&room, file)["layers"].to_string();
    let [both, rest] = ["both", "rest"].map(|name| edits(&format!("{name}.eff.mcap")));
    assert!(both.contains("(lift-a-lock)") && both.contains("(lift-a-lock-2)"), "{both}");
    assert!(!rest.contains("(lift-a-lock)") && rest.contains("(lift-a-lock-2)"), "{rest}");
}

#[test]
fn what_does_not_belong_together_is_named() {
    let room = room();
    room.run("merge even.eff.mcap even.eff.mcap -o a.eff.mcap").ended(1).says(&["twice"]);
    room.run("merge even.eff.mcap -o a.eff.mcap").ended(2);
    let mut session: Value = serde_json::from_slice(&room.read("odd.json")).unwrap();
    session["colliders"]["head_ellipsoid_half_axes_mm"] = serde_json::json!([95, 75, 130]);
    room.write("tall.json", session.to_string());
    room.run("convert gusts.c3d --method paper --session tall.json -o tall.eff.mcap --voxel-mm 50").ended(0);
    room.run("merge even.eff.mcap tall.eff.mcap -o a.eff.mcap").ended(1).says(&[
        "collider",
        "tall.eff.mcap",
        "0.13",
    ]);
    room.run("export odd.eff.mcap -o w.npz").ended(0);
    room.run("import w.npz --session odd.json -o w.eff.mcap").ended(0);
    room.run("merge even.eff.mcap w.eff.mcap -o a.eff.mcap").ended(1).says(&["w.eff.mcap", "even.eff.mcap"]);
    assert!(!room.path("a.eff.mcap").exists());
}
