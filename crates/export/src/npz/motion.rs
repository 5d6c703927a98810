use std::io::{Seek, Write};

use tousle_core::StrandMotion;

use super::error::NpzError;
use super::reader::{FINITE, NpzReader, bad_shape, finite_f32};
use super::writer::NpzWriter;
use crate::ExportError;
use crate::motion::check_motion;

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
    if numbers.len() != motion.counts.len() {
        let (found, expected) =
            (format!("{} numbers of strands", numbers.len()), motion.counts.len().to_string());
        return Err(ExportError::BadMotion { found, expected });
    }
    write(motion, Some(numbers), out)
}

fn write(
    motion: &StrandMotion,
    numbers: Option<&[usize]>,
    out: impl Write + Seek,
) -> Result<(), ExportError> {
    check_motion(motion)?;
    let mut npz = NpzWriter::plain(out);
    let n_frames = motion.times_secs.len();
    npz.array("t", &[n_frames], motion.times_secs.iter().copied())?;
    npz.array("pos", &[n_frames, motion.n_points(), 3], motion.positions_m.iter().flatten().copied())?;
    npz.array("counts", &[motion.counts.len()], motion.counts.iter().map(|n| *n as i64))?;
    if let Some(numbers) = numbers {
        npz.array("strand", &[numbers.len()], numbers.iter().map(|n| *n as i64))?;
    }
    npz.finish()?;
    Ok(())
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
