//! Where to aim: at the target, or at the nearest place that the lock can be at.

use crate::Stage;
use tousle_core::Vec3;
use tousle_edit::{FoundKey, Unreachable, drag, out_of_reach};
use tousle_rod::Surface;

/// A lock is never laid straighter than this share of its length: the last of it takes a wind without end.
const STRAIGHTEST: f64 = 0.998;

/// How often a place is brought within the lock's length and out of the body: what the one does the other may undo.
const ROUNDS: usize = 8;

/// Where a key is aimed at.
#[derive(Clone, Debug)]
pub(crate) struct Aim {
    /// The target, or the nearest place to it that the lock can be at, head space, m.
    pub(crate) place_m: Vec3,
    /// Why the target itself cannot be met, if it cannot.
    pub(crate) why: Option<Unreachable>,
}

/// Where to aim for a key. `points_m`: the strand's points, for its lengths.
pub(crate) fn aim(stage: &Stage<'_>, key: &FoundKey, points_m: &[Vec3]) -> Aim {
    let why = out_of_reach(stage.scene, points_m, key.control_point, key.target_m, key.secs);
    let length_m: f64 = points_m[..=key.control_point].windows(2).map(|p| (p[1] - p[0]).norm()).sum();
    let radius_m = 0.5 * stage.groom.strands[key.strand_idx].lock_width_m;
    let mut place_m = drag(points_m, key.control_point, key.target_m).aimed_m;
    for _ in 0..ROUNDS {
        let from_root = place_m - points_m[0];
        if from_root.norm() > STRAIGHTEST * length_m {
            place_m = points_m[0] + from_root.normalize() * (STRAIGHTEST * length_m);
        }
        place_m = out_of_body(stage, place_m, key.secs, radius_m);
    }
    Aim { place_m, why }
}

/// The nearest place whose distance from the body is at least a lock's radius, if the point is inside.
fn out_of_body(stage: &Stage<'_>, mut point_m: Vec3, secs: f64, radius_m: f64) -> Vec3 {
    let scene = stage.scene;
    let pose = scene.poses.motion_at(secs).world_from_head;
    let head_from_torso = scene.body.head_from_torso(&pose, &scene.rest_pose);
    for surface in Surface::of_body(&scene.body, &head_from_torso) {
        // An ellipsoid's distance is of first order: from deep inside it takes some rounds.
        for _ in 0..8 {
            let gap = surface.gap(point_m);
            if gap.distance_m >= 0.0 {
                break;
            }
            point_m += gap.normal * (radius_m - gap.distance_m);
        }
    }
    point_m
}
