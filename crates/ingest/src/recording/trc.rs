use super::{Frames, Positions, Recording, markers};
use crate::{CaptureFormat, IngestError};

/// The markers of a TRC.
pub(super) fn read(bytes: &[u8]) -> Result<Recording<'_>, IngestError> {
    let mut trc = tousle_trc::read(bytes)?;
    let mut warnings = std::mem::take(&mut trc.warnings);
    let rate_hz = trc.header.data_rate_hz.filter(|rate| *rate > 0.0);
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

/// Whether times and rate differ by more than rounding: times to milliseconds, rates to a hundredth.
fn contradicts(rate_hz: f64, step_secs: f64, n_rows: usize) -> bool {
    let rounding = 0.001 / n_rows.saturating_sub(1).max(1) as f64;
    (step_secs - 1.0 / rate_hz).abs() > 0.01 / rate_hz + rounding
}

/// The mean time from frame to frame, s, if the rows say.
pub(super) fn step_secs(times_secs: &[Option<f64>], frames: &[i64]) -> Option<f64> {
    let n_frames = frames.last()?.checked_sub(*frames.first()?).filter(|n| *n > 0)?;
    Some(((*times_secs.last()?)? - (*times_secs.first()?)?) / n_frames as f64)
}
