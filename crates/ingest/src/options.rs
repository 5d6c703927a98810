use tousle_core::{LengthUnit, Session};

/// What the caller knows about a capture and the file may not say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct IngestOptions {
    /// The unit of positions where the file names none.
    pub unit: Option<LengthUnit>,
    /// The unit of positions whatever the file says.
    pub unit_override: Option<LengthUnit>,
    /// Frames a second where the file does not say.
    pub rate_hz: Option<f64>,
    /// Only this subject's markers, those whose labels name no subject, and those that nobody labeled; all markers if absent.
    pub subject: Option<String>,
    /// Takes positions that are exactly 0, 0, 0 as they are. Without it they count as missing, and are reported:
    /// programs write so what the cameras did not see, and the cameras never see exactly that.
    pub keep_exact_zeros: bool,
    /// Takes what is there of a file that was cut off; without it such a file is an error.
    pub allow_cut: bool,
}

impl IngestOptions {
    /// What a session says about its capture.
    pub fn from_session(session: &Session) -> Self {
        Self {
            unit: session.unit,
            rate_hz: session.rate_hz,
            subject: session.subject.clone(),
            ..Self::default()
        }
    }
}
