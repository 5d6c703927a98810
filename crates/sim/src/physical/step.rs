use super::newton::Weights;
use super::scene::PhysicalScene;
use super::strand::{Batch, PhysicalModel};
use crate::lane::{Lane, Turn, Vector};
use tousle_core::{Quantity, Vec3};

impl<L: Lane> Batch<L> {
    /// One step: BDF2, by Newton's method to the model's tolerance.
    pub fn step(&mut self, model: &PhysicalModel, scene: &PhysicalScene<'_>) {
        self.carry(scene);
        let h = 2.0 / 3.0 * scene.dt_secs;
        let weights =
            Weights { h: L::splat(h), per_h: L::splat(1.0 / h), per_h2: L::splat(1.0 / (h * h)) };
        self.prepare(&weights);
        self.place_sticks();
        self.feel_wind(model, scene);
        let tolerance2 = model.tolerance_m * model.tolerance_m;
        let mut active = L::one();
        for iteration in 0.. {
            self.bend_joints();
            self.load_points(model, scene, &weights);
            self.sweep_inwards(&weights);
            // Where contacts come and go the iteration can circle between two answers; smaller steps end that.
            let share = if iteration < 6 { 1.0 } else if iteration < 14 { 0.5 } else { 0.25 };
            let moved2 = self.sweep_outwards(active * L::splat(share));
            self.place_sticks();
            active = moved2.above(L::splat(tolerance2), active, L::zero());
            self.n_iterations += 1;
            if active.largest() <= 0.0 {
                break;
            }
            if iteration + 1 >= model.max_iterations {
                self.n_failed += 1;
                break;
            }
        }
        self.remember_pushes(model, scene, &weights);
        self.finish(&weights);
    }

    /// Takes what was into the head's axes at the step's end.
    fn carry(&mut self, scene: &PhysicalScene<'_>) {
        let Some(carry) = scene.carry else { return };
        let q = carry.turn.quaternion();
        let turn = Turn { w: L::splat(q.w), v: Vector::splat(Vec3::new(q.i, q.j, q.k)) };
        let shift = Vector::splat(carry.shift);
        for state in &mut self.states {
            state.turn = turn.after(state.turn);
            state.turn_before = turn.after(state.turn_before);
            state.place = turn.rotate(state.place) + shift;
            state.place_before = turn.rotate(state.place_before) + shift;
            state.velocity = turn.rotate(state.velocity);
            state.velocity_before = turn.rotate(state.velocity_before);
        }
    }

    /// What a step begins with: the history's weighted sums, and a first guess.
    #[inline(always)]
    fn prepare(&mut self, weights: &Weights<L>) {
        let (now, before) = (L::splat(4.0 / 3.0), L::splat(1.0 / 3.0));
        for ((link, state), work) in self.links.iter().zip(&self.states).zip(&mut self.work) {
            work.from = state.place * now - state.place_before * before;
            let velocity = state.velocity * now - state.velocity_before * before;
            work.drifting = work.from + velocity * weights.h;
            // A joint gives way slowly: k (c − c0) + k τ ċ, ċ = (c − from) / h.
            let damping = link.stiffness * link.damping_secs * weights.per_h;
            let bend_from = state.bend * now - state.bend_before * before;
            work.stiffness = link.stiffness + damping;
            work.natural = link.natural + bend_from * damping;
            // The stick goes on turning as it did, if that is not far.
            let two = L::splat(2.0);
            let sum = Turn {
                w: state.turn.w * two - state.turn_before.w,
                v: state.turn.v * two - state.turn_before.v,
            };
            let change = (state.turn.w * state.turn_before.w + state.turn.v.dot(state.turn_before.v)).max(L::zero());
            let near = L::splat(0.97);
            let guess = sum.normalized();
            work.turn = Turn {
                w: change.above(near, guess.w, state.turn.w),
                v: Vector::where_above(change, near, guess.v, state.turn.v),
            };
        }
    }

    /// Samples the field at the middle of every stick.
    fn feel_wind(&mut self, model: &PhysicalModel, scene: &PhysicalScene<'_>) {
        if !model.air {
            return;
        }
        let Some(wind) = scene.wind else {
            for work in &mut self.work {
                work.wind = Vector::zero();
            }
            return;
        };
        assert!(scene.quantity == Quantity::AirVelocity);
        let half = L::splat(0.5);
        let mut before = self.root;
        for work in &mut self.work {
            let middle = (before + work.place) * half;
            work.wind = Vector::from_fn(|lane| wind.sample(middle.get(lane)));
            before = work.place;
        }
    }

    #[inline(always)]
    fn finish(&mut self, weights: &Weights<L>) {
        let mut before = self.root_turn;
        for (state, work) in self.states.iter_mut().zip(&self.work) {
            state.turn_before = state.turn;
            state.turn = work.turn;
            state.place_before = state.place;
            state.place = work.place;
            state.velocity_before = state.velocity;
            state.velocity = (work.place - work.from) * weights.per_h;
            state.bend_before = state.bend;
            state.bend = before.inverse().after(work.turn).bend();
            before = work.turn;
        }
    }
}
