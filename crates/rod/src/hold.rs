use crate::contact::Surface;
use crate::lock::Lock;
use crate::natural::rest_bend;
use crate::rest::Rest;
use crate::turn::torque_to_load;
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
/// The energy: joints k/2 |c|² − b · c, c = 4 tan(θ/4) along the axis of the turn by θ, which hold a torque τ; weight and
/// bearing forces on sticks that turn; what pushes outwards at the points that the body bears, and turns with its surface.
/// Sticks turned by φ, with ψ = φⱼ − φⱼ₋₁ a joint's is, to second order, τ · φⱼ₋₁ × φⱼ / 2 + ψᵀ (k (1 + σ²)² + M) ψ / 2
/// (`second_bend`). Eliminating sticks from the tip inwards, all of it is positive if every pivot is.
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

/// The second derivative of a joint's energy by a small turn of the stick behind it: per stiffness, and what the torque that it
/// holds adds, which it has by the slope of c.
///
/// For the turn by 4σ at rest and then by ψ, σ(ψ) is the sum rule of modified Rodrigues parameters (Schaub and Junkins,
/// *Analytical Mechanics of Space Systems*, 3.5) to second order in ψ; all but the turn itself in the frame of the stick before.
fn second_bend(sigma: Vec3, torque: Vec3) -> (f64, Matrix3<f64>) {
    let s2 = sigma.norm_squared();
    let grown = (1.0 + s2) * (1.0 + s2);
    // The slope by c: minus what the joint holds.
    let slope = -torque_to_load(sigma * 4.0, torque);
    let along = slope.dot(&sigma);
    let by = slope * (1.0 - s2) + sigma.cross(&slope) * 2.0 + sigma * (2.0 * along);
    let product = sigma * by.transpose();
    (grown, (product + product.transpose() - Matrix3::from_diagonal_element((1.0 + s2) * along)) * 0.5)
}

/// The derivative of a surface's normal by the place, 1/m: how it turns from one point to the next.
fn normal_turns(surface: &Surface, place_m: Vec3) -> Matrix3<f64> {
    let slope = |along: Vec3| {
        let [before, after] = [-1.0, 1.0].map(|side| surface.gap(place_m + along * (side * APART_M)).normal);
        (after - before) / (2.0 * APART_M)
    };
    let turns = Matrix3::from_columns(&[slope(Vec3::x()), slope(Vec3::y()), slope(Vec3::z())]);
    (turns + turns.transpose()) * 0.5
}

/// How far apart two normals are that tell how a surface is curved, m.
const APART_M: f64 = 1e-3;

/// What acts on each stick at rest.
struct Loads {
    /// Second derivative of the weight's and the bearing forces' energy by the stick's turn, N·m.
    weight: Vec<Matrix3<f64>>,
    /// The torque that the joint at its near end holds, N·m.
    torques: Vec<Vec3>,
    /// By how many times the joint is stiffer as it is bent at rest.
    bent: Vec<f64>,
    /// What the torque that the joint holds adds to its second derivative, as it is bent at rest, N·m.
    held: Vec<Matrix3<f64>>,
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
            let (surface, place_m) = (&support.surfaces[bearing.collider], ends_m[bearing.stick]);
            let normal = surface.gap(place_m).normal;
            forces[bearing.stick] += normal * bearing.force_n + bearing.rub_n;
            // Friction may give way: only what pushes outwards is counted on. Along a round surface that push pushes off.
            borne[bearing.stick] += normal * normal.transpose() * support.stiffness
                - normal_turns(surface, place_m) * bearing.force_n;
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
        let sigmas = (0..n).map(|j| {
            let bend = rest_bend(lock, j);
            let angle = bend.norm();
            if angle > 0.0 { bend * (libm::tan(0.25 * angle) / angle) } else { bend }
        });
        let (bent, held) =
            sigmas.zip(&rest.torques).map(|(sigma, torque)| second_bend(sigma, *torque)).unzip();
        Self { weight, torques: rest.torques.clone(), bent, held, borne, carried }
    }

    /// Whether a lock with these joints stays where it rests.
    fn hold(&self, lock: &Lock, joint_stiffness: &[f64]) -> bool {
        // What is further out, as a quadratic form of the near end's displacement v and the turn a of the stick
        // before: vᵀ A v / 2 + vᵀ B a + aᵀ C a / 2.
        let (mut a, mut b, mut c) = (Matrix3::zeros(), Matrix3::zeros(), Matrix3::zeros());
        for j in (0..lock.n_sticks()).rev() {
            a += self.borne[j];
            let k = Matrix3::from_diagonal_element(joint_stiffness[j] * self.bent[j]) + self.held[j];
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
    use nalgebra::{Quaternion, UnitQuaternion};
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

    /// A joint that is sharply bent at rest: its energy beside the two sticks' turns, told by differences.
    #[test]
    fn a_joint_is_as_stiff_as_its_energy_has_it() {
        let (k, sigma, torque) = (0.7, Vec3::new(0.1, -0.25, 0.15), Vec3::new(0.4, 0.9, -0.6));
        let bend = |turn: UnitQuaternion<f64>| turn.imag() * (4.0 / (1.0 + turn.w));
        let at_rest = {
            let cos = (1.0 - sigma.norm_squared()) / (1.0 + sigma.norm_squared());
            UnitQuaternion::from_quaternion(Quaternion::from_parts(cos, sigma * (1.0 + cos)))
        };
        let turned = |turns: [Vec3; 2]| {
            let [before, behind] = turns.map(UnitQuaternion::from_scaled_axis);
            bend(before.inverse() * behind * at_rest)
        };
        // What is left of k c − b by the sticks' turns is what the joint does not hold.
        let slope_of_bend = Matrix3::from_fn(|i, j| {
            let along = Vec3::ith(j, 1e-5);
            (turned([Vec3::zeros(), along]) - turned([Vec3::zeros(), -along]))[i] / 2e-5
        });
        let load = bend(at_rest) * k + slope_of_bend.transpose().try_inverse().unwrap() * torque;
        let energy = |turns: [Vec3; 2]| {
            let bend = turned(turns);
            0.5 * k * bend.norm_squared() - load.dot(&bend)
        };
        let (grown, held) = second_bend(sigma, torque);
        let own = Matrix3::from_diagonal_element(k * grown) + held;
        let across = torque.cross_matrix() * 0.5 - own;
        for turns in [[1, 0], [0, 1], [1, 1], [1, -1]] {
            let [a, b] = [Vec3::new(0.3, -0.5, 0.8), Vec3::new(-0.6, 0.2, 0.7)];
            let [a, b] = [a * f64::from(turns[0]), b * f64::from(turns[1])];
            let expected = a.dot(&(own * a)) + 2.0 * b.dot(&(across * a)) + b.dot(&(own * b));
            let at = |share: f64| energy([a * share, b * share]);
            let found = (at(1e-3) - 2.0 * at(0.0) + at(-1e-3)) / 1e-6;
            assert!(
                (found - expected).abs() < 1e-5 * (1.0 + expected.abs()),
                "{turns:?}: {found} {expected}"
            );
        }
    }

    #[test]
    fn hair_that_hangs_is_left_alone() {
        assert_eq!(held(-Vec3::z(), 0.0), 1.0);
        assert_eq!(held(-Vec3::z(), 1e-9), 1.0);
    }
}
