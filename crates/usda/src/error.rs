/// What is wrong with a layer, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("USD layer, {place}: found {found}, expected {expected}")]
#[non_exhaustive]
pub struct UsdaError {
    /// Where: a byte, a line, a prim.
    pub place: String,
    /// What is there.
    pub found: String,
    /// What should be.
    pub expected: String,
}

pub(crate) fn bad(
    place: impl Into<String>,
    found: impl Into<String>,
    expected: impl Into<String>,
) -> UsdaError {
    UsdaError { place: place.into(), found: found.into(), expected: expected.into() }
}
