use super::{demo, only_with, read_eff, write_whole};
use crate::args::{BenchArgs, BenchCommand, BenchDirectArgs, BenchFileArgs, BenchSimArgs, BenchWindArgs};
use crate::ui::Outcome;
use anyhow::Context;
use std::io::Write;
use std::path::Path;
use tousle_bench::direct::{self, DirectBenchOptions};
use tousle_bench::measure::{self, Setting};
use tousle_bench::paper::{self, PaperBenchOptions};
use tousle_bench::sim::{self, Part, Sample, SimBenchOptions};
use tousle_fit::{FitMethod, PaperOptions};
use tousle_pipeline::Watch;

/// `tousle bench …`
pub fn run(command: &BenchCommand, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    match command {
        BenchCommand::Paper(args) => paper(args, watch),
        BenchCommand::Sim(args) => sim(args, watch),
        BenchCommand::Wind(args) => wind(args, watch),
        BenchCommand::Direct(args) => direct(args, watch),
        BenchCommand::File(args) => file(args, watch),
    }
}

fn sim(args: &BenchSimArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    let parts = if args.parts.is_empty() { Part::ALL.to_vec() } else { args.parts.clone() };
    if !parts.contains(&Part::Truth) {
        let given = [("--captures", args.captures.is_some())];
        only_with("--part truth", "no other part looks at captures", &given)?;
    }
    if args.captures.is_none() {
        let is_named = args.parts.contains(&Part::Truth);
        let given = [("--part truth", is_named), ("--torso-grip", args.torso_grip.is_some())];
        only_with("--captures", "the captures have the truth", &given)?;
    }
    make_folder(args.output.as_deref())?;
    let method = FitMethod::Paper(PaperOptions::default());
    let (converted, groom) = (demo::converted(method, watch)?, demo::groom()?);
    let eff = &converted.eff;
    let sample =
        Sample { name: "the demo's hair in its wind", field: &eff.field, scene: &eff.scene, groom: &groom };
    let stage = watch.stage("bench");
    let options = SimBenchOptions {
        parts,
        captures: args.captures.clone(),
        torso_grip: args.torso_grip.unwrap_or_default(),
    };
    let report = sim::run(sample, &options, &*stage)?;
    drop(stage);
    say!("{}", report.to_text());
    let Some(folder) = &args.output else { return Ok(Outcome::Fine) };
    for (name, text) in report.files() {
        write_text(folder, &name, &text)?;
    }
    write_text(folder, "sim.html", &report.to_html(&tousle_bench::when_and_where()))?;
    sayln!("wrote {}", folder.join("sim.html").display());
    Ok(Outcome::Fine)
}

fn wind(args: &BenchWindArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    make_folder(args.output.as_deref())?;
    let mut settings = if args.leave_one_out { Setting::choices() } else { Setting::methods() };
    if !args.quick && !args.leave_one_out {
        settings.extend(Setting::varied());
    }
    let stage = watch.stage("bench");
    let report = measure::run(&args.captures, &args.names, &settings, &*stage)?;
    drop(stage);
    let table = report.table();
    say!("{}", table.to_text());
    if args.leave_one_out {
        say!("{}", report.leave_one_out().to_text());
    }
    let Some(folder) = &args.output else { return Ok(Outcome::Fine) };
    if args.leave_one_out {
        write_text(folder, "wind-choices.csv", &table.to_csv())?;
        write_text(folder, "wind-leave-one-out.csv", &report.leave_one_out().to_csv())?;
        return Ok(Outcome::Fine);
    }
    write_text(folder, "wind.csv", &table.to_csv())?;
    write_text(folder, "wind-calibration.svg", &report.calibration_plot().standalone_svg())?;
    write_text(folder, "wind.html", &report.to_html(&tousle_bench::when_and_where()))?;
    sayln!("wrote {}", folder.join("wind.html").display());
    Ok(Outcome::Fine)
}

fn direct(args: &BenchDirectArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    make_folder(args.output.as_deref())?;
    let defaults = DirectBenchOptions::default();
    let names = if args.names.is_empty() { defaults.names } else { args.names.clone() };
    let options = DirectBenchOptions { names, n_drags: args.drags, n_several: args.several, seed: args.seed };
    let stage = watch.stage("bench");
    let report = direct::run(&args.captures, &options, &*stage)?;
    drop(stage);
    say!("{}", report.to_text());
    let Some(folder) = &args.output else { return Ok(Outcome::Fine) };
    for (name, table) in [
        ("direct", report.summary()),
        ("direct-drags", report.drags()),
        ("direct-several", report.several_summary()),
        ("direct-several-keys", report.several_keys()),
        ("direct-live", report.live_table()),
        ("direct-hand", report.hand_table()),
    ] {
        write_text(folder, &format!("{name}.csv"), &table.to_csv())?;
        sayln!("wrote {}", folder.join(format!("{name}.csv")).display());
    }
    Ok(Outcome::Fine)
}

fn file(args: &BenchFileArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    make_folder(args.output.as_deref())?;
    let stage = watch.stage("bench");
    let mut table = tousle_bench::file::table();
    for (k, path) in (0..).zip(&args.fields) {
        stage.at(k, args.fields.len() as u64);
        let eff = read_eff(path)?;
        tousle_bench::file::rows(&eff.name, &eff, &mut table)
            .with_context(|| format!("cannot measure {}", path.display()))?;
    }
    drop(stage);
    say!("{}", table.to_text());
    let Some(folder) = &args.output else { return Ok(Outcome::Fine) };
    write_text(folder, "file.csv", &table.to_csv())?;
    sayln!("wrote {}", folder.join("file.csv").display());
    Ok(Outcome::Fine)
}

fn paper(args: &BenchArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    make_folder(args.output.as_deref())?;
    let stage = watch.stage("bench");
    let report = paper::run(&args.captures, &PaperBenchOptions::default(), &*stage)?;
    drop(stage);
    say!("{}", report.to_text());
    let Some(folder) = &args.output else { return Ok(Outcome::Fine) };
    for (name, table) in ["motion", "field", "cost", "summary"].iter().zip(report.tables()) {
        write_text(folder, &format!("paper-{name}.csv"), &table.to_csv())?;
    }
    write_text(folder, "paper.json", &report.to_json())?;
    write_text(folder, "paper.html", &report.to_html())?;
    sayln!("wrote {}", folder.join("paper.html").display());
    Ok(Outcome::Fine)
}

/// Makes the folder for what is measured, if there is to be one: before the work, which takes minutes.
fn make_folder(folder: Option<&Path>) -> anyhow::Result<()> {
    let Some(folder) = folder else { return Ok(()) };
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {}", folder.display()))
}

fn write_text(folder: &Path, name: &str, text: &str) -> anyhow::Result<()> {
    write_whole(&folder.join(name), |out| out.write_all(text.as_bytes()))?;
    Ok(())
}
