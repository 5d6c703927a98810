use super::{add_eff, check_output, name, only_with, print_json, quality, read_options, write_options};
use crate::args::{ConvertArgs, MethodArg, ReadingArg};
use crate::ui::Outcome;
use std::fmt::Write;
use tousle_clean::CleanOptions;
use tousle_fit::{FitMethod, FitOptions, PaperOptions, PaperReading, PaperSpan, PhysicalOptions};
use tousle_page::decimals;
use tousle_pipeline::{ConversionReport, ConvertOptions, Input, Outputs, PrepareOptions, Watch, read_file};
use tousle_refine::RefineOptions;

/// `tousle convert`
pub fn run(args: &ConvertArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    let inputs = [args.capture.as_path(), &args.session];
    check_output(&args.output, &["mcap"], &inputs)?;
    quality::check_reports(&args.report, &inputs)?;
    check_options(args)?;
    let pack = write_options(&args.pack)?;
    let options = options(args);
    let capture = read_file(&args.capture)?;
    let session = read_file(&args.session)?;
    let converted = tousle_pipeline::convert(
        Input { name: &name(&args.capture), bytes: &capture },
        Input { name: &name(&args.session), bytes: &session },
        &options,
        watch,
    )?;
    let mut outputs = Outputs::default();
    let written = add_eff(&mut outputs, &converted.eff, &args.output, &pack, watch)?;
    quality::add_reports(&mut outputs, &args.report, &args.capture, &converted.prepared)?;
    outputs.appear()?;
    let report = &converted.report;
    if args.json {
        print_json(report)?;
    } else {
        say!("{}", summary(report));
        sayln!(
            "wrote {} ({} steps, {:.1} MB)",
            args.output.display(),
            written.n_steps,
            written.n_bytes as f64 / 1e6
        );
    }
    for loss in &report.losses {
        eprintln!("loss: {loss}");
    }
    Ok(if report.losses.is_empty() { Outcome::Fine } else { Outcome::WithLoss })
}

/// Refuses options of the method that is not used.
fn check_options(args: &ConvertArgs) -> anyhow::Result<()> {
    if args.method == MethodArg::Paper {
        let why = "the captured wig is simulated in a wind, not in forces";
        only_with("--method physical", why, &[("--refine", args.refine)])?;
    } else {
        let given = [("--reading", args.reading.is_some()), ("--span-ms", args.span_ms.is_some())];
        only_with("--method paper", "it says how the paper's equation E3 is read", &given)?;
    }
    if args.reading == Some(ReadingArg::FirstFrame) {
        let why = "the reading first-frame counts s from the first frame";
        only_with("another --reading", why, &[("--span-ms", args.span_ms.is_some())])?;
    }
    Ok(())
}

fn options(args: &ConvertArgs) -> ConvertOptions {
    let reading = match args.reading {
        Some(ReadingArg::FirstFrame) => PaperReading::FirstFrame,
        Some(ReadingArg::SlidingWindow) => PaperReading::SlidingWindow,
        Some(ReadingArg::RestPose) | None => PaperReading::RestPose,
    };
    let span = args.span_ms.map_or(PaperSpan::FreeFall, |ms| PaperSpan::Secs(ms * 1e-3));
    let method = match args.method {
        MethodArg::Paper => FitMethod::Paper(PaperOptions { reading, span }),
        MethodArg::Physical => FitMethod::Physical(PhysicalOptions::default()),
    };
    let prepare = PrepareOptions {
        ingest: read_options(&args.read),
        clean: (!args.no_clean).then(CleanOptions::default),
        ..PrepareOptions::default()
    };
    ConvertOptions {
        prepare,
        fit: FitOptions { method, rate_hz: args.rate_hz, ..FitOptions::default() },
        refine: Some(if args.refine { RefineOptions::default() } else { RefineOptions::quick() }),
        extent_m: args.extent_mm * 1e-3,
        edge_m: args.voxel_mm * 1e-3,
    }
}

/// What happened, in a few lines.
pub fn summary(report: &ConversionReport) -> String {
    let mut text = quality::summary(&report.quality);
    let mut line = |label: &str, words: String| {
        let _ = writeln!(text, "{label:>10}  {words}");
    };
    let fit = &report.fit;
    let filled = match fit.n_filled {
        0 => String::new(),
        n if fit.physical.is_some() => {
            format!(" ({n} of them filled, which shape the lock but are no samples)")
        }
        n => format!(" ({n} of them filled, which this method does not use)"),
    };
    line(
        "wind",
        format!(
            "{}: {} samples in {} steps, {} missing{filled}",
            fit.method, fit.n_samples, fit.n_steps, fit.n_missing
        ),
    );
    if let Some(found) = &fit.physical {
        let range = |values: Vec<f64>| {
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            (low, values.iter().copied().fold(low, f64::max))
        };
        let stiffness = range(found.locks.iter().map(|lock| lock.stiffness_n_m2 * 1e6).collect());
        let learnt = report.refine.as_ref().is_some_and(|refined| refined.kept > 0);
        let drag = range(found.locks.iter().map(|lock| lock.drag_scale).collect());
        // What rounds to nothing is 0, not -0.
        line(
            "air",
            format!(
                "{} m/s far away on average, {} % less in the wake, {} mm of slow air at the scalp",
                decimals(found.outside_mps, 1),
                decimals(found.wake * 100.0, 0),
                decimals(found.layer_m * 1e3, 0)
            ),
        );
        line(
            "locks",
            format!(
                "{} explained; stiffness {:.1} to {:.1} 10⁻⁶ N·m², drag {:.2} to {:.2} of that by width ({})",
                found.locks.len(),
                stiffness.0,
                stiffness.1,
                drag.0,
                drag.1,
                if learnt { "learnt from the simulated wig" } else { "what is likely" },
            ),
        );
        for warning in &found.warnings {
            line("warning", warning.clone());
        }
    }
    if let Some(refined) = &report.refine {
        let off = |k: usize| {
            let round = &refined.rounds[k];
            match round.held_out_m {
                Some(held_out_m) => {
                    format!("{:.1} mm, held-out locks by {:.1} mm", round.seen_m * 1e3, held_out_m * 1e3)
                }
                None => format!("{:.1} mm", round.seen_m * 1e3),
            }
        };
        let outcome = match refined.kept {
            0 => "nothing made those better: the wind is as it was measured".to_owned(),
            1 => format!("after a round by {}", off(1)),
            kept => format!("after {kept} rounds by {}", off(kept)),
        };
        let words = "times as stiff as so many fine hairs: thus it moves in its wind as it was seen to";
        if let Some(stiffness) = refined.stiffness {
            let percent = stiffness.spread * 100.0;
            line("the wig", format!("is {:.2} (standard deviation {percent:.0} %) {words}", stiffness.times));
        }
        if refined.rounds[0].seen_m.is_finite() {
            line("refined", format!("the simulated wig was off by {}; {outcome}", off(0)));
        }
    }
    let raster = &report.raster;
    let all = (raster.n_measured + raster.n_interpolated + raster.n_outside).max(1) as f64;
    let percent = |n: u64| 100.0 * n as f64 / all;
    line(
        "field",
        format!(
            "{:.1} % of voxels measured, {:.1} % interpolated, {:.1} % outside",
            percent(raster.n_measured),
            percent(raster.n_interpolated),
            percent(raster.n_outside)
        ),
    );
    for warning in &report.quality.ingest.warnings {
        line("warning", warning.clone());
    }
    text
}
