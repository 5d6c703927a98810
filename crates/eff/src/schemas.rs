//! Keeps `schemas/` true: what is there is what the types here say, and what travels in every file.
//!
//! `TOUSLE_UPDATE=1 cargo test -p tousle-eff schemas` writes them anew.

use crate::wire::{edits::Edits, manifest::Manifest, v0::ManifestV0};
use prost::Message as _;
use serde::Serialize as _;
use std::path::PathBuf;

fn schemas() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../schemas")
}

/// Compares a file in `schemas/` with what it should be, or writes it.
fn check(name: &str, expected: &[u8]) {
    let path = schemas().join(name);
    if std::env::var_os("TOUSLE_UPDATE").is_some() {
        std::fs::write(&path, expected).unwrap();
    }
    let found = std::fs::read(&path).unwrap();
    assert!(found == expected, "{name} is not current: run with TOUSLE_UPDATE=1");
}

fn json_schema<T: schemars::JsonSchema>(id: &str) -> Vec<u8> {
    let mut schema = schemars::schema_for!(T);
    schema.insert("$id".into(), format!("urn:tousle:{id}").into());
    // It travels in every file, twice: one blank is indentation enough.
    let mut text = Vec::new();
    let format = serde_json::ser::PrettyFormatter::with_indent(b" ");
    schema.serialize(&mut serde_json::Serializer::with_formatter(&mut text, format)).unwrap();
    text.push(b'\n');
    text
}

#[test]
fn json_schemas_are_current() {
    check("eff.v1.manifest.json", &json_schema::<Manifest>("eff.v1.manifest"));
    check("eff.v0.manifest.json", &json_schema::<ManifestV0>("eff.v0.manifest"));
    check("eff.v1.edits.json", &json_schema::<Edits>("eff.v1.edits"));
}

#[test]
fn descriptors_are_current() {
    for name in ["eff.v0", "eff.v1", "preview"] {
        let mut descriptors = protox::compile([format!("{name}.proto")], [schemas()]).unwrap();
        for file in &mut descriptors.file {
            file.source_code_info = None;
        }
        check(&format!("{name}.binpb"), &descriptors.encode_to_vec());
    }
}
