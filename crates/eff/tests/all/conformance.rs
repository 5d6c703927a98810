//! The conformance set in `fixtures/eff`: good files with what is in them, bad ones with what is wrong.
//!
//! The files of a version are kept for ever; `TOUSLE_UPDATE=1 cargo test -p tousle-eff --test all conformance` adds
//! those that are not there yet and changes none.

use crate::bad;
use crate::good;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use tousle_core::NoProgress;
use tousle_eff::{Eff, ReadOptions, Reader, Severity, VERSION, inspect, migrate, read, recover, validate};

fn folder(kind: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/eff").join(kind)
}

/// Adds a file and its twin, if they are not there and it is wanted.
fn keep(kind: &str, name: &str, bytes: impl FnOnce() -> Vec<u8>, twin: impl FnOnce() -> Value) {
    let path = folder(kind).join(format!("{name}.eff.mcap"));
    if std::env::var_os("TOUSLE_UPDATE").is_some() && !path.exists() {
        fs::create_dir_all(folder(kind)).unwrap();
        fs::write(&path, bytes()).unwrap();
        let mut text = serde_json::to_string_pretty(&twin()).unwrap();
        text.push('\n');
        fs::write(path.with_extension("").with_extension("json"), text).unwrap();
    }
}

fn files(kind: &str) -> BTreeSet<String> {
    let names =
        fs::read_dir(folder(kind)).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names.filter_map(|name| name.strip_suffix(".eff.mcap").map(str::to_owned)).collect()
}

fn load(kind: &str, name: &str) -> (Vec<u8>, Value) {
    let bytes = fs::read(folder(kind).join(format!("{name}.eff.mcap"))).unwrap();
    let twin = fs::read(folder(kind).join(format!("{name}.json"))).unwrap();
    (bytes, serde_json::from_slice(&twin).unwrap())
}

fn codes(bytes: &[u8]) -> Vec<String> {
    validate(bytes).unwrap().findings.into_iter().map(|f| f.code.to_string()).collect()
}

/// A case's name, what makes its file, and its twin.
type Kept<'a> = (&'static str, &'a dyn Fn() -> Vec<u8>, Value);

/// Names of a folder's cases, after those that are missing were added.
fn names(kind: &str, cases: &[Kept<'_>]) -> BTreeSet<String> {
    for (name, make, twin) in cases {
        keep(kind, name, make, || twin.clone());
    }
    let names: BTreeSet<_> = cases.iter().map(|(name, ..)| (*name).to_owned()).collect();
    assert_eq!(names, files(kind), "{kind}");
    names
}

#[test]
fn every_bad_file_gives_the_finding_it_must_give() {
    let mut n = 0;
    let mut wrong = Vec::new();
    for (kind, cases) in [("v1/bad", bad::cases()), ("v0/bad", bad::old::cases())] {
        let cases: Vec<_> = cases
            .iter()
            .map(|c| (c.name, &*c.make as &dyn Fn() -> _, json!({ "what": c.what, "findings": c.findings })))
            .collect();
        for name in names(kind, &cases) {
            n += 1;
            let (bytes, twin) = load(kind, &name);
            let validation = validate(&bytes[..]).unwrap();
            if json!(codes(&bytes)) != twin["findings"] {
                wrong.push(format!("{name}: not {}\n{:#?}", twin["findings"], validation.findings));
            }
            let has_error = validation.findings.iter().any(|f| f.severity == Severity::Error);
            assert_eq!(read(&bytes[..], &ReadOptions::default()).is_err(), has_error, "{name}");
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(n >= 60, "{n}");
}

/// Whatever is wrong with a file, what is saved of it is not.
#[test]
fn what_is_recovered_of_bad_files_is_sound() {
    let mut n = 0;
    for kind in ["v1/bad", "v0/bad"] {
        for name in files(kind) {
            let (bytes, _) = load(kind, &name);
            let mut out = Vec::new();
            if recover(Cursor::new(bytes), &mut out, &NoProgress).is_ok() {
                n += 1;
                let validation = validate(&out[..]).unwrap();
                assert!(validation.is_sound, "{name}: {:#?}", validation.findings);
            }
        }
    }
    assert!(n >= 40, "{n}");
}

#[test]
fn every_good_file_is_sound_and_holds_what_its_twin_says() {
    for (kind, cases) in [("v1/good", good::cases()), ("v0/good", good::old::cases())] {
        let cases: Vec<_> =
            cases.iter().map(|c| (c.name, &*c.make as &dyn Fn() -> _, good::twin(c))).collect();
        for name in names(kind, &cases) {
            let (bytes, twin) = load(kind, &name);
            assert_eq!(json!(codes(&bytes)), twin["findings"], "{name}");
            let eff = read(&bytes[..], &ReadOptions::default()).unwrap();
            assert_holds(&name, &eff, &twin);
        }
    }
}

/// A file of any version becomes one of the newest, with the same content; the newest becomes itself.
#[test]
fn every_good_file_migrates() {
    for (kind, from) in [("v1/good", 1), ("v0/good", 0)] {
        for name in files(kind) {
            let (bytes, _) = load(kind, &name);
            let mut out = Vec::new();
            let migration = migrate(Cursor::new(&bytes), &mut out, &NoProgress).unwrap();
            assert_eq!((migration.from, migration.to), (from, VERSION), "{name}");
            let validation = validate(&out[..]).unwrap();
            assert!(validation.is_sound, "{name} {:?}", validation.findings);
            // Whatever else there is to be said of the old file, what readers skip is in the new one too.
            let mut skipped = codes(&bytes);
            skipped.retain(|code| code == "skipped");
            assert_eq!(codes(&out), skipped, "{name}");
            assert_eq!(migration.is_complete(), name != "extended", "{name} {:?}", migration.losses);
            let old = read(&bytes[..], &ReadOptions::default()).unwrap();
            let new = read(&out[..], &ReadOptions::default()).unwrap();
            assert_eq!(new, old, "{name}");
            let mut again = Vec::new();
            migrate(Cursor::new(&out), &mut again, &NoProgress).unwrap();
            assert_eq!(again, out, "{name}");
        }
    }
}

/// Whoever wrote a file: its steps are found one by one, and a cut one is recovered.
#[test]
fn every_good_file_is_read_in_every_way() {
    for (kind, version) in [("v1/good", 1), ("v0/good", 0)] {
        for name in files(kind) {
            let (bytes, _) = load(kind, &name);
            let eff = read(&bytes[..], &ReadOptions::default()).unwrap();
            let mut reader = Reader::open(Cursor::new(&bytes)).unwrap();
            for (k, step) in (0..).zip(&eff.field.steps) {
                assert_eq!(reader.step(k).unwrap().as_ref(), Some(step), "{name}");
            }
            assert_eq!(reader.poses().unwrap(), eff.scene.poses.poses, "{name}");
            let samples = eff.samples.as_ref().map_or(&[][..], |samples| &samples.steps);
            assert_eq!(reader.samples().unwrap(), samples, "{name}");
            assert_eq!(inspect(&bytes[..]).unwrap().manifest.version, version, "{name}");
            let mut out = Vec::new();
            let cut = &bytes[..bytes.len() - 100];
            let recovery = recover(Cursor::new(cut), &mut out, &NoProgress).unwrap();
            assert_eq!(recovery.n_steps, eff.field.steps.len() as u64, "{name}");
            assert_eq!(read(&out[..], &ReadOptions::default()).unwrap(), eff, "{name}");
        }
    }
}

/// Compares a file's content with its twin, numbers to within the twin's error bound.
fn assert_holds(name: &str, eff: &Eff, twin: &Value) {
    let found = good::content(eff);
    let tolerance = twin["max_error"].as_f64().unwrap() * eff.field.grid.n_voxels() as f64 + 1e-9;
    assert_near(name, &found, &twin["content"], tolerance);
}

fn assert_near(at: &str, found: &Value, expected: &Value, tolerance: f64) {
    match (found, expected) {
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            assert!((a - b).abs() <= tolerance * (1.0 + b.abs()), "{at}: {a} {b}");
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{at}");
            a.iter()
                .zip(b)
                .enumerate()
                .for_each(|(k, (a, b))| assert_near(&format!("{at}[{k}]"), a, b, tolerance));
        }
        (Value::Object(a), Value::Object(b)) => {
            assert!(a.keys().eq(b.keys()), "{at}");
            b.iter().for_each(|(key, b)| assert_near(&format!("{at}.{key}"), &a[key], b, tolerance));
        }
        _ => assert_eq!(found, expected, "{at}"),
    }
}

/// The reader in `docs/examples`, written from the specification, finds in every good file what ours finds.
///
/// It needs a Python with mcap, protobuf, numpy and zstandard: `TOUSLE_PYTHON=path/to/python`.
#[test]
fn an_independent_reader_agrees() {
    let Some(python) = std::env::var_os("TOUSLE_PYTHON") else {
        println!("skipped: TOUSLE_PYTHON is not set");
        return;
    };
    let reader = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/examples/read_eff.py");
    for name in files("v1/good") {
        let path = folder("v1/good").join(format!("{name}.eff.mcap"));
        let out = std::process::Command::new(&python).arg(&reader).arg(path).output().unwrap();
        assert!(out.status.success(), "{name}: {}", String::from_utf8_lossy(&out.stderr));
        let (bytes, _) = load("v1/good", &name);
        let expected = good::content(&read(&bytes[..], &ReadOptions::default()).unwrap());
        assert_near(&name, &serde_json::from_slice(&out.stdout).unwrap(), &expected, 1e-9);
    }
}
