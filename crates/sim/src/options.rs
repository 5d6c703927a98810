use crate::Integrator;
use tousle_core::PoseTrack;

/// How to simulate.
#[derive(Clone, Debug, PartialEq)]
pub struct SimOptions {
    /// Which equations.
    pub method: Method,
    /// Frames of the result a second, > 0.
    pub rate_hz: f64,
    /// How the equations are stepped through time.
    pub integrator: Integrator,
    /// The longest step, s; a frame is cut into equal steps not longer than this. `None`: the method's default.
    pub dt_secs: Option<f64>,
    /// What the wind and the head do outside the field's span.
    pub time: TimeMode,
    /// When the motion starts, s on the field's clock. `None`: at the field's first step.
    pub start_secs: Option<f64>,
    /// How long it lasts, s. `None`: to the field's last step.
    pub duration_secs: Option<f64>,
    /// The shot's own head motion on the field's clock, in place of the capture's.
    pub head: Option<PoseTrack>,
    /// What only the method `paper` asks.
    pub paper: PaperOptions,
}

/// Which equations move the strands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// The Hair Object Model of Kazama, Sugisaki and Morishima (2008), E1 and E2.
    #[default]
    Paper,
}

/// What the wind and the head do outside the field's span.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeMode {
    /// The field is played once; before and after it the air is still. The head holds its first and last pose.
    #[default]
    Once,
    /// The field and the capture's head motion begin again.
    Loop,
    /// The last step's wind blows on.
    Hold,
}

/// What only the method `paper` asks.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct PaperOptions {}

impl Default for SimOptions {
    fn default() -> Self {
        Self {
            method: Method::Paper,
            rate_hz: 60.0,
            integrator: Integrator::default(),
            dt_secs: None,
            time: TimeMode::Once,
            start_secs: None,
            duration_secs: None,
            head: None,
            paper: PaperOptions::default(),
        }
    }
}

impl Method {
    /// The name used on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
        }
    }

    /// The method of a name that [`Method::name`] gives.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Paper].into_iter().find(|m| m.name() == name)
    }
}

impl TimeMode {
    /// The name used on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Once => "once",
            Self::Loop => "loop",
            Self::Hold => "hold",
        }
    }

    /// The mode of a name that [`TimeMode::name`] gives.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Once, Self::Loop, Self::Hold].into_iter().find(|m| m.name() == name)
    }
}
