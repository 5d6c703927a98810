//! CSV as OptiTrack Motive exports it, formats 1.2 to 1.25.
//!
//! A line of metadata in pairs of key and value; then one line each for what a column's thing is (`Type`), its
//! name, its id and, since 1.25, its parent; then `Rotation` or `Position`, then the axis. The first two columns
//! count frames and seconds:
//!
//! ```text
//! Format Version,1.23,Export Frame Rate,120.000000,Length Units,Meters
//!
//! ,Type,Rigid Body,Rigid Body,…,Marker,Marker,Marker
//! ,Name,Head,Head,…,Head:LFHD,Head:LFHD,Head:LFHD
//! ,ID,"38A5…","38A5…",…,"38A6…","38A6…","38A6…"
//! ,,Rotation,Rotation,…,Position,Position,Position
//! Frame,Time (Seconds),X,Y,…,X,Y,Z
//! 0,0.000000,0.1,0.2,…,0.3,0.4,0.5
//! ```
//!
//! Older formats name the type of each *row*; they are recognized and refused.

mod header;

use crate::points::PointReader;
use crate::rows::{Rows, delimiter, is_column_key};
use crate::{CsvError, PointTable};
use header::Header;
use tousle_cells::{Numbers, plain, text, whole};

/// Everything of a Motive CSV that has a position.
#[derive(Clone, Debug, PartialEq)]
pub struct MotiveFile {
    /// The version of the format (`1.23`), if the file says.
    pub format_version: Option<String>,
    /// Frames a second as exported, if the file says.
    pub rate_hz: Option<f64>,
    /// The unit of length as the file names it (`Meters`).
    pub unit: Option<String>,
    /// The positions; each point's `kind` is its column type: `Marker`, `Rigid Body`, `Rigid Body Marker` ….
    pub table: PointTable,
    /// Seconds of each row, where the file gives them.
    pub times_secs: Vec<Option<f64>>,
    /// The names of things with a rotation.
    pub rotations: Vec<String>,
    /// What was odd but could be read.
    pub warnings: Vec<String>,
}

/// Reads every position of a Motive CSV.
///
/// # Errors
/// [`CsvError`] if the file is row-typed (before 1.2), has no line `Frame,Time…`, or if a cell of a position
/// holds anything but a number.
pub fn read(bytes: &[u8]) -> Result<MotiveFile, CsvError> {
    let bytes = &*plain(bytes);
    let mut rows = Rows::new(bytes);
    refuse_row_typed(&mut rows)?;
    let header = Header::read(&mut rows)?;
    let mut numbers = Numbers::between(delimiter(bytes));
    let rate_hz = header.rate_hz(&mut numbers)?;
    let mut points = PointReader::new(header.positions()?, header.width(), numbers, bytes.len());
    let mut times = Numbers::between(delimiter(bytes));
    let mut times_secs = Vec::new();
    while let Some(row) = rows.next() {
        let open = rows.peek().is_none() && !bytes.ends_with(b"\n") && !bytes.ends_with(b"\r");
        points.push(&row, open)?;
        let time = times.read(row.cell(1));
        times_secs.push(time.map_err(|expected| CsvError::cell(row.line, 1, row.cell(1), expected))?);
    }
    let (table, mut warnings) = points.finish()?;
    if let Some(claimed) = header.claimed_rows().filter(|&n| usize::try_from(n) != Ok(table.frames.len())) {
        warnings.push(format!("the header claims {claimed} frames, {} are there", table.frames.len()));
    }
    Ok(MotiveFile {
        format_version: header.metadata("Format Version"),
        rate_hz,
        unit: header.metadata("Length Units"),
        table,
        times_secs,
        rotations: header.rotations(),
        warnings,
    })
}

/// Whether bytes look like a Motive CSV, of a format that can be read or not.
pub fn detect(bytes: &[u8]) -> bool {
    const FIRST_LINES: usize = 100;
    let bytes = &*plain(bytes);
    let mut rows = Rows::new(bytes).take(FIRST_LINES).peekable();
    let first = rows.peek().map(|row| text(row.cell(0))).unwrap_or_default();
    first.eq_ignore_ascii_case("format version")
        || is_row_type(&first)
        || rows.any(|row| is_column_key(row.cell(0)) && row.cell(1).to_ascii_lowercase().starts_with(b"time"))
}

fn is_row_type(cell: &str) -> bool {
    let types = ["comment", "righthanded", "lefthanded", "info", "trackable", "rigidbody", "frame"];
    types.contains(&cell.to_ascii_lowercase().as_str()) && !cell.starts_with(char::is_uppercase)
}

fn refuse_row_typed(rows: &mut Rows) -> Result<(), CsvError> {
    match rows.peek() {
        Some(row) if is_row_type(&text(row.cell(0))) => {
            let found = format!("a row of type `{}`, as formats before 1.2 have them", text(row.cell(0)));
            let expected = "`Format Version` 1.2 or later: export the take again with a newer Motive";
            Err(CsvError::line(row.line, found, expected))
        }
        _ => Ok(()),
    }
}

/// A count that the header claims.
fn count(text: &str) -> Option<i64> {
    whole(text.as_bytes())
}

#[cfg(test)]
mod tests;
