use crate::report::CaptureSummary;
use crate::{ConversionReport, Watch};
use tousle_core::{Capture, HeadCapture, STANDARD_GRAVITY, Session};
use tousle_eff::{Attachment, Eff};
use tousle_field::{GridError, GridSpec, Scene};
use tousle_fit::{Fit, FitError, FitMethod, FitOptions};
use tousle_head::{HeadError, HeadOptions, Located};
use tousle_ingest::{CheckError, IngestError, IngestOptions, Ingested, SessionError};
use tousle_raster::{Raster, RasterError, RasterMethod, RasterOptions};

/// A file's name, for messages, and its bytes.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The name.
    pub name: &'a str,
    /// The bytes.
    pub bytes: &'a [u8],
}

/// How a capture becomes a field.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvertOptions {
    /// How the marker file is read; what is not given here the session says.
    pub ingest: IngestOptions,
    /// How the head is found and its poses smoothed.
    pub head: HeadOptions,
    /// How motion becomes wind, and at which rate.
    pub fit: FitOptions,
    /// Edge of the grid, m.
    pub extent_m: f64,
    /// Edge of a voxel, m.
    pub edge_m: f64,
}

impl Default for ConvertOptions {
    fn default() -> Self {
        Self {
            ingest: IngestOptions::default(),
            head: HeadOptions::default(),
            fit: FitOptions::default(),
            extent_m: 0.6,
            edge_m: 0.02,
        }
    }
}

/// A field, the capture in head space it came from, and what happened on the way.
#[derive(Clone, Debug)]
pub struct Converted {
    /// The field with all that travels with it.
    pub eff: Eff,
    /// What the people in the room knew.
    pub session: Session,
    /// The capture in head space.
    pub head: HeadCapture,
    /// What happened.
    pub report: ConversionReport,
}

/// Which stage failed; its own error says why.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ConvertError {
    /// The marker file.
    #[error("cannot read the capture {name}")]
    Capture {
        /// The file.
        name: String,
        /// Why.
        source: IngestError,
    },
    /// The session file.
    #[error("cannot read the session {name}")]
    Session {
        /// The file.
        name: String,
        /// Why.
        source: SessionError,
    },
    /// The two do not belong together.
    #[error("the session {session} does not fit the capture {capture}")]
    Mismatch {
        /// The session file.
        session: String,
        /// The marker file.
        capture: String,
        /// Why.
        source: CheckError,
    },
    /// Nobody says which way is up, and gravity must point somewhere.
    #[error(
        "neither the capture nor the session says which axis is up: add \"up_axis\": \"Z\" (or X, Y) to the session"
    )]
    NoUpAxis,
    /// The grid.
    #[error("the grid is impossible")]
    Grid(#[from] GridError),
    /// The head.
    #[error("cannot find the head")]
    Head(#[from] HeadError),
    /// The wind at the markers.
    #[error("cannot tell the wind from the markers")]
    Fit(#[from] FitError),
    /// The field.
    #[error("cannot fill the grid")]
    Raster(#[from] RasterError),
}

/// The program and its version, as field files name it.
pub const GENERATOR: &str = concat!("tousle ", env!("CARGO_PKG_VERSION"));

/// Turns a capture and its session into a field.
///
/// In: the bytes of a marker file and of a session file. Out: an [`Eff`] with the field, the scene, the samples
/// it was made from, the session as it was given and the report as attachments. The same input and options give
/// the same value, whatever the number of threads.
///
/// # Errors
/// [`ConvertError`], which names the stage that failed.
pub fn convert(
    capture: Input<'_>,
    session: Input<'_>,
    options: &ConvertOptions,
    watch: &dyn Watch,
) -> Result<Converted, ConvertError> {
    let grid = GridSpec::cube(options.extent_m, options.edge_m)?;
    let session_name = || session.name.to_owned();
    let known = tousle_ingest::read_session(session.bytes)
        .map_err(|source| ConvertError::Session { name: session_name(), source })?;
    let ingested = read_capture(capture, &known, &options.ingest, watch)?;
    let check_warnings = tousle_ingest::check_against(&ingested.capture, &known).map_err(|source| {
        ConvertError::Mismatch { session: session_name(), capture: capture.name.to_owned(), source }
    })?;
    let up_axis = known.up_axis.or(ingested.capture.up_axis).ok_or(ConvertError::NoUpAxis)?;

    let stage = watch.stage("head");
    let located = tousle_head::locate_head(&ingested.capture, &known, &options.head)?;
    drop(stage);

    let stage = watch.stage("fit");
    let fit = tousle_fit::fit(&located.head, &known, &options.fit)?;
    drop(stage);

    let stage = watch.stage("raster");
    let raster_options = RasterOptions { method: RasterMethod::Paper, grid };
    let raster = tousle_raster::rasterize(&fit.samples, &fit.outside, &raster_options, &*stage)?;
    drop(stage);

    let scene = Scene {
        poses: located.tracked.poses.clone(),
        rest_pose: located.tracked.rest_pose,
        gravity_world: -up_axis.vector() * STANDARD_GRAVITY,
        air_density: known.air_density,
        body: known.body.clone(),
    };
    let report = report(&known, &ingested, check_warnings, &located, &fit, &raster, options);
    let eff = Eff {
        name: known.name.clone(),
        method: method_name(&options.fit).to_owned(),
        generator: GENERATOR.to_owned(),
        field: raster.sequence,
        scene,
        samples: Some(fit.samples),
        attachments: attachments(session, &report),
    };
    Ok(Converted { eff, session: known, head: located.head, report })
}

fn read_capture(
    capture: Input<'_>,
    session: &Session,
    asked: &IngestOptions,
    watch: &dyn Watch,
) -> Result<Ingested, ConvertError> {
    let _stage = watch.stage("read");
    let of_session = IngestOptions::from_session(session);
    let options = IngestOptions {
        unit: asked.unit.or(of_session.unit),
        rate_hz: asked.rate_hz.or(of_session.rate_hz),
        subject: asked.subject.clone().or(of_session.subject),
        ..asked.clone()
    };
    tousle_ingest::read_capture(capture.bytes, &options)
        .map_err(|source| ConvertError::Capture { name: capture.name.to_owned(), source })
}

fn method_name(options: &FitOptions) -> &'static str {
    match options.method {
        FitMethod::Paper(_) => "paper",
        _ => "unknown",
    }
}

fn report(
    session: &Session,
    ingested: &Ingested,
    check_warnings: Vec<String>,
    located: &Located,
    fit: &Fit,
    raster: &Raster,
    options: &ConvertOptions,
) -> ConversionReport {
    let mut ingest = ingested.report.clone();
    ingest.warnings.extend(check_warnings);
    let mut report = ConversionReport {
        method: method_name(&options.fit).to_owned(),
        capture: summary(&ingested.capture, ingested.format.name(), &located.head),
        assumed: session.assumed.clone(),
        ingest,
        head: located.report.clone(),
        fit: fit.report.clone(),
        raster: raster.report.clone(),
        losses: Vec::new(),
    };
    report.find_losses();
    report
}

fn summary(capture: &Capture, format: &str, head: &HeadCapture) -> CaptureSummary {
    let tracks = || head.strands.iter().flat_map(|s| &s.markers);
    let seen: usize = tracks().map(tousle_core::Track::n_valid).sum();
    let all = tracks().count() * capture.n_frames;
    CaptureSummary {
        format: format.to_owned(),
        n_frames: capture.n_frames,
        rate_hz: capture.rate_hz,
        duration_secs: capture.duration_secs(),
        n_trajectories: capture.trajectories.len(),
        n_unlabeled: capture.trajectories.iter().filter(|t| t.is_unlabeled()).count(),
        seen: seen as f64 / all.max(1) as f64,
    }
}

fn attachments(session: Input<'_>, report: &ConversionReport) -> Vec<Attachment> {
    let is_toml = !session.bytes.trim_ascii_start().starts_with(b"{");
    let (name, media_type) =
        if is_toml { ("session.toml", "application/toml") } else { ("session.json", "application/json") };
    let report = serde_json::to_vec_pretty(report).expect("a report is made of strings, numbers and lists");
    vec![
        Attachment {
            name: name.to_owned(),
            media_type: media_type.to_owned(),
            bytes: session.bytes.to_vec(),
        },
        Attachment {
            name: "report.json".to_owned(),
            media_type: "application/json".to_owned(),
            bytes: report,
        },
    ]
}
