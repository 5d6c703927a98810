use crate::commands::quality;
use std::fmt::Write;
use tousle_fit::{FitReport, PhysicalReport};
use tousle_page::decimals;
use tousle_pipeline::ConversionReport;
use tousle_refine::{RefineReport, Round, Stiffness};

/// What happened, in a few lines.
pub(super) fn summary(report: &ConversionReport) -> String {
    let mut text = quality::summary(&report.quality);
    for (label, words) in lines(report) {
        let _ = writeln!(text, "{label:>10}  {words}");
    }
    text
}

/// What came after head and cleaning, line by line, each with its label.
fn lines(report: &ConversionReport) -> Vec<(&'static str, String)> {
    let warning = |words: &String| ("warning", words.clone());
    let mut lines = vec![("wind", wind(&report.fit))];
    if let Some(found) = &report.fit.physical {
        let learnt = report.refine.as_ref().is_some_and(|refined| refined.kept > 0);
        lines.push(("air", air(found)));
        lines.push(("locks", locks(found, learnt)));
        lines.extend(found.warnings.iter().map(warning));
    }
    if let Some(refined) = &report.refine {
        lines.extend(refined.stiffness.map(|stiffness| ("the wig", wig(stiffness))));
        if refined.rounds[0].seen_m.is_finite() {
            lines.push(("refined", rounds(refined)));
        }
    }
    lines.push(("field", field(report)));
    lines.extend(report.quality.ingest.warnings.iter().map(warning));
    lines
}

fn wind(fit: &FitReport) -> String {
    let filled = match fit.n_filled {
        0 => String::new(),
        n if fit.physical.is_some() => {
            format!(" ({n} of them filled, which shape the lock but are no samples)")
        }
        n => format!(" ({n} of them filled, which this method does not use)"),
    };
    format!(
        "{}: {} samples in {} steps, {} missing{filled}",
        fit.method, fit.n_samples, fit.n_steps, fit.n_missing
    )
}

fn air(found: &PhysicalReport) -> String {
    // What rounds to nothing is 0, not -0.
    format!(
        "{} m/s far away on average, {} % less in the wake, {} mm of slow air at the scalp",
        decimals(found.outside_mps, 1),
        decimals(found.wake * 100.0, 0),
        decimals(found.layer_m * 1e3, 0)
    )
}

fn locks(found: &PhysicalReport, learnt: bool) -> String {
    let range = |values: Vec<f64>| {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        (low, values.iter().copied().fold(low, f64::max))
    };
    let stiffness = range(found.locks.iter().map(|lock| lock.stiffness_n_m2 * 1e6).collect());
    let drag = range(found.locks.iter().map(|lock| lock.drag_scale).collect());
    format!(
        "{} explained; stiffness {:.1} to {:.1} 10⁻⁶ N·m², drag {:.2} to {:.2} of that by width ({})",
        found.locks.len(),
        stiffness.0,
        stiffness.1,
        drag.0,
        drag.1,
        if learnt { "learnt from the simulated wig" } else { "what is likely" },
    )
}

fn wig(stiffness: Stiffness) -> String {
    format!(
        "is {:.2} (standard deviation {:.0} %) times as stiff as so many fine hairs: thus it moves in its wind as it was seen to",
        stiffness.times,
        stiffness.spread * 100.0
    )
}

fn rounds(refined: &RefineReport) -> String {
    let off = |Round { seen_m, held_out_m, .. }: &Round| match held_out_m {
        Some(held_out_m) => {
            format!("{:.1} mm, held-out locks by {:.1} mm", seen_m * 1e3, held_out_m * 1e3)
        }
        None => format!("{:.1} mm", seen_m * 1e3),
    };
    let outcome = match refined.kept {
        0 => "nothing made those better: the wind is as it was measured".to_owned(),
        1 => format!("after a round by {}", off(&refined.rounds[1])),
        kept => format!("after {kept} rounds by {}", off(&refined.rounds[kept])),
    };
    format!("the simulated wig was off by {}; {outcome}", off(&refined.rounds[0]))
}

fn field(report: &ConversionReport) -> String {
    let raster = &report.raster;
    let all = (raster.n_measured + raster.n_interpolated + raster.n_outside).max(1) as f64;
    let percent = |n: u64| 100.0 * n as f64 / all;
    format!(
        "{:.1} % of voxels measured, {:.1} % interpolated, {:.1} % outside",
        percent(raster.n_measured),
        percent(raster.n_interpolated),
        percent(raster.n_outside)
    )
}
