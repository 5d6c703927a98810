use super::layout::Layout;
use crate::point::{Point, word_from_f32};
use crate::{Processor, ReadError, Storage};
use std::io::Read;
use std::ops::Range;
use std::slice::ChunksExact;

/// Bytes that are read at once, unless a frame is longer: small enough to stay in the processor's cache.
const PIECE: usize = 64 * 1024;

/// Decodes the asked-for points of frames that start where `inner` stands, frame by frame.
pub(super) fn read_frames<R: Read>(
    inner: &mut R,
    layout: &Layout,
    point_idxs: &[usize],
    frames: Range<usize>,
    visit: impl FnMut(usize, &[Option<Point>]),
) -> Result<(), ReadError> {
    let points = vec![None; point_idxs.len()];
    let mut by_frame = ByFrame { point_idxs, frame_idx: frames.start, points, visit };
    if layout.frame_bytes() == 0 {
        frames.for_each(|frame_idx| (by_frame.visit)(frame_idx, &[]));
        return Ok(());
    }
    decode(inner, layout, frames.len(), &mut by_frame)
}

/// Decodes the asked-for points of frames that start where `inner` stands, point by point.
pub(super) fn read_trajectories<R: Read>(
    inner: &mut R,
    layout: &Layout,
    point_idxs: &[usize],
    n_frames: usize,
) -> Result<Vec<Vec<Option<Point>>>, ReadError> {
    let trajectories = point_idxs.iter().map(|_| Vec::with_capacity(n_frames)).collect();
    let mut by_point = ByPoint { point_idxs, trajectories };
    if !point_idxs.is_empty() {
        decode(inner, layout, n_frames, &mut by_point)?;
    }
    Ok(by_point.trajectories)
}

/// What to do with the bytes of some frames.
trait Decode {
    fn decode<const N: usize>(
        &mut self,
        frames: ChunksExact<'_, u8>,
        point: impl Fn(&[u8; N]) -> Option<Point>,
    );
}

struct ByFrame<'a, F> {
    point_idxs: &'a [usize],
    frame_idx: usize,
    /// One frame, decoded.
    points: Vec<Option<Point>>,
    visit: F,
}

struct ByPoint<'a> {
    point_idxs: &'a [usize],
    trajectories: Vec<Vec<Option<Point>>>,
}

impl<F: FnMut(usize, &[Option<Point>])> Decode for ByFrame<'_, F> {
    fn decode<const N: usize>(
        &mut self,
        frames: ChunksExact<'_, u8>,
        point: impl Fn(&[u8; N]) -> Option<Point>,
    ) {
        for frame in frames {
            let (words, _) = frame.as_chunks();
            for (decoded, &point_idx) in self.points.iter_mut().zip(self.point_idxs) {
                *decoded = point(&words[point_idx]);
            }
            (self.visit)(self.frame_idx, &self.points);
            self.frame_idx += 1;
        }
    }
}

impl Decode for ByPoint<'_> {
    fn decode<const N: usize>(
        &mut self,
        frames: ChunksExact<'_, u8>,
        point: impl Fn(&[u8; N]) -> Option<Point>,
    ) {
        for (trajectory, &point_idx) in self.trajectories.iter_mut().zip(self.point_idxs) {
            trajectory.extend(frames.clone().map(|frame| point(&frame.as_chunks().0[point_idx])));
        }
    }
}

/// Reads frames piece by piece and hands them on with what decodes a point of this processor and storage.
fn decode<R: Read>(
    inner: &mut R,
    layout: &Layout,
    n_frames: usize,
    decode: &mut impl Decode,
) -> Result<(), ReadError> {
    let scale = layout.scale;
    let mut pieces = Pieces { inner, frame_bytes: layout.frame_bytes() as usize, n_frames };
    match (layout.storage, layout.processor) {
        (Storage::Float32, Processor::Intel) => {
            pieces.each(|frames| decode.decode(frames, |b| float_point(b, f32::from_le_bytes)))
        }
        (Storage::Float32, Processor::Mips) => {
            pieces.each(|frames| decode.decode(frames, |b| float_point(b, f32::from_be_bytes)))
        }
        (Storage::Float32, Processor::Dec) => {
            pieces.each(|frames| decode.decode(frames, |b| float_point(b, |w| Processor::Dec.read_f32(w))))
        }
        (Storage::Int16, Processor::Mips) => {
            pieces.each(|frames| decode.decode(frames, |b| int_point(b, i16::from_be_bytes, scale)))
        }
        (Storage::Int16, Processor::Intel | Processor::Dec) => {
            pieces.each(|frames| decode.decode(frames, |b| int_point(b, i16::from_le_bytes, scale)))
        }
    }
}

/// Frames to read, a piece at a time.
struct Pieces<'a, R> {
    inner: &'a mut R,
    /// > 0.
    frame_bytes: usize,
    n_frames: usize,
}

impl<R: Read> Pieces<'_, R> {
    fn each(&mut self, mut visit: impl FnMut(ChunksExact<'_, u8>)) -> Result<(), ReadError> {
        let n_at_once = (PIECE / self.frame_bytes).clamp(1, self.n_frames.max(1));
        let mut bytes = vec![0; n_at_once * self.frame_bytes];
        while self.n_frames > 0 {
            let n_frames = n_at_once.min(self.n_frames);
            let piece = &mut bytes[..n_frames * self.frame_bytes];
            self.inner.read_exact(piece)?;
            visit(piece.chunks_exact(self.frame_bytes));
            self.n_frames -= n_frames;
        }
        Ok(())
    }
}

#[inline]
fn float_point(bytes: &[u8; 16], float: impl Fn([u8; 4]) -> f32) -> Option<Point> {
    // Called four times and not by `map` over an array, which the compiler does not inline.
    let at = |i: usize| float([bytes[i], bytes[i + 1], bytes[i + 2], bytes[i + 3]]);
    Point::from_word([at(0), at(4), at(8)], word_from_f32(at(12)))
}

#[inline]
fn int_point(bytes: &[u8; 8], int: impl Fn([u8; 2]) -> i16, scale: f32) -> Option<Point> {
    let at = |i: usize| int([bytes[i], bytes[i + 1]]);
    let coordinate = |i: usize| f32::from(at(i)) * scale;
    Point::from_word([coordinate(0), coordinate(2), coordinate(4)], at(6))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Five steps of 0.5 to the right, residual 3, cameras 1 and 2.
    #[test]
    fn an_integer_point() {
        let point = int_point(&[5, 0, 0xfe, 0xff, 0, 0, 3, 0b11], i16::from_le_bytes, 0.5);
        assert_eq!(point, Some(Point { position: [2.5, -1.0, 0.0], residual: 3, cameras: 0b11 }));
        assert_eq!(int_point(&[0, 5, 0, 0, 0, 0, 0x80, 0], i16::from_be_bytes, 0.5), None);
    }
}
