mod body;
mod captured;
mod compass;
mod hair;
mod markers;
mod quantize;
mod sections;
mod wind;

use crate::{Figure, PLOT_STYLE, Packed, Shell, json_for_script};
use body::BodyData;
use hair::HairData;
use markers::MarkerData;
use serde::Serialize;
use tousle_core::{Groom, HeadCapture, Session, StrandMotion};
use tousle_field::{FieldError, FieldSequence, Scene};
use wind::WindData;

/// All that the page of `tousle demo` shows. Text is plain text; the page escapes it.
#[derive(Clone, Copy, Debug)]
pub struct DemoPage<'a> {
    /// The page's title.
    pub title: &'a str,
    /// What the reader is looking at: one paragraph each, over the moving hair.
    pub intro: &'a [String],
    /// Where the capture comes from, in words.
    pub source: &'a str,
    /// The capture, head space.
    pub capture: &'a HeadCapture,
    /// What the people in the room knew.
    pub session: &'a Session,
    /// The wind that was found.
    pub field: &'a FieldSequence,
    /// The method that found it, as its file names it: it tells what the voxels' flags mean.
    pub method: &'a str,
    /// How the head moves and what hair can touch.
    pub scene: &'a Scene,
    /// The hairstyles that wear the wind; the first is shown first. On the same clock as the capture.
    pub hair: &'a [HairView<'a>],
    /// The numbers worth a card.
    pub figures: &'a [Figure],
    /// What was done, in order.
    pub stages: &'a [StageLine],
    /// The folder the files are in.
    pub folder: &'a str,
    /// The files that were written.
    pub files: &'a [FileEntry],
    /// What a reader should know before believing the numbers: losses, repairs, limits.
    pub notes: &'a [String],
}

/// One hairstyle and its motion.
#[derive(Clone, Copy, Debug)]
pub struct HairView<'a> {
    /// Its name on the button that shows it.
    pub name: &'a str,
    /// A sentence about it.
    pub about: &'a str,
    /// The strands at rest; [`StrandMotion::counts`] must be theirs.
    pub groom: &'a Groom,
    /// Where they go.
    pub motion: &'a StrandMotion,
    /// A second motion of the same strands to lay over the first: the truth, another method.
    pub compared: Option<Compared<'a>>,
}

/// A motion to compare with.
#[derive(Clone, Copy, Debug)]
pub struct Compared<'a> {
    /// What it is.
    pub name: &'a str,
    /// The motion, with the same counts; between its frames it is taken as linear.
    pub motion: &'a StrandMotion,
}

/// A stage that ran.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StageLine {
    /// The stage's name.
    pub name: String,
    /// What it did and what it found.
    pub text: String,
    /// The command that does the same by hand; empty for none.
    pub command: String,
    /// How long it took, s, if somebody looked at a clock.
    pub secs: Option<f64>,
}

/// A file that was written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FileEntry {
    /// Its name in the folder.
    pub name: String,
    /// What is in it.
    pub what: String,
    /// Its size.
    pub bytes: u64,
}

/// What makes a page impossible.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PageError {
    /// A motion is not the motion of its groom.
    #[error(
        "{name}: found a motion of {found} control points in {n_frames} frames, expected {expected} in each frame, those of the groom"
    )]
    MotionDoesNotFit {
        /// The hairstyle or what it is compared with.
        name: String,
        /// Positions in the motion.
        found: usize,
        /// Frames of the motion.
        n_frames: usize,
        /// Control points of the groom.
        expected: usize,
    },
    /// A motion has no frame, or its times do not rise.
    #[error(
        "{name}: found times that do not rise at frame {frame}, expected one frame or more, in order of time"
    )]
    BadTimes {
        /// The hairstyle or what it is compared with.
        name: String,
        /// Where the order breaks; 0 if there is no frame.
        frame: usize,
    },
    /// A position is NaN or infinite.
    #[error("{name}, frame {frame}: found a position that is not finite")]
    NotFinite {
        /// The hairstyle or what it is compared with.
        name: String,
        /// The frame.
        frame: usize,
    },
    /// The head has no pose at any time.
    #[error("the scene has no head pose")]
    NoPose,
    /// The field cannot be shown.
    #[error("the field cannot be shown")]
    Field(#[from] FieldError),
    /// The page's data cannot be written as JSON.
    #[error("the page's data cannot be written")]
    Data(#[from] serde_json::Error),
}

/// What the page's script gets, beside the packed arrays.
#[derive(Serialize)]
struct PageData {
    span_secs: [f64; 2],
    start_secs: f64,
    body: BodyData,
    hair: Vec<HairData>,
    markers: MarkerData,
    wind: WindData,
}

const STYLES: [&str; 3] =
    [PLOT_STYLE, include_str!("../assets/css/demo.css"), include_str!("../assets/css/player.css")];

/// The script, in the order in which one part uses another.
const SCRIPTS: [&str; 14] = [
    include_str!("../assets/js/codec.js"),
    include_str!("../assets/js/math.js"),
    include_str!("../assets/js/theme.js"),
    include_str!("../assets/js/player.js"),
    include_str!("../assets/js/tracks.js"),
    include_str!("../assets/js/gl.js"),
    include_str!("../assets/js/bust.js"),
    include_str!("../assets/js/hair.js"),
    include_str!("../assets/js/marks.js"),
    include_str!("../assets/js/camera.js"),
    include_str!("../assets/js/stage.js"),
    include_str!("../assets/js/slice.js"),
    include_str!("../assets/js/captured.js"),
    include_str!("../assets/js/main.js"),
];

/// What the moving picture adds to the data, said on every page that has one.
const DRAWN_FOR_THE_EYE: [&str; 2] = [
    "In the moving picture, hair between the simulated locks is drawn for the eye, blended from the nearest ones; \
     without \"full\" only the locks are there. So are the face and the rounding where head, neck and shoulders meet.",
    "Positions on this page are rounded to 0.05 mm, and times in between are interpolated (cubic for hair, linear for \
     wind and markers); the files hold what was computed.",
];

/// The demo's page: one HTML document that needs nothing else.
///
/// Positions are quantized to a step of 0.05 mm (error half of that) where all of a motion lies within 1.6 m of
/// its middle, and coarser beyond; the field to 1 % of its 99th percentile. What has to be thinned out to keep
/// the page small is said among the page's notes. The same input gives the same page.
///
/// # Errors
/// [`PageError`] if a motion does not fit its groom, a position is not finite, or the field is no field.
pub fn demo_page(page: &DemoPage<'_>) -> Result<String, PageError> {
    page.field.check()?;
    if page.scene.poses.poses.is_empty() {
        return Err(PageError::NoPose);
    }
    let mut notes = page.notes.to_vec();
    notes.extend(DRAWN_FOR_THE_EYE.map(str::to_owned));
    let mut blobs = Vec::new();
    let hair = page
        .hair
        .iter()
        .enumerate()
        .map(|(k, view)| hair::hair_data(k, view, &mut blobs, &mut notes))
        .collect::<Result<Vec<_>, _>>()?;
    let span_secs = span_secs(page);
    let data = PageData {
        span_secs,
        start_secs: start_secs(page, span_secs),
        body: body::body_data(page.scene, page.session, span_secs, &mut blobs),
        hair,
        markers: markers::marker_data(page.capture, page.session, &mut blobs),
        wind: wind::wind_data(page.field, &mut blobs, &mut notes),
    };
    let json = json_for_script(&data)?;
    let elements: String = blobs.iter().map(Packed::element).collect();
    let shell = Shell {
        title: page.title,
        styles: &STYLES,
        body: sections::body_html(page, &data, &notes),
        data: format!("<script type=\"application/json\" id=\"data\">{json}</script>\n{elements}"),
        scripts: &SCRIPTS,
    };
    Ok(shell.html())
}

/// From the first to the last frame of any hairstyle; without hair, that of the field.
fn span_secs(page: &DemoPage<'_>) -> [f64; 2] {
    let ends =
        page.hair.iter().filter_map(|h| Some([*h.motion.times_secs.first()?, *h.motion.times_secs.last()?]));
    ends.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
        .unwrap_or([page.field.start_secs, page.field.end_secs()])
}

/// Where the player begins: just before the wind does, so that a reader need not wait through the still interval.
fn start_secs(page: &DemoPage<'_>, [first, last]: [f64; 2]) -> f64 {
    const LEAD_SECS: f64 = 0.25;
    let wind_start = page.session.wind_start_secs(page.capture.first_frame, page.capture.rate_hz);
    wind_start.map_or(first, |t| (t - LEAD_SECS).clamp(first, last.max(first)))
}
