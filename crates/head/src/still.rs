use rayon::prelude::*;
use tousle_core::{FrameSpan, HeadCapture, Track, Vec3, median, runs};

/// Frames in which hair was seen to hang still, though nobody said so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StillFound {
    /// The frames.
    pub span: FrameSpan,
    /// How far a marker moves within a quarter of a second there, without the cameras' noise, rms over nine tenths of them, m.
    pub moves_m: f64,
    /// How far it moves in the liveliest tenth of the capture, m.
    pub moves_else_m: f64,
}

/// How long hair is watched to tell whether it moves, s: a quarter of the swing of a long lock.
const WINDOW_SECS: f64 = 0.25;

/// The most that still hair moves meanwhile, m. Hair at rest is seen to move by 0.05 mm, in the steadiest wind by 1 to 2 mm.
const MOST_M: f64 = 0.5e-3;

/// The most that it moves, of what it moves where the capture is liveliest: a steady wind that blows from the first frame to the
/// last bends hair and moves it little, but not so much less at one time than at others.
const MOST_OF_LIVELY: f64 = 0.1;

/// What is left out at either end, s: motion starts slowly, and the last swings of hair that comes to rest are small.
const MARGIN_SECS: f64 = 0.1;

/// The longest time in which all hair hangs still, for sessions that do not say when that was.
///
/// In: the locks in head space, m. Out: `None` if there is no such time of a quarter of a second, or nothing ever moves (then
/// nothing tells rest from a wind that never changes). White noise is no motion: half the mean squared difference of successive
/// samples is taken off their variance (von Neumann 1941, "Distribution of the ratio of the mean square successive difference
/// to the variance"), so that noisy captures need no other limit.
pub fn find_still(head: &HeadCapture) -> Option<StillFound> {
    let frames_of = |secs: f64| ((secs * head.rate_hz).round() as usize).max(1);
    let window = frames_of(WINDOW_SECS).max(6);
    let moves_m = motion(head, window);
    let mut known: Vec<f64> = moves_m.iter().copied().filter(|m| m.is_finite()).collect();
    known.sort_by(f64::total_cmp);
    let moves_else_m = *known.get(known.len() * 9 / 10)?;

    let most_m = MOST_M.min(MOST_OF_LIVELY * moves_else_m);
    let quiet = runs(moves_m.len(), |start| moves_m[start] <= most_m);
    // The first of the longest: hair that was never blown hangs best.
    let longest = quiet.iter().rev().max_by_key(|starts| starts.len())?;
    let still_m = median(moves_m[longest.clone()].to_vec())?;
    let (first, end) = (longest.start, longest.end - 1 + window);
    let margin = frames_of(MARGIN_SECS);
    let first = if first == 0 { first } else { first + margin };
    let end = if end == head.n_frames() { end } else { end - margin };
    (end >= first + window).then(|| StillFound {
        span: FrameSpan::of(head.first_frame, &(first..end)),
        moves_m: still_m,
        moves_else_m,
    })
}

/// How far markers move in the window that starts at each frame, without white noise, rms over the nine tenths that move least,
/// m; NaN where fewer than half the markers were seen.
fn motion(head: &HeadCapture, window: usize) -> Vec<f64> {
    let n_starts = (head.n_frames() + 1).saturating_sub(window);
    let tracks: Vec<&Track> = head.strands.iter().flat_map(|strand| &strand.markers).collect();
    let of_track: Vec<Vec<f64>> = tracks.par_iter().map(|track| squares(track, window, n_starts)).collect();
    let at = |start: usize| {
        let mut seen: Vec<f64> = of_track.iter().map(|m| m[start]).filter(|m| m.is_finite()).collect();
        if seen.is_empty() || 2 * seen.len() < tracks.len() {
            return f64::NAN;
        }
        seen.sort_by(f64::total_cmp);
        seen.truncate((seen.len() * 9).div_ceil(10));
        (seen.iter().sum::<f64>() / seen.len() as f64).max(0.0).sqrt()
    };
    (0..n_starts).into_par_iter().map(at).collect()
}

/// Variance of a marker in each window less that of white noise, m², both over the three axes; NaN where it was seen in fewer than
/// two thirds of the frames.
fn squares(track: &Track, window: usize, n_starts: usize) -> Vec<f64> {
    // About the mean, so that nothing is lost in differences of running sums.
    let mean = track.mean().unwrap_or_default();
    let mut sums = Vec::with_capacity(track.n_frames() + 1);
    let mut sum = Sums::default();
    sums.push(sum);
    let mut before = None;
    for position in track.iter() {
        let position = position.map(|p| p - mean);
        if let Some(p) = position {
            sum.n += 1.0;
            sum.position += p;
            sum.square += p.norm_squared();
        }
        if let (Some(p), Some(before)) = (position, before) {
            let difference: Vec3 = p - before;
            sum.n_differences += 1.0;
            sum.difference_square += difference.norm_squared();
        }
        before = position;
        sums.push(sum);
    }
    let at = |start: usize| {
        // A difference belongs to the window of its later sample; that of the first reaches out of it, which is no matter.
        let (a, b) = (&sums[start], &sums[start + window]);
        let (n, n_differences) = (b.n - a.n, b.n_differences - a.n_differences);
        if 3.0 * n < 2.0 * window as f64 || n_differences < 2.0 {
            return f64::NAN;
        }
        let variance = (b.square - a.square - (b.position - a.position).norm_squared() / n) / (n - 1.0);
        variance - 0.5 * (b.difference_square - a.difference_square) / n_differences
    };
    (0..n_starts).map(at).collect()
}

/// Running sums over the frames of a track.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    n: f64,
    position: Vec3,
    square: f64,
    n_differences: f64,
    difference_square: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::StrandTracks;

    const N_FRAMES: usize = 480;

    /// Noise without a seed to choose: the golden ratio's multiples, uniform within ±√3.
    fn noise(k: usize) -> f64 {
        let fraction = (k as f64 * 0.618_033_988_749_895 * (1.0 + (k % 7) as f64)).fract();
        (fraction - 0.5) * 12.0_f64.sqrt()
    }

    /// Twenty markers that follow `at`, each a little otherwise, with noise of 0.2 mm.
    fn capture(at: impl Fn(usize) -> f64) -> HeadCapture {
        let track = |marker: usize| {
            (0..N_FRAMES)
                .map(|frame| {
                    let noise = |axis| 0.2e-3 * noise(3 * (frame * 31 + marker * 977) + axis);
                    let x = at(frame) * (0.5 + marker as f64 / 20.0);
                    Some(Vec3::new(0.1 + x + noise(0), noise(1), noise(2)))
                })
                .collect()
        };
        HeadCapture {
            rate_hz: 120.0,
            first_frame: 1001,
            poses: vec![None; N_FRAMES],
            strands: vec![StrandTracks { strand_idx: 0, markers: (0..20).map(track).collect() }],
            unlabeled: Vec::new(),
        }
    }

    fn swing(frame: usize) -> f64 {
        0.02 * libm::sin(frame as f64 / 15.0)
    }

    #[test]
    fn rest_is_found_to_a_tenth_of_a_second_wherever_it_is() {
        let before = find_still(&capture(|k| if k < 150 { 0.0 } else { swing(k - 150) })).unwrap();
        assert_eq!(before.span.first_frame, 1001);
        assert!((1001 + 130..1001 + 150).contains(&before.span.last_frame), "{before:?}");
        assert!(before.moves_m < 0.1e-3 && before.moves_else_m > 5e-3, "{before:?}");
        let after = find_still(&capture(|k| if k > 300 { swing(300) } else { swing(k) })).unwrap();
        assert!((1001 + 300..1001 + 320).contains(&after.span.first_frame), "{after:?}");
        assert_eq!(after.span.last_frame, 1000 + 480);
    }

    /// Gaps, and a marker that flies off, do not hide that the others hang still.
    #[test]
    fn a_bad_marker_and_gaps_do_not_matter() {
        let mut head = capture(|k| if k < 150 { 0.0 } else { swing(k - 150) });
        for (marker, track) in head.strands[0].markers.iter_mut().enumerate() {
            (5 * marker..5 * marker + 20).for_each(|frame| track.set(frame, None));
        }
        (60..70).for_each(|frame| head.strands[0].markers[3].set(frame, Some(Vec3::repeat(0.5))));
        let found = find_still(&head).unwrap().span;
        assert_eq!(found.first_frame, 1001);
        assert!(found.last_frame > 1001 + 130, "{found:?}");
    }

    /// Neither hair that always swings, nor hair that never moves, nor a moment at the end of a swing.
    #[test]
    fn nothing_is_found_where_nothing_rests() {
        assert_eq!(find_still(&capture(swing)), None);
        assert_eq!(find_still(&capture(|_| 0.0)), None);
        // A steady wind: hair trembles by a millimeter throughout, a little less for a while.
        let steady = |k: usize| swing(4 * k) / 20.0 * if k < 200 { 0.4 } else { 1.0 };
        assert_eq!(find_still(&capture(steady)), None);
        assert_eq!(find_still(&HeadCapture { strands: Vec::new(), ..capture(swing) }), None);
    }
}
