//! Error against run time of the simulator in the true wind: style B of every capture, one line a setting.
//!
//!     cargo run --release -p tousle-bench --example true_wind -- CAPTURES [METHOD [STEPS_A_SECOND…]]
//!
//! One core with `RAYON_NUM_THREADS=1`. `INTEGRATOR=NAME` and `SINGLE=1` choose the others; `TORSO_GRIP_HEAD=1` lets
//! the torso's surface go along with the head, as the engine behind these captures does.

use std::path::Path;
use tousle_bench::{CaptureFolder, sim_in_true_wind};
use tousle_sim::{Integrator, Method, Precision, SimOptions, TorsoGrip};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let captures = CaptureFolder::all(Path::new(args.first().ok_or("expected a folder of captures")?))?;
    let method = args.get(1).map_or("physical", String::as_str);
    let method = Method::from_name(method).ok_or("expected the method physical or paper")?;
    let rates: Vec<f64> = args.iter().skip(2).map(|rate| rate.parse()).collect::<Result<_, _>>()?;
    let rates = if rates.is_empty() { vec![30.0, 60.0, 120.0, 480.0] } else { rates };
    let integrator = std::env::var("INTEGRATOR").ok().and_then(|name| Integrator::from_name(&name));
    let precision = if std::env::var_os("SINGLE").is_some() { Precision::Single } else { Precision::Double };
    let torso_grip = match std::env::var_os("TORSO_GRIP_HEAD") {
        Some(_) => TorsoGrip::Head,
        None => TorsoGrip::Torso,
    };
    println!(
        "capture, steps a second, explained motion, median lock, mean mm, explained fluctuation, CPU s a s"
    );
    for rate in rates {
        for capture in &captures {
            let options = SimOptions {
                // Frames of the result may be coarser than the truth's; the score is resampled.
                rate_hz: f64::min(rate, 60.0),
                dt_secs: Some(1.0 / rate),
                integrator,
                precision,
                torso_grip,
                ..SimOptions::of(method)
            };
            let judged = sim_in_true_wind(capture, &options)?;
            let (points, locks) = (&judged.score.points, judged.score.locks.as_ref());
            println!(
                "{:16} {rate:6} {:.3} {:.3} {:5.2} {:.3} {:.4}",
                capture.name(),
                points.explained_motion,
                locks.map_or(f64::NAN, |locks| locks.explained_median),
                points.mean_mm,
                points.explained_fluctuation,
                judged.cost.cpu_secs.unwrap_or(judged.cost.wall_secs) / judged.simulated_secs,
            );
        }
    }
    Ok(())
}
