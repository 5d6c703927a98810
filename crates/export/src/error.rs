use tousle_core::GroomError;
use tousle_field::FieldError;

/// Why nothing, or not all, was written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The sink takes no more bytes. Which one, whoever chose it says.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// The motion's arrays do not fit together, or hold a number that is not finite.
    #[error("the motion: found {found}, expected {expected}")]
    BadMotion {
        /// What is there.
        found: String,
        /// What should be.
        expected: String,
    },
    /// The groom cannot be used.
    #[error("the groom cannot be used")]
    BadGroom(#[from] GroomError),
    /// The options ask for what is not there.
    #[error("options: found {found}, expected {expected}")]
    BadOptions {
        /// What is there.
        found: String,
        /// What should be.
        expected: String,
    },
    /// The field cannot be used.
    #[error("the field cannot be used")]
    BadField(#[from] FieldError),
}
