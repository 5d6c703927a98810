use super::{check_ending, print_json, read_eff, read_groom, write_eff};
use crate::args::EditArgs;
use crate::ui::Outcome;
use anyhow::Context;
use serde::Serialize;
use tousle_core::{Groom, StrandMotion};
use tousle_edit::{EditEffects, EditOptions, EditReport, Edited};
use tousle_eff::WriteOptions;
use tousle_field::{FieldSequence, Scene};
use tousle_pipeline::{Watch, read_file};
use tousle_sim::SimOptions;

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
    let mut eff = read_eff(&args.field)?;
    let groom = read_groom(&args.groom, &args.groom_args, &eff.scene)?;
    let edits = tousle_edit::read_edits(&read_file(&args.edits)?)
        .with_context(|| format!("cannot read the edits {}", args.edits.display()))?;
    let n_before = eff.field.layers.len();
    let before = simulated(&eff.field, &eff.scene, &groom, watch)?;
    let Edited { sequence, report } =
        tousle_edit::apply(eff.field, &eff.scene, &groom, &before, &edits, &EditOptions::default())
            .with_context(|| format!("cannot apply the edits {}", args.edits.display()))?;
    let after = simulated(&sequence, &eff.scene, &groom, watch)?;
    let effects = tousle_edit::measure(&before, &after, &groom, &sequence.layers[n_before..])?;
    eff.field = sequence;
    write_eff(&eff, &args.output, &WriteOptions::default(), watch)?;
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
    Ok(tousle_sim::simulate(field, scene, groom, &SimOptions::default(), &*stage)?.motion)
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
