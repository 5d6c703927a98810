//! Carrying a vector over a gap.

use tousle_core::Vec3;

/// A vector at one end of a gap.
#[derive(Clone, Copy, Debug)]
pub(crate) struct End {
    pub frame: usize,
    pub value: Vec3,
    /// Change a frame, leading into the gap or out of it.
    pub slope: Vec3,
}

/// The value between two ends: on a line, or (`cubic`) keeping the slope at both; held where one end is missing.
pub(crate) fn carry(left: Option<End>, right: Option<End>, frame: usize, cubic: bool) -> Option<Vec3> {
    let (left, right) = match (left, right) {
        (Some(left), Some(right)) => (left, right),
        (Some(end), None) | (None, Some(end)) => return Some(end.value),
        (None, None) => return None,
    };
    let span = (right.frame - left.frame) as f64;
    let u = (frame - left.frame) as f64 / span;
    let line = left.value + (right.value - left.value) * u;
    if !cubic {
        return Some(line);
    }
    let chord = right.value - left.value;
    let (a, b) = (left.slope * span - chord, chord - right.slope * span);
    Some(line + u * (1.0 - u) * ((1.0 - u) * a + u * b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_keeps_a_parabola() {
        // x = f²: 4 at frame 2 with slope 4, 36 at frame 6 with slope 12; 16 at frame 4.
        let end = |frame: usize| {
            let f = frame as f64;
            Some(End { frame, value: Vec3::x() * f * f, slope: Vec3::x() * 2.0 * f })
        };
        assert!((carry(end(2), end(6), 4, true).unwrap().x - 16.0).abs() < 1e-12);
        assert!((carry(end(2), end(6), 4, false).unwrap().x - 20.0).abs() < 1e-12);
        assert_eq!(carry(end(2), None, 9, true).unwrap().x, 4.0);
        assert_eq!(carry(None, None, 9, true), None);
    }
}
