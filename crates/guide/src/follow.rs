use std::sync::atomic::{AtomicU64, Ordering};

use nalgebra::Matrix3;
use rayon::prelude::*;
use tousle_core::{Groom, Progress, StrandMotion, Vec3};

use crate::alike::lengths;
use crate::guides::Follower;
use crate::turns::AtRest;
use crate::{GuideError, Guides};

/// The most positions of a motion: 12 GB, as in the simulator.
const MAX_POSITIONS: f64 = 1e9;

/// The motion of all strands from that of the guides.
///
/// In: the groom, the guides chosen in it, the motion of [`Guides::groom`], head space, m. Out: the motion of the
/// groom, at the same times. A guide's motion is its own, to the bit. Each stick of any other strand points along
/// Σ w R d, d being its direction at rest, w the weights of the guides it follows, R how each of them has turned
/// since rest at the same share of its length (between the middles of two sticks, a mean of both). From the root on,
/// sticks of the lengths that they have at rest give the points. So points and lengths of guide and follower may
/// differ, no stick is stretched by more than positions of 32 bits make it, and where guides hang as at rest, so
/// does what follows. Collisions are the guides': a follower may dip into the head where its guides pass
/// by; [`keep_out`](crate::keep_out) pushes it out again.
///
/// The result does not depend on the number of threads; frames do not depend on one another.
///
/// # Errors
/// [`GuideError`] if the groom, the guides and the motion do not belong together, or if the result would be too
/// large to hold.
pub fn follow(
    groom: &Groom,
    guides: &Guides,
    motion: &StrandMotion,
    progress: &dyn Progress,
) -> Result<StrandMotion, GuideError> {
    check(groom, guides, motion)?;
    let counts = groom.counts();
    let n_points: usize = counts.iter().sum();
    let n_frames = motion.times_secs.len();
    let leaders = Leaders::new(groom, guides);
    let strands: Vec<Prepared> = groom
        .strands
        .iter()
        .zip(&guides.followers)
        .map(|(s, f)| leaders.prepare(&s.rest_curve_m, f))
        .collect();
    let mut positions_m = vec![[0.0; 3]; n_frames * n_points];
    let done = AtomicU64::new(0);
    positions_m.par_chunks_exact_mut(n_points).enumerate().for_each(|(frame, out)| {
        let guide_points = motion.frame(frame);
        let turns = leaders.turns(guide_points);
        let mut rest = out;
        for (strand, n) in strands.iter().zip(&counts) {
            let (points, others) = std::mem::take(&mut rest).split_at_mut(*n);
            strand.put(guide_points, &turns, points);
            rest = others;
        }
        progress.at(done.fetch_add(1, Ordering::Relaxed) + 1, n_frames as u64);
    });
    Ok(StrandMotion { counts, times_secs: motion.times_secs.clone(), positions_m })
}

fn check(groom: &Groom, guides: &Guides, motion: &StrandMotion) -> Result<(), GuideError> {
    groom.check()?;
    if guides.n_strands() != groom.strands.len() {
        return Err(GuideError::OtherGroom { found: guides.n_strands(), expected: groom.strands.len() });
    }
    let expected: Vec<usize> = guides.strands.iter().map(|k| groom.strands[*k].rest_curve_m.len()).collect();
    if motion.counts != expected {
        return Err(GuideError::BadMotion {
            found: format!("{} strands of {} points", motion.counts.len(), motion.n_points()),
            expected: format!("the {} guides of {} points", expected.len(), expected.iter().sum::<usize>()),
        });
    }
    let (n_frames, n_points) = (motion.times_secs.len(), groom.n_points());
    if motion.positions_m.len() != n_frames * motion.n_points() {
        return Err(GuideError::BadMotion {
            found: format!("{} positions", motion.positions_m.len()),
            expected: format!("{n_frames} frames of {}", motion.n_points()),
        });
    }
    if n_frames as f64 * n_points as f64 > MAX_POSITIONS {
        return Err(GuideError::TooLarge { n_frames, n_points });
    }
    Ok(())
}

/// The guides, ready to be asked how they have turned.
struct Leaders {
    at_rest: Vec<AtRest>,
    /// Where each guide's points start among those of all guides.
    first_point: Vec<usize>,
    counts: Vec<usize>,
    /// Share of each guide's length at which the middles of its sticks lie.
    middles: Vec<Vec<f64>>,
}

/// A strand, ready to be put where its guides are.
enum Prepared {
    /// Its points are there among the guides'.
    Guide(usize),
    /// It follows.
    Sticks { curve_m: Vec<Vec3>, sticks: Vec<Vec3>, heard: Vec<Heard>, n_heard: usize },
}

/// What a stick hears of one guide: the turns of a stick of the guide and of the next one, each with its weight.
struct Heard {
    turn: usize,
    weights: [f64; 2],
}

impl Leaders {
    fn new(groom: &Groom, guides: &Guides) -> Self {
        let curves = || guides.strands.iter().map(|k| &groom.strands[*k].rest_curve_m);
        let counts: Vec<usize> = curves().map(Vec::len).collect();
        Self {
            // As a motion has them: what is at rest then has not turned by a rounding error.
            at_rest: curves()
                .map(|c| AtRest::new(&c.iter().map(|p| double(single(*p))).collect::<Vec<_>>()))
                .collect(),
            first_point: starts(&counts),
            counts,
            middles: curves().map(|c| middles(c)).collect(),
        }
    }

    /// The turns of all guides' sticks, guide after guide.
    fn turns(&self, points: &[[f32; 3]]) -> Vec<Matrix3<f64>> {
        let mut turns = Vec::with_capacity(points.len());
        for ((at_rest, first), n) in self.at_rest.iter().zip(&self.first_point).zip(&self.counts) {
            let curve: Vec<Vec3> = points[*first..first + n].iter().copied().map(double).collect();
            at_rest.turns(&curve, &mut turns);
        }
        turns
    }

    fn prepare(&self, curve_m: &[Vec3], follower: &Follower) -> Prepared {
        let guides = match follower {
            Follower::Guide(guide) => return Prepared::Guide(self.first_point[*guide]),
            Follower::Mean(guides) => guides,
        };
        let heard = |share: f64| guides.iter().map(move |(guide, weight)| self.heard(*guide, *weight, share));
        Prepared::Sticks {
            sticks: curve_m.windows(2).map(|pair| pair[1] - pair[0]).collect(),
            heard: middles(curve_m).into_iter().flat_map(heard).collect(),
            n_heard: guides.len(),
            curve_m: curve_m.to_vec(),
        }
    }

    /// What a stick at a share of its strand's length hears of a guide.
    fn heard(&self, guide: usize, weight: f64, share: f64) -> Heard {
        let middles = &self.middles[guide];
        // A guide of p points before this one has p − 1 sticks.
        let first = self.first_point[guide] - guide;
        let next = middles.partition_point(|m| *m <= share);
        if next == 0 || next == middles.len() {
            return Heard { turn: first + next.saturating_sub(1), weights: [weight, 0.0] };
        }
        let part = (share - middles[next - 1]) / (middles[next] - middles[next - 1]);
        Heard { turn: first + next - 1, weights: [weight * (1.0 - part), weight * part] }
    }
}

impl Prepared {
    /// Puts the strand's points where its guides take them.
    fn put(&self, guide_points: &[[f32; 3]], turns: &[Matrix3<f64>], out: &mut [[f32; 3]]) {
        let (curve_m, sticks, heard, n_heard) = match self {
            Self::Guide(first) => return out.copy_from_slice(&guide_points[*first..][..out.len()]),
            Self::Sticks { curve_m, sticks, heard, n_heard } => (curve_m, sticks, heard, *n_heard),
        };
        out[0] = single(curve_m[0]);
        let mut moved = Vec3::zeros();
        for (k, (stick, heard)) in sticks.iter().zip(heard.chunks_exact(n_heard)).enumerate() {
            let mut sum = Matrix3::zeros();
            for Heard { turn, weights: [this, next] } in heard {
                sum += turns[*turn] * *this;
                if *next > 0.0 {
                    sum += turns[turn + 1] * *next;
                }
            }
            let mean = sum * stick;
            // By how far the point is from its rest place, so that at rest it is there to the last digit.
            let turned = mean.try_normalize(1e-12).map_or(*stick, |direction| direction * stick.norm());
            moved += turned - stick;
            out[k + 1] = single(curve_m[k + 1] + moved);
        }
    }
}

/// Shares of a polyline's length at which the middles of its sticks lie.
fn middles(curve: &[Vec3]) -> Vec<f64> {
    let (along, length) = lengths(curve);
    along.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]) / length).collect()
}

/// Where each strand's points start among those of all.
pub(crate) fn starts(counts: &[usize]) -> Vec<usize> {
    let mut first = 0;
    let start = |n: &usize| {
        first += n;
        first - n
    };
    counts.iter().map(start).collect()
}

fn single(point: Vec3) -> [f32; 3] {
    point.map(|c| c as f32).into()
}

fn double(point: [f32; 3]) -> Vec3 {
    point.map(f64::from).into()
}
