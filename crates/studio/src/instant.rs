//! A motion at one time.

use tousle_core::{StrandMotion, Vec3};

/// The control points of all strands at a time, linear between frames, held before the first and after the last.
///
/// Strand after strand, root first, head space, m. Empty of a motion without frames.
pub fn points_at(motion: &StrandMotion, time_secs: f64) -> Vec<[f32; 3]> {
    let times = &motion.times_secs;
    let Some(last) = times.len().checked_sub(1) else { return Vec::new() };
    let after = times.partition_point(|t| *t <= time_secs).min(last);
    let before = after.saturating_sub(1);
    let span = times[after] - times[before];
    let share = if span > 0.0 { ((time_secs - times[before]) / span).clamp(0.0, 1.0) as f32 } else { 0.0 };
    let (from, to) = (motion.frame(before), motion.frame(after));
    let between = |(a, b): (&[f32; 3], &[f32; 3])| std::array::from_fn(|c| a[c] + (b[c] - a[c]) * share);
    from.iter().zip(to).map(between).collect()
}

/// The way of one control point: its place in each frame of a span of time, head space, m.
pub fn way(motion: &StrandMotion, strand_idx: usize, point: usize, span_secs: [f64; 2]) -> Vec<Vec3> {
    let within = |t: f64| t >= span_secs[0] - 1e-9 && t <= span_secs[1] + 1e-9;
    let frames = motion.times_secs.iter().enumerate().filter(|(_, t)| within(**t));
    frames.map(|(frame, _)| single(motion.strand(frame, strand_idx)[point])).collect()
}

/// A stored position, m.
pub fn single(position: [f32; 3]) -> Vec3 {
    Vec3::from(position.map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_linear_between_frames_and_held_outside() {
        let motion = StrandMotion {
            counts: vec![1],
            times_secs: vec![1.0, 2.0, 3.0],
            positions_m: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0]],
        };
        for (t, expected) in [
            (0.0, [0.0; 3]),
            (1.5, [0.5, 0.0, 0.0]),
            (2.0, [1.0, 0.0, 0.0]),
            (2.5, [1.0, 1.0, 0.0]),
            (3.0, [1.0, 2.0, 0.0]),
            (9.0, [1.0, 2.0, 0.0]),
        ] {
            assert_eq!(points_at(&motion, t), [expected], "{t}");
        }
        assert_eq!(way(&motion, 0, 0, [2.0, 3.0]), [Vec3::new(1.0, 0.0, 0.0), Vec3::new(1.0, 2.0, 0.0)]);
    }
}
