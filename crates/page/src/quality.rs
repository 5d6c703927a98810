//! The page about one capture: what is missing in it, what cleaning changed, and how well the head was found.

mod events;
mod findings;
mod head;
mod locks;

use crate::{Figure, Shell, decimals, escape, figure_cards, short};
use findings::findings;
use tousle_clean::CleanReport;
use tousle_core::{Assumption, Session};
use tousle_head::HeadReport;

/// What the quality page shows.
#[derive(Clone, Copy, Debug)]
pub struct QualityPage<'a> {
    /// The capture's name.
    pub capture: &'a str,
    /// The format it is in.
    pub format: &'a str,
    /// Frames a second.
    pub rate_hz: f64,
    /// The number of the first frame.
    pub first_frame: i64,
    /// Frames.
    pub n_frames: usize,
    /// Trajectories in the file, and how many of them nobody labeled.
    pub n_trajectories: [usize; 2],
    /// Share of the locks' samples that the file has.
    pub seen: f64,
    /// What the people in the room knew.
    pub session: &'a Session,
    /// What was odd about the file.
    pub warnings: &'a [String],
    /// Values that nobody gave.
    pub assumed: &'a [Assumption],
    /// How the head was found.
    pub head: &'a HeadReport,
    /// What cleaning changed; `None` if nothing was cleaned.
    pub clean: Option<&'a CleanReport>,
}

const STYLES: [&str; 2] = [crate::PLOT_STYLE, include_str!("../assets/css/quality.css")];

/// The quality page: one HTML file that needs no other file and no network.
pub fn quality_page(page: &QualityPage<'_>) -> String {
    let body = format!(
        "<main>\n{}{}{}{}{}</main>\n",
        top(page),
        page.clean.map_or_else(not_cleaned, |clean| events::section(page, clean)),
        head::section(page),
        page.clean.map_or_else(String::new, |clean| locks::section(page, clean)),
        notes(page),
    );
    let title = format!("Quality of {}", page.capture);
    Shell { title: &title, styles: &STYLES, body, ..Shell::default() }.html()
}

impl QualityPage<'_> {
    fn secs(&self, n_frames: u64) -> f64 {
        n_frames as f64 / self.rate_hz
    }
}

fn top(page: &QualityPage<'_>) -> String {
    let last_frame = page.first_frame.saturating_add(page.n_frames as i64).saturating_sub(1);
    let facts = format!(
        "{}, {} frames ({} to {last_frame}) at {} Hz, {} s; {} trajectories, {} of them without a name. Session {}.",
        page.format,
        page.n_frames,
        page.first_frame,
        short(page.rate_hz, 3),
        decimals(page.secs(page.n_frames as u64), 2),
        page.n_trajectories[0],
        page.n_trajectories[1],
        page.session.name,
    );
    let items: String = findings(page)
        .iter()
        .map(|f| format!("<li class=\"{}\">{}</li>\n", f.weight.class(), escape(&f.text)))
        .collect();
    format!(
        "<header class=\"top\">\n<p class=\"eyebrow\">Capture quality</p>\n<h1>{}</h1>\n<p class=\"lead\">{}</p>\n{}\
         <h3>What to look at</h3>\n<div class=\"card\"><ul class=\"findings\">\n{items}</ul></div>\n</header>\n",
        escape(page.capture),
        escape(&facts),
        figure_cards(&figures(page))
    )
}

fn figures(page: &QualityPage<'_>) -> Vec<Figure> {
    let figure = |label: &str, value: String, unit: &str, note: String| Figure {
        label: label.to_owned(),
        value,
        unit: unit.to_owned(),
        note,
    };
    let mm = |m: Option<f64>, n: usize| decimals(m.map_or(f64::NAN, |m| m * 1e3), n);
    let head = page.head;
    let n_trusted = head.markers.iter().filter(|m| m.trusted).count();
    let mut figures = vec![
        figure(
            "lock samples in the file",
            decimals(100.0 * page.seen, 1),
            "%",
            "of all lock markers times frames".to_owned(),
        ),
        figure(
            "head found to",
            mm(head.fit_residual_m, 2),
            "mm",
            format!("{n_trusted} of {} markers follow it", head.markers.len()),
        ),
        figure(
            "frames without a head pose",
            head.n_without_pose().to_string(),
            "",
            format!("of {}", page.n_frames),
        ),
    ];
    if let Some(clean) = page.clean {
        let worst = clean.gaps.iter().map(|g| g.expected_error_m).fold(f64::NAN, f64::max);
        figures.push(figure(
            "gaps filled",
            clean.n_gaps_filled().to_string(),
            "",
            if clean.gaps.is_empty() {
                String::new()
            } else {
                format!("the worst to {} mm", mm(Some(worst), 1))
            },
        ));
        figures.push(figure("exchanged labels mended", clean.swaps.len().to_string(), "", String::new()));
        figures.push(figure(
            "nameless pieces given back",
            clean.given_back.len().to_string(),
            "",
            format!("{} refused as ghosts", clean.ghosts.len()),
        ));
        figures.push(figure("spikes cut", clean.spikes.len().to_string(), "", String::new()));
    }
    figures
}

fn not_cleaned() -> String {
    "<section>\n<h2>The locks</h2>\n<p class=\"lead\">Nothing was cleaned: gaps, exchanged labels and ghosts are \
     as the file has them.</p>\n</section>\n"
        .to_owned()
}

fn notes(page: &QualityPage<'_>) -> String {
    let item = |text: String| format!("<li>{}</li>\n", escape(&text));
    let warnings: String = page.warnings.iter().cloned().map(item).collect();
    let assumed: String = page.assumed.iter().map(|a| item(a.to_string())).collect();
    let list = |title: &str, items: String| match items.as_str() {
        "" => format!("<h3>{title}</h3>\n<p class=\"note\">Nothing.</p>\n"),
        items => format!("<h3>{title}</h3>\n<ul class=\"note\">\n{items}</ul>\n"),
    };
    format!(
        "<section>\n<h2>The files</h2>\n<div class=\"card\">\n{}{}</div>\n</section>\n",
        list("Odd about the capture", warnings),
        list("Assumed, because nobody said", assumed)
    )
}
