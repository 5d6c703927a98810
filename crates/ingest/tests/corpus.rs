//! Every file of the shared corpus, held against what independent readers found in it.

use serde_json::Value;
use std::path::PathBuf;
use tousle_core::{LengthUnit, Trajectory, Vec3};
use tousle_ingest::{CaptureSummary, IngestOptions, TrajectorySummary, read_capture, summarize};

/// What a file of the corpus must give.
struct Case {
    name: String,
    outcome: String,
    /// Counts, labels and means, the same keys for all kinds of files.
    expected: Value,
}

fn cases() -> Option<(PathBuf, Vec<Case>)> {
    let Some(shared) = std::env::var_os("TOUSLE_SHARED") else {
        println!("skipped: TOUSLE_SHARED is not set");
        return None;
    };
    let folder = PathBuf::from(shared).join("corpus/mocap");
    let text = std::fs::read(folder.join("expected.json")).expect("the corpus is there");
    let all: Value = serde_json::from_slice(&text).expect("expected.json is JSON");
    let case = |(name, file): (&String, &Value)| Case {
        name: name.clone(),
        outcome: file["outcome"].as_str().unwrap_or_default().to_owned(),
        expected: same_keys(&file["expected"]),
    };
    Some((folder, all["files"].as_object().expect("it lists files").iter().map(case).collect()))
}

/// Each kind of file has keys of its own for the same things.
fn same_keys(expected: &Value) -> Value {
    let mut one = match expected["sections"].as_array() {
        Some(sections) => sections[0].clone(),
        None => expected.clone(),
    };
    if one.is_null() {
        return one;
    }
    for (to, from) in [
        ("frames", "frames_in_body"),
        ("frames", "rows"),
        ("points", "markers"),
        ("points", "position_triples"),
        ("labels_first3", "names_first3"),
        ("labels_last3", "names_last3"),
    ] {
        if one[to].is_null() {
            one[to] = one[from].clone();
        }
    }
    // A list of the units of all columns.
    if let Some(units) = one["units"].as_array() {
        one["units"] = if one["points"].is_null() { Value::Null } else { units[0].clone() };
    }
    one
}

#[test]
fn every_file_gives_what_independent_readers_found() {
    let Some((folder, cases)) = cases() else { return };
    let mut wrong = Vec::new();
    for case in &cases {
        let bytes = std::fs::read(folder.join(&case.name)).unwrap();
        let outcome = match (summarize(&bytes), case.outcome.as_str()) {
            (Ok(summary), "load" | "load_or_clear_error") => compare(&summary, &case.expected),
            (Ok(summary), "error_or_warning") if !summary.warnings.is_empty() => Ok(()),
            (Ok(_), _) => Err("was read without a word".into()),
            (Err(error), "load") => Err(format!("{error}: {:?}", std::error::Error::source(&error))),
            (Err(_), _) => Ok(()),
        };
        if let Err(what) = outcome {
            wrong.push(format!("{}: {what}", case.name));
        }
    }
    println!("{} of {} files are right", cases.len() - wrong.len(), cases.len());
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

fn compare(summary: &CaptureSummary, expected: &Value) -> Result<(), String> {
    let same = |what: &str, found: Value| match &expected[what] {
        Value::Null if what != "units" && what != "rate" => Ok(()),
        wanted if number_or_same(&found, wanted) => Ok(()),
        wanted => Err(format!("{what} is {found}, expected {wanted}")),
    };
    same("frames", summary.frames.into())?;
    same("points", summary.trajectories.len().into())?;
    same("rate", summary.rate_hz.into())?;
    same("units", summary.unit.clone().into())?;
    same("first_frame", summary.first_frame.into())?;
    same("invalid_samples", summary.invalid_samples.into())?;
    let labels = &summary.labels;
    same("labels_first3", labels[..labels.len().min(3)].to_vec().into())?;
    same("labels_last3", labels[labels.len().saturating_sub(3)..].to_vec().into())?;
    for wanted in expected["trajectories"].as_array().into_iter().flatten() {
        compare_trajectory(summary, wanted)?;
    }
    Ok(())
}

fn number_or_same(found: &Value, wanted: &Value) -> bool {
    match (found.as_f64(), wanted.as_f64()) {
        (Some(found), Some(wanted)) => (found - wanted).abs() <= 1e-6 * wanted.abs(),
        _ => found == wanted,
    }
}

fn compare_trajectory(summary: &CaptureSummary, wanted: &Value) -> Result<(), String> {
    let idx = wanted["index"].as_u64().expect("an index") as usize;
    let found = &summary.trajectories[idx];
    if wanted["label"].as_str().unwrap_or_default() != found.label {
        return Err(format!("trajectory {idx} is {:?}, expected {}", found.label, wanted["label"]));
    }
    if wanted["valid"] != found.valid {
        return Err(format!("{}: {} valid, expected {}", found.label, found.valid, wanted["valid"]));
    }
    let absolute = if summary.unit.as_deref().is_some_and(|u| u.starts_with(['m', 'M']) && u != "mm") {
        1e-6
    } else {
        1e-3
    };
    for (axis, mean) in wanted["mean"].as_array().into_iter().flatten().enumerate() {
        let found = found.mean.ok_or("no mean")?[axis];
        let mean = mean.as_f64().ok_or("no number expected")?;
        if (found - mean).abs() > absolute + 1e-5 * mean.abs() {
            return Err(format!("trajectory {idx}: mean {found}, expected {mean}"));
        }
    }
    Ok(())
}

/// What a summary tells and what a capture holds are the same samples: counted through both doors.
#[test]
fn summaries_and_captures_agree() {
    let Some((folder, cases)) = cases() else { return };
    let options = IngestOptions {
        unit: Some(LengthUnit::Millimeter),
        rate_hz: Some(100.0),
        keep_exact_zeros: true,
        ..IngestOptions::default()
    };
    let (mut n_compared, mut refused) = (0, Vec::new());
    for case in &cases {
        let bytes = std::fs::read(folder.join(&case.name)).expect("the file is there");
        let Ok(summary) = summarize(&bytes) else { continue };
        let capture = match read_capture(&bytes, &options) {
            Ok(ingested) => ingested.capture,
            Err(error) => {
                refused.push(format!("{}: {error}", case.name));
                continue;
            }
        };
        let unit = capture.file_unit.unwrap_or(LengthUnit::Millimeter).meters();
        let same = |t: &&TrajectorySummary, m: &Trajectory| {
            t.label.trim().ends_with(&m.label) && t.valid == m.track.n_valid()
        };
        for marker in capture.trajectories.iter().filter(|m| !m.is_unlabeled()) {
            let found: Vec<_> = summary.trajectories.iter().filter(|t| same(t, marker)).collect();
            let Some(mean) = marker.track.mean() else { continue };
            let is_mean =
                |t: &&TrajectorySummary| t.mean.is_some_and(|m| (Vec3::from(m) * unit - mean).amax() < 1e-9);
            assert!(found.iter().any(is_mean), "{}: {}", case.name, marker.label);
            n_compared += 1;
        }
    }
    println!("{n_compared} markers agree; refused:\n{}", refused.join("\n"));
    assert!(n_compared > 2000, "{n_compared}");
}
