mod bridge;
mod foreign;
mod inventory;
mod thread;

use crate::array::Encoding;
use crate::finding::Place;
use crate::manifest::{Manifest, SamplesInfo};
use crate::scan::chunk::{InChunk, records_in};
use crate::wire::edits::Edits;
use crate::wire::proto::FieldStep;
use crate::{Code, EffError, VERSION, WriteReport, Writer, decode, record};
pub(crate) use inventory::attachment_at;
use inventory::{Inventory, Place as Where};
use prost::bytes::Bytes;
use serde::Serialize;
use std::borrow::Cow;
use std::io::{Read, Seek, Write};
use tousle_core::Progress;

/// What could be saved of a damaged file, and what could not.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Recovery {
    /// Steps in the new file.
    pub n_steps: u64,
    /// Steps that the damaged file was to have, if it says so.
    pub n_steps_expected: Option<u64>,
    /// The first step of the damaged file that is in the new one; its time is the new file's start.
    pub first_step: u64,
    /// Steps, as the damaged file counted them, that were lost between whole ones and are filled linearly in
    /// time, as sampling would have it. None of their voxels is flagged as measured.
    pub bridged: Vec<u64>,
    /// What was lost, or is not as it was, in the file's order.
    pub losses: Vec<Loss>,
    /// What was written.
    pub written: WriteReport,
}

/// Something that could not be saved.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Loss {
    /// What.
    pub what: String,
    /// Why, or what stands for it.
    pub why: String,
}

impl Recovery {
    /// Whether all that the damaged file held is in the new one.
    pub fn is_complete(&self) -> bool {
        self.losses.is_empty()
    }
}

/// Writes a sound file of all that is whole in a damaged one: cut, or hit in the middle.
///
/// The packed numbers of whole steps are copied as they are, so nothing is lost twice. One step at a time is in
/// memory. Previews, if there are channels of any, are made anew. A file that is whole is written again, with what
/// other programs put into it: their topics, metadata and private records. Of what has its place in messages and
/// channels of the format (fields from number 1000 on, metadata of channels) all that is left out is named.
///
/// # Errors
/// [`EffError::Unsound`] if there is no sound manifest or no whole step, so that nothing can be saved;
/// [`EffError::Io`] if a stream fails.
pub fn recover<R: Read + Seek, W: Write>(
    mut input: R,
    out: W,
    progress: &dyn Progress,
) -> Result<Recovery, EffError> {
    let mut found = Inventory::take(&mut input)?;
    let Some(old) = found.manifest.take() else {
        return Err(nothing(&found, "manifest", "a sound manifest"));
    };
    let Some((first, last)) = bridge::plan(&mut found) else {
        return Err(nothing(&found, "steps of the field", "at least one whole"));
    };
    let poses = bridge::poses(&mut found, &old);
    let manifest = new_manifest(&old, &found, first, last, poses.len() as u64);
    let edits = found.edits.take().unwrap_or(Edits { layers: Vec::new() });
    let mut writer = Writer::begin(out, manifest, &edits, &poses, found.has_preview)?;
    for &offset in &found.attachments {
        let (attachment, times) = attachment_at(&mut input, offset)?;
        writer.dated_attachment(&attachment, times)?;
    }
    let n_steps = last - first + 1;
    let mut bridged = Vec::new();
    for k in first..=last {
        progress.at(k - first, n_steps);
        writer.samples_before(k - first, |j| match found.samples.get(&j) {
            Some(place) => samples(&mut input, *place).map(Cow::Owned),
            None => Ok(Cow::Borrowed(&[])),
        })?;
        if let Some(place) = found.steps.get(&k) {
            writer.packed_step(packed_step(&mut input, &old, *place)?)?;
        } else {
            let step = bridge::step(&found, k, &old, |place| packed_step(&mut input, &old, place))?;
            writer.step_as(&step, Encoding::F32)?;
            bridged.push(k);
        }
    }
    found.foreign.copy(&mut input, &mut writer)?;
    progress.at(n_steps, n_steps);
    let (written, _) = writer.finish()?;
    Ok(Recovery {
        n_steps,
        n_steps_expected: old.field.n_steps,
        first_step: first,
        bridged,
        losses: found.losses,
        written,
    })
}

/// The manifest of what is left.
fn new_manifest(old: &Manifest, found: &Inventory, first: u64, last: u64, n_poses: u64) -> Manifest {
    let mut manifest = old.clone();
    manifest.version = VERSION;
    manifest.field.start_secs = old.field.step_secs(first);
    manifest.field.n_steps = Some(last - first + 1);
    manifest.pose.n_poses = n_poses;
    manifest.samples = old.samples.map(|info| SamplesInfo { n_steps: found.n_samples(), ..info });
    manifest
}

/// There is nothing to save; the first loss says why.
fn nothing(found: &Inventory, what: &str, expected: &str) -> EffError {
    let why = found.losses.first().map_or_else(String::new, |loss| format!(" ({}: {})", loss.what, loss.why));
    Place::default().finding(Code::Missing, what, format!("none{why}"), expected).into()
}

/// The message at a place.
fn message<R: Read + Seek, T>(
    input: &mut R,
    at: Where,
    take: impl FnOnce(&[u8], Place<'_>) -> Result<T, EffError>,
) -> Result<T, EffError> {
    let unpacked = inventory::content(input, at.record)?;
    let place = crate::scan::at(at.record.0);
    let body =
        records_in(&unpacked).flatten().find(|r| r.offset == at.within).map(|InChunk { body, .. }| body);
    match body.map(|body| record::parse(record::op::MESSAGE, body)) {
        Some(Ok(record::Record::Message(message))) => take(message.data, place),
        // It was there a moment ago: somebody writes to the file.
        _ => Err(place.finding(Code::Record, "message", "another", "the one that was there before").into()),
    }
}

fn packed_step<R: Read + Seek>(input: &mut R, old: &Manifest, at: Where) -> Result<FieldStep, EffError> {
    message(input, at, |payload, place| Ok(decode::packed_step(Bytes::copy_from_slice(payload), old, place)?))
}

fn samples<R: Read + Seek>(input: &mut R, at: Where) -> Result<Vec<tousle_core::WindSample>, EffError> {
    message(input, at, |payload, place| Ok(decode::samples(payload, place)?.1))
}
