use serde::Serialize;
use std::fmt;

/// The file formats of captures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum CaptureFormat {
    /// C3D, of any processor.
    #[serde(rename = "c3d")]
    C3d,
    /// TRC.
    Trc,
    /// OptiTrack Motive, CSV.
    MotiveCsv,
    /// Vicon Nexus, CSV.
    ViconCsv,
    /// Vicon Workstation, CSV.
    ViconWorkstationCsv,
}

impl CaptureFormat {
    /// The format's short name, as summaries have it: `vicon-csv`.
    pub fn name(self) -> &'static str {
        match self {
            Self::C3d => "c3d",
            Self::Trc => "trc",
            Self::MotiveCsv => "motive-csv",
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
/// Only the beginning is looked at: that the rest can be read is not promised.
pub fn guess_format(bytes: &[u8]) -> Option<CaptureFormat> {
    let beginning = &bytes[..bytes.len().min(LONGEST_HEADER)];
    if is_binary(beginning) {
        return (beginning.get(1) == Some(&C3D_KEY)).then_some(CaptureFormat::C3d);
    }
    let readers = [
        (CaptureFormat::Trc, tousle_trc::detect as fn(&[u8]) -> bool),
        (CaptureFormat::MotiveCsv, tousle_csv::motive::detect),
        (CaptureFormat::ViconCsv, tousle_csv::vicon::detect),
    ];
    let found = readers.into_iter().find(|(_, detect)| detect(beginning));
    found.map(|(format, _)| format)
}

/// The header of a text file with thousands of columns ends before.
const LONGEST_HEADER: usize = 1 << 20;

/// The second byte of every C3D.
const C3D_KEY: u8 = 0x50;

/// Whether bytes are no text. The first byte of a C3D is a small number, and zeros follow in its header.
fn is_binary(beginning: &[u8]) -> bool {
    const HEADER: usize = 512;
    let utf_16 = beginning.starts_with(b"\xFF\xFE") || beginning.starts_with(b"\xFE\xFF");
    let header = &beginning[..beginning.len().min(HEADER)];
    !utf_16 && header.iter().any(|b| *b < b'\t')
}
