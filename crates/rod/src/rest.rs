use crate::contact::Surface;
use crate::likely::{Likely, Twist};
use crate::lock::Lock;
use crate::natural::{Fall, Natural, bends_over_m, curvature, falls, rest_bend};
use crate::nnls::nonnegative_least_squares;
use crate::touching::{Candidate, candidates};
use nalgebra::{DMatrix, DVector};
use tousle_core::{Body, Pose, Vec3};

/// How a lock that hangs still carries its weight: what its joints hold and what the body bears.
#[derive(Clone, Debug, PartialEq)]
pub struct Rest {
    /// Torque that the joint at the root's end of each stick holds at rest, N·m, head axes; across the
    /// stick where twist is free.
    ///
    /// Against the joint's stiffness it is the turn by which the natural, force-free shape is bent the other way.
    pub torques: Vec<Vec3>,
    /// The shape without load that was taken for likely, which tells what the body bears.
    pub likely: Natural,
    /// Where the body bears the lock.
    pub bearings: Vec<Bearing>,
    /// How near the point at the end of each stick comes to each collider, m, from center line to surface:
    /// collider after collider, stick after stick. Negative where the rest curve itself lies inside.
    pub clearances_m: Vec<f64>,
}

/// A point at which the body bears a lock at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bearing {
    /// Index of the collider in the body.
    pub collider: usize,
    /// Index of the stick whose far end it is.
    pub stick: usize,
    /// The force away from the collider, N, > 0.
    pub force_n: f64,
    /// The force along its surface, N, head axes: friction that holds the lock where it was laid.
    pub rub_n: Vec3,
}

/// How often the natural shape is worked out anew: how it falls depends on where it points, and how much a joint counts on
/// how far it is off.
const ROUNDS: usize = 8;

/// How a lock carries its weight in its rest curve, under a gravity in head axes, m/s², on a body at rest.
///
/// A rest curve alone does not say how much of the weight the hair holds by itself and how much lies on the
/// head: any force of the body that pushes outwards is possible wherever hair touches it. Of all of them the
/// one is taken that leaves the least of two energies, shared out by the weight s of `likely.natural`: what the joints
/// hold, Σ T²/k, as if the hair had been laid down, not pressed; and what it would take to bend the natural
/// shape to the likely one, Σ k (c + T/k − f)², c being the bend at rest and f the likely one. Their
/// weighted sum is least where Σ (T + s k (c − f))²/k is. The second says nothing of how a lock leaves the scalp.
/// Where other locks tell how this one falls, f falls as they do, and a joint counts the less the farther off it is
/// (t distribution).
pub fn rest_state(lock: &Lock, gravity: Vec3, body: &Body, likely: &Likely) -> Rest {
    let surfaces = Surface::of_body(body, &Pose::identity());
    let weights = weight_on_points(lock, gravity);
    let weight_n = weights.iter().sum::<Vec3>().norm();
    // What weighs nothing lies on nothing.
    let candidates = if weight_n > 0.0 { candidates(lock, &surfaces, likely) } else { Vec::new() };
    let weight_torques = joint_torques(lock, &weights, likely.twist);
    let unit_torques: Vec<Vec<Vec3>> =
        candidates.iter().map(|candidate| unit_torques(lock, candidate, likely.twist)).collect();
    let mut search = Search::new(lock, &weight_torques, &unit_torques, likely.natural.weight());
    let mut borne = search.most_likely();
    if let Natural::Falling(fall) = likely.natural
        && !candidates.is_empty()
        && lock.is_stiff()
    {
        search.force_cost = force_cost(lock, &fall, weight_n);
        let mut as_it_falls = falls(lock, &borne.torques, gravity);
        for _ in 0..ROUNDS {
            search.expect(&fall, &as_it_falls, &borne.torques);
            borne = search.most_likely();
            let found = falls(lock, &borne.torques, gravity);
            as_it_falls.iter_mut().zip(found).for_each(|(fall, found)| *fall = (*fall + found) * 0.5);
        }
    }
    let Borne { torques, forces_n } = borne;
    let bearings = bearings(&candidates, &forces_n);
    let clearances_m = clearances(&lock.rest_points()[1..], &surfaces, &bearings, likely.touch.radius_m);
    Rest { torques, likely: likely.natural, bearings, clearances_m }
}

/// A lock's weight, N: a force on the end of every stick.
pub(crate) fn weight_on_points(lock: &Lock, gravity: Vec3) -> Vec<Vec3> {
    lock.masses_kg.iter().map(|m| gravity * *m).collect()
}

/// What a body's push of 1 N asks of each joint, N·m, up to the last that it asks something of.
fn unit_torques(lock: &Lock, candidate: &Candidate, twist: Twist) -> Vec<Vec3> {
    let mut forces = vec![Vec3::zeros(); lock.n_sticks()];
    for (stick, share) in candidate.on_ends() {
        forces[stick] = candidate.force() * share;
    }
    let mut torques = joint_torques(lock, &forces, twist);
    torques.truncate(candidate.place.stick + 1);
    torques
}

/// What the body bears at each point, by its forces in all ways in which it may.
fn bearings(candidates: &[Candidate], forces: &[f64]) -> Vec<Bearing> {
    let mut bearings: Vec<Bearing> = Vec::new();
    for (candidate, force_n) in candidates.iter().zip(forces).filter(|(_, force_n)| **force_n > 0.0) {
        let Candidate { collider, along, .. } = *candidate;
        for (stick, share) in candidate.on_ends() {
            let (force_n, rub_n) = (force_n * share, along * *force_n * share);
            match bearings.iter_mut().find(|b| b.collider == collider && b.stick == stick) {
                Some(bearing) => {
                    bearing.force_n += force_n;
                    bearing.rub_n += rub_n;
                }
                None => bearings.push(Bearing { collider, stick, force_n, rub_n }),
            }
        }
    }
    bearings
}

/// Torque that each joint must hold against a force on the end of every stick.
///
/// From the tip inwards: a stick's joint holds what its own pull on the lever asks and what the next joint
/// passes on. The part along the stick is twist, which a lock that is free to roll does not hold.
pub fn joint_torques(lock: &Lock, forces: &[Vec3], twist: Twist) -> Vec<Vec3> {
    let mut torques = vec![Vec3::zeros(); lock.n_sticks()];
    let mut pull = Vec3::zeros();
    let mut passed_on = Vec3::zeros();
    for j in (0..lock.n_sticks()).rev() {
        let direction = lock.rest_directions[j];
        pull += forces[j];
        let torque = passed_on - direction.cross(&pull) * lock.lengths_m[j];
        torques[j] = match twist {
            Twist::Free => torque - direction * direction.dot(&torque),
            Twist::Held => torque,
        };
        passed_on = torques[j];
    }
    torques
}

/// The search for the forces ≥ 0 of a body that are most likely.
struct Search<'a> {
    lock: &'a Lock,
    /// What the weight asks of each joint, N·m.
    weight_torques: &'a [Vec3],
    /// What 1 N of each force asks of each joint, up to the last that it asks something of.
    units: &'a [Vec<Vec3>],
    /// How much the natural shape counts.
    natural_weight: f64,
    /// The likely bend of each joint without load, a rotation vector.
    bends: Vec<Vec3>,
    /// By joint, 1/(N·m): what the square of its torque costs.
    costs: Vec<f64>,
    /// What the square of a force costs, m/N.
    force_cost: f64,
}

/// What a body bears, and what is left for the joints.
struct Borne {
    /// N·m.
    torques: Vec<Vec3>,
    /// Of each way to bear, N.
    forces_n: Vec<f64>,
}

impl<'a> Search<'a> {
    /// For a natural shape that is straight.
    fn new(lock: &'a Lock, weight_torques: &'a [Vec3], units: &'a [Vec<Vec3>], natural_weight: f64) -> Self {
        // A lock without any stiffness is judged by torque alone.
        let cost = |k: &f64| if *k > 0.0 { 1.0 / k } else { 1.0 };
        let mut costs: Vec<f64> = lock.joint_stiffness.iter().map(cost).collect();
        costs[0] *= 1.0 - natural_weight;
        Self {
            lock,
            weight_torques,
            units,
            natural_weight,
            bends: vec![Vec3::zeros(); lock.n_sticks()],
            costs,
            force_cost: 0.0,
        }
    }

    /// Expects a natural shape that falls, and joints as far off as they are with these torques.
    fn expect(&mut self, fall: &Fall, as_it_falls: &[Vec3], torques: &[Vec3]) {
        for (j, as_it_falls) in as_it_falls.iter().enumerate().skip(1) {
            let expected = as_it_falls * fall.rate_per_m;
            self.bends[j] = expected * bends_over_m(self.lock, j);
            let off = curvature(self.lock, torques, j) - expected;
            self.costs[j] = fall.trust(off) / self.lock.joint_stiffness[j];
        }
    }

    fn most_likely(&self) -> Borne {
        let Self { lock, weight_torques, units, .. } = self;
        let wished: Vec<Vec3> = (0..lock.n_sticks())
            .map(|j| {
                let bend = rest_bend(lock, j) - self.bends[j];
                weight_torques[j] + bend * (self.natural_weight * lock.joint_stiffness[j])
            })
            .collect();
        let mut products = DMatrix::from_fn(units.len(), units.len(), |r, c| {
            if r < c { 0.0 } else { dot(&units[r], &units[c], &self.costs) }
        });
        products.fill_upper_triangle_with_lower_triangle();
        (0..units.len()).for_each(|k| products[(k, k)] += self.force_cost);
        let b = DVector::from_fn(units.len(), |r, _| -dot(&units[r], &wished, &self.costs));
        let forces_n: Vec<f64> = nonnegative_least_squares(&products, &b).iter().copied().collect();
        let mut torques = weight_torques.to_vec();
        for (unit, force_n) in units.iter().zip(&forces_n) {
            torques.iter_mut().zip(unit).for_each(|(sum, t)| *sum += t * *force_n);
        }
        Borne { torques, forces_n }
    }
}

/// What the square of a force costs, m/N: one like the lock's weight as much as a joint that is off by the scale of the curls.
///
/// Curves that are drawn, or made of a few markers, have kinks that no likely natural shape has: to straighten them the
/// body would push with hundreds of times the weight.
fn force_cost(lock: &Lock, fall: &Fall, weight_n: f64) -> f64 {
    let curl = |j: usize| {
        let bend = fall.curl_per_m * bends_over_m(lock, j);
        lock.joint_stiffness[j] * bend * bend
    };
    let joints = 1..lock.n_sticks();
    let n = joints.len().max(1) as f64;
    joints.map(curl).sum::<f64>() / n / (weight_n * weight_n)
}

/// The sum of two torques' products over the joints that both have, at a joint's cost.
fn dot(a: &[Vec3], b: &[Vec3], costs: &[f64]) -> f64 {
    a.iter().zip(b).zip(costs).map(|((a, b), cost)| a.dot(b) * cost).sum()
}

/// A point may come as near as it lies at rest, or as the lock's own radius allows, whichever is nearer. The
/// radius is that of `touch`, or, where the body bears the lock, how near the bearing points lie.
fn clearances(ends_m: &[Vec3], surfaces: &[Surface], bearings: &[Bearing], radius_m: f64) -> Vec<f64> {
    let gap_at = |collider: usize, stick: usize| surfaces[collider].gap(ends_m[stick]).distance_m;
    let radius = bearings
        .iter()
        .map(|b| gap_at(b.collider, b.stick))
        .reduce(f64::min)
        .map_or(radius_m, |nearest| nearest.max(0.0));
    (0..surfaces.len())
        .flat_map(|collider| (0..ends_m.len()).map(move |stick| (collider, stick)))
        .map(|(collider, stick)| {
            let bears = bearings.iter().any(|b| b.collider == collider && b.stick == stick);
            let at_rest = gap_at(collider, stick);
            if bears { at_rest } else { f64::min(radius, at_rest) }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::likely::{Bears, Touch};
    use crate::lock::tests::straight;
    use crate::natural::tests::falling;
    use tousle_core::{Attachment, Collider, Shape};

    const DOWN: Vec3 = Vec3::new(0.0, 0.0, -9.81);

    fn only(shape: Shape) -> Body {
        Body {
            colliders: vec![Collider { name: "body".into(), shape, attachment: Attachment::Head }],
            ..Body::none()
        }
    }

    /// A body whose top is as good as flat, and so far below the head's origin.
    fn table(below_m: f64) -> Body {
        only(Shape::Ellipsoid {
            center_m: Vec3::new(0.1, 0.0, -1e4),
            half_axes_m: Vec3::new(1e4, 1e4, 1e4 - below_m),
        })
    }

    /// A horizontal lock in free air holds the moment of everything further out at each joint.
    #[test]
    fn a_cantilever_holds_the_moment_of_its_weight() {
        let lock = Lock::new(&straight(Vec3::zeros(), Vec3::x(), 0.2, 4));
        let rest = rest_state(&lock, DOWN, &Body::none(), &Likely::smooth(&lock, Twist::Free));
        // At the clamp: 1 g/m · 9.81 · 0.2²/2 about y. Half masses at the ends make it exact.
        let expected = 1e-3 * 9.81 * 0.2 * 0.2 / 2.0;
        assert!((rest.torques[0].norm() / expected - 1.0).abs() < 1e-12, "{}", rest.torques[0]);
        assert!(rest.bearings.is_empty());
    }

    /// A lock that lies along a table is borne by it altogether, up to half a stick at the clamp.
    #[test]
    fn a_lock_on_a_table_is_borne() {
        let body = table(2e-3);
        let lock = Lock::new(&straight(Vec3::zeros(), Vec3::x(), 0.2, 10));
        let rest = rest_state(&lock, DOWN, &body, &Likely::smooth(&lock, Twist::Free));
        let borne: f64 = rest.bearings.iter().map(|b| b.force_n).sum();
        let weight = lock.masses_kg.iter().sum::<f64>() * 9.81;
        assert!((borne / weight - 1.0).abs() < 1e-3, "{borne} of {weight}");
        assert!(rest.torques.iter().all(|t| t.norm() < 1e-8), "{:?}", rest.torques);
        assert!(rest.clearances_m.iter().all(|c| (c - 2e-3).abs() < 1e-5));
    }

    /// What lies still on a slope is not about to slide.
    #[test]
    fn friction_at_rest_is_below_its_limit() {
        const FRICTION: f64 = 0.25;
        let body = table(2e-3);
        let lock = Lock::new(&straight(Vec3::zeros(), Vec3::x(), 0.2, 10));
        // As on a table that slopes down across the lock and along it, steeper than friction holds.
        let down = Vec3::new(2.0, 3.0, -9.0);
        let likely = Likely { friction: FRICTION, ..Likely::smooth(&lock, Twist::Held) };
        let rest = rest_state(&lock, down, &body, &likely);
        let shares: Vec<f64> =
            rest.bearings.iter().map(|b| b.rub_n.norm() / (FRICTION * b.force_n)).collect();
        let most = shares.iter().copied().fold(0.0, f64::max);
        assert!((0.5..0.95).contains(&most), "{shares:?}");
    }

    /// Where other locks tell how this one falls, it is known how hard a ball holds its middle up.
    #[test]
    fn a_falling_lock_tells_what_bears_it() {
        const STICK: usize = 10;
        const HALF_N: f64 = 2e-4;
        const WIDTH_M: f64 = 4e-3;
        let mut forces = vec![Vec3::zeros(); 20];
        // The force stands on its stick, which turns with it.
        let mut normal = Vec3::z();
        for _ in 0..30 {
            (forces[STICK - 1], forces[STICK]) = (normal * HALF_N, normal * HALF_N);
            let direction = falling(Vec3::x(), 3e-5, &forces).rest_directions[STICK];
            normal = Vec3::y().cross(&direction) * -1.0;
        }
        let lock = falling(Vec3::x(), 3e-5, &forces);
        let points = lock.rest_points();
        let middle = 0.5 * (points[STICK] + points[STICK + 1]);
        let center_m = middle - normal * (0.01 + 0.5 * WIDTH_M);
        let ball = Shape::Ellipsoid { center_m, half_axes_m: Vec3::repeat(0.01) };
        let body = only(ball);
        let force = |natural: Natural| {
            let touch = Touch { within_m: 0.6 * WIDTH_M, radius_m: 0.5 * WIDTH_M };
            let likely = Likely { twist: Twist::Held, bears: Bears::Sticks, touch, friction: 0.0, natural };
            let rest = rest_state(&lock, DOWN, &body, &likely);
            assert!(rest.bearings.iter().all(|b| b.stick == STICK || b.stick == STICK - 1));
            rest.bearings.iter().map(|b| b.force_n).sum::<f64>()
        };
        let fall = Fall { rate_per_m: 10.0, curl_per_m: 1.0 };
        let (falling, straight) = (force(Natural::Falling(fall)), force(Natural::HALF_STRAIGHT));
        assert!((falling / (2.0 * HALF_N) - 1.0).abs() < 1e-2, "{falling}");
        assert!((straight / (2.0 * HALF_N) - 1.0).abs() > 0.1, "{straight}");
    }

    /// A curve with kinks that no likely shape has is not straightened by whatever force it takes.
    #[test]
    fn a_body_pushes_no_harder_than_like_a_weight() {
        let body = table(1.5e-3);
        let mut kinked = straight(Vec3::zeros(), Vec3::x(), 0.05, 10);
        kinked.bending_stiffness_n_m2 = 1e-5;
        kinked.rest_curve_m.iter_mut().step_by(2).for_each(|point| point.z += 3e-4);
        let lock = Lock::new(&kinked);
        let natural = Natural::Falling(Fall { rate_per_m: 10.0, curl_per_m: 2.0 });
        let touch = Touch { within_m: 4e-3, radius_m: 2e-3 };
        let likely = Likely { twist: Twist::Held, bears: Bears::Sticks, touch, friction: 0.25, natural };
        let rest = rest_state(&lock, DOWN, &body, &likely);
        let borne: f64 = rest.bearings.iter().map(|b| b.force_n).sum();
        let weight = lock.masses_kg.iter().sum::<f64>() * 9.81;
        assert!(borne < 5.0 * weight, "{borne} of {weight}");
    }

    /// A lock of one stick has no joint but the root's, and what weighs nothing lies on nothing.
    #[test]
    fn the_shortest_and_the_lightest_lock_have_a_rest() {
        let natural = Natural::Falling(Fall { rate_per_m: 10.0, curl_per_m: 2.0 });
        let touch = Touch { within_m: 4e-3, radius_m: 2e-3 };
        let likely = Likely { twist: Twist::Held, bears: Bears::Sticks, touch, friction: 0.25, natural };
        let shortest = Lock::new(&straight(Vec3::zeros(), Vec3::x(), 0.05, 1));
        let rest = rest_state(&shortest, DOWN, &table(1.5e-3), &likely);
        assert!(rest.torques[0].norm().is_finite());
        assert!(rest.bearings.iter().all(|b| b.force_n.is_finite()), "{:?}", rest.bearings);
        let lightest = Lock::new(&straight(Vec3::zeros(), Vec3::x(), 0.05, 5));
        let rest = rest_state(&lightest, Vec3::zeros(), &table(1.5e-3), &likely);
        assert_eq!(rest.bearings, []);
        assert!(rest.torques.iter().all(|torque| *torque == Vec3::zeros()));
    }
}
