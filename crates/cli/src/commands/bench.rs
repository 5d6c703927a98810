mod all;
mod part;

use crate::args::{BenchAllArgs, BenchArgs, BenchCommand};
use crate::ui::Outcome;
use anyhow::Context;
use std::io::Write;
use std::path::{Path, PathBuf};
use tousle_bench::Report;
use tousle_pipeline::{Watch, write_whole};

/// `tousle bench …`
pub fn run(args: &BenchArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    // The parser takes them for those of all parts, and would forget them.
    if args.part.is_some() && args.all != BenchAllArgs::default() {
        wrong!("found options before the part of the bench, expected them after its name");
    }
    match &args.part {
        None => all::run(&args.all, watch),
        Some(BenchCommand::All(args)) => all::run(args, watch),
        Some(BenchCommand::Paper(args)) => one(args.output.as_ref(), || part::paper(args, watch)),
        Some(BenchCommand::Sim(args)) => {
            part::check_sim(args)?;
            one(args.output.as_ref(), || part::sim(args, watch))
        }
        Some(BenchCommand::Wind(args)) => one(args.output.as_ref(), || part::wind(args, watch)),
        Some(BenchCommand::Direct(args)) => {
            one(args.output.as_ref(), || part::direct(&args.captures, &part::direct_options(args), watch))
        }
        Some(BenchCommand::File(args)) => one(args.output.as_ref(), || part::file(&args.fields, watch)),
    }
}

/// One part by itself, its files in a folder if there is to be one.
fn one(folder: Option<&PathBuf>, part: impl FnOnce() -> anyhow::Result<Report>) -> anyhow::Result<Outcome> {
    // A folder that cannot be made is told of before the work.
    folder.map(|folder| make_folder(folder)).transpose()?;
    let report = part()?;
    say!("{}", report.to_text());
    if let Some(folder) = folder {
        write_report(folder, &report)?;
    }
    Ok(Outcome::Fine)
}

fn write_report(folder: &Path, report: &Report) -> anyhow::Result<()> {
    for (name, text) in report.files(&tousle_bench::when_and_where()) {
        write_text(folder, &name, &text)?;
    }
    sayln!("wrote {}", folder.join(report.page_name()).display());
    Ok(())
}

/// Makes the folder for what is measured, before the work, which takes minutes.
fn make_folder(folder: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {}", folder.display()))
}

fn write_text(folder: &Path, name: &str, text: &str) -> anyhow::Result<()> {
    write_whole(&folder.join(name), |out| out.write_all(text.as_bytes()))?;
    Ok(())
}
