//! One module a command; each is a short list of calls.

pub mod bench;
pub mod convert;
pub mod demo;
pub mod edit;
pub mod export;
pub mod import;
pub mod inspect;
pub mod merge;
pub mod migrate;
mod output;
pub mod quality;
pub mod recover;
pub mod simulate;
pub mod studio;
pub mod validate;

use crate::args::{EncodingArg, GroomArgs, PackArgs, ReadArgs};
use anyhow::{Context, anyhow};
use output::{check_output, check_outputs, ending};
use serde::Serialize;
use std::fmt::Display;
use std::fs::File;
use std::io::Seek;
use std::path::Path;
use tousle_core::Groom;
use tousle_eff::{Code, Eff, EffError, Encoding, Loss, ReadOptions, WriteOptions, WriteReport};
use tousle_field::{GridSpec, Scene};
use tousle_groom::{GroomOptions, GroomReadError, HeadShape, Placement, ReadGroom};
use tousle_ingest::IngestOptions;
use tousle_pipeline::{Outputs, Watch, read_file};

/// The name of a file, for messages.
fn name(path: &Path) -> String {
    path.display().to_string()
}

/// So many of something, for people: `1 pose`, `2 poses`.
fn counted<N: Copy + Display + PartialEq + From<u8>>(n: N, what: &str) -> String {
    let plural = if n == N::from(1) { "" } else { "s" };
    format!("{n} {what}{plural}")
}

/// Refuses an option that was given and does nothing, as it needs another one beside it. `why`: what it is for.
fn only_with(needs: &str, why: &str, options: &[(&str, bool)]) -> anyhow::Result<()> {
    if let Some((option, _)) = options.iter().find(|(_, is_given)| *is_given) {
        wrong!("{option}: found without {needs}, expected with it: {why}");
    }
    Ok(())
}

/// What bytes are that other tools take, for programs and in words: `import` takes wind in them.
fn for_other_tools(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    if bytes.starts_with(b" BDV") {
        Some(("vdb", "OpenVDB grids (.vdb)"))
    } else if first_in_zip(bytes).is_some_and(|name| name.ends_with(b".npy")) {
        Some(("npz", "NumPy arrays (.npz)"))
    } else {
        None
    }
}

/// The name of the first file in a zip archive.
fn first_in_zip(bytes: &[u8]) -> Option<&[u8]> {
    let header = bytes.strip_prefix(b"PK\x03\x04")?;
    let n_bytes = u16::from_le_bytes([*header.get(22)?, *header.get(23)?]);
    header.get(26..26 + usize::from(n_bytes))
}

/// Opens a field file of which steps are read in any order.
fn open_field(path: &Path) -> anyhow::Result<File> {
    let mut file = File::open(path).with_context(|| format!("cannot read {}", path.display()))?;
    // A pipe has no place in it.
    file.stream_position().with_context(|| {
        format!(
            "cannot use the field {}: found a pipe, expected a file that can be read in any order",
            path.display()
        )
    })?;
    Ok(file)
}

/// Reads a sound field file.
fn read_eff(path: &Path) -> anyhow::Result<Eff> {
    sound_eff(&read_file(path)?, path)
}

/// The field of a sound field file's bytes.
fn sound_eff(bytes: &[u8], path: &Path) -> anyhow::Result<Eff> {
    tousle_eff::read(bytes, &ReadOptions::default()).map_err(|e| unusable(e, path))
}

/// Why a field file cannot be used.
fn unusable(error: EffError, path: &Path) -> anyhow::Error {
    let saved = if is_damaged(&error) { ", `tousle recover` saves the whole steps" } else { "" };
    let says =
        format!("cannot use the field {} (`tousle validate` lists all that is wrong{saved})", name(path));
    anyhow!(error).context(says)
}

/// Why a field file cannot be written again: what is wrong with it is said of it, and what keeps the output from being written
/// of that.
fn not_copied(error: EffError, path: &Path) -> anyhow::Error {
    if matches!(error, EffError::Unsound(_)) { unusable(error, path) } else { error.into() }
}

/// Whether a field file was cut off or changed by nobody who writes fields.
fn is_damaged(error: &EffError) -> bool {
    matches!(error, EffError::Unsound(finding) if is_damage(finding.code))
}

/// Whether a finding is of bytes that were sound once.
fn is_damage(code: Code) -> bool {
    use Code::{AttachmentCrc, ChunkCrc, Compression, Cut, DataCrc, Record, SummaryCrc};
    matches!(code, AttachmentCrc | ChunkCrc | Compression | Cut | DataCrc | Record | SummaryCrc)
}

/// Says on stderr what is not in a field that was written again.
fn say_losses(losses: &[Loss]) {
    for loss in losses {
        note!("loss: {}: {}", loss.what, loss.why);
    }
}

/// Reads a groom; what it leaves out or changes is said on stderr.
fn read_groom(path: &Path, args: &GroomArgs, scene: &Scene, grid: &GridSpec) -> anyhow::Result<Groom> {
    Ok(read_groom_and_numbers(path, args, scene, grid)?.groom)
}

/// The same with the numbers that its strands have in the file.
fn read_groom_and_numbers(
    path: &Path,
    args: &GroomArgs,
    scene: &Scene,
    grid: &GridSpec,
) -> anyhow::Result<ReadGroom> {
    let mut options = GroomOptions::default();
    options.unit = args.groom_unit;
    options.up_axis = args.groom_up;
    options.forward = args.groom_forward;
    if args.fit_to_head {
        if args.groom_unit.is_some() {
            note!(
                "warning: --groom-unit does nothing beside --fit-to-head, which finds the scale whatever the unit"
            );
        }
        let head = HeadShape::of_body(&scene.body);
        options.placement = Placement::FitToHead(
            head.context("the field's body has no ellipsoid for a head to fit the groom to")?,
        );
    }
    let read = tousle_groom::read_groom(&read_file(path)?, &options).map_err(|error| {
        let hint = groom_hint(&error);
        anyhow!(error).context(format!("cannot use the groom {}{hint}", path.display()))
    })?;
    for warning in &read.warnings {
        note!("warning: {}: {warning}", path.display());
    }
    let roots = read.groom.strands.iter().map(|s| s.rest_curve_m[0]);
    if !roots.into_iter().any(|root| grid.contains(root)) {
        note!(
            "warning: {}: no root lies in the field's box about the head: --groom-unit, --groom-up or --fit-to-head \
             may be what is missing",
            path.display()
        );
    }
    Ok(read)
}

/// The options with which a groom that could not be used perhaps can.
fn groom_hint(error: &GroomReadError) -> &'static str {
    match error {
        GroomReadError::NotStated { what: "up axis", .. } => {
            " (--groom-up says which axis of the file is up)"
        }
        GroomReadError::NotStated { .. } => {
            " (--groom-unit says the file's unit, --fit-to-head does without)"
        }
        GroomReadError::Placement { .. } => {
            " (without --fit-to-head it stays where its file has it, in the file's unit or that of --groom-unit)"
        }
        _ => "",
    }
}

/// How a marker file is read, as the command line has it.
fn read_options(args: &ReadArgs) -> IngestOptions {
    IngestOptions {
        // Whoever gives a unit has looked at the numbers: it counts whatever the file says of itself.
        unit_override: args.unit,
        subject: args.subject.clone(),
        allow_cut: args.allow_cut,
        ..IngestOptions::default()
    }
}

/// Writes a field file, whole or not at all.
fn write_eff(
    eff: &Eff,
    path: &Path,
    options: &WriteOptions,
    watch: &dyn Watch,
) -> anyhow::Result<WriteReport> {
    let mut outputs = Outputs::default();
    let written = add_eff(&mut outputs, eff, path, options, watch)?;
    outputs.appear()?;
    Ok(written)
}

/// Writes a field file that appears together with others.
fn add_eff(
    outputs: &mut Outputs,
    eff: &Eff,
    path: &Path,
    options: &WriteOptions,
    watch: &dyn Watch,
) -> anyhow::Result<WriteReport> {
    let stage = watch.stage("write");
    Ok(outputs.add(path, |out| tousle_eff::write(eff, out, options, &*stage))?)
}

/// How a field is packed, as the command line has it.
fn write_options(args: &PackArgs) -> anyhow::Result<WriteOptions> {
    let encoding = match (args.encoding, args.max_error) {
        (EncodingArg::Fixed, Some(max_error)) if max_error.is_finite() && max_error > 0.0 => {
            Encoding::Fixed { max_error }
        }
        (EncodingArg::Fixed, Some(max_error)) => {
            wrong!("--max-error: found {max_error}, expected a number above 0")
        }
        (EncodingArg::Fixed, None) => wrong!("--encoding fixed: found no --max-error, expected one"),
        (EncodingArg::F32, Some(_)) => wrong!("--max-error: found encoding f32, expected fixed"),
        (EncodingArg::F16, Some(_)) => wrong!("--max-error: found encoding f16, expected fixed"),
        (EncodingArg::F32, None) => Encoding::F32,
        (EncodingArg::F16, None) => Encoding::F16,
    };
    let options = WriteOptions::with_encoding(encoding);
    Ok(if args.preview { options.with_preview() } else { options })
}

/// Prints a value as JSON on stdout.
fn print_json(value: &impl Serialize) -> anyhow::Result<()> {
    sayln!("{}", serde_json::to_string_pretty(value).context("cannot write the report as JSON")?);
    Ok(())
}
