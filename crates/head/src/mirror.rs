//! A head that is seen as in a mirror: left and right exchanged under all labels, or a left-handed export.

use crate::registration::{Pair, least_squares, register};
use tousle_core::{Session, Track, Vec3};

/// How a mirrored head fits.
#[derive(Clone, Debug)]
pub(crate) struct Mirrored {
    /// Labels of the markers that fit in the mirror.
    pub labels: Vec<String>,
    /// Root mean square distance of these from their places in the mirror, m.
    pub mirrored_m: f64,
    /// The same from their places as the session has them, m.
    pub as_labeled_m: f64,
}

/// Frames that are asked. More of them only take time: a mirrored head is one throughout.
const MOST_ASKED: usize = 100;

/// How much better the mirror must fit. A face whose markers lie nearly in a plane fits it about as well as itself; one with a nose
/// and a neck is off by centimeters, some twenty times what hands measure wrong.
const TIMES_BETTER: f64 = 3.0;

/// One frame's answer.
enum Answer {
    /// The markers are where their labels say.
    AsLabeled,
    /// They are where the mirror has them.
    Mirrored(Mirrored),
}

/// Whether the head's markers fit the mirrored places of the session, and not the places themselves.
///
/// A mirrored head looks like a head: each of its markers would be moved to where its label was seen, and all would agree on a face
/// that looks the other way. No pose comes from it that means anything, and which of the two is wrong (all labels, the capture's
/// axes, the session's) nobody can tell from the head. Only frames are heard in which all markers but one agree, at rest if the
/// session knows when: a pair that is exchanged leaves the others where they are, and is mended later.
pub(crate) fn mirrored(
    tracks: &[Track],
    session: &Session,
    still: Option<(usize, usize)>,
    tolerance_m: f64,
) -> Option<Mirrored> {
    let n_frames = tracks.first().map_or(0, Track::n_frames);
    let (first, last) = still.unwrap_or((0, n_frames.checked_sub(1)?));
    let step = (last - first + 1).div_ceil(MOST_ASKED);
    let places: Vec<Vec3> = session.head_markers.iter().map(|m| m.position_m).collect();
    let (mut n_as_labeled, mut in_mirror) = (0, Vec::new());
    for frame in (first..=last).step_by(step) {
        let pairs: Vec<Pair> = tracks
            .iter()
            .zip(&places)
            .enumerate()
            .filter_map(|(marker, (track, &place_m))| {
                Some(Pair { marker, place_m, seen_m: track.at(frame)? })
            })
            .collect();
        match ask(&pairs, session, tolerance_m) {
            Some(Answer::AsLabeled) => n_as_labeled += 1,
            Some(Answer::Mirrored(found)) => in_mirror.push(found),
            None => {}
        }
    }
    // Labels that were all exchanged for a part of the capture only are mended by the rest of it.
    if 10 * n_as_labeled >= in_mirror.len() {
        return None;
    }
    in_mirror.sort_by(|a, b| a.mirrored_m.total_cmp(&b.mirrored_m));
    let middle = in_mirror.len() / 2;
    Some(in_mirror.swap_remove(middle))
}

fn ask(pairs: &[Pair], session: &Session, tolerance_m: f64) -> Option<Answer> {
    // Three markers are as good as their mirror image.
    let least = pairs.len().saturating_sub(1).max(4);
    let trust = vec![1.0; session.head_markers.len()];
    let n_as_labeled = register(pairs, &trust, tolerance_m).map_or(0, |r| r.used.len());
    // Across which plane is no matter, as a turn makes any of them of one.
    let in_mirror = |p: &Pair| Pair { place_m: Vec3::new(p.place_m.x, -p.place_m.y, p.place_m.z), ..*p };
    let in_mirror: Vec<Pair> = pairs.iter().map(in_mirror).collect();
    if let Some(found) = register(&in_mirror, &trust, tolerance_m)
        && found.used.len() >= least
        && found.used.len() > n_as_labeled
    {
        let used: Vec<Pair> = found.used.iter().map(|&k| pairs[k]).collect();
        let as_labeled_m = rms_m(&used)?;
        if as_labeled_m > f64::max(TIMES_BETTER * found.residual_m, tolerance_m) {
            let labels = used.iter().map(|p| session.head_markers[p.marker].label.clone()).collect();
            return Some(Answer::Mirrored(Mirrored { labels, mirrored_m: found.residual_m, as_labeled_m }));
        }
    }
    (n_as_labeled >= least).then_some(Answer::AsLabeled)
}

/// Root mean square distance of markers from their places after the best rigid fit, m.
fn rms_m(pairs: &[Pair]) -> Option<f64> {
    let pose = least_squares(pairs)?;
    let off2 = |p: &Pair| (pose.rotation * p.place_m + pose.translation.vector - p.seen_m).norm_squared();
    Some((pairs.iter().map(off2).sum::<f64>() / pairs.len() as f64).sqrt())
}
