/// One line of cells.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// Line in the file, from 1.
    pub line: u64,
    cells: csv::ByteRecord,
}

impl Row {
    /// The cell at an index, blanks around it cut off; empty past the end of the line.
    pub fn cell(&self, idx: usize) -> &[u8] {
        self.cells.get(idx).unwrap_or_default().trim_ascii()
    }

    /// How many cells the line has, empty ones at its end included.
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// How many cells the line has up to the last one with something in it.
    pub fn filled_len(&self) -> usize {
        (0..self.len()).rev().find(|&idx| !self.cell(idx).is_empty()).map_or(0, |idx| idx + 1)
    }

    /// The cells in order.
    pub fn cells(&self) -> impl Iterator<Item = &[u8]> {
        (0..self.len()).map(|idx| self.cell(idx))
    }

    /// The text of the only cell with something in it, if there is exactly one and it is the first.
    pub fn only_cell(&self) -> Option<&[u8]> {
        (self.filled_len() == 1).then(|| self.cell(0))
    }
}

/// The lines of a file that have something in them, in order, with one line of foresight.
pub(crate) struct Rows<'a> {
    reader: csv::Reader<&'a [u8]>,
    bytes: &'a [u8],
    line_end: u8,
    counted_to: usize,
    line: u64,
    peeked: Option<Row>,
}

impl<'a> Rows<'a> {
    /// The rows of plain text, as [`tousle_cells::plain`] makes it.
    pub fn new(bytes: &'a [u8]) -> Self {
        let reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(delimiter(bytes))
            .from_reader(bytes);
        let line_end = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
        Self { reader, bytes, line_end, counted_to: 0, line: 1, peeked: None }
    }

    /// The next row that is not blank, without taking it.
    pub fn peek(&mut self) -> Option<&Row> {
        if self.peeked.is_none() {
            self.peeked = self.read();
        }
        self.peeked.as_ref()
    }

    /// Takes the next row that is not blank if it is such a one.
    pub fn next_if(&mut self, wanted: impl FnOnce(&Row) -> bool) -> Option<Row> {
        if self.peek().is_some_and(wanted) { self.peeked.take() } else { None }
    }

    fn read(&mut self) -> Option<Row> {
        let mut cells = csv::ByteRecord::new();
        loop {
            // Reading from memory into byte records of any length leaves the reader nothing to object to.
            if !self.reader.read_byte_record(&mut cells).unwrap_or(false) {
                return None;
            }
            let start = cells.position().map_or(0, csv::Position::byte);
            let line = self.line_at(usize::try_from(start).unwrap_or(usize::MAX));
            let row = Row { line, cells };
            if row.filled_len() > 0 {
                return Some(row);
            }
            cells = row.cells;
        }
    }

    /// The line of the first thing at or after an offset that is not the end of a line.
    fn line_at(&mut self, offset: usize) -> u64 {
        let rest = self.bytes.get(offset..).unwrap_or_default();
        let skipped = rest.iter().take_while(|b| matches!(b, b'\r' | b'\n')).count();
        let to = (offset + skipped).min(self.bytes.len()).max(self.counted_to);
        self.line += self.bytes[self.counted_to..to].iter().filter(|b| **b == self.line_end).count() as u64;
        self.counted_to = to;
        self.line
    }
}

impl Iterator for Rows<'_> {
    type Item = Row;

    fn next(&mut self) -> Option<Row> {
        self.peeked.take().or_else(|| self.read())
    }
}

/// What separates the cells: the first separator in the first line that names its columns.
///
/// That line holds no numbers, so a decimal comma cannot be taken for a separator.
pub(crate) fn delimiter(bytes: &[u8]) -> u8 {
    bytes
        .split(|b| matches!(b, b'\n' | b'\r'))
        .filter(|line| is_column_key(first_word(line)))
        .find_map(|line| line.iter().copied().find(|b| matches!(b, b',' | b';' | b'\t')))
        .unwrap_or(b',')
}

/// Whether a cell heads the column of frame numbers.
pub(crate) fn is_column_key(cell: &[u8]) -> bool {
    [&b"frame"[..], b"field #", b"sample #"].iter().any(|key| cell.eq_ignore_ascii_case(key))
}

fn first_word(line: &[u8]) -> &[u8] {
    let end = line.iter().position(|b| matches!(b, b',' | b';' | b'\t')).unwrap_or(line.len());
    let word = line[..end].trim_ascii();
    word.strip_prefix(b"\"").and_then(|w| w.strip_suffix(b"\"")).unwrap_or(word)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_cells::text;

    fn lines_and_first_cells(bytes: &[u8]) -> Vec<(u64, String)> {
        Rows::new(bytes).map(|row| (row.line, text(row.cell(0)))).collect()
    }

    #[test]
    fn blank_lines_are_skipped_and_counted() {
        let expected = [(1, "a".to_owned()), (4, "b".to_owned()), (5, "c".to_owned())];
        assert_eq!(lines_and_first_cells(b"a,1\n\n,,\nb\nc,2"), expected);
        assert_eq!(lines_and_first_cells(b"a,1\r\n\r\n,,\r\nb\r\nc,2\r\n"), expected);
        assert_eq!(lines_and_first_cells(b"a,1\r\r,,\rb\rc,2"), expected);
        assert_eq!(lines_and_first_cells(b"a,1\r\r\n\r\r\n,,\r\r\nb\r\r\nc,2"), expected);
    }

    #[test]
    fn decimal_commas_do_not_decide_the_separator() {
        assert_eq!(delimiter(b"Trajectories\n100\n;;A;;\nFrame;Sub Frame;X;Y;Z\n1;0;1,5;2,5;3,5"), b';');
        assert_eq!(delimiter(b"Trajectories\n100\n,,A,,\n\"Frame\",Sub Frame,X,Y,Z"), b',');
        assert_eq!(delimiter(b"Field #\tX\tY\tZ"), b'\t');
    }
}
