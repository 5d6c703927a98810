//! What is written is read again, bit for bit, and the same each time.

use crate::arbitrary::{self, any_eff, small, small_file, written};
use proptest::prelude::*;
use std::io::Cursor;
use tousle_core::NoProgress;
use tousle_eff::{Eff, Encoding, ReadOptions, WriteOptions, inspect, read, replace_layers, validate, write};

#[test]
fn a_small_file_comes_back_and_is_sound() {
    let eff = small();
    let bytes = written(&eff, &WriteOptions::default());
    assert_eq!(read(&bytes[..], &ReadOptions::default()).unwrap(), eff);
    let validation = validate(&bytes[..]).unwrap();
    assert!(validation.is_sound && validation.findings.is_empty(), "{:#?}", validation.findings);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn read_undoes_write(eff in any_eff()) {
        let bytes = written(&eff, &WriteOptions::default());
        prop_assert_eq!(&read(&bytes[..], &ReadOptions::default()).unwrap(), &eff);
        prop_assert_eq!(&written(&eff, &WriteOptions::default()), &bytes);
        let validation = validate(&bytes[..]).unwrap();
        prop_assert!(validation.is_sound, "{:#?}", validation.findings);
    }
}

#[test]
fn lossy_files_keep_the_bound_that_their_manifest_states() {
    let eff = small();
    for encoding in [Encoding::F16, Encoding::Fixed { max_error: 1e-3 }, Encoding::Fixed { max_error: 2e-6 }]
    {
        let mut bytes = Vec::new();
        let report = write(&eff, &mut bytes, &WriteOptions::with_encoding(encoding), &NoProgress).unwrap();
        let validation = validate(&bytes[..]).unwrap();
        assert!(validation.findings.is_empty(), "{encoding:?} {:#?}", validation.findings);
        let info = inspect(&bytes[..]).unwrap().manifest.field.encoding;
        let again = read(&bytes[..], &ReadOptions::default()).unwrap();
        let mut largest = 0.0;
        for (read, written) in again.field.steps.iter().zip(&eff.field.steps) {
            assert_eq!(read.flags, written.flags);
            for (read, written) in read.u.iter().zip(&written.u) {
                let error = (f64::from(*read) - f64::from(*written)).abs();
                let relative = info.max_relative_error * f64::from(written.abs());
                assert!(error <= info.max_absolute_error.max(relative), "{encoding:?}: {error}");
                largest = f64::max(largest, error);
            }
        }
        assert_eq!(report.max_error, largest);
        assert!(largest > 0.0, "{encoding:?} loses nothing: this test shows nothing");
    }
}

#[test]
fn what_a_file_cannot_hold_is_refused_before_it_is_written() {
    let refused = |change: &dyn Fn(&mut Eff)| {
        let mut eff = small();
        change(&mut eff);
        let mut bytes = Vec::new();
        write(&eff, &mut bytes, &WriteOptions::default(), &NoProgress).unwrap_err().to_string()
    };
    assert_eq!(
        refused(&|eff| eff.field.start_secs = -0.5),
        "field.start_secs: found -0.5, expected 0 to 1e6"
    );
    assert_eq!(
        refused(&|eff| eff.field.steps[2].u[24] = f32::NAN),
        "step 2, voxel Some([0, 0, 0]): found NaN, expected a finite number"
    );
    assert_eq!(
        refused(&|eff| eff.scene.body.friction = f64::NAN),
        "scene.body.friction: found NaN, expected 0 or above"
    );
    assert_eq!(
        refused(&|eff| eff.scene.gravity_world.z = f64::NEG_INFINITY),
        "scene.gravity_world: found -inf, expected a finite number"
    );
    assert_eq!(
        refused(&|eff| eff.field.layers.push(arbitrary::layer("1"))),
        "layers[1].id: found \"1\" again, expected each id once"
    );
    assert_eq!(
        refused(&|eff| eff.field.layers[0].handles[0].extra.x = f64::INFINITY),
        "layers: found inf, expected a finite number"
    );
    assert_eq!(
        refused(&|eff| eff.attachments.push(eff.attachments[0].clone())),
        "attachment.name: found \"session.json\" again, expected each name once"
    );
}

#[test]
fn a_file_that_unpacks_to_too_much_is_refused() {
    let bytes = small_file();
    let mut options = ReadOptions::default();
    options.max_memory = 1000;
    let error = read(&bytes[..], &options).unwrap_err().to_string();
    // 24 voxels x (3 + 1 floats, 1 flag) = 408 bytes a step: the third is too much.
    assert_eq!(error, "the steps of the file take 1224 bytes of memory, expected at most 1000");
}

/// An edit of a file that has lost something in packing loses nothing more.
#[test]
fn edits_are_replaced_and_nothing_else() {
    let eff = small();
    let bytes = written(&eff, &WriteOptions::with_encoding(Encoding::Fixed { max_error: 1e-3 }));
    let layers = [arbitrary::layer("new"), arbitrary::layer("newer")];
    let mut edited = Vec::new();
    replace_layers(Cursor::new(&bytes), &layers, &mut edited, &NoProgress).unwrap();
    let mut expected = read(&bytes[..], &ReadOptions::default()).unwrap();
    expected.field.layers = layers.to_vec();
    assert_eq!(read(&edited[..], &ReadOptions::default()).unwrap(), expected);
    let mut back = Vec::new();
    replace_layers(Cursor::new(&edited), &eff.field.layers, &mut back, &NoProgress).unwrap();
    assert_eq!(back, bytes);
    let twice = [arbitrary::layer("new"), arbitrary::layer("new")];
    assert!(replace_layers(Cursor::new(&bytes), &twice, Vec::new(), &NoProgress).is_err());
}

/// Four of the 24 voxels are measured and eleven interpolated, as `arbitrary::step` flags them.
#[test]
fn an_inspection_counts_what_is_there() {
    let bytes = small_file();
    let found = inspect(&bytes[..]).unwrap();
    assert_eq!(found.n_bytes, bytes.len() as u64);
    assert_eq!(found.field_span_secs, [0.0, 4.0 / 30.0]);
    let messages: Vec<_> = found.channels.iter().map(|c| (c.topic.as_str(), c.n_messages)).collect();
    let expected =
        [("/eff/manifest", 1), ("/eff/edits", 1), ("/eff/pose", 17), ("/eff/samples", 5), ("/eff/field", 5)];
    assert_eq!(messages, expected);
    // 24 voxels of 3 + 1 floats and a flag each, and some for the rest.
    let per_step = found.channels[4].n_bytes / 5;
    assert!((24 * 17..24 * 17 + 70).contains(&per_step), "{per_step}");
    let coverage = found.coverage;
    assert_eq!((coverage.measured, coverage.interpolated), (4.0 / 24.0, 11.0 / 24.0));
    assert_eq!(coverage.ever_measured, coverage.measured);
    let largest =
        small().field.steps.iter().flat_map(|s| (0..24).map(|v| s.vector(v).norm())).fold(0.0, f64::max);
    assert!((coverage.max_length - largest).abs() < 1e-12);
    assert_eq!(
        (&found.layers[..], &found.attachments[..]),
        (&["lift (1)".to_owned()][..], &[("session.json".into(), 16)][..])
    );
}
