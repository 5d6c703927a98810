mod header;
mod layout;
mod parameters;
mod points;

use crate::parameter::Parameters;
use crate::trial::{self, Trial};
use crate::{Header, Info, Point, ReadError, Warning};
use layout::Layout;
use std::io::{Cursor, Read, Seek, SeekFrom};
use std::ops::Range;

/// Reads a C3D file: header and parameters at once, points when asked for.
///
/// Holds the parameter section and, while reading points, a piece of 64 KiB or one frame; neither grows with the
/// length of the trial.
#[derive(Debug)]
pub struct Reader<R> {
    inner: R,
    header: Header,
    parameters: Parameters,
    info: Info,
    layout: Layout,
    warnings: Vec<Warning>,
}

impl<'a> Reader<Cursor<&'a [u8]>> {
    /// Opens a file that is in memory.
    ///
    /// # Errors
    /// As [`Reader::new`].
    pub fn from_bytes(bytes: &'a [u8]) -> Result<Self, ReadError> {
        Self::new(Cursor::new(bytes))
    }
}

impl<R: Read + Seek> Reader<R> {
    /// Reads header and parameters, and settles what they contradict each other on by the size of the file.
    ///
    /// # Errors
    /// If the source fails, if it is no C3D file, or if not one frame of the announced points is there.
    pub fn new(mut inner: R) -> Result<Self, ReadError> {
        let mut warnings = Vec::new();
        let file = header::read_start(&mut inner, &mut warnings)?;
        let section = header::read_parameter_section(&mut inner, &file)?;
        let parameters =
            parameters::read_parameters(&section, file.processor, file.section_start, &mut warnings);
        let layout = layout::settle(&file, &parameters, &mut warnings)?;
        let info = layout::describe(&file, &parameters, &layout, &mut warnings);
        Ok(Self { inner, header: file.header, parameters, info, layout, warnings })
    }

    /// What the file holds.
    pub fn info(&self) -> &Info {
        &self.info
    }

    /// Everything that is wrong or missing in the file, in the order in which it was found.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// The header as the file has it; [`Reader::info`] is what holds.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The whole parameter section as the file has it; [`Reader::info`] is what holds.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// All that a [`Writer`](crate::Writer) needs to write the points again; analog samples and rotations, and the
    /// parameters that describe them, are left out.
    pub fn trial(&self) -> Trial {
        trial::of(&self.info, &self.parameters)
    }

    /// Decodes some points of some frames, frame by frame.
    ///
    /// `visit` is called once a frame, in order, with the frame's index (from 0) and the points in the order asked
    /// for; `None` where a point is missing: the sign bit of its fourth word is set, or it has no finite position.
    ///
    /// # Errors
    /// If the source fails, or if the file has no such points or frames.
    pub fn read_frames(
        &mut self,
        point_idxs: &[usize],
        frames: Range<usize>,
        visit: impl FnMut(usize, &[Option<Point>]),
    ) -> Result<(), ReadError> {
        self.seek(point_idxs, &frames)?;
        points::read_frames(&mut self.inner, &self.layout, point_idxs, frames, visit)
    }

    /// Decodes some points of some frames, point by point: `[point][frame]`, `None` where missing.
    ///
    /// # Errors
    /// If the source fails, or if the file has no such points or frames.
    pub fn read_trajectories(
        &mut self,
        point_idxs: &[usize],
        frames: Range<usize>,
    ) -> Result<Vec<Vec<Option<Point>>>, ReadError> {
        self.seek(point_idxs, &frames)?;
        points::read_trajectories(&mut self.inner, &self.layout, point_idxs, frames.len())
    }

    /// Goes to the first of the frames, if they and the points are there.
    fn seek(&mut self, point_idxs: &[usize], frames: &Range<usize>) -> Result<(), ReadError> {
        let (n_points, n_frames) = (self.info.n_points, self.info.n_frames);
        if let Some(&asked) = point_idxs.iter().find(|&&i| i >= n_points) {
            return Err(ReadError::NoSuchPoint { asked, n_points });
        }
        if frames.start > frames.end || frames.end > n_frames {
            return Err(ReadError::NoSuchFrames { start: frames.start, end: frames.end, n_frames });
        }
        let start = self.layout.data_start + frames.start as u64 * self.layout.frame_bytes();
        self.inner.seek(SeekFrom::Start(start))?;
        Ok(())
    }
}
