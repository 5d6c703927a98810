//! `HeadCapture` → `WindSamples`: what force or wind explains the motion of each lock.
//!
//! [`fit`] turns marker positions in head space into one vector of wind per marker and time step.
//!
//! - Method `physical`, what `convert` takes: the air that balances the moments of all locks together, with its uncertainty
//!   ([`PhysicalOptions`], docs/physical-fit.md). [`fit_taught`] and [`defects`] are for the closed loop around it.
//! - Method `paper`: the 2008 equation E3 in its three readings ([`PaperReading`]); what blows outside the grid follows from
//!   the fans ([`outside_direction`]).

mod outside;
mod paper;
mod physical;
mod resample;

pub use outside::outside_direction;
pub use paper::{PaperOptions, PaperReading, PaperSpan};
pub use physical::{
    Defects, LIKELY_STIFFNESS_SPREAD, LockFound, PhysicalOptions, PhysicalReport, Scales, Taught, Wig,
};

use serde::Serialize;
use tousle_core::{HeadCapture, Progress, Sample, Session, Track, UpAxis, Vec3, WindSamples};
use tousle_flow::AirFlow;

/// Which method explains the motion, and how.
#[derive(Clone, Debug, PartialEq)]
pub enum FitMethod {
    /// Kazama, Sugisaki and Morishima 2008, eq. 3.
    Paper(PaperOptions),
    /// The air that explains the motion of all locks together.
    Physical(PhysicalOptions),
}

/// How samples are made.
#[derive(Clone, Debug, PartialEq)]
pub struct FitOptions {
    /// The method.
    pub method: FitMethod,
    /// Time steps a second of the samples, and so of the field.
    pub rate_hz: f64,
    /// Which way is up in the world, where the session does not say.
    pub up_axis: Option<UpAxis>,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self { method: FitMethod::Physical(PhysicalOptions::default()), rate_hz: 30.0, up_axis: None }
    }
}

/// The samples, the wind outside, and what happened on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// One vector a visible marker and time step, head space.
    pub samples: WindSamples,
    /// The wind outside the grid at each time step, head axes, in the samples' quantity.
    pub outside: Vec<Vec3>,
    /// The air round the head that the samples are of; `None` for `paper`, which knows none.
    pub air: Option<AirFlow>,
    /// The captured locks, ready to be simulated; `None` for `paper`, which does not know what they are made of.
    pub wig: Option<Wig>,
    /// What happened.
    pub report: FitReport,
}

/// What happened in a fit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FitReport {
    /// The method and its reading, in words.
    pub method: String,
    /// Time steps.
    pub n_steps: usize,
    /// Samples in all steps.
    pub n_samples: usize,
    /// Markers times steps without a sample, because no camera saw the marker when it had to be seen.
    pub n_missing: usize,
    /// How many of these cleaning had filled: `paper` leaves them out, `physical` has them in the lock's curve.
    pub n_filled: usize,
    /// Locks that gave no sample at all.
    pub strands_skipped: Vec<String>,
    /// White noise of a marker coordinate in the still interval, head space, m.
    pub noise_m: Option<f64>,
    /// What the method `physical` found out on the way.
    pub physical: Option<PhysicalReport>,
}

/// The most steps of the field in a frame of the capture.
const MAX_STEPS_PER_FRAME: f64 = 4.0;

/// Why no wind can be told.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// Displacement from rest needs a rest.
    #[error(
        "found no still frames in the capture that the session names, expected some: this reading needs the locks at rest"
    )]
    NoRest,
    /// A single frame tells nothing of motion.
    #[error("found {found} frames, expected at least 2")]
    TooFewFrames {
        /// How many there are.
        found: usize,
    },
    /// A number is not a finite number above 0.
    #[error("found {what} = {found}, expected a number above 0")]
    NotPositive {
        /// Which.
        what: &'static str,
        /// Its value.
        found: f64,
    },
    /// There is nothing to be seen between frames.
    #[error(
        "found a rate of {found} Hz, expected at most {most} Hz: {MAX_STEPS_PER_FRAME} steps a frame of the capture"
    )]
    TooFast {
        /// Steps of the field a second.
        found: f64,
        /// The most.
        most: f64,
    },
    /// Nobody knows where the head is.
    #[error("found no pose of the head in any frame, expected one at least")]
    NoPose,
    /// What the locks say of the air, with what is known before, is no definite system: numbers beyond all measure.
    #[error(
        "round {round} of {n_rounds}: found no most likely air, expected one; are masses, widths and stiffness of the locks of the session's units?"
    )]
    NoSolution {
        /// Of how many that make everything linear anew, from 1.
        round: usize,
        /// How many there are.
        n_rounds: usize,
    },
    /// A lock needs two markers to have a shape.
    #[error(
        "found no lock with two markers that were seen, expected one at least; seen at rest too if the session names still frames"
    )]
    NoLock,
    /// The samples' origins are of another capture.
    #[error(
        "lock {strand_idx}: found where {found:?} samples of its markers come from, expected {expected:?}, a sample a frame"
    )]
    Samples {
        /// The lock, from 0.
        strand_idx: usize,
        /// Origins of each marker's samples.
        found: Vec<usize>,
        /// Frames of each marker's track.
        expected: Vec<usize>,
    },
    /// Weight must point somewhere.
    #[error("found no up axis of the world in session or options, expected one")]
    NoUpAxis,
    /// No marker of any lock was ever seen where it was needed.
    #[error(
        "found no sample of any lock's marker, expected some ({n_missing} markers times steps are missing)"
    )]
    NoSamples {
        /// Markers times steps without a sample.
        n_missing: usize,
    },
}

/// Explains the motion of every lock by wind.
///
/// In: head-space positions, m, `[strand][marker][frame]`; if they were cleaned, where each comes from and its
/// expected error, m, in the same shape (without, every position counts as seen). Out: head-axes vectors at `options.rate_hz`, one for
/// every marker that was seen when its equation needs it; for `paper` force per mass, m/s², with the covariance
/// that the cameras' noise makes of it. Source: the method's own documentation.
///
/// # Errors
/// [`FitError`] if there is no motion to explain, no rest where one is needed, the rate is far above the capture's, or not one
/// sample comes out.
pub fn fit(
    head: &HeadCapture,
    origins: Option<&[Vec<Vec<Sample>>]>,
    session: &Session,
    options: &FitOptions,
    progress: &dyn Progress,
) -> Result<Fit, FitError> {
    fit_taught(head, origins, session, options, &Taught::default(), progress)
}

/// [`fit`] with what a simulation of the captured wig taught; the method `paper` learns nothing from it.
///
/// # Errors
/// As [`fit`].
pub fn fit_taught(
    head: &HeadCapture,
    origins: Option<&[Vec<Vec<Sample>>]>,
    session: &Session,
    options: &FitOptions,
    taught: &Taught,
    progress: &dyn Progress,
) -> Result<Fit, FitError> {
    check(head, origins, options)?;
    match &options.method {
        FitMethod::Paper(paper) => paper::fit_paper(head, origins, session, options.rate_hz, paper),
        FitMethod::Physical(physical) => {
            let set = physical_set(session, options, physical, taught)?;
            physical::fit_physical(head, origins, session, &set, progress)
        }
    }
}

/// The captured locks as a hairstyle, of what is taken for likely, before any wind is measured; `None` by the method `paper`, which
/// knows nothing of what a lock is made of. In: as for [`fit`].
///
/// # Errors
/// As [`fit`].
pub fn wig(
    head: &HeadCapture,
    origins: Option<&[Vec<Vec<Sample>>]>,
    session: &Session,
    options: &FitOptions,
) -> Result<Option<Wig>, FitError> {
    check(head, origins, options)?;
    let FitMethod::Physical(physical) = &options.method else { return Ok(None) };
    let taught = Taught::default();
    let set = physical_set(session, options, physical, &taught)?;
    physical::likely_wig(head, origins, session, &set).map(Some)
}

/// What the balance of moments leaves over of the captured wig when it moves as a simulator says, by lock of the session:
/// nothing if balance and simulator were the same, and if smoothing and splines lost nothing.
///
/// In: the simulated markers, head space, in place of the seen ones; the air that they were simulated in, and what the locks
/// were made of there. Out: `None` for locks without markers, and for all by the method `paper`.
///
/// # Errors
/// [`FitError`] if nobody knows which way is up, or there is not one lock.
pub fn defects(
    simulated: &HeadCapture,
    session: &Session,
    options: &FitOptions,
    scales: &[Scales],
    air: &AirFlow,
) -> Result<Vec<Option<Defects>>, FitError> {
    let FitMethod::Physical(physical) = &options.method else { return Ok(vec![None; session.strands.len()]) };
    let taught = Taught { scales: scales.to_vec(), ..Taught::default() };
    physical::defects(simulated, session, &physical_set(session, options, physical, &taught)?, air)
}

fn physical_set<'a>(
    session: &Session,
    options: &FitOptions,
    physical: &'a PhysicalOptions,
    taught: &'a Taught,
) -> Result<physical::Set<'a>, FitError> {
    let up_axis = session.up_axis.or(options.up_axis).ok_or(FitError::NoUpAxis)?;
    Ok(physical::Set { rate_hz: options.rate_hz, up_axis, options: physical, taught })
}

fn check(
    head: &HeadCapture,
    origins: Option<&[Vec<Vec<Sample>>]>,
    options: &FitOptions,
) -> Result<(), FitError> {
    if !(options.rate_hz.is_finite() && options.rate_hz > 0.0) {
        return Err(FitError::NotPositive { what: "rate", found: options.rate_hz });
    }
    let most = MAX_STEPS_PER_FRAME * head.rate_hz;
    if options.rate_hz > most {
        return Err(FitError::TooFast { found: options.rate_hz, most });
    }
    if head.n_frames() < 2 {
        return Err(FitError::TooFewFrames { found: head.n_frames() });
    }
    let Some(origins) = origins else { return Ok(()) };
    for (strand_idx, strand) in head.strands.iter().enumerate() {
        let found: Vec<usize> = origins.get(strand_idx).into_iter().flatten().map(Vec::len).collect();
        let expected: Vec<usize> = strand.markers.iter().map(Track::n_frames).collect();
        if found != expected {
            return Err(FitError::Samples { strand_idx, found, expected });
        }
    }
    Ok(())
}
