mod body;
mod guided;
mod head;
mod resume;

use super::{
    check_outputs, counted, ending, only_with, open_field, print_json, read_groom_and_numbers, unusable,
};
use crate::args::{ShapeArg, SimulateArgs};
use crate::ui::{Outcome, WrongArgument};
use guided::Simulated;
use resume::Resumable;
use std::path::Path;
use tousle_core::{Groom, Quantity};
use tousle_eff::{Eff, Part, ReadOptions, Reader};
use tousle_export::{HairGeometry, UsdOptions};
use tousle_field::Scene;
use tousle_groom::ReadGroom;
use tousle_pipeline::{Outputs, Watch};
use tousle_sim::{Integrator, Method, PlanEntry, Precision, SimError, SimOptions, TimeMode};

/// `tousle simulate`
pub fn run(args: &SimulateArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    simulate(args, watch).map_err(|error| by_its_flag(error, args))
}

/// Names an option that cannot be as it was given: by its flag, in its unit.
fn by_its_flag(error: anyhow::Error, args: &SimulateArgs) -> anyhow::Error {
    let Some(SimError::BadOption { option, found, expected }) =
        error.chain().find_map(|cause| cause.downcast_ref())
    else {
        return error;
    };
    let (flag, found) = match *option {
        "rate_hz" => ("--rate-hz", *found),
        "dt_secs" => ("--dt-secs", *found),
        "duration_secs" => ("--duration-secs", *found),
        "tolerance_m" => ("--tolerance-mm", args.tolerance_mm.unwrap_or(found * 1e3)),
        _ => return error,
    };
    let found = if found.abs() < 1e-3 && found != 0.0 { format!("{found:e}") } else { format!("{found}") };
    WrongArgument(format!("{flag}: found {found}, expected {expected}")).into()
}

fn simulate(args: &SimulateArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    check_args(args)?;
    let Asked { mut eff, mut options, plan } = read_field(args)?;
    let ReadGroom { groom, numbers, .. } =
        read_groom_and_numbers(&args.groom, &args.groom_args, &eff.scene, &eff.field.grid)?;
    let mut assumed = body::put_meshes(&mut eff.scene.body, &args.body_args, &groom, watch)?;
    if let Some(head) = head::read_head(args, &eff)? {
        options.head = Some(head.poses);
        assumed.extend(head.assumed);
    }
    let resumable = Resumable::open(args, &options)?;
    let mut outputs = Outputs::default();
    let mut simulated = if let Some(output) = only_npz(args) {
        outputs.add(output, |out| guided::simulate_into(&eff, (&groom, &numbers), &options, out, watch))??
    } else {
        let (simulated, motion) = guided::simulate(&eff, &groom, &options, args, resumable.as_ref(), watch)?;
        let poses = options.head.clone().unwrap_or_else(|| eff.scene.poses.clone());
        let scene = Scene { poses, ..eff.scene.clone() };
        let mut usd = usd_options(&scene, args.shape.unwrap_or(ShapeArg::Curves));
        usd.with_body = args.with_body;
        usd.rate_hz = Some(args.rate_hz);
        for output in &args.output {
            outputs.add(output, |out| match ending(output).as_str() {
                "npz" => tousle_export::write_numbered_motion_npz(&motion, &numbers, out),
                _ => tousle_export::write_motion_usda(&motion, &groom, &usd, out),
            })?;
        }
        simulated
    };
    simulated.report.assumed.extend(assumed);
    simulated.report.plan.insert(0, plan);
    outputs.appear()?;
    if let Some(resumable) = resumable {
        resumable.remove()?;
    }
    if args.json {
        print_json(&simulated)?;
    } else {
        say!("{}", summary(&simulated, &groom, args.explain));
        for output in &args.output {
            sayln!("wrote {}", output.display());
        }
    }
    Ok(Outcome::Fine)
}

/// The only output, if its frames can go there one by one as they are made: a `.usda` says first how far the hair ever gets, strands
/// that follow wait for all frames of their guides, and parts that are kept have all of theirs.
fn only_npz(args: &SimulateArgs) -> Option<&Path> {
    match args.output.as_slice() {
        [output] if ending(output) == "npz" && args.guides.is_none() && args.resume.is_none() => Some(output),
        _ => None,
    }
}

/// Refuses outputs that cannot be, and options that do nothing.
fn check_args(args: &SimulateArgs) -> anyhow::Result<()> {
    let head = args.head.as_ref().map(|name| head::split(name).0);
    let mut inputs = vec![args.field.as_path(), &args.groom];
    inputs.extend(head.as_deref());
    check_outputs(&args.output, &["npz", "usda"], &inputs)?;
    if !args.output.iter().any(|output| ending(output) == "usda") {
        let given = [("--shape", args.shape.is_some()), ("--with-body", args.with_body)];
        only_with("a .usda output", "a .npz holds the control points alone", &given)?;
    }
    if args.integrator != Some(Integrator::Adaptive) {
        let why = "no other integrator asks how far a step is off";
        only_with("--integrator adaptive", why, &[("--tolerance-mm", args.tolerance_mm.is_some())])?;
    }
    if !head.is_some_and(|path| head::is_usd(&path)) {
        let given = [("--head-axes", args.head_axes.is_some()), ("--head-start", args.head_start.is_some())];
        only_with("a --head in .usda", "poses in .npz have the field's clock and head axes", &given)?;
    }
    Ok(())
}

/// What a run asks a field file for.
struct Asked {
    /// The steps that it needs, with their scene and their edits.
    eff: Eff,
    options: SimOptions,
    /// What was read and what was left in the file.
    plan: PlanEntry,
}

fn read_field(args: &SimulateArgs) -> anyhow::Result<Asked> {
    let path = &args.field;
    let mut reader = Reader::open(open_field(path)?).map_err(|e| unusable(e, path))?;
    let info = &reader.manifest().field;
    let options = options(args, info.quantity.into())?;
    let mut part = Part::default().without_deviations();
    part.span_secs = options.span_secs(info.start_secs);
    let of = reader.n_steps();
    warn_of_time(args, info.start_secs, info.start_secs + of.saturating_sub(1) as f64 / info.rate_hz);
    let eff = reader.part(&part, &ReadOptions::default()).map_err(|e| unusable(e, path))?;
    let why = format!(
        "{} of {of} steps are read; standard deviations, samples, previews and attachments stay in the file",
        eff.field.steps.len()
    );
    Ok(Asked { eff, options, plan: PlanEntry { term: "field".to_owned(), active: true, why } })
}

/// Warns of a `--time` other than the default where the motion has nothing of the time that it is about.
fn warn_of_time(args: &SimulateArgs, start_secs: f64, end_secs: f64) {
    let last_secs = args.duration_secs.map_or(end_secs, |secs| start_secs + secs);
    if args.time != TimeMode::Once && last_secs <= end_secs {
        note!(
            "warning: --time {}: found a motion that ends at {last_secs:.3} s, expected one past the field's last step at \
             {end_secs:.3} s (--duration-secs): what comes after that is all that it changes",
            args.time.name()
        );
    }
}

fn options(args: &SimulateArgs, quantity: Quantity) -> anyhow::Result<SimOptions> {
    let method = args.method.unwrap_or(Method::for_quantity(quantity));
    let defaults = SimOptions::default();
    let options = SimOptions {
        method,
        rate_hz: args.rate_hz,
        integrator: args.integrator,
        tolerance_m: args.tolerance_mm.map_or(defaults.tolerance_m, |mm| mm * 1e-3),
        precision: if args.single { Precision::Single } else { Precision::Double },
        dt_secs: args.dt_secs,
        time: args.time,
        torso_grip: args.torso_grip,
        duration_secs: args.duration_secs,
        ..defaults
    };
    if !options.has_single() {
        let why = "the others of method physical compute in double precision";
        only_with("--integrator implicit or implicit-euler", why, &[("--single", args.single)])?;
    }
    Ok(options)
}

/// Hair of this shape in its scene.
pub fn usd_options(scene: &Scene, shape: ShapeArg) -> UsdOptions<'_> {
    let mut options = UsdOptions::default();
    options.geometry = match shape {
        ShapeArg::Curves => HairGeometry::Curves,
        ShapeArg::Reeds => HairGeometry::Reeds,
        ShapeArg::Both => HairGeometry::Both,
    };
    options.scene = Some(scene);
    options
}

/// What was done, for a person.
fn summary(simulated: &Simulated, groom: &Groom, explain: bool) -> String {
    use std::fmt::Write;
    let Simulated { n_frames, report, guides } = simulated;
    let mut text = String::new();
    let (n_strands, n_points) = (groom.strands.len(), groom.n_points());
    let _ = writeln!(
        text,
        "{}, {n_points} control points, {}; {} (order {}) in {} strand steps of {}{:.3} ms; \
         stretch at most {:.4} %",
        counted(n_strands, "strand"),
        counted(*n_frames, "frame"),
        report.integrator.name(),
        report.order,
        report.n_steps,
        if report.integrator == Integrator::Adaptive { "at most " } else { "" },
        report.dt_secs * 1e3,
        report.max_stretch * 1e2
    );
    if let Some(guides) = guides {
        let _ = writeln!(text, "{guides}");
    }
    if explain {
        let _ = writeln!(text, "limit: {}", report.limit);
        for entry in &report.plan {
            let _ =
                writeln!(text, "  {} {:<16} {}", if entry.active { "+" } else { "-" }, entry.term, entry.why);
        }
    }
    for assumption in &report.assumed {
        let _ = writeln!(text, "assumed {assumption}");
    }
    text
}
