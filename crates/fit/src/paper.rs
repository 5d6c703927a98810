use crate::resample::{n_filled, n_steps, position_at};
use crate::{Fit, FitError, FitReport, outside_direction};
use std::borrow::Cow;
use tousle_core::{
    HeadCapture, Pose, Quantity, STANDARD_GRAVITY, Sample, SampleKind, Session, Track, Vec3, WindSample,
    WindSamples, median_high,
};

/// How equation E3 is read.
#[derive(Clone, Debug, PartialEq)]
pub struct PaperOptions {
    /// Where the displacement starts.
    pub reading: PaperReading,
    /// The time over which the free particle is carried; not used by [`PaperReading::FirstFrame`].
    pub span: PaperSpan,
}

/// Where the displacement X(s) − X(0) of E3 starts. `docs/equations.md` has the reasons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PaperReading {
    /// (a) At the capture's first frame, literally; s grows without end and the force dies as 1/s².
    FirstFrame,
    /// (b) A fixed time ago; nothing where hair stands still in a steady wind.
    SlidingWindow,
    /// (c) At the rest pose; a steady wind gives a steady force.
    RestPose,
}

/// The time over which the free particle of E3 is carried to where the marker is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PaperSpan {
    /// The same for every marker, s.
    Secs(f64),
    /// As long as a fall from the root to the marker along the lock takes: √(2 l / g).
    ///
    /// For a lock that hangs like a pendulum this makes E3's force the one that holds it there: leaning by x
    /// over a length l takes g x / l, and 2 x / s² is that for s = √(2 l / g).
    FreeFall,
}

impl Default for PaperOptions {
    fn default() -> Self {
        Self { reading: PaperReading::RestPose, span: PaperSpan::FreeFall }
    }
}

impl PaperReading {
    /// The name used in options and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::FirstFrame => "first-frame",
            Self::SlidingWindow => "sliding-window",
            Self::RestPose => "rest-pose",
        }
    }
}

/// A marker, its place along the lock and where it rests.
struct Marker<'a> {
    strand_idx: usize,
    marker_idx: usize,
    /// Where the cameras saw it, under whatever name.
    track: Cow<'a, Track>,
    /// Where it is when nothing blows, head space, m.
    rest: Option<Vec3>,
    /// The time s of E3, s: how long the air is taken to have pushed it from where it started. Unused by
    /// [`PaperReading::FirstFrame`], which counts from the first frame.
    span_secs: f64,
}

/// E3: twice the displacement over the square of the time is the constant acceleration that carries a free
/// particle from rest to where the marker is.
///
/// The factor E(Φ) that turns the vector into a pull on two angles depends on the lock that feels it and is
/// applied there, in the simulator: the field keeps the vector.
///
/// What no camera saw gives no sample, filled or not: the paper's voxels "hold markers", and a voxel that says
/// `measured` must not rest on a guess. Mended and given-back samples were seen, and count as any other.
pub(crate) fn fit_paper(
    head: &HeadCapture,
    origins: Option<&[Vec<Vec<Sample>>]>,
    session: &Session,
    rate_hz: f64,
    options: &PaperOptions,
) -> Result<Fit, FitError> {
    if let PaperSpan::Secs(secs) = options.span
        && !(secs.is_finite() && secs > 0.0)
    {
        return Err(FitError::NotPositive { what: "span", found: secs });
    }
    let still = session.still_range(head.first_frame, head.n_frames());
    if options.reading == PaperReading::RestPose && still.is_none() {
        return Err(FitError::NoRest);
    }
    let markers = markers(head, origins, session, still, options);
    let noise_m = noise(&markers, still);
    let n_steps = n_steps(head.n_frames(), head.rate_hz, rate_hz);
    let mut n_missing = 0;
    let mut steps = Vec::with_capacity(n_steps);
    for step in 0..n_steps {
        let time_secs = step as f64 / rate_hz;
        let samples: Vec<WindSample> = markers
            .iter()
            .filter_map(|m| sample(m, head.rate_hz, time_secs, noise_m, options.reading))
            .collect();
        n_missing += markers.len() - samples.len();
        steps.push(samples);
    }
    let n_samples: usize = steps.iter().map(Vec::len).sum();
    if n_samples == 0 {
        return Err(FitError::NoSamples { n_missing });
    }
    let samples = WindSamples { quantity: Quantity::ForcePerMass, rate_hz, steps };
    let report = FitReport {
        method: format!("paper, E3 read as {}", options.reading.name()),
        n_steps,
        n_samples,
        n_missing,
        n_filled: n_filled(origins, head.rate_hz, n_steps, rate_hz),
        strands_skipped: skipped(&samples, session),
        noise_m,
        physical: None,
    };
    Ok(Fit { outside: outside(&samples, session, head), samples, air: None, wig: None, report })
}

fn markers<'a>(
    head: &'a HeadCapture,
    origins: Option<&[Vec<Vec<Sample>>]>,
    session: &Session,
    still: Option<(usize, usize)>,
    options: &PaperOptions,
) -> Vec<Marker<'a>> {
    let mut markers = Vec::new();
    for strand in &head.strands {
        let spec = &session.strands[strand.strand_idx];
        for (marker_idx, track) in strand.markers.iter().enumerate() {
            let track = seen(track, origins.map(|o| &o[strand.strand_idx][marker_idx][..]));
            let rest = still.and_then(|(first, last)| mean(&track, first, last));
            let span_secs = match options.span {
                PaperSpan::Secs(secs) => secs,
                PaperSpan::FreeFall => (2.0 * spec.marker_distance_m(marker_idx) / STANDARD_GRAVITY).sqrt(),
            };
            markers.push(Marker { strand_idx: strand.strand_idx, marker_idx, track, rest, span_secs });
        }
    }
    markers
}

/// A track without what was filled.
fn seen<'a>(track: &'a Track, origins: Option<&[Sample]>) -> Cow<'a, Track> {
    match origins {
        Some(origins) if origins.iter().any(|o| o.kind == SampleKind::Filled) => {
            Cow::Owned(track.map(|frame, p| origins[frame].kind.is_seen().then_some(p)))
        }
        _ => Cow::Borrowed(track),
    }
}

/// E3 for one marker at one time.
fn sample(
    marker: &Marker<'_>,
    frame_rate_hz: f64,
    time_secs: f64,
    noise_m: Option<f64>,
    reading: PaperReading,
) -> Option<WindSample> {
    let at = |time_secs| position_at(&marker.track, frame_rate_hz, time_secs);
    let position_m = at(time_secs)?;
    let (start_m, secs) = match reading {
        // At s = 0 the equation is 0/0: a particle that has had no time tells nothing.
        PaperReading::FirstFrame if time_secs <= 0.0 => return None,
        PaperReading::FirstFrame => (at(0.0)?, time_secs),
        PaperReading::SlidingWindow => (at(time_secs - marker.span_secs)?, marker.span_secs),
        PaperReading::RestPose => (marker.rest?, marker.span_secs),
    };
    let gain = 2.0 / (secs * secs);
    let variance = match (noise_m, reading) {
        (None, _) => f64::INFINITY,
        // The rest pose is the mean of a hundred frames: its noise does not count.
        (Some(noise_m), PaperReading::RestPose) => gain * gain * noise_m * noise_m,
        (Some(noise_m), _) => 2.0 * gain * gain * noise_m * noise_m,
    };
    Some(WindSample {
        strand_idx: marker.strand_idx as u32,
        marker_idx: marker.marker_idx as u32,
        position_m,
        value: (position_m - start_m) * gain,
        covariance: [variance, variance, variance, 0.0, 0.0, 0.0],
    })
}

fn mean(track: &Track, first: usize, last: usize) -> Option<Vec3> {
    let seen: Vec<Vec3> = (first..=last).filter_map(|f| track.at(f)).collect();
    (!seen.is_empty()).then(|| seen.iter().sum::<Vec3>() / seen.len() as f64)
}

/// White noise of a marker coordinate in the still interval, m; the median over markers, as swaps are no noise.
fn noise(markers: &[Marker<'_>], still: Option<(usize, usize)>) -> Option<f64> {
    let (first, last) = still?;
    let of_marker = |marker: &Marker<'_>| {
        let rest = marker.rest?;
        let squares: Vec<f64> = (first..=last)
            .filter_map(|f| marker.track.at(f))
            .map(|p| (p - rest).norm_squared() / 3.0)
            .collect();
        (squares.len() >= 10).then(|| (squares.iter().sum::<f64>() / (squares.len() - 1) as f64).sqrt())
    };
    median_high(markers.iter().filter_map(of_marker).collect())
}

/// The wind outside: the fans' direction, with the mean strength that the markers feel along it at that time.
///
/// The paper gives its direction and not its strength. Taking the strength from the markers keeps the outside
/// in step with gusts and with what E3 makes of them.
fn outside(samples: &WindSamples, session: &Session, head: &HeadCapture) -> Vec<Vec3> {
    let known = |pose: &Option<tousle_core::HeadPose>| pose.as_ref().map(|p| p.world_from_head);
    let Some(rest_pose) = head.poses.iter().find_map(known) else {
        return vec![Vec3::zeros(); samples.steps.len()];
    };
    let mut pose: Pose = rest_pose;
    let of_step = |(step, samples_of_step): (usize, &Vec<WindSample>)| {
        let time_secs = step as f64 / samples.rate_hz;
        let frame = ((time_secs * head.rate_hz).round() as usize).min(head.n_frames() - 1);
        pose = known(&head.poses[frame]).unwrap_or(pose);
        let direction = outside_direction(session, head, &rest_pose, &pose, time_secs);
        let along: f64 = samples_of_step.iter().map(|s| s.value.dot(&direction)).sum();
        direction * (along / samples_of_step.len().max(1) as f64).max(0.0)
    };
    samples.steps.iter().enumerate().map(of_step).collect()
}

fn skipped(samples: &WindSamples, session: &Session) -> Vec<String> {
    let mut seen = vec![false; session.strands.len()];
    for sample in samples.steps.iter().flatten() {
        seen[sample.strand_idx as usize] = true;
    }
    session.strands.iter().zip(seen).filter(|(_, seen)| !seen).map(|(s, _)| s.name.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marker(track: &Track, rest: Vec3) -> Marker<'_> {
        Marker { strand_idx: 0, marker_idx: 0, track: Cow::Borrowed(track), rest: Some(rest), span_secs: 0.1 }
    }

    /// A free particle under a constant force of 3 m/s² from rest: x = 3/2 t².
    #[test]
    fn each_reading_of_a_free_fall() {
        let rate = 100.0;
        let track: Track =
            (0..100).map(|k| Some(Vec3::x() * (1.5 * (f64::from(k) / rate).powi(2)))).collect();
        let marker = marker(&track, Vec3::zeros());
        let value = |reading| sample(&marker, rate, 0.5, Some(1e-4), reading).unwrap().value.x;
        // Literally: the force itself, however late.
        assert!((value(PaperReading::FirstFrame) - 3.0).abs() < 1e-9);
        // From the position 0.1 s ago: 2 · 1.5 (0.25 − 0.16) / 0.01.
        assert!((value(PaperReading::SlidingWindow) - 27.0).abs() < 1e-9);
        // From rest over 0.1 s: 2 · 0.375 / 0.01.
        assert!((value(PaperReading::RestPose) - 75.0).abs() < 1e-9);
    }

    #[test]
    fn what_was_not_seen_gives_no_sample() {
        let track: Track = [None, Some(Vec3::x()), None, Some(Vec3::x())].into_iter().collect();
        let marker = Marker { span_secs: 0.02, ..marker(&track, Vec3::zeros()) };
        let sample = |time_secs, reading| sample(&marker, 100.0, time_secs, None, reading);
        assert!(sample(0.0, PaperReading::RestPose).is_none());
        assert!(sample(0.01, PaperReading::FirstFrame).is_none());
        assert!(sample(0.03, PaperReading::SlidingWindow).is_some());
        assert!(sample(0.01, PaperReading::RestPose).unwrap().covariance[0].is_infinite());
    }

    #[test]
    fn what_was_filled_gives_no_sample_and_what_was_mended_does() {
        let track: Track = (0..3).map(|_| Some(Vec3::x())).collect();
        let origins = [SampleKind::Filled, SampleKind::Mended, SampleKind::GivenBack]
            .map(|kind| Sample { kind, error_m: 1e-3 });
        let seen: Vec<bool> = seen(&track, Some(&origins)).iter().map(|p| p.is_some()).collect();
        assert_eq!(seen, [false, true, true]);
    }

    /// A pendulum that leans by a small angle under a sideways force a hangs at x = l a / g: free fall gives a back.
    #[test]
    fn free_fall_span_gives_a_leaning_pendulum_its_force() {
        let (length, force) = (0.25, 0.8);
        let x = length * force / STANDARD_GRAVITY;
        let track: Track = [Some(Vec3::x() * x)].into_iter().collect();
        let span_secs = (2.0 * length / STANDARD_GRAVITY).sqrt();
        let marker = Marker { span_secs, ..marker(&track, Vec3::zeros()) };
        let value = sample(&marker, 100.0, 0.0, None, PaperReading::RestPose).unwrap().value.x;
        assert!((value - force).abs() < 1e-12);
    }
}
