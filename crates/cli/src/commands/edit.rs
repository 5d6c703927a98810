use super::{check_ending, print_json, read_groom, sound_eff};
use crate::args::EditArgs;
use crate::ui::Outcome;
use anyhow::Context;
use serde::Serialize;
use std::io::Cursor;
use tousle_core::{Groom, StrandMotion};
use tousle_edit::{EditEffects, EditOptions, EditReport, Edited};
use tousle_field::{FieldSequence, Scene};
use tousle_pipeline::{Watch, read_file, write_whole};
use tousle_sim::{Method, SimOptions};

/// What the edits became, and what they did.
#[derive(Serialize)]
struct Report {
    #[serde(flatten)]
    made: EditReport,
    effects: EditEffects,
}

/// `tousle edit`
pub fn run(args: &EditArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    check_ending(&args.output, &["mcap"])?;
    let bytes = read_file(&args.field)?;
    let eff = sound_eff(&bytes, &args.field)?;
    let groom = read_groom(&args.groom, &args.groom_args, &eff.scene, &eff.field.grid)?;
    let edits = tousle_edit::read_edits(&read_file(&args.edits)?)
        .with_context(|| format!("cannot read the edits {}", args.edits.display()))?;
    let n_before = eff.field.layers.len();
    let before = simulated(&eff.field, &eff.scene, &groom, watch)?;
    let Edited { sequence, report } =
        tousle_edit::apply(eff.field, &eff.scene, &groom, &before, &edits, &EditOptions::default())
            .with_context(|| format!("cannot apply the edits {}", args.edits.display()))?;
    let after = simulated(&sequence, &eff.scene, &groom, watch)?;
    let effects = tousle_edit::measure(&before, &after, &groom, &sequence.layers[n_before..])?;
    let stage = watch.stage("write");
    // The voxels are copied as they are packed: however often a field is edited, they stay what they were.
    write_whole(&args.output, |out| {
        tousle_eff::replace_layers(Cursor::new(&bytes), &sequence.layers, out, &*stage)
    })?;
    drop(stage);
    let report = Report { made: report, effects };
    if args.json {
        print_json(&report)?;
    } else {
        print!("{}", summary(&report));
        println!("wrote {}", args.output.display());
    }
    let unreachable = report.made.edits.iter().filter_map(|e| Some((e, e.unreachable.as_ref()?)));
    let n_unreachable = unreachable.clone().count();
    for (edit, why) in unreachable {
        eprintln!("loss: edit {:?}: the target is {why}", edit.name);
    }
    Ok(if n_unreachable == 0 { Outcome::Fine } else { Outcome::WithLoss })
}

fn simulated(
    field: &FieldSequence,
    scene: &Scene,
    groom: &Groom,
    watch: &dyn Watch,
) -> anyhow::Result<StrandMotion> {
    let stage = watch.stage("simulate");
    let options = SimOptions::of(Method::for_quantity(field.quantity));
    Ok(tousle_sim::simulate(field, scene, groom, &options, &*stage)?.motion)
}

fn summary(report: &Report) -> String {
    use std::fmt::Write;
    let mut text = String::new();
    for (edit, effect) in report.made.edits.iter().zip(&report.effects.edits) {
        let _ = writeln!(
            text,
            "edit {:?}: strand {}, control point {}, {:.3} to {:.3} s, asked to move {:.1} mm",
            edit.name, edit.strand, edit.control_point, edit.first_secs, edit.second_secs, edit.asked_mm
        );
        if let Some(residual) = effect.residual_mm {
            let _ = writeln!(
                text,
                "  distance from the target at the key: {:.1} mm before, {:.1} mm after",
                residual.before, residual.after
            );
        }
        if let (Some(acceleration), Some(jerk)) = (effect.peak_acceleration, effect.peak_jerk) {
            let _ = writeln!(
                text,
                "  peak acceleration {:.1} to {:.1} m/s², peak jerk {:.0} to {:.0} m/s³",
                acceleration.before, acceleration.after, jerk.before, jerk.after
            );
        }
    }
    if let Some(far) = &report.effects.most_moved_far {
        let _ = writeln!(text, "  10 cm outside the reach: {} moved most, {:.2} mm", far.strand, far.mm);
    }
    text
}
