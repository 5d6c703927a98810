//! Cem Yuksel's `.hair`: a header of 128 bytes, then arrays, each only if its flag is set.
//!
//! Source: the format's page, <http://www.cemyuksel.com/research/hairmodels/>.

use tousle_core::Vec3;

use super::{GroomFormat, f32_at, u32_at};
use crate::along::mean_and_shares;
use crate::error::GroomReadError;
use crate::raw::{RawGroom, RawStrand};

const HEADER_BYTES: usize = 128;
const HAS_SEGMENTS: u32 = 1;
const HAS_POINTS: u32 = 2;
const HAS_THICKNESS: u32 = 4;
const HAS_TRANSPARENCY: u32 = 8;
const HAS_COLOR: u32 = 16;

/// Where the arrays start that are used, and where the last one ends. 64 bits: counts in a file may be anything.
struct Layout {
    n_strands: u64,
    n_points: u64,
    segments: Option<u64>,
    points: u64,
    thickness: Option<u64>,
    end: u64,
}

pub(super) fn read(bytes: &[u8]) -> Result<RawGroom, GroomReadError> {
    let layout = Layout::read(bytes)?;
    let counts = point_counts(bytes, &layout)?;
    let mut raw = RawGroom::default();
    let mut first = 0;
    for n in counts {
        raw.strands.push(strand(bytes, &layout, first, n));
        first += n;
    }
    let flags = u32_at(bytes, 12);
    if flags >= 2 * HAS_COLOR {
        raw.warnings
            .push(format!("flags {flags:#x} name arrays that the format does not; they were not read"));
    } else if (layout.end as usize) < bytes.len() {
        let n = bytes.len() - layout.end as usize;
        raw.warnings.push(format!("{n} bytes behind the last array were not read"));
    }
    Ok(raw)
}

impl Layout {
    fn read(bytes: &[u8]) -> Result<Self, GroomReadError> {
        if bytes.len() < HEADER_BYTES {
            return Err(bad("the header", format!("{} bytes", bytes.len()), "128 bytes"));
        }
        let [n_strands, n_points] = [4, 8].map(|at| u64::from(u32_at(bytes, at)));
        let flags = u32_at(bytes, 12);
        if flags & HAS_POINTS == 0 {
            return Err(bad("byte 12", format!("flags {flags:#x}"), "bit 1 set, for an array of points"));
        }
        let mut end = HEADER_BYTES as u64;
        let mut array = |flag: u32, n: u64| {
            let start = end;
            end += if flags & flag == 0 { 0 } else { n };
            (flags & flag != 0).then_some(start)
        };
        let segments = array(HAS_SEGMENTS, 2 * n_strands);
        let points = array(HAS_POINTS, 12 * n_points).unwrap_or(0);
        let thickness = array(HAS_THICKNESS, 4 * n_points);
        array(HAS_TRANSPARENCY, 4 * n_points);
        array(HAS_COLOR, 12 * n_points);
        if end > bytes.len() as u64 {
            let found = format!("{n_strands} strands and {n_points} points, which take {end} bytes");
            return Err(bad("the header", found, format!("at most the file's {} bytes", bytes.len())));
        }
        Ok(Self { n_strands, n_points, segments, points, thickness, end })
    }
}

/// Points of each strand: its own number of segments, or the header's for all, and one more.
fn point_counts(bytes: &[u8], layout: &Layout) -> Result<Vec<usize>, GroomReadError> {
    let total = layout.n_points;
    let counts: Vec<usize> = match layout.segments {
        Some(start) => {
            let array = &bytes[start as usize..][..2 * layout.n_strands as usize];
            array.chunks_exact(2).map(|b| usize::from(u16::from_le_bytes([b[0], b[1]])) + 1).collect()
        }
        None => {
            let n = u64::from(u32_at(bytes, 16)) + 1;
            if n * layout.n_strands != total {
                let found =
                    format!("{} strands of {n} points by default, and {total} points", layout.n_strands);
                return Err(bad("the header", found, "as many points as strands have"));
            }
            vec![n as usize; layout.n_strands as usize]
        }
    };
    let sum: usize = counts.iter().sum();
    if sum as u64 != total {
        let found = format!("segments for {sum} points, and {total} points");
        return Err(bad("the segments array", found, "the same number"));
    }
    Ok(counts)
}

fn strand(bytes: &[u8], layout: &Layout, first: usize, n: usize) -> RawStrand {
    let start = layout.points as usize + 12 * first;
    let point = |k: usize| {
        let at = start + 12 * k;
        Vec3::new(f32_at(bytes, at), f32_at(bytes, at + 4), f32_at(bytes, at + 8))
    };
    // The header's default thickness is a renderer's setting; only an array says something about this hair.
    let thickness = layout.thickness.map(|start| {
        let at = start as usize + 4 * first;
        mean_and_shares(&(0..n).map(|k| f32_at(bytes, at + 4 * k)).collect::<Vec<_>>())
    });
    let mut strand = RawStrand::of_points((0..n).map(point).collect());
    if let Some((mean, shares)) = thickness {
        strand.drawn_width = Some(mean);
        strand.along.width = shares;
    }
    strand
}

fn bad(place: &str, found: String, expected: impl Into<String>) -> GroomReadError {
    let (place, expected) = (place.to_owned(), expected.into());
    GroomReadError::Malformed { format: GroomFormat::Hair, place, found, expected }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(n_strands: u32, n_points: u32, flags: u32, default_segments: u32) -> Vec<u8> {
        let mut bytes = b"HAIR".to_vec();
        for word in [n_strands, n_points, flags, default_segments] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.resize(HEADER_BYTES, 0);
        bytes
    }

    fn floats(values: impl IntoIterator<Item = f32>) -> Vec<u8> {
        values.into_iter().flat_map(f32::to_le_bytes).collect()
    }

    /// Strands of 2 and 1 points with thickness 1, 3 and 5, and colors that are skipped.
    #[test]
    fn every_array() {
        let mut bytes = header(2, 3, HAS_SEGMENTS | HAS_POINTS | HAS_THICKNESS | HAS_COLOR, 99);
        bytes.extend([1, 0, 0, 0]);
        bytes.extend(floats((0..9_u8).map(f32::from)));
        bytes.extend(floats([1.0, 3.0, 5.0]));
        bytes.extend(floats([0.5; 9]));
        let raw = read(&bytes).unwrap();
        assert_eq!(raw.strands[0].points, [Vec3::new(0.0, 1.0, 2.0), Vec3::new(3.0, 4.0, 5.0)]);
        assert_eq!(raw.strands[1].points, [Vec3::new(6.0, 7.0, 8.0)]);
        assert_eq!(raw.strands[0].drawn_width, Some(2.0));
        assert_eq!(raw.strands[0].along.width, [0.5, 1.5]);
        assert!(raw.warnings.is_empty());
        bytes.push(0);
        assert_eq!(read(&bytes).unwrap().warnings.len(), 1);
    }

    /// It is for whoever fills in what is missing to say that a width cannot be.
    #[test]
    fn a_thickness_that_is_no_number_is_handed_on() {
        let mut bytes = header(1, 2, HAS_POINTS | HAS_THICKNESS, 1);
        bytes.extend(floats((0..6_u8).map(f32::from)));
        bytes.extend(floats([1.0, f32::NAN]));
        let strand = &read(&bytes).unwrap().strands[0];
        assert!(strand.drawn_width.is_some_and(f64::is_nan) && strand.along.width.is_empty());
    }

    #[test]
    fn the_default_number_of_segments() {
        let mut bytes = header(2, 4, HAS_POINTS, 1);
        bytes.extend(floats((0..12_u8).map(f32::from)));
        let raw = read(&bytes).unwrap();
        assert_eq!(raw.strands.iter().map(|s| s.points.len()).collect::<Vec<_>>(), [2, 2]);
        assert_eq!(raw.strands[0].drawn_width, None);
    }

    #[test]
    fn counts_that_do_not_fit() {
        for (bytes, says) in [
            (header(1, 1, HAS_SEGMENTS, 0), "flags 0x1"),
            (header(u32::MAX, u32::MAX, 31, 0), "at most the file's 128 bytes"),
            (header(u32::MAX, 0, HAS_POINTS, 0), "strands of 1 points by default, and 0 points"),
            (header(3, 0, HAS_POINTS, u32::MAX), "strands of 4294967296 points by default"),
            (header(1, 0, HAS_POINTS, 0)[..100].to_vec(), "found 100 bytes"),
            ([header(1, 1, 3, 0), vec![9, 0], vec![0; 12]].concat(), "segments for 10 points, and 1 points"),
        ] {
            let error = read(&bytes).unwrap_err().to_string();
            assert!(error.contains(says), "{error}");
        }
    }
}
