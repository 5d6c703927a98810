use super::DemoPage;
use super::compass::{compass_svg, fan_list};
use crate::{Axis, Cell, Column, Plot, Series, SeriesStyle, Table, decimals, escape, short};
use std::fmt::Write;
use tousle_core::{HeadCapture, Session, StrandSpec, StrandTracks};

/// What was captured: facts, fans, the timeline of what the cameras saw, the head's pose, the locks.
pub(super) fn section(page: &DemoPage<'_>) -> String {
    let (capture, session) = (page.capture, page.session);
    format!(
        "<section id=\"captured\">\n<p class=\"eyebrow\">Capture</p>\n<h2>What was captured</h2>\n\
         <p class=\"lead\">{}</p>\n\
         <div class=\"columns\">\n<div class=\"card\"><h3>Fans</h3>\n{}{}</div>\n\
         <div class=\"card\"><h3>Session</h3>\n{}</div>\n</div>\n\
         <div class=\"card\"><h3>Markers seen</h3>\n\
         <p class=\"note\">One row a lock; darker where more of its markers were seen, a break where none was. \
         Click to go there.</p>\n\
         <div class=\"timeline\"><canvas id=\"timeline\" role=\"img\" aria-label=\"Visible markers of each lock \
         over time\"></canvas><span id=\"timeline-tip\" class=\"tip\" hidden></span></div>\n</div>\n\
         <div class=\"card\"><h3>The head's pose</h3>\n{}</div>\n\
         <details class=\"card\"><summary>The {} measured locks</summary>\n{}</details>\n</section>\n",
        escape(page.source),
        compass_svg(session),
        fan_list(session),
        facts(capture, session),
        pose_plot(capture).svg(),
        session.strands.len(),
        lock_table(capture, session).html(),
    )
}

fn facts(capture: &HeadCapture, session: &Session) -> String {
    let n_markers: usize = capture.strands.iter().map(|s| s.markers.len()).sum();
    let n_samples = n_markers * capture.n_frames();
    let n_seen: usize =
        capture.strands.iter().flat_map(|s| &s.markers).map(tousle_core::Track::n_valid).sum();
    let n_poses = capture.poses.iter().flatten().count();
    let last_frame = capture.first_frame + capture.n_frames() as i64 - 1;
    let mut rows = vec![
        ("session", session.name.clone()),
        ("locks", format!("{} with {n_markers} markers", capture.strands.len())),
        ("head markers", session.head_markers.len().to_string()),
        ("length", format!("{} s, {} frames", decimals(capture.duration_secs(), 2), capture.n_frames())),
        (
            "frames",
            format!("{} to {last_frame}, {} a second", capture.first_frame, short(capture.rate_hz, 3)),
        ),
        ("samples missing", percent_missing(n_seen, n_samples)),
        ("frames without a head pose", (capture.n_frames() - n_poses).to_string()),
    ];
    if let Some((first, last)) = session.still_frames {
        rows.push(("still", format!("frames {first} to {last}")));
    }
    let mut html = String::from("<dl class=\"facts\">\n");
    for (what, value) in rows {
        let _ = writeln!(html, "<dt>{what}</dt><dd>{}</dd>", escape(&value));
    }
    html.push_str("</dl>\n");
    html
}

fn percent_missing(n_seen: usize, n_samples: usize) -> String {
    let share = (n_samples - n_seen) as f64 / n_samples.max(1) as f64;
    format!("{} % ({} of {n_samples})", decimals(100.0 * share, 1), n_samples - n_seen)
}

/// How far the head's markers were from their places, frame by frame.
fn pose_plot(capture: &HeadCapture) -> Plot {
    // A curve of more points than a wide screen has pixels only costs bytes: the worst of each bunch is shown.
    let bunch = capture.n_frames().div_ceil(1_200).max(1);
    let points = capture.poses.chunks(bunch).enumerate().map(|(k, poses)| {
        let worst = poses.iter().flatten().map(|p| p.fit_residual_m * 1e3).fold(f64::NAN, f64::max);
        [(k * bunch) as f64 / capture.rate_hz, worst]
    });
    Plot {
        title: "Distance of the head's markers from their places over time".into(),
        x: Axis {
            label: "time".into(),
            unit: "s".into(),
            range: Some([0.0, capture.duration_secs()]),
            ..Axis::default()
        },
        y: Axis { label: "fit residual, rms".into(), unit: "mm".into(), ..Axis::default() },
        series: vec![Series { points: points.collect(), style: SeriesStyle::Area, ..Series::default() }],
        size_px: [920.0, 190.0],
    }
}

fn lock_table(capture: &HeadCapture, session: &Session) -> Table {
    let columns = vec![
        Column::text("lock"),
        Column::number("length", "mm"),
        Column::number("markers", ""),
        Column::number("width", "mm"),
        Column::number("density", "g/m"),
        Column::number("seen", ""),
    ];
    let rows = capture.strands.iter().filter_map(|tracks| {
        let spec = session.strands.get(tracks.strand_idx)?;
        Some(lock_row(spec, tracks, capture.n_frames()))
    });
    Table { caption: String::new(), columns, rows: rows.collect() }
}

fn lock_row(spec: &StrandSpec, tracks: &StrandTracks, n_frames: usize) -> Vec<Cell> {
    let n_seen: usize = tracks.markers.iter().map(tousle_core::Track::n_valid).sum();
    let n_samples = (tracks.markers.len() * n_frames).max(1);
    vec![
        Cell::Code(spec.name.clone()),
        Cell::Number(decimals(spec.length_m * 1e3, 0)),
        Cell::Number(tracks.markers.len().to_string()),
        Cell::Number(decimals(spec.lock_width_m * 1e3, 1)),
        Cell::Number(decimals(spec.linear_density_kg_per_m * 1e3, 2)),
        Cell::Share(n_seen as f64 / n_samples as f64),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_samples_are_counted() {
        assert_eq!(percent_missing(75, 100), "25.0 % (25 of 100)");
        assert_eq!(percent_missing(0, 0), "0.0 % (0 of 0)");
    }
}
