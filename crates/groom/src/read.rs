use tousle_core::Groom;

use crate::defaults::with_defaults;
use crate::error::GroomReadError;
use crate::format::{GroomFormat, read_raw};
use crate::options::GroomOptions;
use crate::placement::place;
use crate::raw::RawGroom;

/// A groom and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadGroom {
    /// The strands, head space, m; `assumed` lists what no one gave.
    pub groom: Groom,
    /// The format the bytes were in.
    pub format: GroomFormat,
    /// What was left out, changed or overruled.
    pub warnings: Vec<String>,
}

/// Reads a groom in any known format, which is told from the bytes.
///
/// Strands without a segment are left out and points that lie on the one before are dropped, with a warning for
/// each kind; a groom that is nothing but such strands is an error.
///
/// # Errors
/// [`GroomReadError`]: bytes that are no groom, a unit or up axis that neither file nor options state, numbers
/// that are not finite, names that occur twice. Any bytes give an answer, and no count in a file makes room that
/// its bytes do not fill.
pub fn read_groom(bytes: &[u8], options: &GroomOptions) -> Result<ReadGroom, GroomReadError> {
    let (format, mut raw) = read_raw(bytes)?;
    clean(&mut raw);
    if raw.strands.is_empty() && !raw.warnings.is_empty() {
        return Err(GroomReadError::NoStrands { format, found: raw.warnings.join("; ") });
    }
    finish(raw, format, options)
}

/// Places cleaned curves and fills in what the file does not know.
pub(crate) fn finish(
    mut raw: RawGroom,
    format: GroomFormat,
    options: &GroomOptions,
) -> Result<ReadGroom, GroomReadError> {
    let mut warnings = std::mem::take(&mut raw.warnings);
    let placed = place(raw, format, options, &mut warnings)?;
    let groom = with_defaults(placed, &mut warnings);
    groom.check()?;
    Ok(ReadGroom { groom, format, warnings })
}

/// Points closer than this share of the groom's size count as one.
const COINCIDENT: f64 = 1e-9;

/// Leaves out what cannot be simulated: points on top of one another, and strands without a segment.
pub(crate) fn clean(raw: &mut RawGroom) {
    let size = raw.bounds().map_or(0.0, |[low, high]| (0..3).map(|a| high[a] - low[a]).fold(0.0, f64::max));
    let mut n_dropped = 0;
    for strand in &mut raw.strands {
        n_dropped += strand.drop_coincident(COINCIDENT * size);
    }
    let n_strands = raw.strands.len();
    let n_points: usize = raw.strands.iter().filter(|s| s.points.len() < 2).map(|s| s.points.len()).sum();
    raw.strands.retain(|s| s.points.len() >= 2);
    let n_short = n_strands - raw.strands.len();
    if n_short > 0 {
        let note =
            format!("{n_short} of {n_strands} strands have no segment ({n_points} points) and were left out");
        raw.warnings.push(note);
    }
    if n_dropped > 0 {
        raw.warnings.push(format!("{n_dropped} points lie on the one before and were left out"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::Vec3;

    #[test]
    fn points_on_one_another_and_strands_of_a_point_are_left_out() {
        let (a, b) = (Vec3::zeros(), Vec3::new(0.0, 0.0, -10.0));
        let mut raw = RawGroom::of_curves(vec![vec![a, a, b, b], vec![a], vec![a, a], Vec::new()]);
        raw.strands[0].along.width = vec![0.7, 0.8, 1.2, 1.3];
        clean(&mut raw);
        assert_eq!(raw.strands[0].along.width, [0.7, 1.2]);
        assert_eq!(raw.strands.len(), 1);
        assert_eq!(raw.strands[0].points, [a, b]);
        assert_eq!(
            raw.warnings,
            [
                "3 of 4 strands have no segment (2 points) and were left out",
                "3 points lie on the one before and were left out"
            ]
        );
    }
}
