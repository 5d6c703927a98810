mod summary;

use self::summary::summary;
use super::{
    add_eff, check_output, counted, name, only_with, print_json, quality, read_options, write_options,
};
use crate::args::{ConvertArgs, MethodArg, ReadingArg};
use crate::ui::Outcome;
use tousle_clean::CleanOptions;
use tousle_fit::{FitMethod, FitOptions, PaperOptions, PaperReading, PaperSpan, PhysicalOptions};
use tousle_pipeline::{ConvertOptions, Input, Outputs, PrepareOptions, Watch, read_file};
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
            "wrote {} ({}, {:.1} MB)",
            args.output.display(),
            counted(written.n_steps, "step"),
            written.n_bytes as f64 / 1e6
        );
    }
    for loss in &report.losses {
        note!("loss: {loss}");
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
