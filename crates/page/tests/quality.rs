//! The quality page: everything that was found is on it, it needs no other file, and labels stay text.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use tousle_clean::{
    CleanReport, FarRefused, FillMethod, GapFilled, GhostRefused, MarkerTimeline, PieceGivenBack, SpikeCut,
    SwapMended, Unfilled,
};
use tousle_core::{FrameSpan, Session};
use tousle_head::{FrameQuality, HeadReport, LabelMended, MarkerReport, PoseGap, PoseTrackReport};
use tousle_page::{QualityPage, quality_page};

fn span(first_frame: i64, last_frame: i64) -> FrameSpan {
    FrameSpan { first_frame, last_frame }
}

fn session() -> Session {
    Session { still_frames: Some((101, 120)), ..Session::unknown("a wig") }
}

fn head() -> HeadReport {
    let marker = |label: &str, trusted| MarkerReport {
        label: label.to_owned(),
        seen: 0.9,
        agreed: 0.5,
        trusted,
        correction_m: 1.2e-3,
        missing: vec![span(140, 149)],
        left_out: Vec::new(),
    };
    let residual = |f: usize| (!(40..50).contains(&f)).then_some(3e-4);
    HeadReport {
        markers: vec![
            marker("LFHD", true),
            marker("LNCK", false),
            MarkerReport { seen: 0.0, agreed: 0.0, ..marker("JAW", false) },
        ],
        without_pose: vec![PoseGap {
            span: span(141, 150),
            n_visible: 2,
            why: "too few",
            bridged_to_m: None,
        }],
        labels_mended: vec![LabelMended {
            label: "LFHD".to_owned(),
            marker: "NOSE".to_owned(),
            span: span(160, 170),
        }],
        frames: FrameQuality {
            residual_m: (0..100).map(residual).collect(),
            n_used: vec![6; 100],
            n_visible: vec![8; 100],
        },
        fit_residual_m: Some(3e-4),
        noise_m: None,
        pose_track: PoseTrackReport {
            frames_bridged: 10,
            moves: true,
            window_secs: 0.1,
            smoothing_m: 1e-4,
            smoothing_rad: 2e-3,
        },
    }
}

fn clean() -> CleanReport {
    let marker = |label: &str| MarkerTimeline {
        strand: "S<1>".to_owned(),
        marker: label.to_owned(),
        noise_m: Some(1e-4),
        shape_residual_m: None,
        seen: vec![span(101, 150)],
        mended: vec![span(151, 155)],
        given_back: Vec::new(),
        filled: vec![span(156, 200)],
    };
    let gap = |first, last, expected_error_m| GapFilled {
        strand: "S<1>".to_owned(),
        marker: "S1_1".to_owned(),
        span: span(first, last),
        method: FillMethod::Lock,
        expected_error_m,
        trials: 9,
        shortened_frames: 0,
    };
    CleanReport {
        far: vec![FarRefused {
            strand: "S<1>".to_owned(),
            marker: "S1_1".to_owned(),
            span: span(120, 124),
            distance_m: 4.7,
            reach_m: 0.1,
        }],
        spikes: vec![SpikeCut {
            marker: "S1_2".to_owned(),
            span: span(130, 130),
            height_m: 0.03,
            confidence: 0.9,
        }],
        swaps: vec![SwapMended {
            markers: ["S1_1".to_owned(), "S1_2".to_owned()],
            span: span(151, 155),
            jump_m: 0.02,
            confidence: 0.99999,
        }],
        given_back: vec![PieceGivenBack {
            piece: "*7".to_owned(),
            marker: "S1_2".to_owned(),
            span: span(160, 165),
            distance_m: 1e-3,
            expected_m: 1e-3,
            confidence: 0.97,
        }],
        ghosts: vec![GhostRefused {
            piece: "*8".to_owned(),
            span: span(110, 112),
            nearest_marker: None,
            confidence: 1.0,
        }],
        gaps: vec![gap(156, 180, 2e-3), gap(181, 200, 9e-3)],
        unfilled: vec![Unfilled { marker: "S1_3".to_owned(), span: span(101, 200), why: "never seen" }],
        markers: vec![marker("S1_1"), marker("S1_2"), marker("S1_3")],
    }
}

fn page(clean: Option<&CleanReport>) -> String {
    quality_page(&QualityPage {
        capture: "a<b.c3d",
        format: "c3d",
        rate_hz: 100.0,
        first_frame: 101,
        n_frames: 100,
        n_trajectories: [12, 2],
        seen: 0.925,
        session: &session(),
        warnings: &["odd <script>".to_owned()],
        assumed: &[],
        head: &head(),
        clean,
    })
}

#[test]
fn everything_that_was_found_is_on_the_page() {
    let html = page(Some(&clean()));
    for words in [
        "No head pose in frames 141 to 150 (0.1 s): too few.",
        "Head marker NOSE carried the label LFHD in frames 160 to 170",
        "LNCK did not follow the head and was not used",
        "No camera saw the head&#39;s JAW: the pose is told by the others.",
        "no: it was never seen",
        "Could not be filled: S1_3 (never seen).",
        "Filled, but expected to be more than 7 mm off in part: S1_1.",
        "S1_1 and S1_2 had exchanged labels in frames 151 to 155 (0.05 s); mended.",
        "The longest gap is S1_3&#39;s, frames 156 to 200 (0.45 s)",
        "S1_1: filled from the lock&#39;s shape, 9.0 mm off as far as can be told, frames 181 to 200",
        "S1_2: given back from *7, 97.0 % sure, frames 160 to 165",
        "*8: refused; no marker was missing, frames 110 to 112",
        "S1_2: a spike of 30.0 mm, frame 130",
        "S1_1: refused, 4700.0 mm from the lock&#39;s root, frames 120 to 124",
        "1 run too far off",
        "&gt; 99.9",
    ] {
        assert!(html.contains(words), "{words}\n{html}");
    }
    let serious = html.find("class=\"serious\"").unwrap();
    assert!(serious < html.find("class=\"changed\"").unwrap(), "the worst comes first");
}

#[test]
fn labels_stay_text_and_nothing_is_loaded() {
    let html = page(Some(&clean()));
    assert!(
        html.contains("a&lt;b.c3d") && html.contains("S&lt;1&gt;") && html.contains("odd &lt;script&gt;")
    );
    assert!(!html.contains("<script") && !html.contains("src=") && !html.contains("NaN"), "{html}");
}

#[test]
fn without_cleaning_the_page_says_so() {
    let html = page(None);
    assert!(html.contains("Nothing was cleaned") && html.contains("How well the head was found"));
}
