use super::setting::{MAX_RATE_HZ, Setting};
use super::{Part, Sample};
use crate::capture::failed;
use crate::clock::least;
use crate::way::unless_too_short;
use crate::{BenchError, Curve, CurvePoint, Section, Way, WorkPrecision};
use tousle_core::{NoProgress, Progress, StrandMotion};
use tousle_sim::{Method, SimError, SimOptions, Simulation, simulate};

/// Steps a second; all are multiples of the first, which is the rate of the frames that are compared.
const RATES_HZ: [f64; 6] = [30.0, 60.0, 120.0, 240.0, 480.0, 960.0];

/// Steps a second of what the others are compared with.
const CONVERGED_HZ: f64 = 7_680.0;

/// Every way to step a hairstyle against the converged solution of the same equations.
pub(super) fn section(sample: Sample<'_>, progress: &dyn Progress) -> Result<Section, BenchError> {
    let ways = Way::all();
    let mut curves = Vec::new();
    let mut unaffordable = Vec::new();
    for method in [Method::Physical, Method::Paper] {
        let way = Way::default_of(method);
        let reference = run(sample, way, Setting::Rate(CONVERGED_HZ)).map_err(in_sample(sample))?.motion;
        for way in ways.iter().filter(|way| way.method == method) {
            progress.at(curves.len() as u64, ways.len() as u64);
            let curve = curve(sample, *way, &reference).map_err(in_sample(sample))?;
            if curve.points.is_empty() {
                unaffordable.push(way.name());
            }
            curves.push(curve);
        }
    }
    let left_out = match unaffordable.as_slice() {
        [] => String::new(),
        names => format!(
            " Not run, as they would need more than {MAX_RATE_HZ} steps a second: {}.",
            names.join("; ")
        ),
    };
    let diagram = WorkPrecision {
        title: format!("{}, against the converged solution", sample.name),
        cost: "CPU s per simulated s".to_owned(),
        error: "mean error, mm".to_owned(),
        curves,
    };
    Ok(Section {
        name: Part::Converged.stem(),
        title: "Against the converged solution of the same equations".to_owned(),
        words: format!(
            "{}: the mean distance, over all points but the roots and all frames, to the method's default integrator at \
             {CONVERGED_HZ} steps a second. The explicit integrators of the method physical count a lock's own rotary \
             inertia, which the others leave out, so they come no nearer than that difference.{left_out}",
            sample.name
        ),
        tables: vec![(String::new(), diagram.to_table())],
        plots: vec![(String::new(), diagram.to_plot())],
    })
}

fn curve(sample: Sample<'_>, way: Way, reference: &StrandMotion) -> Result<Curve, SimError> {
    let limit_secs = way.limit_secs(sample.field, sample.scene, sample.groom)?;
    let point = |setting: Setting| {
        let ran = unless_too_short(least(|| run(sample, way, setting)))?;
        let Some((simulation, secs)) = ran else { return Ok(None) };
        let motion = &simulation.motion;
        let simulated_secs = motion.times_secs[motion.times_secs.len() - 1] - motion.times_secs[0];
        Ok::<_, SimError>(Some(CurvePoint {
            setting: setting.to_string(),
            cost: secs / simulated_secs,
            error: mean_distance_mm(motion, reference),
        }))
    };
    let points = Setting::of(way, &RATES_HZ, limit_secs).into_iter().map(point);
    Ok(Curve {
        points: points.filter_map(Result::transpose).collect::<Result<_, _>>()?,
        is_labeled: way == Way::default_of(way.method),
        ..Curve::named(way.name())
    })
}

fn run(sample: Sample<'_>, way: Way, setting: Setting) -> Result<Simulation, SimError> {
    let options = setting.apply(SimOptions { rate_hz: RATES_HZ[0], ..way.options() });
    simulate(sample.field, sample.scene, sample.groom, &options, &NoProgress)
}

fn in_sample(sample: Sample<'_>) -> impl Fn(SimError) -> BenchError {
    failed(sample.name, "simulating")
}

/// The mean distance between the same points of two motions, mm; roots, which never move, left out.
fn mean_distance_mm(motion: &StrandMotion, reference: &StrandMotion) -> f64 {
    let mut sum = 0.0;
    let mut n = 0;
    for frame in 0..motion.times_secs.len() {
        for strand in 0..motion.counts.len() {
            let pairs = motion.strand(frame, strand).iter().zip(reference.strand(frame, strand)).skip(1);
            for (a, b) in pairs {
                let squares = a.iter().zip(b).map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2));
                sum += squares.sum::<f64>().sqrt();
                n += 1;
            }
        }
    }
    1e3 * sum / f64::from(n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::worlds::{gusts, mannequin, wig};

    /// Ways that do not stand every step are run at those that they stand.
    #[test]
    fn every_way_has_a_curve() {
        let (field, scene, groom) = (gusts(), mannequin(), wig(2, 4));
        let sample = Sample { name: "two strands", field: &field, scene: &scene, groom: &groom };
        for way in Way::all().into_iter().filter(|way| !way.integrator.is_limited()) {
            let reference = run(sample, way, Setting::Rate(60.0)).unwrap().motion;
            assert!(curve(sample, way, &reference).unwrap().points.len() > 3, "{}", way.name());
        }
    }
}
