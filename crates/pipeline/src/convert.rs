use crate::{
    ConversionReport, MeasureOptions, Measured, PrepareOptions, Prepared, Watch, attachments, measure,
    prepare,
};
use tousle_clean::CleanError;
use tousle_eff::Eff;
use tousle_field::{GridError, GridSpec};
use tousle_fit::{FitError, FitMethod, FitOptions, Wig};
use tousle_head::HeadError;
use tousle_ingest::{CheckError, IngestError, SessionError};
use tousle_raster::RasterError;
use tousle_refine::{RefineError, RefineOptions};

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
    /// How the capture is read, seen from the head, and cleaned.
    pub prepare: PrepareOptions,
    /// How motion becomes wind, and at which rate.
    pub fit: FitOptions,
    /// Whether and how the wind is mended until the simulated wig moves as the captured one; only the method `physical` knows
    /// what the wig is made of.
    pub refine: Option<RefineOptions>,
    /// Edge of the grid, m.
    pub extent_m: f64,
    /// Edge of a voxel, m.
    pub edge_m: f64,
}

impl Default for ConvertOptions {
    fn default() -> Self {
        Self {
            prepare: PrepareOptions::default(),
            fit: FitOptions::default(),
            refine: Some(RefineOptions::quick()),
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
    /// The capture that the field was made from.
    pub prepared: Prepared,
    /// The captured locks, ready to be simulated; `None` for `paper`.
    pub wig: Option<Wig>,
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
    /// Locks are seen that are not those of the session, or its head is not where they grow.
    #[error("the session {session} does not fit the hair in the capture {capture}: {found}")]
    OtherLocks {
        /// The session file.
        session: String,
        /// The marker file.
        capture: String,
        /// Which locks or which head, what was found of them and what was expected.
        found: String,
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
    /// The locks' tracks.
    #[error("cannot clean the locks' tracks")]
    Clean(#[from] CleanError),
    /// The wind at the markers.
    #[error("cannot tell the wind from the markers")]
    Fit(#[from] FitError),
    /// The closed loop.
    #[error("cannot refine the wind")]
    Refine(#[source] RefineError),
    /// The field.
    #[error("cannot fill the grid")]
    Raster(#[from] RasterError),
    /// The report that travels with the field.
    #[error("cannot write the report")]
    Report(#[from] serde_json::Error),
}

impl From<RefineError> for ConvertError {
    /// The closed loop's fit fails for what any fit fails for.
    fn from(error: RefineError) -> Self {
        match error {
            RefineError::Fit(error) => Self::Fit(error),
            other => Self::Refine(other),
        }
    }
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
    let prepared = prepare(capture, session, &options.prepare, watch)?;
    let options = MeasureOptions { fit: options.fit.clone(), refine: options.refine.clone(), grid };
    let Measured { fit, refined, scene, raster } = measure(&prepared, &options, watch)?;

    let mut report = ConversionReport {
        method: method_name(&options.fit).to_owned(),
        quality: prepared.quality.clone(),
        fit: fit.report,
        refine: refined,
        raster: raster.report,
        losses: Vec::new(),
    };
    if let (Some(found), Some(refined)) = (&mut report.fit.physical, &report.refine) {
        found.warnings.extend(refined.doubt());
    }
    report.find_losses();
    let eff = Eff {
        name: prepared.session.name.clone(),
        method: method_name(&options.fit).to_owned(),
        generator: GENERATOR.to_owned(),
        field: raster.sequence,
        scene,
        samples: Some(fit.samples),
        attachments: attachments(session, &report)?,
    };
    Ok(Converted { eff, prepared, wig: fit.wig, report })
}

fn method_name(options: &FitOptions) -> &'static str {
    match options.method {
        FitMethod::Paper(_) => "paper",
        FitMethod::Physical(_) => "physical",
    }
}
