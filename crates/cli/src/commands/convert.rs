use super::{check_ending, name, print_json, write_eff, write_options};
use crate::args::{ConvertArgs, MethodArg, ReadingArg};
use crate::ui::Outcome;
use std::fmt::Write;
use tousle_fit::{FitMethod, FitOptions, PaperOptions, PaperReading, PaperSpan};
use tousle_ingest::IngestOptions;
use tousle_pipeline::{ConversionReport, ConvertOptions, Input, Watch, read_file};

/// `tousle convert`
pub fn run(args: &ConvertArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    check_ending(&args.output, &["mcap"])?;
    let pack = write_options(&args.pack)?;
    let capture = read_file(&args.capture)?;
    let session = read_file(&args.session)?;
    let converted = tousle_pipeline::convert(
        Input { name: &name(&args.capture), bytes: &capture },
        Input { name: &name(&args.session), bytes: &session },
        &options(args),
        watch,
    )?;
    let written = write_eff(&converted.eff, &args.output, &pack, watch)?;
    let report = &converted.report;
    if args.json {
        print_json(report)?;
    } else {
        print!("{}", summary(report));
        println!(
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

fn options(args: &ConvertArgs) -> ConvertOptions {
    let reading = match args.reading {
        ReadingArg::FirstFrame => PaperReading::FirstFrame,
        ReadingArg::SlidingWindow => PaperReading::SlidingWindow,
        ReadingArg::RestPose => PaperReading::RestPose,
    };
    let span = args.span_ms.map_or(PaperSpan::FreeFall, |ms| PaperSpan::Secs(ms * 1e-3));
    let method = match args.method {
        MethodArg::Paper => FitMethod::Paper(PaperOptions { reading, span }),
    };
    let ingest = IngestOptions {
        unit: args.read.unit,
        subject: args.read.subject.clone(),
        allow_cut: args.read.allow_cut,
        ..IngestOptions::default()
    };
    ConvertOptions {
        ingest,
        fit: FitOptions { method, rate_hz: args.rate_hz },
        extent_m: args.extent_mm * 1e-3,
        edge_m: args.voxel_mm * 1e-3,
        ..ConvertOptions::default()
    }
}

/// What a technician wants to know at once.
pub fn summary(report: &ConversionReport) -> String {
    let mut text = String::new();
    let capture = &report.capture;
    let mut line = |label: &str, words: String| {
        let _ = writeln!(text, "{label:>10}  {words}");
    };
    line(
        "capture",
        format!(
            "{}, {} frames at {} Hz ({:.2} s), {} trajectories ({} unlabeled), {:.1} % of lock samples seen",
            capture.format,
            capture.n_frames,
            capture.rate_hz,
            capture.duration_secs,
            capture.n_trajectories,
            capture.n_unlabeled,
            100.0 * capture.seen
        ),
    );
    line("head", head_line(report));
    let fit = &report.fit;
    line(
        "wind",
        format!(
            "{}: {} samples in {} steps, {} missing",
            fit.method, fit.n_samples, fit.n_steps, fit.n_missing
        ),
    );
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
    for assumption in &report.assumed {
        line("assumed", format!("{} = {} ({})", assumption.what, assumption.value, assumption.why));
    }
    for warning in &report.ingest.warnings {
        line("warning", warning.clone());
    }
    text
}

fn head_line(report: &ConversionReport) -> String {
    let head = &report.head;
    let trusted = head.markers.iter().filter(|m| m.trusted).count();
    let left_out: Vec<&str> = head.markers.iter().filter(|m| !m.trusted).map(|m| m.label.as_str()).collect();
    let mut words = format!("{trusted} of {} markers follow it", head.markers.len());
    if !left_out.is_empty() {
        let _ = write!(words, " (left out: {})", left_out.join(", "));
    }
    if let Some(residual_m) = head.fit_residual_m {
        let _ = write!(words, ", fit residual {:.2} mm", residual_m * 1e3);
    }
    let _ = write!(words, ", {}", if head.pose_track.moves { "moves" } else { "still" });
    words
}
