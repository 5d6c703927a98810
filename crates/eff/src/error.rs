use crate::Finding;
use tousle_field::FieldError;

/// What keeps a field file from being written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EffError {
    /// The bytes could not be read or written.
    #[error("cannot read or write the field file")]
    Io(#[from] std::io::Error),
    /// The container could not be written.
    #[error("cannot write the field file")]
    Mcap(#[from] mcap::McapError),
    /// The file is not sound. The first finding; [`crate::validate`] gives all.
    #[error("{0}")]
    Unsound(Box<Finding>),
    /// The field that should be written cannot be.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A value that should be written cannot be.
    #[error("{what}: found {found}, expected {expected}")]
    BadValue {
        /// Which value.
        what: String,
        /// What it is.
        found: String,
        /// What a file can hold.
        expected: String,
    },
    /// The file unpacks to more than the reader was allowed to hold.
    #[error("the steps of the file take {needed} bytes of memory, expected at most {allowed}")]
    TooLarge {
        /// What they would take at least, bytes.
        needed: u64,
        /// What [`crate::ReadOptions::max_memory`] allows.
        allowed: u64,
    },
}

impl From<Box<Finding>> for EffError {
    fn from(finding: Box<Finding>) -> Self {
        Self::Unsound(finding)
    }
}

impl EffError {
    pub(crate) fn bad(
        what: impl Into<String>,
        found: impl std::fmt::Display,
        expected: impl std::fmt::Display,
    ) -> Self {
        Self::BadValue { what: what.into(), found: found.to_string(), expected: expected.to_string() }
    }
}
