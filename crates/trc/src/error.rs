/// Why bytes are not a TRC.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrcError {
    /// One cell is not what its place asks for.
    #[error("line {line}, column {column}: found {found:?}, expected {expected}")]
    Cell {
        /// Line in the file, from 1.
        line: u64,
        /// Cell in its line, from 1.
        column: usize,
        /// The cell's text.
        found: String,
        /// What should be there.
        expected: &'static str,
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
}

impl TrcError {
    pub(crate) fn cell(line: u64, column_idx: usize, found: &[u8], expected: &'static str) -> Self {
        let found = tousle_cells::shorten(&tousle_cells::text(found));
        Self::Cell { line, column: column_idx + 1, found, expected }
    }

    pub(crate) fn line(line: u64, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Line { line, found: found.into(), expected: expected.into() }
    }
}
