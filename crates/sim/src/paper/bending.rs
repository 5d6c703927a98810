use super::{Batch, Work};
use tousle_lanes::{Lane, Turn, Vector, angle_per_sine, series};
use tousle_rod::{ANGLE_OVER_SINE, shortest_rotation, shortest_turn};

impl<L: Lane> Batch<L> {
    /// τ (Φ0 − Φ) of E1, and the hair's internal damping: what each joint does to the stick that hangs on it.
    ///
    /// Φ is the turn from where the stick before carries this one's rest direction. τ Φ0 is what the joint holds
    /// at rest; kept as a torque it needs no bound on Φ0, which for soft hair is many turns. The axes that carry
    /// it are turned along the strand by the shortest way, so a lock may roll but stores no twist.
    #[inline(always)]
    pub(super) fn bend(&self, work: &mut [Work<L>]) {
        let mut axes = Turn::identity(self.damping_secs);
        let mut rate_before = Vector::none(self.damping_secs);
        for ((stick, motion), work) in self.sticks.iter().zip(&self.motions).zip(work) {
            let direction = motion.direction;
            let carried = axes.rotate(stick.rest_direction);
            let (angles, turn) = shortest(carried, direction);
            let bent = (motion.rate - rate_before).mul_add(self.damping_secs, angles);
            let torque = bent.mul_add(-stick.stiffness, axes.rotate(stick.rest_torque));
            work.bending_torque = torque.across(direction);
            axes = turn.after(axes);
            rate_before = motion.rate;
        }
    }
}

/// The shortest turn from one unit vector to another: as a rotation vector and as a rotation
/// ([`shortest_turn`], [`shortest_rotation`]).
#[inline(always)]
fn shortest<L: Lane>(from: Vector<L>, to: Vector<L>) -> (Vector<L>, Turn<L>) {
    let cross = from.cross(to);
    let cos = from.dot(to);
    let sin2 = cross.norm_squared();
    let mut per_sine = series(sin2, ANGLE_OVER_SINE);
    let mut turn = Turn { w: from.x.same(1.0) + cos, v: cross }.normalized();
    let zero = from.x.same(0.0);
    // The series is for less than 10 degrees.
    let fits = (from.x.same(SERIES_SIN2) - sin2).min(cos);
    if !fits.all_above(zero) {
        per_sine = fits.above(zero, per_sine, angle_per_sine(sin2, cos));
    }
    let mut angles = cross * per_sine;
    // Folded back, by axes of which there are many.
    let folded = from.x.same(FOLDED_COS) - cos;
    if folded.any_above(zero) {
        for lane in (0..L::N).filter(|lane| folded.get(*lane) > 0.0) {
            let (from, to) = (from.get(lane), to.get(lane));
            angles.set(lane, shortest_turn(from, to));
            let rotation = shortest_rotation(from, to);
            turn.w.set(lane, rotation.w);
            turn.v.set(lane, rotation.imag());
        }
    }
    (angles, turn)
}

/// Where the series of [`ANGLE_OVER_SINE`] ends.
const SERIES_SIN2: f64 = 0.03;

/// Below this cosine a turn's axis is seen with an error.
const FOLDED_COS: f64 = -0.999;
