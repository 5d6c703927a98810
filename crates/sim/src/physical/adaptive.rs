//! Steps as long as a tolerance allows, chosen for each strand by itself.

use super::batch::{Batch, Model};
use super::implicit::Formula;
use super::link::Work;
use super::scene::{Carry, at_end_of_step};
use crate::SimOptions;
use crate::timeline::Timeline;
use tousle_core::Pose;
use tousle_field::{Reading, Sampler};
use tousle_lanes::{Lane, Placing};

/// Where a strand's own clock stands.
#[derive(Clone, Debug)]
pub(crate) struct Pace {
    /// The step that was taken last, if there was one: when it began, and how long it was, s.
    last_secs: Option<(f64, f64)>,
    /// The step that is tried next, s.
    next_secs: f64,
}

/// The shortest and the longest step, s. What is still wrong at the shortest is a jump of the input itself.
const SHORTEST_SECS: f64 = 2e-5;
const LONGEST_SECS: f64 = 0.02;

/// How exact steps are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Precise {
    /// The most that any step may be off at any point, m.
    tolerance_m: f64,
    /// The longest step, s.
    longest_secs: f64,
}

impl Precise {
    /// As the options have it.
    pub fn of(options: &SimOptions) -> Self {
        let longest_secs = options.dt_secs.map_or(LONGEST_SECS, |dt_secs| dt_secs.min(LONGEST_SECS));
        Self { tolerance_m: options.tolerance_m, longest_secs }
    }

    /// The longest step that may be taken, s.
    pub fn longest_secs(&self) -> f64 {
        self.longest_secs
    }
}

impl Pace {
    /// Before the first step.
    pub fn new() -> Self {
        Self { last_secs: None, next_secs: 1e-3 }
    }
}

impl<L: Lane> Batch<L> {
    /// Steps from one time to another.
    pub fn advance(
        &mut self,
        pace: &mut Pace,
        work: &mut [Work<L>],
        model: &Model,
        world: (&Timeline<'_>, &Sampler<'_>),
        (from_secs, to_secs): (f64, f64),
        Precise { tolerance_m, longest_secs }: Precise,
    ) {
        let (timeline, sampler) = world;
        let mut time = from_secs;
        while time < to_secs {
            let left = to_secs - time;
            // A step that would leave a crumb is stretched over it, one that would leave less than itself is halved.
            let dt = match pace.next_secs.clamp(SHORTEST_SECS.min(longest_secs), longest_secs) {
                dt if dt >= 0.999 * left => left,
                dt if dt > 0.5 * left => 0.5 * left,
                dt => dt,
            };
            let (begin_before, formula) = match pace.last_secs {
                Some((begin, last_dt)) => (begin, Formula::bdf2(dt, last_dt)),
                None => (time, Formula::euler(dt)),
            };
            let secs = [begin_before, time, time + dt];
            let (now, carry) = at_end_of_step(timeline, sampler, Reading::LaidOut, secs);
            let before = (self.states.clone(), self.states_before.clone());
            let touchable = self.touchable.clone();
            let (at_rest, went_m) = (self.at_rest, self.went_m);
            self.step_implicit(work, model, &now, carry.as_ref(), formula);
            let error_m = if self.at_rest { 0.0 } else { self.error(dt, carry.as_ref()) };
            let wanted = 0.85 * libm::cbrt(tolerance_m / error_m.max(1e-12));
            if error_m > tolerance_m && dt > SHORTEST_SECS {
                (self.states, self.states_before) = before;
                self.touchable = touchable;
                (self.at_rest, self.went_m) = (at_rest, went_m);
                pace.next_secs = dt * wanted.clamp(0.2, 0.9);
                continue;
            }
            pace.last_secs = Some((time, dt));
            time = if dt == left { to_secs } else { time + dt };
            // BDF2 stands growing steps up to 1 + √2; twice keeps clear of it.
            pace.next_secs = dt * wanted.clamp(0.2, 2.0);
        }
    }

    /// How far the step just taken is off, m, by how far its place is from what the trapezoidal rule makes of the
    /// velocities at its ends.
    ///
    /// The rule is off by 1/12 of dt³ times the third derivative, BDF2 by 2/9 to the same side at equal steps: it is off
    /// by 1.6 times their distance.
    fn error(&self, dt_secs: f64, carry: Option<&Carry>) -> f64 {
        let half_dt = L::splat(0.5 * dt_secs);
        let carried = Placing::same(half_dt, &carry.map_or_else(Pose::identity, |carry| carry.from));
        let off2 = self.states.iter().zip(&self.states_before).fold(L::zero(), |off2, (state, before)| {
            let velocities = carried.turn.mul_vector_add(before.velocity, state.velocity);
            let rule = carried.place(before.place) + velocities * half_dt;
            off2.max((state.place - rule).norm_squared())
        });
        1.6 * off2.largest().sqrt()
    }
}
