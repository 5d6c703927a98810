use crate::{Integrator, Precision};
use tousle_core::{PoseTrack, Quantity};

/// How to simulate.
#[derive(Clone, Debug, PartialEq)]
pub struct SimOptions {
    /// Which equations.
    pub method: Method,
    /// Frames of the result a second, > 0.
    pub rate_hz: f64,
    /// How the equations are stepped through time. `None`: the method's default ([`Integrator::of`]).
    pub integrator: Option<Integrator>,
    /// The longest step, s; a frame is cut into equal steps not longer than this. `None`:
    /// [`SimOptions::DEFAULT_DT_SECS`], or what the integrator stands if that is less.
    pub dt_secs: Option<f64>,
    /// [`Integrator::Adaptive`]: the most that a step may be off at any point, m, at least 1e-7.
    pub tolerance_m: f64,
    /// How many digits are computed with, where the integrator leaves the choice ([`SimOptions::has_single`]). Double is
    /// for every hairstyle; single is up to twice as fast, for hair of usual proportions. Sticks much shorter than 1 mm,
    /// or much stiffer than their weight, want double.
    pub precision: Precision,
    /// What the wind and the head do outside the field's span.
    pub time: TimeMode,
    /// When the motion starts, s on the field's clock. `None`: at the field's first step.
    pub start_secs: Option<f64>,
    /// How long it lasts, s. `None`: to the field's last step.
    pub duration_secs: Option<f64>,
    /// The shot's own head motion on the field's clock, in place of the capture's. Its world must have the same
    /// up axis as the scene's gravity. The torso faces where the head faces in the first pose.
    pub head: Option<PoseTrack>,
    /// What hair that lies on a torso rubs on, when the head moves over it.
    pub torso_grip: TorsoGrip,
}

/// Which equations move the strands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// The Hair Object Model of Kazama, Sugisaki and Morishima (2008), E1 and E2.
    Paper,
    /// An inextensible elastic rod a strand, all joints solved at once.
    #[default]
    Physical,
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

/// What hair that lies on a torso rubs on, when the head moves over it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TorsoGrip {
    /// A surface that is where the torso is at each time but has the head's velocity: so do engines that set a
    /// collider's place without telling their contacts how it moves. The only motions with a truth that were made
    /// with a moving head are of such an engine, so this is what has been checked.
    #[default]
    Head,
    /// The torso's surface, which moves as the torso does: a cloth that holds the hair that lies on it.
    Torso,
}

impl SimOptions {
    /// The step unless another is asked for, s. On the development captures the median strand is then 1 mm rms
    /// from where an endlessly small step would put it, a tenth of what the model itself is off; half the step
    /// halves that and doubles the run time.
    pub const DEFAULT_DT_SECS: f64 = 1.0 / 120.0;

    /// The defaults of a method.
    pub fn of(method: Method) -> Self {
        Self { method, ..Self::default() }
    }

    /// The times of a field with this start that a run asks for, s, from the first to the last; `None`: all of them.
    ///
    /// Of a field that ends later than these, the steps beyond make no difference to any bit of the result. An integrator
    /// with a limit asks for all: how long its steps may be hangs on the strongest wind.
    pub fn span_secs(&self, field_start_secs: f64) -> Option<[f64; 2]> {
        let first = self.start_secs.unwrap_or(field_start_secs);
        let last = first + (n_frames(self.duration_secs?, self.rate_hz) - 1.0) / self.rate_hz;
        // What is played again before its start is played from its end.
        let is_from_end = self.time == TimeMode::Loop && first < field_start_secs;
        let is_all = is_from_end || self.integrator().is_limited();
        (!is_all).then_some([field_start_secs, last])
    }

    /// Whether the run can be computed in single precision; if not, it is computed in double whatever is asked for.
    pub fn has_single(&self) -> bool {
        let is_implicit = matches!(self.integrator(), Integrator::Implicit | Integrator::ImplicitEuler);
        self.method == Method::Paper || is_implicit
    }

    /// The integrator: the one asked for, or the method's default.
    pub fn integrator(&self) -> Integrator {
        self.integrator.unwrap_or(Integrator::of(self.method)[0])
    }
}

/// Frames of a run that lasts so long, the first at its start.
pub(crate) fn n_frames(duration_secs: f64, rate_hz: f64) -> f64 {
    // A millionth of a frame keeps the last one where the span is a whole number of frames.
    (duration_secs * rate_hz + 1e-6).floor() + 1.0
}

impl Default for SimOptions {
    fn default() -> Self {
        Self {
            method: Method::default(),
            rate_hz: 60.0,
            integrator: None,
            dt_secs: None,
            tolerance_m: 1e-4,
            precision: Precision::Double,
            time: TimeMode::Once,
            start_secs: None,
            duration_secs: None,
            head: None,
            torso_grip: TorsoGrip::default(),
        }
    }
}

impl Method {
    /// The method that a field's vectors were made for: forces per mass come from the paper's E3.
    pub fn for_quantity(quantity: Quantity) -> Self {
        match quantity {
            Quantity::ForcePerMass => Self::Paper,
            Quantity::AirVelocity => Self::Physical,
        }
    }

    /// The name used on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Physical => "physical",
        }
    }

    /// The method of a name that [`Method::name`] gives.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Paper, Self::Physical].into_iter().find(|m| m.name() == name)
    }
}

impl TorsoGrip {
    /// The name used on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Torso => "torso",
            Self::Head => "head",
        }
    }

    /// The grip of a name that [`TorsoGrip::name`] gives.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Torso, Self::Head].into_iter().find(|grip| grip.name() == name)
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
