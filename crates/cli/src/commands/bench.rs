use crate::args::BenchCommand;
use crate::ui::Outcome;
use tousle_pipeline::Watch;

/// `tousle bench …`
pub fn run(command: &BenchCommand, _watch: &dyn Watch) -> anyhow::Result<Outcome> {
    match command {
        BenchCommand::Paper(_args) => anyhow::bail!("not yet"),
    }
}
