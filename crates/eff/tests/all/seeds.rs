//! Small files for the fuzz targets to begin with, in `fuzz/seeds/eff`.
//!
//! Their schemas have no text, which is a warning only: nine in ten bytes of a file this small would be schemas, and
//! mutations would hit little else. `TOUSLE_UPDATE=1 cargo test -p tousle-eff --test all seeds` writes them anew.

use crate::arbitrary::tiny_file;
use crate::exercise;
use crate::forge::{Pieces, pieces};
use std::fs;
use std::path::{Path, PathBuf};
use tousle_eff::Encoding;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds/eff")
}

/// A file without the text of its schemas, its chunks unpacked.
fn bare(mut pieces: Pieces) -> Vec<u8> {
    pieces.schemas.iter_mut().for_each(|(_, _, _, text)| text.clear());
    pieces.options = pieces.options.clone().compression(None);
    pieces.forge()
}

/// A file with two attachments of one name, both of which recovery once kept.
fn attachment_twice() -> Vec<u8> {
    let mut pieces = pieces(&tiny_file(Encoding::F32));
    pieces.attachments.push(("session.json".into(), "text/plain".into(), b"other".to_vec()));
    bare(pieces)
}

fn keep(name: &str, bytes: &[u8]) {
    if std::env::var_os("TOUSLE_UPDATE").is_some() {
        fs::create_dir_all(folder()).unwrap();
        fs::write(folder().join(name), bytes).unwrap();
    }
}

#[test]
fn every_target_takes_the_seeds_and_all_but_one_are_sound() {
    let mut seeds = vec![
        ("plain", bare(pieces(&tiny_file(Encoding::F32)))),
        ("f16", bare(pieces(&tiny_file(Encoding::F16)))),
        ("fixed16", bare(pieces(&tiny_file(Encoding::Fixed { max_error: 1e-3 })))),
        ("fixed32", bare(pieces(&tiny_file(Encoding::Fixed { max_error: 2e-6 })))),
        ("zstd", tiny_file(Encoding::F32)),
    ];
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/eff");
    let old = fs::read(fixtures.join("v0/good/tiny.eff.mcap")).unwrap();
    seeds.push(("v0", bare(pieces(&old))));
    for (name, mut bytes) in seeds {
        keep(name, &bytes);
        let before = bytes.clone();
        exercise::refit(&mut bytes);
        assert!(bytes == before, "{name}: its checksums were right");
        assert!(exercise::all_agree(&bytes), "{name}");
        exercise::read_in_parts(&bytes);
    }
    keep("attachment-twice", &attachment_twice());
    let kept = fs::read(folder().join("attachment-twice")).unwrap();
    assert!(kept == attachment_twice() && !exercise::all_agree(&kept));
    for entry in fs::read_dir(folder()).unwrap() {
        let bytes = fs::read(entry.unwrap().path()).unwrap();
        exercise::all_agree(&bytes);
        exercise::read_in_parts(&bytes);
    }
}
