use crate::{TrueMotion, TruthError};
use std::ops::Range;
use tousle_core::{HeadCapture, Session, Track, Vec3};

/// What is done to a capture before it is measured: always the same for the same capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Worse {
    /// Nothing.
    Not,
    /// It is made better: every marker is where it really was in every frame, under its own name.
    Clean,
    /// Of each lock the second, fourth … marker from the tip inwards was never seen.
    EverySecondMarker,
    /// Only so many locks were seen, evenly from all.
    Locks(usize),
    /// White noise of this standard deviation more in every coordinate, m.
    Noise(f64),
    /// This share of all samples more is missing, in gaps of a quarter of a second.
    Gaps(f64),
    /// Nobody saw the locks before the wind blew, and no frame is named in which they hang still.
    RestUnseen,
}

/// Length of a gap, s.
const GAP_SECS: f64 = 0.25;

/// How long after the still frames locks are hidden too where they were never seen at rest, s: it takes the wind so long to move them.
const ONSET_SECS: f64 = 0.2;

impl Worse {
    /// What is known of a capture that is made worse.
    #[must_use]
    pub fn known(self, session: &Session) -> Session {
        let still_frames = session.still_frames.filter(|_| self != Self::RestUnseen);
        Session { still_frames, ..session.clone() }
    }

    /// A capture made worse, or as clean as its truth.
    ///
    /// # Errors
    /// Whatever keeps the truth from being read.
    pub fn applied(
        self,
        head: &HeadCapture,
        session: &Session,
        truth: impl FnOnce() -> Result<TrueMotion, TruthError>,
    ) -> Result<HeadCapture, TruthError> {
        Ok(match self {
            Self::Clean => cleaned(head, &truth()?),
            _ => self.worsened(head, session),
        })
    }

    fn worsened(self, head: &HeadCapture, session: &Session) -> HeadCapture {
        let mut worse = head.clone();
        let n_strands = worse.strands.len();
        let strands = &mut worse.strands;
        match self {
            Self::Not | Self::Clean => {}
            Self::EverySecondMarker => strands
                .iter_mut()
                .flat_map(|strand| strand.markers.iter_mut().rev().skip(1).step_by(2))
                .for_each(hide),
            Self::Locks(n) => strands
                .iter_mut()
                .enumerate()
                .filter(|(strand_idx, _)| is_left_out(*strand_idx, n_strands, n))
                .flat_map(|(_, strand)| &mut strand.markers)
                .for_each(hide),
            Self::Noise(sd_m) => {
                let mut dice = Dice(1);
                for track in strands.iter_mut().flat_map(|strand| &mut strand.markers) {
                    *track = track.map(|_, p| Some(p + Vec3::from_fn(|_, _| sd_m * dice.normal())));
                }
            }
            Self::Gaps(share) => {
                let gap_frames = (GAP_SECS * head.rate_hz).round().max(1.0) as usize;
                let mut dice = Dice(1);
                for track in strands.iter_mut().flat_map(|strand| &mut strand.markers) {
                    let n_gaps = (share * track.n_frames() as f64 / gap_frames as f64).round() as usize;
                    for _ in 0..n_gaps {
                        let first = (dice.even() * track.n_frames() as f64) as usize;
                        hide_frames(track, first..first + gap_frames);
                    }
                }
            }
            Self::RestUnseen => {
                let still = session.still_range(head.first_frame, head.n_frames());
                let onset_frames = (ONSET_SECS * head.rate_hz).round() as usize;
                let blown_from = still.map_or(0, |(_, last)| last + 1 + onset_frames);
                strands
                    .iter_mut()
                    .flat_map(|strand| &mut strand.markers)
                    .for_each(|track| hide_frames(track, 0..blown_from));
            }
        }
        worse
    }
}

/// The true markers, in the order of the session's; where the truth ends, its last place.
fn cleaned(head: &HeadCapture, truth: &TrueMotion) -> HeadCapture {
    let (n_points, last) = (truth.n_points(), truth.times_secs.len().saturating_sub(1));
    let place = |frame: usize, point: usize| {
        truth.positions_m.get(frame.min(last) * n_points + point).map(|p| Vec3::from(p.map(f64::from)))
    };
    let mut clean = HeadCapture { unlabeled: Vec::new(), ..head.clone() };
    for (point, track) in clean.strands.iter_mut().flat_map(|s| &mut s.markers).enumerate() {
        *track = (0..head.n_frames()).map(|frame| place(frame, point)).collect();
    }
    clean
}

fn hide(track: &mut Track) {
    *track = Track::missing(track.n_frames());
}

/// Hides those of these frames that the track has.
fn hide_frames(track: &mut Track, frames: Range<usize>) {
    (frames.start..frames.end.min(track.n_frames())).for_each(|frame| track.set(frame, None));
}

/// Whether a lock is not among `n` that are spread evenly over all.
fn is_left_out(strand_idx: usize, n_strands: usize, n: usize) -> bool {
    strand_idx * n / n_strands == (strand_idx + 1) * n / n_strands
}

/// Numbers without a pattern (Steele, Lea and Flood's splitmix64, 2014).
struct Dice(u64);

impl Dice {
    /// Evenly from 0 to 1.
    fn even(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Of a bell of variance 1: twelve even numbers added up, which is one to three digits.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.even()).sum::<f64>() - 6.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn locks_are_left_out_evenly() {
        let kept = |n| (0..27).filter(|k| !is_left_out(*k, 27, n)).count();
        assert_eq!([kept(27), kept(14), kept(7)], [27, 14, 7]);
    }

    #[test]
    fn dice_have_the_variance_they_say() {
        let mut dice = Dice(1);
        let square: f64 = (0..10_000).map(|_| dice.normal()).map(|x| x * x).sum();
        assert!((square / 10_000.0 - 1.0).abs() < 0.05, "{square}");
    }
}
