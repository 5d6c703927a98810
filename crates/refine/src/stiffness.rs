//! How stiff the whole wig is, where the hair that was taken for likely does not move at all as it was seen to.

use crate::RefineError;
use crate::compare::Compared;
use crate::rounds::{Loop, Turn};

/// Off by more than this share of how far the markers moved, a simulated wig is made of something else. On captures of hair as
/// stiff as is likely it is a tenth at most. If it falls, more captures take longer to convert.
const FAR_OFF: f64 = 0.15;

/// By how much the stiffness of all locks is changed to see whether it serves: more than rounds learn by themselves, which go
/// by how the motion answers to a small change.
const CHANGE: f64 = 2.5;

/// What must be left of the wig's error for a change to be kept. Wind and stiffness go together: hair that is softer, in less
/// wind, moves nearly alike, so little is no evidence.
const SERVES: f64 = 2.0 / 3.0;

/// How often it is changed at most: up to 16 times, or a sixteenth.
const MOST_CHANGES: usize = 3;

/// If the wig is far off, the stiffness of all its locks is changed for as long as that brings it nearer by a third: first up,
/// then down. A lock's motion under wind tells little of its stiffness by itself, as twice the wind bends twice the
/// stiffness as far; but what inertia, weight and the air's resistance make of the motion does not change with both.
pub(crate) fn sought(
    around: &Loop<'_>,
    mut turn: Turn,
    mut compared: Compared,
    held_out: &[usize],
) -> Result<(Turn, Compared), RefineError> {
    // A number that is not finite is far off too.
    if compared.share_of_motion() < FAR_OFF {
        return Ok((turn, compared));
    }
    let off_m = |compared: &Compared| compared.round(held_out).seen_m;
    for change in [CHANGE, 1.0 / CHANGE] {
        let mut served = false;
        for _ in 0..MOST_CHANGES {
            let next = around.with_stiffness(turn.likely.stiffness * change, held_out)?;
            let of_next = around.compare(&next)?;
            let is_nearer = off_m(&of_next) < SERVES * off_m(&compared);
            if !is_nearer {
                break;
            }
            (turn, compared, served) = (next, of_next, true);
        }
        if served {
            break;
        }
    }
    Ok((turn, compared))
}
