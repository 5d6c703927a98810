use crate::plan::MAX_STEPS;
use tousle_core::MAX_SECS;
use tousle_field::GridError;

/// Why fields cannot become one.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// There is nothing to merge with.
    #[error("found {found} fields, expected at least 2")]
    TooFew {
        /// How many there are.
        found: usize,
    },
    /// Two fields differ in what must be the same.
    #[error("{what}: found {found} in {name}, expected {expected} as in {first}")]
    Differ {
        /// In what.
        what: String,
        /// The field that is other than the first.
        name: String,
        /// What it has.
        found: String,
        /// The first field.
        first: String,
        /// What that has.
        expected: String,
    },
    /// A field begins before the common clock does.
    #[error(
        "{name} begins at {start_secs} s with its offset, expected 0 s or later: add as much to every offset"
    )]
    BeforeZero {
        /// The field.
        name: String,
        /// Its first time with its offset, s.
        start_secs: f64,
    },
    /// A field ends later than a field file can say.
    #[error("{name} ends at {end_secs} s with its offset, expected {MAX_SECS} s or earlier")]
    TooLate {
        /// The field.
        name: String,
        /// Its last time with its offset, s.
        end_secs: f64,
    },
    /// The merged field would have more steps than can be kept.
    #[error(
        "found {found} steps from {} s to {} s at {rate_hz} Hz, expected at most {MAX_STEPS}", span_secs[0], span_secs[1]
    )]
    TooManySteps {
        /// How many there would be.
        found: f64,
        /// From when to when, s.
        span_secs: [f64; 2],
        /// Steps a second.
        rate_hz: f64,
    },
    /// No field has a step at some time between others.
    #[error("no field has anything at {at_secs} s; expected fields that overlap or meet")]
    Gap {
        /// The time, s.
        at_secs: f64,
    },
    /// All fields together have no time in common.
    #[error(
        "the fields have no time in common: the last begins at {from_secs} s, the first ends at {to_secs} s"
    )]
    NoCommonSpan {
        /// The last beginning, s.
        from_secs: f64,
        /// The first end, s.
        to_secs: f64,
    },
    /// A number that was asked for cannot be.
    #[error("{what}: found {found}, expected {expected}")]
    BadOption {
        /// Which.
        what: &'static str,
        /// Its value.
        found: f64,
        /// What would do.
        expected: &'static str,
    },
    /// A grid that holds all would be too large.
    #[error("a grid that holds the grids of all fields is impossible")]
    Grid(#[from] GridError),
}
