use std::io::{Seek, Write};

use nalgebra::{Matrix3, Rotation3, UnitQuaternion};
use tousle_core::{Pose, PoseTrack, Vec3};

use super::error::NpzError;
use super::reader::{NpzReader, bad_shape};
use super::writer::NpzWriter;
use crate::ExportError;

/// The most bytes of one array that a pose track may have: 256 MiB.
const MAX_BYTES: u64 = 1 << 28;

/// How far a matrix may be from a rotation, as the largest entry of R Rᵀ − 1: five digits written by hand pass.
const ROTATION_TOLERANCE: f64 = 1e-3;

/// Writes a pose track: `t` (T) s, `R` (T, 3, 3) and `p` (T, 3) m, so that `p_world = R p_head + p`.
///
/// # Errors
/// [`ExportError::Io`] if `out` takes no more.
pub fn write_poses_npz(poses: &PoseTrack, out: impl Write + Seek) -> Result<(), ExportError> {
    let n = poses.poses.len();
    let mut npz = NpzWriter::packed(out);
    npz.array("t", &[n], (0..n).map(|k| poses.start_secs + k as f64 / poses.rate_hz))?;
    let matrices = poses.poses.iter().map(|p| p.rotation.to_rotation_matrix().into_inner());
    npz.array("R", &[n, 3, 3], matrices.flat_map(|m| m.transpose().iter().copied().collect::<Vec<f64>>()))?;
    npz.array("p", &[n, 3], poses.poses.iter().flat_map(|p| <[f64; 3]>::from(p.translation.vector)))?;
    npz.finish()?;
    Ok(())
}

/// Reads a pose track: `t` (T) evenly spaced s, `R` (T, 3, 3), `p` (T, 3) m, so that `p_world = R p_head + p`.
///
/// Numbers of any type. Rotations that are a little off (written with few digits) are made whole.
///
/// # Errors
/// [`NpzError`] with the array and the place: shapes that do not fit, times that are not even to 2 % of a step,
/// a matrix that is no rotation, a number that is not finite.
pub fn read_poses_npz(bytes: &[u8]) -> Result<PoseTrack, NpzError> {
    let mut npz = NpzReader::open(bytes, MAX_BYTES)?;
    let (header, times_secs) = npz.numbers("t")?;
    let n = times_secs.len();
    if header.shape.len() != 1 || n == 0 {
        return Err(bad_shape("t", &header.shape, "one axis of at least 1"));
    }
    let (header, matrices) = npz.numbers("R")?;
    if header.shape != [n, 3, 3] {
        return Err(bad_shape("R", &header.shape, format!("({n}, 3, 3)")));
    }
    let (header, positions) = npz.numbers("p")?;
    if header.shape != [n, 3] {
        return Err(bad_shape("p", &header.shape, format!("({n}, 3)")));
    }
    let mut poses = Vec::with_capacity(n);
    for (k, (matrix, position)) in matrices.chunks_exact(9).zip(positions.chunks_exact(3)).enumerate() {
        poses.push(Pose::from_parts(Vec3::from_column_slice(position).into(), rotation(k, matrix)?));
    }
    Ok(PoseTrack { start_secs: times_secs[0], rate_hz: rate(&times_secs)?, poses })
}

/// Poses a second of evenly spaced times; 1 for a single pose, which stands for all times.
fn rate(times_secs: &[f64]) -> Result<f64, NpzError> {
    let n = times_secs.len();
    if n == 1 {
        return Ok(1.0);
    }
    let step = (times_secs[n - 1] - times_secs[0]) / (n - 1) as f64;
    let off = |k: usize| (times_secs[k] - times_secs[0] - k as f64 * step).abs() > 0.02 * step;
    let bad = if step > 0.0 { (0..n).find(|&k| off(k)) } else { Some(n - 1) };
    match bad {
        None => Ok(1.0 / step),
        Some(k) => Err(NpzError::BadValue {
            key: "t".to_owned(),
            index: vec![k],
            found: times_secs[k],
            expected: "times that rise in even steps".to_owned(),
        }),
    }
}

fn rotation(k: usize, row_major: &[f64]) -> Result<UnitQuaternion<f64>, NpzError> {
    let m = Matrix3::from_row_slice(row_major);
    let off = (m * m.transpose() - Matrix3::identity()).amax();
    let bad = |found: f64, expected: String| {
        Err(NpzError::BadValue { key: "R".to_owned(), index: vec![k], found, expected })
    };
    if off.is_nan() || off > ROTATION_TOLERANCE {
        let expected =
            format!("a rotation, whose product with its transpose is off 1 by {ROTATION_TOLERANCE} at most");
        return bad(off, expected);
    }
    let determinant = m.determinant();
    if determinant < 0.0 {
        return bad(determinant, "a rotation, whose determinant is +1 and not a mirror's".to_owned());
    }
    // Not `Rotation3::from_matrix`, which iterates from no turn and gets stuck at a half turn.
    let near = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(m));
    Ok(UnitQuaternion::new_normalize(near.into_inner()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    #[test]
    fn poses_come_back() {
        let pose = |k: f64| Pose::new(Vec3::new(k, 1.0, 2.0), Vec3::new(0.1 * k, -0.2, 0.3));
        let track = PoseTrack {
            start_secs: 0.5,
            rate_hz: 120.0,
            poses: (0..5).map(|k| pose(f64::from(k))).collect(),
        };
        let mut out = Cursor::new(Vec::new());
        write_poses_npz(&track, &mut out).unwrap();
        let read = read_poses_npz(out.get_ref()).unwrap();
        assert!((read.rate_hz - 120.0).abs() < 1e-9 && read.start_secs == 0.5);
        for (a, b) in read.poses.iter().zip(&track.poses) {
            assert!((a.translation.vector - b.translation.vector).norm() == 0.0);
            assert!(a.rotation.angle_to(&b.rotation) < 1e-7);
        }
    }

    /// A head that faces backwards in its world.
    #[test]
    fn a_half_turn_comes_back() {
        for axis in [Vec3::x(), Vec3::y(), Vec3::z(), Vec3::new(0.6, 0.0, -0.8)] {
            let pose = Pose::new(Vec3::zeros(), axis * std::f64::consts::PI);
            let mut out = Cursor::new(Vec::new());
            write_poses_npz(&PoseTrack::still(pose), &mut out).unwrap();
            let read = read_poses_npz(out.get_ref()).unwrap();
            assert!(read.poses[0].rotation.angle_to(&pose.rotation) < 1e-7, "{axis}");
        }
    }

    #[test]
    fn a_mirror_is_no_rotation() {
        let mut out = Cursor::new(Vec::new());
        let mut npz = NpzWriter::packed(&mut out);
        npz.array("t", &[1], [0.0_f64].into_iter()).unwrap();
        npz.array("R", &[1, 3, 3], [-1.0_f64, 0., 0., 0., 1., 0., 0., 0., 1.].into_iter()).unwrap();
        npz.array("p", &[1, 3], [0.0_f64; 3].into_iter()).unwrap();
        npz.finish().unwrap();
        let error = read_poses_npz(out.get_ref()).unwrap_err().to_string();
        assert!(error.contains("found -1, expected a rotation, whose determinant is +1"), "{error}");
    }
}
