use tousle_core::{Groom, median_high};

use crate::defaults::with_defaults;
use crate::error::GroomReadError;
use crate::format::{GroomFormat, read_raw};
use crate::options::GroomOptions;
use crate::placement::place;
use crate::raw::{RawGroom, RawStrand, bounds};

/// A groom and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadGroom {
    /// The strands, head space, m; `assumed` lists what no one gave.
    pub groom: Groom,
    /// The format the bytes were in.
    pub format: GroomFormat,
    /// What was left out, changed or overruled.
    pub warnings: Vec<String>,
    /// The number of each strand in the file, from 0: ascending, with gaps where some were left out.
    pub numbers: Vec<usize>,
}

/// Reads a groom in any known format, which is told from the bytes.
///
/// Strands without a segment are left out and points that lie on the one before are dropped, with a warning for
/// each kind; strands without a name are called by their number in the file all the same. A groom that is nothing but such strands is an error.
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
    let numbers = raw.strands.iter().enumerate().map(|(k, strand)| strand.number.unwrap_or(k)).collect();
    let placed = place(raw, format, options, &mut warnings)?;
    let groom = with_defaults(placed, &mut warnings);
    groom.check()?;
    Ok(ReadGroom { groom, format, warnings, numbers })
}

/// Points closer than this share of the usual strand's size count as one.
const COINCIDENT: f64 = 1e-9;

/// Leaves out what cannot be simulated: points on top of one another, and strands without a segment.
pub(crate) fn clean(raw: &mut RawGroom) {
    let size = |strand: &RawStrand| {
        bounds(strand.points.iter())
            .map_or(0.0, |[low, high]| (0..3).map(|a| high[a] - low[a]).fold(0.0, f64::max))
    };
    // Not the whole groom's: one stray point would make all other strands' points one. Nor a strand's own: one that is all but a
    // point would keep its own apart.
    let usual = median_high(raw.strands.iter().map(size).collect()).unwrap_or(0.0);
    let mut n_dropped = 0;
    for strand in &mut raw.strands {
        n_dropped += strand.drop_coincident(COINCIDENT * usual);
    }
    let n_strands = raw.strands.len();
    let n_points: usize = raw.strands.iter().filter(|s| s.points.len() < 2).map(|s| s.points.len()).sum();
    raw.strands.iter_mut().enumerate().for_each(|(k, strand)| strand.number = Some(k));
    let short = raw.strands.iter().filter(|s| s.points.len() < 2).filter_map(|s| s.number);
    let short: Vec<usize> = short.collect();
    raw.strands.retain(|s| s.points.len() >= 2);
    if !short.is_empty() {
        let n_short = short.len();
        raw.warnings.push(format!(
            "{n_short} of {n_strands} strands have no segment ({n_points} points) and were left out: {}",
            left_out(&short)
        ));
    }
    if n_dropped > 0 {
        raw.warnings.push(format!("{n_dropped} points lie on the one before and were left out"));
    }
}

/// The most runs of strands that are named.
const MAX_RUNS: usize = 20;

/// Which strands were left out, counted from 1 as in names, and how many places those after them come earlier for it.
fn left_out(numbers: &[usize]) -> String {
    let runs: Vec<&[usize]> = numbers.chunk_by(|a, b| a + 1 == *b).collect();
    let mut n_before = 0;
    let mut words: Vec<String> = Vec::new();
    for run in runs.iter().take(MAX_RUNS) {
        n_before += run.len();
        let (first, last) = (run[0] + 1, run[run.len() - 1] + 1);
        let which = if first == last { format!("{first}") } else { format!("{first} to {last}") };
        let what = if words.is_empty() { "those after it come " } else { "" };
        words.push(format!("{which} ({what}{n_before} earlier in what is written)"));
    }
    if runs.len() > MAX_RUNS {
        words.push(format!("{} more ({} earlier after the last)", numbers.len() - n_before, numbers.len()));
    }
    words.join(", ")
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
                "3 of 4 strands have no segment (2 points) and were left out: 2 to 4 (those after it come 3 earlier in what is \
                 written)",
                "3 points lie on the one before and were left out"
            ]
        );
    }

    #[test]
    fn a_stray_point_makes_no_other_points_one() {
        let curve = |far: f64| vec![Vec3::zeros(), Vec3::x(), Vec3::new(1.0, far, 0.0)];
        let mut raw = RawGroom::of_curves(vec![curve(1.0), curve(3e38), curve(1.0), curve(1e-12)]);
        clean(&mut raw);
        assert_eq!(raw.strands.iter().map(|s| s.points.len()).collect::<Vec<_>>(), [3, 3, 3, 2]);
    }

    #[test]
    fn strands_keep_their_numbers_when_others_are_left_out() {
        let (a, b) = (Vec3::zeros(), Vec3::new(0.0, 0.0, -10.0));
        let mut curves = vec![vec![a, b]; 12];
        for k in [1, 2, 6] {
            curves[k] = vec![a];
        }
        let mut raw = RawGroom::of_curves(curves);
        (raw.unit_m, raw.up_axis) = (Some(0.01), Some(tousle_core::UpAxis::Z));
        clean(&mut raw);
        assert!(
            raw.warnings[0].ends_with(
                "left out: 2 to 3 (those after it come 2 earlier in what is written), 7 (3 earlier in what is written)"
            ),
            "{:?}",
            raw.warnings
        );
        let read = finish(raw, GroomFormat::Hair, &GroomOptions::default()).unwrap();
        assert_eq!(read.numbers, [0, 3, 4, 5, 7, 8, 9, 10, 11]);
        let names: Vec<&str> = read.groom.strands.iter().map(|s| s.name.as_str()).collect();
        assert_eq!(names, ["01", "04", "05", "06", "08", "09", "10", "11", "12"]);
    }

    #[test]
    fn of_many_strands_that_are_left_out_some_are_named() {
        let words = left_out(&(0..50).map(|k| 2 * k).collect::<Vec<_>>());
        assert!(
            words.ends_with("39 (20 earlier in what is written), 30 more (50 earlier after the last)"),
            "{words}"
        );
    }
}
