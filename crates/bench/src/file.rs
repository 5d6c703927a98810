//! What a field costs in a file: each way to pack it, beside `.npz` and `.vdb` of the same numbers.

use crate::clock::least_secs;
use crate::{Cell, Report, Section, Table};
use std::io::Cursor;
use tousle_core::NoProgress;
use tousle_eff::{Eff, EffError, Encoding, ReadOptions, Reader, WriteOptions, read, validate, write};
use tousle_export::{
    ExportError, NpzError, VdbError, VdbOptions, join_steps_vdb, read_field_npz, read_step_vdb,
    write_field_npz, write_step_vdb,
};

/// Why a field cannot be measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileBenchError {
    /// As a field file.
    #[error("as .eff.mcap")]
    Eff(#[from] EffError),
    /// As files for others.
    #[error("as .npz or .vdb")]
    Export(#[from] ExportError),
    /// As NumPy's.
    #[error("as .npz")]
    Npz(#[from] NpzError),
    /// As OpenVDB's.
    #[error("as .vdb")]
    Vdb(#[from] VdbError),
}

/// What was found of fields, as [`rows`] puts it into a [`table`].
pub fn report(table: Table) -> Report {
    Report {
        name: "file",
        title: "Fields in files".to_owned(),
        words: "Speeds are in bytes that the steps take in memory, by processor time of one thread, from and to memory."
            .to_owned(),
        sections: vec![Section {
            name: "file".to_owned(),
            tables: vec![(String::new(), table)],
            ..Section::default()
        }],
        json: None,
    }
}

/// A table with nothing in it: one row a field and a way to write it.
pub fn table() -> Table {
    Table::new(
        "A field in a file",
        &[
            "field",
            "written as",
            "bytes",
            "share of raw",
            "largest error",
            "write MB/s",
            "read MB/s",
            "validate MB/s",
            "validate / read time",
            "one step ms",
        ],
    )
}

/// The rows of one field.
///
/// # Errors
/// [`FileBenchError`] if it cannot be written or read in one of the ways.
pub fn rows(name: &str, eff: &Eff, table: &mut Table) -> Result<(), FileBenchError> {
    for (how, encoding) in [
        ("eff f32", Encoding::F32),
        ("eff f16", Encoding::F16),
        ("eff fixed 1e-3", Encoding::Fixed { max_error: 1e-3 }),
        ("eff fixed 1e-2", Encoding::Fixed { max_error: 1e-2 }),
    ] {
        table.push(packed(name, how, eff, encoding)?);
    }
    table.push(npz(name, eff)?);
    table.push(vdb(name, eff)?);
    Ok(())
}

/// What the steps take in memory, bytes.
fn raw(eff: &Eff) -> f64 {
    let of = |s: &tousle_field::Field| 4 * s.u.len() + s.flags.len() + 4 * s.sd.as_ref().map_or(0, Vec::len);
    eff.field.steps.iter().map(of).sum::<usize>() as f64
}

fn packed(name: &str, how: &str, eff: &Eff, encoding: Encoding) -> Result<Vec<Cell>, FileBenchError> {
    // The field alone, as the others have it: no samples, no attachments.
    let eff = Eff { samples: None, attachments: Vec::new(), ..eff.clone() };
    let options = WriteOptions::with_encoding(encoding);
    let mut bytes = Vec::new();
    let mut max_error = 0.0;
    let written = least_secs(|| {
        bytes.clear();
        max_error = write(&eff, &mut bytes, &options, &NoProgress)?.max_error;
        Ok::<_, EffError>(())
    })?;
    let read_in = least_secs(|| read(&bytes[..], &ReadOptions::default()).map(drop))?;
    let validated = least_secs(|| validate(&bytes[..]).map(drop))?;
    let mut reader = Reader::open(Cursor::new(&bytes))?;
    let n_steps = reader.n_steps();
    // Steps far from one another, so that none is at hand from the one before.
    let n_picked = 20;
    let step = least_secs(|| (0..n_picked).try_for_each(|k| reader.step(k * 7919 % n_steps).map(drop)))?
        / n_picked as f64;
    let mut row = row(name, how, &eff, bytes.len(), max_error, written, read_in);
    row.extend([
        Cell::number(raw(&eff) / 1e6 / validated, 0),
        Cell::number(validated / read_in, 2),
        Cell::number(step * 1e3, 2),
    ]);
    Ok(row)
}

fn npz(name: &str, eff: &Eff) -> Result<Vec<Cell>, FileBenchError> {
    let mut out = Cursor::new(Vec::new());
    let written = least_secs(|| {
        out = Cursor::new(Vec::new());
        write_field_npz(&eff.field, &mut out)
    })?;
    let bytes = out.into_inner();
    let read_in = least_secs(|| read_field_npz(&bytes).map(drop))?;
    Ok(unvalidated(row(name, "npz (deflate)", eff, bytes.len(), 0.0, written, read_in), None))
}

fn vdb(name: &str, eff: &Eff) -> Result<Vec<Cell>, FileBenchError> {
    let mut files = Vec::new();
    let written = least_secs(|| {
        files.clear();
        for step in 0..eff.field.steps.len() {
            let mut bytes = Vec::new();
            write_step_vdb(&eff.field, step, &mut bytes)?;
            files.push(bytes);
        }
        Ok::<_, ExportError>(())
    })?;
    let options = VdbOptions::default();
    let read_in = least_secs(|| {
        let steps: Result<Vec<_>, _> = files.iter().map(|bytes| read_step_vdb(bytes, &options)).collect();
        join_steps_vdb(&steps?, &options).map(drop)
    })?;
    // One is too quick for the clock of processors.
    let n_picked = files.len().min(20);
    let step =
        least_secs(|| files[..n_picked].iter().try_for_each(|file| read_step_vdb(file, &options).map(drop)))?
            / n_picked as f64;
    let n_bytes = files.iter().map(Vec::len).sum();
    Ok(unvalidated(
        row(name, "vdb (zip), a file a step", eff, n_bytes, 0.0, written, read_in),
        Some(step * 1e3),
    ))
}

fn unvalidated(mut row: Vec<Cell>, step_ms: Option<f64>) -> Vec<Cell> {
    row.extend([Cell::Missing, Cell::Missing, Cell::maybe(step_ms, 2)]);
    row
}

fn row(
    name: &str,
    how: &str,
    eff: &Eff,
    n_bytes: usize,
    error: f64,
    write_secs: f64,
    read_secs: f64,
) -> Vec<Cell> {
    let raw = raw(eff);
    vec![
        Cell::text(name),
        Cell::text(how),
        Cell::number(n_bytes as f64, 0),
        Cell::number(n_bytes as f64 / raw, 3),
        Cell::number(error, 6),
        Cell::number(raw / 1e6 / write_secs, 0),
        Cell::number(raw / 1e6 / read_secs, 0),
    ]
}
