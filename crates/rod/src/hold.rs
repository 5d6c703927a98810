use crate::contact::Surface;
use crate::lock::Lock;
use crate::rest::Rest;
use nalgebra::Matrix3;
use tousle_core::Vec3;

/// How much stiffer than the least that keeps a style up its joints are made. At 1 a style would just not fall, and
/// lean far in the weakest wind; if it rises, styled hair gets stiffer near its roots and is moved less.
const MARGIN: f64 = 2.0;

/// Stiffness tried first, over what a joint carries: natural turns of 16 rad.
const SOFTEST: f64 = 1.0 / 16.0;

/// Doublings of it after which a lock is left as it is.
const DOUBLINGS: u32 = 24;

/// A body that bears a lock at rest: the spring of each bearing point, N/m.
#[derive(Clone, Copy, Debug)]
pub struct Support<'a> {
    /// The body's surfaces, in the body's order.
    pub surfaces: &'a [Surface],
    /// Stiffness of a contact, N/m.
    pub stiffness: f64,
}

/// Makes joints stiffer where a lock would not stay in its rest curve. Out: by how many times at most; 1 if it stays.
///
/// Whatever its stiffness, a lock is in balance in its rest curve, since its natural shape is chosen so. But a soft
/// lock that leans far out needs joints that are wound up, and unwinds sideways at the first touch (as a cantilever
/// under too large a load buckles). In life its neighbors keep it up, which are not simulated; here each joint gets
/// at least α times the moment it carries, |τ| + what stands on its stick pushes, with twice the least α for which
/// the second derivative of the energy is positive. Joints that carry nothing, as in hair that hangs, stay as they are.
///
/// The energy: joints k/2 |φⱼ − φⱼ₋₁|² with the torque τ they hold, which turns with its sticks (τ · φⱼ₋₁ × φⱼ / 2);
/// weight and bearing forces on sticks that turn; springs at the points that the body bears. Eliminating sticks from
/// the tip inwards, it is positive if every pivot is. Natural turns are taken to be small, which they are once the
/// joints hold.
pub fn hold_rest(lock: &mut Lock, rest: &Rest, gravity: Vec3, support: &Support<'_>) -> f64 {
    let loads = Loads::new(lock, rest, gravity, support);
    if loads.hold(lock, &lock.joint_stiffness) {
        return 1.0;
    }
    let stiffness = |alpha: f64| -> Vec<f64> {
        let at_least = |(k, carried): (&f64, &f64)| k.max(alpha * carried);
        lock.joint_stiffness.iter().zip(&loads.carried).map(at_least).collect()
    };
    let holds = |alpha: f64| loads.hold(lock, &stiffness(alpha));
    let Some(mut enough) =
        (0..DOUBLINGS).map(|n| SOFTEST * f64::from(1_u32 << n)).find(|alpha| holds(*alpha))
    else {
        return 1.0;
    };
    // Three halvings of the exponent leave a tenth, which the margin hides.
    let mut ratio = 2.0;
    for _ in 0..3 {
        ratio = f64::sqrt(ratio);
        if holds(enough / ratio) {
            enough /= ratio;
        }
    }
    let held = stiffness(MARGIN * enough);
    let times = |(held, own): (&f64, &f64)| if *own > 0.0 || held > own { held / own } else { 1.0 };
    let most = held.iter().zip(&lock.joint_stiffness).map(times).fold(1.0, f64::max);
    lock.joint_stiffness = held;
    most
}

/// What acts on each stick at rest.
struct Loads {
    /// Second derivative of the weight's and the bearing forces' energy by the stick's turn, N·m.
    weight: Vec<Matrix3<f64>>,
    /// The torque that the joint at its near end holds, N·m.
    torques: Vec<Vec3>,
    /// Stiffness of what bears its far end, N/m.
    borne: Vec<Matrix3<f64>>,
    /// What the joint carries, N·m.
    carried: Vec<f64>,
}

impl Loads {
    fn new(lock: &Lock, rest: &Rest, gravity: Vec3, support: &Support<'_>) -> Self {
        let n = lock.n_sticks();
        let mut ends_m = vec![Vec3::zeros(); n];
        lock.place(&lock.rest_directions, &mut ends_m);
        let mut forces: Vec<Vec3> = lock.masses_kg.iter().map(|m| gravity * *m).collect();
        let mut borne = vec![Matrix3::zeros(); n];
        for bearing in &rest.bearings {
            let normal = support.surfaces[bearing.collider].gap(ends_m[bearing.stick]).normal;
            forces[bearing.stick] += normal * bearing.force_n + bearing.rub_n;
            // Friction may give way: only what pushes outwards is counted on.
            borne[bearing.stick] += normal * normal.transpose() * support.stiffness;
        }
        let mut weight = vec![Matrix3::zeros(); n];
        let mut carried = vec![0.0; n];
        let mut pull = Vec3::zeros();
        for j in (0..n).rev() {
            pull += forces[j];
            let (direction, length) = (lock.rest_directions[j], lock.lengths_m[j]);
            let along = pull.dot(&direction);
            let outer = pull * direction.transpose();
            weight[j] = (Matrix3::from_diagonal_element(along) - (outer + outer.transpose()) * 0.5) * length;
            carried[j] = rest.torques[j].norm() + f64::max(0.0, -along) * length;
        }
        Self { weight, torques: rest.torques.clone(), borne, carried }
    }

    /// Whether a lock with these joints stays where it rests.
    fn hold(&self, lock: &Lock, joint_stiffness: &[f64]) -> bool {
        // What is further out, as a quadratic form of the near end's displacement v and the turn a of the stick
        // before: vᵀ A v / 2 + vᵀ B a + aᵀ C a / 2.
        let (mut a, mut b, mut c) = (Matrix3::zeros(), Matrix3::zeros(), Matrix3::zeros());
        for j in (0..lock.n_sticks()).rev() {
            a += self.borne[j];
            let k = Matrix3::from_diagonal_element(joint_stiffness[j]);
            let lever = -lock.rest_directions[j].cross_matrix() * lock.lengths_m[j];
            let own = c + lever.transpose() * b + b.transpose() * lever + lever.transpose() * a * lever;
            let pivot = own + self.weight[j] + k;
            let Some(inverse) = pivot.cholesky().map(|pivot| pivot.inverse()) else { return false };
            let by_place = lever.transpose() * a + b.transpose();
            let twist = if j == 0 { Matrix3::zeros() } else { self.torques[j].cross_matrix() * 0.5 };
            let by_turn = twist - k;
            let passed_on = inverse * by_turn;
            a -= by_place.transpose() * inverse * by_place;
            b = -by_place.transpose() * passed_on;
            c = k - by_turn.transpose() * passed_on;
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::likely::{Likely, Twist};
    use crate::lock::tests::straight;
    use crate::rest::rest_state;
    use tousle_core::{Body, Strand};

    const DOWN: Vec3 = Vec3::new(0.0, 0.0, -9.81);
    const NOTHING: Support<'static> = Support { surfaces: &[], stiffness: 0.0 };

    /// By how many times the joints of a strand of 1 g/m and 20 cm are made stiffer.
    fn held(direction: Vec3, stiffness: f64) -> f64 {
        let strand =
            Strand { bending_stiffness_n_m2: stiffness, ..straight(Vec3::zeros(), direction, 0.2, 40) };
        let mut lock = Lock::new(&strand);
        let rest = rest_state(&lock, DOWN, &Body::none(), &Likely::smooth(&lock, Twist::Held));
        hold_rest(&mut lock, &rest, DOWN, &NOTHING)
    }

    /// A column buckles under its own weight at q L³ / EI = 7.84, a cantilever whose weight is at right angles to it
    /// sideways at 12.85 (Timoshenko and Gere, *Theory of Elastic Stability*, 2.13 and 6.3; EI = GJ).
    #[test]
    fn columns_and_cantilevers_buckle_where_theory_has_it() {
        for (direction, critical) in [(Vec3::z(), 7.84), (Vec3::x(), 12.85)] {
            let load = 1e-3 * 9.81 * 0.2_f64.powi(3);
            let stays = held(direction, 1.05 * load / critical);
            let falls = held(direction, 0.95 * load / critical);
            assert!(stays == 1.0 && falls > 1.0, "{direction}: {stays} {falls}");
        }
    }

    #[test]
    fn hair_that_hangs_is_left_alone() {
        assert_eq!(held(-Vec3::z(), 0.0), 1.0);
        assert_eq!(held(-Vec3::z(), 1e-9), 1.0);
    }
}
