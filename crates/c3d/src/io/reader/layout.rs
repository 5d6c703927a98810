mod choice;
mod claims;

use super::header::Start;
use crate::info::{self, Info};
use crate::parameter::Parameters;
use crate::{BLOCK, Processor, Quantity, ReadError, Storage, Warning};
use choice::Choice;
use std::collections::BTreeMap;

/// Where the samples stand.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    pub processor: Processor,
    pub storage: Storage,
    /// Of integer coordinates, > 0.
    pub scale: f32,
    pub n_points: u64,
    /// Analog words a frame.
    pub analog_words: u64,
    pub n_frames: u64,
    /// Place of the first frame in the file.
    pub data_start: u64,
}

impl Layout {
    pub fn frame_bytes(&self) -> u64 {
        (self.n_points * 4 + self.analog_words) * self.storage.word_bytes()
    }
}

/// Finds the layout that the file's size allows, among those that header and parameters claim.
///
/// # Errors
/// If points or analog samples are announced and not one frame of them fits.
pub(super) fn settle(
    start: &Start,
    parameters: &Parameters,
    warnings: &mut Vec<Warning>,
) -> Result<Layout, ReadError> {
    let Choice { layout, data_bytes } = choice::choose(start, parameters, warnings);
    let Some(n_fitting) = data_bytes.checked_div(layout.frame_bytes()) else {
        return Ok(without_content(start, layout, warnings));
    };
    if n_fitting == 0 {
        let (n_points, n_frames) = (layout.n_points as usize, layout.n_frames);
        return Err(ReadError::NoData { n_points, n_frames, found: start.file_bytes });
    }
    if n_fitting < layout.n_frames {
        warnings.push(Warning::CutShort { claimed: layout.n_frames, found: n_fitting });
        return Ok(Layout { n_frames: n_fitting, ..layout });
    }
    let n_left = data_bytes - layout.n_frames * layout.frame_bytes();
    if n_left >= BLOCK {
        warnings.push(Warning::TrailingBytes { n_bytes: n_left });
    }
    Ok(layout)
}

/// Frames in which nothing stands: what can be claimed is bounded by what a header can say or by the file's size.
fn without_content(start: &Start, layout: Layout, warnings: &mut Vec<Warning>) -> Layout {
    let n_frames = layout.n_frames.min(start.file_bytes.max(0xffff));
    if n_frames < layout.n_frames {
        warnings.push(Warning::CutShort { claimed: layout.n_frames, found: n_frames });
    }
    Layout { n_frames, ..layout }
}

/// Gathers what the file says about its contents.
pub(super) fn describe(
    start: &Start,
    parameters: &Parameters,
    layout: &Layout,
    warnings: &mut Vec<Warning>,
) -> Info {
    let n_points = layout.n_points as usize;
    let (labels, kinds) = info::labels_and_kinds(parameters, n_points);
    let info = Info {
        processor: layout.processor,
        storage: layout.storage,
        scale: layout.scale,
        rate_hz: rate_hz(start, parameters, warnings),
        first_frame: first_frame(start, parameters, warnings),
        n_frames: layout.n_frames as usize,
        n_points,
        unit: info::unit(parameters),
        labels,
        kinds,
        subjects: info::subjects(parameters),
        x_screen: info::first_text(parameters, "POINT", "X_SCREEN"),
        y_screen: info::first_text(parameters, "POINT", "Y_SCREEN"),
        manufacturer: info::manufacturer(parameters),
        analog: info::analog(parameters, layout.analog_words, start.header.analog_samples),
        events: info::events(parameters),
        rotations: info::rotations(parameters),
    };
    report_names(&info, warnings);
    info
}

fn rate_hz(start: &Start, parameters: &Parameters, warnings: &mut Vec<Warning>) -> Option<f64> {
    let usable = |rate: &f64| rate.is_finite() && *rate > 0.0;
    let header = f64::from(start.header.rate_hz);
    let stated = parameters.number("POINT", "RATE").filter(usable);
    let used = Some(header).filter(usable).or(stated);
    match (used, stated) {
        (None, _) => warnings.push(Warning::NoRate),
        (Some(used), Some(stated)) if stated != header => warnings.push(Warning::Contradiction {
            quantity: Quantity::Rate,
            header,
            parameter: "POINT:RATE",
            stated,
            used,
        }),
        _ => {}
    }
    used
}

/// The header's number, unless it is too small a word for it.
fn first_frame(start: &Start, parameters: &Parameters, warnings: &mut Vec<Warning>) -> u32 {
    let header = start.header.first_frame;
    let Some(stated) = claims::trial_frame(parameters, "ACTUAL_START_FIELD") else {
        return u32::from(header);
    };
    let fills_the_word = stated > 0xffff && (header == 0xffff || u32::from(header) == stated & 0xffff);
    let used = if fills_the_word { stated } else { u32::from(header) };
    if stated != u32::from(header) && !fills_the_word {
        warnings.push(Warning::Contradiction {
            quantity: Quantity::FirstFrame,
            header: f64::from(header),
            parameter: "TRIAL:ACTUAL_START_FIELD",
            stated: f64::from(stated),
            used: f64::from(used),
        });
    }
    used
}

fn report_names(info: &Info, warnings: &mut Vec<Warning>) {
    if info.n_points == 0 {
        return;
    }
    if info.unit.is_none() {
        warnings.push(Warning::NoUnit);
    }
    if info.labels.len() < info.n_points {
        warnings.push(Warning::MissingLabels { n_labels: info.labels.len(), n_points: info.n_points });
    }
    let mut counts = BTreeMap::new();
    for label in info.labels.iter().filter(|l| !l.is_empty()) {
        *counts.entry(label).or_insert(0) += 1;
    }
    let repeated = counts.into_iter().filter(|(_, n)| *n > 1);
    warnings.extend(repeated.map(|(l, n_points)| Warning::DuplicateLabel { label: l.clone(), n_points }));
}
