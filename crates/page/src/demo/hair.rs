use super::quantize::{Quantization, quantize};
use super::{Compared, HairView, PageError};
use crate::Packed;
use serde::Serialize;
use tousle_core::StrandMotion;

/// A hairstyle's motion as the page's script gets it.
#[derive(Serialize)]
pub(super) struct HairData {
    name: String,
    about: String,
    /// Control points of each strand that is shown.
    counts: Vec<usize>,
    /// Width of each strand that is shown, m.
    widths_m: Vec<f64>,
    /// Strands of the groom.
    n_strands: usize,
    times_secs: Vec<f64>,
    positions: Positions,
    compared: Option<ComparedData>,
}

/// What is laid over the motion.
#[derive(Serialize)]
struct ComparedData {
    name: String,
    positions: Positions,
}

/// Quantized positions: frame after frame, point after point, x y z.
#[derive(Serialize)]
struct Positions {
    #[serde(flatten)]
    quantization: Quantization,
    packed: Packed,
}

/// Frames a second that are kept: what a screen shows. Between frames the script is cubic in time.
const SHOWN_RATE_HZ: f64 = 60.0;

/// Control points times frames that a page carries of a motion. A point costs 4 to 6 bytes as text, so a motion
/// stays below 4 MB; 60 locks of 15 points fill it in 11 s.
const MAX_POINT_FRAMES: usize = 600_000;

/// Frames that a page carries of a motion.
const MAX_FRAMES: usize = 3_600;

/// Packs a hairstyle's motion, thinned out where it is too much for a page.
///
/// # Errors
/// [`PageError`] if the motion does not fit the groom or is not finite.
pub(super) fn hair_data(
    index: usize,
    view: &HairView<'_>,
    blobs: &mut Vec<Packed>,
    notes: &mut Vec<String>,
) -> Result<HairData, PageError> {
    check(view.name, view.motion, view)?;
    let frames = kept_frames(&view.motion.times_secs);
    let strands = kept_strands(&view.motion.counts, frames.len());
    if strands.len() < view.motion.counts.len() {
        let (shown, all) = (strands.len(), view.motion.counts.len());
        notes.push(format!(
            "{}: this page shows {shown} of {all} strands, evenly chosen, to stay small.",
            view.name
        ));
    }
    let times_secs: Vec<f64> = frames.iter().map(|&f| view.motion.times_secs[f]).collect();
    let mut pack = |what: &str, motion: &StrandMotion| {
        let positions: Vec<_> =
            times_secs.iter().flat_map(|&t| positions_at(motion, t, &strands)).map(Some).collect();
        let (quantization, values) = quantize(&positions);
        let row = values.len() / times_secs.len();
        let packed = Packed::new(&format!("hair-{index}-{what}"), &values, &[&[row], &[row, row], &[3]]);
        blobs.push(packed.clone());
        Positions { quantization, packed }
    };
    let positions = pack("motion", view.motion);
    let compared = match view.compared {
        None => None,
        Some(Compared { name, motion }) => {
            check(name, motion, view)?;
            Some(ComparedData { name: name.to_owned(), positions: pack("compared", motion) })
        }
    };
    Ok(HairData {
        name: view.name.to_owned(),
        about: view.about.to_owned(),
        counts: strands.iter().map(|&s| view.motion.counts[s]).collect(),
        widths_m: strands.iter().map(|&s| view.groom.strands[s].lock_width_m).collect(),
        n_strands: view.motion.counts.len(),
        times_secs,
        positions,
        compared,
    })
}

fn check(name: &str, motion: &StrandMotion, view: &HairView<'_>) -> Result<(), PageError> {
    let name = || name.to_owned();
    let times = &motion.times_secs;
    let (found, n_frames, expected) = (motion.positions_m.len(), times.len(), view.groom.n_points());
    if motion.counts != view.groom.counts() || found != n_frames * expected {
        return Err(PageError::MotionDoesNotFit { name: name(), found, n_frames, expected });
    }
    if times.is_empty() || !times[0].is_finite() {
        return Err(PageError::BadTimes { name: name(), frame: 0 });
    }
    // Written so that a NaN does not count as rising.
    if let Some(k) = times.windows(2).position(|t| !(t[1] > t[0] && t[1].is_finite())) {
        return Err(PageError::BadTimes { name: name(), frame: k + 1 });
    }
    match motion.positions_m.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
        Some(at) => Err(PageError::NotFinite { name: name(), frame: at / expected }),
        None => Ok(()),
    }
}

/// Every frame, or every second, third … so that about [`SHOWN_RATE_HZ`] and at most [`MAX_FRAMES`] are left.
fn kept_frames(times_secs: &[f64]) -> Vec<usize> {
    let n = times_secs.len();
    let span = times_secs[n - 1] - times_secs[0];
    let rate_hz = if span > 0.0 { (n - 1) as f64 / span } else { SHOWN_RATE_HZ };
    let stride = ((rate_hz / SHOWN_RATE_HZ).round() as usize).max(n.div_ceil(MAX_FRAMES)).max(1);
    (0..n).step_by(stride).collect()
}

/// Every strand, or every second, third … so that the motion fits into the page.
fn kept_strands(counts: &[usize], n_frames: usize) -> Vec<usize> {
    let n_points: usize = counts.iter().sum();
    let stride = (n_points * n_frames).div_ceil(MAX_POINT_FRAMES).max(1);
    (0..counts.len()).step_by(stride).collect()
}

/// The chosen strands' control points at a time, linear between frames, held before the first and after the last.
fn positions_at(motion: &StrandMotion, time_secs: f64, strands: &[usize]) -> Vec<[f64; 3]> {
    let times = &motion.times_secs;
    let after = times.partition_point(|&t| t < time_secs).min(times.len() - 1);
    let before = if times[after] <= time_secs { after } else { after.saturating_sub(1) };
    let gap = times[after] - times[before];
    let share = if gap > 0.0 { ((time_secs - times[before]) / gap).clamp(0.0, 1.0) } else { 0.0 };
    let mut positions = Vec::new();
    for &strand in strands {
        for (a, b) in motion.strand(before, strand).iter().zip(motion.strand(after, strand)) {
            positions.push([0, 1, 2].map(|c| f64::from(a[c]) + share * (f64::from(b[c]) - f64::from(a[c]))));
        }
    }
    positions
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_screen_rate_is_kept_and_long_motions_are_bounded() {
        let times = |n: u32, rate: f64| (0..n).map(|k| f64::from(k) / rate).collect::<Vec<_>>();
        assert_eq!(kept_frames(&times(300, 60.0)).len(), 300);
        assert_eq!(kept_frames(&times(600, 120.0)).len(), 300);
        assert_eq!(kept_frames(&times(120, 24.0)).len(), 120);
        assert!(kept_frames(&times(100_000, 60.0)).len() <= MAX_FRAMES);
        assert_eq!(kept_frames(&[7.0]), [0]);
        assert_eq!(kept_strands(&[10; 60], 300).len(), 60);
        assert_eq!(kept_strands(&[100; 600], 300), (0..600).step_by(30).collect::<Vec<_>>());
    }

    #[test]
    fn another_motion_is_read_at_this_ones_times() {
        let motion = StrandMotion {
            counts: vec![1, 1],
            times_secs: vec![0.0, 1.0, 3.0],
            positions_m: [0.0, 9.0, 1.0, 9.0, 5.0, 9.0].map(|x| [x, 0.0, 0.0]).to_vec(),
        };
        for (t, x) in [(-1.0, 0.0), (0.0, 0.0), (0.25, 0.25), (1.0, 1.0), (2.0, 3.0), (9.0, 5.0)] {
            assert_eq!(positions_at(&motion, t, &[0]), [[x, 0.0, 0.0]], "{t}");
        }
    }
}
