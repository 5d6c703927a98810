use super::contact::Contacts;
use super::{Batch, Motion, Stick, bending_bounds, inertias};
use crate::prepared::Prepared;
use tousle_core::Vec3;
use tousle_lanes::{Lane, Vector};
use tousle_rod::DragLaw;

impl<L: Lane> Batch<L> {
    /// Up to as many strands as there are lanes side by side, at rest in their rest curves.
    pub(super) fn new(strands: &[&Prepared<()>], law: &DragLaw) -> Self {
        let of = |lane: usize| strands[lane.min(strands.len() - 1)];
        let n = strands.iter().map(|p| p.lock.n_sticks()).max().unwrap_or(0);
        let per_lane: Vec<(Vec<f64>, Vec<f64>)> =
            (0..L::N).map(|lane| (inertias(&of(lane).lock), bending_bounds(&of(lane).lock))).collect();
        let stick = |k: usize| {
            let own = |value: &dyn Fn(&Prepared<()>, usize) -> f64, beyond: f64| {
                L::from_fn(|lane| if k < of(lane).lock.n_sticks() { value(of(lane), lane) } else { beyond })
            };
            let vector = |value: &dyn Fn(&Prepared<()>) -> Option<Vec3>| {
                Vector::from_fn(|lane| value(of(lane)).unwrap_or_default())
            };
            Stick {
                length: own(&|p, _| p.lock.lengths_m[k], 0.01),
                hair_length: own(&|p, _| p.lock.hair_lengths_m[k], 0.0),
                half_arc: own(&|p, _| 0.5 * p.lock.arcs_m[k], 0.0),
                mass: own(&|p, _| p.lock.masses_kg[k], 0.0),
                per_inertia: own(&|_, lane| 1.0 / per_lane[lane].0[k], 0.0),
                stiffness: own(&|p, _| p.lock.joint_stiffness[k], 0.0),
                bending_bound: own(&|_, lane| per_lane[lane].1[k], 0.0),
                drag: own(&|p, _| 0.5 * law.air_density * p.lock.widths_m[k], 0.0),
                viscous: own(
                    &|p, _| {
                        let cbrt = libm::cbrt(law.viscosity / p.lock.widths_m[k]);
                        10.0 * cbrt * cbrt
                    },
                    0.0,
                ),
                density: own(&|p, _| p.lock.linear_densities_kg_per_m[k], 0.0),
                rest_direction: vector(&|p| {
                    p.lock.rest_directions.get(k).or(p.lock.rest_directions.last()).copied()
                }),
                rest_torque: vector(&|p| p.rest.torques.get(k).copied()),
            }
        };
        let sticks: Vec<Stick<L>> = (0..n).map(stick).collect();
        Self {
            root: Vector::from_fn(|lane| of(lane).lock.root_m),
            damping_secs: L::from_fn(|lane| of(lane).lock.damping_secs),
            motions: sticks
                .iter()
                .map(|s| Motion { direction: s.rest_direction, rate: Vector::zero() })
                .collect(),
            contacts: Contacts::new(strands, n),
            n_strands: strands.len() as u64,
            n_steps: 0,
            asked: None,
            sticks,
        }
    }
}
