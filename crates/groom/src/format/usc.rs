//! USC-HairSalon's `.data`: a count of strands, then each strand's count of points and its points.
//!
//! The format has no magic number, no unit and no version: what tells it is that the last strand ends where the
//! file does. `.bin` is the same with seven numbers a point. Source: Hu, Ma, Luo and Li, "Single-view hair
//! modeling using a hairstyle database", 2015, and its data.

use tousle_core::Vec3;

use super::{GroomFormat, f32_at, u32_at};
use crate::error::GroomReadError;
use crate::raw::RawGroom;

/// Which of the two layouts the bytes fit to the last, if any.
pub(super) fn recognize(bytes: &[u8]) -> Option<GroomFormat> {
    [GroomFormat::Data, GroomFormat::Bin].into_iter().find(|format| walk(bytes, *format, |_, _| ()).is_ok())
}

pub(super) fn read(bytes: &[u8], format: GroomFormat) -> Result<RawGroom, GroomReadError> {
    let mut curves = Vec::new();
    let stride = stride(format);
    walk(bytes, format, |first, n| {
        let point = |k: usize| {
            let at = first + stride * k;
            Vec3::new(f32_at(bytes, at), f32_at(bytes, at + 4), f32_at(bytes, at + 8))
        };
        curves.push((0..n).map(point).collect());
    })?;
    Ok(RawGroom::of_curves(curves))
}

fn stride(format: GroomFormat) -> usize {
    if format == GroomFormat::Bin { 28 } else { 12 }
}

/// Goes from strand to strand; `visit` gets the offset of each one's first point and the number of its points.
fn walk(
    bytes: &[u8],
    format: GroomFormat,
    mut visit: impl FnMut(usize, usize),
) -> Result<(), GroomReadError> {
    let n_strands = count(bytes, 0, format)?;
    let mut at = 4;
    for _ in 0..n_strands {
        let n = count(bytes, at, format)?;
        at += 4;
        let n_bytes = n.saturating_mul(stride(format));
        if n_bytes > bytes.len() - at {
            let expected = format!("at most the {} bytes that are left", bytes.len() - at);
            return Err(bad(format, at - 4, format!("{n} points, which take {n_bytes} bytes"), expected));
        }
        visit(at, n);
        at += n_bytes;
    }
    if at != bytes.len() {
        return Err(bad(format, at, format!("{} more bytes", bytes.len() - at), "the end of the file"));
    }
    Ok(())
}

fn count(bytes: &[u8], at: usize, format: GroomFormat) -> Result<usize, GroomReadError> {
    if bytes.len() < at + 4 {
        return Err(bad(format, at, "the end of the file".to_owned(), "a count in four bytes"));
    }
    let found = u32_at(bytes, at) as i32;
    usize::try_from(found).map_err(|_| bad(format, at, found.to_string(), "a count"))
}

fn bad(format: GroomFormat, at: usize, found: String, expected: impl Into<String>) -> GroomReadError {
    GroomReadError::Malformed { format, place: format!("byte {at}"), found, expected: expected.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Strands of 2, 0 and 1 points, each point followed by `extra` numbers.
    fn file(extra: usize) -> Vec<u8> {
        let mut bytes = 3_i32.to_le_bytes().to_vec();
        let mut x = 0.0_f32;
        for n in [2_i32, 0, 1] {
            bytes.extend(n.to_le_bytes());
            for _ in 0..n {
                x += 1.0;
                bytes.extend([x, 0.5, -x].iter().flat_map(|v| v.to_le_bytes()));
                bytes.extend(vec![0; 4 * extra]);
            }
        }
        bytes
    }

    #[test]
    fn both_layouts() {
        for (extra, format) in [(0, GroomFormat::Data), (4, GroomFormat::Bin)] {
            let bytes = file(extra);
            assert_eq!(recognize(&bytes), Some(format));
            let raw = read(&bytes, format).unwrap();
            let points: Vec<_> = raw.strands.iter().map(|s| s.points.as_slice()).collect();
            let [a, b, c] = [1.0, 2.0, 3.0].map(|x| Vec3::new(x, 0.5, -x));
            assert_eq!(points, [&[a, b][..], &[], &[c]]);
        }
    }

    #[test]
    fn what_does_not_end_where_it_should_is_something_else() {
        let whole = file(0);
        for len in 0..whole.len() {
            assert_eq!(recognize(&whole[..len]), None, "{len}");
        }
        assert_eq!(recognize(&[&whole[..], &[0]].concat()), None);
        let huge = [1_i32.to_le_bytes(), i32::MAX.to_le_bytes()].concat();
        let error = read(&huge, GroomFormat::Data).unwrap_err().to_string();
        assert!(error.contains("byte 4: found 2147483647 points, which take 25769803764 bytes"), "{error}");
        let negative = (-1_i32).to_le_bytes();
        assert!(read(&negative, GroomFormat::Data).unwrap_err().to_string().contains("found -1"));
    }
}
