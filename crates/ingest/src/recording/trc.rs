use super::{Frames, Positions, Recording, markers};
use crate::{CaptureFormat, IngestError};

/// The markers of a TRC.
pub(super) fn read(bytes: &[u8]) -> Result<Recording<'_>, IngestError> {
    let mut trc = tousle_trc::read(bytes)?;
    let mut warnings = std::mem::take(&mut trc.warnings);
    let mut rate_hz = trc.header.data_rate_hz.filter(|rate| *rate > 0.0);
    if rate_hz.is_none() && span_secs(&trc.times_secs) >= LEAST_SPAN_SECS {
        rate_hz = rate_of_times(&trc.times_secs, &trc.frames, &mut warnings);
    }
    if let (Some(rate), Some(step)) = (rate_hz, step_secs(&trc.times_secs, &trc.frames))
        && contradicts(rate, step, trc.frames.len())
    {
        warnings.push(format!("DataRate is {rate}, but the times of the frames are {step:.6} s apart"));
    }
    Ok(Recording {
        format: CaptureFormat::Trc,
        rate_hz,
        other_rate_hz: None,
        frames: Frames::listed(trc.frames, trc.lines),
        unit: trc.header.unit,
        up_axis: None,
        points: markers(trc.markers.iter().map(|marker| marker.label.clone())),
        positions: Positions::Table(trc.markers.into_iter().map(|marker| marker.positions).collect()),
        other: Vec::new(),
        warnings,
        cut: trc.cut,
    })
}

/// Times are mostly written to milliseconds: from so many seconds on they tell a rate to a thousandth, and below it worse than a session.
const LEAST_SPAN_SECS: f64 = 1.0;

/// Whether times and rate differ by more than rounding: times to milliseconds, rates to a hundredth.
fn contradicts(rate_hz: f64, step_secs: f64, n_rows: usize) -> bool {
    let rounding = 0.001 / n_rows.saturating_sub(1).max(1) as f64;
    (step_secs - 1.0 / rate_hz).abs() > 0.01 / rate_hz + rounding
}

/// The rate that the rows' times tell, where the header names none.
pub(super) fn rate_of_times(
    times_secs: &[Option<f64>],
    frames: &[i64],
    warnings: &mut Vec<String>,
) -> Option<f64> {
    let step = step_secs(times_secs, frames).filter(|step| *step > 0.0)?;
    warnings.push(format!("the header names no frame rate; the times of the rows are {step:.6} s apart"));
    Some(1.0 / step)
}

/// The time from the first row to the last, s; 0 if the rows do not say.
fn span_secs(times_secs: &[Option<f64>]) -> f64 {
    let ends = times_secs.first().copied().flatten().zip(times_secs.last().copied().flatten());
    ends.map_or(0.0, |(first, last)| last - first)
}

/// The mean time from frame to frame, s, if the rows say.
fn step_secs(times_secs: &[Option<f64>], frames: &[i64]) -> Option<f64> {
    let n_frames = frames.last()?.checked_sub(*frames.first()?).filter(|n| *n > 0)?;
    Some(((*times_secs.last()?)? - (*times_secs.first()?)?) / n_frames as f64)
}
