//! Files: opening, saving, autosaving, exporting. Nothing else here touches the disk.

use crate::document::{Document, Source};
use anyhow::{Context, bail};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};
use tousle_core::{NoProgress, StrandMotion};
use tousle_eff::ReadOptions;
use tousle_export::UsdOptions;
use tousle_field::{FieldLayer, GridSpec};
use tousle_groom::{GroomOptions, HeadShape, Placement};
use tousle_pipeline::{read_file, write_whole};

/// Which files to open, and how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Files {
    /// The field.
    pub field: PathBuf,
    /// The groom.
    pub groom: PathBuf,
    /// What the groom file does not say.
    pub groom_options: GroomOptions,
    /// Scale and shift the groom so that its roots lie on the field's head.
    pub fit_to_head: bool,
}

/// A document, and what should be said about it.
#[derive(Debug)]
pub struct Opened {
    /// The document.
    pub document: Document,
    /// What was left out, changed or overruled in the groom.
    pub warnings: Vec<String>,
    /// Edits that were not saved when the studio last ended.
    pub unsaved: Option<Vec<FieldLayer>>,
}

/// Opens a field and a groom.
///
/// # Errors
/// If a file cannot be read, is not sound, or holds a groom that needs to be told more.
pub fn open(files: &Files) -> anyhow::Result<Opened> {
    let packed = read_file(&files.field)?;
    let eff = tousle_eff::read(&packed[..], &ReadOptions::default())
        .with_context(|| format!("cannot use the field {}", files.field.display()))?;
    let mut options = files.groom_options;
    if files.fit_to_head {
        let head = HeadShape::of_body(&eff.scene.body);
        let head = head.context("the field's body has no ellipsoid for a head to fit the groom to")?;
        options.placement = Placement::FitToHead(head);
    }
    let read = tousle_groom::read_groom(&read_file(&files.groom)?, &options)
        .with_context(|| format!("cannot use the groom {}", files.groom.display()))?;
    let source = Source {
        field_path: files.field.clone(),
        groom_path: files.groom.clone(),
        strand_numbers: read.numbers,
        packed: packed.into(),
    };
    let document = Document::new(eff.field, eff.scene, read.groom, source);
    let unsaved = read_autosave(&document);
    Ok(Opened { document, warnings: read.warnings, unsaved })
}

/// Writes the field with the stack as its layers, and goes on in that file.
///
/// # Errors
/// If it cannot be written; then what was there before is untouched.
pub fn save(document: &mut Document, path: &Path) -> anyhow::Result<()> {
    check_ending(path, &["mcap"])?;
    let packed = Cursor::new(&document.source.packed[..]);
    write_whole(path, |out| tousle_eff::replace_layers(packed, document.stack(), out, &NoProgress))?;
    discard_autosave(document);
    path.clone_into(&mut document.source.field_path);
    document.mark_saved();
    Ok(())
}

/// Writes a motion in the format that the path's ending names.
///
/// # Errors
/// If the ending is unknown or the file cannot be written.
pub fn export_motion(document: &Document, motion: &StrandMotion, path: &Path) -> anyhow::Result<()> {
    check_ending(path, &["npz", "usda"])?;
    write_whole(path, |out| {
        if ending(path) == "npz" {
            return tousle_export::write_numbered_motion_npz(motion, &document.source.strand_numbers, out);
        }
        let mut options = UsdOptions::default();
        options.scene = Some(&document.scene);
        tousle_export::write_motion_usda(motion, &document.groom, &options, out)
    })?;
    Ok(())
}

/// What an autosave holds: the layers alone, for voxels never change.
#[derive(Serialize, Deserialize)]
struct Autosave<'a> {
    /// The field that the layers belong to: its grid, its first step's time, its rate and its number of steps.
    field: (GridSpec, f64, f64, usize),
    layers: Cow<'a, [FieldLayer]>,
}

impl<'a> Autosave<'a> {
    fn of(document: &'a Document) -> Self {
        let field = &document.field;
        let field = (field.grid, field.start_secs, field.rate_hz, field.steps.len());
        Self { field, layers: document.stack().into() }
    }
}

/// Where the edits of a field that are not saved are kept: beside it.
pub fn autosave_path(field: &Path) -> PathBuf {
    let name = field.file_name().unwrap_or_default().to_string_lossy();
    field.with_file_name(format!(".{name}.autosave.json"))
}

/// Keeps the stack beside the field file, until it is saved.
///
/// # Errors
/// If the file cannot be written.
pub fn autosave(document: &Document) -> anyhow::Result<()> {
    let text = serde_json::to_string(&Autosave::of(document))?;
    write_whole(&autosave_path(&document.source.field_path), |out| out.write_all(text.as_bytes()))?;
    Ok(())
}

/// The edits of this field that were kept and not saved.
fn read_autosave(document: &Document) -> Option<Vec<FieldLayer>> {
    let bytes = read_file(&autosave_path(&document.source.field_path)).ok()?;
    let kept: Autosave<'_> = serde_json::from_slice(&bytes).ok()?;
    let now = Autosave::of(document);
    (kept.field == now.field && kept.layers != now.layers).then(|| kept.layers.into_owned())
}

/// Takes away what [`autosave`] kept.
pub fn discard_autosave(document: &Document) {
    // Where nothing was kept there is nothing to take away.
    let _ = std::fs::remove_file(autosave_path(&document.source.field_path));
}

/// Refuses a file whose ending is none of these.
fn check_ending(path: &Path, endings: &[&str]) -> anyhow::Result<()> {
    if endings.contains(&ending(path).as_str()) {
        return Ok(());
    }
    let list = endings.iter().map(|e| format!(".{e}")).collect::<Vec<_>>().join(" or ");
    bail!("{}: found the ending {:?}, expected {list}", path.display(), ending(path))
}

fn ending(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default()
}
