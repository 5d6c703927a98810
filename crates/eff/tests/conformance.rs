//! The conformance set in `fixtures/eff`: good files with what is in them, bad ones with what is wrong.
//!
//! The files of a version are kept for ever; `TOUSLE_UPDATE=1 cargo test -p tousle-eff --test conformance` adds
//! those that are not there yet and changes none.

#![allow(clippy::unwrap_used)]

mod arbitrary;
mod bad;
mod forge;
mod good;

use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use tousle_eff::{Eff, ReadOptions, Severity, read, validate};

fn folder(kind: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/eff/v1").join(kind)
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

#[test]
fn every_bad_file_gives_the_finding_it_must_give() {
    let cases = bad::cases();
    for case in &cases {
        let twin = || json!({ "what": case.what, "findings": case.findings });
        keep("bad", case.name, || (case.make)(), twin);
    }
    let names: BTreeSet<_> = cases.iter().map(|case| case.name.to_owned()).collect();
    assert_eq!(names, files("bad"));
    assert!(names.len() >= 60, "{}", names.len());
    let mut wrong = Vec::new();
    for name in names {
        let (bytes, twin) = load("bad", &name);
        let validation = validate(&bytes[..]).unwrap();
        let found: Vec<_> = validation.findings.iter().map(|f| json!(f.code.name())).collect();
        if Value::Array(found.clone()) != twin["findings"] {
            wrong.push(format!("{name}: {found:?}, not {}\n{:#?}", twin["findings"], validation.findings));
        }
        let has_error = validation.findings.iter().any(|f| f.severity == Severity::Error);
        assert_eq!(read(&bytes[..], &ReadOptions::default()).is_err(), has_error, "{name}");
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_good_file_is_sound_and_holds_what_its_twin_says() {
    let cases = good::cases();
    for case in &cases {
        keep("good", case.name, || (case.make)(), || good::twin(case));
    }
    let names: BTreeSet<_> = cases.iter().map(|case| case.name.to_owned()).collect();
    assert_eq!(names, files("good"));
    for name in names {
        let (bytes, twin) = load("good", &name);
        assert_eq!(json!(codes(&bytes)), twin["findings"], "{name}");
        let eff = read(&bytes[..], &ReadOptions::default()).unwrap();
        assert_holds(&name, &eff, &twin);
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
