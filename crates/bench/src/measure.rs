//! Measuring the wind judged: `paper` and `physical` on every capture, and what becomes of `physical` with other voxels,
//! rates, markers, locks, noise, gaps, and hair that nobody saw at rest.

mod calibration;
mod report;
mod setting;
mod trade;
mod worse;

pub use calibration::Calibration;
pub use report::MeasureReport;
pub use setting::Setting;
pub use worse::Worse;

use crate::capture::failed;
use crate::{
    BenchError, CaptureFolder, Cost, FieldScore, MotionScore, Stopwatch, TrueWind, baselines_beside,
    resample_to_truth, score_field, score_motion, sim_in_field, sim_to_the_end,
};
use serde::Serialize;
use std::path::Path;
use tousle_clean::CleanOptions;
use tousle_core::{NoProgress, Progress};
use tousle_field::{FieldSequence, GridSpec, Scene};
use tousle_fit::{FitMethod, FitOptions, Wig};
use tousle_pipeline::{Input, MeasureOptions, Measured, PrepareOptions, Prepared, Silent, measure, prepare};
use tousle_refine::RefineReport;
use tousle_sim::{Method, SimOptions};

/// One setting on one capture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeasureRow {
    /// The capture's name.
    pub capture: String,
    /// The method's name: `paper`, `physical`, `physical --refine`.
    pub method: &'static str,
    /// What is varied: `method`, `dirt`, `choice`, `reading`, `voxel`, `rate`, `refine`, `markers`, `locks`, `noise`, `gaps`, `rest`.
    pub varied: &'static str,
    /// How much there is of what is varied ([`Setting::level`]).
    pub level: f64,
    /// The setting in words.
    pub setting: String,
    /// What cleaning, fit and raster cost.
    pub cost: Cost,
    /// Style B simulated in the field, against its truth.
    pub motion: MotionScore,
    /// The captured wig itself simulated in the field, its markers against theirs; `None` for `paper`, which does not know
    /// what the wig is made of.
    pub wig: Option<MotionScore>,
    /// The field against the true wind.
    pub field: FieldScore,
    /// How the closed loop went; `None` without it.
    pub refined: Option<RefineReport>,
    /// How honest the field's standard deviations are; `None` where it states none.
    pub calibration: Option<Calibration>,
}

impl MeasureRow {
    /// Whether another is of the same setting, if perhaps of another capture.
    fn is_set_as(&self, other: &Self) -> bool {
        (self.method, self.varied, &self.setting) == (other.method, other.varied, &other.setting)
    }

    /// Whether it is of a method as it is by default.
    fn is_default(&self) -> bool {
        self.varied == Setting::AS_IT_IS
    }
}

/// Extent of the grid, m: that of the truth.
const EXTENT_M: f64 = 0.6;

/// Measures the wind of every capture in every setting, simulates style B in it, and scores both.
///
/// `names` are the captures' names; empty for all. Progress is in runs.
///
/// # Errors
/// [`BenchError`] with the capture and the stage that failed.
pub fn run(
    captures: &Path,
    names: &[String],
    settings: &[Setting],
    progress: &dyn Progress,
) -> Result<MeasureReport, BenchError> {
    let folders = CaptureFolder::named(captures, names)?;
    let total = (folders.len() * settings.len()) as u64;
    let mut rows = Vec::new();
    for folder in &folders {
        let wind = folder.truth.wind().map_err(folder.truth_failed())?;
        let (csv, session) = (folder.csv()?, folder.session_bytes()?);
        let capture = Input { name: "capture", bytes: &csv };
        let options = PrepareOptions { clean: None, ..PrepareOptions::default() };
        let prepared = prepare(capture, Input { name: "session.json", bytes: &session }, &options, &Silent)
            .map_err(failed(folder.name(), "reading"))?;
        let mut seen: Option<Seen> = None;
        for setting in settings {
            progress.at(rows.len() as u64, total);
            // Settings that are of one capture follow one another: it is cleaned once for all of them.
            let as_before = seen.take().filter(|seen| seen.worse == setting.worse);
            let now = as_before.map_or_else(|| Seen::of(folder, &prepared, setting.worse), Ok)?;
            rows.push(judge(folder, &wind, &now, setting)?);
            seen = Some(now);
        }
    }
    progress.at(total, total);
    Ok(MeasureReport { rows, baselines: baselines_beside(captures) })
}

/// What is seen of a capture that was made worse, cleaned.
struct Seen {
    worse: Worse,
    prepared: Prepared,
    /// What cleaning cost.
    cost: Cost,
}

impl Seen {
    fn of(folder: &CaptureFolder, prepared: &Prepared, worse: Worse) -> Result<Self, BenchError> {
        let head = worse.applied(&prepared.located.head, &prepared.session, || folder.truth.markers());
        let head = head.map_err(folder.truth_failed())?;
        let session = worse.known(&prepared.session);
        let watch = Stopwatch::start();
        let cleaned = tousle_clean::clean(&head, &session, &CleanOptions::default(), &NoProgress)
            .map_err(failed(folder.name(), "cleaning"))?;
        let cost = watch.stop();
        let prepared = Prepared { session, ..prepared.clone() };
        Ok(Self { worse, prepared: prepared.with_cleaned(cleaned), cost })
    }
}

fn judge(
    folder: &CaptureFolder,
    wind: &TrueWind,
    seen: &Seen,
    setting: &Setting,
) -> Result<MeasureRow, BenchError> {
    let watch = Stopwatch::start();
    let grid = GridSpec::cube(EXTENT_M, setting.edge_m).map_err(failed(folder.name(), "the grid"))?;
    let fit = FitOptions { method: setting.fit.clone(), rate_hz: setting.rate_hz, up_axis: None };
    let options = MeasureOptions { fit, refine: setting.refine.clone(), grid };
    let measured = measure(&seen.prepared, &options, &Silent);
    let Measured { fit, refined, scene, raster } = measured.map_err(failed(folder.name(), "the wind"))?;
    let field = raster.sequence;
    let cost = seen.cost + watch.stop();
    let simulate = match setting.fit {
        FitMethod::Paper(_) => SimOptions::of(Method::Paper),
        FitMethod::Physical(_) => SimOptions::of(Method::Physical),
    };
    let judged = sim_in_field(folder, &field, &scene, &simulate)?;
    let score =
        score_field(&resample_to_truth(&field, wind), wind).map_err(failed(folder.name(), "scoring"))?;
    Ok(MeasureRow {
        capture: folder.name().to_owned(),
        method: setting.method(),
        varied: setting.varied,
        level: setting.level(),
        setting: setting.words.clone(),
        cost,
        motion: judged.score,
        wig: fit.wig.map(|wig| again(folder, &wig, &seen.prepared, &field, &scene)).transpose()?,
        field: score,
        refined,
        calibration: Calibration::of(&field, wind),
    })
}

/// The captured wig simulated in a field, its markers against where they really were.
fn again(
    folder: &CaptureFolder,
    wig: &Wig,
    prepared: &Prepared,
    field: &FieldSequence,
    scene: &Scene,
) -> Result<MotionScore, BenchError> {
    let truth = folder.truth.markers().map_err(folder.truth_failed())?;
    let options =
        SimOptions { rate_hz: prepared.ingested.capture.rate_hz, ..SimOptions::of(Method::Physical) };
    let motion = sim_to_the_end(folder.name(), field, scene, &wig.groom, &truth, &options)?.motion;
    score_motion(&wig.markers(&motion, &prepared.session), &truth)
        .map_err(failed(folder.name(), "scoring the captured wig"))
}
