use super::{read_eff, write_whole};
use crate::args::{BenchArgs, BenchCommand, BenchFileArgs};
use crate::ui::Outcome;
use anyhow::Context;
use std::io::Write;
use tousle_bench::paper::{self, PaperBenchOptions};
use tousle_pipeline::Watch;

/// `tousle bench …`
pub fn run(command: &BenchCommand, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    match command {
        BenchCommand::Paper(args) => paper(args, watch),
        BenchCommand::File(args) => file(args, watch),
    }
}

fn file(args: &BenchFileArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    let stage = watch.stage("bench");
    let mut table = tousle_bench::file::table();
    for (k, path) in (0..).zip(&args.fields) {
        stage.at(k, args.fields.len() as u64);
        let eff = read_eff(path)?;
        tousle_bench::file::rows(&eff.name, &eff, &mut table)
            .with_context(|| format!("cannot measure {}", path.display()))?;
    }
    drop(stage);
    print!("{}", table.to_text());
    let Some(folder) = &args.output else { return Ok(Outcome::Fine) };
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    write_whole(&folder.join("file.csv"), |out| out.write_all(table.to_csv().as_bytes()))?;
    println!("wrote {}", folder.join("file.csv").display());
    Ok(Outcome::Fine)
}

fn paper(args: &BenchArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    let stage = watch.stage("bench");
    let report = paper::run(&args.captures, &PaperBenchOptions::default(), &*stage)?;
    drop(stage);
    print!("{}", report.to_text());
    let Some(folder) = &args.output else { return Ok(Outcome::Fine) };
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    let write =
        |name: &str, text: String| write_whole(&folder.join(name), |out| out.write_all(text.as_bytes()));
    for (name, table) in ["motion", "field", "cost", "summary"].iter().zip(report.tables()) {
        write(&format!("paper-{name}.csv"), table.to_csv())?;
    }
    write("paper.json", report.to_json())?;
    write("paper.html", report.to_html())?;
    println!("wrote {}", folder.join("paper.html").display());
    Ok(Outcome::Fine)
}
