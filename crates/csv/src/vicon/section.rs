use super::heading::Heading;
use super::{Layout, ViconFile};
use crate::points::{Columns, PointReader, Width};
use crate::rows::{Row, Rows, delimiter, is_column_key};
use crate::{CsvError, PointTable};
use tousle_cells::{Numbers, shorten, text, whole};

/// One section of a Vicon CSV.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// What it holds.
    pub kind: SectionKind,
    /// Its title as the file has it; empty where the title line is missing.
    pub title: String,
    /// The line it begins in, from 1.
    pub line: u64,
    /// Rows a second, sub-frames counted, if the file says.
    pub rate_hz: Option<f64>,
    /// The names above its columns: markers, devices, model outputs.
    pub names: Vec<String>,
    /// How many rows its table has.
    pub n_rows: usize,
    /// The number of its first frame, if it has one.
    pub first_frame: Option<i64>,
    /// The positions, for trajectories; empty for everything else.
    pub table: PointTable,
}

/// What a section holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SectionKind {
    /// Positions of markers.
    Trajectories,
    /// Analog signals: force plates, EMG.
    Devices,
    /// Angles, moments, segments.
    ModelOutputs,
    /// Foot strikes and the like.
    Events,
    /// Something else.
    Other,
}

/// The lines that give a table's columns their meaning.
struct Header {
    labels: Option<Row>,
    components: Row,
    units: Option<Row>,
}

/// Reads the section below a heading.
pub(super) fn read(
    heading: Heading,
    rows: &mut Rows,
    bytes: &[u8],
    file: &mut ViconFile,
) -> Result<Section, CsvError> {
    let named = kind_of(&heading.title);
    let mut section = Section {
        kind: named.unwrap_or(SectionKind::Other),
        title: heading.title,
        line: heading.line,
        rate_hz: heading.rate_hz,
        names: Vec::new(),
        n_rows: 0,
        first_frame: None,
        table: PointTable::default(),
    };
    if section.kind == SectionKind::Events {
        section.n_rows = count_events(rows);
        return Ok(section);
    }
    let header = read_header(heading.labels, rows, section.line)?;
    if is_workstation(&header) {
        file.layout = Layout::Workstation;
    }
    section.names = header.names().into_iter().map(|(_, name)| name).collect();
    if named.is_none() && section.title.is_empty() && header.holds_positions() {
        section.kind = SectionKind::Trajectories;
    }
    if section.kind == SectionKind::Trajectories {
        read_trajectories(&header, rows, bytes, &mut section, &mut file.warnings)?;
    } else {
        count_rows(rows, &mut section);
    }
    check_end(rows)?;
    Ok(section)
}

fn kind_of(title: &str) -> Option<SectionKind> {
    match title.to_ascii_lowercase().as_str() {
        "trajectories" => Some(SectionKind::Trajectories),
        "devices" | "analog" | "analogs" | "analog devices" => Some(SectionKind::Devices),
        "model outputs" | "joints" | "segments" => Some(SectionKind::ModelOutputs),
        "events" => Some(SectionKind::Events),
        _ => None,
    }
}

/// The line of labels, the line of components that begins with `Frame` or `Field #`, and the line of units.
fn read_header(labels: Option<Row>, rows: &mut Rows, line: u64) -> Result<Header, CsvError> {
    let is_key = |row: &Row| is_column_key(row.cell(0));
    let labels = labels.or_else(|| rows.next_if(|row| !is_key(row)));
    let Some(components) = rows.next_if(is_key) else {
        let after = labels.map_or(line, |row| row.line);
        let found = rows.peek().map_or("the end of the file".to_owned(), |row| shorten(&text(row.cell(0))));
        return Err(CsvError::line(after + 1, found, "a line that begins with `Frame` or `Field #`"));
    };
    let units = rows.next_if(|row| {
        let first = row.cell(0);
        first.is_empty() || first.to_ascii_lowercase().starts_with(b"units")
    });
    Ok(Header { labels, components, units })
}

fn is_workstation(header: &Header) -> bool {
    !header.components.cell(0).eq_ignore_ascii_case(b"frame")
}

impl Header {
    /// Columns in front of the data: the frame's number and, in Nexus, the sub-frame's.
    fn first_column(&self) -> usize {
        if self.components.cell(1).to_ascii_lowercase().starts_with(b"sub") { 2 } else { 1 }
    }

    /// Each name above the columns, and where it stands.
    fn names(&self) -> Vec<(usize, String)> {
        let Some(labels) = &self.labels else { return Vec::new() };
        let named = labels.cells().enumerate().skip(self.first_column());
        named.filter(|(_, name)| !name.is_empty()).map(|(idx, name)| (idx, text(name))).collect()
    }

    fn width(&self) -> Width {
        let units_len = self.units.as_ref().map_or(0, Row::len);
        let labels_len = self.labels.as_ref().map_or(0, Row::len);
        Width {
            used: self.components.filled_len(),
            longest: self.components.len().max(labels_len).max(units_len),
        }
    }

    /// Whether an untitled table is one of positions: X, Y, Z under every name, in a unit of length if any.
    fn holds_positions(&self) -> bool {
        let unit_of =
            |idx| self.units.as_ref().map_or(&b""[..], |units| units.cell(idx)).to_ascii_lowercase();
        let names = self.names();
        !names.is_empty()
            && names.iter().all(|(idx, _)| {
                self.is_xyz(*idx) && matches!(&*unit_of(*idx), b"" | b"mm" | b"cm" | b"m" | b"in" | b"inches")
            })
    }

    fn is_xyz(&self, idx: usize) -> bool {
        [b"x", b"y", b"z"]
            .iter()
            .enumerate()
            .all(|(axis, name)| self.components.cell(idx + axis).eq_ignore_ascii_case(*name))
    }

    /// Where each trajectory's coordinates stand.
    ///
    /// Under a name there may be more than X, Y and Z: Nexus can add velocities and accelerations.
    fn columns(&self) -> Result<Vec<Columns>, CsvError> {
        let names = self.names();
        let column = |(idx, label): (usize, String)| {
            if !self.is_xyz(idx) {
                let found = self.components.cell(idx);
                let expected = format!("X, Y, Z under the label {}", shorten(&label));
                return Err(CsvError::cell(self.components.line, idx, found, expected));
            }
            let unit = self.units.as_ref().map(|row| text(row.cell(idx))).filter(|unit| !unit.is_empty());
            Ok(Columns { label, kind: String::new(), unit, xyz: [idx, idx + 1, idx + 2] })
        };
        names.into_iter().map(column).collect()
    }

    /// How many columns are X without a name above.
    fn n_unnamed(&self, columns: &[Columns]) -> usize {
        let n_x = self.components.cells().filter(|cell| cell.eq_ignore_ascii_case(b"x")).count();
        n_x.saturating_sub(columns.len())
    }
}

fn read_trajectories(
    header: &Header,
    rows: &mut Rows,
    bytes: &[u8],
    section: &mut Section,
    warnings: &mut Vec<String>,
) -> Result<(), CsvError> {
    let columns = header.columns()?;
    let n_unnamed = header.n_unnamed(&columns);
    if n_unnamed > 0 {
        warnings.push(format!(
            "line {}: {n_unnamed} trajectories without a label are left out",
            header.components.line
        ));
    }
    let sub_frame_column = (header.first_column() == 2).then_some(1);
    let mut reader =
        PointReader::new(columns, header.width(), Numbers::between(delimiter(bytes)), bytes.len());
    while let Some(row) = next_data_row(rows) {
        if let Some(column) = sub_frame_column
            && !matches!(whole(row.cell(column)), Some(0) | None)
        {
            let expected = "sub-frame 0: trajectories have one row a frame";
            return Err(CsvError::cell(row.line, column, row.cell(column), expected));
        }
        let open = rows.peek().is_none() && !bytes.ends_with(b"\n") && !bytes.ends_with(b"\r");
        reader.push(&row, open)?;
    }
    let (table, odd) = reader.finish()?;
    warnings.extend(odd);
    section.n_rows = table.frames.len();
    section.first_frame = table.frames.first().copied();
    section.table = table;
    Ok(())
}

fn count_rows(rows: &mut Rows, section: &mut Section) {
    while let Some(row) = next_data_row(rows) {
        section.n_rows += 1;
        section.first_frame = section.first_frame.or_else(|| whole(row.cell(0)));
    }
}

/// The next row if it is one of data: whatever follows a table begins with a word.
fn next_data_row(rows: &mut Rows) -> Option<Row> {
    rows.next_if(|row| !row.cell(0).first().is_some_and(u8::is_ascii_alphabetic))
}

/// Events follow until a line with nothing but a title.
fn count_events(rows: &mut Rows) -> usize {
    let mut n_lines = 0;
    while rows.next_if(|row| row.only_cell().is_none()).is_some() {
        n_lines += 1;
    }
    // The first of them names the columns.
    n_lines.max(1) - 1
}

/// After a table comes another section's title, or nothing.
fn check_end(rows: &mut Rows) -> Result<(), CsvError> {
    match rows.peek() {
        Some(row) if row.only_cell().is_none() && !is_column_key(row.cell(0)) => {
            let expected = "a frame number, or the title of the next section";
            Err(CsvError::cell(row.line, 0, row.cell(0), expected))
        }
        _ => Ok(()),
    }
}
