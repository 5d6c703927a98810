//! Where to aim: at the target, or at the nearest place that the lock can be at.

use crate::Stage;
use tousle_core::Vec3;
use tousle_edit::{FoundKey, Unreachable, drag, out_of_reach};
use tousle_field::Scene;
use tousle_rod::Surface;

/// A lock is never laid straighter than this share of its length: the last of it takes a wind without end.
const STRAIGHTEST: f64 = 0.998;

/// How often a place is brought within the lock's length and out of the body: what the one does the other may undo.
const ROUNDS: usize = 8;

/// A place slides along the body in steps of so much, m, so many at most: as far as hair is long.
const SLIDE_M: f64 = 2e-3;
const SLIDES: usize = 500;

/// It has come to rest when a step leaves it within this of where it was, m.
const AT_REST_M: f64 = 1e-6;

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
        place_m = out_of_body(stage.scene, key.secs, radius_m, points_m[key.control_point], place_m);
    }
    Aim { place_m, why }
}

/// A place, or if it is inside the body the nearest outside, a lock's radius off, on the side on which the hair is: where
/// something comes to rest that is pulled to the place from there and slides along the body.
///
/// To go the shortest way out would often be to come out on the other side of the head.
fn out_of_body(scene: &Scene, secs: f64, radius_m: f64, from_m: Vec3, place_m: Vec3) -> Vec3 {
    let pose = scene.poses.motion_at(secs).world_from_head;
    let head_from_torso = scene.body.head_from_torso(&pose, &scene.rest_pose);
    let surfaces = Surface::of_body(&scene.body, &head_from_torso);
    if surfaces.iter().all(|surface| surface.gap(place_m).distance_m >= 0.0) {
        return place_m;
    }
    let mut at_m = pushed_out(&surfaces, radius_m, from_m);
    for _ in 0..SLIDES {
        let pulled_m = at_m + (place_m - at_m).cap_magnitude(SLIDE_M);
        let next_m = pushed_out(&surfaces, radius_m, pulled_m);
        let went_m = (next_m - at_m).norm();
        at_m = next_m;
        if went_m < AT_REST_M {
            break;
        }
    }
    at_m
}

/// A point, brought to a distance from all surfaces.
fn pushed_out(surfaces: &[Surface], radius_m: f64, mut point_m: Vec3) -> Vec3 {
    for surface in surfaces {
        // An ellipsoid's distance is of first order: from deep inside it takes some rounds.
        for _ in 0..8 {
            let gap = surface.gap(point_m);
            if gap.distance_m >= radius_m - AT_REST_M {
                break;
            }
            point_m += gap.normal * (radius_m - gap.distance_m);
        }
    }
    point_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_bench::worlds::mannequin;

    /// Places in the head are left on the side from which the hair comes, where they are nearest.
    #[test]
    fn a_place_in_the_head_is_left_on_the_hairs_side() {
        let scene = mannequin();
        let surfaces =
            Surface::of_body(&scene.body, &scene.body.head_from_torso(&scene.rest_pose, &scene.rest_pose));
        let depth_m = |at: Vec3| surfaces.iter().map(|s| s.gap(at).distance_m).fold(f64::INFINITY, f64::min);
        // Left and right the head is nearest to its middle.
        for side in [Vec3::y(), -Vec3::y()] {
            let hair_m = side * 0.14 + Vec3::new(0.0, 0.0, 0.02);
            for target_m in [Vec3::new(0.001, 0.002, 0.003), side * 0.04, side * 0.06 + Vec3::z() * 0.03] {
                assert!(depth_m(target_m) < 0.0);
                let found_m = out_of_body(&scene, 0.0, 0.004, hair_m, target_m);
                assert!((depth_m(found_m) - 0.004).abs() < 1e-4, "{found_m}");
                // No place a little farther along the surface is nearer.
                for aside in
                    [Vec3::x(), Vec3::y(), Vec3::z()].into_iter().flat_map(|a| [a * 0.004, a * -0.004])
                {
                    let other_m = pushed_out(&surfaces, 0.004, found_m + aside);
                    assert!((other_m - target_m).norm() > (found_m - target_m).norm() - 1e-4, "{found_m}");
                }
                assert!(found_m.dot(&side) > 0.05, "{found_m}");
            }
        }
    }

    #[test]
    fn a_place_outside_stays() {
        let place_m = Vec3::new(-0.12, 0.03, 0.05);
        assert_eq!(out_of_body(&mannequin(), 0.0, 0.004, Vec3::new(-0.2, 0.0, 0.0), place_m), place_m);
    }
}
