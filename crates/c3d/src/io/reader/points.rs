use super::layout::Layout;
use crate::point::{Point, word_from_f32};
use crate::{Processor, ReadError, Storage};
use std::io::Read;
use std::ops::Range;

/// Bytes that are read at once, unless a frame is longer.
const PIECE: u64 = 256 * 1024;

/// Decodes the asked-for points of frames that start where `inner` stands.
pub(super) fn read_frames<R: Read>(
    inner: &mut R,
    layout: &Layout,
    point_idxs: &[usize],
    frames: Range<usize>,
    visit: &mut impl FnMut(usize, &[Option<Point>]),
) -> Result<(), ReadError> {
    let scale = layout.scale;
    let mut frames = Frames { inner, layout, point_idxs, frames, visit };
    match (layout.storage, layout.processor) {
        (Storage::Float32, Processor::Intel) => frames.decode(|b| float_point(b, f32::from_le_bytes)),
        (Storage::Float32, Processor::Mips) => frames.decode(|b| float_point(b, f32::from_be_bytes)),
        (Storage::Float32, Processor::Dec) => {
            frames.decode(|b| float_point(b, |w| Processor::Dec.read_f32(w)))
        }
        (Storage::Int16, Processor::Mips) => frames.decode(|b| int_point(b, i16::from_be_bytes, scale)),
        (Storage::Int16, _) => frames.decode(|b| int_point(b, i16::from_le_bytes, scale)),
    }
}

struct Frames<'a, R, F> {
    inner: &'a mut R,
    layout: &'a Layout,
    point_idxs: &'a [usize],
    frames: Range<usize>,
    visit: &'a mut F,
}

impl<R: Read, F: FnMut(usize, &[Option<Point>])> Frames<'_, R, F> {
    fn decode<const N: usize>(&mut self, point: impl Fn(&[u8; N]) -> Option<Point>) -> Result<(), ReadError> {
        let frame_bytes = self.layout.frame_bytes() as usize;
        let frames_at_once = (PIECE as usize).checked_div(frame_bytes).unwrap_or(1).max(1);
        let mut bytes = vec![0; frames_at_once.min(self.frames.len()) * frame_bytes];
        let mut points = vec![None; self.point_idxs.len()];
        let mut frame_idx = self.frames.start;
        while frame_idx < self.frames.end {
            let n_frames = frames_at_once.min(self.frames.end - frame_idx);
            let piece = &mut bytes[..n_frames * frame_bytes];
            self.inner.read_exact(piece)?;
            for i in 0..n_frames {
                let (words, _) = piece[i * frame_bytes..(i + 1) * frame_bytes].as_chunks();
                for (decoded, &point_idx) in points.iter_mut().zip(self.point_idxs) {
                    *decoded = point(&words[point_idx]);
                }
                (self.visit)(frame_idx + i, &points);
            }
            frame_idx += n_frames;
        }
        Ok(())
    }
}

#[inline]
fn float_point(bytes: &[u8; 16], float: impl Fn([u8; 4]) -> f32) -> Option<Point> {
    let [x, y, z, word] = [0, 4, 8, 12].map(|i| float([bytes[i], bytes[i + 1], bytes[i + 2], bytes[i + 3]]));
    Point::from_word([x, y, z], word_from_f32(word))
}

#[inline]
fn int_point(bytes: &[u8; 8], int: impl Fn([u8; 2]) -> i16, scale: f32) -> Option<Point> {
    let [x, y, z, word] = [0, 2, 4, 6].map(|i| int([bytes[i], bytes[i + 1]]));
    Point::from_word([x, y, z].map(|c| f32::from(c) * scale), word)
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
