//! Puts strands where their guides take them, as many frames side by side as a register holds.
//!
//! What a strand hears of its guides is ten times as many numbers as where it is, and the same in all frames. Frames never
//! meet, so a frame's bits do not depend on the registers; a product and a sum are two roundings on every machine. What is written
//! out here could be maps of arrays, but those are calls for the compiler, of functions that know no wide registers.

use std::ops::Range;

use pulp::bytemuck::cast_slice;
use pulp::{Simd, WithSimd};

/// A strand, ready to be put where its guides are.
pub(crate) enum Prepared {
    /// Its points are there among the guides'.
    Guide(Range<usize>),
    /// It follows.
    Sticks { root_m: [f32; 3], sticks: Vec<Stick>, heard: Vec<Heard> },
}

/// A stick of a strand that follows.
pub(crate) struct Stick {
    /// From its near end to the other at rest, m.
    pub(crate) rest_m: [f32; 3],
    /// Its [`length`], m.
    pub(crate) length_m: f32,
    /// Its far end at rest, m.
    pub(crate) end_m: [f32; 3],
    /// How many of the strand's [`Heard`] are its own; they follow those of the stick before.
    pub(crate) n_heard: usize,
}

/// What a stick hears of a guide's stick.
pub(crate) struct Heard {
    /// The guide's stick among those of all guides: there are fewer than positions in a frame, of which 32 bits count more than fit
    /// a motion.
    pub(crate) turn: u32,
    pub(crate) weight: f32,
}

/// The length of a stick, m, summed as [`Put`] sums it: what is at rest is as long as at rest, to the bit.
pub(crate) fn length([x, y, z]: [f32; 3]) -> f32 {
    (x * x + y * y + z * z).sqrt()
}

/// How many frames fit a register.
pub(crate) struct NLanes;

impl WithSimd for NLanes {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        S::F32_LANES
    }
}

/// Some strands, put where their guides take them in as many frames as fit a register, or fewer.
pub(crate) struct Put<'a, 'b> {
    pub(crate) strands: &'a [Prepared],
    /// The guides' points in each frame.
    pub(crate) guide_points: &'a [&'a [[f32; 3]]],
    /// How far each stick of the guides has turned: the nine numbers of R − 1, row after row, each in as many frames side by
    /// side as fit a register.
    pub(crate) turned: &'a [f32],
    /// The strands' points in each frame.
    pub(crate) out: &'a mut [&'b mut [[f32; 3]]],
}

impl WithSimd for Put<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (turned, _) = cast_slice::<f32, S::f32s>(self.turned).as_chunks::<9>();
        let mut first = 0;
        for strand in self.strands {
            match strand {
                Prepared::Guide(points) => {
                    for (guide_points, out) in self.guide_points.iter().zip(&mut *self.out) {
                        out[first..first + points.len()].copy_from_slice(&guide_points[points.clone()]);
                    }
                    first += points.len();
                }
                Prepared::Sticks { root_m, sticks, heard } => {
                    self.out.iter_mut().for_each(|out| out[first] = *root_m);
                    put_sticks(simd, sticks, heard, turned, self.out, first + 1);
                    first += 1 + sticks.len();
                }
            }
        }
    }
}

/// Puts the far ends of a strand's sticks, the first of which is point `first` of each frame.
#[inline(always)]
fn put_sticks<S: Simd>(
    simd: S,
    sticks: &[Stick],
    mut heard: &[Heard],
    turned: &[[S::f32s; 9]],
    out: &mut [&mut [[f32; 3]]],
    first: usize,
) {
    let zeros = [simd.splat_f32s(0.0); 3];
    // By how far a point is from its rest place, so that at rest it is there to the last digit; and what rounding took off that sum
    // (Kahan 1965).
    let (mut moved, mut lost) = (zeros, zeros);
    for (point, stick) in (first..).zip(sticks) {
        let (own, others) = heard.split_at(stick.n_heard);
        heard = others;
        let now = turn(simd, stick, own, turned);
        for axis in 0..3 {
            let by = simd.sub_f32s(now[axis], simd.splat_f32s(stick.rest_m[axis]));
            let by = simd.sub_f32s(by, lost[axis]);
            let sum = simd.add_f32s(moved[axis], by);
            lost[axis] = simd.sub_f32s(simd.sub_f32s(sum, moved[axis]), by);
            moved[axis] = sum;
            let place = simd.add_f32s(simd.splat_f32s(stick.end_m[axis]), sum);
            for (out, place) in out.iter_mut().zip(cast_slice::<S::f32s, f32>(&[place])) {
                out[point][axis] = *place;
            }
        }
    }
}

/// The stick where what it hears turns it.
#[inline(always)]
fn turn<S: Simd>(simd: S, stick: &Stick, heard: &[Heard], turned: &[[S::f32s; 9]]) -> [S::f32s; 3] {
    let mut sum = [simd.splat_f32s(0.0); 9];
    for Heard { turn, weight } in heard {
        let weight = simd.splat_f32s(*weight);
        for (sum, off) in sum.iter_mut().zip(&turned[*turn as usize]) {
            *sum = simd.add_f32s(*sum, simd.mul_f32s(weight, *off));
        }
    }
    let [x, y, z] = stick.rest_m;
    let rest = [simd.splat_f32s(x), simd.splat_f32s(y), simd.splat_f32s(z)];
    let [xx, xy, xz, yx, yy, yz, zx, zy, zz] = sum;
    let mean = [
        simd.add_f32s(rest[0], dot(simd, [xx, xy, xz], rest)),
        simd.add_f32s(rest[1], dot(simd, [yx, yy, yz], rest)),
        simd.add_f32s(rest[2], dot(simd, [zx, zy, zz], rest)),
    ];
    let norm = simd.sqrt_f32s(dot(simd, mean, mean));
    // Weights see to it that what guides say never cancels; a stick without length has no direction to turn.
    let is_turned = simd.greater_than_f32s(norm, simd.splat_f32s(1e-6 * stick.length_m));
    let scale = simd.div_f32s(simd.splat_f32s(stick.length_m), norm);
    let mut now = rest;
    for axis in 0..3 {
        now[axis] = simd.select_f32s(is_turned, simd.mul_f32s(mean[axis], scale), rest[axis]);
    }
    now
}

#[inline(always)]
fn dot<S: Simd>(simd: S, [ax, ay, az]: [S::f32s; 3], [bx, by, bz]: [S::f32s; 3]) -> S::f32s {
    simd.add_f32s(simd.add_f32s(simd.mul_f32s(ax, bx), simd.mul_f32s(ay, by)), simd.mul_f32s(az, bz))
}
