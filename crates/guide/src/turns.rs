//! How far each stick of a strand has turned since it hung still.

use std::marker::PhantomData;

use tousle_core::Vec3;
use tousle_lanes::{F64x1, Lane, MOST_LANES, Matrix, NullaryFnOnce, Turn, Vector, WithLanes};

/// A strand's sticks at rest, and from what they turn.
pub(crate) struct AtRest {
    /// Directions of the sticks.
    directions: Vec<Vec3>,
    /// From each stick to the next, at rest, the other way round.
    back: Vec<Turn<F64x1>>,
}

impl AtRest {
    pub(crate) fn new(curve: &[Vec3]) -> Self {
        let mut last = straight_down(F64x1::zero());
        let directions: Vec<_> = curve
            .windows(2)
            .map(|pair| {
                last = direction(Vector::splat(pair[1] - pair[0]), last);
                last
            })
            .collect();
        let back = directions.windows(2).map(|pair| turn(pair[1], pair[0])).collect();
        Self { directions: directions.iter().map(|d| d.get(0)).collect(), back }
    }

    /// Says the rotation of each stick from rest to where `point`, for several curves side by side, has its ends: without
    /// twist along the strand.
    ///
    /// A cross carried from stick to stick by the smallest turns, from the root on (Bishop 1975: parallel
    /// transport), turns as the material of a round rod without twist does. Comparing it with the same at rest
    /// gives for each stick a rotation R with R · rest direction = direction, that changes smoothly in time
    /// wherever the stick points, also straight against its rest direction. It does not where a joint folds by
    /// 180°, nor where the stick at the root turns against its own rest direction: into the scalp.
    #[inline(always)]
    pub(crate) fn turns<L: Lane>(
        &self,
        point: impl Fn(usize) -> Vector<L>,
        mut say: impl FnMut(usize, Turn<L>),
    ) {
        let mut near = point(0);
        let like = near.x;
        let mut before = straight_down(like);
        let mut rotation = Turn::identity(like);
        for (stick, rest) in self.directions.iter().enumerate() {
            let far = point(stick + 1);
            let now = direction(far - near, before);
            rotation = match stick.checked_sub(1) {
                None => turn(Vector::same(like, *rest), now),
                Some(joint) => turn(before, now).after(rotation).after(Turn::same(like, &self.back[joint])),
            };
            say(stick, rotation);
            (near, before) = (far, now);
        }
    }
}

/// Some guides' sticks, to be turned as they have in some frames.
pub(crate) struct Turning<'a, L> {
    pub(crate) at_rest: &'a [AtRest],
    /// Where each guide's points start in a frame.
    pub(crate) first_points: &'a [usize],
    /// The guides' points in each frame.
    pub(crate) frames: &'a [&'a [[f32; 3]]],
    /// How far each stick has turned in each frame, R − 1; where there are fewer frames than lanes, the last again.
    pub(crate) turned: &'a mut [Matrix<L>],
}

/// The same, worked out in lanes `W`, of which there may be fewer.
struct In<'a, W, L>(Turning<'a, L>, PhantomData<W>);

impl<L: Lane> WithLanes for Turning<'_, L> {
    type Output = ();

    fn with<W: Lane>(self) {
        W::dispatch(In::<W, L>(self, PhantomData));
    }
}

impl<W: Lane, L: Lane> NullaryFnOnce for In<'_, W, L> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Turning { at_rest, first_points, frames, mut turned } = self.0;
        let last = frames.len() - 1;
        let mut rows = Vec::new();
        for (at_rest, first_point) in at_rest.iter().zip(first_points) {
            rows.resize(at_rest.directions.len(), [[[0.0; MOST_LANES]; 3]; 3]);
            for first_frame in (0..L::N).step_by(W::N) {
                let point = |k: usize| {
                    let mut point = [[0.0; MOST_LANES]; 3];
                    for lane in 0..W::N {
                        let [x, y, z] = frames[last.min(first_frame + lane)][first_point + k];
                        (point[0][lane], point[1][lane], point[2][lane]) = (x, y, z);
                    }
                    Vector::of_single(W::zero(), &point, 0)
                };
                at_rest.turns(point, |stick, turn| {
                    let Matrix { x, y, z } = turn.less_identity();
                    [x, y, z]
                        .iter()
                        .zip(&mut rows[stick])
                        .for_each(|(row, rows)| row.put_single(rows, first_frame));
                });
            }
            let own = turned.split_off_mut(..rows.len()).expect("all sticks");
            for (turned, [x, y, z]) in own.iter_mut().zip(&rows) {
                let row = |row| Vector::of_single(L::zero(), row, 0);
                *turned = Matrix { x: row(x), y: row(y), z: row(z) };
            }
        }
    }
}

/// Where a first stick without length points.
#[inline(always)]
fn straight_down<L: Lane>(like: L) -> Vector<L> {
    Vector::same(like, -Vec3::z())
}

/// The direction of a stick. One without length points as the one before.
#[inline(always)]
fn direction<L: Lane>(stick: Vector<L>, before: Vector<L>) -> Vector<L> {
    let length2 = stick.norm_squared();
    Vector::where_above(length2, length2.same(1e-24), stick.normalized(), before)
}

/// The smallest rotation that takes one unit vector to another; between opposite ones some half turn.
#[inline(always)]
fn turn<L: Lane>(from: Vector<L>, to: Vector<L>) -> Turn<L> {
    let zero = from.x.same(0.0);
    let w = from.x.same(1.0) + from.dot(to);
    // Across the axis along which it is the shorter of x and y, or nearly so.
    let (across_x, across_y) = (Vector::new(zero, from.z, -from.y), Vector::new(-from.z, zero, from.x));
    let across = Vector::where_above(from.x * from.x, from.y * from.y, across_y, across_x);
    let half_turn = Turn { w: zero, v: across };
    Turn { w, v: from.cross(to) }.where_above(w, from.x.same(1e-9), half_turn).normalized()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rotated(turn: &Turn<F64x1>, v: Vec3) -> Vec3 {
        turn.rotate(Vector::splat(v)).get(0)
    }

    fn turns(rest: &[Vec3], now: &[Vec3]) -> Vec<Turn<F64x1>> {
        let mut turns = Vec::new();
        AtRest::new(rest).turns(|k| Vector::splat(now[k]), |_, turn| turns.push(turn));
        turns
    }

    #[test]
    fn smallest_turns() {
        let axes = [Vec3::x(), Vec3::y(), Vec3::z()];
        for (k, x) in axes.iter().enumerate() {
            let (y, z) = (axes[(k + 1) % 3], axes[(k + 2) % 3]);
            let quarter = turn(Vector::<F64x1>::splat(*x), Vector::splat(y));
            assert!((rotated(&quarter, *x) - y).norm() < 1e-15 && (rotated(&quarter, z) - z).norm() < 1e-15);
            let half = turn(Vector::<F64x1>::splat(*x), Vector::splat(-x));
            assert!((rotated(&half, *x) + x).norm() < 1e-15);
            assert!((half.v.norm_squared().get(0) - 1.0).abs() < 1e-15 && half.w.get(0) == 0.0);
        }
    }

    /// A helix at rest, all of it turned by a rotation about its root's direction: no stick knows of it but by its
    /// own direction, and every stick has turned by exactly that rotation or one that takes it to the same place.
    #[test]
    fn turns_take_each_stick_where_it_is() {
        let helix = |phase: f64| -> Vec<Vec3> {
            (0..30)
                .map(|k| {
                    let a = 0.4 * f64::from(k) + phase;
                    Vec3::new(0.02 * libm::cos(a), 0.02 * libm::sin(a), -0.005 * f64::from(k))
                })
                .collect()
        };
        let (rest, now) = (helix(0.0), helix(1.0));
        for (k, turn) in turns(&rest, &now).iter().enumerate() {
            let [rest, now] = [&rest, &now].map(|curve| (curve[k + 1] - curve[k]).normalize());
            assert!((rotated(turn, rest) - now).norm() < 1e-13);
            assert!((turn.w.get(0).powi(2) + turn.v.norm_squared().get(0) - 1.0).abs() < 1e-13);
        }
        let still = turns(&rest, &rest);
        assert!(still.iter().all(|t| t.v.norm_squared().get(0) < 1e-26), "at rest nothing has turned");
    }

    /// A stick without length turns with the one before.
    #[test]
    fn a_stick_without_length_has_a_turn() {
        let rest = [Vec3::zeros(), Vec3::x(), Vec3::x(), Vec3::new(2.0, 0.0, 0.0)];
        let now = [Vec3::zeros(), Vec3::y(), Vec3::y(), Vec3::new(0.0, 2.0, 0.0)];
        for turn in turns(&rest, &now) {
            assert!((rotated(&turn, Vec3::x()) - Vec3::y()).norm() < 1e-15);
        }
    }
}
