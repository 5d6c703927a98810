//! A writer that is killed, at a hundred moments: the old file is there or the new one, never a part of one.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::Room;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const N_MOMENTS: u32 = 100;

#[test]
fn a_killed_writer_leaves_the_old_file_or_the_new_one() {
    let room = Room::new();
    room.run("convert gusts.c3d --method paper --session session.json -o f.eff.mcap --voxel-mm 40").ended(0);
    room.run("migrate f.eff.mcap -o new.eff.mcap").ended(0);
    let new = room.read("new.eff.mcap");
    let old = b"what was here before".to_vec();

    let start = Instant::now();
    assert!(writer(&room).wait().unwrap().success());
    let whole = start.elapsed();
    let (mut n_old, mut n_new) = (0, 0);
    for moment in 0..N_MOMENTS {
        let has_old = moment % 2 == 0;
        let _ = std::fs::remove_file(room.path("out.eff.mcap"));
        if has_old {
            room.write("out.eff.mcap", &old);
        }
        let mut child = writer(&room);
        // A little beyond the end, so that some are done.
        std::thread::sleep(whole * moment * 12 / (10 * N_MOMENTS));
        kill(&mut child, ["-KILL", "-TERM", "-INT"][moment as usize % 3]);
        match std::fs::read(room.path("out.eff.mcap")) {
            Ok(bytes) if bytes == new => n_new += 1,
            Ok(bytes) => {
                assert!(has_old && bytes == old, "moment {moment}: {} bytes of neither", bytes.len());
                n_old += 1;
            }
            Err(_) => {
                assert!(!has_old, "moment {moment}: the old file is gone");
                n_old += 1;
            }
        }
    }
    println!("{n_old} left what was there, {n_new} the new file");
    assert!(n_old > 0, "no writer was killed in time");
    // What a killed writer leaves behind is hidden, and named for what it is.
    let known =
        ["bob.json", "f.eff.mcap", "gusts.c3d", "lift.toml", "new.eff.mcap", "out.eff.mcap", "session.json"];
    for file in room.files().iter().filter(|file| !known.contains(&file.as_str())) {
        assert!(file.starts_with(".out.eff.mcap.") && file.ends_with(".partial"), "{file}");
    }
    // The next writer of that name takes it away.
    room.run("migrate f.eff.mcap -o out.eff.mcap").ended(0);
    assert_eq!(room.files(), known);
}

fn writer(room: &Room) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tousle"));
    command.args(["migrate", "f.eff.mcap", "-o", "out.eff.mcap"]).current_dir(room.path("."));
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

/// Sends a signal and waits for the end, which may have come before.
fn kill(child: &mut Child, signal: &str) {
    if signal == "-KILL" {
        child.kill().unwrap();
    } else {
        let sent =
            Command::new("kill").args([signal, &child.id().to_string()]).stderr(Stdio::null()).status();
        sent.unwrap();
    }
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        assert!(start.elapsed() < Duration::from_secs(60), "{signal} did not end it");
        std::thread::sleep(Duration::from_millis(1));
    }
}
