use super::{check_ending, ending, print_json, read_eff, read_groom};
use crate::args::{MethodArg, ShapeArg, SimulateArgs};
use crate::ui::Outcome;
use anyhow::Context;
use std::path::Path;
use tousle_core::{Groom, StrandMotion};
use tousle_export::{HairGeometry, UsdOptions};
use tousle_field::Scene;
use tousle_pipeline::{Watch, read_file, write_whole};
use tousle_sim::{Method, SimOptions, SimReport, Simulation};

/// `tousle simulate`
pub fn run(args: &SimulateArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    for output in &args.output {
        check_ending(output, &["npz", "usda"])?;
    }
    let eff = read_eff(&args.field)?;
    let groom = read_groom(&args.groom, &args.groom_args, &eff.scene)?;
    let options = options(args)?;
    let stage = watch.stage("simulate");
    let Simulation { motion, report } =
        tousle_sim::simulate(&eff.field, &eff.scene, &groom, &options, &*stage)?;
    drop(stage);
    let scene = Scene { poses: options.head.unwrap_or_else(|| eff.scene.poses.clone()), ..eff.scene.clone() };
    for output in &args.output {
        write_motion(output, &motion, &groom, &scene, args.shape)?;
    }
    if args.json {
        print_json(&report)?;
    } else {
        print!("{}", summary(&motion, &report, args.explain));
        for output in &args.output {
            println!("wrote {}", output.display());
        }
    }
    Ok(Outcome::Fine)
}

fn options(args: &SimulateArgs) -> anyhow::Result<SimOptions> {
    let head = match &args.head {
        None => None,
        Some(path) => Some(
            tousle_export::read_poses_npz(&read_file(path)?)
                .with_context(|| format!("cannot read the head's poses {}", path.display()))?,
        ),
    };
    let method = match args.method {
        MethodArg::Paper => Method::Paper,
    };
    Ok(SimOptions {
        method,
        rate_hz: args.rate_hz,
        integrator: args.integrator,
        dt_secs: args.dt_secs,
        time: args.time,
        duration_secs: args.duration_secs,
        head,
        ..SimOptions::default()
    })
}

/// Writes a motion in the format that the path's ending names.
pub fn write_motion(
    path: &Path,
    motion: &StrandMotion,
    groom: &Groom,
    scene: &Scene,
    shape: ShapeArg,
) -> anyhow::Result<()> {
    if ending(path) == "npz" {
        write_whole(path, |out| tousle_export::write_motion_npz(motion, out))?;
        return Ok(());
    }
    let mut options = UsdOptions::default();
    options.geometry = match shape {
        ShapeArg::Curves => HairGeometry::Curves,
        ShapeArg::Reeds => HairGeometry::Reeds,
        ShapeArg::Both => HairGeometry::Both,
    };
    options.scene = Some(scene);
    write_whole(path, |out| tousle_export::write_motion_usda(motion, groom, &options, out))?;
    Ok(())
}

/// What was done, for a person.
fn summary(motion: &StrandMotion, report: &SimReport, explain: bool) -> String {
    use std::fmt::Write;
    let mut text = String::new();
    let (n_strands, n_points, n_frames) = (motion.counts.len(), motion.n_points(), motion.times_secs.len());
    let _ = writeln!(
        text,
        "{n_strands} strands, {n_points} control points, {n_frames} frames; {} (order {}) in {} steps of {:.3} ms",
        report.integrator.name(),
        report.order,
        report.n_steps,
        report.dt_secs * 1e3
    );
    if explain {
        let _ = writeln!(text, "limit: {}", report.limit);
        for entry in &report.plan {
            let _ =
                writeln!(text, "  {} {:<16} {}", if entry.active { "+" } else { "-" }, entry.term, entry.why);
        }
    }
    for assumption in &report.assumed {
        let _ = writeln!(text, "assumed {} = {} ({})", assumption.what, assumption.value, assumption.why);
    }
    text
}
