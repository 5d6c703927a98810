use crate::wire::edits::Edits;
use crate::writer::head;
use crate::{EffError, Reader, VERSION, WriteReport, Writer};
use std::borrow::Cow;
use std::io::{Read, Seek, Write};
use tousle_core::Progress;
use tousle_field::FieldLayer;

/// Writes a field file again with other edits.
///
/// The packed numbers are copied as they are: however often a field is edited, its voxels stay what they were.
/// One step at a time is in memory. Previews, if there are any, are made anew.
///
/// # Errors
/// [`EffError::Unsound`] if something that is copied is not sound, [`EffError::BadValue`] if a layer cannot be,
/// [`EffError::Io`] if a stream fails.
pub fn replace_layers<R: Read + Seek, W: Write>(
    input: R,
    layers: &[FieldLayer],
    out: W,
    progress: &dyn Progress,
) -> Result<WriteReport, EffError> {
    let mut reader = Reader::open(input)?;
    let mut manifest = reader.manifest().clone();
    manifest.version = VERSION;
    manifest.field.n_steps = Some(reader.n_steps());
    let edits = Edits { layers: layers.iter().map(Into::into).collect() };
    head::check(&manifest, &edits)?;
    let mut writer = Writer::begin(out, manifest, &edits, &reader.poses()?, reader.has_preview())?;
    for attachment in reader.attachments()? {
        writer.attachment(&attachment)?;
    }
    let samples = reader.samples()?;
    let n_steps = reader.n_steps();
    for k in 0..n_steps {
        progress.at(k, n_steps);
        writer.samples_before(k, |j| Ok::<_, EffError>(Cow::Borrowed(&samples[j as usize])))?;
        writer.packed_step(reader.packed_step(k)?)?;
    }
    progress.at(n_steps, n_steps);
    writer.finish().map(|(report, _)| report)
}
