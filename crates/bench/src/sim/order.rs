use super::Part;
use crate::capture::failed;
use crate::way::unless_too_short;
use crate::worlds::{DOWN, groom, straight, uniform, vacuum};
use crate::{BenchError, Cell, Curve, CurvePoint, Section, Table, Way, WorkPrecision};
use tousle_core::{Groom, NoProgress, Progress, Quantity, Strand, Vec3};
use tousle_field::{FieldSequence, Scene};
use tousle_sim::{Integrator, Method, Precision, SimError, SimOptions, simulate};

/// Steps a second at which errors are compared: each half of the one before.
const RATES_HZ: [f64; 8] = [60.0, 120.0, 240.0, 480.0, 960.0, 1_920.0, 3_840.0, 7_680.0];

/// Steps a second of the solution that the others are compared with.
const CONVERGED_HZ: f64 = 61_440.0;

/// Below this an error is as much one of rounding and of where an iteration stops as of the step, mm.
const CLEAR_MM: f64 = 1e-2;

/// A lock in gusts, with nothing to touch: all is smooth but the wind's corners at its steps.
struct World {
    field: FieldSequence,
    scene: Scene,
    groom: Groom,
}

/// How errors fall with the step, and whether stiff hair needs smaller ones.
pub(super) fn section(progress: &dyn Progress) -> Result<Section, BenchError> {
    let (table, curves) = orders(progress).map_err(failed("one lock in gusts", "simulating"))?;
    let stiff = stiffness().map_err(failed("stiff hair in gusts", "simulating"))?;
    let diagram = WorkPrecision {
        title: "One lock in gusts: order".to_owned(),
        cost: "steps a second".to_owned(),
        error: "error of the tip, mm".to_owned(),
        curves,
    };
    Ok(Section {
        name: Part::Order.stem(),
        title: "Order: how errors fall with the step".to_owned(),
        words: format!(
            "One lock of five sticks swings in gusts for 0.75 s; the error is that of its tip at the end, against \
             {CONVERGED_HZ} steps a second of the method's default, or of the explicit integrator of highest order for \
             those of the method physical, which count rotary inertia. Order found: log₂ of the last two errors above \
             {CLEAR_MM} mm. A dash: refused, or fewer than two such errors. Stiff hair: the farthest that any point of twelve \
             sticks is off at any time within a second."
        ),
        tables: vec![(String::new(), table), ("stiff".to_owned(), stiff)],
        plots: vec![(String::new(), diagram.to_plot())],
    })
}

fn gusty_lock() -> World {
    let lock = Strand {
        // So thick that explicit steps of a third of a millisecond stand its twist.
        bending_stiffness_n_m2: 1e-5,
        internal_damping_secs: 0.002,
        lock_width_m: 0.01,
        ..straight(Vec3::new(0.0, 0.0, 0.2), Vec3::new(0.3, 0.0, -1.0), 0.2, 5)
    };
    World { groom: groom(vec![lock]), ..gusty(0.2) }
}

/// Nobody in gusts that swing by so much a step of 1/60 s, rad.
fn gusty(turn: f64) -> World {
    let gust = |k: u32| Vec3::new(0.0, 3.0 * libm::sin(f64::from(k) * turn), 1.0);
    let gusts: Vec<Vec3> = (0..=60).map(gust).collect();
    World {
        field: uniform(Quantity::AirVelocity, 60.0, &gusts),
        scene: Scene { air_density: 1.2, ..vacuum(DOWN) },
        groom: groom(Vec::new()),
    }
}

/// Where the first strand's points are at the end, and how many steps that took a second.
fn end(world: &World, options: SimOptions) -> Result<([f32; 3], f64), SimError> {
    let options = SimOptions { duration_secs: Some(0.75), ..options };
    let simulation = simulate(&world.field, &world.scene, &world.groom, &options, &NoProgress)?;
    let motion = &simulation.motion;
    let last = motion.strand(motion.times_secs.len() - 1, 0);
    Ok((last[last.len() - 1], simulation.report.n_steps as f64 / 0.75))
}

fn at_rate(way: Way, rate_hz: f64) -> SimOptions {
    SimOptions { dt_secs: Some(1.0 / rate_hz), ..way.options() }
}

fn orders(progress: &dyn Progress) -> Result<(Table, Vec<Curve>), SimError> {
    let rates = RATES_HZ.map(|rate| format!("{rate}/s, mm"));
    let columns: Vec<&str> = ["integrator", "order claimed", "order found"]
        .into_iter()
        .chain(rates.iter().map(String::as_str))
        .collect();
    let mut table = Table::new("One lock in gusts: error of the tip", &columns);
    let mut curves = Vec::new();
    let world = gusty_lock();
    let ways = Way::all();
    for (k, way) in (0..).zip(&ways) {
        progress.at(k, ways.len() as u64);
        let (reference, _) = end(&world, at_rate(reference_way(*way), CONVERGED_HZ))?;
        let point = |options: SimOptions| match unless_too_short(end(&world, options)) {
            Err(SimError::Unstable { .. }) => Ok(None),
            ended => ended.map(|end| end.map(|(tip, steps)| (distance_mm(tip, reference), steps))),
        };
        let points: Vec<Option<(f64, f64)>> = if way.integrator == Integrator::Adaptive {
            let tolerances = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7];
            let with = |tolerance_m| point(SimOptions { tolerance_m, ..way.options() });
            tolerances.into_iter().map(with).collect::<Result<_, _>>()?
        } else {
            RATES_HZ.into_iter().map(|rate| point(at_rate(*way, rate))).collect::<Result<_, _>>()?
        };
        let errors: Vec<(f64, f64)> = points.iter().flatten().copied().collect();
        if way.integrator != Integrator::Adaptive {
            let order = order_found(&errors);
            let head = [Cell::text(way.name()), Cell::number(way.integrator.order().into(), 0)];
            let errors = points.iter().map(|p| Cell::maybe(p.map(|(error, _)| error), 5));
            table.push(head.into_iter().chain([Cell::maybe(order, 2)]).chain(errors).collect());
        }
        let to_point = |(error, cost): &(f64, f64)| CurvePoint {
            setting: format!("{cost:.0}/s"),
            cost: *cost,
            error: *error,
        };
        curves.push(Curve { points: errors.iter().map(to_point).collect(), ..Curve::named(way.name()) });
    }
    Ok((table, curves))
}

/// What a way is compared with.
fn reference_way(way: Way) -> Way {
    let limited = Integrator::of(way.method).iter().copied().filter(|i| i.is_limited());
    match limited.max_by_key(|i| i.order()) {
        Some(integrator) if way.method == Method::Physical && way.integrator.is_limited() => {
            Way { integrator, ..way }
        }
        _ => Way::default_of(way.method),
    }
}

/// log₂ of how the last two clear errors fall, each with its steps a second; `None` where there are no two.
fn order_found(errors: &[(f64, f64)]) -> Option<f64> {
    let clear: Vec<&(f64, f64)> = errors.iter().take_while(|(error, _)| *error > CLEAR_MM).collect();
    let [.., (coarse, few), (fine, many)] = clear.as_slice() else { return None };
    Some(libm::log2(coarse / fine) / libm::log2(many / few))
}

/// The largest error of any point at any time, of hair of one, a hundred and ten thousand times the stiffness.
fn stiffness() -> Result<Table, SimError> {
    const AT_HZ: [f64; 4] = [60.0, 120.0, 240.0, 480.0];
    let rates = AT_HZ.map(|rate| format!("{rate}/s, mm"));
    let columns: Vec<&str> =
        ["integrator", "bending stiffness"].into_iter().chain(rates.iter().map(String::as_str)).collect();
    let mut table = Table::new("Stiff hair at the same steps", &columns);
    let never_refused = |way: &Way| !way.integrator.is_limited() && way.integrator != Integrator::Adaptive;
    for way in Way::all().into_iter().filter(never_refused) {
        for times in [1.0, 100.0, 10_000.0] {
            let lock = Strand {
                bending_stiffness_n_m2: 2e-6 * times,
                ..straight(Vec3::new(0.0, 0.0, 0.5), Vec3::new(0.3, 0.0, -1.0), 0.25, 12)
            };
            let world = World { groom: groom(vec![lock]), ..gusty(0.1) };
            let motion = |way: Way, rate_hz| {
                let options = SimOptions { duration_secs: Some(1.0), ..at_rate(way, rate_hz) };
                simulate(&world.field, &world.scene, &world.groom, &options, &NoProgress).map(|s| s.motion)
            };
            let converged = motion(Way { precision: Precision::Double, ..way }, 7_680.0)?;
            let mut row = vec![Cell::text(way.name()), Cell::text(format!("× {times}"))];
            for rate_hz in AT_HZ {
                let found = motion(way, rate_hz)?;
                let pairs = found.positions_m.iter().zip(&converged.positions_m);
                let off = pairs.map(|(a, b)| distance_mm(*a, *b)).fold(0.0, f64::max);
                row.push(Cell::number(off, 2));
            }
            table.push(row);
        }
    }
    Ok(table)
}

fn distance_mm(a: [f32; 3], b: [f32; 3]) -> f64 {
    1e3 * (Vec3::from(a.map(f64::from)) - Vec3::from(b.map(f64::from))).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halved_errors_are_of_order_one_and_rounding_does_not_count() {
        let errors = [(8.0, 60.0), (4.0, 120.0), (2.0, 240.0), (0.0, 480.0)];
        assert_eq!(order_found(&errors), Some(1.0));
        assert_eq!(order_found(&errors[..1]), None);
    }
}
