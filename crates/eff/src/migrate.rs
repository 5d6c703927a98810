use crate::manifest::Manifest;
use crate::scan::{Findings, Listener, scan};
use crate::{EffError, Loss, Recovery, VERSION, WriteReport, recover};
use serde::Serialize;
use std::io::{Read, Seek, SeekFrom, Write};
use tousle_core::Progress;

/// What a migration did.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Migration {
    /// The version the file had.
    pub from: u32,
    /// The version it has now.
    pub to: u32,
    /// What could not be copied.
    pub losses: Vec<Loss>,
    /// What was written.
    pub written: WriteReport,
}

impl Migration {
    /// Whether all that the old file held is in the new one.
    pub fn is_complete(&self) -> bool {
        self.losses.is_empty()
    }
}

/// Writes a sound file of any version again in the newest one. Packed numbers are copied, so the field is what it was,
/// and so is what other programs put into the file; what cannot be copied is named, as by [`recover()`]. Previews are
/// made anew.
///
/// # Errors
/// [`EffError::Unsound`] if the file is not sound: then [`recover()`] is what is wanted;
/// [`EffError::Io`] if a stream fails.
pub fn migrate<R: Read + Seek, W: Write>(
    mut input: R,
    out: W,
    progress: &dyn Progress,
) -> Result<Migration, EffError> {
    let mut version = Version(VERSION);
    let mut findings = Findings::first_error();
    input.seek(SeekFrom::Start(0))?;
    scan(&mut input, &mut version, &mut findings)?;
    if let Some(finding) = findings.into_first_error() {
        return Err(Box::new(finding).into());
    }
    // Of a sound file everything is recovered, and what is written is always of the newest version.
    let Recovery { losses, written, .. } = recover(input, out, progress)?;
    Ok(Migration { from: version.0, to: VERSION, losses, written })
}

/// Listens for the version only.
struct Version(u32);

impl Listener for Version {
    fn manifest(&mut self, manifest: &Manifest) -> Result<(), EffError> {
        self.0 = manifest.version;
        Ok(())
    }
}
