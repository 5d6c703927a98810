/// Why bytes are not a capture in CSV.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CsvError {
    /// One cell is not what its place in the table asks for.
    #[error("line {line}, column {column}: found {found:?}, expected {expected}")]
    Cell {
        /// Line in the file, from 1.
        line: u64,
        /// Cell in its line, from 1.
        column: usize,
        /// The cell's text.
        found: String,
        /// What should be there.
        expected: String,
    },
    /// A line as a whole is not what should follow the line before.
    #[error("line {line}: found {found}, expected {expected}")]
    Line {
        /// Line in the file, from 1.
        line: u64,
        /// What is there.
        found: String,
        /// What should be there.
        expected: String,
    },
    /// The file ends, or holds something else altogether.
    #[error("found {found}, expected {expected}")]
    File {
        /// What is there.
        found: String,
        /// What should be there.
        expected: String,
    },
}

impl CsvError {
    pub(crate) fn cell(line: u64, column_idx: usize, found: &[u8], expected: impl Into<String>) -> Self {
        let found = tousle_cells::shorten(&tousle_cells::text(found));
        Self::Cell { line, column: column_idx + 1, found, expected: expected.into() }
    }

    pub(crate) fn line(line: u64, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Line { line, found: found.into(), expected: expected.into() }
    }

    pub(crate) fn file(found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::File { found: found.into(), expected: expected.into() }
    }
}
