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
    check_times(&motion.times_secs)?;
    for (frame, positions_m) in motion.positions_m.chunks_exact(n_points.max(1)).enumerate() {
        check_frame(frame, positions_m)?;
    }
    Ok(())
}

/// Checks that every time is a number.
pub(crate) fn check_times(times_secs: &[f64]) -> Result<(), ExportError> {
    match times_secs.iter().position(|t| !t.is_finite()) {
        None => Ok(()),
        Some(frame) => {
            let found = format!("time {} of frame {frame}", times_secs[frame]);
            Err(ExportError::BadMotion { found, expected: "a finite number".into() })
        }
    }
}

/// Checks that every position of a frame is one.
pub(crate) fn check_frame(frame: usize, positions_m: &[[f32; 3]]) -> Result<(), ExportError> {
    match positions_m.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
        None => Ok(()),
        Some(point) => {
            let found = format!("{:?} in frame {frame}, point {point}", positions_m[point]);
            Err(ExportError::BadMotion { found, expected: "finite numbers".into() })
        }
    }
}
