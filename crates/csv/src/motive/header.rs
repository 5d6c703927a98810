use super::count;
use crate::CsvError;
use crate::points::{Columns, Width};
use crate::rows::{Row, Rows, is_column_key};
use tousle_cells::{Numbers, shorten, text};

/// The lines above the data.
pub(super) struct Header {
    /// Lines of keys and values.
    metadata: Vec<Row>,
    /// What the thing of each column is.
    types: Option<Row>,
    /// Its name.
    names: Option<Row>,
    /// `Rotation`, `Position`, and others that are of no interest.
    quantities: Row,
    /// The axis.
    axes: Row,
    longest: usize,
}

impl Header {
    /// Takes all lines up to the one that begins with `Frame`.
    pub fn read(rows: &mut Rows) -> Result<Self, CsvError> {
        let mut lines: Vec<Row> = Vec::new();
        while let Some(line) = rows.next_if(|row| !is_column_key(row.cell(0))) {
            lines.push(line);
        }
        let last_line = lines.last().map_or(1, |row| row.line);
        let axes = rows.next();
        let (Some(axes), Some(quantities)) = (axes, lines.pop()) else {
            let expected = "a line of `Rotation` and `Position`, and below it one that begins with `Frame`";
            return Err(CsvError::line(last_line, "the end of the header", expected));
        };
        let longest = lines.iter().chain([&quantities, &axes]).map(Row::len).max().unwrap_or(0);
        let mut metadata = Vec::new();
        let (mut types, mut names) = (None, None);
        // Until 1.21 the lines of types, names and ids do not say which they are, but keep this order.
        let mut n_unsaid = 0;
        for line in lines {
            if !line.cell(0).is_empty() {
                metadata.push(line);
                continue;
            }
            let said = line.cell(1).to_ascii_lowercase();
            n_unsaid += usize::from(said.is_empty());
            match (&*said, n_unsaid) {
                (b"type", _) | (b"", 1) => types = Some(line),
                (b"name", _) | (b"", 2) => names = Some(line),
                _ => {}
            }
        }
        Ok(Self { metadata, types, names, quantities, axes, longest })
    }

    /// The value of a key in the metadata, if it is there and not blank.
    pub fn metadata(&self, key: &str) -> Option<String> {
        self.metadata_cell(key).map(|(_, _, value)| text(value))
    }

    /// Frames a second of what was exported, or else of the capture.
    pub fn rate_hz(&self, numbers: &mut Numbers) -> Result<Option<f64>, CsvError> {
        let cell =
            self.metadata_cell("Export Frame Rate").or_else(|| self.metadata_cell("Capture Frame Rate"));
        let Some((line, idx, cell)) = cell else { return Ok(None) };
        numbers.read(cell).map_err(|expected| CsvError::cell(line, idx, cell, expected))
    }

    /// How many rows the metadata promises.
    pub fn claimed_rows(&self) -> Option<i64> {
        self.metadata("Total Exported Frames").and_then(|n| count(&n))
    }

    /// Where the coordinates of each position stand.
    pub fn positions(&self) -> Result<Vec<Columns>, CsvError> {
        let Some(names) = &self.names else {
            let found = format!("no line of names above line {}", self.quantities.line);
            return Err(CsvError::line(self.quantities.line, found, "one that begins with `,Name`"));
        };
        let starts = self.starts_of(b"position");
        starts.map(|idx| self.position(idx, names)).collect()
    }

    /// The names of things with a rotation.
    pub fn rotations(&self) -> Vec<String> {
        let names = self.names.as_ref();
        self.starts_of(b"rotation").filter_map(|idx| names.map(|names| text(names.cell(idx)))).collect()
    }

    pub fn width(&self) -> Width {
        let rows = [Some(&self.quantities), Some(&self.axes), self.names.as_ref()];
        let used = rows.into_iter().flatten().map(Row::filled_len).max().unwrap_or(0);
        Width { used, longest: self.longest }
    }

    /// The first column, that of X, of each run of columns of one quantity.
    fn starts_of<'a>(&'a self, quantity: &'a [u8]) -> impl Iterator<Item = usize> + 'a {
        (2..self.quantities.len()).filter(move |&idx| {
            self.quantities.cell(idx).eq_ignore_ascii_case(quantity)
                && self.axes.cell(idx).eq_ignore_ascii_case(b"x")
        })
    }

    fn position(&self, idx: usize, names: &Row) -> Result<Columns, CsvError> {
        for (axis, name) in [(1, b"y"), (2, b"z")] {
            let column = idx + axis;
            let is_position = self.quantities.cell(column).eq_ignore_ascii_case(b"position");
            if !is_position || !self.axes.cell(column).eq_ignore_ascii_case(name) {
                let found = self.axes.cell(column);
                let expected = format!("Position X, Y, Z of {}", shorten(&text(names.cell(idx))));
                return Err(CsvError::cell(self.axes.line, column, found, expected));
            }
        }
        let kind = self.types.as_ref().map(|types| text(types.cell(idx))).unwrap_or_default();
        Ok(Columns { label: text(names.cell(idx)), kind, unit: None, xyz: [idx, idx + 1, idx + 2] })
    }

    fn metadata_cell(&self, key: &str) -> Option<(u64, usize, &[u8])> {
        self.metadata.iter().find_map(|row| {
            let idx =
                (0..row.len()).step_by(2).find(|&i| row.cell(i).eq_ignore_ascii_case(key.as_bytes()))?;
            Some((row.line, idx + 1, row.cell(idx + 1))).filter(|(_, _, value)| !value.is_empty())
        })
    }
}
