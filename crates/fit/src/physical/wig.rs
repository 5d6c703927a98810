use super::lock::SeenLock;
use super::solve::Problem;
use tousle_core::{Groom, Session, Strand, StrandMotion};

/// The captured locks as a hairstyle that can be simulated: as they hung at rest, with the stiffness and drag that the
/// motion gave, and the weight of their markers.
#[derive(Clone, Debug, PartialEq)]
pub struct Wig {
    /// One strand a lock that could be explained, in the session's order.
    pub groom: Groom,
    /// By strand of the groom, the lock's index in the session.
    pub strand_idxs: Vec<usize>,
    /// By strand of the groom and marker of the lock, the control point that the marker sits on; `None` for a marker that was
    /// never seen at rest.
    pub marker_points: Vec<Vec<Option<usize>>>,
}

impl Wig {
    /// Where the session's markers are when the wig moves so: lock after lock, root to tip, NaN for those that the wig knows
    /// nothing of.
    ///
    /// # Panics
    /// If the motion is not of the wig's groom.
    pub fn markers(&self, motion: &StrandMotion, session: &Session) -> StrandMotion {
        let counts: Vec<usize> = session.strands.iter().map(|s| s.markers.len()).collect();
        let mut positions_m = Vec::with_capacity(motion.times_secs.len() * counts.iter().sum::<usize>());
        for frame in 0..motion.times_secs.len() {
            for (strand_idx, count) in counts.iter().enumerate() {
                let strand = self.strand_idxs.iter().position(|idx| *idx == strand_idx);
                positions_m.extend(
                    (0..*count)
                        .map(|marker_idx| {
                            let strand = strand?;
                            let point = self.marker_points[strand][marker_idx]?;
                            Some(motion.strand(frame, strand)[point])
                        })
                        .map(|place| place.unwrap_or([f32::NAN; 3])),
                );
            }
        }
        StrandMotion { counts, times_secs: motion.times_secs.clone(), positions_m }
    }
}

pub(crate) fn wig(problem: &Problem<'_>) -> Wig {
    let strand = |(lock, seen): (usize, &SeenLock)| {
        let (strand, scales) = (&seen.strand, problem.scales(lock));
        Strand {
            bending_stiffness_n_m2: strand.bending_stiffness_n_m2 * scales.stiffness,
            // Drag is in proportion to width, but for the law's slow change with it.
            lock_width_m: strand.lock_width_m * scales.drag,
            ..strand.clone()
        }
    };
    let locks = problem.locks;
    Wig {
        groom: Groom { strands: locks.iter().enumerate().map(strand).collect(), assumed: Vec::new() },
        strand_idxs: locks.iter().map(|seen| seen.strand_idx).collect(),
        marker_points: locks.iter().map(|seen| seen.marker_points.clone()).collect(),
    }
}
