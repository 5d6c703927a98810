use super::{check_output, not_copied, print_json, read_file, say_losses};
use crate::args::RecoverArgs;
use crate::ui::Outcome;
use std::io::Cursor;
use tousle_pipeline::{Watch, write_whole};

/// `tousle recover`
pub fn run(args: &RecoverArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    check_output(&args.output, &["mcap"], &[&args.field])?;
    let bytes = read_file(&args.field)?;
    let stage = watch.stage("recover");
    let recovery = write_whole(&args.output, |out| {
        tousle_eff::recover(Cursor::new(&bytes), out, &*stage).map_err(|error| not_copied(error, &args.field))
    })?;
    drop(stage);
    if args.json {
        print_json(&recovery)?;
    } else {
        let expected = recovery.n_steps_expected.map_or_else(String::new, |n| format!(" of {n}"));
        sayln!("saved {}{expected} steps, {} of them bridged", recovery.n_steps, recovery.bridged.len());
        sayln!("wrote {}", args.output.display());
    }
    say_losses(&recovery.losses);
    Ok(if recovery.is_complete() { Outcome::Fine } else { Outcome::WithLoss })
}
