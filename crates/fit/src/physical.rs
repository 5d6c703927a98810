//! The method `physical`: the air that explains the motion of all locks together. `docs/physical-fit.md` has the maths.

mod constants;
mod contact;
mod evidence;
mod lock;
mod moments;
mod noise;
mod prior;
mod report;
mod smooth;
mod smoother;
mod solve;
mod spline;
mod statements;
mod taught;
mod tracks;
mod triangle;
mod wig;

use crate::resample::{n_filled, n_steps};
use crate::{Fit, FitError, FitReport};
use lock::{Seeing, SeenLock};
use nalgebra::Matrix3;
use rayon::prelude::*;
pub use report::{LockFound, PhysicalReport};
pub use taught::{Defects, LIKELY_STIFFNESS_SPREAD, Scales, Taught};
use tousle_core::{
    HeadCapture, Progress, Quantity, STANDARD_GRAVITY, Sample, Session, UpAxis, Vec3, WindSample, WindSamples,
};
use tousle_flow::{AirFlow, AirState, WindAt};
use tracks::Clock;
pub use wig::Wig;

/// How the method `physical` is set.
#[derive(Clone, Debug, PartialEq)]
pub struct PhysicalOptions {
    /// Frequency above which a marker's motion is taken for noise, Hz, if it errs by 0.3 mm or less; that of a noisier marker falls as
    /// the sixth root of its error.
    pub cutoff_hz: f64,
    /// The most swirl modes.
    pub max_modes: usize,
    /// Half the way over which a swirl of middling size turns round, m > 0 ([`tousle_flow::SwirlKernel`]): swirls near a head are some
    /// 10 to 20 cm across.
    pub swirl_length_m: f64,
    /// Error of a joint's bend beyond the first marker, rad: what a spline between markers cannot see (curls of a few millimeters),
    /// and twist. If it rises, less is told by the outer ends of locks, whose weight is small beside their stiffness.
    pub bend_error_rad: f64,
    /// How long the errors of a lock's moments last, s: that of its mass, its width and how it hung for as long as it leans so.
    /// If it rises, how a lock leans tells less of the wind, and how that changes tells more.
    pub errors_last_secs: f64,
    /// The share of those errors' square that does not last, 0 to 1.
    pub fleeting_share: f64,
    /// Whether how stiff locks are is known well enough for errors of their bends to count by it. While stiffnesses are compared they
    /// must count the same for all: with larger errors a fit finds less wind, and a wig that is too soft would come nearest.
    pub stiffness_known: bool,
    /// Whether each lock may be off by itself, for the whole capture, in stiffness, drag and natural shape.
    pub locks_differ: bool,
    /// Whether it is said how sure the wind is; else it counts as if it were known.
    pub says_how_sure: bool,
}

impl Default for PhysicalOptions {
    fn default() -> Self {
        Self {
            cutoff_hz: 12.0,
            max_modes: 100,
            swirl_length_m: 0.14,
            bend_error_rad: 0.06,
            errors_last_secs: 0.17,
            fleeting_share: 0.5,
            stiffness_known: true,
            locks_differ: true,
            says_how_sure: true,
        }
    }
}

/// The options and what belongs to them.
pub(crate) struct Set<'a> {
    pub(crate) rate_hz: f64,
    pub(crate) up_axis: UpAxis,
    pub(crate) options: &'a PhysicalOptions,
    pub(crate) taught: &'a Taught,
}

/// Explains the motion of all locks by the air round the head.
pub(crate) fn fit_physical(
    head: &HeadCapture,
    origins: Option<&[Vec<Vec<Sample>>]>,
    session: &Session,
    set: &Set<'_>,
    progress: &dyn Progress,
) -> Result<Fit, FitError> {
    let seen = Seen::new(head, origins, session, set)?;
    let problem = seen.problem(head, session, set);
    let solved = solve::solve(&problem, progress)?;
    let samples = samples(&problem, &solved.air, origins);
    let outside = solved.air.states.iter().map(AirState::outside).collect();
    let n_samples = samples.steps.iter().map(Vec::len).sum();
    let n_markers: usize = session.strands.iter().map(|s| s.markers.len()).sum();
    let skipped = |idx: &usize| !seen.locks.iter().any(|lock| lock.strand_idx == *idx);
    let n_steps = problem.clock.n_steps;
    let report = FitReport {
        method: "physical: balance of moments of all locks in one flow".to_owned(),
        n_steps,
        n_samples,
        n_missing: n_markers * n_steps - n_samples,
        n_filled: n_filled(origins, head.rate_hz, n_steps, set.rate_hz),
        strands_skipped: (0..session.strands.len())
            .filter(skipped)
            .map(|i| session.strands[i].name.clone())
            .collect(),
        noise_m: None,
        physical: Some(report::report(&problem, &solved)),
    };
    let wig = Some(wig::wig(&problem));
    Ok(Fit { samples, outside, air: Some(solved.air), wig, report })
}

/// All locks that can be explained, before anything is.
pub(crate) fn likely_wig(
    head: &HeadCapture,
    origins: Option<&[Vec<Vec<Sample>>]>,
    session: &Session,
    set: &Set<'_>,
) -> Result<Wig, FitError> {
    let seen = Seen::new(head, origins, session, set)?;
    Ok(wig::wig(&seen.problem(head, session, set)))
}

/// What the balance leaves over of a wig that was simulated in a known air: by lock of the session.
pub(crate) fn defects(
    simulated: &HeadCapture,
    session: &Session,
    set: &Set<'_>,
    air: &AirFlow,
) -> Result<Vec<Option<Defects>>, FitError> {
    let seen = Seen::new(simulated, None, session, set)?;
    let found = solve::defects(&seen.problem(simulated, session, set), air);
    let mut defects = vec![None; session.strands.len()];
    for (lock, of_lock) in seen.locks.iter().zip(found) {
        defects[lock.strand_idx] = Some(of_lock);
    }
    Ok(defects)
}

/// A capture made ready.
struct Seen {
    clock: Clock,
    still: Option<(usize, usize)>,
    gravity_world: Vec3,
    locks: Vec<SeenLock>,
}

impl Seen {
    fn new(
        head: &HeadCapture,
        origins: Option<&[Vec<Vec<Sample>>]>,
        session: &Session,
        set: &Set<'_>,
    ) -> Result<Self, FitError> {
        let n_steps = n_steps(head.n_frames(), head.rate_hz, set.rate_hz);
        let clock = Clock::new(head, n_steps, set.rate_hz).ok_or(FitError::NoPose)?;
        let still = session.still_range(head.first_frame, head.n_frames());
        let gravity_world = -set.up_axis.vector() * STANDARD_GRAVITY;
        let cutoff_hz = set.options.cutoff_hz;
        let seeing = Seeing { head, origins, session, clock: &clock, still, gravity_world, cutoff_hz };
        let locks: Vec<SeenLock> = (0..session.strands.len())
            .into_par_iter()
            .filter_map(|idx| SeenLock::new(idx, &seeing))
            .collect();
        if locks.is_empty() {
            return Err(FitError::NoLock);
        }
        Ok(Self { clock, still, gravity_world, locks })
    }

    fn problem<'a>(
        &'a self,
        head: &'a HeadCapture,
        session: &'a Session,
        set: &Set<'a>,
    ) -> solve::Problem<'a> {
        solve::Problem {
            locks: &self.locks,
            clock: &self.clock,
            session,
            head,
            still: self.still,
            rest_pose: self.clock.poses[self.still.map_or(0, |(first, last)| (first + last) / 2)],
            gravity_world: self.gravity_world,
            options: set.options,
            taught: set.taught,
        }
    }
}

/// The air at every marker that a camera saw, with its covariance.
fn samples(problem: &solve::Problem<'_>, air: &AirFlow, origins: Option<&[Vec<Vec<Sample>>]>) -> WindSamples {
    let clock = problem.clock;
    let of_step = |step: usize| {
        let frame = clock.frame(step);
        let mut places = Vec::new();
        for seen in problem.locks {
            let Some(strand) = problem.head.strands.iter().find(|s| s.strand_idx == seen.strand_idx) else {
                continue;
            };
            for (marker_idx, track) in strand.markers.iter().enumerate() {
                let is_seen = origins.is_none_or(|o| o[seen.strand_idx][marker_idx][frame].kind.is_seen());
                let Some(position_m) = track.at(frame).filter(|_| is_seen) else { continue };
                places.push((seen.strand_idx as u32, marker_idx as u32, position_m));
            }
        }
        let winds: Vec<_> = places.iter().map(|(.., position_m)| air.at(step, *position_m)).collect();
        let covariances = air.covariances(step, &winds);
        let sample =
            |(((strand_idx, marker_idx, position_m), wind), covariance): ((_, &WindAt), &Matrix3<f64>)| {
                let (value, covariance) = (wind.velocity, packed(covariance));
                WindSample { strand_idx, marker_idx, position_m, value, covariance }
            };
        places.into_iter().zip(&winds).zip(&covariances).map(sample).collect()
    };
    let steps = (0..clock.n_steps).into_par_iter().map(of_step).collect();
    WindSamples { quantity: Quantity::AirVelocity, rate_hz: clock.rate_hz, steps }
}

fn packed(m: &Matrix3<f64>) -> [f64; 6] {
    [m[(0, 0)], m[(1, 1)], m[(2, 2)], m[(0, 1)], m[(0, 2)], m[(1, 2)]]
}
