//! What is wrong with messages that MCAP takes for sound.

use super::{Case, forged, forged_from, forged_preview};
use crate::forge::{
    EDITS, FIELD, MANIFEST, POSE, PREVIEW_HEAD, PREVIEW_WIND, SAMPLES, bytes, put_float, set,
};
use protox::prost_reflect::Value as Proto;
use serde_json::json;
use tousle_eff::Encoding;

pub fn cases() -> Vec<Case> {
    let mut cases = manifest();
    cases.extend(numbers());
    cases.extend(edits());
    cases.extend(poses());
    cases.extend(samples());
    cases.extend(steps());
    cases.extend(packing());
    cases.extend(previews());
    cases
}

fn manifest() -> Vec<Case> {
    vec![
        forged("version-newer", "a manifest of version 2", &["version"], |p| p.manifest("/version", 2)),
        forged("version-other", "a manifest that says it is of version 0", &["version"], |p| {
            p.manifest("/version", 0);
        }),
        forged("requires", "a feature that nobody knows", &["requires"], |p| {
            p.manifest("/requires", json!(["vorticity"]));
        }),
        forged("json", "a manifest that ends too early", &["json"], |p| {
            p.message(MANIFEST, 0).payload.pop();
        }),
        forged("json-more", "something after the manifest", &["json"], |p| {
            p.message(MANIFEST, 0).payload.extend(b" {}");
        }),
        forged("json-format", "another format", &["json-schema"], |p| p.manifest("/format", "vdb")),
        forged("json-unknown-member", "a member that version 1 does not have", &["json-schema"], |p| {
            p.json(MANIFEST, |m| m["field"]["units"] = json!("mph"));
        }),
        forged("json-missing-member", "no gravity", &["json-schema"], |p| {
            p.json(MANIFEST, |m| drop(m["scene"].as_object_mut().unwrap().remove("gravity_world")));
        }),
        forged("json-type", "a rate in words", &["json-schema"], |p| {
            p.manifest("/field/rate_hz", "thirty");
        }),
        forged("json-two", "two things wrong at once", &["json-schema", "json-schema"], |p| {
            p.manifest("/field/quantity", "wind");
            p.manifest("/scene/gravity_world", json!([0, 0]));
        }),
        forged("json-member-twice", "a member that is there twice", &["json-schema"], |p| {
            let payload = &mut p.message(MANIFEST, 0).payload;
            payload.splice(1..1, b"\"name\":\"other\",".iter().copied());
        }),
        forged(
            "json-extension-twice",
            "a member within extensions that is there twice",
            &["json-schema"],
            |p| {
                let payload = &mut p.message(MANIFEST, 0).payload;
                payload.splice(1..1, b"\"extensions\":{\"a\":[{\"b\":1,\"b\":2}]},".iter().copied());
            },
        ),
        forged("dims-zero", "no voxels", &["json-schema"], |p| {
            p.manifest("/field/grid/dims", json!([2, 0, 1]));
        }),
    ]
}

fn numbers() -> Vec<Case> {
    vec![
        forged("dims-many", "more voxels than a step may have", &["value"], |p| {
            p.manifest("/field/grid/dims", json!([4096, 4096, 2]));
        }),
        forged("edge-zero", "voxels without size", &["json-schema"], |p| {
            p.manifest("/field/grid/edge_m", 0.0);
        }),
        forged("rate-negative", "time runs backwards", &["json-schema"], |p| {
            p.manifest("/field/rate_hz", -30.0);
        }),
        forged("rate-high", "steps closer than a nanosecond", &["json-schema"], |p| {
            p.manifest("/field/rate_hz", 2e9);
        }),
        forged("start-negative", "a field that begins before time 0", &["json-schema"], |p| {
            p.manifest("/field/start_secs", -1.0);
        }),
        forged("last-late", "steps beyond the last time there is", &["value"], |p| {
            p.manifest("/field/n_steps", 100_000_000);
        }),
        forged("rest-rotation", "a rest pose that is no rotation", &["rotation"], |p| {
            p.manifest("/scene/rest_pose/rotation_xyzw", json!([0, 0, 0, 0.9]));
        }),
        forged("collider-flat", "an ellipsoid without height", &["value"], |p| {
            p.manifest("/scene/body/colliders/0/shape/ellipsoid/half_axes_m", json!([0.1, 0.1, 0.0]));
        }),
        forged("bound-f32", "an error bound where nothing is lost", &["value"], |p| {
            p.manifest("/field/encoding/max_absolute_error", 0.001);
        }),
        forged("count-steps", "a step fewer than announced", &["count"], |p| p.manifest("/field/n_steps", 3)),
        forged("count-poses", "a pose more than announced", &["count"], |p| p.manifest("/pose/n_poses", 2)),
        forged("count-samples", "samples that were not announced", &["count", "count"], |p| {
            p.manifest("/samples", json!(null));
        }),
    ]
}

fn edits() -> Vec<Case> {
    vec![
        forged("edit-id", "two layers of one id", &["duplicate-id"], |p| {
            p.json(EDITS, |e| {
                let layer = e["layers"][0].clone();
                e["layers"].as_array_mut().unwrap().push(layer);
            });
        }),
        forged("edit-span", "a layer that ends before it begins", &["value"], |p| {
            p.json(EDITS, |e| e["layers"][0]["last_secs"] = json!(0.01));
        }),
        forged("edit-ease", "a layer that falls before it has risen", &["value"], |p| {
            p.json(EDITS, |e| e["layers"][0]["rise"] = json!(0.8));
        }),
        forged("edit-reach", "a handle without reach", &["json-schema"], |p| {
            p.json(EDITS, |e| e["layers"][0]["handles"][0]["reach_m"] = json!(0));
        }),
        forged("edit-kind", "a layer of a kind that version 1 does not have", &["json-schema"], |p| {
            p.json(EDITS, |e| e["layers"][0]["origin"]["kind"] = json!("brush"));
        }),
        forged("edit-feature", "a calm, and no word of the feature that it needs", &["requires"], |p| {
            p.json(EDITS, |e| e["layers"][0]["origin"] = json!({ "kind": "wind", "action": "calm" }));
        }),
        forged("edit-scale", "wind that is less than none", &["json-schema"], |p| {
            p.manifest("/requires", json!(["directing"]));
            p.json(EDITS, |e| e["layers"][0]["reshape"] = json!({ "turn": [0, 0, 0], "scale": -1 }));
        }),
    ]
}

/// Wrong previews are warned of; the field is sound.
fn previews() -> Vec<Case> {
    vec![
        forged_preview("preview-time", "a preview of another time", &["preview"], |p| {
            p.message(PREVIEW_WIND, 1).log_time += 5;
        }),
        forged_preview("preview-payload", "a preview that is no protobuf", &["preview"], |p| {
            p.message(PREVIEW_HEAD, 0).payload = vec![0xff; 9];
        }),
        forged_preview("preview-cut", "points that end within one", &["preview"], |p| {
            // Its last field is the data: one byte less of it, and its length says so.
            let payload = &mut p.message(PREVIEW_WIND, 0).payload;
            payload.pop();
            let length = payload.len() - 4 * 6 * 16 + 1;
            assert_eq!(payload[length - 2], 0x80, "the low seven bits of 384");
            (payload[length - 2], payload[length - 1]) = (0xff, 2);
        }),
        forged_preview("preview-schema", "a preview's topic with another schema", &["skipped"], |p| {
            p.channels.retain_mut(|(id, schema, ..)| {
                if *id == PREVIEW_HEAD {
                    *schema = PREVIEW_WIND;
                }
                true
            });
        }),
    ]
}

fn poses() -> Vec<Case> {
    vec![
        forged("pose-rotation", "a quaternion of length 0.9", &["rotation"], |p| {
            p.proto(POSE, 1, |m| {
                for (axis, value) in [("x", 0.0), ("y", 0.0), ("z", 0.0), ("w", 0.9)] {
                    set(m, &format!("rotation.{axis}"), Proto::F64(value));
                }
            });
        }),
        forged("pose-nan", "a head that is nowhere", &["not-finite"], |p| {
            p.proto(POSE, 1, |m| set(m, "translation_m.y", Proto::F64(f64::NAN)));
        }),
        forged("pose-index", "a pose that counts otherwise", &["order"], |p| {
            p.proto(POSE, 1, |m| set(m, "index", Proto::U64(7)));
        }),
        forged("pose-time", "a pose at another time than its step", &["time"], |p| {
            let piece = p.message(POSE, 1);
            piece.log_time += 1000;
            piece.publish_time += 1000;
            p.proto(POSE, 1, |m| set(m, "time_ns", Proto::U64(8_334_333)));
        }),
        forged("pose-time-ns", "a pose whose time is not its message's", &["time"], |p| {
            p.proto(POSE, 1, |m| set(m, "time_ns", Proto::U64(1)));
        }),
        forged("pose-empty", "a payload of no bytes", &["rotation"], |p| p.message(POSE, 1).payload.clear()),
        forged("protobuf-garbage", "bytes that are no protobuf", &["protobuf"], |p| {
            p.message(POSE, 1).payload = vec![0xff; 20];
        }),
        forged(
            "protobuf-garbage-that-decodes",
            "bytes that decoders take for an empty message",
            &["unknown-field"],
            |p| {
                p.message(POSE, 1).payload = [&[0x7a, 9][..], b"not wind."].concat();
            },
        ),
        forged("protobuf-unknown-field", "a field of another version", &["unknown-field"], |p| {
            p.message(POSE, 1).payload.extend([0x28, 1]);
        }),
        forged("protobuf-unknown-within", "an unknown field within a field", &["unknown-field"], |p| {
            p.message(POSE, 0).payload = [&[0x1a, 2, 0x28, 7][..], &p.message(POSE, 0).payload].concat();
        }),
        forged("protobuf-twice", "a field that is there twice", &["protobuf"], |p| {
            p.message(POSE, 1).payload.extend([0x08, 1]);
        }),
    ]
}

fn samples() -> Vec<Case> {
    vec![
        forged("samples-size", "a marker without a lock", &["size"], |p| {
            p.proto(SAMPLES, 1, |m| set(m, "strand_idx", Proto::List(vec![Proto::U32(2)])));
        }),
        forged("samples-column", "positions for fewer samples", &["size"], |p| {
            p.proto(SAMPLES, 1, |m| {
                let mut data = bytes(m, "position_m.data");
                data.truncate(12);
                set(m, "position_m.data", Proto::Bytes(data.into()));
            });
        }),
        forged("samples-nan", "a vector that is not a number", &["not-finite"], |p| {
            p.proto(SAMPLES, 1, |m| put_float(m, "value", 3, f32::NAN));
        }),
        forged("covariance-negative", "a variance below 0", &["covariance"], |p| {
            p.proto(SAMPLES, 1, |m| put_float(m, "covariance", 3, -0.5));
        }),
        forged("covariance-impossible", "a correlation above 1", &["covariance"], |p| {
            p.proto(SAMPLES, 1, |m| put_float(m, "covariance", 7, 2.0));
        }),
        forged("flag-samples", "a sample in a voxel that is not flagged", &["flag-samples"], |p| {
            p.proto(FIELD, 1, |m| {
                let mut flags = bytes(m, "flags");
                flags[0] = 1;
                set(m, "flags", Proto::Bytes(flags.into()));
            });
        }),
    ]
}

fn steps() -> Vec<Case> {
    vec![
        forged("step-size", "a step of fewer voxels than the grid", &["size"], |p| {
            p.proto(FIELD, 1, |m| {
                let mut data = bytes(m, "u.data");
                data.truncate(36);
                set(m, "u.data", Proto::Bytes(data.into()));
            });
        }),
        forged("step-nan", "a vector that is not a number", &["not-finite"], |p| {
            p.proto(FIELD, 1, |m| put_float(m, "u", 5, f32::NAN));
        }),
        forged("step-infinite", "an infinite vector", &["not-finite"], |p| {
            p.proto(FIELD, 1, |m| put_float(m, "u", 11, f32::NEG_INFINITY));
        }),
        forged("outside-infinite", "an infinite wind outside", &["not-finite"], |p| {
            p.proto(FIELD, 0, |m| set(m, "outside.x", Proto::F64(f64::INFINITY)));
        }),
        forged("flags-size", "a flag too few", &["size"], |p| {
            p.proto(FIELD, 1, |m| set(m, "flags", Proto::Bytes(vec![2, 1, 1].into())));
        }),
        forged("flag", "a flag that means nothing", &["flag"], |p| {
            p.proto(FIELD, 1, |m| set(m, "flags", Proto::Bytes(vec![2, 1, 1, 3].into())));
        }),
        forged("sd-negative", "a standard deviation below 0", &["value"], |p| {
            p.proto(FIELD, 1, |m| put_float(m, "sd", 2, -0.1));
        }),
        forged("sd-nan", "a standard deviation that is not a number", &["value"], |p| {
            p.proto(FIELD, 1, |m| put_float(m, "sd", 2, f32::NAN));
        }),
        forged("step-many-wrong", "three things wrong in one step", &["not-finite", "flag", "value"], |p| {
            p.proto(FIELD, 1, |m| {
                put_float(m, "u", 5, f32::NAN);
                put_float(m, "sd", 2, -0.1);
                set(m, "flags", Proto::Bytes(vec![2, 1, 1, 9].into()));
            });
        }),
        forged("step-index", "a step that counts otherwise", &["order"], |p| {
            p.proto(FIELD, 1, |m| set(m, "index", Proto::U64(2)));
        }),
        forged("step-time", "a step at another time", &["time"], |p| {
            let piece = p.message(FIELD, 1);
            piece.log_time = 40_000_000;
            piece.publish_time = 40_000_000;
            p.proto(FIELD, 1, |m| set(m, "time_ns", Proto::U64(40_000_000)));
        }),
        forged("attachment-twice", "two attachments of one name", &["duplicate-id"], |p| {
            p.attachments.push(("session.json".into(), "text/plain".into(), b"other".to_vec()));
        }),
    ]
}

fn packing() -> Vec<Case> {
    const FIXED: Encoding = Encoding::Fixed { max_error: 1e-3 };
    vec![
        forged("encoding-unknown", "an encoding that version 1 does not have", &["encoding"], |p| {
            p.proto(FIELD, 1, |m| set(m, "u.encoding", Proto::EnumNumber(5)));
        }),
        forged("encoding-none", "no encoding", &["encoding"], |p| {
            p.proto(FIELD, 1, |m| set(m, "u.encoding", Proto::EnumNumber(0)));
        }),
        forged_from(
            Encoding::F16,
            "encoding-other",
            "half precision where single is announced",
            &["encoding"; 2],
            |p| {
                p.manifest(
                    "/field/encoding",
                    json!({"kind": "f32", "max_absolute_error": 0, "max_relative_error": 0}),
                );
            },
        ),
        forged(
            "encoding-sd-f16",
            "half precision of what is known, where single is announced",
            &["encoding"],
            |p| {
                p.proto(FIELD, 1, |m| {
                    set(m, "sd.data", Proto::Bytes(vec![0; 8].into()));
                    set(m, "sd.encoding", Proto::EnumNumber(2));
                });
            },
        ),
        forged_from(FIXED, "encoding-sd-fixed", "multiples of what is known", &["encoding"], |p| {
            p.proto(FIELD, 1, |m| {
                set(m, "sd.data", Proto::Bytes(vec![0; 8].into()));
                set(m, "sd.encoding", Proto::EnumNumber(3));
                set(m, "sd.quantum", Proto::F64(0.0005));
            });
        }),
        forged("encoding-samples", "places in half precision", &["encoding"], |p| {
            p.proto(SAMPLES, 1, |m| {
                set(m, "position_m.data", Proto::Bytes(vec![0; 12].into()));
                set(m, "position_m.encoding", Proto::EnumNumber(2));
            });
        }),
        forged("quantum-needless", "steps of numbers that have none", &["encoding"], |p| {
            p.proto(FIELD, 1, |m| set(m, "u.quantum", Proto::F64(f64::NAN)));
        }),
        forged_from(
            FIXED,
            "quantum-coarse",
            "steps coarser than the error bound allows",
            &["encoding"],
            |p| {
                p.proto(FIELD, 1, |m| set(m, "u.quantum", Proto::F64(0.0021)));
            },
        ),
        forged_from(FIXED, "quantum-zero", "steps of 0", &["encoding"], |p| {
            p.proto(FIELD, 1, |m| set(m, "u.quantum", Proto::F64(0.0)));
        }),
        forged_from(FIXED, "quantum-nan", "steps that are not a number", &["encoding"], |p| {
            p.proto(FIELD, 1, |m| set(m, "u.quantum", Proto::F64(f64::NAN)));
        }),
    ]
}
