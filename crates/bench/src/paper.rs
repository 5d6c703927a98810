//! The 2008 method judged: every reading of E3 on every capture, beside predictors that measure nothing.

mod report;

use crate::capture::failed;
use crate::{
    Baseline, BenchError, CaptureFolder, Cost, FieldScore, Judged, MotionScore, Stopwatch, TrueWind,
    baselines_beside, resample_to_truth, score_field, sim_in_field,
};
use serde::Serialize;
use std::path::Path;
use tousle_core::Progress;
use tousle_fit::{FitMethod, FitOptions, PaperOptions, PaperReading};
use tousle_pipeline::{ConvertOptions, Input, Silent, convert};
use tousle_sim::{Method, SimOptions};

/// What is judged.
#[derive(Clone, Debug, PartialEq)]
pub struct PaperBenchOptions {
    /// The captures by name; empty for all.
    pub captures: Vec<String>,
    /// The readings of E3.
    pub readings: Vec<PaperReading>,
    /// How captures are converted; method and reading are set for each run.
    pub convert: ConvertOptions,
    /// How style B is simulated.
    pub simulate: SimOptions,
    /// Whether style B is simulated in the true wind too.
    pub true_wind: bool,
}

impl Default for PaperBenchOptions {
    fn default() -> Self {
        Self {
            captures: Vec::new(),
            readings: vec![PaperReading::FirstFrame, PaperReading::SlidingWindow, PaperReading::RestPose],
            convert: ConvertOptions::default(),
            simulate: SimOptions::of(Method::Paper),
            true_wind: true,
        }
    }
}

/// The 2008 method on every capture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PaperReport {
    /// One entry a capture and wind, capture after capture.
    pub rows: Vec<PaperRow>,
    /// What `BASELINES.md` beside the captures says of the same captures; empty if it is not there.
    pub baselines: Vec<Baseline>,
}

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PaperRow {
    /// The capture's name.
    pub capture: String,
    /// The wind that style B was simulated in: a reading of E3 by name, or `true wind`.
    pub wind: String,
    /// How long the capture lasts, s.
    pub captured_secs: f64,
    /// What converting the capture cost; `None` where nothing was converted.
    pub convert: Option<Cost>,
    /// What simulating style B cost.
    pub simulate: Cost,
    /// Style B against its truth.
    pub motion: MotionScore,
    /// The field against the true wind; `None` where it is the true wind.
    pub field: Option<FieldScore>,
    /// Largest change of a stick's length in any frame, as a share of it.
    pub max_stretch: f64,
}

/// The name of the wind that nobody measured, in [`PaperRow::wind`].
pub const TRUE_WIND: &str = "true wind";

/// Converts every capture by every reading of E3, simulates style B in each field, and scores both.
///
/// `captures` is a folder of folders as the captures come, each with its truth. Progress is in runs.
///
/// # Errors
/// [`BenchError`] with the capture and the stage that failed.
pub fn run(
    captures: &Path,
    options: &PaperBenchOptions,
    progress: &dyn Progress,
) -> Result<PaperReport, BenchError> {
    let folders = CaptureFolder::named(captures, &options.captures)?;
    let runs_each = options.readings.len() + usize::from(options.true_wind);
    let total = (folders.len() * runs_each) as u64;
    let mut rows = Vec::new();
    for folder in &folders {
        let wind = folder.truth.wind().map_err(folder.truth_failed())?;
        for reading in &options.readings {
            progress.at(rows.len() as u64, total);
            rows.push(judge_reading(folder, &wind, *reading, options)?);
        }
        if options.true_wind {
            progress.at(rows.len() as u64, total);
            let judged = sim_in_field(folder, &wind.to_sequence(), &folder.true_scene()?, &options.simulate)?;
            rows.push(row(folder, TRUE_WIND, judged));
        }
    }
    progress.at(total, total);
    let mut baselines = baselines_beside(captures);
    baselines.retain(|baseline| folders.iter().any(|folder| folder.name() == baseline.capture));
    Ok(PaperReport { rows, baselines })
}

fn judge_reading(
    folder: &CaptureFolder,
    wind: &TrueWind,
    reading: PaperReading,
    options: &PaperBenchOptions,
) -> Result<PaperRow, BenchError> {
    let (csv, session) = (folder.csv()?, folder.session_bytes()?);
    let method = FitMethod::Paper(PaperOptions { reading, ..PaperOptions::default() });
    let convert_options = ConvertOptions {
        fit: FitOptions { method, ..options.convert.fit.clone() },
        ..options.convert.clone()
    };
    let watch = Stopwatch::start();
    let converted = convert(
        Input { name: "capture", bytes: &csv },
        Input { name: "session.json", bytes: &session },
        &convert_options,
        &Silent,
    )
    .map_err(failed(folder.name(), "converting"))?;
    let convert_cost = watch.stop();
    let judged = sim_in_field(folder, &converted.eff.field, &converted.eff.scene, &options.simulate)?;
    let field = score_field(&resample_to_truth(&converted.eff.field, wind), wind)
        .map_err(failed(folder.name(), "scoring the field"))?;
    Ok(PaperRow {
        captured_secs: converted.report.quality.capture.duration_secs,
        convert: Some(convert_cost),
        field: Some(field),
        ..row(folder, reading.name(), judged)
    })
}

fn row(folder: &CaptureFolder, wind: &str, judged: Judged) -> PaperRow {
    PaperRow {
        capture: folder.name().to_owned(),
        wind: wind.to_owned(),
        captured_secs: judged.simulated_secs,
        convert: None,
        simulate: judged.cost,
        motion: judged.score,
        field: None,
        max_stretch: judged.simulation.report.max_stretch,
    }
}
