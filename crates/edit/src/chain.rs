//! Where the rest of a lock goes when one of its control points is dragged.

use nalgebra::UnitQuaternion;
use tousle_core::Vec3;

/// A lock's shape with one control point dragged as near to its target as the lock lets it.
#[derive(Clone, Debug, PartialEq)]
pub struct Dragged {
    /// All control points, m, root first; the root has not moved and no segment has stretched.
    pub points_m: Vec<Vec3>,
    /// Where the dragged point was to go: the target, or the place nearest to it that the lock reaches.
    pub aimed_m: Vec3,
}

/// Passes over the chain before it counts as solved as well as it can be.
///
/// A chain that is nearly straight closes in on its target by a constant factor a pass; 16 sticks at 99.9 % of
/// their length need some 300.
const MAX_PASSES: usize = 1000;

/// Distance from its target at which the dragged point counts as there, m.
const TOLERANCE_M: f64 = 1e-7;

/// Drags the control point `dragged` (at least 1) of a lock to a target, all lengths kept, the root held.
///
/// Between the root and the dragged point the lock first turns about its root, as a pendulum would, until the
/// dragged point is on the line to its target. What is then missing in distance it makes up by bending, by FABRIK
/// (Aristidou and Lasenby 2011): from the dragged point back to the root each point is drawn along the line to
/// its neighbor, then forth again, until both ends hold. Beyond the dragged point the lock hangs on as it was,
/// carried along.
pub fn drag(points_m: &[Vec3], dragged: usize, target_m: Vec3) -> Dragged {
    let lengths: Vec<f64> = points_m.windows(2).take(dragged).map(|p| (p[1] - p[0]).norm()).collect();
    let root = points_m[0];
    let (nearest, farthest) = reach_m(&lengths);
    let distance = (target_m - root).norm();
    let aimed_m = if distance > farthest || distance < nearest {
        let towards = direction(root, target_m).unwrap_or_else(|| fallback_direction(points_m));
        root + towards * distance.clamp(nearest, farthest)
    } else {
        target_m
    };
    let mut moved = points_m.to_vec();
    if distance >= farthest {
        lay_straight(&mut moved[..=dragged], &lengths, aimed_m);
    } else {
        turn_towards(&mut moved[..=dragged], aimed_m);
        follow(&mut moved[..=dragged], &lengths, aimed_m);
    }
    let carried = moved[dragged] - points_m[dragged];
    for (point, from) in moved.iter_mut().zip(points_m).skip(dragged + 1) {
        *point = from + carried;
    }
    Dragged { points_m: moved, aimed_m }
}

/// How near to its root and how far from it the end of a chain of sticks can be, m.
pub(crate) fn reach_m(lengths: &[f64]) -> (f64, f64) {
    let farthest: f64 = lengths.iter().sum();
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    (f64::max(2.0 * longest - farthest, 0.0), farthest)
}

/// Turns a chain about its first point until its last one is on the line to `end`. Where that line is straight
/// back, any way round would do and none is taken.
fn turn_towards(points: &mut [Vec3], end: Vec3) {
    let root = points[0];
    let chord = points[points.len() - 1] - root;
    let Some(turn) = UnitQuaternion::rotation_between(&chord, &(end - root)) else { return };
    for point in &mut *points {
        *point = root + turn * (*point - root);
    }
}

fn lay_straight(points: &mut [Vec3], lengths: &[f64], end: Vec3) {
    let towards = direction(points[0], end).unwrap_or_else(Vec3::x);
    for (k, length) in lengths.iter().enumerate() {
        points[k + 1] = points[k] + towards * *length;
    }
}

fn follow(points: &mut [Vec3], lengths: &[f64], end: Vec3) {
    let root = points[0];
    let last = lengths.len();
    for pass in 0..MAX_PASSES {
        if (points[last] - end).norm() <= TOLERANCE_M {
            return;
        }
        if pass == MAX_PASSES / 2 {
            // A straight chain whose target lies on its own line never leaves that line by itself.
            bow(points, lengths);
        }
        points[last] = end;
        for k in (0..last).rev() {
            points[k] = at_length(points[k + 1], points[k], lengths[k]);
        }
        points[0] = root;
        for k in 0..last {
            points[k + 1] = at_length(points[k], points[k + 1], lengths[k]);
        }
    }
}

/// The point at this distance from `from`, in the direction of `towards`.
fn at_length(from: Vec3, towards: Vec3, length: f64) -> Vec3 {
    from + direction(from, towards).unwrap_or_else(Vec3::x) * length
}

/// Bends a chain a little to one side, by a hundredth of its length in the middle.
fn bow(points: &mut [Vec3], lengths: &[f64]) {
    let last = points.len() - 1;
    let aside = sideways(points[last] - points[0]);
    let total: f64 = lengths.iter().sum();
    for (k, point) in points.iter_mut().enumerate() {
        let share = k as f64 / last as f64;
        *point += aside * (0.04 * total * share * (1.0 - share));
    }
}

/// A unit vector across another one.
fn sideways(along: Vec3) -> Vec3 {
    let across = if along.x.abs() < along.z.abs() { Vec3::x() } else { Vec3::z() };
    along.cross(&across).try_normalize(1e-12).unwrap_or_else(Vec3::x)
}

fn direction(from: Vec3, to: Vec3) -> Option<Vec3> {
    (to - from).try_normalize(1e-12)
}

/// Where to point a chain whose target is its root: where it points now.
fn fallback_direction(points_m: &[Vec3]) -> Vec3 {
    direction(points_m[0], points_m[1]).unwrap_or_else(Vec3::x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four sticks of 50 mm that hang down.
    fn hanging() -> Vec<Vec3> {
        (0..5).map(|k| Vec3::new(0.0, 0.0, -0.05 * f64::from(k))).collect()
    }

    fn assert_lengths_kept(points: &[Vec3]) {
        for pair in points.windows(2) {
            assert!(((pair[1] - pair[0]).norm() - 0.05).abs() < 1e-12, "{points:?}");
        }
    }

    #[test]
    fn a_tip_goes_to_its_target_and_the_lock_follows() {
        let target = Vec3::new(0.12, 0.03, -0.1);
        let dragged = drag(&hanging(), 4, target);
        assert_lengths_kept(&dragged.points_m);
        assert_eq!(dragged.points_m[0], Vec3::zeros());
        assert!((dragged.points_m[4] - target).norm() < 1e-6);
        assert_eq!(dragged.aimed_m, target);
    }

    #[test]
    fn a_target_where_the_point_is_moves_nothing() {
        assert_eq!(drag(&hanging(), 4, hanging()[4]).points_m, hanging());
    }

    /// A quarter turn at the same distance: no bend.
    #[test]
    fn a_lock_turns_before_it_bends() {
        let dragged = drag(&hanging(), 4, Vec3::new(0.2 - 1e-9, 0.0, 0.0));
        for (k, point) in dragged.points_m.iter().enumerate() {
            assert!((point - Vec3::x() * (0.05 * k as f64)).norm() < 1e-6, "{dragged:?}");
        }
    }

    #[test]
    fn a_target_too_far_is_aimed_at_with_the_lock_straight() {
        let dragged = drag(&hanging(), 4, Vec3::new(0.5, 0.0, 0.0));
        assert!((dragged.aimed_m - Vec3::new(0.2, 0.0, 0.0)).norm() < 1e-12);
        assert!((dragged.points_m[2] - Vec3::new(0.1, 0.0, 0.0)).norm() < 1e-12);
        assert_lengths_kept(&dragged.points_m);
    }

    #[test]
    fn what_lies_beyond_the_dragged_point_is_carried_along() {
        let dragged = drag(&hanging(), 2, Vec3::new(0.06, 0.0, -0.07));
        let carried = dragged.points_m[2] - hanging()[2];
        assert!((dragged.points_m[4] - hanging()[4] - carried).norm() < 1e-15);
    }

    #[test]
    fn a_straight_lock_can_be_pushed_towards_its_root() {
        let target = Vec3::new(0.0, 0.0, -0.1);
        let dragged = drag(&hanging(), 4, target);
        assert!((dragged.points_m[4] - target).norm() < 1e-6, "{dragged:?}");
        assert_lengths_kept(&dragged.points_m);
    }

    /// Two sticks, the first 80 mm, the second 30 mm: the tip cannot come nearer to the root than 50 mm.
    #[test]
    fn a_long_stick_keeps_its_tip_away() {
        assert!((reach_m(&[0.08, 0.03]).0 - 0.05).abs() < 1e-15);
        let points = [Vec3::zeros(), Vec3::new(0.08, 0.0, 0.0), Vec3::new(0.11, 0.0, 0.0)];
        let dragged = drag(&points, 2, Vec3::new(0.02, 0.0, 0.0));
        assert!((dragged.aimed_m.norm() - 0.05).abs() < 1e-12);
        assert!((dragged.points_m[2] - dragged.aimed_m).norm() < 1e-6, "{dragged:?}");
    }

    #[test]
    fn any_target_within_reach_is_reached() {
        for k in 0..60 {
            let angle = f64::from(k);
            let distance = 0.1999 * f64::from(k % 10) / 9.0;
            let target =
                Vec3::new(libm::cos(angle), libm::sin(angle), libm::cos(3.0 * angle)).normalize() * distance;
            let dragged = drag(&hanging(), 4, target);
            assert!((dragged.points_m[4] - target).norm() < 1e-4, "{k}: {dragged:?}");
            assert_lengths_kept(&dragged.points_m);
        }
    }
}
