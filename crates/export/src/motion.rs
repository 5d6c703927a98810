use tousle_core::StrandMotion;

use crate::ExportError;

/// Checks that a motion's arrays fit together and every number is finite, so that no writer has to.
pub(crate) fn check_motion(motion: &StrandMotion) -> Result<(), ExportError> {
    let bad = |found: String, expected: String| Err(ExportError::BadMotion { found, expected });
    let n_points = motion.n_points();
    let n_expected = n_points.saturating_mul(motion.times_secs.len());
    if motion.positions_m.len() != n_expected {
        return bad(
            format!("{} positions", motion.positions_m.len()),
            format!("{n_expected}, which is {n_points} points in {} frames", motion.times_secs.len()),
        );
    }
    if let Some(frame) = motion.times_secs.iter().position(|t| !t.is_finite()) {
        return bad(format!("time {} of frame {frame}", motion.times_secs[frame]), "a finite number".into());
    }
    if let Some(at) = motion.positions_m.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
        let (frame, point) = (at / n_points, at % n_points);
        let found = format!("{:?} in frame {frame}, point {point}", motion.positions_m[at]);
        return bad(found, "finite numbers".into());
    }
    Ok(())
}
