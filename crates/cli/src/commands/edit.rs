use super::{check_output, counted, only_with, print_json, read_groom, sound_eff};
use crate::args::EditArgs;
use crate::ui::Outcome;
use anyhow::Context;
use serde::Serialize;
use std::fmt::Write;
use std::io::Cursor;
use tousle_core::Quantity;
use tousle_direct::{DirectOptions, DirectReport, EditMethod, Made, Stage, apply};
use tousle_edit::{EditEffects, EditList, Moved, StackChange, Under};
use tousle_field::{FieldLayer, FieldSequence, LayerOrigin};
use tousle_pipeline::{Watch, read_file, write_whole};
use tousle_sim::{Method, SimOptions, Simulator};

/// What the edits became, and what they did.
#[derive(Serialize)]
struct Report {
    /// Changes of edits that were on the field.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    changes: Vec<StackChange>,
    #[serde(flatten)]
    made: DirectReport,
    effects: EditEffects,
}

/// `tousle edit`
pub fn run(args: &EditArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    // Into the field itself as well: it takes its name in one step, and edits are layers that can be removed.
    check_output(&args.output, &["mcap"], &[&args.groom, &args.edits])?;
    let bytes = read_file(&args.field)?;
    let eff = sound_eff(&bytes, &args.field)?;
    let groom = read_groom(&args.groom, &args.groom_args, &eff.scene, &eff.field.grid)?;
    let edits = tousle_edit::read_edits(&read_file(&args.edits)?)
        .with_context(|| format!("cannot read the edits {}", args.edits.display()))?;
    let (field, scene, groom) = (&eff.field, &eff.scene, &groom);
    let options = SimOptions::of(Method::for_quantity(field.quantity));
    let direct = direct_options(args, field.quantity)?;
    let simulator = Simulator::new(field, scene, groom, &options)?;
    let stage = watch.stage("simulate");
    let before = simulator.trace(&field.layers, &*stage)?;
    drop(stage);
    let stage = watch.stage("solve");
    let world = Stage { simulator: &simulator, field, scene, groom };
    let directed = apply(&world, &field.layers, before.motion(), &edits, &direct)
        .with_context(|| format!("cannot apply the edits {}", args.edits.display()))?;
    drop(stage);
    let after = simulator.retrace(&before, &directed.stack, &tousle_core::NoProgress)?;
    let before = Under { motion: before.motion(), layers: &field.layers };
    let after = Under { motion: after.motion(), layers: &directed.stack };
    let effects = tousle_edit::measure(before, after, groom)?;
    warn_of_nothing(args, field, &edits, &directed.stack);
    let stage = watch.stage("write");
    // The voxels are copied as they are packed: however often a field is edited, they stay what they were.
    write_whole(&args.output, |out| {
        tousle_eff::replace_layers(Cursor::new(&bytes), &directed.stack, out, &*stage)
    })?;
    drop(stage);
    let report = Report { changes: edits.changes, made: directed.report, effects };
    if args.json {
        print_json(&report)?;
    } else {
        say!("{}", summary(&report, &directed.stack, field.quantity));
        sayln!("wrote {}", args.output.display());
    }
    Ok(losses(&report, direct.tolerance_m * 1e3))
}

/// Says where edits change nothing: a list without any, and layers of the list whose time is not the field's.
fn warn_of_nothing(args: &EditArgs, field: &FieldSequence, edits: &EditList, stack: &[FieldLayer]) {
    let file = args.edits.display();
    if edits.changes.is_empty() && edits.winds.is_empty() && edits.edits.is_empty() {
        note!(
            "warning: {file}: found no edits, expected [[edit]], [[wind]] or [[change]]: the field is written as it was"
        );
    }
    // A single step stands for all times.
    if field.steps.len() < 2 {
        return;
    }
    let (start, end) = (field.start_secs, field.end_secs());
    for layer in stack.iter().filter(|layer| !field.layers.contains(layer)) {
        if layer.first_secs >= end || layer.last_secs <= start {
            note!(
                "warning: {file}: layer {:?} ({:?}): found {:.3} to {:.3} s, expected some of the field's time, {start:.3} to \
                 {end:.3} s: in it nothing changes",
                layer.id,
                layer.name,
                layer.first_secs,
                layer.last_secs
            );
        }
    }
}

fn direct_options(args: &EditArgs, quantity: Quantity) -> anyhow::Result<DirectOptions> {
    let mut options = DirectOptions::for_quantity(quantity);
    options.method = args.method.unwrap_or(options.method);
    if options.method == EditMethod::Paper {
        let why = "by E4 a drag is one push, whether or not it meets its key";
        only_with("--method physical", why, &[("--tolerance-mm", args.tolerance_mm.is_some())])?;
    }
    options.tolerance_m = args.tolerance_mm.map_or(options.tolerance_m, |mm| mm * 1e-3);
    Ok(options)
}

/// Says what was not reached: by an edit alone, or because others move what it drags too.
fn losses(report: &Report, tolerance_mm: f64) -> Outcome {
    let mut outcome = Outcome::Fine;
    for made in &report.made.edits {
        let unreachable = made.unreachable();
        for why in &unreachable {
            note!("loss: edit {:?}: the target is {why}", made.name());
            outcome = Outcome::WithLoss;
        }
        // One push by the paper's E4 is not asked to meet its target, and what is out of reach has been said.
        let Made::Physical(solved) = made else { continue };
        if solved.muted || !unreachable.is_empty() {
            continue;
        }
        let effects = report.effects.edits.iter().filter(|effect| effect.edit_id == made.edit_id());
        for key in effects.flat_map(|effect| &effect.keys) {
            // What is written is single precision.
            if key.residual_mm.after > 1.01 * tolerance_mm {
                note!(
                    "loss: edit {:?}: strand {}, control point {}, at {:.3} s: found it {:.2} mm from its target, expected at \
                     most {tolerance_mm} mm: other edits move it too",
                    made.name(),
                    key.key.strand,
                    key.key.control_point,
                    key.key.secs,
                    key.residual_mm.after
                );
                outcome = Outcome::WithLoss;
            }
        }
    }
    outcome
}

fn summary(report: &Report, stack: &[FieldLayer], quantity: Quantity) -> String {
    let mut text = String::new();
    for change in &report.changes {
        let _ = writeln!(text, "{change}");
    }
    for effect in &report.effects.edits {
        let made = report.made.edits.iter().find(|made| made.edit_id() == effect.edit_id);
        let layer = stack.iter().find(|layer| layer.edit_id() == effect.edit_id);
        let how = match (made, layer.map(|layer| &layer.origin)) {
            (Some(made), _) => how(made, quantity),
            (None, Some(LayerOrigin::Wind { .. })) => "a change of the wind".to_owned(),
            (None, Some(LayerOrigin::Mirrored { of, .. })) => format!("`{of}` on the other side"),
            (None, _) => "changed".to_owned(),
        };
        let _ = writeln!(text, "edit {:?}, {how}", effect.name);
        for key in &effect.keys {
            let _ = writeln!(
                text,
                "  strand {}, control point {}, at {:.3} s: {:.1} mm from the target before, {:.2} mm after",
                key.key.strand,
                key.key.control_point,
                key.key.secs,
                key.residual_mm.before,
                key.residual_mm.after
            );
        }
        for aimed in made.into_iter().flat_map(aimed_elsewhere) {
            let _ = writeln!(text, "  aimed at the nearest place the lock can be at, {aimed}");
        }
        for strand in &effect.strands {
            let (acceleration, jerk, energy) =
                (strand.peak_acceleration, strand.peak_jerk, strand.peak_energy);
            let _ = writeln!(
                text,
                "  strand {}: peak acceleration {:.1} to {:.1} m/s², jerk {:.0} to {:.0} m/s³, energy {:.3} to {:.3} mJ",
                strand.strand,
                acceleration.before,
                acceleration.after,
                jerk.before,
                jerk.after,
                energy.before * 1e3,
                energy.after * 1e3
            );
        }
    }
    text.push_str(&elsewhere(&report.effects));
    text
}

/// When motion begins to differ, and what moved that should not have.
fn elsewhere(effects: &EditEffects) -> String {
    let Some(secs) = effects.first_change_secs else { return "  nothing moved\n".to_owned() };
    let mut text = format!("  the same to the bit before {secs:.3} s\n");
    for (where_, moved) in [
        ("outside the reach", &effects.most_moved_outside),
        ("10 cm outside the reach", &effects.most_moved_far),
    ] {
        let Some(Moved { strand, mm, .. }) = moved else { continue };
        let _ = match *mm {
            0.0 => writeln!(text, "  {where_}: nothing moved"),
            // What moved is not 0.00 mm.
            mm if mm < 0.01 => writeln!(text, "  {where_}: {strand} moved most, less than 0.01 mm"),
            mm => writeln!(text, "  {where_}: {strand} moved most, {mm:.2} mm"),
        };
    }
    text
}

/// The places that were aimed at instead of targets out of reach, in words.
fn aimed_elsewhere(made: &Made) -> Vec<String> {
    let Made::Physical(outcome) = made else { return Vec::new() };
    let elsewhere = outcome.keys.iter().filter(|key| key.aimed_m != key.key.target_m);
    elsewhere
        .map(|key| format!("[{:.4}, {:.4}, {:.4}] m", key.aimed_m.x, key.aimed_m.y, key.aimed_m.z))
        .collect()
}

fn how(made: &Made, quantity: Quantity) -> String {
    match made {
        Made::Physical(outcome) => format!(
            "solved: {} with {}, the strongest adds {:.1} {}; {} simulated for it; peaks of \
             acceleration {:.2} times the unedited, of jerk {:.2}; the keys demand at least {:.2} and {:.2}{}",
            counted(outcome.n_layers, "layer"),
            counted(outcome.n_handles, "handle"),
            outcome.strongest,
            quantity.unit(),
            counted(outcome.n_runs, "strand"),
            outcome.acceleration_ratio,
            outcome.jerk_ratio,
            outcome.least_acceleration_ratio,
            outcome.least_jerk_ratio,
            if outcome.peaks_demanded { ", more than strands may do unasked" } else { "" }
        ),
        Made::Paper(outcome) => {
            format!(
                "by E4: asked to move {:.1} mm, {}",
                outcome.asked_mm,
                counted(outcome.n_handles, "handle")
            )
        }
        _ => "made".to_owned(),
    }
}
