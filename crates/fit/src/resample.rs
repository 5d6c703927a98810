use tousle_core::{Sample, SampleKind, Track, Vec3};

/// How many time steps of `rate_hz` a capture of `n_frames` at `frame_rate_hz` holds, the one at 0 included.
pub(crate) fn n_steps(n_frames: usize, frame_rate_hz: f64, rate_hz: f64) -> usize {
    // A hair's breadth above, so that 600 frames at 120 Hz give step 149 at 4.9667 s whatever the rounding.
    ((n_frames - 1) as f64 / frame_rate_hz * rate_hz + 1e-9) as usize + 1
}

/// The position at a time, s, linear between two frames; `None` unless every frame it rests on was seen.
pub(crate) fn position_at(track: &Track, frame_rate_hz: f64, time_secs: f64) -> Option<Vec3> {
    let place = time_secs * frame_rate_hz;
    if place < -1e-9 {
        return None;
    }
    let nearest = place.round();
    if (place - nearest).abs() < 1e-6 {
        return track.at(nearest as usize);
    }
    let before = place.floor();
    let (a, b) = (track.at(before as usize)?, track.at(before as usize + 1)?);
    Some(a + (b - a) * (place - before))
}

/// How many of the samples that are not there cleaning had filled, by the frame nearest to each step.
pub(crate) fn n_filled(
    origins: Option<&[Vec<Vec<Sample>>]>,
    frame_rate_hz: f64,
    n_steps: usize,
    rate_hz: f64,
) -> usize {
    let frame = |step: usize| (step as f64 / rate_hz * frame_rate_hz).round() as usize;
    let is_filled = |o: &[Sample], step| o.get(frame(step)).is_some_and(|s| s.kind == SampleKind::Filled);
    let of_marker = |o: &Vec<Sample>| (0..n_steps).filter(|step| is_filled(o, *step)).count();
    origins.into_iter().flatten().flatten().map(of_marker).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_and_positions_between_frames() {
        assert_eq!(n_steps(600, 120.0, 30.0), 150);
        assert_eq!(n_steps(601, 120.0, 30.0), 151);
        let track: Track = [Some(Vec3::x()), Some(3.0 * Vec3::x()), None].into_iter().collect();
        assert_eq!(position_at(&track, 10.0, 0.05), Some(2.0 * Vec3::x()));
        assert_eq!(position_at(&track, 10.0, 0.1), Some(3.0 * Vec3::x()));
        assert_eq!(position_at(&track, 10.0, 0.15), None);
        assert_eq!(position_at(&track, 10.0, -0.05), None);
    }

    #[test]
    fn fills_are_counted_where_a_step_looks() {
        let origins = [SampleKind::Filled, SampleKind::Mended, SampleKind::GivenBack, SampleKind::Filled]
            .map(|kind| Sample { kind, error_m: 1e-3 });
        let of_markers = [vec![origins.to_vec()], vec![origins.to_vec()]];
        assert_eq!(n_filled(Some(&of_markers), 100.0, 2, 50.0), 2);
        assert_eq!(n_filled(Some(&of_markers), 100.0, 4, 100.0), 4);
        assert_eq!(n_filled(None, 100.0, 4, 100.0), 0);
    }
}
