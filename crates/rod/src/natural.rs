use crate::likely::Twist;
use crate::lock::Lock;
use crate::rest::{joint_torques, weight_on_points};
use crate::turn::{shortest_rotation, shortest_turn};
use nalgebra::UnitQuaternion;
use rayon::prelude::*;
use tousle_core::{Vec3, median_high};

/// What shape a lock is likely to have without load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Natural {
    /// Straight; and how much that counts beside joints that hold little, 0 to 1.
    Straight(f64),
    /// As the other locks of its hairstyle fall.
    Falling(Fall),
}

impl Natural {
    /// Of what a rest curve leaves open: a natural shape without bends is as likely as joints without load. On the
    /// development captures anything from 0.3 to 0.7 scores alike, and better than 0 or 1.
    pub const HALF_STRAIGHT: Self = Self::Straight(0.5);

    /// How much it counts beside joints that hold little, 0 to 1.
    pub(crate) fn weight(&self) -> f64 {
        match self {
            Self::Straight(weight) => *weight,
            Self::Falling(_) => 1.0,
        }
    }
}

/// How the natural shapes of a hairstyle's locks fall.
///
/// Hair that is combed or cut to fall bends downwards by itself, the more the farther it points from there: the
/// curvature of its natural shape is a rate times the sine of its angle with the vertical, and curls beside that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fall {
    /// The rate, 1/m.
    pub rate_per_m: f64,
    /// How much curls add in each direction across the lock, 1/m: the scale of a t distribution with
    /// four degrees of freedom.
    pub curl_per_m: f64,
}

impl Fall {
    /// So that a few sharp bends, where hair is laid over an ear or a shoulder, are left as they are.
    const FREEDOM: f64 = 4.0;

    /// Joints that it takes to tell how a hairstyle falls.
    const ENOUGH_JOINTS: usize = 30;

    /// Sine of the angle with the vertical below which a joint does not tell the rate: its curls are more.
    const MIN_SINE: f64 = 0.2;

    /// The median of |r|²/σ² for two numbers r of the t distribution with four degrees of freedom and scale σ.
    const MEDIAN_SQUARE: f64 = 4.0 * (core::f64::consts::SQRT_2 - 1.0);

    /// Told by locks that nothing bears under a gravity in head axes, m/s²: their natural shape is known. The medians of
    /// all joints; `None` where too few tell.
    pub(crate) fn of<'a>(free: impl ParallelIterator<Item = &'a Lock>, gravity: Vec3) -> Option<Self> {
        let joints: Vec<FreeJoint> = free.flat_map_iter(|lock| FreeJoint::all(lock, gravity)).collect();
        let telling = joints.iter().filter(|joint| joint.fall.norm() > Self::MIN_SINE);
        let rates: Vec<f64> = telling.map(|j| j.curvature.dot(&j.fall) / j.fall.norm_squared()).collect();
        if rates.len() < Self::ENOUGH_JOINTS {
            return None;
        }
        let rate_per_m = median_high(rates)?;
        let curls = joints.iter().map(|j| (j.curvature - j.fall * rate_per_m).norm_squared()).collect();
        let curl_per_m = (median_high(curls)? / Self::MEDIAN_SQUARE).sqrt();
        (curl_per_m > 0.0).then_some(Self { rate_per_m, curl_per_m })
    }

    /// How much a joint counts whose natural curvature is off by so much, beside one that falls as it should.
    pub(crate) fn trust(&self, off_per_m: Vec3) -> f64 {
        let off2 = off_per_m.norm_squared() / (self.curl_per_m * self.curl_per_m);
        (Self::FREEDOM + 2.0) / (Self::FREEDOM + off2)
    }
}

/// A joint of a lock that nothing bears.
struct FreeJoint {
    /// How its natural shape is curved, 1/m.
    curvature: Vec3,
    /// How it would be if it fell with a rate of 1, as long as the sine of its angle with the vertical.
    fall: Vec3,
}

impl FreeJoint {
    fn all(lock: &Lock, gravity: Vec3) -> Vec<Self> {
        if !lock.is_stiff() {
            return Vec::new();
        }
        let torques = joint_torques(lock, &weight_on_points(lock, gravity), Twist::Held);
        let falls = falls(lock, &torques, gravity);
        let joint = |j: usize| Self { curvature: curvature(lock, &torques, j), fall: falls[j] };
        (1..lock.n_sticks()).map(joint).collect()
    }
}

/// The curvature of the natural shape at a joint beyond the root, 1/m: what the joint leaves of the rest curve when it lets go.
pub(crate) fn curvature(lock: &Lock, torques: &[Vec3], joint: usize) -> Vec3 {
    (rest_bend(lock, joint) + torques[joint] / lock.joint_stiffness[joint]) / bends_over_m(lock, joint)
}

/// At each joint, the curvature of a shape that falls with a rate of 1 and points where the natural one does; turned back
/// to where the stick is at rest.
///
/// The natural shape is what is left of the rest curve when the joints let go of their torques. Zero at the root.
pub(crate) fn falls(lock: &Lock, torques: &[Vec3], gravity: Vec3) -> Vec<Vec3> {
    let mut falls = vec![Vec3::zeros(); lock.n_sticks()];
    let Some(down) = gravity.try_normalize(0.0) else { return falls };
    // Hair all but without stiffness lets go by more turns than can be counted, and is left as it lies.
    let let_go =
        |j: usize| Some(torques[j] / lock.joint_stiffness[j]).filter(is_countable).unwrap_or_default();
    // From rest to the natural shape.
    let mut turn = UnitQuaternion::from_scaled_axis(let_go(0));
    for (j, fall) in falls.iter_mut().enumerate().skip(1) {
        let [before, direction] = [lock.rest_directions[j - 1], lock.rest_directions[j]];
        let from = turn * before;
        turn *= UnitQuaternion::from_scaled_axis(rest_bend(lock, j) + let_go(j))
            * shortest_rotation(before, direction).inverse();
        if let Some(middle) = (from + turn * direction).try_normalize(1e-9) {
            *fall = turn.inverse() * middle.cross(&down);
        }
    }
    falls
}

/// Whether a rotation vector is short enough to tell where it leads.
fn is_countable(turn: &Vec3) -> bool {
    turn.amax() < 1e6
}

/// The bend of a joint at rest, a rotation vector, head axes. The joint at the root is straight as it grows.
pub(crate) fn rest_bend(lock: &Lock, joint: usize) -> Vec3 {
    let directions = &lock.rest_directions;
    if joint == 0 { Vec3::zeros() } else { shortest_turn(directions[joint - 1], directions[joint]) }
}

/// The length that a joint beyond the root bends for, m.
pub(crate) fn bends_over_m(lock: &Lock, joint: usize) -> f64 {
    0.5 * (lock.lengths_m[joint - 1] + lock.lengths_m[joint])
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use tousle_core::{Along, Strand};

    const DOWN: Vec3 = Vec3::new(0.0, 0.0, -9.81);

    /// A strand of 30 cm with sticks of 15 mm that hangs as it would by itself, but for its weight: 1 g/m.
    ///
    /// It grows in the direction `root` and falls with a rate of 10/m without load. `forces` act on its points beside
    /// its weight, N.
    pub(crate) fn falling(root: Vec3, stiffness: f64, forces: &[Vec3]) -> Lock {
        const LENGTH_M: f64 = 0.015;
        let n = 20;
        let mut natural = vec![root];
        for j in 1..n {
            // The middle between two sticks is where the curvature is told.
            let mut next = natural[j - 1];
            for _ in 0..50 {
                let middle = (natural[j - 1] + next).normalize();
                let turn = middle.cross(&-Vec3::z()) * (10.0 * LENGTH_M);
                next = UnitQuaternion::from_scaled_axis(turn) * natural[j - 1];
            }
            natural.push(next);
        }
        let mut lock = strand(&natural, LENGTH_M, stiffness);
        // The rest curve that is in balance with the weight.
        for _ in 0..200 {
            let mut pulls = weight_on_points(&lock, DOWN);
            pulls.iter_mut().zip(forces).for_each(|(pull, force)| *pull += force);
            let torques = joint_torques(&lock, &pulls, Twist::Held);
            let mut directions = Vec::new();
            // From the natural shape to rest.
            let mut turn = UnitQuaternion::from_scaled_axis(-torques[0] / lock.joint_stiffness[0]);
            directions.push(turn * natural[0]);
            for j in 1..n {
                // Of the plane, in which all of this happens, every axis is the same for both shapes.
                turn = UnitQuaternion::from_scaled_axis(-torques[j] / lock.joint_stiffness[j]) * turn;
                directions.push(turn * natural[j]);
            }
            // Half the way: soft locks would swing to and fro.
            let halfway = |(new, old): (&Vec3, &Vec3)| (new + old).normalize();
            directions = directions.iter().zip(&lock.rest_directions).map(halfway).collect();
            lock = strand(&directions, LENGTH_M, stiffness);
        }
        lock
    }

    fn strand(directions: &[Vec3], length_m: f64, stiffness: f64) -> Lock {
        let mut points = vec![Vec3::zeros()];
        for direction in directions {
            points.push(points[points.len() - 1] + direction * length_m);
        }
        Lock::new(&Strand {
            name: "falling".into(),
            length_m: length_m * directions.len() as f64,
            rest_curve_m: points,
            linear_density_kg_per_m: 1e-3,
            lock_width_m: 4e-3,
            bending_stiffness_n_m2: stiffness,
            internal_damping_secs: 0.02,
            along: Along::default(),
            holds_style: false,
        })
    }

    /// However far their weight pulls them down.
    #[test]
    fn free_locks_tell_how_they_fall() {
        for stiffness in [1e-3, 1e-4, 3e-5] {
            let locks = [falling(Vec3::x(), stiffness, &[]), falling(Vec3::y(), stiffness, &[])];
            let fall = Fall::of(locks.par_iter(), DOWN).unwrap();
            assert!((fall.rate_per_m - 10.0).abs() < 0.05, "{stiffness}: {fall:?}");
            assert!(fall.curl_per_m < 0.1, "{stiffness}: {fall:?}");
        }
    }

    #[test]
    fn hair_without_stiffness_is_left_as_it_lies() {
        let mut lock = falling(Vec3::x(), 1e-4, &[]);
        lock.joint_stiffness.fill(1e-300);
        let torques = joint_torques(&lock, &weight_on_points(&lock, DOWN), Twist::Held);
        assert!(falls(&lock, &torques, DOWN).iter().all(|fall| fall.iter().all(|x| x.is_finite())));
    }

    #[test]
    fn few_joints_tell_nothing() {
        let lock = falling(Vec3::x(), 1e-4, &[]);
        assert_eq!(Fall::of([&lock].into_par_iter(), DOWN), None);
        assert_eq!(Fall::of([&lock, &lock].into_par_iter(), Vec3::zeros()), None);
    }
}
