//! Puts strands where their guides take them, as many frames side by side as a register holds.
//!
//! What a strand hears of its guides is more than where it is, and the same in all frames. Frames never meet, so a
//! frame's bits do not depend on the registers.

use std::ops::Range;

use tousle_core::Vec3;
use tousle_lanes::{F32x1, Lane, Matrix, NullaryFnOnce, Vector};

use crate::follow::single;

/// A strand, ready to be put where its guides are.
pub(crate) enum Prepared {
    /// Its points are there among the guides'.
    Guide(Range<usize>),
    /// It follows.
    Sticks { root_m: [f32; 3], sticks: Vec<Stick>, heard: Vec<Heard>, listening: Listening },
}

/// Which sticks of a strand hear what.
pub(crate) enum Listening {
    /// Each hears its own, so many after those of the stick before.
    Each { n_heard: Vec<usize> },
    /// The first hears all; each of the others what it does, of the guides' next sticks.
    StickByStick,
}

/// A stick of a strand that follows.
pub(crate) struct Stick {
    /// From its near end to the other at rest, m.
    rest_m: [f32; 3],
    /// The square of its length, m², as [`turn`] has it: what is at rest is as long as at rest, to the bit.
    length2_m2: f32,
    /// One over that; 0 for a stick without length, which has no direction to turn.
    per_length2: f32,
    /// Its far end at rest, m.
    end_m: [f32; 3],
}

/// What a stick hears of a guide's stick.
pub(crate) struct Heard {
    /// The guide's stick among those of all guides: there are fewer than positions in a frame, of which 32 bits count more than fit
    /// a motion.
    pub(crate) turn: u32,
    pub(crate) weight: f32,
}

/// The square of a length that is none, m².
const NO_LENGTH2: f64 = 1e-24;

impl Stick {
    /// A stick from its near end to its far end at rest, m.
    pub(crate) fn new(near: Vec3, far: Vec3) -> Self {
        let [rest_m, end_m] = [far - near, far].map(single);
        let length2 = vector(F32x1::zero(), rest_m).norm_squared().get(0);
        let per_length2 = if length2 > NO_LENGTH2 { 1.0 / length2 } else { 0.0 };
        Self { rest_m, length2_m2: length2 as f32, per_length2: per_length2 as f32, end_m }
    }
}

/// Some strands, put where their guides take them in as many frames as there are lanes, or fewer.
pub(crate) struct Put<'a, 'b, L> {
    pub(crate) strands: &'a [Prepared],
    /// The guides' points in each frame.
    pub(crate) guide_points: &'a [&'a [[f32; 3]]],
    /// How far each stick of the guides has turned: R − 1.
    pub(crate) turned: &'a [Matrix<L>],
    /// The strands' points in each frame.
    pub(crate) out: &'a mut [&'b mut [[f32; 3]]],
}

impl<L: Lane> NullaryFnOnce for Put<'_, '_, L> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        // A frame's points are far from the next frame's, often by as much as caches have places for: all of a strand's go
        // there together.
        let mut places = Vec::new();
        let mut first = 0;
        for strand in self.strands {
            let n_points = match strand {
                Prepared::Guide(points) => {
                    for (guide_points, out) in self.guide_points.iter().zip(&mut *self.out) {
                        out[first..first + points.len()].copy_from_slice(&guide_points[points.clone()]);
                    }
                    points.len()
                }
                Prepared::Sticks { root_m, sticks, heard, listening } => {
                    let n_points = 1 + sticks.len();
                    places.resize(L::N * n_points + 1, [0.0; 3]);
                    put_sticks(*root_m, sticks, heard, listening, self.turned, &mut places);
                    for (out, places) in self.out.iter_mut().zip(places.chunks_exact(n_points)) {
                        out[first..first + n_points].copy_from_slice(places);
                    }
                    n_points
                }
            };
            first += n_points;
        }
    }
}

/// Puts a strand's points, frame after frame; behind them there is room for one more.
#[inline(always)]
fn put_sticks<L: Lane>(
    root_m: [f32; 3],
    sticks: &[Stick],
    mut heard: &[Heard],
    listening: &Listening,
    turned: &[Matrix<L>],
    places: &mut [[f32; 3]],
) {
    let n_points = 1 + sticks.len();
    let like = turned[0].x.x;
    // By how far a point is from its rest place, so that at rest it is there to the last digit; and what rounding took off that sum
    // (Kahan 1965).
    let (mut moved, mut lost) = (Vector::none(like), Vector::none(like));
    for (k, stick) in sticks.iter().enumerate() {
        let now = match listening {
            Listening::StickByStick => turn(stick, heard, &turned[k..]),
            Listening::Each { n_heard } => {
                let (own, others) = heard.split_at(n_heard[k]);
                heard = others;
                turn(stick, own, turned)
            }
        };
        let by = now - vector(like, stick.rest_m) - lost;
        let sum = moved + by;
        lost = (sum - moved) - by;
        moved = sum;
        let Vector { x, y, z } = vector(like, stick.end_m) + sum;
        L::each_point([x, y, z], |lane, place| put(places, lane * n_points + k + 1, place));
    }
    (0..L::N).for_each(|lane| places[lane * n_points] = root_m);
}

/// Puts a point and whatever comes behind it, where the next point's x will be.
#[inline(always)]
fn put(places: &mut [[f32; 3]], point: usize, place: [f32; 4]) {
    places.as_flattened_mut()[3 * point..3 * point + 4].copy_from_slice(&place);
}

/// The stick where what it hears turns it.
#[inline(always)]
fn turn<L: Lane>(stick: &Stick, heard: &[Heard], turned: &[Matrix<L>]) -> Vector<L> {
    let like = turned[0].x.x;
    let mut sum = Matrix::none(like);
    for Heard { turn, weight } in heard {
        sum = turned[*turn as usize].mul_add(like.same(f64::from(*weight)), &sum);
    }
    let rest = vector(like, stick.rest_m);
    let mean = sum.mul_vector_add(rest, rest);
    // Weights see to it that what guides say never cancels. 1 to the bit where the mean is as long as at rest.
    let [length2, per_length2] = [stick.length2_m2, stick.per_length2].map(|l| like.same(f64::from(l)));
    let share2 = (mean.norm_squared() - length2).mul_add(per_length2, like.same(1.0));
    mean * share2.per_sqrt()
}

#[inline(always)]
fn vector<L: Lane>(like: L, [x, y, z]: [f32; 3]) -> Vector<L> {
    Vector::new(like.same(f64::from(x)), like.same(f64::from(y)), like.same(f64::from(z)))
}
