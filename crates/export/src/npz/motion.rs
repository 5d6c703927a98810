use core::fmt;
use std::io::{Seek, Write};

use tousle_core::StrandMotion;

use super::error::NpzError;
use super::reader::{FINITE, NpzReader, bad_shape, finite_f32};
use super::writer::NpzWriter;
use crate::ExportError;
use crate::motion::{check_frame, check_motion, check_times};

/// The most bytes of one array that a motion may have: 4 GiB.
const MAX_BYTES: u64 = 1 << 32;

/// Writes a motion as NumPy reads it: `t` (T) f64, s; `pos` (T, P, 3) f32, head space, m, strand after strand,
/// root first; `counts` (strands) i64.
///
/// The same motion gives the same bytes. Wrap a file in a [`std::io::BufWriter`].
///
/// # Errors
/// [`ExportError::BadMotion`] if the motion's arrays do not fit together or hold a number that is not finite,
/// [`ExportError::Io`] if `out` takes no more.
pub fn write_motion_npz(motion: &StrandMotion, out: impl Write + Seek) -> Result<(), ExportError> {
    write(motion, None, out)
}

/// [`write_motion_npz`] with `strand` (strands) i64: the number of each strand in the groom's file, from 0. Strands that
/// cannot be simulated are left out and leave gaps in them.
///
/// # Errors
/// As [`write_motion_npz`]; [`ExportError::BadMotion`] also if there is not one number a strand.
pub fn write_numbered_motion_npz(
    motion: &StrandMotion,
    numbers: &[usize],
    out: impl Write + Seek,
) -> Result<(), ExportError> {
    write(motion, Some(numbers), out)
}

fn write(
    motion: &StrandMotion,
    numbers: Option<&[usize]>,
    out: impl Write + Seek,
) -> Result<(), ExportError> {
    check_motion(motion)?;
    let mut npz = MotionNpz::begin(&motion.counts, &motion.times_secs, numbers, out)?;
    npz.append(&motion.positions_m, motion.times_secs.len())?;
    npz.finish()
}

/// A motion on its way into a `.npz`, frame by frame, for motions that nobody holds as a whole: the same bytes as
/// [`write_motion_npz`] or, with numbers, [`write_numbered_motion_npz`].
pub struct MotionNpz<W: Write + Seek> {
    npz: NpzWriter<W>,
    counts: Vec<usize>,
    numbers: Option<Vec<usize>>,
    n_frames: usize,
    n_put: usize,
}

impl<W: Write + Seek> fmt::Debug for MotionNpz<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { n_frames, n_put, .. } = self;
        f.debug_struct("MotionNpz").field("n_frames", n_frames).field("n_put", n_put).finish_non_exhaustive()
    }
}

impl<W: Write + Seek> MotionNpz<W> {
    /// Begins with what is known before the first frame: control points of each strand, time of each frame, s, and the
    /// numbers of the strands in the groom's file, if they are to be said.
    ///
    /// # Errors
    /// [`ExportError::BadMotion`] if a time is no number or there is not one number a strand, [`ExportError::Io`] if `out`
    /// takes no more.
    pub fn begin(
        counts: &[usize],
        times_secs: &[f64],
        numbers: Option<&[usize]>,
        out: W,
    ) -> Result<Self, ExportError> {
        if let Some(numbers) = numbers.filter(|numbers| numbers.len() != counts.len()) {
            let (found, expected) =
                (format!("{} numbers of strands", numbers.len()), counts.len().to_string());
            return Err(ExportError::BadMotion { found, expected });
        }
        check_times(times_secs)?;
        let n_frames = times_secs.len();
        let mut npz = NpzWriter::plain(out);
        npz.array("t", &[n_frames], times_secs.iter().copied())?;
        npz.begin::<f32>("pos", &[n_frames, counts.iter().sum(), 3])?;
        let numbers = numbers.map(<[usize]>::to_vec);
        Ok(Self { npz, counts: counts.to_vec(), numbers, n_frames, n_put: 0 })
    }

    /// Puts the next frame: positions, head space, m, strand after strand, root first.
    ///
    /// # Errors
    /// [`ExportError::BadMotion`] if it has another number of points than the strands, or one that is not finite, or if all
    /// frames are there; [`ExportError::Io`] if the sink takes no more.
    pub fn put(&mut self, positions_m: &[[f32; 3]]) -> Result<(), ExportError> {
        let n_points: usize = self.counts.iter().sum();
        if self.n_put == self.n_frames || positions_m.len() != n_points {
            let found = format!("{} points in frame {}", positions_m.len(), self.n_put);
            let expected = format!("{n_points} in each of {} frames", self.n_frames);
            return Err(ExportError::BadMotion { found, expected });
        }
        check_frame(self.n_put, positions_m)?;
        self.append(positions_m, 1)
    }

    /// Puts frames that were checked.
    fn append(&mut self, positions_m: &[[f32; 3]], n_frames: usize) -> Result<(), ExportError> {
        self.npz.go_on(positions_m.iter().flatten().copied())?;
        self.n_put += n_frames;
        Ok(())
    }

    /// Ends the archive.
    ///
    /// # Errors
    /// [`ExportError::BadMotion`] if a frame is missing, [`ExportError::Io`] if the sink takes no more.
    pub fn finish(mut self) -> Result<(), ExportError> {
        if self.n_put < self.n_frames {
            let (found, expected) = (format!("{} frames", self.n_put), self.n_frames.to_string());
            return Err(ExportError::BadMotion { found, expected });
        }
        self.npz.array("counts", &[self.counts.len()], self.counts.iter().map(|n| *n as i64))?;
        if let Some(numbers) = &self.numbers {
            self.npz.array("strand", &[numbers.len()], numbers.iter().map(|n| *n as i64))?;
        }
        self.npz.finish()?;
        Ok(())
    }
}

/// Reads what [`write_motion_npz`] writes, and what other programs write by the same names: numbers of any type,
/// in C or Fortran order.
///
/// # Errors
/// [`NpzError`] with the array and the place, for any bytes that are not a motion.
pub fn read_motion_npz(bytes: &[u8]) -> Result<StrandMotion, NpzError> {
    let mut npz = NpzReader::open(bytes, MAX_BYTES)?;
    let (header, times_secs) = npz.numbers("t")?;
    if header.shape.len() != 1 {
        return Err(bad_shape("t", &header.shape, "one axis"));
    }
    check_increasing(&times_secs)?;
    let counts = read_counts(&mut npz)?;
    let n_points = counts.iter().try_fold(0_usize, |sum, n| sum.checked_add(*n));
    let mut pos = npz.array("pos")?;
    match pos.header.shape.as_slice() {
        [frames, points, 3] if *frames == times_secs.len() && Some(*points) == n_points => {}
        shape => {
            let points = n_points.map_or("(the sum of `counts`)".to_owned(), |n| n.to_string());
            return Err(bad_shape("pos", shape, format!("({}, {points}, 3)", times_secs.len())));
        }
    }
    let flat = pos.all(FINITE, finite_f32)?;
    let positions_m = flat.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    Ok(StrandMotion { counts, times_secs, positions_m })
}

fn check_increasing(times_secs: &[f64]) -> Result<(), NpzError> {
    match times_secs.windows(2).position(|pair| pair[1] <= pair[0]) {
        None => Ok(()),
        Some(before) => Err(NpzError::BadValue {
            key: "t".to_owned(),
            index: vec![before + 1],
            found: times_secs[before + 1],
            expected: format!("a time after {} s", times_secs[before]),
        }),
    }
}

fn read_counts(npz: &mut NpzReader<'_>) -> Result<Vec<usize>, NpzError> {
    let (header, values) = npz.numbers("counts")?;
    if header.shape.len() != 1 {
        return Err(bad_shape("counts", &header.shape, "one axis"));
    }
    let count = |(strand, value): (usize, &f64)| {
        if *value >= 1.0 && value.fract() == 0.0 && *value <= f64::from(u32::MAX) {
            return Ok(*value as usize);
        }
        let expected = "a whole number above 0".to_owned();
        Err(NpzError::BadValue { key: "counts".to_owned(), index: vec![strand], found: *value, expected })
    };
    values.iter().enumerate().map(count).collect()
}
