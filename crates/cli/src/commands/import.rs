mod wind;

use super::{check_output, name, only_with, print_json, write_eff, write_options};
use crate::args::ImportArgs;
use crate::ui::Outcome;
use anyhow::Context;
use serde::Serialize;
use std::path::{Path, PathBuf};
use tousle_core::{Assumption, Pose, PoseTrack, STANDARD_GRAVITY, Session, UpAxis};
use tousle_eff::Eff;
use tousle_field::Scene;
use tousle_pipeline::{GENERATOR, Input, Watch, attachments, read_file};

/// What an import took for granted.
#[derive(Serialize)]
struct ImportReport {
    method: &'static str,
    assumed: Vec<Assumption>,
}

/// `tousle import`
pub fn run(args: &ImportArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    let wind = args.wind.iter().map(PathBuf::as_path);
    let inputs: Vec<&Path> = wind.chain([args.session.as_path()]).chain(args.head.as_deref()).collect();
    check_output(&args.output, &["mcap"], &inputs)?;
    check_options(args)?;
    let pack = write_options(&args.pack)?;
    let session_bytes = read_file(&args.session)?;
    let session = tousle_ingest::read_session(&session_bytes)
        .with_context(|| format!("cannot read the session {}", args.session.display()))?;
    let stage = watch.stage("read");
    let read = wind::read(args, &*stage)?;
    drop(stage);
    let mut assumed = session.assumed.clone();
    assumed.extend(read.assumed);
    let scene = scene(args, &session, &mut assumed)?;
    let report = ImportReport { method: "import", assumed };
    let session_input = Input { name: &name(&args.session), bytes: &session_bytes };
    let eff = Eff {
        name: session.name.clone(),
        method: report.method.to_owned(),
        generator: GENERATOR.to_owned(),
        field: read.field,
        scene,
        samples: None,
        attachments: attachments(session_input, &report)?,
    };
    let written = write_eff(&eff, &args.output, &pack, watch)?;
    if args.json {
        print_json(&report)?;
    } else {
        for assumption in &report.assumed {
            sayln!("   assumed  {assumption}");
        }
        sayln!(
            "wrote {} ({} steps, {:.1} MB)",
            args.output.display(),
            written.n_steps,
            written.n_bytes as f64 / 1e6
        );
    }
    Ok(Outcome::Fine)
}

/// Refuses options of the kind of file that is not read.
fn check_options(args: &ImportArgs) -> anyhow::Result<()> {
    if wind::is_vdb(args) {
        let why = "in .vdb the grid is where its transform puts it";
        return only_with("a .npz file", why, &[("--extent-mm", args.extent_mm.is_some())]);
    }
    let given = [("--grid", args.grid.is_some()), ("--rate-hz", args.rate_hz.is_some())];
    only_with(".vdb files", "a .npz holds one wind and its times", &given)
}

/// The scene around imported wind: from the session, and the head's poses if they are given.
fn scene(args: &ImportArgs, session: &Session, assumed: &mut Vec<Assumption>) -> anyhow::Result<Scene> {
    let mut assume = |what: &str, value: &str, why: &str| {
        assumed.push(Assumption { what: what.to_owned(), value: value.to_owned(), why: why.to_owned() });
    };
    let (poses, up_axis) = match &args.head {
        Some(path) => {
            let poses = tousle_export::read_poses_npz(&read_file(path)?)
                .with_context(|| format!("cannot read the head's poses {}", path.display()))?;
            let up_axis = session
                .up_axis
                .context("the session does not say which axis of the world is up: add \"up_axis\"")?;
            (poses, up_axis)
        }
        None => {
            assume("head pose", "upright and still at the origin", "no --head was given");
            (PoseTrack::still(Pose::identity()), UpAxis::Z)
        }
    };
    Ok(Scene {
        rest_pose: poses.poses[0],
        poses,
        gravity_world: -up_axis.vector() * STANDARD_GRAVITY,
        air_density: session.air_density,
        body: session.body.clone(),
    })
}
