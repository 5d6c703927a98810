use crate::CsvError;
use crate::rows::Row;
use tousle_cells::{Decimals, Numbers, half_positions, lost_digits, whole};

/// A table of positions: one row a frame, three columns a point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointTable {
    /// The frame number of each row, as the file counts.
    pub frames: Vec<i64>,
    /// The line of each row in the file, from 1.
    pub lines: Vec<u64>,
    /// The points, in the file's order.
    pub points: Vec<Point>,
}

/// One point of a table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    /// The label as the file has it, with its prefix, blanks around it cut off.
    pub label: String,
    /// What kind of thing the file says it is (`Marker`, `Rigid Body` …); empty where it says nothing.
    pub kind: String,
    /// The unit its columns name, if they do.
    pub unit: Option<String>,
    /// The position in each row, in the file's own unit; `None` where a cell is blank or not a number.
    pub positions: Vec<Option<[f64; 3]>>,
}

/// Where a point's coordinates stand in a row.
#[derive(Clone, Debug)]
pub(crate) struct Columns {
    pub label: String,
    pub kind: String,
    pub unit: Option<String>,
    pub xyz: [usize; 3],
}

/// Fills a [`PointTable`] row by row.
pub(crate) struct PointReader {
    columns: Vec<Columns>,
    width: Width,
    /// A full table has at least three bytes a position; far more positions than bytes mean that most are not there.
    most_positions: usize,
    numbers: Numbers,
    /// Those of the last column that the header gives a meaning.
    last_decimals: Decimals,
    cut_line: Option<u64>,
    table: PointTable,
    odd_lines: usize,
    first_odd_line: Option<u64>,
    first_doubtful_line: Option<u64>,
    half_positions: usize,
}

/// How many cells a row should have.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Width {
    /// Up to the last column that the header gives a meaning.
    pub used: usize,
    /// Up to the end of the longest header line, whatever its last cells hold.
    pub longest: usize,
}

impl PointReader {
    pub fn new(columns: Vec<Columns>, width: Width, numbers: Numbers, file_len: usize) -> Self {
        let points = columns
            .iter()
            .map(|c| Point {
                label: c.label.clone(),
                kind: c.kind.clone(),
                unit: c.unit.clone(),
                positions: Vec::new(),
            })
            .collect();
        Self {
            columns,
            width,
            most_positions: file_len.saturating_mul(2),
            numbers,
            last_decimals: Decimals::default(),
            cut_line: None,
            table: PointTable { points, ..PointTable::default() },
            odd_lines: 0,
            first_odd_line: None,
            first_doubtful_line: None,
            half_positions: 0,
        }
    }

    /// Takes one row; `open` says that the file ends in it, without the end of the line.
    pub fn push(&mut self, row: &Row, open: bool) -> Result<(), CsvError> {
        let frame = whole(row.cell(0))
            .ok_or_else(|| CsvError::cell(row.line, 0, row.cell(0), "a frame number (a whole number)"))?;
        self.check_width(row)?;
        self.table.frames.push(frame);
        self.table.lines.push(row.line);
        if self.table.frames.len().saturating_mul(self.columns.len()) > self.most_positions {
            let found = format!("lines of {} cells or so", row.len());
            return Err(CsvError::line(row.line, found, format!("{} cells in each", self.width.used)));
        }
        let complete = self.complete(row, open);
        for (columns, point) in self.columns.iter().zip(&mut self.table.points) {
            let mut xyz = [None; 3];
            for (value, &idx) in xyz.iter_mut().zip(&columns.xyz) {
                let read = self.numbers.read(row.cell(idx));
                *value = read.map_err(|expected| CsvError::cell(row.line, idx, row.cell(idx), expected))?;
                *value = value.filter(|_| idx < complete);
            }
            point.positions.push(match xyz {
                [Some(x), Some(y), Some(z)] => Some([x, y, z]),
                _ => None,
            });
            self.half_positions += usize::from(xyz.iter().flatten().count() % 3 != 0);
        }
        Ok(())
    }

    /// How many cells of a row are there as they were written.
    fn complete(&mut self, row: &Row, open: bool) -> usize {
        let last_idx = self.width.used.saturating_sub(1);
        let last = row.cell(last_idx);
        // The last number of a cut line may have lost digits without showing it.
        if open && row.len() < self.width.used {
            return row.len().saturating_sub(1);
        }
        if open && row.len() == self.width.used && self.last_decimals.lost_some(last) {
            self.cut_line = Some(row.line);
            return last_idx;
        }
        self.last_decimals.see(last);
        usize::MAX
    }

    /// The table, and what was odd about it.
    pub fn finish(self) -> Result<(PointTable, Vec<String>), CsvError> {
        // Split at its decimal commas a line has too many cells, unless blanks at its end make up for it.
        // One number with a point proves that commas are separators and nothing else.
        if let Some(line) = self.first_doubtful_line
            && !self.numbers.saw_a_point()
        {
            let found = format!("a line that does not have {} cells, and no decimal point", self.width.used);
            return Err(CsvError::line(line, found, "numbers with a decimal point"));
        }
        let mut warnings = Vec::new();
        if let Some(line) = self.first_odd_line {
            warnings.push(format!(
                "{} lines, the first of them line {line}, are not as long as the header; missing cells count as blank",
                self.odd_lines
            ));
        }
        warnings.extend(self.cut_line.map(lost_digits));
        warnings.extend(half_positions(self.half_positions));
        Ok((self.table, warnings))
    }

    fn check_width(&mut self, row: &Row) -> Result<(), CsvError> {
        if row.filled_len() > self.width.used {
            let expected = format!(
                "at most {} cells (a decimal comma in a comma-separated file makes two of one)",
                self.width.used
            );
            return Err(CsvError::line(row.line, format!("{} cells", row.filled_len()), expected));
        }
        let short = row.len() < self.width.used;
        if short || row.len() > self.width.longest {
            self.first_doubtful_line.get_or_insert(row.line);
        }
        // A comma at the end of every line is nothing to speak of.
        if short || row.len() > self.width.longest + 1 {
            self.first_odd_line.get_or_insert(row.line);
            self.odd_lines += 1;
        }
        Ok(())
    }
}
