use tousle_core::GroomError;
use tousle_field::FieldError;

/// Why there is no motion.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimError {
    /// The groom cannot be simulated.
    #[error("the groom cannot be simulated")]
    Groom(#[from] GroomError),
    /// The field cannot be sampled.
    #[error("the field cannot be sampled")]
    Field(#[from] FieldError),
    /// The scene holds something that cannot be.
    #[error("scene: found {what} = {found}, expected {expected}")]
    BadScene {
        /// Which value.
        what: &'static str,
        /// What it is.
        found: f64,
        /// What it should be.
        expected: &'static str,
    },
    /// An option is outside what it can be.
    #[error("option {option}: found {found}, expected {expected}")]
    BadOption {
        /// The option's name.
        option: &'static str,
        /// Its value.
        found: f64,
        /// What it should be.
        expected: &'static str,
    },
    /// The integrator belongs to another method.
    #[error("method {method}: found the integrator {found}, expected {expected}")]
    OtherMethod {
        /// The method's name.
        method: &'static str,
        /// The integrator's name.
        found: &'static str,
        /// Those that the method has.
        expected: String,
    },
    /// The step is beyond the integrator's stability limit for this groom.
    #[error(
        "integrator {integrator}: found a step of {dt_secs} s, expected at most {limit_secs:.3e} s \
         (its stability limit, set by strand {strand}{})",
        point.map(|p| format!(", control point {p}")).unwrap_or_default()
    )]
    Unstable {
        /// The integrator's name.
        integrator: &'static str,
        /// The step, s.
        dt_secs: f64,
        /// The largest step it stands, s.
        limit_secs: f64,
        /// The strand that sets the limit.
        strand: String,
        /// The control point at the far end of its stiffest stick, from the root, where one joint sets it.
        point: Option<usize>,
    },
    /// The step is too short for the digits that are computed with.
    #[error(
        "found a step of {dt_secs:.3e} s, expected {limit_secs:.3e} s or longer in single precision, whose rounding pushes \
         hair in shorter ones; or double precision"
    )]
    TooShort {
        /// The step, s.
        dt_secs: f64,
        /// The shortest step, s.
        limit_secs: f64,
    },
    /// An explicit integrator's run blew up at a step within its limit.
    #[error(
        "{integrator}: found strand {strand} nowhere at {secs} s, expected steps of {dt_secs:.3e} s to hold; hair so \
         limp cracks like a whip, and no explicit step is sure to be short enough for that"
    )]
    BlewUp {
        /// The integrator's name.
        integrator: &'static str,
        /// The strand.
        strand: String,
        /// Time of the first frame at which it is nowhere, s.
        secs: f64,
        /// The step, s.
        dt_secs: f64,
    },
    /// A strand got nowhere, though no step is too long for the integrator.
    #[error(
        "{integrator}: found strand {strand} nowhere at {secs} s, expected finite places; a number of its own, of the wind, of the \
         body or of the head's motion is larger than can be computed with"
    )]
    Nowhere {
        /// The integrator's name.
        integrator: &'static str,
        /// The strand.
        strand: String,
        /// Time of the first frame at which it is nowhere, s.
        secs: f64,
    },
    /// What keeps a run's parts failed.
    #[error("cannot keep or read back a part of the run")]
    Keeper(#[source] Box<dyn core::error::Error + Send + Sync>),
    /// What takes a run's frames takes no more.
    #[error("cannot hand on a frame of the run")]
    Sink(#[source] Box<dyn core::error::Error + Send + Sync>),
    /// A part that was kept is none of this run.
    #[error("part {number} of the run: found another number of positions than its strands have")]
    OtherPart {
        /// Which part, from 0.
        number: usize,
    },
}
