//! Files of version 0, as its writer made them. No program writes it any more; this stays for the tests.

use super::Case;
use crate::arbitrary::{small, step, tiny};
use crate::forge::{FIELD, MANIFEST, POSE, Piece, Pieces};
use protox::prost_reflect::prost::Message as _;
use protox::prost_reflect::{DescriptorPool, DynamicMessage, Value};
use serde_json::json;
use tousle_eff::Eff;
use tousle_field::{Field, GridSpec};

pub fn cases() -> Vec<Case> {
    let case = |name, what, eff: Eff| {
        let written = eff.clone();
        let make = Box::new(move || pieces(&written).forge());
        Case { name, what, eff, make, max_error: 0.0, findings: &[] }
    };
    vec![
        case("tiny", "as little as a file of version 0 can be", of_version_0(tiny(), 2, 2)),
        case("small", "a few voxels and steps", of_version_0(small(), 3, 5)),
    ]
}

/// Leaves out what version 0 did not have: a grid that is no cube, standard deviations, samples, edits.
fn of_version_0(mut eff: Eff, n: usize, n_steps: u32) -> Eff {
    let extent_m = 0.6;
    let edge_m = extent_m / n as f64;
    let grid = GridSpec { origin_m: tousle_core::Vec3::repeat(-extent_m / 2.0), edge_m, dims: [n; 3] };
    eff.field.grid = grid;
    eff.field.steps = (0..n_steps).map(|k| Field { sd: None, ..step(&grid, f64::from(k)) }).collect();
    eff.field.layers.clear();
    eff.samples = None;
    eff
}

pub fn pieces(eff: &Eff) -> Pieces {
    let manifest_schema = include_bytes!("../../../../../schemas/eff.v0.manifest.json").to_vec();
    let descriptors = include_bytes!("../../../../../schemas/eff.v0.binpb").to_vec();
    let schema = |id, name: &str, encoding: &str, text: &[u8]| {
        (id, format!("tousle.eff.v0.{name}"), encoding.to_owned(), text.to_vec())
    };
    let channel = |id, topic: &str, encoding: &str| (id, id, topic.to_owned(), encoding.to_owned());
    let mut chunks = vec![vec![piece(MANIFEST, 0, 0, serde_json::to_vec(&manifest(eff)).unwrap())]];
    chunks.push(poses(eff));
    chunks.extend(steps(eff).into_iter().map(|step| vec![step]));
    Pieces {
        profile: "tousle.eff".into(),
        schemas: vec![
            schema(MANIFEST, "Manifest", "jsonschema", &manifest_schema),
            schema(POSE, "PoseStep", "protobuf", &descriptors),
            schema(FIELD, "FieldStep", "protobuf", &descriptors),
        ],
        channels: vec![
            channel(MANIFEST, "/eff/manifest", "json"),
            channel(POSE, "/eff/pose", "protobuf"),
            channel(FIELD, "/eff/field", "protobuf"),
        ],
        chunks,
        attachments: eff
            .attachments
            .iter()
            .map(|a| (a.name.clone(), a.media_type.clone(), a.bytes.clone()))
            .collect(),
        metadata: Vec::new(),
        options: mcap::WriteOptions::new().compression_threads(0).compression_level(1).chunk_size(None),
    }
}

fn piece(channel_id: u16, sequence: usize, log_time: u64, payload: Vec<u8>) -> Piece {
    Piece { channel_id, sequence: sequence as u32, log_time, publish_time: log_time, payload }
}

fn manifest(eff: &Eff) -> serde_json::Value {
    let scene = &eff.scene;
    let body = serde_json::to_value(&scene.body).unwrap();
    json!({
        "format": "tousle.eff",
        "version": 0,
        "name": eff.name,
        "method": eff.method,
        "generator": eff.generator,
        "quantity": eff.field.quantity.name(),
        "extent_m": 0.6,
        "n_voxels": eff.field.grid.dims[0],
        "rate_hz": eff.field.rate_hz,
        "n_steps": eff.field.steps.len(),
        "pose_rate_hz": scene.poses.rate_hz,
        "n_poses": scene.poses.poses.len(),
        "gravity_world": scene.gravity_world,
        "air_density": scene.air_density,
        "rest_pose": seven(&scene.rest_pose),
        "body": body,
    })
}

fn seven(pose: &tousle_core::Pose) -> Vec<f64> {
    let mut numbers = pose.translation.vector.as_slice().to_vec();
    numbers.extend(pose.rotation.coords.as_slice());
    numbers
}

fn poses(eff: &Eff) -> Vec<Piece> {
    let track = &eff.scene.poses;
    let poses = track.poses.iter().enumerate().map(|(k, pose)| {
        let time = (k as f64 / track.rate_hz * 1e9).round() as u64;
        let mut message = message("PoseStep", k, time);
        let numbers = seven(pose).into_iter().map(Value::F64).collect();
        message.set_field_by_name("pose", Value::List(numbers));
        piece(POSE, k, time, message.encode_to_vec())
    });
    poses.collect()
}

fn steps(eff: &Eff) -> Vec<Piece> {
    let steps = eff.field.steps.iter().enumerate().map(|(k, step)| {
        let time = (k as f64 / eff.field.rate_hz * 1e9).round() as u64;
        let mut message = message("FieldStep", k, time);
        let flags: Vec<u8> = step.flags.iter().map(|flag| *flag as u8).collect();
        message.set_field_by_name("u", Value::List(step.u.iter().map(|c| Value::F32(*c)).collect()));
        message.set_field_by_name("flags", Value::Bytes(flags.into()));
        let outside = step.outside.iter().map(|c| Value::F64(*c)).collect();
        message.set_field_by_name("outside", Value::List(outside));
        piece(FIELD, k, time, message.encode_to_vec())
    });
    steps.collect()
}

fn message(name: &str, k: usize, time: u64) -> DynamicMessage {
    let pool = DescriptorPool::decode(&include_bytes!("../../../../../schemas/eff.v0.binpb")[..]).unwrap();
    let mut message =
        DynamicMessage::new(pool.get_message_by_name(&format!("tousle.eff.v0.{name}")).unwrap());
    message.set_field_by_name("index", Value::U64(k as u64));
    message.set_field_by_name("time_ns", Value::U64(time));
    message
}
