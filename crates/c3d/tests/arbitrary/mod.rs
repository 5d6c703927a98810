//! Trials and points as a writer can be given them.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use proptest::collection::vec;
use proptest::prelude::*;
use tousle_c3d::{Group, Parameter, Parameters, Point, Processor, Storage, Trial, Value};

/// A trial and its frames.
pub type Recording = (Trial, Vec<Vec<Option<Point>>>);

pub fn recording() -> impl Strategy<Value = Recording> {
    let processor = prop_oneof![Just(Processor::Intel), Just(Processor::Dec), Just(Processor::Mips)];
    let storage = prop_oneof![Just(Storage::Float32), Just(Storage::Int16)];
    let shape = (0_usize..6, 1_usize..40);
    (processor, storage, 1e-3_f32..10.0, shape).prop_flat_map(
        |(processor, storage, scale, (n_points, n_frames))| {
            let frames = vec(vec(point(storage, scale), n_points), n_frames);
            let head = (0_f32..2000.0, prop_oneof![0_u32..1000, 65_000_u32..200_000]);
            let texts = (proptest::option::of("[a-zµ]{1,6}"), vec(label(), n_points));
            (head, texts, parameters(), frames).prop_map(
                move |((rate_hz, first_frame), (unit, labels), parameters, frames)| {
                    let trial = Trial {
                        processor,
                        storage,
                        scale,
                        rate_hz,
                        first_frame,
                        n_frames,
                        unit,
                        labels,
                        parameters,
                    };
                    (trial, frames)
                },
            )
        },
    )
}

/// Latin-1 without blanks around it; some are empty.
fn label() -> impl Strategy<Value = String> {
    prop_oneof![Just(String::new()), "[A-Za-z*ü][A-Za-z0-9:_ é]{0,40}[A-Za-z0-9ß]", "\\*[0-9]{1,3}"]
}

fn point(storage: Storage, scale: f32) -> impl Strategy<Value = Option<Point>> {
    let steps = any::<[i16; 3]>().prop_map(move |steps| steps.map(|s| f32::from(s) * scale));
    let floats = any::<[f32; 3]>().prop_map(|floats| floats.map(representable));
    let position = match storage {
        Storage::Int16 => steps.boxed(),
        Storage::Float32 => floats.boxed(),
    };
    proptest::option::weighted(
        0.8,
        (position, any::<u8>(), 0_u8..128).prop_map(|(position, residual, cameras)| Point {
            position,
            residual,
            cameras,
        }),
    )
}

/// A number that floats of every processor hold: finite, below 2^127, and no denormal.
fn representable(value: f32) -> f32 {
    if value.is_normal() && value.abs() < 1.7e38 { value } else { 0.0 }
}

fn parameters() -> impl Strategy<Value = Parameters> {
    // Names of their own, so that none is reserved; POINT and TRIAL are joined with what the writer adds there.
    let name = prop_oneof![Just("POINT".to_owned()), Just("TRIAL".to_owned()), "OTHER[A-Z_]{0,12}"];
    let group = (name, text(30), any::<bool>(), vec(parameter(), 1..4))
        .prop_map(|(name, description, locked, parameters)| Group { name, description, locked, parameters });
    vec(group, 0..5).prop_map(|mut groups| {
        let mut names = std::collections::BTreeSet::new();
        groups.retain(|g| names.insert(g.name.clone()));
        Parameters { groups }
    })
}

fn parameter() -> impl Strategy<Value = Parameter> {
    let dimensions = vec(0_u8..6, 0..4);
    (dimensions, 0..4).prop_flat_map(|(dimensions, kind)| {
        let n = dimensions.iter().map(|&d| usize::from(d)).product::<usize>();
        let value = match kind {
            0 => vec(any::<u8>(), n).prop_map(Value::Text).boxed(),
            1 => vec(any::<u8>(), n).prop_map(Value::Bytes).boxed(),
            2 => vec(any::<i16>(), n).prop_map(Value::Integers).boxed(),
            _ => vec(any::<f32>().prop_map(representable), n).prop_map(Value::Floats).boxed(),
        };
        ("X[A-Z0-9_]{0,20}", text(255), any::<bool>(), value).prop_map(
            move |(name, description, locked, value)| Parameter {
                name,
                description,
                locked,
                dimensions: dimensions.clone(),
                value,
            },
        )
    })
}

/// Latin-1 without blanks around it.
fn text(max: usize) -> impl Strategy<Value = String> {
    vec(prop_oneof![0x21_u8..0x7f, 0xa1_u8..], 0..=max)
        .prop_map(|letters| letters.into_iter().map(char::from).collect())
}
