use serde::Serialize;

/// Where a sample of a marker's track comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SampleKind {
    /// There is none.
    #[default]
    Missing,
    /// Seen by the cameras under its own label.
    Seen,
    /// Seen under another marker's label.
    Mended,
    /// Seen without a label.
    GivenBack,
    /// Not seen: filled.
    Filled,
}

impl SampleKind {
    /// Whether a camera saw it, under whatever name.
    pub fn is_seen(self) -> bool {
        matches!(self, Self::Seen | Self::Mended | Self::GivenBack)
    }
}

/// Where a sample comes from and how far it can be trusted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Sample {
    /// Where it comes from.
    pub kind: SampleKind,
    /// Expected error (root mean square of the distance), m; infinite where there is no sample.
    pub error_m: f64,
}
