//! Good files, one for every feature.

pub mod old;

use crate::arbitrary::{layer, scene, small, step, tiny, written};
use crate::forge::by_hand::Habits;
use crate::forge::{FIELD, MANIFEST, Piece, Pieces, pieces};
use serde_json::{Value, json};
use tousle_core::{Body, PoseTrack, Quantity, Vec3};
use tousle_eff::{Eff, Encoding, WriteOptions};
use tousle_field::{FieldLayer, GridSpec, Handle, LayerKey, LayerOrigin, Reshape, VoxelFlag};

pub struct Case {
    pub name: &'static str,
    pub what: &'static str,
    /// What the file holds.
    pub eff: Eff,
    pub make: Box<dyn Fn() -> Vec<u8>>,
    /// How far components may be off.
    pub max_error: f64,
    /// Warnings.
    pub findings: &'static [&'static str],
}

pub fn cases() -> Vec<Case> {
    let mut cases = vec![
        plain("full", "something of everything", small()),
        plain("tiny", "something of everything, as little as can be", tiny()),
        plain("minimal", "one voxel, one step, one pose, nothing else", minimal()),
        plain("late", "field and poses begin late, at odd rates", late()),
        plain("oblong", "a grid that is no cube, without standard deviations", oblong()),
        plain("muted", "a muted layer and one that begins before the field", layers()),
        plain("directing", "layers that were solved for, change the wind, and are mirrored", directed()),
        plain("empty-steps", "samples of which most steps have none", few_samples()),
        packed("f16", "half precision", small(), Encoding::F16),
        packed("fixed16", "multiples in 16 bits", small(), Encoding::Fixed { max_error: 1e-3 }),
        packed("fixed32", "multiples in 32 bits", small(), Encoding::Fixed { max_error: 2e-6 }),
        packed(
            "f16-sd-f32",
            "half precision, but a standard deviation beyond its range",
            large_sd(),
            Encoding::F16,
        ),
    ];
    let make = Box::new(|| written(&small(), &WriteOptions::default().with_preview()));
    let what = "channels for viewers beside the field";
    cases.push(Case { name: "preview", what, eff: small(), make, max_error: 0.0, findings: &[] });
    cases.push(forged("stranger", "other chunks, no compression, by another program", &[], |p| {
        p.options = p.options.clone().compression(None);
        let messages: Vec<Piece> = p.chunks.drain(..).flatten().collect();
        p.chunks.push(messages);
        // Empty, so that the attachments still come after a chunk.
        p.chunks.push(Vec::new());
    }));
    cases.push(forged("unknown-length", "a writer that did not know how many steps would come", &[], |p| {
        p.manifest("/field/n_steps", Value::Null);
    }));
    cases.push(forged("extended", "extensions that a reader skips", &["skipped", "skipped"], |p| {
        p.json(MANIFEST, |m| m["extensions"] = json!({"com.example.lens": {"mm": 35}}));
        // Field 1000, two bytes.
        p.message(FIELD, 1).payload.extend([0xc2, 0x3e, 2, 7, 7]);
        p.channels.push((9, 0, "/preview/slice".into(), "json".into()));
        p.chunks.push(vec![Piece {
            channel_id: 9,
            sequence: 3,
            log_time: 5,
            publish_time: 6,
            payload: b"anything".to_vec(),
        }]);
        p.metadata.push("com.example".into());
    }));
    cases.push(forged(
        "other-schema-text",
        "schemas as another compiler gives them",
        &["schema-text"; 3],
        |p| {
            for (_, _, encoding, text) in &mut p.schemas {
                if encoding == "protobuf" {
                    // A second file without content, which changes no message.
                    text.extend([0x0a, 3, 0x0a, 1, b'x']);
                }
            }
        },
    ));
    cases.push(forged("outside-chunks", "no chunks at all", &[], |p| {
        p.options = p.options.clone().use_chunks(false);
    }));
    let habits = Habits { has_early_schemas: true, ..Habits::default() };
    cases.push(by_hand("early-schemas", "schemas and channels before the first chunk", habits, |_| {}));
    let habits = Habits { indexes_every_channel: true, ..Habits::default() };
    cases.push(by_hand(
        "all-indexed",
        "empty indexes, and samples of later times between steps",
        habits,
        |p| {
            let later = p.chunks[2].split_off(3);
            p.chunks.insert(4, later);
        },
    ));
    let habits = Habits { has_offsets_of_nothing: true, ..Habits::default() };
    cases.push(by_hand(
        "offsets-of-nothing",
        "summary offsets of records that are not there",
        habits,
        |_| {},
    ));
    cases.push(forged("rounded-down", "times rounded down to whole nanoseconds", &[], |p| {
        for piece in p.chunks.iter_mut().flatten().filter(|piece| piece.log_time == 33_333_334) {
            piece.log_time -= 1;
        }
    }));
    cases
}

fn plain(name: &'static str, what: &'static str, eff: Eff) -> Case {
    packed(name, what, eff, Encoding::F32)
}

fn packed(name: &'static str, what: &'static str, eff: Eff, encoding: Encoding) -> Case {
    let bound = encoding.error_bound();
    let largest = eff.field.steps.iter().flat_map(|s| &s.u).fold(0.0, |a: f32, c| a.max(c.abs()));
    let max_error = bound.absolute.max(bound.relative * f64::from(largest));
    let written = eff.clone();
    let make = Box::new(move || bytes(&written, encoding));
    Case { name, what, eff, make, max_error, findings: &[] }
}

fn forged(
    name: &'static str,
    what: &'static str,
    findings: &'static [&'static str],
    change: fn(&mut Pieces),
) -> Case {
    let make = Box::new(move || {
        let mut pieces = pieces(&bytes(&tiny(), Encoding::F32));
        change(&mut pieces);
        pieces.forge()
    });
    Case { name, what, eff: tiny(), make, max_error: 0.0, findings }
}

/// Written by a program with other habits; without attachments.
fn by_hand(name: &'static str, what: &'static str, habits: Habits, change: fn(&mut Pieces)) -> Case {
    let mut eff = small();
    eff.attachments.clear();
    let written = bytes(&eff, Encoding::F32);
    let make = Box::new(move || {
        let mut pieces = pieces(&written);
        change(&mut pieces);
        pieces.by_hand(habits)
    });
    Case { name, what, eff, make, max_error: 0.0, findings: &[] }
}

fn bytes(eff: &Eff, encoding: Encoding) -> Vec<u8> {
    written(eff, &WriteOptions::with_encoding(encoding))
}

fn minimal() -> Eff {
    let grid = GridSpec { origin_m: Vec3::repeat(-0.3), edge_m: 0.6, dims: [1, 1, 1] };
    let mut eff = tiny();
    eff.name = String::new();
    eff.field.grid = grid;
    eff.field.steps = vec![tousle_field::Field::still(&grid)];
    eff.field.layers.clear();
    eff.scene.poses = PoseTrack::still(scene().rest_pose);
    eff.scene.body = Body::none();
    eff.samples = None;
    eff.attachments.clear();
    eff
}

fn late() -> Eff {
    let mut eff = small();
    eff.field.quantity = Quantity::ForcePerMass;
    eff.field.start_secs = 12.345;
    eff.field.rate_hz = 29.97;
    eff.scene.poses.start_secs = 12.3;
    eff.scene.poses.rate_hz = 239.76;
    eff.samples = None;
    eff
}

fn oblong() -> Eff {
    let grid = GridSpec { origin_m: Vec3::new(0.01, -0.2, 0.3), edge_m: 0.013, dims: [7, 1, 5] };
    let mut eff = tiny();
    eff.field.grid = grid;
    eff.field.steps = (0..3).map(|k| tousle_field::Field { sd: None, ..step(&grid, f64::from(k)) }).collect();
    eff.samples = None;
    eff
}

fn layers() -> Eff {
    let mut eff = tiny();
    let early = FieldLayer { first_secs: -0.5, ..layer("early") };
    eff.field.layers = vec![FieldLayer { muted: true, ..layer("muted") }, early];
    eff
}

/// A layer of each kind that needs the feature `directing`, all there at the middle of the field's time; and a muted one.
fn directed() -> Eff {
    let mut eff = tiny();
    let at = |id: &str, origin: LayerOrigin| {
        let center_m = Vec3::new(0.03, 0.0, 0.01);
        let handles = vec![Handle { center_m, reach_m: 0.1, extra: Vec3::new(0.5, -0.25, 1.0) }];
        FieldLayer { first_secs: 0.005, last_secs: 0.03, handles, origin, ..layer(id) }
    };
    let key = |strand: &str, control_point, secs| LayerKey {
        strand: strand.into(),
        control_point,
        secs,
        target_m: Vec3::new(0.1, 0.05, -0.0625),
    };
    let keys = LayerOrigin::Keys {
        edit: "lift".into(),
        first_secs: 0.005,
        keys: vec![key("S01", 3, 0.02), key("S01", 5, 0.03), key("S02", 13, 0.03)],
        method: "physical".into(),
    };
    let wind = |action: &str| LayerOrigin::Wind { action: action.into() };
    let mirrored = LayerOrigin::Mirrored { edit: "lift-mirrored".into(), of: "lift".into() };
    let reshape = |turn, scale| Some(Reshape { turn, scale });
    eff.field.layers = vec![
        at("gust", wind("gust")),
        FieldLayer { reshape: reshape(Vec3::zeros(), 0.5), ..at("weaker", wind("strength")) },
        FieldLayer { reshape: reshape(Vec3::new(0.25, 0.0, 1.5), 1.0), ..at("aside", wind("turn")) },
        FieldLayer { muted: true, reshape: reshape(Vec3::zeros(), 0.0), ..at("calm", wind("calm")) },
        at("lift/1", keys.clone()),
        FieldLayer { first_secs: 0.01, ..at("lift/2", keys) },
        at("lift-mirrored/1", mirrored),
    ];
    eff
}

fn few_samples() -> Eff {
    let mut eff = tiny();
    if let Some(samples) = &mut eff.samples {
        samples.rate_hz = 120.0;
        samples.steps.splice(0..0, vec![Vec::new(); 6]);
    }
    eff
}

fn large_sd() -> Eff {
    let mut eff = tiny();
    for step in &mut eff.field.steps {
        step.sd = Some(vec![1e5, 0.0, f32::INFINITY, 1e-6]);
    }
    eff
}

/// A case's expected values, from what was written and not from what is read.
pub fn twin(case: &Case) -> Value {
    json!({
        "what": case.what,
        "findings": case.findings,
        "max_error": case.max_error,
        "content": content(&case.eff),
    })
}

/// What is in a file, in numbers that another program can compare.
pub fn content(eff: &Eff) -> Value {
    let field = &eff.field;
    let grid = &field.grid;
    let n = grid.n_voxels();
    let steps = field.steps.iter().map(|step| {
        let component = |axis: usize| &step.u[axis * n..(axis + 1) * n];
        let sum = |values: &[f32]| values.iter().map(|c| f64::from(*c)).sum::<f64>();
        let count = |flag: VoxelFlag| step.flags.iter().filter(|f| **f == flag).count();
        let known =
            |sd: &Vec<f32>| sd.iter().filter(|sd| sd.is_finite()).map(|sd| f64::from(*sd)).sum::<f64>();
        json!({
            "sum_u": [sum(component(0)), sum(component(1)), sum(component(2))],
            "first_u": [component(0)[0], component(1)[0], component(2)[0]],
            "last_u": [component(0)[n - 1], component(1)[n - 1], component(2)[n - 1]],
            "n_outside": count(VoxelFlag::Outside),
            "n_interpolated": count(VoxelFlag::Interpolated),
            "n_measured": count(VoxelFlag::Measured),
            "sum_known_sd": step.sd.as_ref().map(known),
            "outside": step.outside.as_slice(),
        })
    });
    let pose = |k: usize| {
        let pose = &eff.scene.poses.poses[k];
        json!({ "translation_m": pose.translation.vector.as_slice(), "rotation_xyzw": pose.rotation.coords.as_slice() })
    };
    let samples = eff.samples.as_ref().map(|samples| {
        let all = || samples.steps.iter().flatten();
        json!({
            "rate_hz": samples.rate_hz,
            "counts": samples.steps.iter().map(Vec::len).collect::<Vec<_>>(),
            "sum_position_m": all().map(|s| s.position_m.sum()).sum::<f64>(),
            "sum_value": all().map(|s| s.value.sum()).sum::<f64>(),
            "sum_known_covariance": all().flat_map(|s| s.covariance).filter(|c| c.is_finite()).sum::<f64>(),
        })
    });
    let mut content = json!({
        "name": eff.name,
        "quantity": field.quantity.name(),
        "grid": { "origin_m": grid.origin_m.as_slice(), "edge_m": grid.edge_m, "dims": grid.dims },
        "times_secs": (0..field.steps.len()).map(|k| field.time_secs(k)).collect::<Vec<_>>(),
        "steps": steps.collect::<Vec<_>>(),
        "n_poses": eff.scene.poses.poses.len(),
        "first_pose": pose(0),
        "last_pose": pose(eff.scene.poses.poses.len() - 1),
        "colliders": eff.scene.body.colliders.iter().map(|c| &c.name).collect::<Vec<_>>(),
        "layers": field.layers.iter().map(|l| json!([l.id, l.muted, l.first_secs, l.last_secs])).collect::<Vec<_>>(),
        "samples": samples,
        "attachments": eff.attachments.iter().map(|a| &a.name).collect::<Vec<_>>(),
        // At the middle of the box and time, with the edits.
        "sampled": sampled(eff).as_slice(),
    });
    // Twins that are older than the feature have no such member.
    if field.layers.iter().any(|l| l.reshape.is_some() || !matches!(l.origin, LayerOrigin::Drag { .. })) {
        let layer =
            |l: &FieldLayer| json!({ "handles": l.handles, "reshape": l.reshape, "origin": l.origin });
        content["directing"] = field.layers.iter().map(layer).collect();
    }
    content
}

fn sampled(eff: &Eff) -> Vec3 {
    let grid = &eff.field.grid;
    let time_secs = (eff.field.start_secs + eff.field.end_secs()) / 2.0;
    let point = grid.origin_m * 0.45 + grid.far_corner_m() * 0.55;
    eff.field.at(time_secs).sample(point)
}
