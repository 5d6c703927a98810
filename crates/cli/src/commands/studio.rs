use crate::args::StudioArgs;
use crate::ui::Outcome;
use anyhow::{Context, bail};
use std::env::{current_exe, split_paths, var_os};
use std::path::PathBuf;
use std::process::Command;

/// The editor's own program: a window needs hundreds of crates that no other command does.
const PROGRAM: &str = "tousle-studio";

/// What can be said of the editor without it; its own `--help` has the options.
const HELP: &str =
    "Pull hair to where the shot needs it, in a window\n\nUsage: tousle studio FIELD --groom GROOM";

/// That the program is not there, and how to get it.
fn missing() -> String {
    format!(
        "found no program {PROGRAM} beside this one nor in PATH; `cargo build --release -p {PROGRAM}` in a checkout makes it \
         (some minutes the first time, Rust 1.95), and `cargo install --path crates/studio` puts it beside an installed tousle"
    )
}

/// `tousle studio`
pub fn run(args: &StudioArgs) -> anyhow::Result<Outcome> {
    let Some(program) = find() else {
        if args.args.iter().any(|arg| arg == "--help" || arg == "-h") {
            sayln!("{HELP}\n\nThe program that does it is not here: {}.", missing());
            return Ok(Outcome::Fine);
        }
        bail!(missing());
    };
    let ended = Command::new(&program)
        .args(&args.args)
        .status()
        .with_context(|| format!("cannot run {}", program.display()))?;
    // A program that a signal ended has no code.
    Ok(ended.code().and_then(|code| u8::try_from(code).ok()).map_or(Outcome::Ended(1), Outcome::Ended))
}

/// Beside this program, or where the shell looks for programs.
fn find() -> Option<PathBuf> {
    let name = format!("{PROGRAM}{}", std::env::consts::EXE_SUFFIX);
    let beside = current_exe().ok().map(|exe| exe.with_file_name(&name));
    let in_path =
        var_os("PATH").map(|path| split_paths(&path).map(|folder| folder.join(&name)).collect::<Vec<_>>());
    beside.into_iter().chain(in_path.into_iter().flatten()).find(|program| program.is_file())
}
