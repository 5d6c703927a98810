//! One strand's way through a simulated motion.

use crate::EditError;
use tousle_core::{Groom, StrandMotion, Vec3};

/// One strand of a motion that fits its groom.
#[derive(Clone, Copy, Debug)]
pub struct StrandPath<'a> {
    motion: &'a StrandMotion,
    strand_idx: usize,
}

/// Checks that a motion is one of this groom, with times that increase.
pub(crate) fn check_motion(motion: &StrandMotion, groom: &Groom) -> Result<(), EditError> {
    let (frames, n_points) = (motion.times_secs.len(), motion.n_points());
    let increasing = motion.times_secs.windows(2).all(|pair| pair[0] < pair[1]);
    let fits = motion.counts == groom.counts() && motion.positions_m.len() == frames * n_points;
    if frames > 0 && fits && increasing {
        return Ok(());
    }
    Err(EditError::OtherGroom { found: n_points, frames, expected: groom.n_points() })
}

impl<'a> StrandPath<'a> {
    /// The way of a strand, by its index in the motion.
    pub fn new(motion: &'a StrandMotion, strand_idx: usize) -> Self {
        Self { motion, strand_idx }
    }

    /// The control points at a time, linear between frames, held before the first and after the last, m.
    pub fn points_at(&self, time_secs: f64) -> Vec<Vec3> {
        let times = &self.motion.times_secs;
        let after = times.partition_point(|t| *t <= time_secs).clamp(1, times.len().max(2) - 1);
        let before = after - 1;
        let frame = |k: usize| self.motion.strand(k, self.strand_idx);
        if times.len() == 1 {
            return frame(0).iter().map(single).collect();
        }
        let share = ((time_secs - times[before]) / (times[after] - times[before])).clamp(0.0, 1.0);
        frame(before).iter().zip(frame(after)).map(|(a, b)| single(a).lerp(&single(b), share)).collect()
    }

    /// The control points' velocities at a time, m/s, from the two frames around it.
    pub(crate) fn velocities_at(&self, time_secs: f64) -> Vec<Vec3> {
        let times = &self.motion.times_secs;
        let half = self.frame_secs() / 2.0;
        let (from, to) = (time_secs - half, time_secs + half);
        let held = |t: f64| t.clamp(times[0], times[times.len() - 1]);
        let span = held(to) - held(from);
        let moved = self.points_at(to).into_iter().zip(self.points_at(from));
        moved.map(|(b, a)| if span > 0.0 { (b - a) / span } else { Vec3::zeros() }).collect()
    }

    /// The mean time between two frames, s; 0 of a single frame.
    pub(crate) fn frame_secs(&self) -> f64 {
        let times = &self.motion.times_secs;
        (times[times.len() - 1] - times[0]) / (times.len().max(2) - 1) as f64
    }
}

/// A stored position, m.
pub(crate) fn single(position: &[f32; 3]) -> Vec3 {
    Vec3::from(position.map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A root that stays and a tip that moves by 0.1 m a frame, at 10 Hz.
    fn motion() -> StrandMotion {
        let frame = |k: u8| [[0.0; 3], [0.1 * f32::from(k), 0.0, -0.1]];
        StrandMotion {
            counts: vec![2],
            times_secs: (0..4).map(|k| f64::from(k) / 10.0).collect(),
            positions_m: (0..4).flat_map(frame).collect(),
        }
    }

    #[test]
    fn a_path_is_linear_between_frames_and_held_outside() {
        let motion = motion();
        let path = StrandPath::new(&motion, 0);
        for (t, x) in [(-1.0, 0.0), (0.0, 0.0), (0.15, 0.15), (0.3, 0.3), (9.0, 0.3)] {
            assert!((path.points_at(t)[1].x - x).abs() < 1e-7, "{t}");
        }
        assert!((path.velocities_at(0.15)[1].x - 1.0).abs() < 1e-6);
        assert!((path.velocities_at(0.0)[1].x - 1.0).abs() < 1e-6);
    }
}
