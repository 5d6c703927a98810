//! Explicit steps, for comparison: the same forces, with places and stiffness at the step's start.
//!
//! Here the sticks' turns and angular velocities are the state. Newton's and Euler's law for all joints at once is
//! solved by the sweeps of [`super::newton`], with masses where an implicit step has derivatives.

use super::batch::{Batch, Model};
use super::contact::Firmness;
use super::drag::push;
use super::link::{Bending, Unwinding, Work};
use super::newton::{FurtherOut, Outwards, bend_joint, place_sticks};
use super::scene::Now;
use tousle_core::Vec3;
use tousle_lanes::{Lane, Symmetric, Turn, Vector};

/// Where each stick points, and its angular velocity over the ground, head axes, rad/s.
#[derive(Clone, Debug)]
pub(crate) struct Swing<L> {
    turns: Vec<Turn<L>>,
    spins: Vec<Vector<L>>,
}

/// How a swing changes: turns in space, rad/s, and angular accelerations as the head's axes see them, rad/s².
struct Change<L> {
    rates: Vec<Vector<L>>,
    accelerations: Vec<Vector<L>>,
}

impl<L: Lane> Swing<L> {
    /// That of no sticks.
    pub fn none() -> Self {
        Self { turns: Vec::new(), spins: Vec::new() }
    }

    /// The swing of a batch that goes along with a head that turns.
    pub fn at_rest(batch: &Batch<L>, spin: Vec3) -> Self {
        Self {
            turns: batch.states.iter().map(|s| s.turn).collect(),
            spins: vec![Vector::splat(spin); batch.states.len()],
        }
    }

    #[inline(always)]
    fn moved(&self, change: &Change<L>, dt_secs: f64) -> Self {
        let dt = L::splat(dt_secs);
        Self {
            turns: self.turns.iter().zip(&change.rates).map(|(t, r)| turned(*t, *r * dt)).collect(),
            spins: self.spins.iter().zip(&change.accelerations).map(|(s, a)| *s + *a * dt).collect(),
        }
    }
}

/// [`Batch::change`], compiled for the widest registers of the machine it runs on.
struct Law<'a, 'b, L> {
    batch: &'a mut Batch<L>,
    swing: &'a Swing<L>,
    work: &'a mut [Work<L>],
    model: &'a Model,
    now: &'a Now<'b>,
    implicit_secs: f64,
}

impl<L: Lane> pulp::NullaryFnOnce for Law<'_, '_, L> {
    type Output = Change<L>;

    #[inline(always)]
    fn call(self) -> Change<L> {
        self.batch.change_here(self.swing, self.work, self.model, self.now, self.implicit_secs)
    }
}

/// A stick turned by a rotation vector, to fourth order in it.
#[inline(always)]
fn turned<L: Lane>(turn: Turn<L>, by: Vector<L>) -> Turn<L> {
    // 2 tan(θ/2) = θ (1 + θ²/12 + …)
    let scale = L::one() + by.norm_squared() * L::splat(1.0 / 12.0);
    turn.turned(by * scale)
}

/// What surfaces go by at a stick's end: its place, its velocity and the stick's direction.
#[inline(always)]
fn felt<L: Lane>(work: &Work<L>) -> (Vector<L>, Vector<L>, Vector<L>) {
    (work.place, work.drifting, work.direction)
}

impl<L: Lane> Batch<L> {
    /// One step of semi-implicit Euler: stiffness and surfaces at the start, damping and air's resistance at the end.
    pub fn step_semi_implicit(
        &mut self,
        swing: &mut Swing<L>,
        work: &mut [Work<L>],
        model: &Model,
        now: &Now<'_>,
        dt_secs: f64,
    ) {
        self.count.steps += self.n_strands as u64;
        let change = self.change(swing, work, model, now, dt_secs);
        let dt = L::splat(dt_secs);
        let head = head_spin(now);
        for ((turn, spin), acceleration) in
            swing.turns.iter_mut().zip(&mut swing.spins).zip(&change.accelerations)
        {
            *spin += *acceleration * dt;
            *turn = turned(*turn, (*spin - head) * dt);
        }
        self.take(swing, work, model, now, dt_secs);
    }

    /// One step of the classical Runge-Kutta method. `now`: the world at the step's start, middle and end.
    pub fn step_rk4(
        &mut self,
        swing: &mut Swing<L>,
        work: &mut [Work<L>],
        model: &Model,
        now: &[Now<'_>; 3],
        dt_secs: f64,
    ) {
        self.count.steps += self.n_strands as u64;
        let k1 = self.change(swing, work, model, &now[0], 0.0);
        let k2 = self.change(&swing.moved(&k1, 0.5 * dt_secs), work, model, &now[1], 0.0);
        let k3 = self.change(&swing.moved(&k2, 0.5 * dt_secs), work, model, &now[1], 0.0);
        let k4 = self.change(&swing.moved(&k3, dt_secs), work, model, &now[2], 0.0);
        let sixth = L::splat(dt_secs / 6.0);
        let mean = |f: &dyn Fn(&Change<L>) -> Vector<L>| {
            (f(&k1) + (f(&k2) + f(&k3)) * L::splat(2.0) + f(&k4)) * sixth
        };
        for j in 0..swing.turns.len() {
            let by = mean(&|k| k.rates[j]);
            // Turns about different axes do not commute: what that makes in a step, to third order in it.
            let twist = (k1.rates[j].cross(k4.rates[j])) * L::splat(dt_secs * dt_secs / 12.0);
            swing.turns[j] = turned(swing.turns[j], by - twist);
            swing.spins[j] += mean(&|k| k.accelerations[j]);
        }
        self.take(swing, work, model, &now[2], dt_secs);
    }

    /// Newton's and Euler's law at a swing. With `implicit_secs` above 0, damping and resistance count as they will be
    /// when that time has passed.
    #[inline(never)]
    fn change(
        &mut self,
        swing: &Swing<L>,
        work: &mut [Work<L>],
        model: &Model,
        now: &Now<'_>,
        implicit_secs: f64,
    ) -> Change<L> {
        L::dispatch(Law { batch: self, swing, work, model, now, implicit_secs })
    }

    #[inline(always)]
    fn change_here(
        &mut self,
        swing: &Swing<L>,
        work: &mut [Work<L>],
        model: &Model,
        now: &Now<'_>,
        implicit_secs: f64,
    ) -> Change<L> {
        for ((work, turn), link) in work.iter_mut().zip(&swing.turns).zip(&self.links) {
            work.turn = *turn;
            work.stiffness = link.stiffness;
            work.natural = link.natural;
        }
        place_sticks(self.root, &self.links, work);
        self.feel_wind(work, model, now);
        let later = L::splat(implicit_secs);
        self.load_swing(swing, work, model, now, later);
        self.eliminate_turns(swing, work, now, later);
        let head = head_spin(now);
        let mut outwards = Outwards::at_root(L::zero());
        // The head's axes turn under the spin.
        let sticks = self.links.iter().zip(&*work).zip(&swing.spins);
        let accelerations = sticks.map(|((link, work), spin)| outwards.next(link, work) - head.cross(*spin));
        Change {
            rates: swing.spins.iter().map(|spin| *spin - head).collect(),
            accelerations: accelerations.collect(),
        }
    }

    /// From the tip: every stick's angular acceleration eliminated.
    #[inline(always)]
    fn eliminate_turns(&self, swing: &Swing<L>, work: &mut [Work<L>], now: &Now<'_>, later: L) {
        let mut further_out = FurtherOut::nothing(L::zero());
        for j in (0..work.len()).rev() {
            let (link, here) = (&self.links[j], &mut work[j]);
            let (turn_before, spin_before) = match j {
                0 => (self.root_turn, head_spin(now)),
                _ => (swing.turns[j - 1], swing.spins[j - 1]),
            };
            let Bending { torque, curvature } = bend_joint(turn_before, here);
            // Internal damping, in place of the stiffness that an implicit step has there.
            let damping = curvature * link.damping_secs;
            let torque = (swing.spins[j] - spin_before).mul_add(damping, torque);
            further_out.add_point(here.slope, &here.hessian);
            let joint = Bending { torque, curvature: damping * later };
            further_out.eliminate(here, link.length, joint, link.rotary, L::zero());
        }
    }

    /// Forces on the points, and masses.
    #[inline(always)]
    fn load_swing(&mut self, swing: &Swing<L>, work: &mut [Work<L>], model: &Model, now: &Now<'_>, later: L) {
        let gravity = Vector::splat(now.gravity);
        let mut velocity = self.root_velocity(now);
        let mut acceleration = now.head.as_ref().map_or(Vector::zero(), |head| {
            let turning = Vector::splat(head.angular_acceleration).cross(self.root);
            let spin = Vector::splat(head.angular_velocity);
            Vector::splat(head.acceleration) + turning + spin.cross(spin.cross(self.root))
        });
        let half = L::splat(0.5);
        let along = L::splat(model.along);
        for ((work, link), spin) in work.iter_mut().zip(&self.links).zip(&swing.spins) {
            let lever = work.direction * link.length;
            velocity += spin.cross(lever);
            acceleration += spin.cross(spin.cross(lever));
            work.drifting = velocity;
            work.slope = (acceleration - gravity) * link.mass;
            work.hessian = Symmetric::scaled_identity(link.mass);
            if model.pushes {
                work.slope -= work.wind * link.mass;
            }
        }
        if model.air {
            let mut velocity_before = self.root_velocity(now);
            for j in 0..work.len() {
                let middle = (velocity_before + work[j].drifting) * half;
                let push = push(&self.links[j], along, work[j].direction, work[j].wind - middle);
                velocity_before = work[j].drifting;
                let ends = if j > 0 { j - 1..j + 1 } else { j..j + 1 };
                for work in &mut work[ends] {
                    work.slope -= push.force * half;
                    work.hessian.add_scaled(&push.slope, half * later);
                }
            }
        }
        let firmness = Firmness {
            stiffness: self.contact_stiffness,
            give: self.contact_give,
            per_h: L::one(),
            dt: L::zero(),
        };
        // How far points have gone nobody says here.
        self.went_m = L::splat(f64::INFINITY);
        self.look(work, now, L::zero(), false);
        for touchable in &mut self.touchable {
            let moving = &now.surfaces[touchable.collider];
            touchable.feel(model, moving, |stick| felt(&work[stick]), firmness);
            for (stick, bearing) in touchable.touched() {
                let work = &mut work[stick];
                work.slope += bearing.slope;
                work.hessian.add_scaled(&bearing.hessian, later);
            }
        }
    }

    /// Where the swing has come to is where the strands are. `now`: the world at the step's end.
    fn take(
        &mut self,
        swing: &mut Swing<L>,
        work: &mut [Work<L>],
        model: &Model,
        now: &Now<'_>,
        dt_secs: f64,
    ) {
        let firmness = Firmness {
            stiffness: self.contact_stiffness,
            give: self.contact_give,
            per_h: L::one(),
            dt: L::splat(dt_secs),
        };
        for touchable in &mut self.touchable {
            let moving = &now.surfaces[touchable.collider];
            touchable.feel(model, moving, |stick| felt(&work[stick]), firmness);
            touchable.remember();
        }
        let mut unwinding = Unwinding::from_root(self.root_turn);
        for (work, turn) in work.iter_mut().zip(&mut swing.turns) {
            unwinding.next(*turn);
            *turn = unwinding.before;
            work.turn = unwinding.before;
        }
        place_sticks(self.root, &self.links, work);
        for (state, work) in self.states.iter_mut().zip(&*work) {
            state.turn = work.turn;
            state.place = work.place;
        }
    }

    /// The highest frequency, rad/s, at which the strands' joints swing about their rest, and how fast internal damping
    /// alone would still it, 1/s; by the power method.
    pub fn stiffest(&self, work: &mut [Work<L>]) -> L {
        let now_turns: Vec<Turn<L>> = self.states.iter().map(|s| s.turn).collect();
        for ((work, turn), link) in work.iter_mut().zip(&now_turns).zip(&self.links) {
            work.turn = *turn;
            work.stiffness = link.stiffness;
            work.natural = Vector::zero();
        }
        place_sticks(self.root, &self.links, work);
        let before = core::iter::once(self.root_turn).chain(now_turns.iter().copied());
        let curvatures: Vec<L> =
            before.zip(&*work).map(|(before, work)| bend_joint(before, work).curvature).collect();
        // Starts from turns that differ from joint to joint, in all directions.
        let start = Vector::splat(Vec3::new(0.3, 0.7, -0.5));
        let mut turns: Vec<Vector<L>> =
            (0..work.len()).map(|j| if j % 2 == 0 { start } else { -start }).collect();
        let mut squared = L::zero();
        for _ in 0..POWER_ITERATIONS {
            let mut further_out = FurtherOut::nothing(L::zero());
            for j in (0..work.len()).rev() {
                let link = &self.links[j];
                let before = if j > 0 { turns[j - 1] } else { Vector::zero() };
                let joint = Bending { torque: (turns[j] - before) * curvatures[j], curvature: L::zero() };
                further_out.add_point(Vector::zero(), &Symmetric::scaled_identity(link.mass));
                further_out.eliminate(&mut work[j], link.length, joint, link.rotary, L::zero());
            }
            let size2 = turns.iter().fold(L::zero(), |sum, t| sum + t.norm_squared());
            let mut outwards = Outwards::at_root(L::zero());
            for ((turn, link), work) in turns.iter_mut().zip(&self.links).zip(&*work) {
                *turn = -outwards.next(link, work);
            }
            let grown2 = turns.iter().fold(L::zero(), |sum, t| sum + t.norm_squared());
            squared = (grown2 / size2.max(L::splat(1e-300))).sqrt();
            let per_size = grown2.max(L::splat(1e-300)).per_sqrt();
            turns.iter_mut().for_each(|t| *t = *t * per_size);
        }
        squared.sqrt()
    }
}

/// Iterations of the power method: the frequency is then right to a few per cent, and the limit leaves 20 %.
const POWER_ITERATIONS: usize = 60;

fn head_spin<L: Lane>(now: &Now<'_>) -> Vector<L> {
    now.head.as_ref().map_or(Vector::zero(), |head| Vector::splat(head.angular_velocity))
}
