use super::quantize::{Quantization, quantize};
use crate::Packed;
use serde::Serialize;
use tousle_core::{HeadCapture, Session};

/// The captured markers as the page's script gets them.
#[derive(Serialize)]
pub(super) struct MarkerData {
    /// The locks' names, in the capture's order.
    names: Vec<String>,
    /// Markers of each lock.
    counts: Vec<usize>,
    /// Frames a second of the positions.
    rate_hz: f64,
    n_frames: usize,
    #[serde(flatten)]
    quantization: Quantization,
    positions: Packed,
    visible: VisibleData,
}

/// How many of a lock's markers were seen, over time: what the timeline shows.
#[derive(Serialize)]
struct VisibleData {
    /// Columns of the timeline; each stands for the same number of frames, the last perhaps for fewer.
    n_columns: usize,
    secs_per_column: f64,
    /// Row after row (lock after lock), the share of the samples that were seen, in 255ths.
    shares: Packed,
    /// Column after column, the share of the frames in which the head's pose was found, in 255ths.
    head: Packed,
}

/// Frames a second of the markers shown.
const SHOWN_RATE_HZ: f64 = 60.0;

/// Frames and columns that a page carries at most: a minute at 60 a second, and the pixels of a wide screen.
const MAX_FRAMES: usize = 3_600;
const MAX_COLUMNS: usize = 1_500;

/// Packs the markers' positions and the timeline of their visibility.
pub(super) fn marker_data(capture: &HeadCapture, session: &Session, blobs: &mut Vec<Packed>) -> MarkerData {
    let n = capture.n_frames();
    let stride = ((capture.rate_hz / SHOWN_RATE_HZ).round() as usize).max(n.div_ceil(MAX_FRAMES)).max(1);
    let tracks = || capture.strands.iter().flat_map(|s| &s.markers);
    let frames: Vec<usize> = (0..n).step_by(stride).collect();
    let positions: Vec<Option<[f64; 3]>> =
        frames.iter().flat_map(|&f| tracks().map(move |track| track.at(f).map(Into::into))).collect();
    let (quantization, values) = quantize(&positions);
    let row = 3 * tracks().count();
    let packed = Packed::new("markers", &values, &[&[row], &[row, row]]);
    blobs.push(packed.clone());
    let name = |idx: usize| session.strands.get(idx).map_or_else(|| format!("#{idx}"), |s| s.name.clone());
    MarkerData {
        names: capture.strands.iter().map(|s| name(s.strand_idx)).collect(),
        counts: capture.strands.iter().map(|s| s.markers.len()).collect(),
        rate_hz: capture.rate_hz / stride as f64,
        n_frames: frames.len(),
        quantization,
        positions: packed,
        visible: visible_data(capture, blobs),
    }
}

fn visible_data(capture: &HeadCapture, blobs: &mut Vec<Packed>) -> VisibleData {
    let n = capture.n_frames();
    let per_column = n.div_ceil(MAX_COLUMNS).max(1);
    let n_columns = n.div_ceil(per_column);
    let columns = || (0..n_columns).map(|c| c * per_column..((c + 1) * per_column).min(n));
    let shares: Vec<i16> = capture
        .strands
        .iter()
        .flat_map(|strand| {
            columns().map(|frames| {
                let samples = || frames.clone().flat_map(|f| strand.markers.iter().map(move |m| m.at(f)));
                in_255ths(samples().flatten().count(), samples().count())
            })
        })
        .collect();
    let head: Vec<i16> = columns()
        .map(|frames| in_255ths(capture.poses[frames.clone()].iter().flatten().count(), frames.len()))
        .collect();
    let shares = Packed::new("visible", &shares, &[&[1], &[]]);
    let head = Packed::new("head-seen", &head, &[&[1], &[]]);
    blobs.extend([shares.clone(), head.clone()]);
    VisibleData { n_columns, secs_per_column: per_column as f64 / capture.rate_hz, shares, head }
}

/// 0 only if nothing was seen, 255 only if everything was: a single lost sample must show.
fn in_255ths(seen: usize, of: usize) -> i16 {
    match (seen, of) {
        (0, _) => 0,
        (seen, of) if seen >= of => 255,
        (seen, of) => (255 * seen / of).clamp(1, 254) as i16,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_lost_sample_shows() {
        assert_eq!(in_255ths(0, 5), 0);
        assert_eq!(in_255ths(5, 5), 255);
        assert_eq!(in_255ths(9_999, 10_000), 254);
        assert_eq!(in_255ths(1, 10_000), 1);
        assert_eq!(in_255ths(0, 0), 0);
    }
}
