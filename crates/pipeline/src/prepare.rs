use crate::report::{CaptureSummary, QualityReport};
use crate::{ConvertError, Input, Watch, held, still};
use tousle_clean::{CleanOptions, Cleaned};
use tousle_core::{Capture, HeadCapture, Sample, Session};
use tousle_head::{HeadOptions, Located};
use tousle_ingest::{IngestOptions, Ingested};

/// How a capture is read, seen from the head, and cleaned.
#[derive(Clone, Debug, PartialEq)]
pub struct PrepareOptions {
    /// How the marker file is read; what is not given here the session says.
    pub ingest: IngestOptions,
    /// How the head is found and its poses smoothed.
    pub head: HeadOptions,
    /// How the locks' tracks are cleaned; `None` leaves them as the file has them.
    pub clean: Option<CleanOptions>,
}

impl Default for PrepareOptions {
    fn default() -> Self {
        Self {
            ingest: IngestOptions::default(),
            head: HeadOptions::default(),
            clean: Some(CleanOptions::default()),
        }
    }
}

/// A capture ready to be explained by wind, and what it took to get there.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// What the people in the room knew.
    pub session: Session,
    /// The markers as the file has them, world space.
    pub ingested: Ingested,
    /// The head's poses, and the locks as the file has them, head space.
    pub located: Located,
    /// The locks cleaned; `None` if nobody wanted that.
    pub cleaned: Option<Cleaned>,
    /// What was found and changed on the way.
    pub quality: QualityReport,
}

impl Prepared {
    /// The capture in head space: cleaned, or as the file has it.
    pub fn head(&self) -> &HeadCapture {
        self.cleaned.as_ref().map_or(&self.located.head, |cleaned| &cleaned.head)
    }

    /// Where each sample of the locks comes from, `[strand][marker][frame]`; `None` where nothing was cleaned.
    pub fn samples(&self) -> Option<&[Vec<Vec<Sample>>]> {
        self.cleaned.as_ref().map(|cleaned| &cleaned.samples[..])
    }

    /// The same capture with its locks cleaned by someone else.
    #[must_use]
    pub fn with_cleaned(mut self, cleaned: Cleaned) -> Self {
        self.quality.clean = Some(cleaned.report.clone());
        self.cleaned = Some(cleaned);
        self
    }
}

/// Reads a capture and its session, finds the head, cleans the locks.
///
/// In: the bytes of a marker file and of a session file. Out: the locks in head space, m, and the quality report
/// that lists everything that was odd, assumed, left out or changed.
///
/// # Errors
/// [`ConvertError`], which names the stage that failed.
pub fn prepare(
    capture: Input<'_>,
    session: Input<'_>,
    options: &PrepareOptions,
    watch: &dyn Watch,
) -> Result<Prepared, ConvertError> {
    let session_name = || session.name.to_owned();
    let mut known = tousle_ingest::read_session(session.bytes)
        .map_err(|source| ConvertError::Session { name: session_name(), source })?;
    let mut ingested = read_capture(capture, &known, &options.ingest, watch)?;
    let warnings = tousle_ingest::check_against(&ingested.capture, &known).map_err(|source| {
        ConvertError::Mismatch { session: session_name(), capture: capture.name.to_owned(), source }
    })?;
    ingested.report.warnings.extend(warnings);

    let stage = watch.stage("head");
    still::settle(&mut known, &ingested.capture);
    let locate = |known: &Session| tousle_head::locate_head(&ingested.capture, known, &options.head);
    let mut located = locate(&known)?;
    if still::find(&mut known, &located.head) {
        // At rest the head's own shape is seen better than hands measured it.
        located = locate(&known)?;
    }
    let odd = held::hold_against(&known, &located).map_err(|found| ConvertError::OtherLocks {
        session: session_name(),
        capture: capture.name.to_owned(),
        found,
    })?;
    ingested.report.warnings.extend(odd);
    drop(stage);

    let stage = watch.stage("clean");
    let clean = |options: &CleanOptions| tousle_clean::clean(&located.head, &known, options, &*stage);
    let cleaned = options.clean.as_ref().map(clean).transpose()?;
    ingested.report.warnings.extend(cleaned.iter().flat_map(|cleaned| cleaned.report.warnings()));
    drop(stage);

    let quality = QualityReport {
        name: known.name.clone(),
        capture: summary(&ingested.capture, ingested.format.name(), &located.head),
        assumed: known.assumed.clone(),
        ingest: ingested.report.clone(),
        head: located.report.clone(),
        clean: cleaned.as_ref().map(|cleaned| cleaned.report.clone()),
    };
    Ok(Prepared { session: known, ingested, located, cleaned, quality })
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

fn summary(capture: &Capture, format: &str, head: &HeadCapture) -> CaptureSummary {
    let tracks = || head.strands.iter().flat_map(|s| &s.markers);
    let seen: usize = tracks().map(tousle_core::Track::n_valid).sum();
    let all = tracks().count() * capture.n_frames;
    CaptureSummary {
        format: format.to_owned(),
        n_frames: capture.n_frames,
        first_frame: capture.first_frame,
        rate_hz: capture.rate_hz,
        duration_secs: capture.duration_secs(),
        n_trajectories: capture.trajectories.len(),
        n_unlabeled: capture.trajectories.iter().filter(|t| t.is_unlabeled()).count(),
        seen: seen as f64 / all.max(1) as f64,
    }
}
