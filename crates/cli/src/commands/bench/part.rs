//! Each part of the bench: what was asked for becomes what was found.

use crate::args::{BenchDirectArgs, BenchPaperArgs, BenchSimArgs, BenchWindArgs};
use crate::commands::{demo, only_with, read_eff};
use anyhow::Context;
use std::path::{Path, PathBuf};
use tousle_bench::direct::{self, DirectBenchOptions};
use tousle_bench::measure::{self, Setting};
use tousle_bench::paper::{self, PaperBenchOptions};
use tousle_bench::sim::{self, Part, Sample, SimBenchOptions};
use tousle_bench::{Report, file};
use tousle_eff::Eff;
use tousle_fit::{FitMethod, PaperOptions};
use tousle_pipeline::Watch;

pub(super) fn paper(args: &BenchPaperArgs, watch: &dyn Watch) -> anyhow::Result<Report> {
    let stage = watch.stage("bench");
    let options = PaperBenchOptions { captures: args.names.clone(), ..PaperBenchOptions::default() };
    Ok(paper::run(&args.captures, &options, &*stage)?.report())
}

/// Refuses options that nothing would be done with.
pub(super) fn check_sim(args: &BenchSimArgs) -> anyhow::Result<()> {
    let is_named = args.parts.contains(&Part::Truth);
    if !args.parts.is_empty() && !is_named {
        let given = [("--captures", args.captures.is_some())];
        only_with("--part truth", "no other part looks at captures", &given)?;
    }
    if args.captures.is_none() {
        let given = [("--part truth", is_named), ("--torso-grip", args.torso_grip.is_some())];
        only_with("--captures", "the captures have the truth", &given)?;
    }
    Ok(())
}

pub(super) fn sim(args: &BenchSimArgs, watch: &dyn Watch) -> anyhow::Result<Report> {
    let parts = if args.parts.is_empty() { Part::ALL.to_vec() } else { args.parts.clone() };
    let (eff, groom) = (demo_field(watch)?, demo::groom()?);
    let sample =
        Sample { name: "the demo's hair in its wind", field: &eff.field, scene: &eff.scene, groom: &groom };
    let stage = watch.stage("bench");
    let options = SimBenchOptions {
        parts,
        captures: args.captures.clone(),
        names: args.names.clone(),
        torso_grip: args.torso_grip.unwrap_or_default(),
    };
    Ok(sim::run(sample, &options, &*stage)?)
}

pub(super) fn wind(args: &BenchWindArgs, watch: &dyn Watch) -> anyhow::Result<Report> {
    let mut settings = if args.leave_one_out { Setting::choices() } else { Setting::methods() };
    if !args.quick && !args.leave_one_out {
        settings.extend(Setting::varied());
    }
    let stage = watch.stage("bench");
    let report = measure::run(&args.captures, &args.names, &settings, &*stage)?;
    Ok(if args.leave_one_out { report.leave_one_out_report() } else { report.report() })
}

pub(super) fn direct(
    captures: &Path,
    options: &DirectBenchOptions,
    watch: &dyn Watch,
) -> anyhow::Result<Report> {
    let stage = watch.stage("bench");
    Ok(direct::run(captures, options, &*stage)?.report())
}

/// What is drawn, as the command line has it.
pub(super) fn direct_options(args: &BenchDirectArgs) -> DirectBenchOptions {
    let options = direct_options_of(&args.names);
    DirectBenchOptions { n_drags: args.drags, n_several: args.several, seed: args.seed, ..options }
}

/// The usual drags on these captures; on the usual ones if none is named.
pub(super) fn direct_options_of(names: &[String]) -> DirectBenchOptions {
    let usual = DirectBenchOptions::default();
    if names.is_empty() { usual } else { DirectBenchOptions { names: names.to_vec(), ..usual } }
}

/// Of fields in files; of the one that everybody has, the demo's, if none is given.
pub(super) fn file(fields: &[PathBuf], watch: &dyn Watch) -> anyhow::Result<Report> {
    let demo = if fields.is_empty() { Some(demo_field(watch)?) } else { None };
    let stage = watch.stage("bench");
    let mut table = file::table();
    if let Some(eff) = demo {
        file::rows(&eff.name, &eff, &mut table).context("cannot measure the demo's field")?;
    }
    for (k, path) in (0..).zip(fields) {
        stage.at(k, fields.len() as u64);
        let eff = read_eff(path)?;
        file::rows(&eff.name, &eff, &mut table)
            .with_context(|| format!("cannot measure {}", path.display()))?;
    }
    Ok(file::report(table))
}

fn demo_field(watch: &dyn Watch) -> anyhow::Result<Eff> {
    let method = FitMethod::Paper(PaperOptions::default());
    Ok(demo::converted(method, watch)?.eff)
}
