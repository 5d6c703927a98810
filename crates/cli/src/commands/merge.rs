use super::{check_output, counted, name, open_field, print_json, unusable, write_options};
use crate::args::{MergeArgs, SpanArg};
use crate::ui::Outcome;
use std::fmt::Write;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use tousle_core::Quantity;
use tousle_eff::Reader;
use tousle_merge::{MergeOptions, MergeReport, Span};
use tousle_pipeline::{MergeSource, Watch, write_whole};

/// `tousle merge`
pub fn run(args: &MergeArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    let inputs: Vec<&Path> = args.fields.iter().map(PathBuf::as_path).collect();
    check_output(&args.output, &["mcap"], &inputs)?;
    let encoding = args.pack.given().map(|pack| write_options(&pack)).transpose()?.map(|pack| pack.encoding);
    let names: Vec<String> = args.fields.iter().map(|path| name(path)).collect();
    let n_offsets = args.offset_secs.len();
    if ![0, names.len()].contains(&n_offsets) {
        wrong!("--offset-secs: found {n_offsets} numbers, expected {}, one a field", names.len());
    }
    let offsets = args.offset_secs.iter().copied().chain(std::iter::repeat(0.0));
    let mut sources = Vec::new();
    for ((path, name), offset_secs) in args.fields.iter().zip(&names).zip(offsets) {
        sources.push(MergeSource { name, input: BufReader::new(open_field(path)?), offset_secs });
    }
    let (report, written) = write_whole(&args.output, |out| {
        tousle_pipeline::merge(sources, out, &options(args), encoding, args.pack.preview, watch)
    })?;
    if args.json {
        print_json(&report)?;
    } else {
        say!("{}", summary(&report, unit(&args.fields[0])?));
        let (steps, megabytes) = (counted(written.n_steps, "step"), written.n_bytes as f64 / 1e6);
        sayln!("wrote {} ({steps}, {megabytes:.1} MB)", args.output.display());
    }
    for warning in &report.warnings {
        note!("warning: {warning}");
    }
    Ok(Outcome::Fine)
}

/// The unit of a field's vectors.
fn unit(field: &Path) -> anyhow::Result<&'static str> {
    let reader = Reader::open(open_field(field)?).map_err(|error| unusable(error, field))?;
    Ok(Quantity::from(reader.manifest().field.quantity).unit())
}

fn options(args: &MergeArgs) -> MergeOptions {
    let mut options = MergeOptions::default();
    options.span = match args.span {
        SpanArg::All => Span::All,
        SpanArg::Common => Span::Common,
    };
    options.rate_hz = args.rate_hz;
    options.tolerance_m = args.tolerance_mm * 1e-3;
    options.tolerance_rad = args.tolerance_deg.to_radians();
    options
}

fn summary(report: &MergeReport, unit: &str) -> String {
    let mut text = String::new();
    let percent = |share: f64| 100.0 * share;
    for input in &report.inputs {
        let [from, to] = input.span_secs;
        let _ = writeln!(
            text,
            "     input  {}: {from:.3} to {to:.3} s, {:.1} % measured, heard in {:.1} % of the voxels",
            input.name,
            percent(input.coverage[2]),
            percent(input.heard)
        );
    }
    let [outside, interpolated, measured] = report.coverage.map(percent);
    let _ = writeln!(
        text,
        "     field  {measured:.1} % of voxels measured, {interpolated:.1} % interpolated, {outside:.1} % outside"
    );
    if let Some(rms) = report.rms_disagreement {
        let ratio = report.birge_ratio.map_or_else(String::new, |ratio| {
            format!(", {ratio:.2} times what their standard deviations say")
        });
        let _ = writeln!(
            text,
            "    agrees  to {rms:.3} {unit} rms{ratio}, in {} voxels that several measured",
            report.n_measured_by_several
        );
    }
    if let Some(rms) = report.rms_outside_disagreement {
        let _ = writeln!(text, "   outside  the winds agree to {rms:.3} {unit} rms");
    }
    text
}
