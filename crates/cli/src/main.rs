//! The commands. `tousle help` lists them; DESIGN of their contract: exit codes 0 fine, 1 failed or invalid,
//! 2 wrong arguments, 3 finished with loss; results on stdout, diagnostics on stderr.

#![warn(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "they panic where nobody listens; `say!` and `note!` do not"
)]

#[macro_use]
mod ui;
mod args;
mod commands;
mod disk;

use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = args::Cli::read();
    disk::survive_full_disks();
    match run(&cli).and_then(ui::all_said) {
        Ok(outcome) => outcome.into(),
        Err(error) => {
            ui::print_error(&error);
            ExitCode::from(if ui::is_wrong_argument(&error) { 2 } else { 1 })
        }
    }
}

fn run(cli: &args::Cli) -> anyhow::Result<ui::Outcome> {
    if let Some(threads) = cli.threads {
        rayon::ThreadPoolBuilder::new().num_threads(usize::from(threads)).build_global()?;
    }
    let bars = ui::Bars { quiet: cli.quiet };
    match &cli.command {
        args::Command::Convert(args) => commands::convert::run(args, &bars),
        args::Command::Validate(args) => commands::validate::run(args, &bars),
        args::Command::Inspect(args) => commands::inspect::run(args, &bars),
        args::Command::Simulate(args) => commands::simulate::run(args, &bars),
        args::Command::Edit(args) => commands::edit::run(args, &bars),
        args::Command::Studio(args) => commands::studio::run(args),
        args::Command::Export(args) => commands::export::run(args, &bars),
        args::Command::Import(args) => commands::import::run(args, &bars),
        args::Command::Merge(args) => commands::merge::run(args, &bars),
        args::Command::Recover(args) => commands::recover::run(args, &bars),
        args::Command::Migrate(args) => commands::migrate::run(args, &bars),
        args::Command::Demo(args) => commands::demo::run(args, &bars),
        args::Command::Bench(args) => commands::bench::run(args, &bars),
    }
}
