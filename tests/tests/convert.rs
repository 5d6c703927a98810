//! From a capture to a field: the main job, on the demo's capture and on those a stranger does not have.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::collections::BTreeMap;
use std::sync::LazyLock;
use tousle_core::NoProgress;
use tousle_eff::{ReadOptions, WriteOptions};
use tousle_field::VoxelFlag;
use tousle_fit::{FitMethod, FitOptions, PaperOptions};
use tousle_pipeline::{
    ConvertError, ConvertOptions, Converted, Input, PrepareOptions, Prepared, Silent, convert, prepare,
};
use tousle_tests::{CAPTURE, SESSION, name, shared_captures};

fn input(bytes: &[u8]) -> Input<'_> {
    Input { name: "test", bytes }
}

/// By the method `paper`, whose samples can be traced to their markers.
fn by_paper() -> ConvertOptions {
    let method = FitMethod::Paper(PaperOptions::default());
    ConvertOptions { fit: FitOptions { method, ..FitOptions::default() }, ..ConvertOptions::default() }
}

/// The demo's capture, converted once for all tests.
static DEMO: LazyLock<Converted> = LazyLock::new(|| converted(CAPTURE, SESSION));

fn converted(capture: &[u8], session: &[u8]) -> Converted {
    convert(input(capture), input(session), &by_paper(), &Silent).unwrap()
}

fn bytes(converted: &Converted) -> Vec<u8> {
    let mut bytes = Vec::new();
    tousle_eff::write(&converted.eff, &mut bytes, &WriteOptions::default(), &NoProgress).unwrap();
    bytes
}

#[test]
fn the_demo_capture_becomes_a_sound_field() {
    let converted = &*DEMO;
    assert!(converted.report.losses.is_empty(), "{:?}", converted.report.losses);
    let field = &converted.eff.field;
    assert_eq!((field.steps.len(), field.grid.dims), (120, [30; 3]));
    assert!(converted.eff.scene.poses.is_still(), "the mannequin does not move");
    // The first second is still: its forces are the noise of the cameras, far below those of the wind.
    let strength = |step: usize| {
        let step = &field.steps[step];
        let measured = (0..step.flags.len()).filter(|&v| step.flags[v] == VoxelFlag::Measured);
        let lengths: Vec<f64> = measured.map(|v| step.vector(v).norm()).collect();
        lengths.iter().sum::<f64>() / lengths.len() as f64
    };
    assert!(strength(10) < 0.1, "{}", strength(10));
    assert!(strength(75) > 1.0, "{}", strength(75));
    let bytes = bytes(converted);
    let validation = tousle_eff::validate(&bytes[..]).unwrap();
    assert!(validation.is_sound && validation.findings.is_empty(), "{:?}", validation.findings);
    let read = tousle_eff::read(&bytes[..], &ReadOptions::default()).unwrap();
    assert!(read.field == converted.eff.field, "the field comes back as it was");
    assert!(read.scene == converted.eff.scene, "and so does the scene");
}

/// A session that does not say when hair hung still: the capture shows it, and the report says that nobody said it.
#[test]
fn still_frames_that_nobody_named_are_found() {
    let mut session: serde_json::Value = serde_json::from_slice(SESSION).unwrap();
    let fields = session.as_object_mut().unwrap();
    let named = fields.remove("still_frames").unwrap();
    let named = [0, 1].map(|k| named[k].as_i64().unwrap());
    fields.remove("wind_starts_about_frame").unwrap();
    let session = serde_json::to_vec(&session).unwrap();
    let prepared = prepare(input(CAPTURE), input(&session), &PrepareOptions::default(), &Silent).unwrap();
    let (first, last) = prepared.session.still_frames.unwrap();
    assert_eq!(first, named[0]);
    // Hair takes a tenth of a second to be moved by the first of the wind.
    assert!((named[1] - 12..named[1] + 18).contains(&last), "{last}, named {}", named[1]);
    let said = prepared.quality.assumed.iter().find(|assumed| assumed.what == "still_frames").unwrap();
    assert_eq!(said.value, format!("[{first}, {last}]"));
    let noise_m = |prepared: &Prepared| prepared.located.report.noise_m.unwrap();
    let of_named = prepare(input(CAPTURE), input(SESSION), &PrepareOptions::default(), &Silent).unwrap();
    assert!((noise_m(&prepared) / noise_m(&of_named) - 1.0).abs() < 0.1, "the head is seen at rest as well");
    assert!(!of_named.quality.assumed.iter().any(|assumed| assumed.what == "still_frames"));
}

/// The demo's capture has gaps; as it was, and cleaned: what no camera saw makes no wind, so that the method's
/// samples stay what they were wherever nothing was mended.
#[test]
fn cleaning_is_told_and_can_be_left_out() {
    let mut options = by_paper();
    options.prepare.clean = None;
    let as_read = convert(input(CAPTURE), input(SESSION), &options, &Silent).unwrap();
    let cleaned = &*DEMO;
    assert_eq!(as_read.report.quality.clean, None);
    assert!(std::ptr::eq(as_read.prepared.head(), &as_read.prepared.located.head));
    let report = cleaned.report.quality.clean.as_ref().unwrap();
    assert!(report.n_gaps_filled() > 0);
    assert!(report.gaps.iter().all(|g| g.expected_error_m.is_finite()));
    assert!(cleaned.report.fit.n_samples >= as_read.report.fit.n_samples);
    assert_eq!(
        cleaned.report.fit.n_filled, cleaned.report.fit.n_missing,
        "every hole was filled, none is used"
    );
    let attached = cleaned.eff.attachments.iter().find(|a| a.name == "report.json").unwrap();
    let attached: serde_json::Value = serde_json::from_slice(&attached.bytes).unwrap();
    assert_eq!(attached["clean"]["gaps"].as_array().unwrap().len(), report.gaps.len());
    assert_eq!(attached["head"]["frames"]["residual_m"].as_array().unwrap().len(), 480);
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let with_threads = |n| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        let convert = |options: &ConvertOptions| {
            bytes(&convert(input(CAPTURE), input(SESSION), options, &Silent).unwrap())
        };
        pool.install(|| (convert(&by_paper()), convert(&ConvertOptions::default())))
    };
    assert!(with_threads(1) == with_threads(2), "1 and 2 threads");
}

#[test]
fn a_session_that_names_other_markers_than_are_there_is_refused() {
    // A marker that is not there counts as never seen (`tousle-ingest`); here it is all of them.
    let mut session = String::from_utf8(SESSION.to_vec()).unwrap();
    (1..=27).for_each(|lock| session = session.replace(&format!("S{lock:02}_"), &format!("X{lock:02}_")));
    let result = convert(input(CAPTURE), input(session.as_bytes()), &ConvertOptions::default(), &Silent);
    let Err(ConvertError::Mismatch { source, .. }) = result else {
        panic!("expected a refusal, found {:?}", result.map(|converted| converted.report.losses))
    };
    assert!(source.to_string().contains("X01_1"), "{source}");
}

#[test]
fn a_cut_capture_is_refused() {
    for n_bytes in [0, 100, 512, 4000, CAPTURE.len() / 2, CAPTURE.len() - 100_000] {
        let result = convert(input(&CAPTURE[..n_bytes]), input(SESSION), &ConvertOptions::default(), &Silent);
        assert!(
            matches!(result, Err(ConvertError::Capture { .. })),
            "{n_bytes} bytes: {:?}",
            result.map(|c| c.report)
        );
    }
}

/// A step of 0.1 mm moves a coordinate by up to 0.05 mm, 0.087 mm in all; E3 makes 2 / s² of it, and the shortest
/// s is a fall of 2 cm, 0.064 s. The rest pose and the head's pose are means and add less than as much again.
const INTEGER_BOUND: f64 = 2.0 * 0.087e-3 * 2.0 / (0.064 * 0.064);
/// The CSV has six significant digits: up to 0.005 mm in a coordinate over a meter.
const CSV_BOUND: f64 = INTEGER_BOUND / 10.0;

/// CSV, float C3D and integer C3D of one trial give the same field within the rounding of their numbers.
#[test]
fn three_files_of_one_trial_give_one_field() {
    for folder in shared_captures().into_iter().filter(|f| name(f) == "two_fans") {
        let read = |file: &str| std::fs::read(folder.join(file)).unwrap();
        let session = read("session.json");
        let float = converted(&read("two_fans.c3d"), &session);
        for (file, bound) in [("two_fans.csv", CSV_BOUND), ("two_fans_int.c3d", INTEGER_BOUND)] {
            let other = converted(&read(file), &session);
            let (worst, n_compared, n_all) = difference(&float, &other);
            println!(
                "{file}: {worst:.5} m/s² at most in {n_compared} of {n_all} measured voxels (bound {bound:.5})"
            );
            assert!(worst < bound, "{file}: {worst} m/s², expected at most {bound}");
            assert!(
                n_compared as f64 > 0.98 * n_all as f64,
                "{file}: {n_compared} of {n_all} voxels compared"
            );
        }
    }
}

/// The largest difference in measured voxels that hold the same markers in both, and how many those are of all.
/// (Rounding moves a marker across a voxel's side now and then; then two voxels hold other markers' means.)
fn difference(a: &Converted, b: &Converted) -> (f64, usize, usize) {
    let grid = a.eff.field.grid;
    let markers = |converted: &Converted, step: usize| {
        let mut markers = BTreeMap::<usize, Vec<(u32, u32)>>::new();
        for sample in &converted.eff.samples.as_ref().unwrap().steps[step] {
            if let Some(voxel) = grid.voxel_at(sample.position_m) {
                markers.entry(grid.flat(voxel)).or_default().push((sample.strand_idx, sample.marker_idx));
            }
        }
        markers
    };
    let (mut worst, mut n_compared, mut n_all) = (0.0_f64, 0, 0);
    for (step, (field_a, field_b)) in a.eff.field.steps.iter().zip(&b.eff.field.steps).enumerate() {
        let (in_a, in_b) = (markers(a, step), markers(b, step));
        n_all += in_a.len();
        for (voxel, _) in in_a.iter().filter(|(voxel, markers)| in_b.get(voxel) == Some(markers)) {
            n_compared += 1;
            worst = worst.max((field_a.vector(*voxel) - field_b.vector(*voxel)).norm());
        }
    }
    (worst, n_compared, n_all)
}
