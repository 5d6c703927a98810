//! The public door: sessions that do not fit their capture, and those that nearly do.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use serde_json::{Value, json};
use tousle_pipeline::{ConvertError, Input, PrepareOptions, Prepared, Silent, prepare};

const CAPTURE: &[u8] = include_bytes!("../../../fixtures/demo/gusts.c3d");
const SESSION: &[u8] = include_bytes!("../../../fixtures/demo/session.json");

/// The demo's capture as the file has it, with a session that was changed.
fn prepared(change: impl Fn(&mut Value)) -> Result<Prepared, ConvertError> {
    prepared_by(&PrepareOptions { clean: None, ..PrepareOptions::default() }, change)
}

fn prepared_by(options: &PrepareOptions, change: impl Fn(&mut Value)) -> Result<Prepared, ConvertError> {
    let mut session: Value = serde_json::from_slice(SESSION).unwrap();
    change(&mut session);
    let session = serde_json::to_vec(&session).unwrap();
    let input = |bytes| Input { name: "demo", bytes };
    prepare(input(CAPTURE), input(&session), options, &Silent)
}

fn warnings(change: impl Fn(&mut Value)) -> Vec<String> {
    prepared(change).unwrap().quality.ingest.warnings
}

fn error(change: impl Fn(&mut Value)) -> String {
    prepared(change).unwrap_err().to_string()
}

fn each_lock(session: &mut Value, change: impl Fn(&mut Value)) {
    session["strands"].as_array_mut().unwrap().iter_mut().for_each(change);
}

fn times(value: &mut Value, factor: f64) {
    match value {
        Value::Array(values) => values.iter_mut().for_each(|v| times(v, factor)),
        value => *value = json!(value.as_f64().unwrap() * factor),
    }
}

fn forget_distances(lock: &mut Value) {
    lock.as_object_mut().unwrap().remove("marker_distance_from_root_mm");
}

#[test]
fn the_demo_fits_its_session() {
    assert_eq!(warnings(|_| ()), [""; 0]);
    assert_eq!(warnings(|session| each_lock(session, forget_distances)), [""; 0]);
}

#[test]
fn locks_of_other_lengths_are_told() {
    let n_locks = serde_json::from_slice::<Value>(SESSION).unwrap()["strands"].as_array().unwrap().len();
    let doubled = warnings(|session| {
        each_lock(session, |lock| {
            forget_distances(lock);
            times(&mut lock["length_mm"], 2.0);
        });
    });
    assert_eq!(doubled.len(), n_locks, "{doubled:?}");
    assert!(doubled.iter().all(|w| w.starts_with("lock ") && w.ends_with("(`length_mm`)")), "{doubled:?}");
    let halved = warnings(|session| {
        each_lock(session, |lock| {
            times(&mut lock["marker_distance_from_root_mm"], 0.5);
        });
    });
    assert!(
        halved.iter().filter(|w| w.ends_with("mm (`marker_distance_from_root_mm`)")).count() == n_locks,
        "{halved:?}"
    );
    let of_one = warnings(|session| times(&mut session["strands"][0]["length_mm"], 10.0));
    assert_eq!(of_one.len(), 1, "{of_one:?}");
    assert!(of_one[0].contains("mm down a lock of"), "{of_one:?}");
}

#[test]
fn locks_in_another_unit_are_refused() {
    for factor in [0.1, 10.0] {
        let error = error(|session| {
            each_lock(session, |lock| {
                times(&mut lock["length_mm"], factor);
                times(&mut lock["marker_distance_from_root_mm"], factor);
            });
        });
        assert!(
            error.starts_with("the session demo does not fit the hair in the capture demo: lock "),
            "{error}"
        );
        assert!(error.contains("; and ") && error.ends_with("locks more"), "{error}");
    }
    let error = error(|session| {
        forget_distances(&mut session["strands"][0]);
        times(&mut session["strands"][0]["length_mm"], 10.0);
    });
    assert!(error.ends_with("(`length_mm`)") && !error.contains(';'), "{error}");
}

#[test]
fn one_marker_of_a_lock_in_a_wrong_place_is_told() {
    // The second marker 2 mm after the first: the hair between it and the first is seen to be longer.
    let found = warnings(|session| {
        let distances = &mut session["strands"][0]["marker_distance_from_root_mm"];
        distances[1] = json!(distances[0].as_f64().unwrap() + 2.0);
    });
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].contains("mm from what is before it, expected at most the 2 mm of hair"), "{found:?}");
}

#[test]
fn a_root_that_is_not_on_the_head_is_told() {
    let found = warnings(|session| session["strands"][0]["root_mm"][0] = json!(5000.0));
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(
        found[0].contains(": found its root (`root_mm`) 4.")
            && found[0].ends_with("expected it on the scalp"),
        "{found:?}"
    );
}

/// Full axes for half axes, a head in centimeters, and one in meters, with colliders or without.
#[test]
fn a_head_on_which_no_hair_grows_is_told() {
    const AXES: &str = "head_ellipsoid_half_axes_mm";
    let scaled = |factor: f64| move |session: &mut Value| times(&mut session["colliders"][AXES], factor);
    let doubled = warnings(scaled(1.8));
    assert_eq!(doubled.len(), 1, "{doubled:?}");
    assert!(
        doubled[0].starts_with("`colliders.head_ellipsoid_half_axes_mm`: found roots (`root_mm`) at 0.5")
            && doubled[0].ends_with("expected them on it"),
        "{doubled:?}"
    );
    for factor in [0.1, 0.001, 10.0] {
        let error = error(scaled(factor));
        assert!(
            error.contains("capture demo: `colliders.head_ellipsoid_half_axes_mm`: found roots"),
            "{error}"
        );
    }
    let error = error(|session| {
        session.as_object_mut().unwrap().remove("colliders");
        each_lock(session, |lock| times(&mut lock["root_mm"], 0.1));
    });
    assert!(error.contains("an adult's head, as the session has no `colliders`: found roots"), "{error}");
}

#[test]
fn what_is_too_far_from_its_lock_is_told() {
    let cleaned = prepared_by(&PrepareOptions::default(), |session| {
        session["strands"][0]["root_mm"][0] = json!(5000.0);
    });
    let found = cleaned.unwrap().quality.ingest.warnings;
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found[1].contains(": found markers farther from its root than hair lets them be"), "{found:?}");
}

#[test]
fn a_head_marker_far_from_its_place_is_told() {
    let found = warnings(|session| {
        let nose = &mut session["head_markers_mm_in_head_frame"]["NOSE"];
        nose[0] = json!(nose[0].as_f64().unwrap() + 40.0);
    });
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(
        found[0].starts_with("head marker NOSE: found it 4")
            || found[0].starts_with("head marker NOSE: found it 39"),
        "{found:?}"
    );
}

#[test]
fn fans_that_blow_two_ways_are_told() {
    let by_20 = |degrees: f64| {
        warnings(|session| {
            let azimuth = &mut session["fans"][0]["from_azimuth_deg"];
            *azimuth = json!(azimuth.as_f64().unwrap() + degrees);
        })
    };
    assert_eq!(by_20(15.0), [""; 0]);
    let found = by_20(30.0);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(
        found[0].starts_with("fans[0]: found wind from azimuth 70°") && found[0].contains("from 100° and 0°"),
        "{found:?}"
    );
    let turned = warnings(|session| {
        session["fans"][0]["from_azimuth_deg"] = json!(100);
        session["fans"][0]["to_azimuth_deg"] = json!(120);
    });
    assert!(turned[0].ends_with("`from_azimuth_deg` is believed"), "{turned:?}");
}

/// The last lock is in the session and not in the capture, as is a marker of the head: all else is as it was.
#[test]
fn markers_that_are_not_there_are_told() {
    let prepared = prepared(|session| {
        let head = session["head_markers_mm_in_head_frame"].as_object_mut().unwrap();
        head.insert("CROWN".to_owned(), json!([0, 0, 105]));
        let strands = session["strands"].as_array_mut().unwrap();
        let mut lock = strands[0].clone();
        lock["strand"] = json!("T99");
        lock["markers"]
            .as_array_mut()
            .unwrap()
            .iter_mut()
            .enumerate()
            .for_each(|(k, m)| *m = json!(format!("T99_{k}")));
        strands.push(lock);
    })
    .unwrap();
    let warnings = &prepared.quality.ingest.warnings;
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(
        warnings[0]
            .starts_with("markers of the session that are not in the capture count as never seen: CROWN")
    );
    assert_eq!(warnings[1], "locks without a marker in the capture are left out: T99");
    let crown = prepared.located.report.markers.iter().find(|m| m.label == "CROWN").unwrap();
    assert!(crown.is_never_seen() && !crown.trusted);
}

#[test]
fn hair_that_is_blown_in_the_still_frames_is_told() {
    let found = warnings(|session| session["still_frames"] = json!([200, 400]));
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(
        found[0].starts_with("found locks that move by ")
            && found[0].ends_with("in the still frames 200 to 400, expected hair that hangs still"),
        "{found:?}"
    );
}

#[test]
fn still_frames_outside_of_the_capture_are_told_and_others_taken() {
    let outside = prepared(|session| {
        session["still_frames"] = json!([5000, 5100]);
        session.as_object_mut().unwrap().remove("wind_starts_about_frame");
    });
    let outside = outside.unwrap();
    let warnings = &outside.quality.ingest.warnings;
    assert_eq!(warnings, &["still frames 5000 to 5100 are not in the capture (frames 1 to 480)"]);
    let (first, last) = outside.session.still_frames.unwrap();
    assert!(first == 1 && (100..140).contains(&last), "{first} to {last}");
    assert!(outside.quality.assumed.iter().any(|assumed| assumed.what == "still_frames"));
}
