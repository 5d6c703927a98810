use serde::Serialize;
use std::fmt;

/// The file formats of captures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum CaptureFormat {
    /// Vicon Nexus, CSV.
    ViconCsv,
    /// Vicon Workstation, CSV.
    ViconWorkstationCsv,
}

impl CaptureFormat {
    /// The format's short name, as summaries have it: `vicon-csv`.
    pub fn name(self) -> &'static str {
        match self {
            Self::ViconCsv => "vicon-csv",
            Self::ViconWorkstationCsv => "vicon-workstation-csv",
        }
    }
}

impl fmt::Display for CaptureFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The format that bytes seem to be in, whatever their file is called; `None` if they look like no capture.
///
/// Only the beginning is looked at: that it can be read is not promised.
pub fn guess_format(bytes: &[u8]) -> Option<CaptureFormat> {
    tousle_csv::vicon::detect(bytes).then_some(CaptureFormat::ViconCsv)
}
