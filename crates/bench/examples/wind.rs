//! The wind of captures by the method `physical`: style B simulated in it, and the field itself, one line a capture.
//!
//!     cargo run --release -p tousle-bench --example wind -- CAPTURES [NAME…]

use std::path::Path;
use tousle_bench::measure::Calibration;
use tousle_bench::{CaptureFolder, Stopwatch, VectorScore, resample_to_truth, score_field, sim_in_field};
use tousle_fit::{FitMethod, FitOptions, PhysicalOptions};
use tousle_pipeline::{ConvertOptions, Input, Silent, convert};
use tousle_sim::{Method, SimOptions};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let captures = CaptureFolder::all(Path::new(args.first().ok_or("expected a folder of captures")?))?;
    let names = &args[1..];
    println!(
        "style B: explained motion, median lock, explained fluctuation | vector error, median angle where hair was, nearby, elsewhere | truth within 2 sd there | left over, layer, wake | CPU s, wall s"
    );
    for folder in captures.iter().filter(|c| names.is_empty() || names.iter().any(|name| name == c.name())) {
        let wind = folder.truth.wind()?;
        let (csv, session) = (folder.csv()?, folder.session_bytes()?);
        let method = FitMethod::Physical(PhysicalOptions::default());
        let options = ConvertOptions {
            fit: FitOptions { method, ..FitOptions::default() },
            ..ConvertOptions::default()
        };
        let watch = Stopwatch::start();
        let capture = Input { name: "capture", bytes: &csv };
        let converted = convert(capture, Input { name: "session.json", bytes: &session }, &options, &Silent)?;
        let cost = watch.stop();
        let simulate = SimOptions { dt_secs: Some(1.0 / 60.0), ..SimOptions::of(Method::Physical) };
        let judged = sim_in_field(folder, &converted.eff.field, &converted.eff.scene, &simulate)?;
        let field = score_field(&resample_to_truth(&converted.eff.field, &wind), &wind)?;
        let of = |score: &Option<VectorScore>| {
            score.map_or(String::new(), |s| format!("{:.3} {:4.1}°", s.vector_error, s.angle_median_deg))
        };
        let (points, locks) = (&judged.score.points, judged.score.locks.as_ref());
        let found =
            converted.report.fit.physical.as_ref().ok_or("expected a report of the method physical")?;
        println!(
            "{:16} {:.3} {:.3} {:.3} | {} {} {} | {:.3?} | {:.2} {:.4} {:.2} | {:.1} {:.1}",
            folder.name(),
            points.explained_motion,
            locks.map_or(f64::NAN, |locks| locks.explained_median),
            points.explained_fluctuation,
            of(&field.hair),
            of(&field.nearby),
            of(&field.elsewhere),
            Calibration::of(&converted.eff.field, &wind).map_or([f64::NAN; 3], |c| c.within_two()),
            found.left_over,
            found.layer_m,
            found.wake,
            cost.cpu_secs.unwrap_or(f64::NAN),
            cost.wall_secs,
        );
    }
    Ok(())
}
