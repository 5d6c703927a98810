use super::{check_output, not_copied, print_json, read_file, say_losses};
use crate::args::MigrateArgs;
use crate::ui::Outcome;
use std::io::Cursor;
use tousle_pipeline::{Watch, write_whole};

/// `tousle migrate`
pub fn run(args: &MigrateArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    check_output(&args.output, &["mcap"], &[&args.field])?;
    let bytes = read_file(&args.field)?;
    let stage = watch.stage("migrate");
    let migration = write_whole(&args.output, |out| {
        tousle_eff::migrate(Cursor::new(&bytes), out, &*stage).map_err(|error| not_copied(error, &args.field))
    })?;
    drop(stage);
    if args.json {
        print_json(&migration)?;
    } else {
        sayln!("from version {} to {}", migration.from, migration.to);
        sayln!("wrote {}", args.output.display());
    }
    say_losses(&migration.losses);
    Ok(if migration.is_complete() { Outcome::Fine } else { Outcome::WithLoss })
}
