//! Every C3D file of the shared corpus against what a correct reader must find in it (`expected.json`).
//!
//! Needs the folder of shared data in `TOUSLE_SHARED`; says so and passes without it.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;
use tousle_c3d::{Point, Processor, Reader, Storage, Trial, WriteError, Writer};

#[test]
fn every_file_reads_as_expected() {
    let Some(corpus) = corpus() else { return };
    let expected: Value =
        serde_json::from_slice(&std::fs::read(corpus.join("expected.json")).unwrap()).unwrap();
    let files = expected["files"].as_object().unwrap();
    let mut tally = BTreeMap::new();
    let mut failures = String::new();
    for (name, entry) in files.iter().filter(|(name, _)| name.to_lowercase().ends_with(".c3d")) {
        let bytes = std::fs::read(corpus.join(name)).unwrap();
        match judge(&bytes, entry) {
            Ok(verdict) => {
                println!("{name}: {verdict}");
                *tally.entry(verdict.kind()).or_insert(0) += 1;
            }
            Err(why) => writeln!(failures, "{name}:\n{why}").unwrap(),
        }
    }
    println!("{tally:?}");
    assert!(failures.is_empty(), "{failures}");
    assert_eq!(tally.values().sum::<usize>(), 76);
}

/// Sample by sample beside another reader, on the files that it is known to read rightly.
#[test]
fn coordinates_are_those_of_c3dio() {
    let Some(corpus) = corpus() else { return };
    let expected: Value =
        serde_json::from_slice(&std::fs::read(corpus.join("expected.json")).unwrap()).unwrap();
    let mut n_compared = 0;
    for (name, entry) in expected["files"].as_object().unwrap() {
        if entry["rust_crates"]["c3dio 0.8.0"] != "right" {
            continue;
        }
        let bytes = std::fs::read(corpus.join(name)).unwrap();
        let theirs = c3dio::C3d::load_path(corpus.join(name)).unwrap().points.points;
        let ours = all_frames(&mut Reader::from_bytes(&bytes).unwrap());
        assert!(ours.len() <= theirs.rows() || ours.is_empty() || ours[0].is_empty(), "{name}");
        for (frame, points) in ours.iter().enumerate() {
            for (idx, point) in points.iter().enumerate() {
                let Some(point) = point else { continue };
                let other = theirs[(frame, idx)].point;
                let worst =
                    [0, 1, 2].map(|k| (point.position[k] - other[k]).abs()).into_iter().fold(0.0, f32::max);
                assert!(
                    worst <= 1e-6 * other.iter().fold(0.0, |m: f32, c| m.max(c.abs())),
                    "{name} {frame} {idx}"
                );
                n_compared += 1;
            }
        }
    }
    println!("{n_compared} samples compared");
    assert!(n_compared > 100_000);
}

/// One trial in the encodings of three machines, as integers and as floats, twice.
#[test]
fn six_encodings_of_one_trial_load_equal() {
    let Some(corpus) = corpus() else { return };
    let first =
        ["Eb015pi", "Eb015pr", "Eb015si", "Eb015sr", "Eb015vi", "Eb015vr"].map(|n| format!("c3dorg-01--{n}"));
    let second = ["pc_int", "pc_real", "sgi_int", "sgi_real", "dec_int", "dec_real"]
        .map(|n| format!("c3dorg-02--{n}"));
    // The second trial was rounded anew for each encoding, by those who made the files: a step either way.
    for (names, n_steps) in [(first, 0.0), (second, 1.0)] {
        let trials = names.map(|name| {
            let bytes = std::fs::read(corpus.join(format!("c3d/{name}.c3d"))).unwrap();
            let mut reader = Reader::from_bytes(&bytes).unwrap();
            (reader.info().clone(), all_frames(&mut reader))
        });
        let (reference, reference_frames) = &trials[0];
        for (info, frames) in &trials[1..] {
            assert_eq!((&info.labels, &info.unit), (&reference.labels, &reference.unit));
            assert_eq!((info.rate_hz, info.first_frame), (reference.rate_hz, reference.first_frame));
            assert_eq!(frames.len(), reference_frames.len());
            let worst =
                frames.iter().zip(reference_frames).map(|(a, b)| worst_difference(a, b)).fold(0.0, f32::max);
            println!("{:?} {:?}: {worst} of a step of {}", info.processor, info.storage, info.scale);
            assert!(worst <= n_steps * info.scale * 1.001);
        }
    }
}

fn worst_difference(a: &[Option<Point>], b: &[Option<Point>]) -> f32 {
    let both = a.iter().zip(b).filter_map(|(a, b)| {
        assert_eq!(a.is_some(), b.is_some(), "missing in one, seen in the other");
        (*a).zip(*b)
    });
    both.flat_map(|(a, b)| [0, 1, 2].map(|k| (a.position[k] - b.position[k]).abs())).fold(0.0, f32::max)
}

/// Real trials, written in each encoding and read again: the same points, and no contradiction left.
#[test]
fn what_was_read_is_written_in_every_encoding() {
    let Some(corpus) = corpus() else { return };
    let mut n_written = 0;
    for entry in std::fs::read_dir(corpus.join("c3d")).unwrap() {
        let bytes = std::fs::read(entry.unwrap().path()).unwrap();
        let Ok(mut reader) = Reader::from_bytes(&bytes) else { continue };
        let (trial, frames) = (reader.trial(), all_frames(&mut reader));
        for processor in [Processor::Intel, Processor::Dec, Processor::Mips] {
            let mut trial = Trial { processor, ..trial.clone() };
            let again = write(&trial, &frames).unwrap();
            let mut reader = Reader::from_bytes(&again).unwrap();
            // A NaN among the parameters is equal to nothing, itself included.
            assert_eq!(format!("{:?}", reader.trial()), format!("{trial:?}"));
            assert_eq!(all_frames(&mut reader), frames);
            trial.storage = Storage::Float32;
            let floats = write(&trial, &frames).unwrap();
            assert_eq!(all_frames(&mut Reader::from_bytes(&floats).unwrap()), frames);
            n_written += 2;
        }
    }
    println!("{n_written} files written");
    assert!(n_written >= 6 * 72);
}

fn write(trial: &Trial, frames: &[Vec<Option<Point>>]) -> Result<Vec<u8>, WriteError> {
    let mut writer = Writer::new(Vec::new(), trial)?;
    for frame in frames {
        writer.write_frame(frame)?;
    }
    writer.finish()
}

fn all_frames(reader: &mut Reader<std::io::Cursor<&[u8]>>) -> Vec<Vec<Option<Point>>> {
    let all: Vec<_> = (0..reader.info().n_points).collect();
    let n_frames = reader.info().n_frames;
    let mut frames = Vec::new();
    reader.read_frames(&all, 0..n_frames, |_, points| frames.push(points.to_vec())).unwrap();
    frames
}

fn corpus() -> Option<PathBuf> {
    let Some(shared) = std::env::var_os("TOUSLE_SHARED") else {
        eprintln!("skipped: TOUSLE_SHARED is not set");
        return None;
    };
    Some(PathBuf::from(shared).join("corpus/mocap"))
}

enum Verdict {
    Right(Vec<String>),
    Warned(Vec<String>),
    Refused(String),
}

impl Verdict {
    fn kind(&self) -> &'static str {
        match self {
            Self::Right(_) => "right",
            Self::Warned(_) => "malformed, read with warnings",
            Self::Refused(_) => "malformed, refused",
        }
    }
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Right(warnings) | Self::Warned(warnings) => write!(f, "{} {warnings:#?}", self.kind()),
            Self::Refused(why) => write!(f, "{}: {why}", self.kind()),
        }
    }
}

fn judge(bytes: &[u8], entry: &Value) -> Result<Verdict, String> {
    let must_load = entry["outcome"] == "load";
    let mut reader = match Reader::from_bytes(bytes) {
        Ok(reader) => reader,
        Err(e) if must_load => return Err(format!("refused: {e}")),
        Err(e) => return Ok(Verdict::Refused(e.to_string())),
    };
    let warnings: Vec<_> = reader.warnings().iter().map(ToString::to_string).collect();
    let differences = differences(&mut reader, entry);
    if must_load {
        return if differences.is_empty() { Ok(Verdict::Right(warnings)) } else { Err(differences) };
    }
    if warnings.is_empty() {
        return Err("malformed, but read without a warning".into());
    }
    println!("{differences}");
    Ok(Verdict::Warned(warnings))
}

fn differences(reader: &mut Reader<std::io::Cursor<&[u8]>>, entry: &Value) -> String {
    let expected = &entry["expected"];
    let mut out = String::new();
    let mut same = |what: &str, found: Value, expected: &Value| {
        if found != *expected {
            writeln!(out, "  {what}: found {found}, expected {expected}").unwrap();
        }
    };
    let info = reader.info().clone();
    same("points", info.n_points.into(), &expected["points"]);
    same("frames", info.n_frames.into(), &expected["frames"]);
    same("first frame", info.first_frame.into(), &expected["first_frame"]);
    same("unit", info.unit.clone().into(), &expected["units"]);
    same("label count", info.labels.len().into(), &expected["labels_count"]);
    let digest = Sha256::digest(info.labels.join("\n").as_bytes());
    let hex = digest.iter().fold(String::new(), |hex, b| format!("{hex}{b:02x}"));
    same("labels", hex.into(), &expected["labels_sha256"]);
    same("analog channels", info.analog.n_channels.into(), &expected["analog"]["channels"]);
    let n_samples = info.analog.n_samples_per_frame * info.n_frames;
    if info.analog.n_channels > 0 {
        same("analog samples", n_samples.into(), &expected["analog"]["samples"]);
    }
    if !expected["events"].is_null() {
        same("events", info.events.len().into(), &expected["events"]["count"]);
    }
    if !expected["rotations"].is_null() {
        same("rotations", info.rotations.n_rotations.into(), &expected["rotations"]);
    }
    if !expected["subjects"].is_null() {
        let subjects: Vec<_> = info.subjects.iter().map(|s| s.name.clone()).collect();
        let named = expected["subjects"].as_array().unwrap().iter().filter(|s| **s != "").cloned().collect();
        same("subjects", subjects.into(), &Value::Array(named));
    }
    let file = &entry["file"];
    same("processor", format!("{:?}", info.processor).to_lowercase().into(), &file["processor"]);
    same("storage", format!("{:?}", info.storage).to_lowercase().into(), &file["storage"]);
    let rate = expected["rate"].as_f64().unwrap();
    if !near(info.rate_hz.unwrap_or(f64::NAN), rate, 1e-6) {
        same("rate", info.rate_hz.into(), &expected["rate"]);
    }
    let all: Vec<_> = (0..info.n_points).collect();
    let trajectories = reader.read_trajectories(&all, 0..info.n_frames).unwrap();
    let n_missing = trajectories.iter().flatten().filter(|p| p.is_none()).count();
    if info.n_points > 0 {
        same("missing samples", n_missing.into(), &expected["invalid_samples"]);
    }
    let tolerance = if info.unit.as_deref() == Some("m") { 1e-6 } else { 1e-3 };
    for expected in expected["trajectories"].as_array().into_iter().flatten() {
        let trajectory = &trajectories[expected["index"].as_u64().unwrap() as usize];
        let valid: Vec<_> = trajectory.iter().flatten().collect();
        same("valid samples", valid.len().into(), &expected["valid"]);
        let mean = [0, 1, 2]
            .map(|k| valid.iter().map(|p| f64::from(p.position[k])).sum::<f64>() / valid.len() as f64);
        if !is_position(Some(mean), &expected["mean"], tolerance) {
            same("mean", mean.to_vec().into(), &expected["mean"]);
        }
    }
    for expected in expected["samples"].as_array().into_iter().flatten() {
        let index = |key: &str| expected[key].as_u64().unwrap() as usize;
        let point = trajectories[index("point_index")][index("frame_index")];
        let position = point.map(|p: Point| p.position.map(f64::from));
        if !is_position(position, &expected["xyz"], tolerance) {
            same("sample", position.map(|p| p.to_vec()).into(), &expected["xyz"]);
        }
    }
    out
}

fn is_position(found: Option<[f64; 3]>, expected: &Value, tolerance: f64) -> bool {
    match (found, expected.as_array()) {
        (Some(found), Some(expected)) => {
            found.iter().zip(expected).all(|(a, b)| near(*a, b.as_f64().unwrap(), tolerance))
        }
        (found, None) => found.is_none_or(|f| f[0].is_nan()),
        (None, Some(_)) => false,
    }
}

fn near(found: f64, expected: f64, tolerance: f64) -> bool {
    (found - expected).abs() <= 1e-5 * expected.abs() + tolerance
}
