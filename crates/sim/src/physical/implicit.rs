//! Implicit steps: a multistep formula, and Newton's method for what it asks.

use super::batch::{Batch, Model};
use super::contact::Touchable;
use super::link::{State, Unwinding, Work};
use super::newton::{Weights, sweep_outwards};
use super::scene::{Carry, Now};
use crate::wind::feel_at_middles;
use tousle_core::{Pose, Vec3};
use tousle_lanes::{Lane, Matrix, Placing, Turn, Vector};
use tousle_rod::DragLaw;

/// A formula that gives a rate at a step's end: rate = (value − now · value now − before · value a step ago) / h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Formula {
    /// The step, s.
    pub dt_secs: f64,
    /// h, s.
    pub h_secs: f64,
    pub now: f64,
    pub before: f64,
}

impl Formula {
    /// Backward Euler: order 1, what is stiff is gone after a step.
    pub fn euler(dt_secs: f64) -> Self {
        Self { dt_secs, h_secs: dt_secs, now: 1.0, before: 0.0 }
    }

    /// The backward differentiation formula of order 2 after a step of another length (Hairer, Nørsett and Wanner,
    /// "Solving Ordinary Differential Equations I", III.5): what is stiff is gone after a step here too.
    pub fn bdf2(dt_secs: f64, dt_before_secs: f64) -> Self {
        let ratio = dt_secs / dt_before_secs;
        let per = 1.0 / (1.0 + 2.0 * ratio);
        Self {
            dt_secs,
            h_secs: dt_secs * (1.0 + ratio) * per,
            now: (1.0 + ratio) * (1.0 + ratio) * per,
            before: -ratio * ratio * per,
        }
    }
}

/// Iterations of a step. Without contacts two or three settle; what has not settled then is counted and reported.
const MAX_ITERATIONS: usize = 40;

/// Where the ends of contacts meet, the iteration can circle between two answers: after some iterations it goes
/// shares of the way only.
const fn share_of_way(updates: usize) -> f64 {
    match updates {
        0..8 => 1.0,
        8..16 => 0.5,
        _ => 0.25,
    }
}

/// The least contraction that is foretold, squared, and what a measured one grows by with every step that does not measure it.
/// If these fall, more steps take a single iteration and more is left over by it. Where nothing touches, second updates are a
/// hundredth of the first ones; nine in ten that a contraction of twice that foretold to be felt were not.
const BEST_CONTRACTION2: f64 = 4e-4;
const FORGOTTEN2: f64 = 1.05;

/// Every so many steps all strands take two iterations or more, which measures their contraction: all in the same steps,
/// for a batch goes on until its last strand has settled. If it rises, fewer steps take two, doubt has more time to grow,
/// and strands are farther from where iterations without end would take them.
const MEASURED_EVERY: u64 = 16;

/// Squared updates below this are rounding, m².
const TINY2: f64 = 1e-32;

/// An iteration has not settled, either, while another would go farther than this share of the way to the step's first guess, squared;
/// but for what is less than this, m, and more than what has settled in short steps by itself. With three tenths, limp curls that hang still swing by some 5 mm/s at 48 steps a second; from a
/// tenth on none does, and hair that moves takes no more iterations.
const SETTLED_SHARE2: f64 = 0.01;
const LEAST_SETTLED_M: f64 = 1e-9;

/// A contact is looked for within as much, m, and a quarter of the way from the last step's end to the first guess. Should
/// an iteration go farther from the guess, it is looked for again.
const LOOK_M: f64 = 5e-3;

/// A step, compiled for the widest registers of the machine it runs on.
struct Step<'a, 'b, L> {
    batch: &'a mut Batch<L>,
    work: &'a mut [Work<L>],
    model: &'a Model,
    now: &'a Now<'b>,
    carry: Option<&'a Carry>,
    formula: Formula,
}

impl<L: Lane> pulp::NullaryFnOnce for Step<'_, '_, L> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.batch.step_here(self.work, self.model, self.now, self.carry, self.formula);
    }
}

impl<L: Lane> Batch<L> {
    /// One step. `work` is room for it, as [`Batch::make_room`] makes it.
    pub fn step_implicit(
        &mut self,
        work: &mut [Work<L>],
        model: &Model,
        now: &Now<'_>,
        carry: Option<&Carry>,
        formula: Formula,
    ) {
        L::dispatch(Step { batch: self, work, model, now, carry, formula });
    }

    #[inline(always)]
    fn step_here(
        &mut self,
        work: &mut [Work<L>],
        model: &Model,
        now: &Now<'_>,
        carry: Option<&Carry>,
        formula: Formula,
    ) {
        let n_strands = self.n_strands as u64;
        self.count.steps += n_strands;
        if self.at_rest && now.is_still {
            self.count.slept += n_strands;
            return;
        }
        self.at_rest = false;
        self.n_moved += 1;
        if let Some(carry) = carry {
            self.carry_slips(carry, now);
        }
        let weights = Weights::new(formula.dt_secs, formula.h_secs);
        let falls = Vector::same(weights.h, now.gravity * (formula.h_secs * formula.h_secs));
        let history = carry.map(|carry| History::new(carry, formula, weights.h));
        let way_m = self.prepare(work, history.as_ref(), &weights, (formula, falls));
        self.feel_wind(work, model, now);
        self.settle(work, model, now, &weights, way_m);
        self.finish(work, &weights);
    }

    /// Newton's method, each strand until it has settled: until another update would be smaller than the tolerance.
    ///
    /// The next update is foretold: by how much smaller the last one was than the one before, and for the first by how
    /// much smaller the second was in an earlier step. What surfaces do other than was foretold is known, and counts too.
    /// In every [`MEASURED_EVERY`]th step nothing is foretold of the first.
    ///
    /// The tolerance is a share of the way, too, that a strand is guessed to go, `way_m`. What an iteration leaves over hangs on
    /// that way, so a strand that goes less than its tolerance would be left to one iteration however it swings, and some that
    /// hang still by themselves then swing for ever, by as much as the tolerance lets them.
    #[inline(always)]
    fn settle(&mut self, work: &mut [Work<L>], model: &Model, now: &Now<'_>, weights: &Weights<L>, way_m: L) {
        let (zero, one) = (weights.h.same(0.0), weights.h.same(1.0));
        // Within how much of the places contacts are looked for.
        let margin_m = way_m.mul_add(one.same(0.25), one.same(LOOK_M));
        let square = |tolerance_m: f64| {
            let tolerance_m = f64::max(tolerance_m, model.resolution_m);
            weights.h.same(tolerance_m * tolerance_m)
        };
        let h_secs = weights.h.get(0);
        let (settled2, felt2) = (square(model.settled_m(h_secs)), square(model.felt_m(h_secs)));
        let of_way2 = (way_m * way_m * one.same(SETTLED_SHARE2)).max(square(LEAST_SETTLED_M));
        let settled2 = settled2.min(of_way2);
        // 1 for a strand that still moves, 0 for one that has settled, whatever its neighbors in the batch do.
        let mut active = one;
        let (mut moved2, mut moved2_before) = (zero, zero);
        let mut contraction2 = self.contraction2;
        self.contraction2 = (self.contraction2 * weights.h.same(FORGOTTEN2)).min(one);
        let measures = self.n_moved.is_multiple_of(MEASURED_EVERY);
        // How far points may still go before contacts that were not looked for could be felt.
        let mut room_m = if self.touchable.is_empty() { weights.h.same(f64::INFINITY) } else { -one };
        self.went_m += way_m;
        for updates in 0.. {
            if zero.any_above(room_m) {
                let looks = |yes: L, no: L| zero.above(room_m, yes, no);
                self.look(work, now, looks(margin_m, zero.same(f64::NEG_INFINITY)), updates > 0);
                room_m = looks(margin_m, room_m);
            }
            let off2 = self.feel_contacts(work, model, now, weights);
            if updates > 1 {
                let ratio2 = moved2 / moved2_before.max(weights.h.same(TINY2));
                let measured2 = ratio2.max(weights.h.same(BEST_CONTRACTION2)).min(one);
                contraction2 = if share_of_way(updates - 1) < 1.0 { one } else { measured2 };
                if updates == 2 {
                    self.contraction2 = active.above(zero, measured2, self.contraction2);
                }
            }
            if updates > 0 {
                let goes_on = measures && updates == 1;
                let expected2 = if goes_on { settled2 + settled2 } else { moved2 * contraction2 };
                active = expected2.above(settled2, active, off2.above(felt2, active, zero));
                if !active.any_above(zero) {
                    return;
                }
            }
            if updates == MAX_ITERATIONS {
                self.count.unsettled += self.n_above_zero(active);
                self.count.unsettled_m = self.count.unsettled_m.max((moved2 * active).largest().sqrt());
                return;
            }
            self.count.iterations += self.n_above_zero(active);
            self.load_sticks(work, model, now, weights);
            self.sweep_inwards(work, weights);
            let way = active * weights.h.same(share_of_way(updates));
            moved2_before = moved2;
            moved2 = sweep_outwards(self.root, &self.links, work, way);
            let went_m = moved2.sqrt() * way;
            room_m -= went_m;
            self.went_m += went_m;
        }
    }

    /// How many strands, of those that are read, have a number above 0.
    #[inline(always)]
    fn n_above_zero(&self, numbers: L) -> u64 {
        (0..self.n_strands).filter(|lane| numbers.get(*lane) > 0.0).count() as u64
    }

    /// Takes what friction goes by into the head's axes at the step's end.
    #[inline(always)]
    fn carry_slips(&mut self, carry: &Carry, now: &Now<'_>) {
        let placing = Placing::same(self.contact_give, &carry.from);
        for touchable in &mut self.touchable {
            if now.surfaces[touchable.collider].own_from_head.is_some() {
                for slip in &mut touchable.slips {
                    *slip = placing.turn.mul_vector(*slip);
                }
            }
        }
    }

    /// What a step begins with: weighted sums of the history, in the head's axes at the step's end, and a first guess of
    /// turns and places. `falls`: how far gravity takes a point, m. Out: how far any point of each strand goes to its guess, m.
    #[inline(always)]
    fn prepare(
        &mut self,
        work: &mut [Work<L>],
        history: Option<&History<L>>,
        weights: &Weights<L>,
        (formula, falls): (Formula, Vector<L>),
    ) -> L {
        let (now, before) = (weights.h.same(formula.now), weights.h.same(formula.before));
        let nothing = weights.h.same(0.0);
        let (mut end, mut way2) = (self.root, nothing);
        let states = self.states.iter().zip(&self.states_before);
        for ((link, (state, past)), work) in self.links.iter().zip(states).zip(work) {
            let velocity;
            (work.from, velocity) = match history {
                Some(history) => history.sums(state, past),
                None => (
                    state.place.mul_add(now, past.place * before),
                    state.velocity.mul_add(now, past.velocity * before),
                ),
            };
            work.drifting = velocity.mul_add(weights.h, work.from + falls);
            // A joint gives way slowly: k (c − c0) + k τ ċ, ċ = (c − from) / h.
            let damping = link.stiffness * link.damping_secs * weights.per_h;
            work.stiffness = link.stiffness + damping;
            work.natural = link.natural + (state.bend * now + past.bend * before) * damping;
            work.turn = go_on(state.turn, past.turn);
            work.direction = work.turn.x_axis();
            end = work.direction.mul_add(link.length, end);
            work.place = end;
            // Sticks that only fill up the batch have no mass and no say.
            let own2 = link.mass.above(nothing, (end - state.place).norm_squared(), nothing);
            way2 = way2.max(own2);
        }
        way2.sqrt()
    }

    /// Samples the field at the middle of every stick.
    #[inline(always)]
    pub(super) fn feel_wind(&mut self, work: &mut [Work<L>], model: &Model, now: &Now<'_>) {
        if let Some(asked) = &mut self.asked {
            asked.take_in(self.root, work.iter().map(|work| work.place));
        }
        let (true, Some(wind)) = (model.air || model.pushes, &now.wind) else {
            work.iter_mut().for_each(|work| work.wind = Vector::none(self.contact_give));
            return;
        };
        let end = |work: &Work<L>| work.place;
        match &model.force_law {
            None => feel_at_middles(wind, self.root, work, end, |_, work, found| work.wind = found),
            Some(law) => feel_at_middles(wind, self.root, work, end, |stick, work, found| {
                work.wind = Vector::from_fn(|lane| self.wind_of_force(law, (stick, lane), found.get(lane)));
            }),
        }
    }

    /// The wind that pushes a strand that lies across it as hard as a force per mass, m/s².
    fn wind_of_force(&self, law: &DragLaw, (stick, lane): (usize, usize), per_mass: Vec3) -> Vec3 {
        let strength = per_mass.norm();
        if strength > 0.0 {
            let (width_m, density) = (self.widths_m[stick].get(lane), self.densities[stick].get(lane));
            let speed = law.speed_across(width_m, density * strength);
            per_mass * (speed / strength)
        } else {
            Vec3::zeros()
        }
    }

    #[inline(always)]
    fn finish(&mut self, work: &[Work<L>], weights: &Weights<L>) {
        self.touchable.iter_mut().for_each(Touchable::remember);
        let mut unwinding = Unwinding::from_root(self.root_turn);
        // What was a step ago is of no more use: its memory takes what is now.
        core::mem::swap(&mut self.states, &mut self.states_before);
        for ((state, past), work) in self.states.iter_mut().zip(&mut self.states_before).zip(work) {
            let joint = unwinding.next(work.turn);
            *state = State {
                turn: unwinding.before,
                place: work.place,
                velocity: work.velocity(weights.per_h),
                bend: joint.bend,
            };
            if !joint.sign.all_above(weights.h.same(0.0)) {
                past.bend = Vector::where_above(joint.sign, weights.h.same(0.0), past.bend, joint.bend);
            }
        }
    }
}

/// Takes what was, each in the head's axes of its own time, into those at a step's end, and adds it up with a formula's weights.
struct History<L> {
    now: Matrix<L>,
    before: Matrix<L>,
    shift: Vector<L>,
}

impl<L: Lane> History<L> {
    #[inline(always)]
    fn new(Carry { from, from_before }: &Carry, formula: Formula, like: L) -> Self {
        let turn = |pose: &Pose, weight: f64| {
            Matrix::same(like, &(pose.rotation.to_rotation_matrix().matrix() * weight))
        };
        let shift = from.translation.vector * formula.now + from_before.translation.vector * formula.before;
        Self {
            now: turn(from, formula.now),
            before: turn(from_before, formula.before),
            shift: Vector::same(like, shift),
        }
    }

    /// Of places and of velocities.
    #[inline(always)]
    fn sums(&self, state: &State<L>, past: &State<L>) -> (Vector<L>, Vector<L>) {
        let turned =
            |now: Vector<L>, before: Vector<L>| self.now.mul_vector_add(now, self.before.mul_vector(before));
        (
            self.now.mul_vector_add(state.place, self.before.mul_vector_add(past.place, self.shift)),
            turned(state.velocity, past.velocity),
        )
    }
}

/// A stick goes on turning against the head as it did in the last step, if that is not far (some 30° a step).
///
/// How that turning changed is left out: a parabola foretells more of a swing than one iteration takes back, so most curls that
/// hung still began to swing at 60 steps a second.
#[inline(always)]
fn go_on<L: Lane>(now: Turn<L>, before: Turn<L>) -> Turn<L> {
    let alike = now.w * before.w + now.v.dot(before.v);
    let guess = Turn { w: now.w + now.w - before.w, v: now.v + now.v - before.v };
    guess.where_above(alike, now.w.same(0.97), now).normalized()
}
