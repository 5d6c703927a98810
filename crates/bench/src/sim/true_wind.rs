use super::peers::{PeerPoint, Peers};
use super::setting::Setting;
use super::{Part, SimBenchOptions};
use crate::capture::failed;
use crate::clock::TRIES;
use crate::{
    Baseline, BenchError, CaptureFolder, Cell, Curve, CurvePoint, Judged, Section, Table, TrueWind, Way,
    WorkPrecision, baselines_beside, sim_in_field,
};
use tousle_core::Progress;
use tousle_field::{FieldSequence, Scene};
use tousle_sim::{Method, SimOptions, TorsoGrip};

/// Steps a second; the frames are no finer than the second of them.
const RATES_HZ: [f64; 5] = [30.0, 60.0, 120.0, 240.0, 480.0];

/// One run.
struct Run {
    capture: String,
    way: Way,
    setting: Setting,
    cost: f64,
    judged: Judged,
}

/// Style B of every capture in its true wind, by every way, against where it really went.
pub(super) fn section(options: &SimBenchOptions, progress: &dyn Progress) -> Result<Section, BenchError> {
    let title = "Against independent truth: style B in the true wind".to_owned();
    let Some(captures) = &options.captures else {
        return Ok(Section {
            name: Part::Truth.stem(),
            title,
            words: "Skipped: no folder of captures was given (--captures).".to_owned(),
            ..Section::default()
        });
    };
    let folders = CaptureFolder::named(captures, &options.names)?;
    let baselines = baselines_beside(captures);
    let peers = Peers::read();
    let mut runs = Vec::new();
    for (k, folder) in (0..).zip(&folders) {
        progress.at(k, folders.len() as u64);
        runs.extend(of_capture(folder, options.torso_grip)?);
    }
    let names = folders.iter().map(CaptureFolder::name);
    Ok(Section {
        name: Part::Truth.stem(),
        title,
        words: format!(
            "Style B is a hairstyle of 60 locks that nobody captured; truth is what an independent engine computed for \
             it. Unexplained motion: rms error over rms displacement from rest; 1 is as good as never moving. The cost \
             is that of the whole simulation on one core, preparation included. Other programs are quoted: {}; {}; {}. \
             Ceiling: the engine that made the truth, in the same stored wind. Hair on the torso rubs on the {}.",
            peers.source,
            peers.machine,
            peers.remark,
            options.torso_grip.name()
        ),
        tables: vec![(String::new(), table(&runs, &peers))],
        plots: names
            .map(|name| (name.to_owned(), diagram(name, &runs, &peers, &baselines).to_plot()))
            .collect(),
    })
}

fn of_capture(folder: &CaptureFolder, torso_grip: TorsoGrip) -> Result<Vec<Run>, BenchError> {
    let wind: TrueWind = folder.truth.wind().map_err(folder.truth_failed())?;
    let (field, scene) = (wind.to_sequence(), folder.true_scene()?);
    let groom = folder.style_b()?;
    let mut runs = Vec::new();
    for way in Way::all() {
        let limit_secs =
            way.limit_secs(&field, &scene, &groom).map_err(failed(folder.name(), "simulating style B"))?;
        // More than its limit tells an explicit integrator nothing but a longer wait.
        let rates = if limit_secs.is_some() { 1 } else { RATES_HZ.len() };
        for setting in Setting::of(way, &RATES_HZ, limit_secs).into_iter().take(rates) {
            let options = SimOptions { torso_grip, ..way.options() };
            let judged = judge(folder, &field, &scene, setting, options)?;
            let cost = judged.cost.secs() / judged.simulated_secs;
            runs.push(Run { capture: folder.name().to_owned(), way, setting, cost, judged });
        }
    }
    Ok(runs)
}

/// The cheapest of a few runs, which all move alike.
fn judge(
    folder: &CaptureFolder,
    field: &FieldSequence,
    scene: &Scene,
    setting: Setting,
    options: SimOptions,
) -> Result<Judged, BenchError> {
    let rate_hz = if setting == Setting::Rate(RATES_HZ[0]) { RATES_HZ[0] } else { RATES_HZ[1] };
    let options = setting.apply(SimOptions { rate_hz, ..options });
    let mut judged = sim_in_field(folder, field, scene, &options)?;
    for _ in 1..TRIES {
        let again = sim_in_field(folder, field, scene, &options)?;
        if again.cost.secs() < judged.cost.secs() {
            judged = again;
        }
    }
    Ok(judged)
}

fn table(runs: &[Run], peers: &Peers) -> Table {
    let columns = [
        "capture",
        "integrator",
        "setting",
        "CPU s per simulated s",
        "explained motion",
        "median lock",
        "explained fluctuation",
        "mean mm",
        "95 % mm",
    ];
    let mut table = Table::new("Style B in the true wind", &columns);
    for run in runs {
        let (points, locks) = (&run.judged.score.points, &run.judged.score.locks);
        table.push(vec![
            Cell::text(&run.capture),
            Cell::text(run.way.name()),
            Cell::text(run.setting.to_string()),
            Cell::number(run.cost, 4),
            Cell::number(points.explained_motion, 3),
            Cell::maybe(locks.as_ref().map(|locks| locks.explained_median), 3),
            Cell::number(points.explained_fluctuation, 3),
            Cell::number(points.mean_mm, 2),
            Cell::number(points.p95_mm, 1),
        ]);
    }
    let is_here = |peer: &&PeerPoint| runs.iter().any(|run| run.capture == peer.capture);
    for peer in peers.points.iter().filter(is_here) {
        table.push(vec![
            Cell::text(&peer.capture),
            Cell::text(format!("quoted: {}", peer.program)),
            Cell::text(&peer.setting),
            Cell::number(peer.cpu_secs_per_sec, 4),
            Cell::number(peer.explained_motion, 3),
            Cell::Missing,
            Cell::Missing,
            Cell::number(peer.mean_mm, 2),
            Cell::Missing,
        ]);
    }
    table
}

fn diagram(capture: &str, runs: &[Run], peers: &Peers, baselines: &[Baseline]) -> WorkPrecision {
    let here: Vec<&Run> = runs.iter().filter(|run| run.capture == capture).collect();
    let point = |run: &Run| CurvePoint {
        setting: run.setting.to_string(),
        cost: run.cost,
        error: 1.0 - run.judged.score.points.explained_motion,
    };
    let mut curves: Vec<Curve> = here
        .chunk_by(|a, b| a.way == b.way)
        .map(|of_way| Curve {
            points: of_way.iter().map(|run| point(run)).collect(),
            is_labeled: of_way[0].way == Way::default_of(Method::Physical),
            ..Curve::named(of_way[0].way.name())
        })
        .collect();
    curves.extend(peers.curves(capture));
    let ceiling = baselines.iter().find(|b| b.capture == capture && b.predictor == Baseline::CEILING);
    let diagram = WorkPrecision {
        title: format!("{capture}: style B in the true wind"),
        cost: "CPU s per simulated s".to_owned(),
        error: "unexplained motion".to_owned(),
        curves,
    };
    diagram.with_level("ceiling", ceiling.map(|ceiling| 1.0 - ceiling.explained_motion))
}
