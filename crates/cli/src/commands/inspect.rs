mod capture;

use super::validate::by_hand;
use super::{counted, for_other_tools, is_damaged, only_with, print_json, quality, read_file};
use crate::args::{InspectArgs, ReadArgs};
use crate::ui::Outcome;
use anyhow::{Context, anyhow};
use std::fmt::Write;
use std::path::Path;
use tousle_core::Quantity;
use tousle_eff::Inspection;
use tousle_eff::manifest::{EncodingInfo, EncodingName};
use tousle_groom::{GroomOptions, GroomReadError, GroomSummary};
use tousle_pipeline::Watch;

/// The first bytes of every MCAP file.
const MCAP_MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// `tousle inspect`
pub fn run(args: &InspectArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    let inputs: Vec<&Path> = [args.file.as_path()].into_iter().chain(args.session.as_deref()).collect();
    quality::check_reports(&args.report, &inputs)?;
    let bytes = read_file(&args.file)?;
    let cannot = || format!("cannot inspect {}", args.file.display());
    if bytes.starts_with(MCAP_MAGIC) {
        no_capture_options(args, "the file is a field")?;
        no_groom_options(args, "the file is a field")?;
        let inspection = tousle_eff::inspect(&bytes[..]).map_err(|error| {
            let saved = if is_damaged(&error) { " (`tousle recover` saves the whole steps)" } else { "" };
            anyhow!(error).context(format!("{}{saved}", cannot()))
        })?;
        show(args.json, &inspection, field_table)?;
    } else if tousle_ingest::guess_format(&bytes).is_some() {
        no_groom_options(args, "the file is a capture")?;
        if args.session.is_none() {
            let why = "a capture is told as its file has it otherwise";
            only_with("--session", why, &read_options_given(args))?;
        }
        return capture::run(args, &bytes, watch).with_context(cannot);
    } else {
        show(args.json, &groom(args, &bytes).with_context(cannot)?, groom_table)?;
    }
    Ok(Outcome::Fine)
}

/// What is in a groom, or what the file is instead.
fn groom(args: &InspectArgs, bytes: &[u8]) -> anyhow::Result<GroomSummary> {
    let other = |found: &str, advice: &str| {
        anyhow!("found {found}, expected a field, a capture or a groom ({advice})")
    };
    if let Some((_, found)) = for_other_tools(bytes) {
        return Err(other(found, "`tousle import` makes a field of wind in them"));
    }
    match by_hand::kind(bytes) {
        Some("session") => return Err(other("a session", "`tousle validate` checks sessions")),
        Some("edits") => return Err(other("edits", "`tousle validate` checks edits")),
        _ => {}
    }
    let mut options = GroomOptions::default();
    options.unit = args.groom_unit;
    options.up_axis = args.groom_up;
    let summary = tousle_groom::inspect_groom(bytes, &options);
    if let Err(GroomReadError::UnknownFormat { .. }) = summary {
        // Neither a field nor a groom: what a capture reader has to say is the clearest answer.
        let error = tousle_ingest::summarize(bytes).err().map(anyhow::Error::from);
        let error = error.unwrap_or_else(|| anyhow!("the format is unknown"));
        return Err(error.context("the file is neither a field, nor a groom, nor a capture"));
    }
    no_capture_options(args, "the file is a groom; its unit and its axes are --groom-unit and --groom-up")?;
    Ok(summary?)
}

/// Refuses options that say how a capture is read.
fn no_capture_options(args: &InspectArgs, why: &str) -> anyhow::Result<()> {
    only_with("a capture", why, &read_options_given(args))?;
    only_with("a capture", why, &[("--session", args.session.is_some())])
}

/// Refuses options that say how a groom is read.
fn no_groom_options(args: &InspectArgs, why: &str) -> anyhow::Result<()> {
    let given = [("--groom-unit", args.groom_unit.is_some()), ("--groom-up", args.groom_up.is_some())];
    only_with("a groom", why, &given)
}

fn read_options_given(args: &InspectArgs) -> [(&'static str, bool); 3] {
    let ReadArgs { unit, subject, allow_cut } = &args.read;
    [("--unit", unit.is_some()), ("--subject", subject.is_some()), ("--allow-cut", *allow_cut)]
}

fn show<T: serde::Serialize>(json: bool, summary: &T, table: impl Fn(&T) -> String) -> anyhow::Result<()> {
    if json {
        print_json(summary)?;
    } else {
        say!("{}", table(summary));
    }
    Ok(())
}

fn field_table(field: &Inspection) -> String {
    let mut text = String::new();
    let manifest = &field.manifest;
    let info = &manifest.field;
    let unit = Quantity::from(info.quantity).unit();
    let [from, to] = field.field_span_secs;
    let coverage = &field.coverage;
    let percent = |share: f64| 100.0 * share;
    let _ = writeln!(
        text,
        "field      {}, by method {} ({})",
        manifest.name, manifest.method, manifest.generator
    );
    let _ = writeln!(text, "time       {from:.3} to {to:.3} s at {} Hz", info.rate_hz);
    // To a nanometer: in meters most numbers of millimeters have no last digit.
    let edge_mm = (info.grid.edge_m * 1e9).round() / 1e6;
    let _ = writeln!(text, "grid       {:?} voxels of {edge_mm} mm", info.grid.dims);
    let _ = writeln!(
        text,
        "coverage   {:.1} % measured, {:.1} % interpolated, {:.1} % outside; {:.1} % measured at some time",
        percent(coverage.measured),
        percent(coverage.interpolated),
        percent(coverage.outside),
        percent(coverage.ever_measured)
    );
    let _ = writeln!(
        text,
        "strength   {:.2} {unit} in the mean where measured, {:.2} {unit} at most",
        coverage.mean_measured_length, coverage.max_length
    );
    let encoding = &info.encoding;
    let _ = writeln!(text, "packed     {}", packing(encoding, unit));
    if let Some(sd) = coverage.mean_sd {
        let _ = writeln!(text, "sure to    {sd:.3} {unit} in the mean, where that is known");
    }
    let [from, to] = field.pose_span_secs;
    let _ = writeln!(text, "head       {}, {from:.3} to {to:.3} s", counted(manifest.pose.n_poses, "pose"));
    for layer in &field.layers {
        let _ = writeln!(text, "edit       {layer}");
    }
    for channel in &field.channels {
        let kilobytes = channel.n_bytes as f64 / 1e3;
        let (topic, n) = (&channel.topic, channel.n_messages);
        let messages = if n == 1 { "message," } else { "messages," };
        let _ = writeln!(text, "channel    {topic:<14} {n:>6} {messages:<9} {kilobytes:>10.1} kB unpacked");
    }
    for (name, n_bytes) in &field.attachments {
        let _ = writeln!(text, "attached   {name} ({n_bytes} bytes)");
    }
    let _ = writeln!(text, "size       {:.2} MB", field.n_bytes as f64 / 1e6);
    text
}

fn groom_table(groom: &GroomSummary) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "groom      {}", groom.format);
    let _ = writeln!(text, "strands    {} with {} control points", groom.strands, groom.points);
    if let (Some(least), Some(most)) = (groom.counts.iter().min(), groom.counts.iter().max()) {
        let _ = writeln!(text, "points     {least} to {most} a strand");
    }
    let bounds = |[low, high]: [[f64; 3]; 2]| {
        let axis = |a: usize| format!("{:.3} to {:.3}", low[a], high[a]);
        format!("x {}, y {}, z {}", axis(0), axis(1), axis(2))
    };
    if let Some(file) = groom.bounds_in_file {
        let _ = writeln!(text, "in file    {}", bounds(file));
    }
    if let Some(meters) = groom.bounds_m {
        let _ = writeln!(text, "bounds, m  {}", bounds(meters));
    }
    for assumption in &groom.assumed {
        let _ = writeln!(text, "assumed    {assumption}");
    }
    for warning in &groom.warnings {
        let _ = writeln!(text, "warning    {warning}");
    }
    text
}

/// How the vectors are packed, and what that loses.
fn packing(encoding: &EncodingInfo, unit: &str) -> String {
    let (absolute, relative) = (encoding.max_absolute_error, encoding.max_relative_error);
    match encoding.kind {
        EncodingName::F32 => "f32, nothing lost".to_owned(),
        EncodingName::F16 => format!("f16, at most {:.2} % off", 100.0 * relative),
        EncodingName::Fixed => format!("fixed, at most {absolute} {unit} off"),
    }
}
