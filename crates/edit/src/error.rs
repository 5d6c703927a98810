/// Why edits cannot be read or applied.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// The file is no text.
    #[error("edits, byte {byte}: found bytes that are no UTF-8 text")]
    NotText {
        /// The first byte that cannot be read.
        byte: usize,
    },
    /// The file does not follow its format.
    #[error("edits, line {line}, column {column}: {problem}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What was found and expected.
        problem: String,
    },
    /// The file is of a version that is not known here.
    #[error("edits: found version {found}, expected {expected}")]
    Version {
        /// The version.
        found: u32,
        /// The only one that is read.
        expected: u32,
    },
    /// An edit cannot be used.
    #[error("edit {number} (`{name}`): {problem}")]
    BadEdit {
        /// The edit's place in the file, from 1.
        number: usize,
        /// Its name.
        name: String,
        /// What was found and expected.
        problem: String,
    },
    /// The motion does not belong to the groom.
    #[error("found a motion of {found} control points and {frames} frames, expected {expected} of the groom")]
    OtherGroom {
        /// Control points in the motion.
        found: usize,
        /// Its frames.
        frames: usize,
        /// Control points in the groom.
        expected: usize,
    },
    /// The motion has a position that is NaN or infinite.
    #[error("the motion at {secs} s, strand {strand}: found a position that is not finite")]
    BadMotion {
        /// The strand's name.
        strand: String,
        /// The time, s.
        secs: f64,
    },
    /// No layer has this id.
    #[error(
        "found no layer `{id}`, expected {}",
        if known.is_empty() { "one that is on the field, which has no layers".to_owned() } else { format!("one of: {known}") }
    )]
    NoLayer {
        /// The id.
        id: String,
        /// The ids that are there; empty where the field has no layers.
        known: String,
    },
    /// An edit of the stack cannot be changed so.
    #[error("edit `{id}`: {problem}")]
    BadChange {
        /// The edit's id.
        id: String,
        /// What was found and expected.
        problem: String,
    },
    /// The field cannot be sampled.
    #[error("the field cannot be sampled")]
    Field(#[from] tousle_field::FieldError),
}
