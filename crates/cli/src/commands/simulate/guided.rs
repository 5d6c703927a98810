//! Simulates all strands, or some that the others follow.

use super::resume::Resumable;
use crate::args::SimulateArgs;
use crate::commands::counted;
use serde::Serialize;
use std::fmt;
use std::io::{Seek, Write};
use tousle_core::{Groom, Pose, StrandMotion};
use tousle_eff::Eff;
use tousle_export::{ExportError, MotionNpz};
use tousle_field::FieldLayer;
use tousle_guide::{FollowError, Guides};
use tousle_pipeline::Watch;
use tousle_rod::Surface;
use tousle_sim::{Frame, Integrator, Keeper, SimError, SimOptions, SimReport, Simulation, Simulator, Steps};

/// How the motion of all strands came about.
#[derive(Debug, Serialize)]
pub struct Simulated {
    /// How many frames it has.
    #[serde(skip)]
    pub n_frames: usize,
    /// What the simulator says; of the guides, if there are any, but for the stretch, which is that of all strands.
    #[serde(flatten)]
    pub report: SimReport,
    /// Who followed whom.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub guides: Option<GuideReport>,
}

/// Who followed whom, and how well.
#[derive(Debug, Serialize)]
pub struct GuideReport {
    /// Strands that were simulated.
    pub n_guides: usize,
    /// Strands that followed them.
    pub n_following: usize,
    /// Positions of theirs, in all frames, that were moved because they lay in the body or behind one that did.
    pub n_kept_out: u64,
    /// How far those are from where the simulator takes them; `None` if it was not looked at.
    pub error: Option<FollowError>,
}

/// An integrator's limit is worth a warning from so many times the usual steps on. A step of an explicit integrator costs no
/// less than one of the default, so the run then takes as many times as long, and seconds become minutes. What asks for
/// fewer is the price that a comparison of integrators is ready to pay.
const MANY: f64 = 10.0;

/// Warns of a run that takes many times the usual steps because its integrator does not stand longer ones. Who names a step
/// knows what it costs.
fn warn_of_many_steps(
    simulator: &Simulator<'_>,
    layers: &[FieldLayer],
    options: &SimOptions,
) -> Result<(), SimError> {
    let integrator = options.integrator();
    if !integrator.is_limited() || options.dt_secs.is_some() {
        return Ok(());
    }
    let Steps { per_second, in_all, unlimited_per_second, limit } = simulator.steps(layers)?;
    if per_second > MANY * unlimited_per_second {
        let (name, better) = (integrator.name(), Integrator::of(options.method)[0].name());
        note!(
            "warning: {name} takes {per_second:.0} steps a second, {in_all} in all, as it stands none longer than {limit}; \
             --integrator {better} stands every step and takes {unlimited_per_second:.0} a second"
        );
    }
    Ok(())
}

/// A simulator of a groom, or of a part of it.
fn simulator<'a>(
    Eff { field, scene, .. }: &'a Eff,
    (groom, part): (&'a Groom, Option<&'a Groom>),
    options: &'a SimOptions,
) -> Result<Simulator<'a>, SimError> {
    let simulator = match part {
        Some(part) => Simulator::of_part(field, scene, part, groom, options),
        None => Simulator::new(field, scene, groom, options),
    }?;
    warn_of_many_steps(&simulator, &field.layers, options)?;
    Ok(simulator)
}

/// Simulates all strands of a groom, frame by frame into a `.npz`: the same bytes as of the motion that [`simulate`] gives, which
/// nobody holds as a whole. The inner error is the simulation's.
pub fn simulate_into(
    eff: &Eff,
    (groom, numbers): (&Groom, &[usize]),
    options: &SimOptions,
    out: impl Write + Seek,
    watch: &dyn Watch,
) -> Result<Result<Simulated, SimError>, ExportError> {
    let simulator = match simulator(eff, (groom, None), options) {
        Ok(simulator) => simulator,
        Err(error) => return Ok(Err(error)),
    };
    let times_secs = simulator.times_secs();
    let mut npz = MotionNpz::begin(&groom.counts(), times_secs, Some(numbers), out)?;
    let mut failed = None;
    let mut sink = |frame: Frame<'_>| {
        npz.put(frame.positions_m).map_err(|error| {
            failed = Some(error);
            "the file takes no more".into()
        })
    };
    let run = simulator.simulate_once_into(&eff.field.layers, &mut sink, &*watch.stage("simulate"));
    match (run, failed) {
        (_, Some(error)) => Err(error),
        (Err(error), None) => Ok(Err(error)),
        (Ok(report), None) => {
            npz.finish()?;
            Ok(Ok(Simulated { n_frames: times_secs.len(), report, guides: None }))
        }
    }
}

/// Simulates a groom as the arguments want it: whole, or guides that the rest follows.
pub fn simulate(
    eff: &Eff,
    groom: &Groom,
    options: &SimOptions,
    args: &SimulateArgs,
    resumable: Option<&Resumable>,
    watch: &dyn Watch,
) -> anyhow::Result<(Simulated, StrandMotion)> {
    let run = |stage: &'static str, part: Option<&Groom>| {
        let stage_keeper = resumable.map(|run| run.stage(stage));
        let keeper = stage_keeper.as_ref().map(|stage| stage as &dyn Keeper);
        let simulator = simulator(eff, (groom, part), options)?;
        simulator.simulate_once(&eff.field.layers, keeper, &*watch.stage(stage))
    };
    let n_guides = args.guides.map(|n| n as usize).filter(|n| *n < groom.strands.len());
    let Some(n_guides) = n_guides else {
        if let Some(asked) = args.guides {
            let n_strands = groom.strands.len();
            note!(
                "warning: --guides {asked}: found {n_strands} strands, so all are simulated and none follows"
            );
        }
        let Simulation { motion, report } = run("simulate", None)?;
        return Ok((Simulated { n_frames: motion.times_secs.len(), report, guides: None }, motion));
    };
    let guides = tousle_guide::choose(groom, n_guides)?;
    let Simulation { motion, mut report } = run("simulate", Some(&guides.groom(groom)))?;
    let mut motion = tousle_guide::follow(groom, &guides, &motion, &*watch.stage("follow"))?;
    let at_rest = Surface::of_body(&eff.scene.body, &Pose::identity());
    let at_times = tousle_sim::surfaces_at(&eff.field, &eff.scene, options, &motion.times_secs)?;
    let n_kept_out = tousle_guide::keep_out(groom, &guides, &mut motion, &at_rest, &at_times);
    report.max_stretch = tousle_sim::max_stretch(&motion);
    let sample = guides.sample(args.guides_check as usize);
    let mut error = None;
    if !sample.is_empty() {
        let checked = run("check", Some(&Guides::groom_of(groom, &sample)))?;
        error = Some(tousle_guide::compare(&motion, &checked.motion, &sample)?);
    }
    let n_guides = guides.strands().len();
    let report_of_guides =
        GuideReport { n_guides, n_following: groom.strands.len() - n_guides, n_kept_out, error };
    let n_frames = motion.times_secs.len();
    Ok((Simulated { n_frames, report, guides: Some(report_of_guides) }, motion))
}

impl fmt::Display for GuideReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} simulated, ", counted(self.n_guides, "guide"))?;
        let follow = if self.n_following == 1 { "follows" } else { "follow" };
        write!(f, "{} {follow}; ", counted(self.n_following, "strand"))?;
        match &self.error {
            None => write!(f, "how well was not looked at (--guides-check 0)"),
            Some(error) => write!(
                f,
                "{} of these simulated too: {:.1} mm off in the mean, 95 % within {:.1} mm, explained motion {:.3}",
                error.n_strands, error.mean_mm, error.p95_mm, error.explained
            ),
        }
    }
}
