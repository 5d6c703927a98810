//! The quality report of a capture: on the terminal, as JSON, as a page.

use super::{check_outputs, ending};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use tousle_core::FrameSpan;
use tousle_page::{QualityPage, quality_page};
use tousle_pipeline::{Outputs, Prepared, QualityReport};

/// Refuses report files that are neither a page nor JSON, or cannot be written, before any work is done.
pub fn check_reports(paths: &[PathBuf], inputs: &[&Path]) -> anyhow::Result<()> {
    check_outputs(paths, &["html", "json"], inputs)
}

/// Writes the quality report to each path, as its ending asks, to all or to none.
pub fn write_reports(paths: &[PathBuf], capture: &Path, prepared: &Prepared) -> anyhow::Result<()> {
    let mut outputs = Outputs::default();
    add_reports(&mut outputs, paths, capture, prepared)?;
    Ok(outputs.appear()?)
}

/// The same, together with other files.
pub fn add_reports(
    outputs: &mut Outputs,
    paths: &[PathBuf],
    capture: &Path,
    prepared: &Prepared,
) -> anyhow::Result<()> {
    for path in paths {
        let bytes = match ending(path).as_str() {
            "json" => serde_json::to_vec_pretty(&prepared.quality)?,
            _ => page(capture, prepared).into_bytes(),
        };
        outputs.add(path, |out| std::io::Write::write_all(out, &bytes))?;
    }
    Ok(())
}

fn page(capture: &Path, prepared: &Prepared) -> String {
    let quality = &prepared.quality;
    let name = capture.file_name().unwrap_or(capture.as_os_str()).to_string_lossy();
    quality_page(&QualityPage {
        capture: &name,
        format: &quality.capture.format,
        rate_hz: quality.capture.rate_hz,
        first_frame: quality.capture.first_frame,
        n_frames: quality.capture.n_frames,
        n_trajectories: [quality.capture.n_trajectories, quality.capture.n_unlabeled],
        seen: quality.capture.seen,
        session: &prepared.session,
        warnings: &quality.ingest.warnings,
        assumed: &quality.assumed,
        head: &quality.head,
        clean: quality.clean.as_ref(),
    })
}

/// Spans of frames that are told one by one.
const MOST_LINES: usize = 10;

/// What a technician wants to know at once.
pub fn summary(report: &QualityReport) -> String {
    let mut text = String::new();
    let capture = &report.capture;
    let mut line = |label: &str, words: String| {
        let _ = writeln!(text, "{label:>10}  {words}");
    };
    line(
        "capture",
        format!(
            "{}, {} frames at {} Hz ({:.2} s), {} trajectories ({} unlabeled), {:.1} % of lock samples seen",
            capture.format,
            capture.n_frames,
            capture.rate_hz,
            capture.duration_secs,
            capture.n_trajectories,
            capture.n_unlabeled,
            100.0 * capture.seen
        ),
    );
    line("head", head_line(report));
    let gaps = &report.head.without_pose;
    for gap in gaps.iter().take(MOST_LINES) {
        let bridged = match gap.bridged_to_m {
            Some(0.0) => "; it stands still".to_owned(),
            Some(m) => format!("; told from those around, to {:.1} mm", m * 1e3),
            None => String::new(),
        };
        let FrameSpan { first_frame, last_frame } = gap.span;
        line("no pose", format!("frames {first_frame} to {last_frame}: {}{bridged}", gap.why));
    }
    if let Some(more @ 1..) = gaps.len().checked_sub(MOST_LINES) {
        line("no pose", format!("in {more} more spans of frames (--json and reports have them all)"));
    }
    for mended in &report.head.labels_mended {
        let span = mended.span;
        let words = format!(
            "head marker {} had the label {} in frames {} to {}",
            mended.marker, mended.label, span.first_frame, span.last_frame
        );
        line("mended", words);
    }
    match &report.clean {
        Some(clean) => line("cleaned", clean_line(clean)),
        None => line("cleaned", "nothing: the locks are as the file has them".to_owned()),
    }
    for assumption in &report.assumed {
        line("assumed", assumption.to_string());
    }
    text
}

fn head_line(report: &QualityReport) -> String {
    let head = &report.head;
    let trusted = head.markers.iter().filter(|m| m.trusted).count();
    let mut words = format!("{trusted} of {} markers follow it", head.markers.len());
    let never_seen = head.markers.iter().filter(|m| m.is_never_seen());
    let left_out = head.markers.iter().filter(|m| m.is_left_out());
    let labels = [
        ("left out", left_out.map(|m| m.label.as_str()).collect::<Vec<_>>()),
        ("never seen", never_seen.map(|m| m.label.as_str()).collect()),
    ];
    for (what, labels) in labels.iter().filter(|(_, labels)| !labels.is_empty()) {
        let _ = write!(words, " ({what}: {})", labels.join(", "));
    }
    if let Some(residual_m) = head.fit_residual_m {
        let _ = write!(words, ", fit residual {:.2} mm", residual_m * 1e3);
    }
    let _ = write!(words, ", {}", if head.pose_track.moves { "moves" } else { "still" });
    words
}

fn clean_line(clean: &tousle_clean::CleanReport) -> String {
    let mut words = format!(
        "{} swaps mended, {} pieces given back, {} ghosts refused, {} spikes cut, {} gaps filled",
        clean.swaps.len(),
        clean.given_back.len(),
        clean.ghosts.len(),
        clean.spikes.len(),
        clean.n_gaps_filled()
    );
    let worst = clean.gaps.iter().map(|g| g.expected_error_m).fold(f64::NAN, f64::max);
    if worst.is_finite() {
        let _ = write!(words, " (the worst to {:.1} mm)", worst * 1e3);
    }
    let n_far: u64 = clean.far.iter().map(|far| far.span.n_frames()).sum();
    if n_far > 0 {
        let _ = write!(words, ", {n_far} samples too far from their locks left out");
    }
    if !clean.unfilled.is_empty() {
        let _ = write!(words, ", {} gaps left", clean.unfilled.len());
    }
    words
}
