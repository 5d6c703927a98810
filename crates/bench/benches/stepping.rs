//! How many strand-point steps a second the simulator makes, beside what it would cost only to sample the field at those
//! points, only to move the strands' state through memory, and only to write the points of all frames.
//!
//!     cargo bench -p tousle-bench --bench stepping
//!
//! Strands of 16 points all over a head that stands still, with contacts, in gusts of 3 m/s; 60 steps and frames a
//! second. An item is one point through one step, frames of the result included. What comes before the first step is
//! measured by itself: `prepare` is a whole run of one step (how the hair hangs, what it can touch).

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use rayon::prelude::*;
use std::iter::Sum;
use std::ops::AddAssign;
use std::sync::LazyLock;
use tousle_bench::worlds::{gusts, mannequin, wig};
use tousle_core::{Body, NoProgress};
use tousle_field::{FieldSequence, Reading, SAMPLED_AT_ONCE, Sampler, Scene};
use tousle_sim::{Frame, Method, Precision, SimOptions, Simulator, TimeMode, simulate};

fn main() {
    divan::main();
}

const N_POINTS: usize = 16;
static WIND: LazyLock<FieldSequence> = LazyLock::new(gusts);
const RATE_HZ: f64 = 60.0;

/// Strands, steps and threads: few strands take many steps, so that preparing them counts for little.
const RUNS: [Run; 8] = [
    Run { strands: 120, steps: 1200, threads: 1 },
    Run { strands: 120, steps: 1200, threads: 2 },
    Run { strands: 1_000, steps: 300, threads: 1 },
    Run { strands: 1_000, steps: 300, threads: 2 },
    Run { strands: 10_000, steps: 60, threads: 1 },
    Run { strands: 10_000, steps: 60, threads: 2 },
    Run { strands: 100_000, steps: 60, threads: 1 },
    Run { strands: 100_000, steps: 60, threads: 2 },
];

#[derive(Clone, Copy, Debug)]
struct Run {
    strands: usize,
    steps: u32,
    threads: usize,
}

impl std::fmt::Display for Run {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} strands, {} steps, {} threads", self.strands, self.steps, self.threads)
    }
}

impl Run {
    fn measure(self, bencher: Bencher<'_, '_>, steps: u32, mut work: impl FnMut() + Send) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads).build().expect("a pool");
        let items = self.strands as u64 * N_POINTS as u64 * u64::from(steps);
        bencher.counter(ItemsCount::new(items)).bench_local(|| pool.install(&mut work));
    }

    fn options(self, steps: u32, options: SimOptions) -> SimOptions {
        SimOptions {
            rate_hz: RATE_HZ,
            dt_secs: Some(1.0 / RATE_HZ),
            duration_secs: Some(f64::from(steps) / RATE_HZ),
            time: TimeMode::Loop,
            ..options
        }
    }

    /// All steps of strands that are prepared.
    fn step(self, bencher: Bencher<'_, '_>, scene: &Scene, options: SimOptions) {
        let (groom, options) = (wig(self.strands, N_POINTS), self.options(self.steps, options));
        let simulator = Simulator::new(&WIND, scene, &groom, &options).expect("a sound world");
        self.measure(bencher, self.steps, || {
            black_box(simulator.simulate(&[], &NoProgress).expect("a sound world"));
        });
    }

    /// All steps of strands that are prepared, each frame into a sink.
    fn step_into_sink(self, bencher: Bencher<'_, '_>, options: SimOptions) {
        let (scene, groom) = (mannequin(), wig(self.strands, N_POINTS));
        let options = self.options(self.steps, options);
        let simulator = Simulator::new(&WIND, &scene, &groom, &options).expect("a sound world");
        self.measure(bencher, self.steps, || {
            let mut sink = |frame: Frame<'_>| {
                black_box(frame);
                Ok(())
            };
            black_box(simulator.simulate_into(&[], &mut sink, &NoProgress).expect("a sound world"));
        });
    }

    /// A whole run of one step.
    fn prepare(self, bencher: Bencher<'_, '_>, method: Method) {
        let (scene, groom) = (mannequin(), wig(self.strands, N_POINTS));
        let options = self.options(1, SimOptions::of(method));
        self.measure(bencher, 1, || {
            black_box(simulate(&WIND, &scene, &groom, &options, &NoProgress).expect("a sound world"));
        });
    }
}

#[divan::bench(args = RUNS, max_time = 6, min_time = 1)]
fn physical(bencher: Bencher<'_, '_>, run: Run) {
    run.step(bencher, &mannequin(), SimOptions::of(Method::Physical));
}

#[divan::bench(args = RUNS, max_time = 6, min_time = 1)]
fn physical_single(bencher: Bencher<'_, '_>, run: Run) {
    let options = SimOptions { precision: Precision::Single, ..SimOptions::of(Method::Physical) };
    run.step(bencher, &mannequin(), options);
}

/// Runs of some seconds: how strands are put side by side at the beginning counts for little, as in a shot.
const RUNS_OF_SECONDS: [Run; 6] = [
    Run { strands: 1_000, steps: 600, threads: 1 },
    Run { strands: 1_000, steps: 600, threads: 2 },
    Run { strands: 10_000, steps: 300, threads: 1 },
    Run { strands: 10_000, steps: 300, threads: 2 },
    Run { strands: 100_000, steps: 300, threads: 1 },
    Run { strands: 100_000, steps: 300, threads: 2 },
];

#[divan::bench(args = RUNS_OF_SECONDS, max_time = 12, min_time = 1)]
fn physical_into_sink(bencher: Bencher<'_, '_>, run: Run) {
    run.step_into_sink(bencher, SimOptions::of(Method::Physical));
}

#[divan::bench(args = RUNS_OF_SECONDS, max_time = 12, min_time = 1)]
fn physical_single_into_sink(bencher: Bencher<'_, '_>, run: Run) {
    let options = SimOptions { precision: Precision::Single, ..SimOptions::of(Method::Physical) };
    run.step_into_sink(bencher, options);
}

/// Without body: nothing to touch, beside a head that stands still and a field without edits.
#[divan::bench(args = RUNS, max_time = 6, min_time = 1)]
fn physical_plain(bencher: Bencher<'_, '_>, run: Run) {
    let scene = Scene { body: Body::none(), ..mannequin() };
    run.step(bencher, &scene, SimOptions::of(Method::Physical));
}

#[divan::bench(args = RUNS, max_time = 6, min_time = 1)]
fn paper(bencher: Bencher<'_, '_>, run: Run) {
    run.step(bencher, &mannequin(), SimOptions::of(Method::Paper));
}

#[divan::bench(args = RUNS, max_time = 6, min_time = 1)]
fn paper_single(bencher: Bencher<'_, '_>, run: Run) {
    let options = SimOptions { precision: Precision::Single, ..SimOptions::of(Method::Paper) };
    run.step(bencher, &mannequin(), options);
}

#[divan::bench(args = RUNS, max_time = 6, min_time = 1)]
fn prepare_physical(bencher: Bencher<'_, '_>, run: Run) {
    run.prepare(bencher, Method::Physical);
}

#[divan::bench(args = RUNS, max_time = 6, min_time = 1)]
fn prepare_paper(bencher: Bencher<'_, '_>, run: Run) {
    run.prepare(bencher, Method::Paper);
}

/// The field at the middle of every stick, at the time of every step.
#[divan::bench(args = RUNS, max_time = 3, min_time = 1)]
fn only_sampling(bencher: Bencher<'_, '_>, run: Run) {
    let groom = wig(run.strands, N_POINTS);
    let sampler = Sampler::new(&WIND, |_| false);
    let middles: Vec<[f32; 3]> = groom
        .strands
        .iter()
        .flat_map(|s| s.rest_curve_m.windows(2).map(|p| ((p[0] + p[1]) / 2.0).map(|c| c as f32).into()))
        .collect();
    let points: Vec<[[f32; SAMPLED_AT_ONCE]; 3]> = middles
        .chunks_exact(SAMPLED_AT_ONCE)
        .map(|chunk| [0, 1, 2].map(|axis| core::array::from_fn(|k| chunk[k][axis])))
        .collect();
    let mut vectors = points.clone();
    let reading = if run.strands > 120 { Reading::Together } else { Reading::LaidOut };
    run.measure(bencher, run.steps, || {
        for step in 0..run.steps {
            let moment = sampler.at(f64::from(step) / RATE_HZ % WIND.end_secs(), reading);
            points.par_chunks(64).zip(vectors.par_chunks_mut(64)).for_each(|(points, vectors)| {
                moment.sample_all(points, vectors);
            });
            black_box(&mut vectors);
        }
    });
}

/// What a point is made of: turn, place, velocity and bend now and a step ago.
const STATE: usize = 26;

/// What a stick is made of and never changes.
const LINK: usize = 10;

/// Every point's state and stick read, and the state written, in every step.
#[divan::bench(args = RUNS, types = [f64, f32], max_time = 3, min_time = 1)]
fn only_memory<T>(bencher: Bencher<'_, '_>, run: Run)
where
    T: Copy + Send + Sync + From<f32> + Sum + AddAssign,
{
    let n = run.strands * N_POINTS;
    let links: Vec<[T; LINK]> = vec![[1e-9.into(); LINK]; n];
    let mut states: Vec<[T; STATE]> = vec![[1.0.into(); STATE]; n];
    run.measure(bencher, run.steps, || {
        for _ in 0..run.steps {
            states.par_chunks_mut(1024).zip(links.par_chunks(1024)).for_each(|(states, links)| {
                for (state, link) in states.iter_mut().zip(links) {
                    let sum: T = link.iter().copied().sum();
                    state.iter_mut().for_each(|number| *number += sum);
                }
            });
        }
        black_box(&mut states);
    });
}

/// The points of every frame written, into memory that nobody has used yet.
#[divan::bench(args = RUNS, max_time = 3, min_time = 1)]
fn only_frames(bencher: Bencher<'_, '_>, run: Run) {
    let n = run.strands * N_POINTS;
    let points: Vec<[f32; 3]> = vec![[0.5; 3]; n];
    run.measure(bencher, run.steps, || {
        let mut frames = vec![[0.0; 3]; n * run.steps as usize];
        for frame in frames.chunks_exact_mut(n) {
            let chunks = frame.par_chunks_mut(4096).zip(points.par_chunks(4096));
            chunks.for_each(|(frame, points)| frame.copy_from_slice(points));
        }
        black_box(frames);
    });
}
