use super::{bending_bounds, inertias};
use crate::mechanics::Setting;
use crate::prepared::Prepared;
use crate::stability::{Limit, strongest_vector};
use crate::timeline::Timeline;
use tousle_core::Quantity;
use tousle_rod::Lock;

/// The longest step of semi-implicit Euler: 2 over the highest frequency a joint can have, √(τ / I1).
///
/// τ holds the bending of the joint and its neighbors, and what pulls on its stick: the weight, the strongest
/// acceleration of the head, and the strongest wind of the field. It is a bound: some longer steps would do.
pub(super) fn limit(
    setting: &Setting<'_>,
    timeline: &Timeline<'_>,
    strands: &[Prepared<()>],
) -> Option<Limit> {
    let (terms, law) = (timeline.terms, setting.law());
    let head = timeline.strongest_pull();
    let strongest = if terms.wind { strongest_vector(setting.field, timeline.layers()) } else { 0.0 };
    let limits = strands.iter().enumerate().flat_map(|(strand_idx, Prepared { lock, .. })| {
        let reach = lock.root_m.norm() + lock.reach_m();
        let acceleration = head.acceleration + head.per_meter * reach;
        let most = |of_sticks: &[f64]| of_sticks.iter().copied().fold(0.0, f64::max);
        let wind = match terms.quantity {
            Quantity::AirVelocity if terms.air => law.across(most(&lock.widths_m), strongest) * strongest,
            Quantity::AirVelocity => 0.0,
            Quantity::ForcePerMass => strongest * most(&lock.linear_densities_kg_per_m),
        };
        let joint = move |(j, dt_secs)| Limit { dt_secs, strand_idx, point: Some(j + 1), limp_idx: None };
        joint_limits(lock, acceleration, wind).into_iter().enumerate().map(joint)
    });
    limits.reduce(Limit::and).filter(|limit| limit.dt_secs.is_finite())
}

fn joint_limits(lock: &Lock, acceleration: f64, wind_per_length: f64) -> Vec<f64> {
    let inertias = inertias(lock);
    let bending = bending_bounds(lock);
    let mut pull = 0.0;
    let mut limits = vec![f64::INFINITY; lock.n_sticks()];
    for j in (0..lock.n_sticks()).rev() {
        pull += lock.masses_kg[j] * acceleration + lock.hair_lengths_m[j] * wind_per_length;
        let strength = bending[j] + lock.lengths_m[j] * pull;
        limits[j] = 2.0 * (inertias[j] / strength).sqrt();
    }
    limits
}
