//! CSV as Vicon Nexus exports it, and its ancestor Workstation.
//!
//! A file is a list of sections. Each has a title line, a line with its rate, lines that name its columns
//! (labels, components, units), then one row a frame or, for devices, several (`Sub Frame`):
//!
//! ```text
//! Trajectories                              TRAJECTORIES
//! 100                                       100,Hz
//! ,,Wig:LFHD,,,Wig:NOSE,,                   ,LFHD,,,NOSE,,
//! Frame,Sub Frame,X,Y,Z,X,Y,Z               Field #,X,Y,Z,X,Y,Z
//! ,,mm,mm,mm,mm,mm,mm                       1,165.1,331.8,1508.1,,,
//! 1,0,165.1,331.8,1508.1,,,
//! ```
//!
//! Title and rate are missing where somebody cut them off.

mod heading;
mod section;

pub use section::{Section, SectionKind};

use crate::CsvError;
use crate::rows::{Rows, delimiter, is_column_key};
use tousle_cells::plain;

/// Everything a Vicon CSV holds.
#[derive(Clone, Debug, PartialEq)]
pub struct ViconFile {
    /// Which program's layout it has.
    pub layout: Layout,
    /// The sections, in the file's order, at least one.
    pub sections: Vec<Section>,
    /// What was odd but could be read.
    pub warnings: Vec<String>,
}

/// The two layouts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// Nexus: `Frame`, `Sub Frame`, a line of units.
    Nexus,
    /// Workstation and the first Nexus versions: `Field #`, no sub-frames, no units.
    Workstation,
}

/// Reads all sections of a Vicon CSV; positions of the `Trajectories`, and of the rest what it is called.
///
/// # Errors
/// [`CsvError`] where a section has no table, a row has more cells than the header, or a cell of a trajectory
/// holds anything but a number. A decimal comma, of a rate too, that could be a separator is one of these.
pub fn read(bytes: &[u8]) -> Result<ViconFile, CsvError> {
    let bytes = &*plain(bytes);
    let mut rows = Rows::new(bytes);
    let mut file = ViconFile { layout: Layout::Nexus, sections: Vec::new(), warnings: Vec::new() };
    while let Some(heading) = heading::next(&mut rows, delimiter(bytes))? {
        let section = section::read(heading, &mut rows, bytes, &mut file)?;
        file.sections.push(section);
    }
    if file.sections.is_empty() {
        return Err(CsvError::file(
            "no section",
            "a line with a rate or with `Frame,Sub Frame,…` or `Field #,…`",
        ));
    }
    Ok(file)
}

/// Whether bytes look like a Vicon CSV: some line heads a column of frame numbers, and none of times beside it.
pub fn detect(bytes: &[u8]) -> bool {
    let bytes = &*plain(bytes);
    let starts_with_time = |cell: &[u8]| cell.to_ascii_lowercase().starts_with(b"time");
    Rows::new(bytes).any(|row| is_column_key(row.cell(0)) && !starts_with_time(row.cell(1)))
}

#[cfg(test)]
mod tests;
