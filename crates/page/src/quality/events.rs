use super::QualityPage;
use crate::{Cell, Column, Mark, Table, Timeline, TimelineEvent, TimelineGroup, TimelineRow, decimals};
use tousle_clean::{CleanReport, FillMethod, GapFilled, MarkerTimeline};
use tousle_core::FrameSpan;

/// What cleaning found and did, over time and as lists.
pub(super) fn section(page: &QualityPage<'_>, clean: &CleanReport) -> String {
    let tables: String = [
        (swaps(clean), "No two markers had exchanged labels."),
        (given_back(clean), "No nameless trajectory was given back to a marker."),
        (ghosts(clean), "No nameless trajectory was refused."),
        (spikes(clean), "No spike was cut."),
        (far(clean), "No marker was farther from its lock's root than hair lets it be."),
    ]
    .iter()
    .map(
        |(table, none)| {
            if table.rows.is_empty() { format!("<p class=\"note\">{none}</p>\n") } else { table.html() }
        },
    )
    .collect();
    let gaps = gaps(page, clean);
    let n_gaps = clean.n_gaps_filled();
    format!(
        "<section>\n<p class=\"eyebrow\">Locks</p>\n<h2>What the cameras missed, and what was done</h2>\n\
         <p class=\"lead\">One row a marker, root to tip within each lock. Point at a mark to read what it is. \
         The still interval is shaded.</p>\n<div class=\"card\">\n{}{}</div>\n<div class=\"card\">\n{tables}</div>\n\
         <details class=\"card\"><summary>All {n_gaps} filled gaps, part by part</summary>\n<div class=\"scroll\">{}</div></details>\n\
         </section>\n",
        legend(&[
            (Mark::Good, "seen"),
            (Mark::Filled, "not seen, filled"),
            (Mark::Mended, "label exchanged, mended"),
            (Mark::GivenBack, "without a name, given back"),
            (Mark::Refused, "without a name or too far from its lock, refused"),
            (Mark::Hole, "not seen, could not be filled"),
            (Mark::Spike, "spike, cut"),
        ]),
        timeline(page, clean).svg(),
        gaps.html(),
    )
}

/// What the marks of a timeline mean.
pub(super) fn legend(entries: &[(Mark, &str)]) -> String {
    let shape = |mark: Mark| match mark {
        Mark::Spike => "<circle class=\"spike\" cx=\"9\" cy=\"5\" r=\"3.4\"/>".to_owned(),
        mark => format!("<rect class=\"{}\" y=\"2\" width=\"18\" height=\"6\"/>", mark.class()),
    };
    let entry = |(mark, what): &(Mark, &str)| {
        format!("<li><svg viewBox=\"0 0 18 10\" aria-hidden=\"true\">{}</svg>{what}</li>", shape(*mark))
    };
    format!("<ul class=\"legend\">{}</ul>\n", entries.iter().map(entry).collect::<String>())
}

/// The stretches of time that every row is seen against.
pub(super) fn shaded(page: &QualityPage<'_>) -> Vec<(FrameSpan, String)> {
    let still = page.session.still_frames.map(|(first_frame, last_frame)| {
        (FrameSpan { first_frame, last_frame }, "still, by the session".to_owned())
    });
    still.into_iter().collect()
}

fn timeline(page: &QualityPage<'_>, clean: &CleanReport) -> Timeline {
    let mut groups: Vec<TimelineGroup> = Vec::new();
    for marker in &clean.markers {
        if groups.last().is_none_or(|g| g.name != marker.strand) {
            groups.push(TimelineGroup { name: marker.strand.clone(), rows: Vec::new() });
        }
        if let Some(group) = groups.last_mut() {
            group.rows.push(row(marker, clean));
        }
    }
    if !clean.ghosts.is_empty() {
        groups.push(TimelineGroup { name: "ghosts".to_owned(), rows: ghost_rows(clean) });
    }
    Timeline {
        title: "Gaps, exchanged labels and given-back pieces of every marker over time".to_owned(),
        first_frame: page.first_frame,
        n_frames: page.n_frames,
        rate_hz: page.rate_hz,
        groups,
        shaded: shaded(page),
    }
}

fn row(marker: &MarkerTimeline, clean: &CleanReport) -> TimelineRow {
    let label = &marker.marker;
    let event = |span: &FrameSpan, mark, text: String| TimelineEvent { span: *span, mark, text };
    let mut events: Vec<TimelineEvent> =
        marker.seen.iter().map(|s| event(s, Mark::Good, "seen".to_owned())).collect();
    for gap in clean.gaps.iter().filter(|g| g.marker == *label) {
        events.push(event(&gap.span, Mark::Filled, filled(gap)));
    }
    for swap in clean.swaps.iter().filter(|s| s.markers.contains(label)) {
        let [a, b] = &swap.markers;
        let other = if a == label { b } else { a };
        let text = format!("exchanged with {other}, {} % sure", percent(swap.confidence));
        events.push(event(&swap.span, Mark::Mended, text));
    }
    for piece in clean.given_back.iter().filter(|p| p.marker == *label) {
        let text = format!("given back from {}, {} % sure", piece.piece, percent(piece.confidence));
        events.push(event(&piece.span, Mark::GivenBack, text));
    }
    for hole in clean.unfilled.iter().filter(|u| u.marker == *label) {
        events.push(event(&hole.span, Mark::Hole, hole.why.to_owned()));
    }
    for spike in clean.spikes.iter().filter(|s| s.marker == *label) {
        let text = format!("a spike of {} mm", millimeters(spike.height_m));
        events.push(event(&spike.span, Mark::Spike, text));
    }
    for far in clean.far.iter().filter(|f| f.marker == *label) {
        let text = format!("refused, {} mm from the lock's root", millimeters(far.distance_m));
        events.push(event(&far.span, Mark::Refused, text));
    }
    TimelineRow { label: label.clone(), events }
}

fn filled(gap: &GapFilled) -> String {
    format!(
        "filled {}, {} mm off as far as can be told",
        method_words(gap.method),
        millimeters(gap.expected_error_m)
    )
}

/// One row a nameless trajectory.
fn ghost_rows(clean: &CleanReport) -> Vec<TimelineRow> {
    let mut rows: Vec<TimelineRow> = Vec::new();
    for ghost in &clean.ghosts {
        if rows.last().is_none_or(|r| r.label != ghost.piece) {
            rows.push(TimelineRow { label: ghost.piece.clone(), events: Vec::new() });
        }
        let text = match &ghost.nearest_marker {
            Some(marker) => format!("refused; {marker} was nearest"),
            None => "refused; no marker was missing".to_owned(),
        };
        if let Some(row) = rows.last_mut() {
            row.events.push(TimelineEvent { span: ghost.span, mark: Mark::Refused, text });
        }
    }
    rows
}

fn method_words(method: FillMethod) -> &'static str {
    match method {
        FillMethod::Line => "by a line in head space",
        FillMethod::Cubic => "by a cubic in head space",
        FillMethod::Neighbors | FillMethod::NeighborsCubic => "from its neighbors on the lock",
        FillMethod::Lock | FillMethod::LockCubic => "from the lock's shape",
        _ => "by a model",
    }
}

fn swaps(clean: &CleanReport) -> Table {
    let row = |s: &tousle_clean::SwapMended| {
        vec![
            Cell::Code(s.markers.join(" ⇄ ")),
            frames(s.span),
            Cell::Number(millimeters(s.jump_m)),
            Cell::Number(percent(s.confidence)),
        ]
    };
    Table {
        caption: "Exchanged labels, mended".to_owned(),
        columns: vec![
            Column::text("markers"),
            Column::number("frames", ""),
            Column::number("jump", "mm"),
            Column::number("sure", "%"),
        ],
        rows: clean.swaps.iter().map(row).collect(),
    }
}

fn given_back(clean: &CleanReport) -> Table {
    let row = |p: &tousle_clean::PieceGivenBack| {
        vec![
            Cell::Code(p.piece.clone()),
            Cell::Code(p.marker.clone()),
            frames(p.span),
            Cell::Number(millimeters(p.distance_m)),
            Cell::Number(millimeters(p.expected_m)),
            Cell::Number(percent(p.confidence)),
        ]
    };
    Table {
        caption: "Nameless pieces, given back".to_owned(),
        columns: vec![
            Column::text("piece"),
            Column::text("is"),
            Column::number("frames", ""),
            Column::number("off the lock's word by", "mm"),
            Column::number("usually", "mm"),
            Column::number("sure", "%"),
        ],
        rows: clean.given_back.iter().map(row).collect(),
    }
}

fn ghosts(clean: &CleanReport) -> Table {
    let row = |g: &tousle_clean::GhostRefused| {
        vec![
            Cell::Code(g.piece.clone()),
            frames(g.span),
            Cell::Code(g.nearest_marker.clone().unwrap_or_else(|| "–".to_owned())),
            Cell::Number(percent(g.confidence)),
        ]
    };
    Table {
        caption: "Nameless pieces, refused".to_owned(),
        columns: vec![
            Column::text("piece"),
            Column::number("frames", ""),
            Column::text("nearest missing marker"),
            Column::number("sure", "%"),
        ],
        rows: clean.ghosts.iter().map(row).collect(),
    }
}

fn spikes(clean: &CleanReport) -> Table {
    let row = |s: &tousle_clean::SpikeCut| {
        vec![
            Cell::Code(s.marker.clone()),
            frames(s.span),
            Cell::Number(millimeters(s.height_m)),
            Cell::Number(percent(s.confidence)),
        ]
    };
    Table {
        caption: "Spikes, cut".to_owned(),
        columns: vec![
            Column::text("marker"),
            Column::number("frames", ""),
            Column::number("height", "mm"),
            Column::number("sure", "%"),
        ],
        rows: clean.spikes.iter().map(row).collect(),
    }
}

fn far(clean: &CleanReport) -> Table {
    let row = |f: &tousle_clean::FarRefused| {
        vec![
            Cell::Code(f.marker.clone()),
            frames(f.span),
            Cell::Number(millimeters(f.distance_m)),
            Cell::Number(millimeters(f.reach_m)),
        ]
    };
    Table {
        caption: "Markers too far from their lock's root, left out".to_owned(),
        columns: vec![
            Column::text("marker"),
            Column::number("frames", ""),
            Column::number("from the root", "mm"),
            Column::number("at most", "mm"),
        ],
        rows: clean.far.iter().map(row).collect(),
    }
}

fn gaps(page: &QualityPage<'_>, clean: &CleanReport) -> Table {
    let row = |g: &GapFilled| {
        vec![
            Cell::Code(g.marker.clone()),
            frames(g.span),
            Cell::Number(decimals(page.secs(g.span.n_frames()), 2)),
            Cell::Text(method_words(g.method).to_owned()),
            Cell::Number(millimeters(g.expected_error_m)),
            Cell::Number(g.trials.to_string()),
        ]
    };
    Table {
        caption:
            "A gap is filled part by part, as its neighbors are seen or not. The expected error is that of the same fill at other times, where the marker was seen; without \
                  trials it is the worst of all others."
                .to_owned(),
        columns: vec![
            Column::text("marker"),
            Column::number("frames", ""),
            Column::number("length", "s"),
            Column::text("filled"),
            Column::number("expected error", "mm"),
            Column::number("trials", ""),
        ],
        rows: clean.gaps.iter().map(row).collect(),
    }
}

pub(super) fn frames(span: FrameSpan) -> Cell {
    Cell::Number(match span.n_frames() {
        1 => span.first_frame.to_string(),
        _ => format!("{}–{}", span.first_frame, span.last_frame),
    })
}

pub(super) fn millimeters(m: f64) -> String {
    decimals(m * 1e3, 1)
}

/// A probability, never rounded up to certainty.
fn percent(probability: f64) -> String {
    if (0.999..1.0).contains(&probability) { "> 99.9".to_owned() } else { decimals(100.0 * probability, 1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn certainty_is_not_rounded_into_being() {
        assert_eq!(percent(0.99997), "> 99.9");
        assert_eq!(percent(0.93), "93.0");
        assert_eq!(frames(FrameSpan { first_frame: 3, last_frame: 3 }), Cell::Number("3".to_owned()));
    }
}
