//! How long a step semi-implicit Euler stands.

use crate::paper::{bending_bounds, inertias};
use crate::timeline::Timeline;
use tousle_core::{Groom, Quantity, Vec3};
use tousle_field::{FieldLayer, FieldSequence};
use tousle_rod::{DragLaw, Lock};

/// The longest step for a groom, and the joint that sets it.
#[derive(Clone, Debug)]
pub(crate) struct Limit {
    /// The longest step, s.
    pub dt_secs: f64,
    /// Index of the strand.
    pub strand_idx: usize,
    /// Index of the control point at the far end of the joint's stick.
    pub point: usize,
}

/// The longest step of semi-implicit Euler: 2 over the highest frequency a joint can have, √(τ / I1).
///
/// τ holds the bending of the joint and its neighbors, and what pulls on its stick: the weight, the strongest
/// acceleration of the head, and the strongest wind of the field. It is a bound: some longer steps would do.
pub(crate) fn limit(
    field: &FieldSequence,
    groom: &Groom,
    timeline: &Timeline<'_>,
    drag: &DragLaw,
) -> Option<Limit> {
    let terms = timeline.terms;
    let head = timeline.strongest_pull();
    let strongest = if terms.wind { strongest_vector(field, timeline.layers()) } else { 0.0 };
    let mut limit: Option<Limit> = None;
    for (strand_idx, strand) in groom.strands.iter().enumerate() {
        let lock = Lock::new(strand);
        let reach = lock.root_m.norm() + lock.reach_m();
        let acceleration = head.acceleration + head.per_meter * reach;
        let most = |of_sticks: &[f64]| of_sticks.iter().copied().fold(0.0, f64::max);
        let wind = match terms.quantity {
            Quantity::AirVelocity if terms.air => drag.across(most(&lock.widths_m), strongest) * strongest,
            Quantity::AirVelocity => 0.0,
            Quantity::ForcePerMass => strongest * most(&lock.linear_densities_kg_per_m),
        };
        for (j, dt_secs) in joint_limits(&lock, acceleration, wind).into_iter().enumerate() {
            if limit.as_ref().is_none_or(|least| dt_secs < least.dt_secs) {
                limit = Some(Limit { dt_secs, strand_idx, point: j + 1 });
            }
        }
    }
    limit.filter(|limit| limit.dt_secs.is_finite())
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

/// The longest vector of a field under some layers.
pub(crate) fn strongest_vector(field: &FieldSequence, layers: &[FieldLayer]) -> f64 {
    let step = |step: &tousle_field::Field| {
        (0..step.flags.len()).map(|voxel| step.vector(voxel).norm()).fold(step.outside.norm(), f64::max)
    };
    let strongest =
        |layer: &FieldLayer| layer.handles.iter().map(|h| Vec3::norm(&h.extra)).fold(0.0, f64::max);
    field.steps.iter().map(step).fold(0.0, f64::max) + layers.iter().map(strongest).sum::<f64>()
}
