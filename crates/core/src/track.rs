use crate::Vec3;

/// One marker's positions over all frames, with gaps.
///
/// A missing sample is stored as NaN so that a track of a long session stays one flat array; callers see it as
/// `None` and cannot put a NaN in by accident.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Track {
    positions: Vec<Vec3>,
}

impl Track {
    /// A track of `n_frames` frames in which nothing was seen yet.
    pub fn missing(n_frames: usize) -> Self {
        Self { positions: vec![Vec3::repeat(f64::NAN); n_frames] }
    }

    /// The number of frames, seen or not.
    pub fn n_frames(&self) -> usize {
        self.positions.len()
    }

    /// The position at a frame (from 0), or `None` where the marker was not seen or the frame is past the end.
    #[inline]
    pub fn at(&self, frame: usize) -> Option<Vec3> {
        self.positions.get(frame).copied().filter(|p| p.x.is_finite() && p.y.is_finite() && p.z.is_finite())
    }

    /// Sets the position at a frame; `None`, or a position that is not finite, makes it missing.
    ///
    /// # Panics
    /// If `frame` is past the end.
    pub fn set(&mut self, frame: usize, position: Option<Vec3>) {
        let finite = position.filter(|p| p.iter().all(|c| c.is_finite()));
        self.positions[frame] = finite.unwrap_or_else(|| Vec3::repeat(f64::NAN));
    }

    /// Every frame in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Option<Vec3>> + '_ {
        (0..self.n_frames()).map(|frame| self.at(frame))
    }

    /// How many frames were seen.
    pub fn n_valid(&self) -> usize {
        self.iter().flatten().count()
    }

    /// The mean over the frames that were seen, or `None` if there is none.
    pub fn mean(&self) -> Option<Vec3> {
        let n = self.n_valid();
        (n > 0).then(|| self.iter().flatten().sum::<Vec3>() / n as f64)
    }

    /// Every position passed through `f`; what is missing stays missing.
    pub fn map(&self, mut f: impl FnMut(usize, Vec3) -> Option<Vec3>) -> Self {
        self.iter().enumerate().map(|(frame, p)| p.and_then(|p| f(frame, p))).collect()
    }
}

impl FromIterator<Option<Vec3>> for Track {
    fn from_iter<I: IntoIterator<Item = Option<Vec3>>>(iter: I) -> Self {
        let mut track = Self::default();
        for position in iter {
            track.positions.push(Vec3::zeros());
            track.set(track.positions.len() - 1, position);
        }
        track
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_nan_is_a_gap() {
        let track: Track =
            [Some(Vec3::new(1.0, 2.0, 3.0)), None, Some(Vec3::new(f64::NAN, 0.0, 0.0))].into_iter().collect();
        assert_eq!(track.n_frames(), 3);
        assert_eq!(track.n_valid(), 1);
        assert_eq!(track.at(2), None);
        assert_eq!(track.mean(), Some(Vec3::new(1.0, 2.0, 3.0)));
        assert_eq!(track.at(99), None);
    }
}
