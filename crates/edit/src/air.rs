//! Which extra wind gives an extra acceleration.

use crate::resolve::Resolved;
use tousle_core::{Along, Strand, Vec3};
use tousle_field::{Ease, FieldLayer, FieldSequence, Scene};
use tousle_rod::DragLaw;

/// Instants of the span over which the extra wind is averaged. If it rises, a gust within the span is seen better.
const N_INSTANTS: usize = 16;

/// For each control point the extra wind, m/s, head axes, that pushes the lock by its extra acceleration, and the
/// share of the dragged point's acceleration that no wind can give because it lies along the lock.
///
/// The drag law is turned round at instants of the unedited motion: there, with the wind that blows already, the
/// lock's own motion and its direction, so much wind must be added. A layer holds one vector a handle, so the
/// instants' answers are averaged, each as much as the layer is there.
pub(crate) fn extra_winds(
    field: &FieldSequence,
    layers: &[FieldLayer],
    scene: &Scene,
    resolved: &Resolved<'_>,
    ease: Ease,
    accelerations: &[Vec3],
) -> (Vec<Vec3>, f64) {
    let law = DragLaw::in_air(scene.air_density);
    let span_secs = resolved.second_secs - resolved.first_secs;
    let mut sums = vec![Vec3::zeros(); accelerations.len()];
    let mut weights = 0.0;
    let mut along = 0.0;
    for k in 0..N_INSTANTS {
        let share = (k as f64 + 0.5) / N_INSTANTS as f64;
        let time_secs = resolved.first_secs + span_secs * share;
        let weight = ease.presence(share);
        let head = scene.poses.motion_at(time_secs);
        let wind = field.at(time_secs).with_layers(layers);
        let points = resolved.path.points_at(time_secs);
        let velocities = resolved.path.velocities_at(time_secs);
        for (j, acceleration) in accelerations.iter().enumerate() {
            let over_ground = velocities[j] + head.velocity_of(points[j]);
            let tangent = tangent(&points, j);
            let relative = wind.sample(points[j]) - over_ground;
            let hair = HairAt::of(resolved.strand, j);
            sums[j] += extra_wind(&law, &hair, tangent, relative, *acceleration) * weight;
            if j == resolved.dragged {
                along += share_along(tangent, *acceleration) * weight;
            }
        }
        weights += weight;
    }
    (sums.into_iter().map(|sum| sum / weights).collect(), along / weights)
}

/// What a lock is made of at a control point.
struct HairAt {
    width_m: f64,
    linear_density_kg_per_m: f64,
}

impl HairAt {
    fn of(strand: &Strand, point: usize) -> Self {
        let Along { width, linear_density, .. } = &strand.along;
        Self {
            width_m: strand.lock_width_m * Along::at(width, point),
            linear_density_kg_per_m: strand.linear_density_kg_per_m * Along::at(linear_density, point),
        }
    }
}

/// The wind to add to the relative wind so that the force across the lock grows by acceleration times mass.
fn extra_wind(law: &DragLaw, hair: &HairAt, tangent: Vec3, relative: Vec3, acceleration: Vec3) -> Vec3 {
    let across = |v: Vec3| v - tangent * v.dot(&tangent);
    let wind_across = across(relative);
    let HairAt { width_m, linear_density_kg_per_m } = *hair;
    let force = wind_across * law.across(width_m, wind_across.norm())
        + across(acceleration) * linear_density_kg_per_m;
    let strength = force.norm();
    if strength == 0.0 {
        return -wind_across;
    }
    force * (law.speed_across(width_m, strength) / strength) - wind_across
}

/// The length of an acceleration's part along the lock, as a share of its own.
fn share_along(tangent: Vec3, acceleration: Vec3) -> f64 {
    let length = acceleration.norm();
    if length > 0.0 { acceleration.dot(&tangent).abs() / length } else { 0.0 }
}

/// The lock's direction at a control point: that of the line between its neighbors.
fn tangent(points_m: &[Vec3], point: usize) -> Vec3 {
    let before = points_m[point.saturating_sub(1)];
    let after = points_m[(point + 1).min(points_m.len() - 1)];
    (after - before).try_normalize(1e-12).unwrap_or_else(Vec3::z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strand() -> Strand {
        Strand {
            name: "A".into(),
            rest_curve_m: vec![Vec3::zeros(), -Vec3::z() * 0.1],
            length_m: 0.1,
            linear_density_kg_per_m: 0.002,
            lock_width_m: 0.005,
            bending_stiffness_n_m2: 1e-6,
            internal_damping_secs: 0.01,
            along: Along { width: vec![1.0, 0.25], linear_density: vec![1.0, 0.5], ..Along::default() },
            holds_style: false,
        }
    }

    /// The lock hangs; 2 m/s from the side turned to 2 m/s from elsewhere by what the drag law says that takes, where the lock
    /// is a quarter as wide as where it is widest.
    #[test]
    fn the_law_gives_back_the_acceleration() {
        let (law, hair) = (DragLaw::in_air(1.2), HairAt::of(&strand(), 1));
        assert_eq!((hair.width_m, hair.linear_density_kg_per_m), (0.00125, 0.001));
        let tangent = Vec3::new(0.0, 0.6, -0.8);
        for (wind, acceleration) in [
            (Vec3::new(2.0, 0.0, 0.0), Vec3::new(-3.0, 4.0, 1.0)),
            (Vec3::zeros(), Vec3::new(0.5, 0.0, 0.0)),
            (Vec3::new(0.3, 2.0, -1.0), Vec3::zeros()),
        ] {
            let extra = extra_wind(&law, &hair, tangent, wind, acceleration);
            let force = |w: Vec3| law.at(hair.width_m, tangent, w).force;
            let gained = (force(wind + extra) - force(wind)) / hair.linear_density_kg_per_m;
            let expected = acceleration - tangent * acceleration.dot(&tangent);
            assert!((gained - expected).norm() < 1e-9, "{gained} {expected}");
            assert!(extra.dot(&tangent).abs() < 1e-12, "{extra} has a part along the lock");
        }
    }

    #[test]
    fn a_pull_along_the_lock_is_lost() {
        assert_eq!(share_along(Vec3::z(), Vec3::new(3.0, 0.0, 4.0)), 0.8);
        assert_eq!(share_along(Vec3::z(), Vec3::zeros()), 0.0);
    }
}
