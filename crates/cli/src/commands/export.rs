use super::{check_output, ending, read_eff};
use crate::args::ExportArgs;
use crate::ui::Outcome;
use std::path::PathBuf;
use tousle_core::Progress;
use tousle_field::FieldSequence;
use tousle_pipeline::{Outputs, Watch, write_whole};

/// `tousle export`
pub fn run(args: &ExportArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    check_output(&args.output, &["npz", "vdb"], &[&args.field])?;
    let eff = read_eff(&args.field)?;
    let stage = watch.stage("export");
    if ending(&args.output) == "npz" {
        write_whole(&args.output, |out| tousle_export::write_field_npz(&eff.field, out))?;
        drop(stage);
        sayln!("wrote {}", args.output.display());
    } else {
        let files = write_vdbs(&eff.field, args, &*stage)?;
        drop(stage);
        sayln!("wrote {} files, {} to {}", files.len(), files[0].display(), files[files.len() - 1].display());
    }
    Ok(Outcome::Fine)
}

/// One file a time step, `OUT.0000.vdb` and on: as tools expect a sequence.
fn write_vdbs(
    field: &FieldSequence,
    args: &ExportArgs,
    progress: &dyn Progress,
) -> anyhow::Result<Vec<PathBuf>> {
    let flat = field.flattened();
    let n_steps = flat.steps.len();
    // Together or not at all: part of a sequence is a shorter one to whoever reads it.
    let mut outputs = Outputs::default();
    let mut files = Vec::with_capacity(n_steps);
    for step in 0..n_steps {
        let path = args.output.with_extension(format!("{step:04}.vdb"));
        outputs.add(&path, |out| tousle_export::write_step_vdb(&flat, step, out))?;
        files.push(path);
        progress.at(step as u64 + 1, n_steps as u64);
    }
    outputs.appear()?;
    let next = args.output.with_extension(format!("{n_steps:04}.vdb"));
    if next.exists() {
        note!(
            "warning: {}: is there from a longer sequence; who reads the sequence takes it, and any after it, for steps of this one",
            next.display()
        );
    }
    Ok(files)
}
