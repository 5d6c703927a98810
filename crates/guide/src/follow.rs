use rayon::prelude::*;
use tousle_core::{Groom, Progress, StrandMotion, Vec3};
use tousle_lanes::{Lane, Matrix, Precision, Registers, WithLanes};

use crate::alike::lengths;
use crate::guides::Follower;
use crate::put::{Heard, Listening, Prepared, Put, Stick};
use crate::turns::{AtRest, Turning};
use crate::{GuideError, Guides};

/// The most positions of a motion: 12 GB, as in the simulator.
const MAX_POSITIONS: f64 = 1e9;

/// Strands that a thread puts in their places at once: few enough for many threads, enough to be worth handing out.
const STRANDS_AT_ONCE: usize = 128;

/// Guides whose turns a thread works out at once.
const GUIDES_AT_ONCE: usize = 32;

/// A stick whose share of the length is so near to that of a guide's stick is heard of that one alone: strands of as many even
/// points as their guides, as most grooms have, hear of half as many sticks.
const SAME_SHARE: f64 = 1e-6;

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
    Ok(follow_in(Registers::widest(), groom, guides, motion, progress))
}

/// [`follow`] of what belongs together, in some registers.
fn follow_in(
    registers: Registers,
    groom: &Groom,
    guides: &Guides,
    motion: &StrandMotion,
    progress: &dyn Progress,
) -> StrandMotion {
    let counts = groom.counts();
    let n_points: usize = counts.iter().sum();
    let n_frames = motion.times_secs.len();
    let leaders = Leaders::new(groom, guides);
    let strands: Vec<Prepared> = groom
        .strands
        .par_iter()
        .zip(&guides.followers)
        .map(|(s, f)| leaders.prepare(&s.rest_curve_m, f))
        .collect();
    let mut positions_m = vec![[0.0; 3]; n_frames * n_points];
    registers.with_lanes(
        Precision::Single,
        Following {
            registers,
            leaders: &leaders,
            strands: &strands,
            counts: &counts,
            motion,
            positions_m: &mut positions_m,
            progress,
        },
    );
    StrandMotion { counts, times_secs: motion.times_secs.clone(), positions_m }
}

/// All frames, as many at once as there are lanes.
struct Following<'a> {
    registers: Registers,
    leaders: &'a Leaders,
    strands: &'a [Prepared],
    counts: &'a [usize],
    motion: &'a StrandMotion,
    positions_m: &'a mut [[f32; 3]],
    progress: &'a dyn Progress,
}

impl WithLanes for Following<'_> {
    type Output = ();

    fn with<L: Lane>(self) {
        let n_points: usize = self.counts.iter().sum();
        let n_frames = self.motion.times_secs.len();
        let mut turned = vec![Matrix::<L>::zero(); self.leaders.n_sticks()];
        for (block, out) in self.positions_m.chunks_mut(L::N * n_points).enumerate() {
            let frames: Vec<&[[f32; 3]]> =
                (L::N * block..n_frames).take(L::N).map(|frame| self.motion.frame(frame)).collect();
            self.leaders.turn(self.registers, &frames, &mut turned);
            let parts = parts(self.strands, self.counts, out.chunks_exact_mut(n_points).collect());
            parts.into_par_iter().for_each(|(strands, mut out)| {
                L::dispatch(Put { strands, guide_points: &frames, turned: &turned, out: &mut out });
            });
            self.progress.at((L::N * block + frames.len()) as u64, n_frames as u64);
        }
    }
}

/// Some strands, and where their points go in each frame.
type Part<'a, 'b> = (&'a [Prepared], Vec<&'b mut [[f32; 3]]>);

/// Strands after strands, each few with their points in frames that hold those of all.
fn parts<'a, 'b>(
    strands: &'a [Prepared],
    counts: &[usize],
    mut frames: Vec<&'b mut [[f32; 3]]>,
) -> Vec<Part<'a, 'b>> {
    let part = |(strands, counts): (&'a [Prepared], &[usize])| {
        let n: usize = counts.iter().sum();
        let own = frames.iter_mut().map(|frame| frame.split_off_mut(..n).expect("points of all strands"));
        (strands, own.collect())
    };
    strands.chunks(STRANDS_AT_ONCE).zip(counts.chunks(STRANDS_AT_ONCE)).map(part).collect()
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

    /// How many sticks all guides have.
    fn n_sticks(&self) -> usize {
        self.counts.iter().map(|n| n - 1).sum()
    }

    /// How far all guides' sticks have turned since rest in some frames, guide after guide: R − 1. Where there are fewer
    /// frames than lanes, the last again.
    ///
    /// The turns are worked out in double precision: they are products of as many as there are sticks, and what is at rest
    /// stays there to the bit.
    fn turn<L: Lane>(&self, registers: Registers, frames: &[&[[f32; 3]]], mut turned: &mut [Matrix<L>]) {
        let own = |counts: &[usize]| {
            let n_sticks = counts.iter().map(|n| n - 1).sum();
            turned.split_off_mut(..n_sticks).expect("all guides' sticks")
        };
        let own: Vec<_> = self.counts.chunks(GUIDES_AT_ONCE).map(own).collect();
        let guides = self.at_rest.par_chunks(GUIDES_AT_ONCE).zip(self.first_point.par_chunks(GUIDES_AT_ONCE));
        guides.zip(own).for_each(|((at_rest, first_points), turned)| {
            let turning = Turning { at_rest, first_points, frames, turned };
            registers.with_lanes(Precision::Double, turning);
        });
    }

    fn prepare(&self, curve_m: &[Vec3], follower: &Follower) -> Prepared {
        let guides = match follower {
            Follower::Guide(guide) => {
                let first = self.first_point[*guide];
                return Prepared::Guide(first..first + self.counts[*guide]);
            }
            Follower::Mean(guides) => guides,
        };
        let middles = middles(curve_m);
        let is_alike = guides.iter().all(|(guide, _)| are_alike(&middles, &self.middles[*guide]));
        let n_listened = if is_alike { 1 } else { middles.len() };
        let mut heard = Vec::with_capacity(2 * guides.len() * n_listened);
        let mut n_heard = Vec::with_capacity(n_listened);
        for share in &middles[..n_listened] {
            let before = heard.len();
            guides.iter().for_each(|(guide, weight)| self.hear(*guide, *weight, *share, &mut heard));
            n_heard.push(heard.len() - before);
        }
        let sticks = curve_m.windows(2).map(|pair| Stick::new(pair[0], pair[1])).collect();
        let listening = if is_alike { Listening::StickByStick } else { Listening::Each { n_heard } };
        Prepared::Sticks { root_m: single(curve_m[0]), sticks, heard, listening }
    }

    /// What a stick at a share of its strand's length hears of a guide.
    fn hear(&self, guide: usize, weight: f64, share: f64, heard: &mut Vec<Heard>) {
        let middles = &self.middles[guide];
        // A guide of p points before this one has p − 1 sticks.
        let first = self.first_point[guide] - guide;
        let mut say = |stick: usize, part: f64| {
            heard.push(Heard { turn: (first + stick) as u32, weight: (weight * part) as f32 });
        };
        let next = middles.partition_point(|m| *m <= share);
        if next == 0 || next == middles.len() {
            return say(next.saturating_sub(1), 1.0);
        }
        let [before, after] = [middles[next - 1], middles[next]];
        if share - before < SAME_SHARE {
            say(next - 1, 1.0);
        } else if after - share < SAME_SHARE {
            say(next, 1.0);
        } else {
            let part = (share - before) / (after - before);
            say(next - 1, 1.0 - part);
            say(next, part);
        }
    }
}

/// Whether the middles of two strands' sticks lie at the same shares of their lengths.
fn are_alike(middles: &[f64], others: &[f64]) -> bool {
    let is_near = |(a, b): (&f64, &f64)| (a - b).abs() < SAME_SHARE;
    middles.len() == others.len() && middles.iter().zip(others).all(is_near)
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

pub(crate) fn single(point: Vec3) -> [f32; 3] {
    point.map(|c| c as f32).into()
}

pub(crate) fn double(point: [f32; 3]) -> Vec3 {
    point.map(f64::from).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_bench::worlds::wig;
    use tousle_core::NoProgress;

    /// A frame does not know how many are worked out beside it, nor in which registers; also where strands have other points
    /// than their guides.
    #[test]
    fn strands_follow_the_same_in_all_registers() {
        let mut groom = wig(60, 7);
        groom.strands.iter_mut().step_by(3).for_each(|s| s.rest_curve_m.truncate(5));
        let guides = crate::choose(&groom, 8).unwrap();
        let rest = guides.groom(&groom);
        let swung = |frame: usize| {
            let sway = move |along: usize| 0.3 * libm::sin(0.7 * frame as f64 + 0.2 * along as f64);
            let place =
                move |(k, p): (usize, &Vec3)| single(p + Vec3::new(sway(k), 0.0, 0.5 * sway(k + 3)) * p.z);
            rest.strands.iter().flat_map(move |s| s.rest_curve_m.iter().enumerate().map(place))
        };
        let n_frames = 19;
        let motion = StrandMotion {
            counts: rest.counts(),
            times_secs: (0..n_frames).map(|frame| frame as f64 / 60.0).collect(),
            positions_m: (0..n_frames).flat_map(swung).collect(),
        };
        let here = Registers::here();
        let followed = |registers: &Registers| follow_in(*registers, &groom, &guides, &motion, &NoProgress);
        let positions: Vec<_> = here.iter().map(|registers| followed(registers).positions_m).collect();
        assert!(positions.iter().all(|p| *p == positions[0]), "{here:?}");
    }
}
