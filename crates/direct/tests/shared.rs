//! Drags drawn at random on real captures: the short twin of `tousle bench direct`.

use std::path::Path;
use tousle_bench::direct::{DirectBenchOptions, run};
use tousle_core::NoProgress;

/// Five drags on one capture; the whole is three captures with twenty each.
#[test]
fn drags_on_a_capture_meet_their_keys() {
    let Some(shared) = std::env::var_os("TOUSLE_SHARED") else {
        eprintln!("skipped: TOUSLE_SHARED is not set");
        return;
    };
    let options = DirectBenchOptions { names: vec!["gusts_left".into()], n_drags: 5, ..Default::default() };
    let report = run(&Path::new(&shared).join("captures"), &options, &NoProgress).expect("a bench");
    eprintln!("{}", report.to_text());
    for row in &report.rows {
        let solved = &row.solved;
        assert!(solved.residual_mm.1 <= 1.0 || solved.unreachable.is_some(), "{row:#?}");
        assert!(solved.same_before && solved.far_mm < 1.0, "{row:#?}");
    }
    let met = report.rows.iter().filter(|row| row.solved.residual_mm.1 <= 1.0).count();
    assert!(met >= 4, "{met} of 5 met");
}

/// Three captures, twenty drags each: some minutes.
#[test]
#[ignore = "some minutes; `tousle bench direct` is the same"]
fn drags_on_three_captures_meet_their_keys_or_say_why_not() {
    let Some(shared) = std::env::var_os("TOUSLE_SHARED") else {
        eprintln!("skipped: TOUSLE_SHARED is not set");
        return;
    };
    let options = DirectBenchOptions::default();
    let report = run(&Path::new(&shared).join("captures"), &options, &NoProgress).expect("a bench");
    eprintln!("{}", report.to_text());
    let (n, met) =
        (report.rows.len(), report.rows.iter().filter(|row| row.solved.residual_mm.1 <= 1.0).count());
    assert!(met * 100 >= n * 95, "{met} of {n} met");
}
