/// Why bytes are not a session.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SessionError {
    /// The text breaks off or does not follow the format, or a field has the wrong type.
    #[error("line {line}, column {column}: {message}")]
    Syntax {
        /// Line in the file, from 1.
        line: usize,
        /// Character in the line, from 1.
        column: usize,
        /// What was found, what was expected.
        message: String,
    },
    /// The bytes are no text.
    #[error("byte {offset}: found bytes that are not UTF-8, expected a session in JSON or TOML")]
    NotText {
        /// Where the first of them is, from 0.
        offset: usize,
    },
    /// The bytes are something else.
    #[error("found {found}, expected a session in JSON or TOML")]
    NotASession {
        /// What they are.
        found: String,
    },
    /// A field's value cannot be.
    #[error("{path}: found {found}, expected {expected}")]
    Field {
        /// The field, from the top of the file.
        path: String,
        /// Its value.
        found: String,
        /// What it should be.
        expected: String,
    },
}

impl SessionError {
    pub(super) fn field(path: &str, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Field { path: path.to_owned(), found: found.into(), expected: expected.into() }
    }
}
