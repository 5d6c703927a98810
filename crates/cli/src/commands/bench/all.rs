//! Every part of the bench that can be run with what is given, and one page over them.

use super::{make_folder, part, write_report, write_text};
use crate::args::{BenchAllArgs, BenchPaperArgs, BenchPart, BenchSimArgs, BenchWindArgs};
use crate::commands::only_with;
use crate::ui::{Outcome, error_lines};
use anyhow::ensure;
use clap::ValueEnum;
use std::path::Path;
use std::time::Instant;
use tousle_bench::{CaptureFolder, Ending, PartRun, Report, index_html, when_and_where};
use tousle_pipeline::Watch;

/// What a part is told that lacks captures.
const NEEDS_CAPTURES: &str = "needs --captures DIR";

/// `tousle bench`, `tousle bench all`
pub fn run(args: &BenchAllArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    let parts = chosen(args)?;
    if let Some(captures) = &args.captures {
        CaptureFolder::named(captures, &args.names)?;
    }
    let folder = args.output.as_deref().unwrap_or(Path::new("tousle-bench"));
    make_folder(folder)?;
    let runs = try_each(&parts, |part| run_part(part, args, folder, watch));
    write_text(folder, "index.html", &index_html(&runs, &when_and_where()))?;
    sayln!("wrote {}", folder.join("index.html").display());
    let failed: Vec<&str> =
        runs.iter().filter(|run| matches!(run.ending, Ending::Failed(_))).map(|run| run.name).collect();
    ensure!(failed.is_empty(), "{} of {} parts failed: {}", failed.len(), runs.len(), failed.join(", "));
    Ok(Outcome::Fine)
}

/// The parts that are asked for, each once, in the order in which they are run.
fn chosen(args: &BenchAllArgs) -> anyhow::Result<Vec<BenchPart>> {
    if args.captures.is_none()
        && let Some(part) = args.parts.iter().find(|part| part.needs_captures())
    {
        wrong!("--part {}: found no --captures, expected a folder of captures", part.name());
    }
    let is_asked_for = |part: &BenchPart| args.parts.is_empty() || args.parts.contains(part);
    if !is_asked_for(&BenchPart::File) {
        only_with("--part file", "no other part takes fields", &[("--field", !args.fields.is_empty())])?;
    }
    if !is_asked_for(&BenchPart::Wind) {
        only_with("--part wind", "no other part has a quick way", &[("--quick", args.quick)])?;
    }
    if !args.parts.is_empty() && args.parts.iter().all(|part| *part == BenchPart::File) {
        let given = [("--captures", args.captures.is_some())];
        only_with("a part beside --part file", "that one looks at no captures", &given)?;
    }
    Ok(BenchPart::value_variants().iter().copied().filter(is_asked_for).collect())
}

/// Tries each part whatever became of those before, and tells on stderr how it goes.
fn try_each(parts: &[BenchPart], mut run: impl FnMut(BenchPart) -> anyhow::Result<Ending>) -> Vec<PartRun> {
    let mut runs = Vec::new();
    for (k, part) in (1..).zip(parts) {
        let name = part.name();
        note!("{name}: part {k} of {}", parts.len());
        let started = Instant::now();
        let ending = run(*part).unwrap_or_else(|error| Ending::Failed(error_lines(&error)));
        let wall_secs = started.elapsed().as_secs_f64();
        match &ending {
            Ending::Done(_) => note!("{name}: done in {wall_secs:.1} s"),
            Ending::Failed(why) => note!("{name}: failed: {why}"),
            Ending::Skipped(why) => note!("{name}: skipped, {why}"),
        }
        runs.push(PartRun { name, wall_secs, ending });
    }
    runs
}

/// Runs a part if it can be, and writes what it found: what comes after cannot spoil it.
fn run_part(
    part: BenchPart,
    args: &BenchAllArgs,
    folder: &Path,
    watch: &dyn Watch,
) -> anyhow::Result<Ending> {
    let Some(report) = report(part, args, watch)? else {
        return Ok(Ending::Skipped(NEEDS_CAPTURES.to_owned()));
    };
    say!("{}", report.to_text());
    write_report(folder, &report)?;
    Ok(Ending::Done(report))
}

/// What a part finds; `None` if it needs captures and there are none.
fn report(part: BenchPart, args: &BenchAllArgs, watch: &dyn Watch) -> anyhow::Result<Option<Report>> {
    let names = args.names.clone();
    match (part, args.captures.clone()) {
        (BenchPart::File, _) => part::file(&args.fields, watch).map(Some),
        (BenchPart::Sim, captures) => {
            if captures.is_none() {
                note!("sim: its part truth is skipped, {NEEDS_CAPTURES}");
            }
            let args = BenchSimArgs { captures, names, torso_grip: None, parts: Vec::new(), output: None };
            part::sim(&args, watch).map(Some)
        }
        (_, None) => Ok(None),
        (BenchPart::Paper, Some(captures)) => {
            part::paper(&BenchPaperArgs { captures, names, output: None }, watch).map(Some)
        }
        (BenchPart::Wind, Some(captures)) => {
            let quick = args.quick;
            let args = BenchWindArgs { captures, names, quick, leave_one_out: false, output: None };
            part::wind(&args, watch).map(Some)
        }
        (BenchPart::Direct, Some(captures)) => {
            part::direct(&captures, &part::direct_options_of(&names), watch).map(Some)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A part that fails is named with the reason, and those after it run.
    #[test]
    fn no_part_stops_the_others() {
        let mut tried = Vec::new();
        let parts = [BenchPart::Wind, BenchPart::Paper, BenchPart::File];
        let runs = try_each(&parts, |part| {
            tried.push(part);
            match part {
                BenchPart::Wind => Err(anyhow::anyhow!("no wind").context("cannot measure")),
                BenchPart::Paper => Ok(Ending::Skipped(NEEDS_CAPTURES.to_owned())),
                _ => Ok(Ending::Done(Report::default())),
            }
        });
        assert_eq!(tried, parts);
        assert_eq!(runs[0].ending, Ending::Failed("cannot measure\n  because no wind".to_owned()));
        assert_eq!(runs[1].ending, Ending::Skipped(NEEDS_CAPTURES.to_owned()));
        assert_eq!((runs[2].name, &runs[2].ending), ("file", &Ending::Done(Report::default())));
    }

    #[test]
    fn what_needs_captures_is_skipped_without() {
        let args = BenchAllArgs::default();
        assert_eq!(chosen(&args).unwrap(), BenchPart::value_variants());
        for part in chosen(&args).unwrap().into_iter().filter(|part| part.needs_captures()) {
            let ending = run_part(part, &args, Path::new("nowhere"), &tousle_pipeline::Silent).unwrap();
            assert_eq!(ending, Ending::Skipped(NEEDS_CAPTURES.to_owned()), "{}", part.name());
        }
        let asked = BenchAllArgs { parts: vec![BenchPart::Wind], ..args };
        assert!(crate::ui::is_wrong_argument(&chosen(&asked).unwrap_err()));
    }
}
