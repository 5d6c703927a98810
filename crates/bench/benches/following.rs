//! How many points a second strands that follow guides make, beside what it costs to simulate them (`stepping`).
//!
//!     cargo bench -p tousle-bench --bench following
//!
//! The strands, the body and the gusts of `stepping`, every twentieth strand a guide; 60 steps and frames a second, single
//! precision. An item is one point in one frame.

use divan::Bencher;
use divan::counter::ItemsCount;
use std::sync::LazyLock;
use tousle_bench::worlds::{gusts, mannequin, wig};
use tousle_core::{Groom, NoProgress, Pose, StrandMotion};
use tousle_field::FieldSequence;
use tousle_guide::Guides;
use tousle_rod::Surface;
use tousle_sim::{Method, Precision, SimOptions, TimeMode, simulate};

fn main() {
    divan::main();
}

const N_POINTS: usize = 16;
const STRANDS_PER_GUIDE: usize = 20;
const RATE_HZ: f64 = 60.0;
const N_FRAMES: usize = 120;
static WIND: LazyLock<FieldSequence> = LazyLock::new(gusts);

const RUNS: [Run; 4] = [
    Run { strands: 10_000, threads: 1 },
    Run { strands: 10_000, threads: 2 },
    Run { strands: 100_000, threads: 1 },
    Run { strands: 100_000, threads: 2 },
];

#[derive(Clone, Copy, Debug)]
struct Run {
    strands: usize,
    threads: usize,
}

impl std::fmt::Display for Run {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} strands, {} threads", self.strands, self.threads)
    }
}

/// A groom, its guides and how these move.
struct Led {
    groom: Groom,
    guides: Guides,
    motion: StrandMotion,
}

fn led(run: Run) -> Led {
    let groom = wig(run.strands, N_POINTS);
    let guides = tousle_guide::choose(&groom, run.strands / STRANDS_PER_GUIDE).expect("guides");
    let motion = blown(&guides.groom(&groom));
    Led { groom, guides, motion }
}

fn blown(groom: &Groom) -> StrandMotion {
    let options = SimOptions {
        rate_hz: RATE_HZ,
        dt_secs: Some(1.0 / RATE_HZ),
        duration_secs: Some((N_FRAMES - 1) as f64 / RATE_HZ),
        time: TimeMode::Loop,
        precision: Precision::Single,
        ..SimOptions::of(Method::Physical)
    };
    simulate(&WIND, &mannequin(), groom, &options, &NoProgress).expect("a sound world").motion
}

/// Times what `work` makes; that it is thrown away is not timed.
fn measure<T: Send>(bencher: Bencher<'_, '_>, run: Run, mut work: impl FnMut() -> T + Send) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(run.threads).build().expect("a pool");
    let items = (run.strands * N_POINTS * N_FRAMES) as u64;
    bencher.counter(ItemsCount::new(items)).bench_local(|| pool.install(&mut work));
}

/// The turns of guides given to all.
#[divan::bench(args = RUNS, max_time = 4, min_time = 1)]
fn follow(bencher: Bencher<'_, '_>, run: Run) {
    let Led { groom, guides, motion } = led(run);
    measure(bencher, run, || followed(&groom, &guides, &motion));
}

fn followed(groom: &Groom, guides: &Guides, motion: &StrandMotion) -> StrandMotion {
    tousle_guide::follow(groom, guides, motion, &NoProgress).expect("a motion")
}

/// What follows kept out of head, neck and shoulders.
#[divan::bench(args = RUNS, max_time = 4, min_time = 1)]
fn keep_out(bencher: Bencher<'_, '_>, run: Run) {
    let Led { groom, guides, motion } = led(run);
    let mut all = followed(&groom, &guides, &motion);
    measure(bencher, run, || kept_out(&groom, &guides, &mut all));
}

fn kept_out(groom: &Groom, guides: &Guides, motion: &mut StrandMotion) -> u64 {
    let at_rest = Surface::of_body(&mannequin().body, &Pose::identity());
    let at_times = vec![at_rest.clone(); N_FRAMES];
    tousle_guide::keep_out(groom, guides, motion, &at_rest, &at_times)
}

/// All of it for guides that are chosen: they are simulated, followed, and what follows is kept out.
#[divan::bench(args = RUNS, max_time = 8, min_time = 1)]
fn whole(bencher: Bencher<'_, '_>, run: Run) {
    let Led { groom, guides, .. } = led(run);
    measure(bencher, run, || {
        let mut all = followed(&groom, &guides, &blown(&guides.groom(&groom)));
        kept_out(&groom, &guides, &mut all);
        all
    });
}

/// Guides chosen, and whom each of the others follows. An item here is a point of a strand, once for all frames.
#[divan::bench(args = RUNS, max_time = 4, min_time = 1)]
fn choose(bencher: Bencher<'_, '_>, run: Run) {
    let groom = wig(run.strands, N_POINTS);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(run.threads).build().expect("a pool");
    let items = (run.strands * N_POINTS) as u64;
    bencher.counter(ItemsCount::new(items)).bench_local(|| {
        pool.install(|| tousle_guide::choose(&groom, run.strands / STRANDS_PER_GUIDE)).expect("guides")
    });
}
