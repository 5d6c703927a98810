use crate::stiffness::Stiffness;
use serde::Serialize;

/// What happened when a wind was refined.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RefineReport {
    /// The locks that were held out to say when to stop.
    pub held_out: Vec<String>,
    /// How stiff all locks were found to be, before any was asked by itself; `None` where nobody knows how they hung at rest, or
    /// nothing was seen after that, and they are taken for as stiff as is likely.
    pub stiffness: Option<Stiffness>,
    /// Before the first round, and after each; with some locks held out, if any were.
    pub rounds: Vec<Round>,
    /// Rounds that were gone with all locks and kept: 0 means that the wind is as it was measured.
    pub kept: usize,
}

/// A wig that is off by more than this share of how far it moved is believed less: on captures of all that a session should
/// have it is 0.03 to 0.1.
const DOUBTFUL_SHARE: f64 = 0.2;

/// Whatever the share, a wig that is off by less is not doubted, m: hair that hardly moves.
const LEAST_DOUBTFUL_M: f64 = 4e-3;

impl RefineReport {
    /// Says so where the wig does not move in the wind that is kept as it was seen to move: then something that was taken for
    /// granted is wrong.
    pub fn doubt(&self) -> Option<String> {
        let Round { seen_m: off_m, share_of_motion, .. } = *self.rounds.get(self.kept)?;
        if off_m == f64::INFINITY {
            return Some(
                "found no marker after the still frames that the simulated wig could be compared with, expected some: nothing \
                 says how good this wind is"
                    .to_owned(),
            );
        }
        let is_off = off_m >= LEAST_DOUBTFUL_M && share_of_motion >= DOUBTFUL_SHARE;
        (off_m.is_nan() || share_of_motion.is_nan() || is_off).then(|| {
            format!(
                "found the captured wig, simulated in this wind, off by {:.0} mm, {:.0} % of how far it moved, expected \
                 10 % at most: is the session right (still frames, up axis, places of roots, colliders)?",
                off_m * 1e3,
                share_of_motion * 1e2
            )
        })
    }
}

/// How far the simulated markers are from the seen ones: the root mean square over a lock's markers and frames, geometric mean
/// over locks, m. So a lock that falls to the other side of a shoulder counts as one lock.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Round {
    /// Of the locks that the wind was measured from.
    pub seen_m: f64,
    /// Of those that were held out; `None` if none were.
    pub held_out_m: Option<f64>,
    /// Of all locks over how far they went from where they were when the wind began. 1 is as good as never moving.
    pub share_of_motion: f64,
}

impl Round {
    /// How far those locks are off that say whether a round served, m.
    pub fn judged_m(&self) -> f64 {
        self.held_out_m.unwrap_or(self.seen_m)
    }
}

/// What a round must make better to be worth going, as a share: less may be chance, as locks that are held out are few.
const WORTH: f64 = 0.01;

/// After how many rounds those that judge are nearest; 0 unless it is worth it.
pub(crate) fn best(rounds: &[Round]) -> usize {
    let mut best = 0;
    for (k, round) in rounds.iter().enumerate() {
        if round.judged_m() < rounds[best].judged_m() * (1.0 - WORTH) {
            best = k;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wig_that_moves_otherwise_is_doubted() {
        let report = |kept: usize, rounds: &[(f64, f64)]| RefineReport {
            held_out: Vec::new(),
            stiffness: None,
            rounds: rounds
                .iter()
                .map(|(seen_m, share)| Round { seen_m: *seen_m, held_out_m: None, share_of_motion: *share })
                .collect(),
            kept,
        };
        assert_eq!(report(1, &[(0.05, 0.5), (0.005, 0.05)]).doubt(), None);
        let doubt = report(1, &[(0.08, 0.8), (0.01, 0.3)]).doubt();
        assert!(doubt.is_some_and(|words| words.contains("off by 10 mm, 30 %")));
        assert_eq!(report(0, &[(0.001, 0.3)]).doubt(), None, "it hardly moved");
        let doubt = report(0, &[(f64::INFINITY, 1.0)]).doubt();
        assert!(doubt.is_some_and(|words| words.contains("no marker after the still frames")));
        assert!(report(0, &[(f64::NAN, f64::NAN)]).doubt().is_some());
    }

    #[test]
    fn it_stops_where_those_held_out_are_nearest() {
        let rounds = |held_out: &[f64]| -> Vec<Round> {
            held_out
                .iter()
                .map(|m| Round { seen_m: 0.0, held_out_m: Some(*m), share_of_motion: 0.0 })
                .collect()
        };
        assert_eq!(best(&rounds(&[10.0, 8.0, 9.0])), 1);
        assert_eq!(best(&rounds(&[10.0, 9.95, 11.0])), 0);
        assert_eq!(best(&rounds(&[10.0, 9.0, 8.0])), 2);
        let seen = [10.0, 9.0].map(|seen_m| Round { seen_m, held_out_m: None, share_of_motion: 0.0 });
        assert_eq!(best(&seen), 1);
    }
}
