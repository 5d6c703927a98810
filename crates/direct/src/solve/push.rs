//! Where to begin: in still air the drag law has no slope, and nothing tells which way to go.

use super::Problem;
use super::ground::Held1;
use crate::Stage;
use tousle_core::{Quantity, Vec3};
use tousle_edit::{FoundKey, StrandPath};
use tousle_rod::DragLaw;

/// How many times the push that would do for a free pendulum is tried, side by side; nothing first.
const PUSHES: [f64; 4] = [0.0, 0.5, 1.0, 2.0];

impl Problem<'_> {
    /// Vectors from which to begin: none, and such as push the strands towards their keys by more and more.
    pub(super) fn starts(&self) -> Vec<Vec<Vec3>> {
        let (stage, basis) = (self.stage, &self.basis);
        let mut pushes = vec![Vec3::zeros(); self.n()];
        for (strand, held) in self.ground.strands.iter().enumerate() {
            for (vector, time_secs, share) in basis.of_strand(strand) {
                // The push of a layer is that of the next key: before it is met there is no use in another.
                let own = self
                    .drag
                    .keys
                    .iter()
                    .zip(&self.aims)
                    .filter(|(key, _)| key.strand_idx == held.strand_idx);
                let next =
                    own.clone().find(|(key, _)| key.secs >= time_secs).or_else(|| own.clone().next_back());
                if let Some((key, aim)) = next {
                    pushes[vector] = push(stage, held, key, aim.place_m, self.drag.first_secs) * share;
                }
            }
        }
        let start = |times: f64| pushes.iter().map(|v| (v * times).cap_magnitude(self.limit)).collect();
        PUSHES.map(start).to_vec()
    }
}

/// The vector, in the field's quantity, that holds a lock as far aside as its key is, or carries it there if the time is
/// shorter than a pendulum would need: an acceleration of 2 d / s², as E4 has it, and by the drag law the wind of it.
fn push(stage: &Stage<'_>, held: &Held1, key: &FoundKey, aim_m: Vec3, first_secs: f64) -> Vec3 {
    let strand = &stage.groom.strands[held.strand_idx];
    let points = StrandPath::new(&held.unedited, 0).points_at(key.secs);
    let length_m: f64 = points[..=key.control_point].windows(2).map(|p| (p[1] - p[0]).norm()).sum();
    let span_secs = key.secs - first_secs;
    let time2 = f64::min(span_secs * span_secs, 2.0 * length_m / stage.scene.gravity_world.norm());
    let acceleration = (aim_m - points[key.control_point]) * (2.0 / time2);
    if stage.field.quantity == Quantity::ForcePerMass {
        return acceleration;
    }
    let law = DragLaw::in_air(stage.scene.air_density);
    let force = acceleration.norm() * strand.linear_density_kg_per_m;
    acceleration.try_normalize(1e-12).unwrap_or_else(Vec3::zeros)
        * law.speed_across(strand.lock_width_m, force)
}
