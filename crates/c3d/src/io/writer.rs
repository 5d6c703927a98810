mod header;
mod parameters;
mod points;

use crate::trial::Trial;
use crate::{BLOCK, Point, WriteError};
use std::io::Write;

/// Writes a C3D file, frame by frame: the same trial and points give the same bytes.
///
/// Header and parameters agree with each other; beyond 65,535 frames `TRIAL:ACTUAL_START_FIELD`,
/// `TRIAL:ACTUAL_END_FIELD` and `POINT:LONG_FRAMES` say what the header cannot. Labels beyond 255 go on in `LABELS2`…
///
/// ```
/// use tousle_c3d::{Point, Reader, Trial, Writer};
///
/// let trial = Trial {
///     rate_hz: 120.0,
///     n_frames: 1,
///     unit: Some("mm".into()),
///     labels: vec!["LFHD".into(), "RFHD".into()],
///     ..Trial::default()
/// };
/// let seen = Point::at([1.0, 2.0, 3.0]);
/// let mut writer = Writer::new(Vec::new(), &trial)?;
/// writer.write_frame(&[Some(seen), None])?;
/// let bytes = writer.finish()?;
///
/// let mut reader = Reader::from_bytes(&bytes)?;
/// assert_eq!(reader.trial(), trial);
/// assert_eq!(reader.read_trajectories(&[0, 1], 0..1)?, [[Some(seen)], [None]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Writer<W> {
    inner: W,
    coder: points::Coder,
    n_points: usize,
    n_frames: usize,
    n_written: usize,
    /// One frame, coded.
    frame: Vec<u8>,
}

impl<W: Write> Writer<W> {
    /// Writes header and parameters.
    ///
    /// # Errors
    /// If the trial says what the format cannot hold, or if writing fails.
    pub fn new(mut inner: W, trial: &Trial) -> Result<Self, WriteError> {
        let section = parameters::section(trial)?;
        inner.write_all(&header::block(trial, &section))?;
        inner.write_all(&section.bytes)?;
        Ok(Self {
            inner,
            coder: points::Coder::new(trial),
            n_points: trial.labels.len(),
            n_frames: trial.n_frames,
            n_written: 0,
            frame: Vec::new(),
        })
    }

    /// Writes one frame: as many points as the trial has labels, `None` where missing.
    ///
    /// Integer storage rounds coordinates to the nearest step of the scale. VAX floats turn what is below
    /// 2^-128 to zero.
    ///
    /// # Errors
    /// If a frame is one too many or has another number of points, if a point has a coordinate that the storage cannot
    /// hold or more than seven cameras, or if writing fails.
    pub fn write_frame(&mut self, points: &[Option<Point>]) -> Result<(), WriteError> {
        let frame = self.n_written;
        if frame == self.n_frames {
            return Err(WriteError::FrameCount { found: frame + 1, expected: self.n_frames });
        }
        if points.len() != self.n_points {
            return Err(WriteError::PointCount { frame, found: points.len(), expected: self.n_points });
        }
        self.frame.clear();
        for (point_idx, point) in points.iter().enumerate() {
            let coded = self.coder.push(&mut self.frame, *point);
            coded.map_err(|reason| WriteError::Point { frame, point_idx, reason })?;
        }
        self.inner.write_all(&self.frame)?;
        self.n_written += 1;
        Ok(())
    }

    /// Fills the last block and hands back what was written to.
    ///
    /// # Errors
    /// If frames are missing, or if writing fails.
    pub fn finish(mut self) -> Result<W, WriteError> {
        if self.n_written != self.n_frames {
            return Err(WriteError::FrameCount { found: self.n_written, expected: self.n_frames });
        }
        let frame_bytes = self.n_points as u64 * self.coder.point_bytes();
        let n_over = (self.n_written as u64 * frame_bytes) % BLOCK;
        if n_over > 0 {
            self.inner.write_all(&vec![0; (BLOCK - n_over) as usize])?;
        }
        self.inner.flush()?;
        Ok(self.inner)
    }
}
