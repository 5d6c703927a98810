use serde::Serialize;
use tousle_core::Assumption;

use crate::error::GroomReadError;
use crate::format::{GroomFormat, read_raw};
use crate::options::GroomOptions;
use crate::raw::bounds;
use crate::read::{clean, finish};

/// What is in a groom file, as `inspect GROOM --json` says it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GroomSummary {
    /// Always `groom`.
    pub kind: &'static str,
    /// The format's name.
    pub format: GroomFormat,
    /// How many strands.
    pub strands: usize,
    /// Control points of all strands.
    pub points: usize,
    /// Smallest and largest coordinates, head space, m; `None` while unit or up axis are unknown.
    pub bounds_m: Option<[[f64; 3]; 2]>,
    /// Smallest and largest coordinates in the file's own axes and unit.
    pub bounds_in_file: Option<[[f64; 3]; 2]>,
    /// Control points of each strand.
    pub counts: Vec<usize>,
    /// What a default stands for.
    pub assumed: Vec<Assumption>,
    /// What was left out, changed or overruled, and what is missing before the groom can be used.
    pub warnings: Vec<String>,
}

/// Tells what is in a groom file. One that states no unit or up axis is looked at all the same, without
/// `bounds_m` and with a warning that says what to pass.
///
/// # Errors
/// As [`read_groom`](crate::read_groom), for everything else.
pub fn inspect_groom(bytes: &[u8], options: &GroomOptions) -> Result<GroomSummary, GroomReadError> {
    let (format, mut raw) = read_raw(bytes)?;
    let bounds_in_file = raw.bounds();
    clean(&mut raw);
    let counts: Vec<usize> = raw.strands.iter().map(|s| s.points.len()).collect();
    let mut summary = GroomSummary {
        kind: "groom",
        format,
        strands: counts.len(),
        points: counts.iter().sum(),
        bounds_m: None,
        bounds_in_file,
        counts,
        assumed: Vec::new(),
        warnings: Vec::new(),
    };
    let warnings = raw.warnings.clone();
    match finish(raw, format, options) {
        Ok(read) => {
            summary.bounds_m = bounds(read.groom.strands.iter().flat_map(|s| s.rest_curve_m.iter()));
            summary.assumed = read.groom.assumed;
            summary.warnings = read.warnings;
        }
        Err(missing @ GroomReadError::NotStated { .. }) => {
            summary.warnings = warnings;
            summary.warnings.push(missing.to_string());
        }
        Err(other) => return Err(other),
    }
    Ok(summary)
}
