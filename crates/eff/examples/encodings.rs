//! Size, time and error of each encoding, on field files of yours:
//!
//!     cargo run --release -p tousle-eff --example encodings -- FIELD.eff.mcap...
//!
//! Times are the best of three, one thread, from and to memory; `step` is the mean over steps picked at random.

use std::io::Cursor;
use std::time::{Duration, Instant};
use tousle_core::NoProgress;
use tousle_eff::{Eff, EffError, Encoding, ReadOptions, Reader, WriteOptions, read, validate, write};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("field,encoding,bytes,share of raw,largest error,write MB/s,read MB/s,validate MB/s,step ms");
    for path in std::env::args().skip(1) {
        let eff = read(std::fs::File::open(&path)?, &ReadOptions::default())?;
        for (name, encoding) in [
            ("f32", Encoding::F32),
            ("f16", Encoding::F16),
            ("fixed 1e-4", Encoding::Fixed { max_error: 1e-4 }),
            ("fixed 1e-3", Encoding::Fixed { max_error: 1e-3 }),
            ("fixed 1e-2", Encoding::Fixed { max_error: 1e-2 }),
        ] {
            println!("{},{name},{}", eff.name, row(&eff, encoding)?);
        }
    }
    Ok(())
}

/// One line of the table. Speeds are in raw bytes: what the steps take in memory.
fn row(eff: &Eff, encoding: Encoding) -> Result<String, EffError> {
    let raw: usize = eff
        .field
        .steps
        .iter()
        .map(|s| 4 * s.u.len() + s.flags.len() + 4 * s.sd.as_ref().map_or(0, Vec::len))
        .sum();
    let mut bytes = Vec::new();
    let mut max_error = 0.0;
    let written = best(|| {
        bytes.clear();
        let report = write(eff, &mut bytes, &WriteOptions::with_encoding(encoding), &NoProgress)?;
        max_error = report.max_error;
        Ok(())
    })?;
    let read_in = best(|| read(&bytes[..], &ReadOptions::default()).map(drop))?;
    let validated = best(|| validate(&bytes[..]).map(drop))?;
    let mut reader = Reader::open(Cursor::new(&bytes))?;
    let n_steps = reader.n_steps();
    let stepped = best(|| (0..20).try_for_each(|k| reader.step(k * 7919 % n_steps).map(drop)))? / 20;
    let speed = |time: Duration| raw as f64 / 1e6 / time.as_secs_f64();
    Ok(format!(
        "{},{:.3},{max_error:.1e},{:.0},{:.0},{:.0},{:.2}",
        bytes.len(),
        bytes.len() as f64 / raw as f64,
        speed(written),
        speed(read_in),
        speed(validated),
        stepped.as_secs_f64() * 1e3
    ))
}

/// The shortest of three times.
fn best(mut work: impl FnMut() -> Result<(), EffError>) -> Result<Duration, EffError> {
    let mut shortest = Duration::MAX;
    for _ in 0..3 {
        let start = Instant::now();
        work()?;
        shortest = shortest.min(start.elapsed());
    }
    Ok(shortest)
}
