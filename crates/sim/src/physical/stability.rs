//! How long a step the explicit integrators stand.

use super::build::{Prepared, build, contact_stiffness};
use crate::Integrator;
use crate::mechanics::Setting;
use crate::stability::{Limit, strongest_vector};
use crate::timeline::Timeline;
use tousle_lanes::{F64x1, Lane};
use tousle_rod::DragLaw;

/// The share of the limit that is left to what the power method and the rest shape do not see.
const SAFETY: f64 = 0.8;

/// How much stiffer a joint is that is bent by half a turn (`bend_joints`): it may have come that far from rest.
const HALF_TURN_STIFFENS: f64 = 4.0;

/// The highest frequency at which a strand's joints swing about their rest, rad/s.
pub(super) fn stiffest(prepared: &Prepared, law: &DragLaw) -> f64 {
    let batch = build::<F64x1>(&[prepared], law);
    let mut work = Vec::new();
    batch.make_room(&mut work);
    batch.stiffest(&mut work).get(0)
}

/// The longest step for a groom.
pub(super) fn limit(setting: &Setting<'_>, timeline: &Timeline<'_>, strands: &[Prepared]) -> Option<Limit> {
    let (law, integrator) = (setting.law(), setting.options.integrator());
    let head = timeline.strongest_pull();
    let strongest = strongest_vector(setting.field, timeline.layers());
    let limits = strands.iter().enumerate().map(|(strand_idx, prepared)| {
        let lock = &prepared.lock;
        let per_mass = |(w, d): (&f64, &f64)| law.across(*w, strongest) * strongest / d;
        let air = lock.widths_m.iter().zip(&lock.linear_densities_kg_per_m).map(per_mass).fold(0.0, f64::max);
        let pull = head.acceleration + head.per_meter * (lock.root_m.norm() + lock.reach_m()) + air;
        strand_limit((strand_idx, prepared), integrator == Integrator::Rk4, pull)
    });
    limits.reduce(Limit::and).filter(|limit| limit.dt_secs.is_finite())
}

/// The longest step for a strand, s. `pull`: the strongest pull on a unit of mass, m/s².
///
/// Semi-implicit Euler stands 2 over the highest frequency; what damps is taken at the step's end. The Runge-Kutta
/// method stands 2.8 over it, and 2.7 over the rate of damping, which is the square of the frequency times the damping's
/// time.
fn strand_limit((strand_idx, prepared): (usize, &Prepared), damping_is_explicit: bool, pull: f64) -> Limit {
    let (lock, stiffest) = (&prepared.lock, prepared.shape.stiffest);
    let shortest = lock.lengths_m.iter().copied().fold(f64::INFINITY, f64::min);
    let lightest = lock.masses_kg.iter().copied().filter(|m| *m > 0.0).fold(f64::INFINITY, f64::min);
    let bending2 = HALF_TURN_STIFFENS * stiffest * stiffest;
    // A stick under a pull is a pendulum. Folded hair that falls through its whole length cracks like a whip: its
    // shortest stick then swings round with the speed of that fall.
    let reach: f64 = lock.lengths_m.iter().sum();
    let whip = pull * (1.0 + 2.0 * reach / shortest);
    let swing = whip / shortest * lock.n_sticks() as f64;
    // A contact is a spring made for the mean point.
    let touch = if prepared.touchable.is_empty() { 0.0 } else { contact_stiffness(lock) / lightest };
    let frequency = (bending2 + swing + touch).sqrt();
    let dt_secs = if damping_is_explicit {
        let rate = lock.damping_secs * bending2 + 2.0 * touch.sqrt();
        f64::min(2.8 / frequency, 2.7 / rate)
    } else {
        2.0 / frequency
    };
    let limp_idx = (bending2 < swing).then_some(strand_idx);
    Limit { dt_secs: SAFETY * dt_secs, strand_idx, point: None, limp_idx }
}
