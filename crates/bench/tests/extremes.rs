//! The list of stiff and extreme cases: what we recommend holds in each, and what does not hold is refused.

use rayon::prelude::*;
use tousle_bench::Way;
use tousle_bench::extremes::{Case, Verdict, cases, judge, judge_refusals};

/// Every case at every step, by every integrator that has no limit.
#[test]
fn nothing_explodes() {
    let ways: Vec<Way> = Way::all().into_iter().filter(|way| !way.integrator.is_limited()).collect();
    let flaw = |case: &Case, way: &Way| {
        let verdict = judge(case, *way);
        (!verdict.is_sound()).then(|| format!("{}, {}: {verdict}", case.name, way.name()))
    };
    let flaws_of = |case: &Case| ways.iter().filter_map(|way| flaw(case, way)).collect::<Vec<_>>();
    let flaws: Vec<String> = cases().par_iter().flat_map_iter(flaws_of).collect();
    assert!(flaws.is_empty(), "{}", flaws.join("\n"));
}

#[test]
fn what_cannot_be_is_refused() {
    for way in Way::all() {
        assert_eq!(judge_refusals(way), Verdict::Holds { deep: None }, "{}", way.name());
    }
}
