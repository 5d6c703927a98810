//! The bench of the 2008 method on the captures with truth beside them.

use std::path::Path;
use tousle_bench::paper::{PaperBenchOptions, TRUE_WIND, run};
use tousle_core::NoProgress;

/// One capture, every reading; `TOUSLE_BENCH_ALL` for all captures, whose tables go to stderr.
#[test]
fn every_reading_is_judged_beside_the_baselines() {
    let Some(shared) = std::env::var_os("TOUSLE_SHARED") else {
        eprintln!("skipped: TOUSLE_SHARED is not set");
        return;
    };
    let all = std::env::var_os("TOUSLE_BENCH_ALL").is_some();
    let captures = if all { Vec::new() } else { vec!["steady_front".to_owned()] };
    let options = PaperBenchOptions { captures, ..PaperBenchOptions::default() };
    let report = run(&Path::new(&shared).join("captures"), &options, &NoProgress).unwrap();
    eprintln!("{}", report.report().to_text());
    let of_one: Vec<&str> =
        report.rows.iter().filter(|r| r.capture == "steady_front").map(|r| r.wind.as_str()).collect();
    assert_eq!(of_one, ["first-frame", "sliding-window", "rest-pose", TRUE_WIND]);
    for row in &report.rows {
        assert_eq!(row.motion.missing_fraction, 0.0, "{row:?}");
        assert_eq!(row.motion.frames_beyond_prediction, 0, "{row:?}");
        assert_eq!(row.field.is_none(), row.wind == TRUE_WIND);
    }
    let pendulum = report.baselines.iter().filter(|b| b.predictor == "pendulum");
    assert_eq!(pendulum.count() * 4, report.rows.len());
    assert_eq!(report.motion_table().rows.len(), report.rows.len() / 4 * 7);
    let files = report.report().files("on 2 cores");
    let has = |name: &str, words: &str| files.iter().any(|(file, text)| file == name && text.contains(words));
    assert!(has("paper.html", "steady_front") && has("paper.json", "explained_motion"));
}
