use super::simulate::usd_options;
use crate::args::{DemoArgs, ShapeArg};
use crate::ui::Outcome;
use anyhow::{Context, ensure};
use std::io::Write;
use std::path::Path;
use std::time::Instant;
use tousle_core::{Groom, StrandMotion};
use tousle_direct::{DirectOptions, EditMethod, Stage};
use tousle_edit::{Change, EditEffects, Under};
use tousle_eff::{Eff, WriteOptions};
use tousle_field::FieldSequence;
use tousle_fit::{FitMethod, FitOptions};
use tousle_groom::{GroomOptions, ReadGroom};
use tousle_page::{Compared, DemoPage, Figure, FileEntry, HairView, StageLine};
use tousle_pipeline::{ConvertOptions, Converted, Input, Watch, write_whole};
use tousle_sim::{Method, SimOptions, Simulation, Simulator};

const CAPTURE: &[u8] = include_bytes!("../../../../fixtures/demo/gusts.c3d");
const SESSION: &[u8] = include_bytes!("../../../../fixtures/demo/session.json");
const GROOM: &[u8] = include_bytes!("../../../../fixtures/demo/bob.json");
const EDITS: &[u8] = include_bytes!("../../../../fixtures/demo/lift.toml");

/// `tousle demo`
pub fn run(args: &DemoArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    let folder = Folder::create(&args.output)?;
    let mut log = Log::default();
    folder.write("gusts.c3d", CAPTURE)?;
    folder.write("session.json", SESSION)?;
    folder.write("bob.json", GROOM)?;
    folder.write("lift.toml", EDITS)?;

    let converted = convert(&folder, &mut log, watch)?;
    let read = read_groom()?;
    let simulated = simulate(&converted.eff, &read, &folder, &mut log, watch)?;
    let edited = edit(&converted.eff, &read.groom, &simulated.motion, &folder, &mut log, watch)?;
    export(&converted.eff, &folder, &mut log)?;
    page(&folder, &log, &converted, &read.groom, &simulated, &edited)?;

    say!("{}", log.text());
    sayln!("\nopen {}", folder.path.join("index.html").display());
    Ok(Outcome::Fine)
}

/// The embedded capture, converted by a method.
pub(super) fn converted(method: FitMethod, watch: &dyn Watch) -> anyhow::Result<Converted> {
    let capture = Input { name: "gusts.c3d", bytes: CAPTURE };
    let session = Input { name: "session.json", bytes: SESSION };
    let fit = FitOptions { method, ..FitOptions::default() };
    Ok(tousle_pipeline::convert(
        capture,
        session,
        &ConvertOptions { fit, ..ConvertOptions::default() },
        watch,
    )?)
}

/// The embedded hairstyle.
pub(super) fn groom() -> anyhow::Result<Groom> {
    Ok(read_groom()?.groom)
}

fn read_groom() -> anyhow::Result<ReadGroom> {
    Ok(tousle_groom::read_groom(GROOM, &GroomOptions::default())?)
}

/// The folder that everything goes into.
struct Folder<'a> {
    path: &'a Path,
}

impl<'a> Folder<'a> {
    /// Makes the folder, or takes one that is there.
    fn create(path: &'a Path) -> anyhow::Result<Self> {
        std::fs::create_dir_all(path)
            .with_context(|| format!("cannot make the folder {}", path.display()))?;
        Ok(Self { path })
    }

    fn write(&self, name: &str, bytes: &[u8]) -> anyhow::Result<()> {
        write_whole(&self.path.join(name), |out| out.write_all(bytes))?;
        Ok(())
    }
}

/// What was done so far, for the page and for the terminal.
#[derive(Default)]
struct Log {
    stages: Vec<StageLine>,
}

impl Log {
    /// Runs a stage and keeps how long it took and what it says of itself.
    fn stage<T>(
        &mut self,
        name: &str,
        command: &str,
        run: impl FnOnce() -> anyhow::Result<(T, String)>,
    ) -> anyhow::Result<T> {
        let start = Instant::now();
        let (value, text) = run().with_context(|| format!("the demo failed in its stage {name}"))?;
        let secs = Some(start.elapsed().as_secs_f64());
        self.stages.push(StageLine { name: name.to_owned(), text, command: command.to_owned(), secs });
        Ok(value)
    }

    fn text(&self) -> String {
        let line =
            |s: &StageLine| format!("{:>9} {:>6.2} s  {}\n", s.name, s.secs.unwrap_or_default(), s.text);
        self.stages.iter().map(line).collect()
    }
}

fn convert(folder: &Folder<'_>, log: &mut Log, watch: &dyn Watch) -> anyhow::Result<Converted> {
    let command = "tousle convert gusts.c3d --session session.json -o gusts.eff.mcap";
    let converted = log.stage("convert", command, || {
        let converted = converted(FitOptions::default().method, watch)?;
        let report = &converted.report;
        let text = format!(
            "{} frames of {} trajectories became {} time steps of wind from {} samples",
            report.quality.capture.n_frames,
            report.quality.capture.n_trajectories,
            report.fit.n_steps,
            report.fit.n_samples
        );
        Ok((converted, text))
    })?;
    let path = folder.path.join("gusts.eff.mcap");
    log.stage("write", "", || {
        let written = write_whole(&path, |out| {
            tousle_eff::write(&converted.eff, out, &WriteOptions::default(), &tousle_core::NoProgress)
        })?;
        Ok(((), format!("{:.1} MB, {} steps", written.n_bytes as f64 / 1e6, written.n_steps)))
    })?;
    log.stage("validate", "tousle validate gusts.eff.mcap", || {
        let validation = tousle_eff::validate(&std::fs::read(&path)?[..])?;
        ensure!(
            validation.is_sound,
            "the field that was just written is not sound: {:?}",
            validation.findings.first()
        );
        Ok(((), format!("sound, {} findings", validation.findings.len())))
    })?;
    Ok(converted)
}

fn simulate(
    eff: &Eff,
    ReadGroom { groom, numbers, .. }: &ReadGroom,
    folder: &Folder<'_>,
    log: &mut Log,
    watch: &dyn Watch,
) -> anyhow::Result<Simulation> {
    let command = "tousle simulate gusts.eff.mcap --groom bob.json -o bob.npz -o bob.usda --shape both";
    let simulated = log.stage("simulate", command, || {
        let stage = watch.stage("simulate");
        let options = SimOptions::of(Method::for_quantity(eff.field.quantity));
        let simulated = tousle_sim::simulate(&eff.field, &eff.scene, groom, &options, &*stage)?;
        let text = format!(
            "{} strands of another hairstyle, {} frames, integrator {}",
            groom.strands.len(),
            simulated.motion.times_secs.len(),
            simulated.report.integrator.name()
        );
        Ok((simulated, text))
    })?;
    let motion = &simulated.motion;
    write_whole(&folder.path.join("bob.npz"), |out| {
        tousle_export::write_numbered_motion_npz(motion, numbers, out)
    })?;
    write_whole(&folder.path.join("bob.usda"), |out| {
        let usd = usd_options(&eff.scene, ShapeArg::Both);
        tousle_export::write_motion_usda(motion, groom, &usd, out)
    })?;
    Ok(simulated)
}

/// The motion with the edit.
struct Edited {
    method: EditMethod,
    motion: StrandMotion,
    effects: EditEffects,
}

fn edit(
    eff: &Eff,
    groom: &Groom,
    before: &StrandMotion,
    folder: &Folder<'_>,
    log: &mut Log,
    watch: &dyn Watch,
) -> anyhow::Result<Edited> {
    let command = "tousle edit gusts.eff.mcap --groom bob.json --edits lift.toml -o lifted.eff.mcap";
    log.stage("edit", command, || {
        let edits = tousle_edit::read_edits(EDITS)?;
        let options = SimOptions::of(Method::for_quantity(eff.field.quantity));
        let simulator = Simulator::new(&eff.field, &eff.scene, groom, &options)?;
        let world = Stage { simulator: &simulator, field: &eff.field, scene: &eff.scene, groom };
        let direct = DirectOptions::for_quantity(eff.field.quantity);
        let layers = tousle_direct::apply(&world, &[], before, &edits, &direct)?.stack;
        let stage = watch.stage("simulate");
        let motion = simulator.simulate(&layers, &*stage)?.motion;
        drop(stage);
        let before = Under { motion: before, layers: &[] };
        let effects = tousle_edit::measure(before, Under { motion: &motion, layers: &layers }, groom)?;
        let mut eff = eff.clone();
        eff.field.layers = layers;
        write_whole(&folder.path.join("lifted.eff.mcap"), |out| {
            tousle_eff::write(&eff, out, &WriteOptions::default(), &tousle_core::NoProgress)
        })?;
        let residual = key_residual_mm(&effects);
        let text = residual.map_or_else(String::new, |r| {
            format!("a strand pulled towards a key: {:.0} mm off before, {:.0} mm after", r.before, r.after)
        });
        Ok((Edited { method: direct.method, motion, effects }, text))
    })
}

fn export(eff: &Eff, folder: &Folder<'_>, log: &mut Log) -> anyhow::Result<()> {
    log.stage("export", "tousle export gusts.eff.mcap -o gusts.npz", || {
        write_whole(&folder.path.join("gusts.npz"), |out| tousle_export::write_field_npz(&eff.field, out))?;
        let (step, name) = vdb_step(&eff.field);
        write_whole(&folder.path.join(&name), |out| tousle_export::write_step_vdb(&eff.field, step, out))?;
        Ok(((), format!("gusts.npz for NumPy, {name} (one step) for OpenVDB")))
    })
}

/// The one step that is written for OpenVDB, while the wind blows, and its file.
fn vdb_step(field: &FieldSequence) -> (usize, String) {
    let step = field.steps.len() * 2 / 3;
    (step, format!("gusts.{step:04}.vdb"))
}

fn page(
    folder: &Folder<'_>,
    log: &Log,
    converted: &Converted,
    groom: &Groom,
    simulated: &Simulation,
    edited: &Edited,
) -> anyhow::Result<()> {
    let intro = [
        "27 locks with markers were blown about by a fan. Their motion told how the air moved around the head; \
         that wind now blows a hairstyle that was never captured."
            .to_owned(),
        "The road is that of Kazama, Sugisaki and Morishima (2008); wind and hair are by our method, physical."
            .to_owned(),
    ];
    let compared = Compared { name: "with the edit", motion: &edited.motion };
    let hair = [HairView {
        name: "bob",
        about: "60 strands that the cameras never saw, in the wind that was measured on the wig.",
        groom,
        motion: &simulated.motion,
        compared: Some(compared),
    }];
    let notes = [
        "The capture is computed, not filmed: fixtures/demo/README.md says how.".to_owned(),
        format!("The edit is by the method {}: {}.", edited.method.name(), edited.method.about()),
    ];
    let page = DemoPage {
        title: "Hair in the wind, measured once, worn by any hairstyle",
        intro: &intro,
        source: "gusts.c3d: 4 s of a wig on a mannequin in a gusting wind, embedded in the program",
        capture: &converted.prepared.located.head,
        session: &converted.prepared.session,
        field: &converted.eff.field,
        method: &converted.eff.method,
        scene: &converted.eff.scene,
        hair: &hair,
        figures: &figures(converted, simulated, &edited.effects),
        stages: &log.stages,
        folder: &folder.path.display().to_string(),
        files: &files(folder, &converted.eff.field)?,
        notes: &notes,
    };
    folder.write("index.html", tousle_page::demo_page(&page)?.as_bytes())
}

fn figures(converted: &Converted, simulated: &Simulation, effects: &EditEffects) -> Vec<Figure> {
    let figure = |label: &str, value: String, unit: &str, note: String| Figure {
        label: label.to_owned(),
        value,
        unit: unit.to_owned(),
        note,
    };
    let report = &converted.report;
    let all =
        (report.raster.n_measured + report.raster.n_interpolated + report.raster.n_outside).max(1) as f64;
    let mut figures = vec![
        figure(
            "lock samples seen",
            format!("{:.1}", 100.0 * report.quality.capture.seen),
            "%",
            format!(
                "of {} markers in {} frames",
                report.quality.capture.n_trajectories, report.quality.capture.n_frames
            ),
        ),
        figure(
            "head found to",
            format!("{:.2}", report.quality.head.fit_residual_m.unwrap_or_default() * 1e3),
            "mm",
            "rms distance of its markers from their places".to_owned(),
        ),
        figure(
            "voxels measured",
            format!("{:.1}", 100.0 * report.raster.n_measured as f64 / all),
            "%",
            format!(
                "{:.1} % interpolated, the rest outside",
                100.0 * report.raster.n_interpolated as f64 / all
            ),
        ),
        figure(
            "strands blown",
            simulated.motion.counts.len().to_string(),
            "",
            format!("{} strand steps of {:.2} ms", simulated.report.n_steps, simulated.report.dt_secs * 1e3),
        ),
    ];
    if let Some(residual) = key_residual_mm(effects) {
        let note = format!("{:.0} mm off before the edit", residual.before);
        figures.push(figure("edited strand off its key", format!("{:.0}", residual.after), "mm", note));
    }
    figures
}

/// How far the dragged point is from its key, mm.
fn key_residual_mm(effects: &EditEffects) -> Option<Change> {
    Some(effects.edits.first()?.keys.first()?.residual_mm)
}

/// Every file that the demo wrote beside the page, with its size.
fn files(folder: &Folder<'_>, field: &FieldSequence) -> anyhow::Result<Vec<FileEntry>> {
    let (_, vdb) = vdb_step(field);
    let known = [
        ("gusts.c3d", "the capture"),
        ("session.json", "what the people in the room knew"),
        ("gusts.eff.mcap", "the wind field"),
        ("gusts.npz", "the same for NumPy"),
        (vdb.as_str(), "one step of it for OpenVDB"),
        ("bob.json", "the other hairstyle"),
        ("bob.npz", "its motion for NumPy"),
        ("bob.usda", "its motion for USD: curves and reeds"),
        ("lift.toml", "an edit: a strand pulled to a key"),
        ("lifted.eff.mcap", "the field with that edit as a layer"),
    ];
    let entry = |(name, what): (&str, &str)| {
        let bytes = std::fs::metadata(folder.path.join(name))?.len();
        Ok(FileEntry { name: name.to_owned(), what: what.to_owned(), bytes })
    };
    known.into_iter().map(entry).collect()
}
