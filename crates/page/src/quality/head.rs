use super::QualityPage;
use super::events::{legend, shaded};
use crate::{
    Axis, Cell, Column, Mark, Plot, Series, SeriesStyle, Table, Timeline, TimelineEvent, TimelineGroup,
    TimelineRow, decimals, escape,
};
use tousle_core::FrameSpan;
use tousle_head::MarkerReport;

/// How well the head was found, frame by frame and marker by marker.
pub(super) fn section(page: &QualityPage<'_>) -> String {
    format!(
        "<section>\n<p class=\"eyebrow\">Head</p>\n<h2>How well the head was found</h2>\n\
         <p class=\"lead\">{}</p>\n<div class=\"card\">\n<h3>Distance of the markers from their places</h3>\n{}\
         <h3>Head markers seen and used</h3>\n{}</div>\n<div class=\"card\">\n{}{}{}</div>\n</section>\n",
        escape(&lead(page)),
        residuals(page).svg(),
        counts(page).svg(),
        legend(&[
            (Mark::Good, "used"),
            (Mark::Refused, "seen, not used"),
            (Mark::Mended, "found under another label"),
            (Mark::Hole, "not seen"),
        ]),
        timeline(page).svg(),
        table(page).html(),
    )
}

fn lead(page: &QualityPage<'_>) -> String {
    let head = page.head;
    let track = &head.pose_track;
    let motion = if track.moves { "The head moves" } else { "The head stands still" };
    let without = match head.n_without_pose() {
        0 => "every frame has a pose".to_owned(),
        n => format!("{n} frames have no pose, and only the track bridges them"),
    };
    format!(
        "{motion}; {without}. Smoothing over {} ms took {} mm and {} mrad away.",
        decimals(track.window_secs * 1e3, 0),
        decimals(track.smoothing_m * 1e3, 2),
        decimals(track.smoothing_rad * 1e3, 2),
    )
}

fn residuals(page: &QualityPage<'_>) -> Plot {
    let points = page.head.frames.residual_m.iter().enumerate();
    let points = points.map(|(f, r)| [frame(page, f), r.map_or(f64::NAN, |r| r * 1e3)]);
    Plot {
        title: "Head residual in each frame".to_owned(),
        x: frames_axis(page),
        y: Axis { label: "rms".to_owned(), unit: "mm".to_owned(), ..Axis::default() },
        series: vec![Series { points: thinned(points.collect()), ..Series::default() }],
        size_px: [1020.0, 170.0],
    }
}

fn counts(page: &QualityPage<'_>) -> Plot {
    let series = |name: &str, counts: &[usize], style| Series {
        name: name.to_owned(),
        points: thinned(counts.iter().enumerate().map(|(f, n)| [frame(page, f), *n as f64]).collect()),
        style,
        ..Series::default()
    };
    let frames = &page.head.frames;
    Plot {
        title: "Head markers seen and used in each frame".to_owned(),
        x: frames_axis(page),
        y: Axis { label: "markers".to_owned(), ..Axis::default() },
        series: vec![
            series("used", &frames.n_used, SeriesStyle::Area),
            series("seen", &frames.n_visible, SeriesStyle::Line),
        ],
        size_px: [1020.0, 150.0],
    }
}

fn frame(page: &QualityPage<'_>, idx: usize) -> f64 {
    page.first_frame as f64 + idx as f64
}

fn frames_axis(page: &QualityPage<'_>) -> Axis {
    let range = [frame(page, 0), frame(page, page.n_frames.max(2) - 1)];
    Axis { label: "frame".to_owned(), range: Some(range), ..Axis::default() }
}

/// At most some thousand points: of each run of frames the lowest and the highest, so that no outlier is lost,
/// and none where a frame of it has no value, so that no hole is.
fn thinned(points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    const MOST: usize = 3000;
    if points.len() <= MOST {
        return points;
    }
    let run = points.len().div_ceil(MOST / 2);
    let ends = |run: &[[f64; 2]]| {
        let hole = run.iter().find(|p| !p[1].is_finite());
        let low = hole.or_else(|| run.iter().min_by(|a, b| a[1].total_cmp(&b[1])));
        let high = hole.or_else(|| run.iter().max_by(|a, b| a[1].total_cmp(&b[1])));
        let mut ends: Vec<[f64; 2]> = low.into_iter().chain(high).copied().collect();
        ends.sort_by(|a, b| a[0].total_cmp(&b[0]));
        ends
    };
    points.chunks(run).flat_map(ends).collect()
}

fn timeline(page: &QualityPage<'_>) -> Timeline {
    let whole = FrameSpan::of(page.first_frame, &(0..page.n_frames));
    let group = |marker: &MarkerReport| {
        let event =
            |span: &FrameSpan, mark, text: &str| TimelineEvent { span: *span, mark, text: text.to_owned() };
        let mut events = vec![event(&whole, Mark::Good, "used")];
        events.extend(
            marker.left_out.iter().map(|s| event(s, Mark::Refused, "seen, not where the head has it")),
        );
        events.extend(marker.missing.iter().map(|s| event(s, Mark::Hole, "not seen")));
        for mended in page.head.labels_mended.iter().filter(|m| m.marker == marker.label) {
            let text = format!("found under the label {}", mended.label);
            events.push(event(&mended.span, Mark::Mended, &text));
        }
        let row = TimelineRow { label: marker.label.clone(), events };
        TimelineGroup { name: marker.label.clone(), rows: vec![row] }
    };
    let mut groups: Vec<TimelineGroup> = page.head.markers.iter().map(group).collect();
    if !page.head.without_pose.is_empty() {
        let event = |gap: &tousle_head::PoseGap| TimelineEvent {
            span: gap.span,
            mark: Mark::Hole,
            text: format!("no pose, {}", gap.why),
        };
        let events = page.head.without_pose.iter().map(event).collect();
        let row = TimelineRow { label: "pose".to_owned(), events };
        groups.push(TimelineGroup { name: "no pose".to_owned(), rows: vec![row] });
    }
    Timeline {
        title: "Head markers over time".to_owned(),
        first_frame: page.first_frame,
        n_frames: page.n_frames,
        rate_hz: page.rate_hz,
        groups,
        shaded: shaded(page),
    }
}

fn used(marker: &MarkerReport) -> &'static str {
    match (marker.is_never_seen(), marker.is_left_out()) {
        (true, _) => "no: it was never seen",
        (false, true) => "no: it does not follow the head",
        (false, false) => "yes",
    }
}

fn table(page: &QualityPage<'_>) -> Table {
    let row = |m: &MarkerReport| {
        vec![
            Cell::Code(m.label.clone()),
            Cell::Share(m.seen),
            Cell::Share(m.agreed),
            Cell::Text(used(m).to_owned()),
            Cell::Number(decimals(m.correction_m * 1e3, 1)),
        ]
    };
    Table {
        caption: String::new(),
        columns: vec![
            Column::text("marker"),
            Column::number("seen", ""),
            Column::number("where the head has it", ""),
            Column::text("used"),
            Column::number("measured wrong by", "mm"),
        ],
        rows: page.head.markers.iter().map(row).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_outliers_and_holes() {
        let mut points: Vec<[f64; 2]> = (0..100_000).map(|k| [f64::from(k), 1.0]).collect();
        points[54_321][1] = 9.0;
        points[70_000][1] = f64::NAN;
        let thin = thinned(points);
        assert!(thin.len() <= 3000);
        assert!(thin.contains(&[54_321.0, 9.0]));
        assert!(thin.iter().any(|p| p[1].is_nan()));
    }
}
