use super::super::{name, quality, read_options};
use crate::args::InspectArgs;
use crate::commands::print_json;
use crate::ui::Outcome;
use anyhow::Context;
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;
use tousle_clean::CleanOptions;
use tousle_ingest::{CaptureSummary, TrajectorySummary};
use tousle_pipeline::{Input, PrepareOptions, Prepared, QualityReport, Watch, prepare, read_file};

/// What `--json` prints of a capture with a session: the contract's fields, and the quality report beside them.
#[derive(Serialize)]
struct WithQuality<'a> {
    #[serde(flatten)]
    summary: &'a CaptureSummary,
    quality: &'a QualityReport,
}

/// Tells what is in a capture file, and with a session how good it is: with loss where frames that it claims are not there.
pub(super) fn run(args: &InspectArgs, bytes: &[u8], watch: &dyn Watch) -> anyhow::Result<Outcome> {
    let summary = tousle_ingest::summarize(bytes)?;
    let prepared = args.session.as_ref().map(|session| prepared(args, bytes, session, watch)).transpose()?;
    if let Some(prepared) = &prepared {
        quality::write_reports(&args.report, &args.file, prepared)?;
    }
    let quality = prepared.as_ref().map(|p| &p.quality);
    match (args.json, quality) {
        (true, None) => print_json(&summary)?,
        (true, Some(quality)) => print_json(&WithQuality { summary: &summary, quality })?,
        (false, quality) => {
            say!("{}", table(&summary));
            if let Some(quality) = quality {
                say!("\n{}", quality::summary(quality));
                // What the file alone brings up stands in the table.
                let of_session = quality.ingest.warnings.iter().filter(|w| !summary.warnings.contains(w));
                of_session.for_each(|warning| sayln!("{:>10}  {warning}", "warning"));
            }
        }
    }
    let Some(loss) = quality.and_then(QualityReport::loss) else { return Ok(Outcome::Fine) };
    note!("loss: {loss}");
    Ok(Outcome::WithLoss)
}

fn prepared(args: &InspectArgs, bytes: &[u8], session: &Path, watch: &dyn Watch) -> anyhow::Result<Prepared> {
    let session_bytes = read_file(session)?;
    let options = PrepareOptions {
        ingest: read_options(&args.read),
        clean: (!args.no_clean).then(CleanOptions::default),
        ..PrepareOptions::default()
    };
    let capture = Input { name: &name(&args.file), bytes };
    let session = Input { name: &name(session), bytes: &session_bytes };
    prepare(capture, session, &options, watch).context("the session does not help")
}

fn table(capture: &CaptureSummary) -> String {
    let mut text = String::new();
    let mut line = |label: &str, words: String| {
        let _ = writeln!(text, "{label:<10} {words}");
    };
    let maybe = |value: Option<String>| value.unwrap_or_else(|| "not stated".to_owned());
    let all = (capture.frames * capture.trajectories.len()).max(1);
    let last_frame = capture.first_frame.saturating_add(capture.frames as i64).saturating_sub(1);
    line("capture", capture.format.to_string());
    let secs = capture.rate_hz.map_or_else(String::new, |r| format!(", {:.2} s", capture.frames as f64 / r));
    line("frames", format!("{} ({} to {last_frame}){secs}", capture.frames, capture.first_frame));
    line("rate", maybe(capture.rate_hz.map(|r| format!("{r} Hz"))));
    line("unit", maybe(capture.unit.clone()));
    line("up axis", maybe(capture.up_axis.map(|axis| format!("{axis:?}"))));
    if !capture.subjects.is_empty() {
        line("subjects", capture.subjects.join(", "));
    }
    let n_unlabeled = capture.n_unlabeled;
    line("points", format!("{} ({n_unlabeled} unlabeled)", capture.trajectories.len()));
    line(
        "missing",
        format!(
            "{} of {all} samples ({:.1} %)",
            capture.invalid_samples,
            100.0 * capture.invalid_samples as f64 / all as f64
        ),
    );
    for other in &capture.other {
        line("also", other.to_string());
    }
    for warning in &capture.warnings {
        line("warning", warning.clone());
    }
    text.push_str(&trajectories(capture));
    text
}

fn trajectories(capture: &CaptureSummary) -> String {
    let mut text = String::new();
    let widest = capture.trajectories.iter().map(|t| t.label.chars().count()).max().unwrap_or(0);
    let width = widest.clamp(10, 40);
    let unit = capture.unit.as_deref().map_or_else(String::new, |unit| format!(", {unit}"));
    let _ = writeln!(
        text,
        "\n{:<width$} {:>7} {:>6} {:>5} {:>8}  {:>10} {:>10} {:>10}",
        "trajectory",
        "valid",
        "%",
        "gaps",
        "longest",
        "mean x",
        "y",
        format!("z{unit}")
    );
    for TrajectorySummary { label, valid, mean, gaps, longest_gap } in &capture.trajectories {
        let share = 100.0 * *valid as f64 / capture.frames.max(1) as f64;
        let mean = mean.map_or_else(String::new, |[x, y, z]| format!("{x:>10.2} {y:>10.2} {z:>10.2}"));
        let _ = writeln!(text, "{label:<width$} {valid:>7} {share:>6.1} {gaps:>5} {longest_gap:>8}  {mean}");
    }
    text
}
