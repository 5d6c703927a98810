use super::QualityPage;
use super::events::millimeters;
use crate::{Cell, Column, Table, decimals};
use tousle_clean::{CleanReport, MarkerTimeline};
use tousle_core::FrameSpan;

/// How well each lock was seen.
pub(super) fn section(page: &QualityPage<'_>, clean: &CleanReport) -> String {
    format!(
        "<section>\n<p class=\"eyebrow\">Locks</p>\n<h2>Lock by lock</h2>\n\
         <p class=\"lead\">Which locks the cameras see badly, and how far their markers do what the rest of the \
         lock says.</p>\n<div class=\"card\">\n{}</div>\n</section>\n",
        table(page, clean).html()
    )
}

fn table(page: &QualityPage<'_>, clean: &CleanReport) -> Table {
    let of_locks = clean.markers.chunk_by(|a, b| a.strand == b.strand);
    Table {
        caption: "Noise is that of one coordinate; the shape residual is how far a marker is from where its \
                  neighbors put it, as a root mean square."
            .to_owned(),
        columns: vec![
            Column::text("lock"),
            Column::number("seen", ""),
            Column::number("longest gap", "s"),
            Column::number("worst fill", "mm"),
            Column::number("noise", "mm"),
            Column::number("shape residual", "mm"),
            Column::text("changed"),
        ],
        rows: of_locks.map(|markers| row(page, clean, markers)).collect(),
    }
}

fn row(page: &QualityPage<'_>, clean: &CleanReport, markers: &[MarkerTimeline]) -> Vec<Cell> {
    let frames = |spans: &[FrameSpan]| spans.iter().map(FrameSpan::n_frames).sum::<u64>();
    let seen: u64 = markers.iter().map(|m| frames(&m.seen) + frames(&m.mended) + frames(&m.given_back)).sum();
    let all = (markers.len() * page.n_frames).max(1);
    let longest = markers.iter().flat_map(|m| &m.filled).map(FrameSpan::n_frames).max();
    let is_here = |label: &str| markers.iter().any(|m| m.marker == label);
    let fills = clean.gaps.iter().filter(|g| is_here(&g.marker)).map(|g| g.expected_error_m);
    let rms = |of: fn(&MarkerTimeline) -> Option<f64>| {
        let squares: Vec<f64> = markers.iter().filter_map(of).map(|x| x * x).collect();
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        decimals(mean.sqrt() * 1e3, 2)
    };
    vec![
        Cell::Code(markers.first().map_or_else(String::new, |m| m.strand.clone())),
        Cell::Share(seen as f64 / all as f64),
        Cell::Number(longest.map_or_else(|| "–".to_owned(), |n| decimals(page.secs(n), 2))),
        Cell::Number(millimeters(fills.fold(f64::NAN, f64::max))),
        Cell::Number(rms(|m| m.noise_m)),
        Cell::Number(rms(|m| m.shape_residual_m)),
        Cell::Text(changes(clean, is_here)),
    ]
}

fn changes(clean: &CleanReport, is_here: impl Fn(&str) -> bool) -> String {
    let counts = [
        ("swap", "swaps", clean.swaps.iter().filter(|s| s.markers.iter().any(|m| is_here(m))).count()),
        ("piece", "pieces", clean.given_back.iter().filter(|p| is_here(&p.marker)).count()),
        ("run too far off", "runs too far off", clean.far.iter().filter(|f| is_here(&f.marker)).count()),
        ("spike", "spikes", clean.spikes.iter().filter(|s| is_here(&s.marker)).count()),
    ];
    let words = counts.iter().filter(|(_, _, n)| *n > 0);
    words
        .map(|(one, many, n)| format!("{n} {}", if *n == 1 { one } else { many }))
        .collect::<Vec<_>>()
        .join(", ")
}
