//! What the tests over the whole workspace share: the demo's capture, and the captures a stranger does not have.

use std::path::{Path, PathBuf};

/// The demo's capture: `gusts.c3d`.
pub const CAPTURE: &[u8] = include_bytes!("../../fixtures/demo/gusts.c3d");
/// Its session.
pub const SESSION: &[u8] = include_bytes!("../../fixtures/demo/session.json");
/// Another hairstyle.
pub const GROOM: &[u8] = include_bytes!("../../fixtures/demo/bob.json");

/// The folders of captures with truth below `TOUSLE_SHARED`, in order; says aloud if there are none to look at.
pub fn shared_captures() -> Vec<PathBuf> {
    let Some(shared) = std::env::var_os("TOUSLE_SHARED") else {
        println!("skipped: TOUSLE_SHARED is not set");
        return Vec::new();
    };
    let folder = Path::new(&shared).join("captures");
    let entries = std::fs::read_dir(&folder).expect("TOUSLE_SHARED has a folder `captures`");
    let mut captures: Vec<PathBuf> = entries.flatten().map(|e| e.path()).filter(|p| p.is_dir()).collect();
    captures.sort();
    captures
}

/// The last part of a path.
pub fn name(path: &Path) -> String {
    path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default()
}
