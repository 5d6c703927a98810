//! Drags drawn at random on real captures: the short twin of `tousle bench direct`.

use std::path::Path;
use std::sync::LazyLock;
use tousle_bench::direct::{DirectBenchOptions, DirectBenchReport, run};
use tousle_core::NoProgress;

/// Drags on one capture, with one key and with several; the whole is three captures with more of each.
static REPORT: LazyLock<Option<DirectBenchReport>> = LazyLock::new(|| {
    let names = vec!["gusts_left".into()];
    bench(&DirectBenchOptions { names, n_drags: 5, n_several: 2, seed: 7 })
});

/// What the bench says; `None` where there are no captures, and then it says that.
fn bench(options: &DirectBenchOptions) -> Option<DirectBenchReport> {
    let Some(shared) = std::env::var_os("TOUSLE_SHARED") else {
        eprintln!("skipped: TOUSLE_SHARED is not set");
        return None;
    };
    let report = run(&Path::new(&shared).join("captures"), options, &NoProgress).expect("a bench");
    eprintln!("{}", report.report().to_text());
    Some(report)
}

/// Keys of drags with several, and how many of them are met.
fn several_keys(report: &DirectBenchReport) -> (usize, usize) {
    let keys: Vec<_> = report.several.iter().flat_map(|row| &row.keys).collect();
    (keys.len(), keys.iter().filter(|key| key.is_met()).count())
}

#[test]
fn drags_on_a_capture_meet_their_keys() {
    let Some(report) = &*REPORT else { return };
    for row in &report.rows {
        let solved = &row.solved;
        assert!(solved.residual_mm.1 <= 1.0 || solved.unreachable.is_some(), "{row:#?}");
        assert!(solved.effect.same_before && solved.effect.far_mm < 1.0, "{row:#?}");
    }
    let met = report.rows.iter().filter(|row| row.solved.residual_mm.1 <= 1.0).count();
    assert!(met >= 4, "{met} of 5 met");
}

/// Two drags each of one strand in time, of two strands at once, and of two neighbors: 95 % of the keys are met to 1 mm,
/// the others named, and no strand is more violent than it may be unless a key demands it.
#[test]
fn several_keys_on_a_capture_are_met_together() {
    let Some(report) = &*REPORT else { return };
    for row in &report.several {
        assert!(row.keys.iter().all(|key| key.is_met() || key.unreachable.is_some()), "{row:#?}");
        assert!(row.effect.same_before && row.effect.far_mm < 1.0, "{row:#?}");
        assert!(row.keys.len() > 1 && (!row.effect.is_violent() || row.effect.demanded), "{row:#?}");
    }
    let (n, met) = several_keys(report);
    assert!(report.several.len() == 6 && met * 100 >= n * 95, "{met} of {n} met");
}

/// Three captures, twenty drags with one key and ten of each kind with several: some minutes.
#[test]
#[ignore = "some minutes; `tousle bench direct` is the same"]
fn drags_on_three_captures_meet_their_keys_or_say_why_not() {
    let Some(report) = bench(&DirectBenchOptions::default()) else { return };
    let (n, met) =
        (report.rows.len(), report.rows.iter().filter(|row| row.solved.residual_mm.1 <= 1.0).count());
    assert!(met * 100 >= n * 95, "{met} of {n} met");
    let (n, met) = several_keys(&report);
    assert!(met * 100 >= n * 95, "{met} of {n} of several keys met");
}
