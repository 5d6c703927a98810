//! What stands in for what was lost between two things that are whole.

use super::Loss;
use super::inventory::{Inventory, Place};
use crate::finding::Place as At;
use crate::manifest::Manifest;
use crate::wire::proto::FieldStep;
use crate::wire::scene;
use crate::{EffError, decode};
use std::collections::BTreeMap;
use tousle_core::Pose;
use tousle_field::{Field, VoxelFlag};

/// The first and the last step that the new file will have; `None` if no step is whole.
///
/// A gap longer than all that was found is no gap that can be bridged: what is after it is dropped, and so a few
/// bytes with a large number in them cannot make a file of any size.
pub(super) fn plan(found: &mut Inventory) -> Option<(u64, u64)> {
    let first = *found.steps.first_key_value()?.0;
    drop_beyond_gaps(&mut found.steps, first, "steps of the field", &mut found.losses);
    drop_beyond_gaps(&mut found.samples, 0, "steps of samples", &mut found.losses);
    drop_beyond_gaps(&mut found.poses, 0, "poses", &mut found.losses);
    let last = *found.steps.last_key_value()?.0;
    Some((first, last))
}

fn drop_beyond_gaps<T>(whole: &mut BTreeMap<u64, T>, start: u64, what: &str, losses: &mut Vec<Loss>) {
    let longest = whole.len() as u64;
    let mut next = start;
    let mut end = None;
    for &k in whole.keys() {
        if k - next > longest {
            end = Some(k);
            break;
        }
        next = k + 1;
    }
    if let Some(end) = end {
        let dropped = whole.split_off(&end);
        let why = format!("they follow a gap of more than the {longest} that are whole");
        losses.push(Loss { what: format!("{} {what}", dropped.len()), why });
    }
}

/// The pose track from its start, gaps filled by turning and moving evenly between the whole poses around them.
pub(super) fn poses(found: &mut Inventory, old: &Manifest) -> Vec<Pose> {
    let Some((&last, _)) = found.poses.last_key_value() else {
        let why = "the head stands still in its rest pose instead".to_owned();
        found.losses.push(Loss { what: "all poses".into(), why });
        return vec![scene::pose(old.scene.rest_pose.translation_m, old.scene.rest_pose.rotation_xyzw)];
    };
    let whole = &found.poses;
    (0..=last).filter_map(|k| pose_at(whole, k)).collect()
}

fn pose_at(whole: &BTreeMap<u64, Pose>, k: u64) -> Option<Pose> {
    let before = whole.range(..=k).next_back();
    let after = whole.range(k..).next();
    match (before, after) {
        (Some((a, before)), Some((b, after))) if a < b => {
            let share = (k - a) as f64 / (b - a) as f64;
            // Opposite turns have no shortest way; then the earlier one holds.
            Some(before.try_lerp_slerp(after, share, 1e-9).unwrap_or(*before))
        }
        (Some((_, pose)), _) | (None, Some((_, pose))) => Some(*pose),
        (None, None) => None,
    }
}

/// A lost step, linear in time between the whole ones around it.
pub(super) fn step(
    found: &Inventory,
    k: u64,
    old: &Manifest,
    mut load: impl FnMut(Place) -> Result<FieldStep, EffError>,
) -> Result<Field, EffError> {
    let mut unpacked = |place| {
        let step = decode::unpack_step(load(place)?, &old.field, At::default());
        step.map_err(|findings| super::inventory::first(findings).into())
    };
    let before = found.steps.range(..k).next_back();
    let after = found.steps.range(k..).next();
    match (before, after) {
        (Some((a, before)), Some((b, after))) => {
            Ok(between(&unpacked(*before)?, &unpacked(*after)?, (k - a) as f64 / (b - a) as f64))
        }
        (Some((_, place)), None) | (None, Some((_, place))) => unpacked(*place),
        (None, None) => Err(EffError::bad("steps of the field", "none", "at least one whole")),
    }
}

/// The field at a share of the way from one step to another.
fn between(a: &Field, b: &Field, share: f64) -> Field {
    let mix = |(a, b): (&f32, &f32)| (f64::from(*a) + (f64::from(*b) - f64::from(*a)) * share) as f32;
    let flag = |(a, b): (&VoxelFlag, &VoxelFlag)| match (a, b) {
        (VoxelFlag::Outside, VoxelFlag::Outside) => VoxelFlag::Outside,
        _ => VoxelFlag::Interpolated,
    };
    Field {
        u: a.u.iter().zip(&b.u).map(mix).collect(),
        flags: a.flags.iter().zip(&b.flags).map(flag).collect(),
        // A lost step is at most as sure as the less sure of its neighbors.
        sd: a.sd.as_ref().zip(b.sd.as_ref()).map(|(a, b)| a.iter().zip(b).map(|(a, b)| a.max(*b)).collect()),
        outside: a.outside + (b.outside - a.outside) * share,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::Vec3;
    use tousle_field::GridSpec;

    #[test]
    fn halfway_is_the_mean_and_nothing_is_measured() {
        let grid = GridSpec { origin_m: Vec3::zeros(), edge_m: 1.0, dims: [2, 1, 1] };
        let mut a = Field::still(&grid);
        a.flags = vec![VoxelFlag::Measured, VoxelFlag::Outside];
        let mut b = a.clone();
        b.set_vector(0, Vec3::new(2.0, 0.0, -4.0));
        b.outside = Vec3::x();
        let middle = between(&a, &b, 0.25);
        assert_eq!(middle.vector(0), Vec3::new(0.5, 0.0, -1.0));
        assert_eq!(middle.flags, [VoxelFlag::Interpolated, VoxelFlag::Outside]);
        assert_eq!(middle.outside, 0.25 * Vec3::x());
    }

    #[test]
    fn what_follows_an_endless_gap_is_dropped() {
        let mut losses = Vec::new();
        let mut whole: BTreeMap<u64, ()> = [5, 6, 9, 1 << 40].map(|k| (k, ())).into();
        drop_beyond_gaps(&mut whole, 5, "steps", &mut losses);
        assert_eq!(whole.into_keys().collect::<Vec<_>>(), [5, 6, 9]);
        assert_eq!(losses[0].what, "1 steps");
    }
}
