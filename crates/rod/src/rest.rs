use crate::contact::Surface;
use crate::lock::Lock;
use crate::nnls::nonnegative_least_squares;
use crate::turn::{any_perpendicular, shortest_turn};
use nalgebra::{DMatrix, DVector};
use tousle_core::{Body, Pose, Vec3};

/// What a joint does against a turn of its stick about the stick itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Twist {
    /// Nothing: the lock is free to roll, and the moment about a stick goes nowhere.
    Free,
    /// It holds the moment as it does across the stick: an elastic rod.
    Held,
}

/// How near to a body hair comes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// A point at rest whose center line is this near to a surface may be borne by it, m.
    pub within_m: f64,
    /// How near a center line may come that is not borne at rest, m.
    pub radius_m: f64,
}

impl Touch {
    /// Judged by a lock's width alone.
    pub fn by_width(lock: &Lock) -> Self {
        Self { within_m: lock.width_m, radius_m: 0.5 * lock.width_m }
    }

    /// Judged by how near the locks of a hairstyle come to the body at rest: those that lie on it show how thick hair
    /// is to a surface, whatever it is to the wind. `None` where no lock comes near, or where they lie inside.
    ///
    /// The radius is the gap that a twentieth of the locks that come near fall short of. A stick between two points
    /// on a round body lies deeper in than they do, so a point may be borne from half a radius farther out.
    pub fn by_rest(locks: &[Lock], body: &Body) -> Option<Self> {
        let surfaces = Surface::of_body(body, &Pose::identity());
        let mut nearest: Vec<f64> = locks.iter().filter_map(|lock| nearest_gap(lock, &surfaces)).collect();
        nearest.sort_by(f64::total_cmp);
        let radius_m = *nearest.get(nearest.len() / 20)?;
        (radius_m > 0.0).then_some(Self { within_m: 1.5 * radius_m, radius_m })
    }
}

/// The least gap of a lock's points that lie beyond its first stick and within a width of a surface.
fn nearest_gap(lock: &Lock, surfaces: &[Surface]) -> Option<f64> {
    let mut ends_m = vec![Vec3::zeros(); lock.n_sticks()];
    lock.place(&lock.rest_directions, &mut ends_m);
    let near = |end: &Vec3| {
        let gaps = surfaces.iter().filter_map(|s| s.gap_within(*end, lock.width_m));
        gaps.map(|gap| gap.distance_m).reduce(f64::min)
    };
    ends_m.iter().skip(1).filter_map(near).reduce(f64::min)
}

/// How a lock that hangs still carries its weight: what its joints hold and what the body bears.
#[derive(Clone, Debug, PartialEq)]
pub struct Rest {
    /// Torque that the joint at the root's end of each stick holds at rest, N·m, head axes; across the
    /// stick where twist is free.
    ///
    /// Against the joint's stiffness it is the turn by which the natural, force-free shape is bent the other way.
    pub torques: Vec<Vec3>,
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

/// What is taken to be likely of a lock that hangs still, where its rest curve leaves it open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Likely {
    /// What its joints do against twist.
    pub twist: Twist,
    /// How near it must be to the body to be borne.
    pub touch: Touch,
    /// Coulomb's coefficient up to which the body holds it along its surface, ≥ 0.
    pub friction: f64,
    /// How much a natural shape that is nearly straight counts beside joints that hold little, 0 to 1.
    pub straightness: f64,
}

impl Likely {
    /// Of what a rest curve leaves open: a natural shape without bends is as likely as joints without load. On the
    /// development captures anything from 0.3 to 0.7 scores alike, and better than 0 or 1.
    const STRAIGHTNESS: f64 = 0.5;

    /// Hair on a body that rubs, near by the lock's own width: for measuring and for simulating alike.
    pub fn hair(lock: &Lock, body: &Body) -> Self {
        let friction = body.friction;
        Self { friction, straightness: Self::STRAIGHTNESS, ..Self::smooth(lock, Twist::Held) }
    }

    /// A lock whose joints hold as little as can be, on a smooth body, near by its own width.
    pub fn smooth(lock: &Lock, twist: Twist) -> Self {
        Self { twist, touch: Touch::by_width(lock), friction: 0.0, straightness: 0.0 }
    }
}

/// Contacts a lock may have before every second, third … is left out of the search for what bears it.
const MAX_CANDIDATES: usize = 64;

/// How a lock carries its weight in its rest curve, under a gravity in head axes, m/s², on a body at rest.
///
/// A rest curve alone does not say how much of the weight the hair holds by itself and how much lies on the
/// head: any force of the body that pushes outwards is possible wherever hair touches it. Of all of them the
/// one is taken that leaves the least of two energies, shared out by `likely.straightness` s: what the joints
/// hold, Σ T²/k, as if the hair had been laid down, not pressed; and what it would take to straighten the natural
/// shape, Σ k (c + T/k)², c being the bend at rest. Their weighted sum is least where Σ (T + s k c)²/k is.
pub fn rest_state(lock: &Lock, gravity: Vec3, body: &Body, likely: &Likely) -> Rest {
    let Likely { twist, touch, friction, straightness } = *likely;
    let surfaces = Surface::of_body(body, &Pose::identity());
    let n = lock.n_sticks();
    let mut ends_m = vec![Vec3::zeros(); n];
    lock.place(&lock.rest_directions, &mut ends_m);
    let candidates = candidates(lock, &ends_m, &surfaces, touch.within_m, friction);
    let weight: Vec<Vec3> = lock.masses_kg.iter().map(|m| gravity * *m).collect();
    let weight_torques = joint_torques(lock, &weight, twist);
    let unit_torques: Vec<Vec<Vec3>> = candidates
        .iter()
        .map(|c| {
            let mut push = vec![Vec3::zeros(); n];
            push[c.stick] = c.normal + c.along;
            joint_torques(lock, &push, twist)
        })
        .collect();
    let wished: Vec<Vec3> = weight_torques
        .iter()
        .enumerate()
        .map(|(j, torque)| torque + rest_bend(lock, j) * (straightness * lock.joint_stiffness[j]))
        .collect();
    let forces = bearing_forces(lock, &wished, &unit_torques);
    let mut torques = weight_torques;
    let mut bearings: Vec<Bearing> = Vec::new();
    for ((candidate, unit), force_n) in candidates.iter().zip(&unit_torques).zip(forces) {
        if force_n > 0.0 {
            let Candidate { collider, stick, along, .. } = *candidate;
            torques.iter_mut().zip(unit).for_each(|(sum, t)| *sum += t * force_n);
            // The ways in which one point may be borne follow one another.
            match bearings.last_mut().filter(|b| b.collider == collider && b.stick == stick) {
                Some(bearing) => {
                    bearing.force_n += force_n;
                    bearing.rub_n += along * force_n;
                }
                None => bearings.push(Bearing { collider, stick, force_n, rub_n: along * force_n }),
            }
        }
    }
    let clearances_m = clearances(&ends_m, &surfaces, &bearings, touch.radius_m);
    Rest { torques, bearings, clearances_m }
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

/// The bend of a joint at rest, a rotation vector, head axes. The joint at the root is straight as it grows.
fn rest_bend(lock: &Lock, joint: usize) -> Vec3 {
    let directions = &lock.rest_directions;
    if joint == 0 { Vec3::zeros() } else { shortest_turn(directions[joint - 1], directions[joint]) }
}

/// A way in which a point may be borne: by 1 N outwards, and what friction adds to it along the surface.
struct Candidate {
    collider: usize,
    stick: usize,
    normal: Vec3,
    along: Vec3,
}

/// With friction, each point may be borne in four ways: the edges of a pyramid within Coulomb's cone.
fn candidates(
    lock: &Lock,
    ends_m: &[Vec3],
    surfaces: &[Surface],
    within_m: f64,
    friction: f64,
) -> Vec<Candidate> {
    let mut points = Vec::new();
    for (collider, surface) in surfaces.iter().enumerate() {
        for (stick, end) in ends_m.iter().enumerate() {
            if let Some(gap) = surface.gap_within(*end, within_m) {
                points.push((collider, stick, gap.normal));
            }
        }
    }
    let stride = points.len().div_ceil(MAX_CANDIDATES).max(1);
    let ways = |(collider, stick, normal): (usize, usize, Vec3)| {
        let across = across(normal, lock.rest_directions[stick]) * friction;
        let beside = across.cross(&normal);
        let edges = if friction > 0.0 { vec![across, -across, beside, -beside] } else { vec![across] };
        edges.into_iter().map(move |along| Candidate { collider, stick, normal, along })
    };
    points.into_iter().step_by(stride).flat_map(ways).collect()
}

/// A unit vector along a surface, across the stick that lies on it.
fn across(normal: Vec3, direction: Vec3) -> Vec3 {
    let across = direction.cross(&normal);
    if across.norm() > 1e-3 { across.normalize() } else { any_perpendicular(normal) }
}

/// The forces ≥ 0 that leave the least Σ torque²/stiffness, with those that are there without them.
fn bearing_forces(lock: &Lock, without: &[Vec3], units: &[Vec<Vec3>]) -> Vec<f64> {
    if units.is_empty() {
        return Vec::new();
    }
    // A lock without any stiffness is judged by torque alone.
    let softness: Vec<f64> =
        lock.joint_stiffness.iter().map(|k| if *k > 0.0 { 1.0 / k } else { 1.0 }).collect();
    let dot = |a: &[Vec3], b: &[Vec3]| -> f64 {
        a.iter().zip(b).zip(&softness).map(|((a, b), soft)| a.dot(b) * soft).sum()
    };
    let g = DMatrix::from_fn(units.len(), units.len(), |r, c| dot(&units[r], &units[c]));
    let b = DVector::from_fn(units.len(), |r, _| -dot(&units[r], without));
    nonnegative_least_squares(&g, &b).iter().copied().collect()
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
    use crate::lock::tests::straight;
    use tousle_core::{Attachment, Collider, Shape};

    const DOWN: Vec3 = Vec3::new(0.0, 0.0, -9.81);

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
        let table = Shape::Ellipsoid {
            center_m: Vec3::new(0.1, 0.0, -1e4),
            half_axes_m: Vec3::new(1e4, 1e4, 1e4 - 2e-3),
        };
        let body = Body {
            colliders: vec![Collider { name: "table".into(), shape: table, attachment: Attachment::Head }],
            ..Body::none()
        };
        let lock = Lock::new(&straight(Vec3::zeros(), Vec3::x(), 0.2, 10));
        let rest = rest_state(&lock, DOWN, &body, &Likely::smooth(&lock, Twist::Free));
        let borne: f64 = rest.bearings.iter().map(|b| b.force_n).sum();
        let weight = lock.masses_kg.iter().sum::<f64>() * 9.81;
        assert!((borne / weight - 1.0).abs() < 1e-3, "{borne} of {weight}");
        assert!(rest.torques.iter().all(|t| t.norm() < 1e-8), "{:?}", rest.torques);
        assert!(rest.clearances_m.iter().all(|c| (c - 2e-3).abs() < 1e-5));
    }
}
