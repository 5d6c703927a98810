//! What trivial predictors get, as `BASELINES.md` beside the captures tells it.
//!
//! The figures are quoted, not computed again: how the pendulum is damped is not written there. What never
//! moves is computed by [`never_moves`], and agrees.

use crate::TrueMotion;
use serde::Serialize;
use std::path::Path;
use tousle_core::StrandMotion;

/// How style B was predicted without measuring anything, or with everything known.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Baseline {
    /// The capture's name.
    pub capture: String,
    /// What predicted: `never moves`, `pendulum`; for exact hair, in which wind: `whole true field`, …
    pub predictor: String,
    /// Mean distance to the truth, mm.
    pub mean_mm: f64,
    /// The distance that 95 % stay below, mm.
    pub p95_mm: f64,
    /// 1 − rms error / rms displacement.
    pub explained_motion: f64,
    /// The same after each point's own time mean is taken off both.
    pub explained_fluctuation: f64,
    /// Explained motion of the median lock.
    pub median_lock: f64,
}

impl Baseline {
    /// Exact hair in the whole true wind, which is as near as anybody came.
    pub const CEILING: &'static str = "whole true field";
}

/// What `BASELINES.md` in a folder of captures says; nothing if it is not there.
pub(crate) fn baselines_beside(captures: &Path) -> Vec<Baseline> {
    std::fs::read_to_string(captures.join("BASELINES.md"))
        .map_or_else(|_| Vec::new(), |text| read_baselines(&text))
}

/// The rows about style B in the text of `BASELINES.md`: trivial predictors, then exact hair in a given wind.
///
/// Tables without the columns of a [`Baseline`], and those about the captured wig itself, are passed over.
pub fn read_baselines(markdown: &str) -> Vec<Baseline> {
    let mut baselines = Vec::new();
    let mut of_style_b = false;
    let mut columns: Vec<&str> = Vec::new();
    for line in markdown.lines() {
        if line.starts_with('#') {
            of_style_b = line.contains("style B");
        }
        let Some(row) = line.trim().strip_prefix('|') else {
            columns.clear();
            continue;
        };
        let cells: Vec<&str> = row.trim_end_matches('|').split('|').map(str::trim).collect();
        if columns.is_empty() {
            columns = cells;
        } else if of_style_b {
            baselines.extend(baseline(&columns, &cells));
        }
    }
    baselines
}

/// Every point at its mean still position, at the truth's first and last time.
pub fn never_moves(truth: &TrueMotion) -> StrandMotion {
    let rest: Vec<[f32; 3]> = truth.rest_m().iter().map(|p| p.map(|c| c as f32).into()).collect();
    let times_secs: Vec<f64> = match truth.times_secs.as_slice() {
        [first, .., last] => vec![*first, *last],
        times => times.to_vec(),
    };
    StrandMotion {
        counts: truth.locks.iter().map(|(_, n)| *n).collect(),
        positions_m: rest.repeat(times_secs.len()),
        times_secs,
    }
}

fn baseline(columns: &[&str], cells: &[&str]) -> Option<Baseline> {
    let cell = |name: &str| cells.get(columns.iter().position(|c| *c == name)?).copied();
    let figure = |name: &str| cell(name)?.parse::<f64>().ok();
    Some(Baseline {
        capture: cell("capture")?.to_owned(),
        predictor: cell("predictor").or(cell("wind given"))?.to_owned(),
        mean_mm: figure("mean mm")?,
        p95_mm: figure("95 % mm")?,
        explained_motion: figure("explained motion")?,
        explained_fluctuation: figure("explained fluctuation")?,
        median_lock: figure("median lock explained")?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_about_style_b_are_read_and_no_others() {
        let markdown = "\
## Another hairstyle (style B, all control points but the roots)

| capture | predictor | mean mm | 95 % mm | explained motion | explained fluctuation | median lock explained |
| --- | --- | --- | --- | --- | --- | --- |
| gusts | pendulum | 45.0 | 129.9 | +0.543 | +0.225 | +0.501 |

## The captured wig itself

| capture | predictor | mean mm | 95 % mm | explained motion | explained fluctuation | median lock explained |
| --- | --- | --- | --- | --- | --- | --- |
| gusts | pendulum | 49.0 | 136.0 | +0.362 | +0.157 | +0.422 |
";
        let rows = read_baselines(markdown);
        assert_eq!(rows.len(), 1);
        assert_eq!((rows[0].predictor.as_str(), rows[0].median_lock), ("pendulum", 0.501));
    }
}
