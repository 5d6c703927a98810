use super::cases::{Ask, Case, World};
use tousle_core::{Pose, PoseTrack, Quantity, Strand, StrandMotion, Vec3};
use tousle_sim::Simulation;

/// What is wrong with what became of a world; `None` if nothing.
pub(super) fn flaw(case: &Case, world: &World, simulation: &Simulation) -> Option<String> {
    let motion = &simulation.motion;
    if !motion.positions_m.iter().flatten().all(|c| c.is_finite()) {
        return Some("not finite".to_owned());
    }
    let stretch = simulation.report.max_stretch;
    if stretch > largest_stretch(world) {
        return Some(format!("stretches by {:.2} %", 100.0 * stretch));
    }
    let (speed, bound) = (fastest(motion), fastest_possible(world));
    if speed > bound {
        return Some(format!("a point at {speed:.0} m/s where nothing drives it beyond {bound:.0}"));
    }
    let mm = |what: &str, found_m: f64, bound_m: f64| {
        (found_m > bound_m).then(|| format!("{what} {:.1} mm", 1e3 * found_m))
    };
    match case.asks {
        Ask::Nothing => None,
        Ask::Calm(bound_m) => mm("jitters by", jitter(motion), bound_m),
        Ask::Settles(bound_m) => mm("still moves by", late_motion(motion, world.rate_hz), bound_m),
        Ask::Rests(bound_m) => mm("leaves its rest by", drift(motion), bound_m),
        Ask::GainsNoEnergy(bound) => {
            let gain = energy_gain(world, motion);
            (gain > bound).then(|| format!("gains {:.0} % of weight times length", 100.0 * gain))
        }
    }
}

/// A thousandth; more only where the rounding of the result to single precision is: 3e-8 m at 0.3 m.
fn largest_stretch(world: &World) -> f64 {
    let sticks = world.groom.strands.iter().flat_map(|s| s.rest_curve_m.windows(2));
    let shortest_m = sticks.map(|p| (p[1] - p[0]).norm()).fold(f64::INFINITY, f64::min);
    f64::max(1e-3, 3e-8 / shortest_m)
}

/// The fastest that a point goes from frame to frame, m/s.
fn fastest(motion: &StrandMotion) -> f64 {
    let between = |frame: usize| {
        let secs = motion.times_secs[frame + 1] - motion.times_secs[frame];
        (0..motion.n_points()).map(move |k| (at(motion, frame + 1, k) - at(motion, frame, k)).norm() / secs)
    };
    (0..motion.times_secs.len() - 1).flat_map(between).fold(0.0, f64::max)
}

/// Twice what wind, push, head and weight together could give a point, m/s: a tip cracks like a whip.
fn fastest_possible(world: &World) -> f64 {
    let strongest = world
        .field
        .steps
        .iter()
        .flat_map(|s| {
            let n = s.flags.len();
            let at = |v: usize| Vec3::new(s.u[v].into(), s.u[n + v].into(), s.u[2 * n + v].into()).norm();
            (0..n).map(at).chain([s.outside.norm()]).collect::<Vec<_>>()
        })
        .fold(0.0, f64::max);
    let length_m = world.groom.strands.iter().map(|s| s.length_m).fold(0.0, f64::max);
    let wind = match world.field.quantity {
        Quantity::AirVelocity => strongest,
        Quantity::ForcePerMass => (2.0 * strongest * length_m).sqrt(),
    };
    let weight = (2.0 * world.scene.gravity_world.norm() * 2.0 * length_m).sqrt();
    2.0 * (wind + weight + head_speed(&world.scene.poses))
}

/// How fast the head moves what is half a meter from its middle, m/s, but no faster than a cut can be missed for: hair goes along at
/// most jumps.
fn head_speed(track: &PoseTrack) -> f64 {
    let way = |p: &[Pose]| {
        let shift = (p[1].translation.vector - p[0].translation.vector).norm();
        (shift + 0.5 * p[0].rotation.angle_to(&p[1].rotation)) * track.rate_hz
    };
    track.poses.windows(2).map(way).fold(0.0, f64::max).min(50.0)
}

/// In the last third: how far a point is from the middle of where it was a frame before and is a frame later, twice, m.
fn jitter(motion: &StrandMotion) -> f64 {
    let n = motion.times_secs.len();
    let bend = |frame: usize, k: usize| {
        (at(motion, frame - 1, k) - at(motion, frame, k) * 2.0 + at(motion, frame + 1, k)).norm()
    };
    (2 * n / 3..n - 1)
        .flat_map(|frame| (0..motion.n_points()).map(move |k| bend(frame, k)))
        .fold(0.0, f64::max)
}

/// The farthest from its last place that a point is in the last second, m.
fn late_motion(motion: &StrandMotion, rate_hz: f64) -> f64 {
    let last = motion.times_secs.len() - 1;
    let from = last.saturating_sub(rate_hz as usize);
    farthest(motion, from..last, last)
}

/// The farthest that a point is from its first place, m.
fn drift(motion: &StrandMotion) -> f64 {
    farthest(motion, 1..motion.times_secs.len(), 0)
}

fn farthest(motion: &StrandMotion, frames: std::ops::Range<usize>, from: usize) -> f64 {
    let away = |frame: usize, k: usize| (at(motion, frame, k) - at(motion, from, k)).norm();
    frames.flat_map(|frame| (0..motion.n_points()).map(move |k| away(frame, k))).fold(0.0, f64::max)
}

/// By how much a single strand's energy of place and of motion exceeds that of the start, in weight times length.
///
/// Speeds are those between frames, places those between them, so what is found is never too much but for the curve that
/// the path has between two frames.
fn energy_gain(world: &World, motion: &StrandMotion) -> f64 {
    let strand: &Strand = &world.groom.strands[0];
    let gravity = world.scene.poses.poses[0].rotation.inverse() * world.scene.gravity_world;
    let sticks_m: Vec<f64> = strand.rest_curve_m.windows(2).map(|p| (p[1] - p[0]).norm()).collect();
    let mass = |k: usize| {
        let next = sticks_m.get(k).copied().unwrap_or(0.0);
        0.5 * strand.linear_density_kg_per_m * (sticks_m[k - 1] + next)
    };
    let points = 1..strand.rest_curve_m.len();
    let place =
        |frame: usize| -> f64 { points.clone().map(|k| -mass(k) * gravity.dot(&at(motion, frame, k))).sum() };
    let moving = |frame: usize| -> f64 {
        let secs = motion.times_secs[frame + 1] - motion.times_secs[frame];
        let speed2 =
            |k: usize| (at(motion, frame + 1, k) - at(motion, frame, k)).norm_squared() / (secs * secs);
        points.clone().map(|k| 0.5 * mass(k) * speed2(k)).sum()
    };
    let start = place(0);
    let most = (0..motion.times_secs.len() - 1)
        .map(|frame| f64::min(place(frame), place(frame + 1)) + moving(frame) - start)
        .fold(0.0, f64::max);
    let weight: f64 = points.clone().map(mass).sum::<f64>() * gravity.norm();
    most / (weight * strand.length_m)
}

fn at(motion: &StrandMotion, frame: usize, point: usize) -> Vec3 {
    Vec3::from(motion.frame(frame)[point].map(f64::from))
}
