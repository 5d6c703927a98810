//! Whatever the bytes: no panic, no hang, and what can be read can be written and read again.
//!
//! The seeds of the fuzz target are read here too; `TOUSLE_UPDATE_SEEDS=1` writes them anew.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

#[path = "support/exercise.rs"]
mod exercise;
mod support;

use exercise::exercise;
use std::path::PathBuf;
use support::{File, float, frames, group, int, ints, points, repointed, text};
use tousle_c3d::{Point, Processor, Storage, Trial, Writer};

#[test]
fn every_seed() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds/c3d");
    let is_update = std::env::var_os("TOUSLE_UPDATE_SEEDS").is_some();
    if is_update {
        std::fs::create_dir_all(&folder).unwrap();
    }
    let seeds = seeds();
    for (name, bytes) in &seeds {
        let path = folder.join(name).with_extension("c3d");
        if is_update {
            std::fs::write(&path, bytes).unwrap();
        }
        assert_eq!(&std::fs::read(&path).unwrap(), bytes, "{} is not what makes it", path.display());
        exercise(bytes);
    }
    // Inputs that once failed are kept beside them, named by what they are.
    for entry in std::fs::read_dir(&folder).unwrap() {
        exercise(&std::fs::read(entry.unwrap().path()).unwrap());
    }
}

#[test]
fn every_seed_cut_anywhere() {
    for (_, bytes) in seeds() {
        // Every place in header and parameters, and some in the data.
        for n_bytes in (0..bytes.len().min(1200)).chain((1200..bytes.len()).step_by(97)) {
            exercise(&bytes[..n_bytes]);
        }
    }
}

#[test]
fn every_seed_with_any_byte_changed() {
    for (_, bytes) in seeds() {
        let is_text = |i: usize| bytes[i].is_ascii_uppercase();
        for i in (0..24).chain(512..bytes.len().min(1100)).filter(|&i| !is_text(i)) {
            for value in [0, 1, 0x7f, 0x80, 0xff] {
                let mut bytes = bytes.clone();
                bytes[i] = value;
                exercise(&bytes);
            }
        }
    }
}

/// Small files, each with something of its own.
fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    let mut seeds = vec![
        ("intel-float", written(Processor::Intel, Storage::Float32)),
        ("intel-int", written(Processor::Intel, Storage::Int16)),
        ("dec-float", written(Processor::Dec, Storage::Float32)),
        ("dec-int", written(Processor::Dec, Storage::Int16)),
        ("mips-float", written(Processor::Mips, Storage::Float32)),
        ("mips-int", written(Processor::Mips, Storage::Int16)),
    ];
    seeds.extend(made());
    seeds
}

/// A trial of a head and a lock, as our writer writes it.
fn written(processor: Processor, storage: Storage) -> Vec<u8> {
    let labels = ["Wig:LFHD", "Wig:S01_1", "*1"].map(str::to_owned).to_vec();
    let unit = Some("mm".to_owned());
    let trial = Trial {
        processor,
        storage,
        scale: 0.5,
        rate_hz: 240.0,
        n_frames: 4,
        unit,
        labels,
        ..Trial::default()
    };
    let mut writer = Writer::new(Vec::new(), &trial).unwrap();
    for frame in 0..4_u8 {
        let at = Point { position: [f32::from(frame), -7.5, 1600.0], residual: 200, cameras: 3 };
        writer.write_frame(&[Some(at), (frame != 2).then_some(at), None]).unwrap();
    }
    writer.finish().unwrap()
}

/// Files with what real ones have and our writer does not write.
fn made() -> Vec<(&'static str, Vec<u8>)> {
    let default = File::default;
    let analog =
        [group(2, "ANALOG"), int(2, "USED", 2), float(2, "RATE", 300.0), text(2, "LABELS", &[2, 2], "FxFy")];
    let words = |n: u32| [n as u16, (n >> 16) as u16];
    let trial = [
        group(5, "TRIAL"),
        ints(5, "ACTUAL_START_FIELD", &[2], &words(1)),
        ints(5, "ACTUAL_END_FIELD", &[2], &words(70_000)),
    ];
    let events = [
        group(4, "EVENT"),
        int(4, "USED", 1),
        text(4, "LABELS", &[6, 1], "Strike"),
        text(4, "CONTEXTS", &[4, 1], "Left"),
    ];
    let kinds = [
        text(1, "LABELS2", &[6, 2], "LHip  GRF   "),
        text(1, "ANGLES", &[4, 1], "LHip"),
        text(1, "TYPE_GROUPS", &[6, 2, 2], "ANGLESAnglesGROUNDGround"),
        text(1, "GROUND", &[3, 1], "GRF"),
    ];
    let subjects = [group(3, "SUBJECTS"), int(3, "USED", 1), text(3, "NAMES", &[3, 2], "WigBob")];
    let rotations =
        [group(6, "ROTATION"), int(6, "USED", 1), int(6, "DATA_START", 4), text(6, "LABELS", &[4], "Head")];
    let missing: Vec<u8> = [65535.0, -1.0, 684.0, 1.7e38]
        .iter()
        .flat_map(|&w| points(&[[f32::NAN, 0.0, 1.0, w], [1.0, 2.0, 3.0, w]]))
        .collect();
    let bad_pointer =
        [group(1, "POINT"), repointed(text(1, "UNITS", &[2], "mm"), 400), text(1, "LABELS", &[1, 1], "A")];
    let orphans = [text(7, "USED", &[1], "x"), text(1, "LABELS", &[1, 1], "A"), group(1, "POINT")];
    let contradictory = [
        int(1, "USED", 2),
        int(1, "FRAMES", 9),
        int(1, "DATA_START", 7),
        float(1, "SCALE", 0.1),
        float(1, "RATE", 59.94),
    ];
    vec![
        (
            "analog",
            File { analog_words: 6, analog_samples: 3, data: frames(2, 1, 6), last_frame: 2, ..default() }
                .with(&analog)
                .bytes(),
        ),
        (
            "contradictory",
            File { data: frames(9, 2, 0), last_frame: 8, ..default() }.with(&contradictory).bytes(),
        ),
        ("events", default().with(&events).bytes()),
        (
            "kinds",
            File { n_points: 3, data: frames(2, 3, 0), last_frame: 2, ..default() }.with(&kinds).bytes(),
        ),
        ("leading-zeros", [vec![0; 5], default().bytes()].concat()),
        ("long", File { last_frame: 65535, data: frames(40, 1, 0), ..default() }.with(&trial).bytes()),
        ("missing", File { n_points: 2, last_frame: 4, data: missing, ..default() }.bytes()),
        ("no-parameters", File { records: vec![], ..default() }.bytes()),
        ("orphans", File { records: orphans.concat(), ..default() }.bytes()),
        ("pointer", File { records: bad_pointer.concat(), ..default() }.bytes()),
        ("rotations", default().with(&rotations).bytes()),
        ("subjects", default().with(&subjects).bytes()),
        ("unknown-processor", File { processor: 1, ..default() }.bytes()),
    ]
}
