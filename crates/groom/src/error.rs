use tousle_core::{Axis, GroomError};

use crate::GroomFormat;

/// Why a groom cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GroomReadError {
    /// The bytes are in no format that is known here.
    #[error(
        "found bytes that start with {start:?}, expected a groom: JSON, .hair, .data, .bin, .ply, .usda or .abc"
    )]
    UnknownFormat {
        /// How the bytes start.
        start: String,
    },
    /// The format is known and not read.
    #[error("found {found}, which is not read; {advice}")]
    Unsupported {
        /// The format.
        found: &'static str,
        /// What to do instead.
        advice: &'static str,
    },
    /// JSON that is not what it should be.
    #[error("JSON groom, line {line}, column {column}: {problem}")]
    Json {
        /// The line, from 1.
        line: usize,
        /// The column, from 1.
        column: usize,
        /// What is wrong there.
        problem: String,
    },
    /// The file does not hold together.
    #[error("{format} groom, {place}: found {found}, expected {expected}")]
    Malformed {
        /// The format.
        format: GroomFormat,
        /// Where: a byte offset, a line, a strand.
        place: String,
        /// What is there.
        found: String,
        /// What should be.
        expected: String,
    },
    /// Strands were there, and none can be simulated.
    #[error("{format} groom: found no strand that can be simulated, expected at least one: {found}")]
    NoStrands {
        /// The format.
        format: GroomFormat,
        /// What was left out.
        found: String,
    },
    /// The format does not say where or how large things are, and the caller did not either.
    #[error("a groom in {format} states no {what}: pass {pass}")]
    NotStated {
        /// The format.
        format: GroomFormat,
        /// What it does not state.
        what: &'static str,
        /// What the caller can give.
        pass: &'static str,
    },
    /// Up and forward are along one axis.
    #[error("found {up} for up and {forward} for forward, expected two axes across one another")]
    SameAxis {
        /// The axis that is up, as the file or the caller has it.
        up: Axis,
        /// The axis along which the nose points.
        forward: Axis,
    },
    /// The groom cannot be put where it should go.
    #[error("cannot place the groom: found {found}, expected {expected}")]
    Placement {
        /// What is there.
        found: String,
        /// What should be.
        expected: &'static str,
    },
    /// What came out cannot be simulated.
    #[error(transparent)]
    Groom(#[from] GroomError),
}
