//! Bad input: a clear error, exit code 1, or 2 for a wrong argument, and nothing written.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::Room;

/// Runs `convert` on a changed room; it must fail with these words and leave no file behind.
#[track_caller]
fn convert_refuses(change: impl FnOnce(&Room) -> String, words: &[&str]) {
    convert_ends(1, change, words);
}

#[track_caller]
fn convert_ends(code: i32, change: impl FnOnce(&Room) -> String, words: &[&str]) {
    let room = Room::new();
    let arguments = change(&room);
    let before = room.files();
    room.run(&format!("convert {arguments} -o out.eff.mcap")).ended(code).says(words);
    assert_eq!(room.files(), before);
}

const GOOD_SESSION: &str = "--session session.json";

#[test]
fn an_empty_capture() {
    convert_refuses(
        |room| {
            room.write("empty.csv", "");
            format!("empty.csv {GOOD_SESSION}")
        },
        &["empty.csv", "the file is empty"],
    );
}

#[test]
fn a_capture_that_is_not_there() {
    convert_refuses(|_| format!("nowhere.c3d {GOOD_SESSION}"), &["nowhere.c3d", "No such file"]);
}

#[test]
fn a_cut_c3d() {
    convert_refuses(
        |room| {
            room.write("cut.c3d", &room.read("gusts.c3d")[..300_000]);
            format!("cut.c3d {GOOD_SESSION}")
        },
        &["cut.c3d", "cut off", "expected 480"],
    );
}

#[test]
fn a_cut_c3d_that_the_user_wants_all_the_same_ends_with_loss() {
    let room = Room::new();
    room.write("cut.c3d", &room.read("gusts.c3d")[..400_000]);
    let run = room.run("convert cut.c3d --session session.json -o out.eff.mcap --allow-cut");
    run.ended(3).says(&["loss", "of 480 frames are there"]);
    room.run("validate out.eff.mcap").ended(0);
    // So does what `inspect` tells of its quality; without a session the file is told as it is, which is all there.
    room.run("inspect cut.c3d --session session.json").ended(1).says(&["cut off"]);
    let run = room.run("inspect cut.c3d --session session.json --allow-cut --json").ended(3);
    let told: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    assert!(told["quality"]["capture"]["n_frames"].as_u64() < Some(480), "{}", run.out);
    run.says(&["loss: the capture is cut off", "of 480 frames are there"]);
    let run = room.run("inspect cut.c3d").ended(0);
    assert!(run.out.contains("warning"), "{}", run.out);
    room.run("inspect gusts.c3d --session session.json --allow-cut").ended(0);
}

#[test]
fn a_csv_with_decimal_commas_between_commas() {
    convert_refuses(
        |room| {
            let csv = "Trajectories\r\n120\r\n,,Wig:LFHD,,\r\nFrame,Sub Frame,X,Y,Z\r\n,,mm,mm,mm\r\n1,0,\"1,5\",\"2,5\",\"3,5\"\r\n";
            room.write("comma.csv", csv);
            format!("comma.csv {GOOD_SESSION}")
        },
        &["comma.csv", "line 6", "1,5"],
    );
}

#[test]
fn a_session_that_names_markers_which_are_not_there() {
    let with = |room: &Room, from: &str, to: &str| {
        let session = String::from_utf8(room.read("session.json")).unwrap().replace(from, to);
        room.write("session.json", session);
        format!("gusts.c3d {GOOD_SESSION}")
    };
    convert_refuses(
        |room| with(room, "\"S", "\"T"),
        &["session.json", "T01_1 (the capture has S01_1)", "and"],
    );
    let room = Room::new();
    let words = with(&room, "S05_3", "S05_33");
    let run = room.run(&format!("inspect --no-clean {words}")).ended(0);
    assert!(run.out.contains("count as never seen: S05_33 (the capture has S05_3)"), "{}", run.out);
}

#[test]
fn a_session_that_is_no_json() {
    convert_refuses(
        |room| {
            room.write("session.json", "{ \"name\": }");
            format!("gusts.c3d {GOOD_SESSION}")
        },
        &["session.json", "line 1", "column 11"],
    );
}

#[test]
fn a_grid_that_is_no_whole_number_of_voxels() {
    convert_ends(2, |_| format!("gusts.c3d {GOOD_SESSION} --voxel-mm 70"), &["600 mm", "70 mm"]);
}

/// Wherever it is, `validate` finds it. A run refuses the field, unless it needs nothing of what is damaged: then it gives
/// what it gave before.
#[test]
fn a_voxel_of_less_than_nothing() {
    convert_ends(
        2,
        |_| format!("gusts.c3d {GOOD_SESSION} --voxel-mm -5"),
        &["the grid is impossible", "found voxel edge = -5 mm, expected a number above 0"],
    );
}

#[test]
fn a_field_with_a_flipped_byte() {
    let room = Room::with_field();
    room.run("simulate f.eff.mcap --groom bob.json -o sound.npz").ended(0);
    let (bytes, sound) = (room.read("f.eff.mcap"), room.read("sound.npz"));
    let before = room.files();
    let mut n_refused = 0;
    for sixteenth in 1..16 {
        let mut bytes = bytes.clone();
        let at = bytes.len() * sixteenth / 16;
        bytes[at] ^= 0x10;
        room.write("f.eff.mcap", bytes);
        let run = room.run("simulate f.eff.mcap --groom bob.json -o m.npz");
        if run.code == Some(0) {
            assert!(room.read("m.npz") == sound, "byte {at}");
            room.remove("m.npz");
        } else {
            run.ended(1).says(&["f.eff.mcap", "found", "expected"]);
            n_refused += 1;
        }
        assert_eq!(room.files(), before);
        let validation = room.run("validate f.eff.mcap").ended(1);
        assert!(validation.out.contains("NOT SOUND"), "{}", validation.out);
    }
    assert!(n_refused > 3, "{n_refused} of 15 refused");
}

#[test]
fn a_groom_with_a_nan() {
    let room = Room::with_field();
    let groom = String::from_utf8(room.read("bob.json")).unwrap().replacen("0.02266", "NaN", 1);
    room.write("nan.json", groom);
    let before = room.files();
    room.run("simulate f.eff.mcap --groom nan.json -o m.npz").ended(1).says(&[
        "nan.json",
        "line",
        "strands[0].rest_curve_m (strand B01): found NaN",
    ]);
    assert_eq!(room.files(), before);
}

/// `ulimit -f` counts kibibytes: the field of the demo is some 27 MB.
#[test]
#[cfg(unix)]
fn a_disk_that_is_full() {
    let room = Room::new();
    let before = room.files();
    let line =
        "ulimit -f 4096; $TOUSLE convert gusts.c3d --method paper --session session.json -o f.eff.mcap";
    room.shell(line).ended(1).says(&["f.eff.mcap", "nothing was written", "File too large"]);
    assert_eq!(room.files(), before);
}

/// A line for what could not be written and one for why.
#[test]
#[cfg(unix)]
fn a_full_disk_is_told_of_in_two_lines() {
    let room = Room::with_field();
    let before = room.files();
    let simulate = "$TOUSLE simulate f.eff.mcap --groom bob.json";
    for (line, file) in [
        (format!("{simulate} -o m.npz"), "m.npz"),
        (format!("{simulate} -o m.usda"), "m.usda"),
        ("$TOUSLE export f.eff.mcap -o f.npz".to_owned(), "f.npz"),
        ("$TOUSLE export f.eff.mcap -o f.vdb".to_owned(), "f.0000.vdb"),
    ] {
        let run = room.shell(&format!("ulimit -f 8; {line}")).ended(1);
        let [what, why] = run.err.lines().collect::<Vec<_>>()[..] else { panic!("{}", run.err) };
        assert_eq!(what, format!("error: cannot write {file} (nothing was written)"));
        assert!(why.starts_with("  because File too large"), "{why}");
    }
    assert_eq!(room.files(), before);
}

/// A sequence of files appears together: of one that fails midway nothing is there, and what was there before is.
#[test]
fn a_sequence_that_fails_leaves_nothing() {
    let room = Room::with_field();
    room.write("f.0002.vdb", "old");
    // A folder with something in it cannot give its name away.
    std::fs::create_dir_all(room.path("f.0050.vdb/full")).unwrap();
    let before = room.files();
    let run = room.run("export f.eff.mcap -o f.vdb").ended(1);
    run.says(&["cannot write f.0050.vdb (nothing was written)"]);
    assert_eq!(room.files(), before);
    assert_eq!(room.read("f.0002.vdb"), b"old");
}

/// One file by two spellings is one file.
#[test]
fn an_output_that_is_named_twice_is_refused() {
    let room = Room::with_field();
    let before = room.files();
    let folder = room.path(".").canonicalize().unwrap();
    for other in ["o.npz".to_owned(), "./o.npz".to_owned(), format!("{}/o.npz", folder.display())] {
        let run = room.run(&format!("simulate f.eff.mcap --groom bob.json -o o.npz -o {other}")).ended(2);
        run.says(&[&format!("output {other}: found it twice")]);
    }
    assert_eq!(room.files(), before);
}

/// Edits that change nothing are warned of: nobody writes them for that.
#[test]
fn edits_that_change_nothing_say_so() {
    let room = Room::with_field();
    let edit = "edit f.eff.mcap --groom bob.json --edits e.toml -o g.eff.mcap";
    room.write("e.toml", "# to do\n");
    room.run(edit)
        .ended(0)
        .says(&["warning: e.toml: found no edits, expected [[edit]], [[wind]] or [[change]]"]);
    let wind = |first: f64, last: f64| {
        let wind = format!("[[wind]]\nname = \"door\"\nfirst_secs = {first}\nlast_secs = {last}\n");
        room.write("e.toml", format!("{wind}center_m = [0.1, 0, 0]\nreach_m = 0.2\nkind = \"calm\"\n"));
        room.run(edit).ended(0)
    };
    for (first, last) in [(60.0, 61.0), (-2.0, -1.0)] {
        let found =
            format!("found {first:.3} to {last:.3} s, expected some of the field's time, 0.000 to 3.967 s");
        wind(first, last).says(&["warning: e.toml: layer \"door\"", &found]);
    }
    let run = wind(1.0, 2.0);
    assert!(run.err.is_empty(), "{}", run.err);
    room.write("e.toml", "[[change]]\nkind = \"mute\"\nedit = \"lift\"\n");
    room.run(edit).ended(1).says(&["found no layer `lift`", "the field, which has no layers"]);
}

#[test]
fn a_full_disk_leaves_the_old_file() {
    let room = Room::new();
    room.write("f.eff.mcap", "old");
    let line =
        "ulimit -f 4096; $TOUSLE convert gusts.c3d --method paper --session session.json -o f.eff.mcap";
    room.shell(line).ended(1);
    assert_eq!(room.read("f.eff.mcap"), b"old");
}

/// A report that cannot be written leaves no field without it.
#[cfg(target_os = "linux")]
#[test]
fn field_and_reports_appear_together() {
    let room = Room::new();
    let before = room.files();
    let convert = "convert gusts.c3d --method paper --session session.json -o f.eff.mcap";
    let run = room.run(&format!("{convert} --report q.json --report /proc/q.json")).ended(1);
    run.says(&["cannot write /proc/q.json (nothing was written)"]);
    assert_eq!(room.files(), before);
}

/// The file says millimeters: whoever says that it does not is believed, and the head tells that this is wrong.
#[test]
fn a_unit_that_is_given_wins() {
    let room = Room::new();
    let inspect = "inspect gusts.c3d --session session.json";
    room.run(&format!("{inspect} --unit cm"))
        .ended(1)
        .says(&["found head markers 10.", "`unit` overrides that"]);
    let run = room.run(&format!("{inspect} --unit mm")).ended(0);
    assert!(!run.out.contains("as given"), "{}", run.out);
}

#[test]
fn wrong_words_are_exit_code_2() {
    let room = Room::new();
    for folder in ["folder.eff.mcap", "folder.json"] {
        std::fs::create_dir(room.path(folder)).unwrap();
    }
    for words in [
        "",
        "fly",
        "convert",
        "convert a.c3d -o",
        "simulate f --groom g -o m.npz --integrator magic",
        "convert a --session s -o o --threads 0",
        "inspect gusts.c3d --unit mm",
        "convert gusts.c3d --session session.json -o f.eff.mcap --reading first-frame",
        "convert gusts.c3d --session session.json -o f.eff.mcap --rate-hz 1e18",
        "convert gusts.c3d --session session.json -o f.eff.mcap --encoding fixed --max-error 0",
        "convert gusts.c3d --session gusts.c3d -o gusts.c3d",
        "convert gusts.c3d --session session.json -o f.eff.mcap --report session.json",
        "convert gusts.c3d --session session.json -o folder.eff.mcap",
        "convert gusts.c3d --session session.json -o f.eff.mcap --report folder.json",
    ] {
        room.run(words).ended(2);
    }
    let room = Room::with_field();
    for words in [
        "--rate-hz 0",
        "--dt-secs -1",
        "--integrator rk4 --dt-secs 0.01",
        "--resume=0",
        "--method physical --integrator exponential",
    ] {
        room.run(&format!("simulate f.eff.mcap --groom bob.json -o m.npz {words}")).ended(2);
    }
    for words in ["recover", "migrate", "merge f.eff.mcap"] {
        room.run(&format!("{words} f.eff.mcap -o f.eff.mcap")).ended(2).says(&["expected another one"]);
    }
}

/// Every command that writes says so before it reads anything: here nothing that it should read is there.
#[test]
fn a_folder_that_is_not_there_is_told_of_before_any_work() {
    let room = Room::new();
    let before = room.files();
    for words in [
        "convert c --session s -o nowhere/f.mcap",
        "convert c --session s -o f.mcap --report nowhere/q.html",
        "inspect c --session s --report nowhere/q.json",
        "simulate f --groom g -o m.npz -o nowhere/m.usda",
        "edit f --groom g --edits e -o nowhere/f.mcap",
        "export f -o nowhere/f.vdb",
        "import w.npz --session s -o nowhere/f.mcap",
        "merge f g -o nowhere/f.mcap",
        "recover f -o nowhere/f.mcap",
        "migrate f -o nowhere/f.mcap",
    ] {
        room.run(words).ended(1).says(&["found no folder nowhere, expected one"]);
    }
    // Those that make their folder make it first.
    room.write("file", "");
    for words in ["demo -o file/d", "bench file f -o file/d", "bench paper --captures c -o file/d"] {
        room.run(words).ended(1).says(&["cannot make the folder file/d"]);
    }
    room.remove("file");
    assert_eq!(room.files(), before);
}

/// What cannot be is named as it was given: by the option, in its unit.
#[test]
fn options_that_cannot_be_are_named_by_their_flags() {
    let room = Room::with_field();
    let before = room.files();
    let simulate = "simulate f.eff.mcap --groom bob.json --method physical -o m.npz";
    for (options, says) in [
        ("--rate-hz 1e9", "--rate-hz: found 1000000000, expected at most 1e7 frames"),
        ("--rate-hz 0", "--rate-hz: found 0, expected a number above 0"),
        ("--duration-secs 1e9", "--duration-secs: found 1000000000, expected at most 1e7 frames"),
        ("--dt-secs 1e-30", "--dt-secs: found 1e-30, expected at most 1e6 steps a frame"),
        ("--rate-hz 1e-9", "--rate-hz: found 1e-9, expected at most 1e6 steps a frame"),
        ("--head h.usda --head-start nan", "--head-start <CODE>': expected a finite number"),
        ("--head h.usda --head-axes z,-z", "expected two axes across one another"),
        ("--groom-up z --groom-forward -z", "found z for up and -z for forward, expected two axes across"),
        (
            "--head-mesh h.obj --mesh-unit m --mesh-up z --mesh-forward z",
            "--mesh-forward: found z, expected an axis across --mesh-up z",
        ),
        (
            "--integrator adaptive --tolerance-mm 1e-5",
            "--tolerance-mm: found 1e-5, expected 1e-7 m (1e-4 mm) or more",
        ),
    ] {
        room.run(&format!("{simulate} {options}")).ended(2).says(&[says]);
    }
    assert_eq!(room.files(), before);
}

/// An option that does nothing is told what it needs, and nothing is done.
#[test]
fn options_that_do_nothing_say_what_they_need() {
    let room = Room::with_field();
    room.write("w.obj", "");
    let before = room.files();
    let simulate = "simulate f.eff.mcap --groom bob.json -o m.npz";
    let convert = "convert gusts.c3d --session session.json -o g.eff.mcap";
    let edit = "edit f.eff.mcap --groom bob.json --edits lift.toml -o g.eff.mcap";
    for (words, needs) in [
        (format!("{simulate} --tolerance-mm 0.1"), "--integrator adaptive"),
        (
            format!("{simulate} --method physical --integrator implicit --tolerance-mm 1"),
            "--integrator adaptive",
        ),
        (format!("{simulate} --shape curves"), "a .usda output"),
        (format!("{simulate} --with-body"), "a .usda output"),
        (format!("{simulate} --mesh-up Z"), "--head-mesh"),
        (format!("{simulate} --mesh-unit mm"), "--torso-mesh"),
        (format!("{simulate} --mesh-forward x"), "--head-mesh"),
        (format!("{simulate} --head-axes Y,Z"), "--head"),
        (format!("{simulate} --head p.npz --head-axes Y,Z"), "a --head in .usda"),
        (format!("{simulate} --head p.npz --head-start 1001"), "a --head in .usda"),
        (format!("{simulate} --guides-check 3"), "--guides"),
        (format!("{simulate} --method physical --integrator adaptive --single"), "--integrator implicit"),
        (format!("{simulate} --method physical --integrator rk4 --single"), "--integrator implicit"),
        (format!("{convert} --span-ms 100"), "--method paper"),
        (format!("{convert} --method paper --refine"), "--method physical"),
        (format!("{convert} --method paper --reading first-frame --span-ms 100"), "another --reading"),
        (format!("{convert} --max-error 0.1"), "found encoding f32, expected fixed"),
        (format!("{edit} --tolerance-mm 2"), "--method physical"),
        ("inspect gusts.c3d --allow-cut".to_owned(), "--session"),
        ("inspect gusts.c3d --groom-up Z".to_owned(), "a groom"),
        ("inspect f.eff.mcap --groom-unit mm".to_owned(), "a groom"),
        ("inspect f.eff.mcap --session session.json".to_owned(), "a capture"),
        (
            "inspect bob.json --unit mm".to_owned(),
            "the file is a groom; its unit and its axes are --groom-unit",
        ),
        ("inspect bob.json --session session.json".to_owned(), "a capture"),
        ("import w.vdb --session session.json -o g.eff.mcap --extent-mm 500".to_owned(), "a .npz file"),
        ("import w.npz --session session.json -o g.eff.mcap --grid vel".to_owned(), ".vdb files"),
        ("import w.npz --session session.json -o g.eff.mcap --rate-hz 30".to_owned(), ".vdb files"),
        ("merge f.eff.mcap f.eff.mcap -o g.eff.mcap --max-error 1".to_owned(), "--encoding"),
        ("bench --part file --quick --captures .".to_owned(), "--part wind"),
        ("bench --part wind --quick".to_owned(), "--captures"),
        ("bench --part sim --field f.eff.mcap".to_owned(), "--part file"),
        ("bench --part file --captures .".to_owned(), "a part beside --part file"),
        ("bench sim --part order --captures .".to_owned(), "--part truth"),
        ("bench sim --part order --torso-grip torso".to_owned(), "--captures"),
        ("bench sim --part truth".to_owned(), "--captures"),
    ] {
        let run = room.run(&words);
        assert_eq!(run.code, Some(2), "{words}: {}{}", run.out, run.err);
        run.says(&[needs]);
    }
    assert_eq!(room.files(), before);
    // The paper's joints have single precision, and a field of theirs asks for them.
    room.run(&format!("{simulate} --duration-secs 0.1 --single")).ended(0);
}

/// A reader that has heard enough is no failure; a disk that takes no words is.
#[test]
#[cfg(target_os = "linux")]
fn a_stdout_that_takes_no_more() {
    let room = Room::with_field();
    let run = room.shell("\"$TOUSLE\" inspect f.eff.mcap --json > /dev/full");
    run.ended(1).says(&["cannot write to the standard output"]);
    let run = room.shell("\"$TOUSLE\" inspect f.eff.mcap --json | true; exit ${PIPESTATUS[0]}").ended(0);
    assert_eq!(run.err, "");
}

/// Where nobody hears what is said on stderr, the work is done as ever and the exit code says how it ended.
#[test]
#[cfg(target_os = "linux")]
fn a_stderr_that_takes_no_more() {
    let room = Room::with_field();
    let lift = String::from_utf8(room.read("lift.toml")).unwrap();
    room.write("far.toml", lift.replace("[0.05, -0.05, 0.08]", "[0, 0, 9]"));
    for (code, words) in [
        (0, "simulate f.eff.mcap --groom bob.json -o m.npz --duration-secs 0.1 --guides 1000"),
        (1, "inspect nowhere"),
        (2, "validate --nothing"),
        (2, "inspect gusts.c3d --report q.json"),
        (3, "edit f.eff.mcap --groom bob.json --edits far.toml -o g.eff.mcap"),
    ] {
        assert!(!room.run(words).ended(code).err.is_empty(), "{words}");
        room.shell(&format!("$TOUSLE {words} 2> /dev/full")).ended(code);
        room.shell(&format!("$TOUSLE {words} 2>&1 | true; exit ${{PIPESTATUS[0]}}")).ended(code);
    }
    assert!(room.path("m.npz").exists() && room.path("g.eff.mcap").exists());
}

#[test]
fn a_capture_in_another_unit() {
    convert_refuses(
        |room| {
            let session = String::from_utf8(room.read("session.json")).unwrap();
            assert!(session.contains("head_markers_mm_in_head_frame"));
            let mut session: serde_json::Value = serde_json::from_str(&session).unwrap();
            for place in session["head_markers_mm_in_head_frame"].as_object_mut().unwrap().values_mut() {
                for coordinate in place.as_array_mut().unwrap() {
                    *coordinate = (coordinate.as_f64().unwrap() * 10.0).into();
                }
            }
            room.write("tenths.json", session.to_string());
            "gusts.c3d --session tenths.json".to_owned()
        },
        &["0.1", "times as far apart", "unit"],
    );
}

#[test]
fn an_output_of_an_unknown_ending_is_refused_before_any_work() {
    let room = Room::new();
    room.run("simulate nowhere.eff.mcap --groom nowhere.json -o motion.fbx")
        .ended(2)
        .says(&["fbx", ".npz or .usda"]);
}
