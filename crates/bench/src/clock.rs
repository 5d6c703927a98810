//! What a stage costs.

use serde::Serialize;
use std::ops::Add;
use std::time::Instant;

/// Measures what runs between [`Stopwatch::start`] and [`Stopwatch::stop`].
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    started: Instant,
    cpu_nanos: Option<u64>,
}

/// What something cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Cost {
    /// Time on the wall's clock, s.
    pub wall_secs: f64,
    /// Time on all cores together, s; `None` where the system does not tell.
    pub cpu_secs: Option<f64>,
}

impl Stopwatch {
    /// Begins to measure.
    pub fn start() -> Self {
        Self { started: Instant::now(), cpu_nanos: process_cpu_nanos() }
    }

    /// What was spent since the start.
    ///
    /// Processor time is that of threads alive now: pools that outlive the work are counted whole.
    pub fn stop(self) -> Cost {
        let spent = |before: u64| Some(process_cpu_nanos()?.saturating_sub(before) as f64 * 1e-9);
        Cost { wall_secs: self.started.elapsed().as_secs_f64(), cpu_secs: self.cpu_nanos.and_then(spent) }
    }
}

impl Cost {
    /// Processor time, or the wall's where the system does not tell.
    pub fn secs(&self) -> f64 {
        self.cpu_secs.unwrap_or(self.wall_secs)
    }
}

/// One after the other.
impl Add for Cost {
    type Output = Self;

    fn add(self, then: Self) -> Self {
        Self {
            wall_secs: self.wall_secs + then.wall_secs,
            cpu_secs: self.cpu_secs.zip(then.cpu_secs).map(|(a, b)| a + b),
        }
    }
}

/// How often a cost is measured; the least is kept.
pub(crate) const TRIES: usize = 3;

/// What some work gives, and the least time of a few tries, s.
pub(crate) fn least<T, E>(mut work: impl FnMut() -> Result<T, E>) -> Result<(T, f64), E> {
    let mut timed = || {
        let watch = Stopwatch::start();
        work().map(|result| (result, watch.stop().secs()))
    };
    let (mut result, mut shortest) = timed()?;
    for _ in 1..TRIES {
        let again = timed()?;
        shortest = shortest.min(again.1);
        result = again.0;
    }
    Ok((result, shortest.max(1e-9)))
}

/// The least time of a few tries, s.
pub(crate) fn least_secs<E>(work: impl FnMut() -> Result<(), E>) -> Result<f64, E> {
    least(work).map(|((), secs)| secs)
}

/// Time on a processor of all threads of this process, ns, as Linux keeps it by thread.
fn process_cpu_nanos() -> Option<u64> {
    let threads = std::fs::read_dir("/proc/self/task").ok()?;
    let mut sum = 0;
    for thread in threads.flatten() {
        // A thread that ended since the folder was listed is no reason to give up.
        let Ok(line) = std::fs::read_to_string(thread.path().join("schedstat")) else { continue };
        sum += line.split_whitespace().next()?.parse::<u64>().ok()?;
    }
    (sum > 0).then_some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_costs() {
        let watch = Stopwatch::start();
        let mut sum = 0_u64;
        while watch.started.elapsed().as_millis() < 30 {
            sum = std::hint::black_box(sum + 1);
        }
        let cost = watch.stop();
        assert!(cost.wall_secs >= 0.03);
        assert!(cost.secs() > 0.0, "{cost:?} after counting to {sum}");
    }
}
