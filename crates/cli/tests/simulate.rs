//! `tousle simulate`: guides, a shot's own head, several outputs.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::Room;

#[test]
fn strands_follow_guides_and_the_report_says_how_well() {
    let room = Room::with_field();
    let simulate = "simulate f.eff.mcap --groom bob.json --duration-secs 2";
    let run = room.run(&format!("{simulate} -o g.npz --guides 15 --json")).ended(0);
    let report: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    let guides = &report["guides"];
    assert_eq!((guides["n_guides"].as_u64(), guides["n_following"].as_u64()), (Some(15), Some(45)));
    let error = &guides["error"];
    assert_eq!(error["n_strands"], 45, "a small groom is looked at as a whole");
    let [mean, p95] = ["mean_mm", "p95_mm"].map(|key| error[key].as_f64().unwrap());
    assert!(0.0 < mean && mean < p95 && p95 < 100.0, "{error}");
    assert!(report["integrator"].is_string(), "the simulator's report is there too");
    // As many points as all strands have, and the same whoever looks.
    room.run(&format!("{simulate} -o all.npz")).ended(0);
    let motion = |file: &str| tousle_export::read_motion_npz(&room.read(file)).unwrap();
    let (followed, all) = (motion("g.npz"), motion("all.npz"));
    assert_eq!((&followed.counts, &followed.times_secs), (&all.counts, &all.times_secs));
    assert_eq!(followed.frame(0), all.frame(0), "the rest curves");
    let run = room.run(&format!("{simulate} -o h.npz --guides 15 --guides-check 0 --threads 1")).ended(0);
    assert!(run.out.contains("15 guides simulated, 45 strands follow"), "{}", run.out);
    assert!(room.read("g.npz") == room.read("h.npz"));
    // More guides than strands: all are simulated.
    room.run(&format!("{simulate} -o n.npz --guides 1000")).ended(0);
    assert!(room.read("n.npz") == room.read("all.npz"));
    room.run(&format!("{simulate} -o x.npz --guides 0")).ended(2);
}

#[test]
fn a_short_run_reads_no_more_of_the_field_than_it_needs() {
    let room = Room::with_field();
    let motion = |file: &str| tousle_export::read_motion_npz(&room.read(file)).unwrap().positions_m;
    room.run("simulate f.eff.mcap --groom bob.json -o whole.npz").ended(0);
    let whole = motion("whole.npz");
    // What lies behind the first second is lost, and nobody who stops before it notices.
    let file = std::fs::File::open(room.path("f.eff.mcap")).unwrap();
    let n_steps = tousle_eff::Reader::open(file).unwrap().n_steps();
    let mut bytes = room.read("f.eff.mcap");
    let n = bytes.len();
    bytes[n * 6 / 10..n * 9 / 10].iter_mut().step_by(100).for_each(|byte| *byte ^= 0x10);
    room.write("bad.eff.mcap", bytes);
    for time in ["once", "loop", "hold"] {
        let simulate = format!("simulate bad.eff.mcap --groom bob.json --time {time} --explain -o s.npz");
        let run = room.run(&format!("{simulate} --duration-secs 1")).ended(0);
        assert!(run.out.contains(&format!("32 of {n_steps} steps are read")), "{}", run.out);
        let short = motion("s.npz");
        assert!(short[..] == whole[..short.len()], "{time}");
        room.run(&simulate).ended(1).says(&["bad.eff.mcap"]);
    }
}

#[test]
fn a_shots_head_comes_as_usd() {
    let room = Room::with_field();
    let head = "#usda 1.0\n(upAxis = \"Y\" metersPerUnit = 0.01 timeCodesPerSecond = 24 startTimeCode = 1001)\n\
        def Xform \"World\" { def Xform \"Head\" {\n\
        double3 xformOp:translate.timeSamples = { 1001: (0, 160, 0), 1013: (20, 160, 0), 1025: (0, 160, 0) }\n\
        float3 xformOp:rotateXYZ.timeSamples = { 1001: (0, 0, 0), 1013: (0, 60, 0), 1025: (0, 0, 0) }\n\
        uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:rotateXYZ\"] } }\n";
    room.write("shot.usda", head);
    let simulate = "simulate f.eff.mcap --groom bob.json --duration-secs 1.5";
    let run = room.run(&format!("{simulate} -o a.npz --head shot.usda --explain")).ended(0);
    assert!(run.out.contains("time code 1001 of /World/Head"), "{}", run.out);
    room.run(&format!("{simulate} -o b.npz --head shot.usda:/World/Head --head-axes Y,Z --head-start 1001"))
        .ended(0);
    assert!(room.read("a.npz") == room.read("b.npz"), "the defaults by name");
    room.run(&format!("{simulate} -o c.npz")).ended(0);
    assert!(room.read("a.npz") != room.read("c.npz"), "the head moves the hair");
    let run = room.run(&format!("{simulate} -o d.npz --head shot.usda:/World/Hat")).ended(1);
    assert!(run.err.contains("/World/Hat: found no such prim"), "{}", run.err);
    room.run(&format!("{simulate} -o d.npz --head shot.usda --head-axes Y")).ended(2);
}

#[test]
fn several_outputs_appear_together_or_not_at_all() {
    let room = Room::with_field();
    let simulate = "simulate f.eff.mcap --groom bob.json --duration-secs 0.1";
    let before = room.files();
    room.run(&format!("{simulate} -o a.npz -o nowhere/b.usda")).ended(1);
    assert_eq!(room.files(), before);
    room.run(&format!("{simulate} -o a.npz -o a.npz")).ended(2);
    assert_eq!(room.files(), before);
    room.run(&format!("{simulate} -o a.npz -o b.usda")).ended(0);
    assert_eq!(room.files().len(), before.len() + 2);
}

#[test]
fn a_run_that_was_killed_goes_on_to_the_same_bytes() {
    let room = Room::with_field();
    let simulate = "simulate f.eff.mcap --groom bob.json --duration-secs 2 --dt-secs 2e-4 --guides 40";
    room.run(&format!("{simulate} -o whole.npz")).ended(0);
    let resumed = format!("{simulate} -o out.npz --resume=8");
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_tousle"))
        .args(resumed.split_whitespace())
        .current_dir(room.path("."))
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let folder = room.path(".out.npz.resume");
    let n_parts = || std::fs::read_dir(&folder).map_or(0, |entries| entries.count().saturating_sub(1));
    while n_parts() < 2 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(n_parts() >= 2 && !room.path("out.npz").exists(), "killed in time");

    let other = room.run(&format!("{resumed} --rate-hz 30")).ended(1);
    other.says(&["parts of another run in", "(other options)", "remove that folder or name another output"]);
    std::fs::write(folder.join("simulate-000001.part"), "x").unwrap();
    room.run(&resumed).ended(1).says(&["simulate-000001.part", "expected a part; remove it"]);
    std::fs::remove_file(folder.join("simulate-000001.part")).unwrap();
    room.run(&resumed).ended(0);
    assert!(room.read("out.npz") == room.read("whole.npz"));
    assert!(!folder.exists(), "what was kept is gone");
}

/// The corners and faces of an ellipsoid about the origin, mm, z up, as an OBJ file.
fn ellipsoid_obj([a, b, c]: [f64; 3]) -> String {
    use std::fmt::Write;
    const AROUND: usize = 96;
    const DOWN: usize = 64;
    let mut text = String::new();
    for k in 0..=DOWN {
        for j in 0..AROUND {
            let (polar, azimuth) = (
                k as f64 / DOWN as f64 * std::f64::consts::PI,
                j as f64 / AROUND as f64 * std::f64::consts::TAU,
            );
            let (sin, cos) = libm::sincos(polar);
            let (y, x) = libm::sincos(azimuth);
            // Rounded, so that all corners at a pole are one.
            writeln!(text, "v {:.6} {:.6} {:.6}", a * sin * x, b * sin * y, c * cos).unwrap();
        }
    }
    for k in 0..DOWN {
        for j in 0..AROUND {
            let [p, q] = [j, (j + 1) % AROUND].map(|j| k * AROUND + j + 1);
            // At the poles one side has no length.
            if k > 0 {
                writeln!(text, "f {p} {} {q}", p + AROUND).unwrap();
            }
            if k + 1 < DOWN {
                writeln!(text, "f {q} {} {}", p + AROUND, q + AROUND).unwrap();
            }
        }
    }
    text
}

/// A mesh in the head's own shape moves hair as the head does, though the two are measured in different ways.
#[test]
fn a_shots_body_comes_as_a_mesh() {
    let room = Room::with_field();
    room.write("head.obj", ellipsoid_obj([95.0, 75.0, 100.0]));
    let simulate = "simulate f.eff.mcap --groom bob.json --method physical --duration-secs 2";
    let mesh = "--head-mesh head.obj --mesh-unit mm --mesh-up Z";
    let run = room.run(&format!("{simulate} -o mesh.npz -o mesh.usda --with-body {mesh} --explain")).ended(0);
    assert!(run.out.contains("body: head = head.obj: 12096 triangles, measured every 4.0 mm"), "{}", run.out);
    assert!(run.err.is_empty(), "{}", run.err);
    room.run(&format!("{simulate} -o own.npz")).ended(0);
    let motion = |file: &str| tousle_export::read_motion_npz(&room.read(file)).unwrap();
    let (mesh_m, own_m) = (motion("mesh.npz").positions_m, motion("own.npz").positions_m);
    let off = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f32::max);
    let mut offs: Vec<f32> = mesh_m.iter().zip(&own_m).map(off).collect();
    offs.sort_by(f32::total_cmp);
    // The mesh takes the neck away too, which a few locks lie on.
    assert!(offs[offs.len() / 2] < 1e-4, "median {}", offs[offs.len() / 2]);
    assert!(String::from_utf8(room.read("mesh.usda")).unwrap().contains("def Mesh \"head_0\""));
    for (arguments, code, says) in [
        ("--head-mesh head.obj", 2, "--mesh-unit"),
        ("--head-mesh none.obj --mesh-unit mm --mesh-up Z", 1, "cannot read none.obj"),
        ("--torso-mesh bob.json --mesh-unit mm --mesh-up Z", 1, ".obj"),
        ("--head-mesh head.obj --mesh-unit mm --mesh-up Z --mesh-forward Z", 2, "an axis across --mesh-up"),
        ("--head-mesh head.obj --mesh-unit m --mesh-up Z", 1, "200.000 m across"),
        ("--head-mesh head.obj --mesh-unit m --mesh-up Z", 1, "positions were read with --mesh-unit m"),
    ] {
        let run = room.run(&format!("{simulate} -o x.npz {arguments}")).ended(code);
        run.says(&[says]);
        assert!(!room.path("x.npz").exists(), "{arguments}");
    }
    // Too small, and out of reach: both may be meant, so both run.
    room.write("far.obj", "v 0 0 -5\nv 1 0 -5\nv 0 1 -5\nv 0 0 -4\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    room.write("tiny.obj", ellipsoid_obj([0.095, 0.075, 0.1]));
    for (arguments, says) in [
        ("--head-mesh tiny.obj --mesh-unit mm --mesh-up Z", "0.0002 m across and the nearest root"),
        ("--torso-mesh far.obj --mesh-unit m --mesh-up Z", "1.0000 m across and none of its surface"),
    ] {
        room.run(&format!("{simulate} -o x.npz {arguments}")).ended(0).says(&[
            "warning: ",
            says,
            "--mesh-unit",
        ]);
    }
}

/// Rates that are no whole numbers reach USD to the bit, also with a single frame.
#[test]
fn time_codes_are_as_many_as_were_asked_for() {
    let room = Room::with_field();
    for secs in [1.5, 0.0] {
        for rate in [24000.0 / 1001.0, 30000.0 / 1001.0, 60.0] {
            let simulate = "simulate f.eff.mcap --groom bob.json -o m.usda";
            room.run(&format!("{simulate} --duration-secs {secs} --rate-hz {rate}")).ended(0);
            let text = String::from_utf8(room.read("m.usda")).unwrap();
            assert!(text.contains(&format!("timeCodesPerSecond = {rate}\n")), "{secs} s: {}", &text[..400]);
        }
    }
}

/// A strand of one point is left out, and what is written says which strands are left.
#[test]
fn strands_that_are_left_out_are_named_and_the_others_keep_their_numbers() {
    let room = Room::with_field();
    let mut groom: serde_json::Value = serde_json::from_slice(&room.read("bob.json")).unwrap();
    groom["strands"][2]["rest_curve_m"].as_array_mut().unwrap().truncate(1);
    groom["strands"].as_array_mut().unwrap().truncate(5);
    room.write("short.json", groom.to_string());
    let simulate = "simulate f.eff.mcap --duration-secs 0.1";
    room.run(&format!("{simulate} --groom short.json -o short.npz"))
        .ended(0)
        .says(&["1 of 5 strands", "left out: 3 (those after it come 1 earlier"]);
    let numbers = |file: &str| tousle_export::read_numbers_npz(&room.read(file), "strand", &[0]).unwrap();
    assert_eq!(numbers("short.npz"), [0.0, 1.0, 3.0, 4.0]);
    room.run(&format!("{simulate} --groom bob.json -o all.npz")).ended(0);
    assert_eq!(numbers("all.npz"), (0..60).map(f64::from).collect::<Vec<_>>());
}

/// Whoever picks an integrator that does not stand long steps learns what that costs before the run.
#[test]
fn a_run_of_very_many_steps_is_warned_of() {
    let room = Room::with_field();
    let simulate = "simulate f.eff.mcap --groom bob.json --method physical --duration-secs 0.05 -o m.npz";
    let run = room.run(&format!("{simulate} --integrator semi-implicit --json")).ended(0).says(&[
        "warning: semi-implicit takes ",
        "steps a second",
        "in all, as it stands none longer than",
        "set by strand B",
        "--integrator implicit stands every step",
    ]);
    let report: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    let dt_secs = report["dt_secs"].as_f64().unwrap();
    let n_steps = report["n_steps"].as_u64().unwrap() / 60;
    for told in [format!("{:.0} steps a second", 1.0 / dt_secs), format!("{n_steps} in all")] {
        assert!(run.err.contains(&told), "{told}: {}", run.err);
    }
    // Who names the step knows; who has no limit, or one that is near, need not.
    let shorter = format!("{simulate} --integrator semi-implicit --dt-secs {}", dt_secs / 2.0);
    assert_eq!(room.run(&shorter).ended(0).err, "");
    assert_eq!(room.run(simulate).ended(0).err, "");
    let paper = "simulate f.eff.mcap --groom bob.json --method paper --duration-secs 0.05 -o m.npz";
    assert_eq!(room.run(&format!("{paper} --integrator semi-implicit")).ended(0).err, "");
}

/// Up may be an axis that points down; a minus sign makes no option of it.
#[test]
fn an_axis_may_point_down() {
    let room = Room::with_field();
    // A groom in the file's axes: y points down, the nose along x, so z points to the left.
    let curves = |flip: bool| {
        let point = |[x, y, z]: [f64; 3]| {
            if flip { format!("({x}, {}, {y})", -z) } else { format!("({x}, {y}, {z})") }
        };
        let points: Vec<String> = (0..5).map(|k| point([0.0, 0.1, 0.05 - 0.03 * f64::from(k)])).collect();
        format!(
            "#usda 1.0\n(upAxis = \"Z\" metersPerUnit = 1)\ndef BasisCurves \"hair\" {{\nuniform token type = \"linear\"\n\
             int[] curveVertexCounts = [5]\npoint3f[] points = [{}]\n}}\n",
            points.join(", ")
        )
    };
    room.write("down.usda", curves(true));
    room.write("up.usda", curves(false));
    let simulate = "simulate f.eff.mcap --duration-secs 0.1";
    room.run(&format!("{simulate} --groom up.usda -o up.npz")).ended(0);
    for (k, up) in ["--groom-up -y", "--groom-up=-y", "--groom-up -Y"].iter().enumerate() {
        let run = format!("{simulate} --groom down.usda {up} --groom-forward x -o {k}.npz");
        room.run(&run).ended(0).says(&["the file's up axis is z; the given -y holds"]);
        assert!(room.read(&format!("{k}.npz")) == room.read("up.npz"), "{up}");
    }
    room.run("inspect down.usda --groom-up -y").ended(0);
    room.run(&format!("{simulate} --groom up.usda --groom-up -w -o w.npz"))
        .ended(2)
        .says(&["x, y, z, -x, -y or -z"]);
    room.write("head.obj", ellipsoid_obj([95.0, 75.0, 100.0]));
    let mesh = "--head-mesh head.obj --mesh-unit mm --mesh-up -z";
    room.run(&format!("{simulate} --groom up.usda {mesh} -o mesh.npz")).ended(0);
}
