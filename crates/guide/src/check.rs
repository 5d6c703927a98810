use serde::Serialize;
use tousle_core::{Groom, StrandMotion, Vec3};

use crate::GuideError;
use crate::follow::starts;
use crate::guides::{Guides, part};

/// How far strands that follow are from where the simulator takes them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FollowError {
    /// Strands that were compared.
    pub n_strands: usize,
    /// Mean distance over all their control points but the roots and over all frames, mm.
    pub mean_mm: f64,
    /// 95 of 100 distances are no larger, mm.
    pub p95_mm: f64,
    /// The largest distance, mm.
    pub max_mm: f64,
    /// 1 − rms distance / rms displacement from where the simulator has them in the first frame: 1 is perfect, 0 no better
    /// than hair that never moves. 1 where nothing moves.
    pub explained: f64,
}

impl Guides {
    /// Some strands as a groom of their own, to be simulated and given to [`compare`].
    ///
    /// # Panics
    /// If an index is past the groom's end.
    pub fn groom_of(groom: &Groom, strands: &[usize]) -> Groom {
        part(groom, strands)
    }
}

/// Compares the motion of all strands with a simulation of some of them.
///
/// # Errors
/// [`GuideError::BadMotion`] if the motions do not have the same frames and points of these strands.
pub fn compare(
    followed: &StrandMotion,
    simulated: &StrandMotion,
    strands: &[usize],
) -> Result<FollowError, GuideError> {
    let counts: Option<Vec<usize>> = strands.iter().map(|k| followed.counts.get(*k).copied()).collect();
    let same = counts.as_ref() == Some(&simulated.counts) && followed.times_secs == simulated.times_secs;
    if !same {
        return Err(GuideError::BadMotion {
            found: format!("{} strands in {} frames", simulated.counts.len(), simulated.times_secs.len()),
            expected: format!("{} of the groom's in {}", strands.len(), followed.times_secs.len()),
        });
    }
    let starts = starts(&followed.counts);
    let mut distances = Vec::new();
    let (mut error, mut displacement) = (0.0, 0.0);
    for frame in 0..simulated.times_secs.len() {
        let (all, some, rest) = (followed.frame(frame), simulated.frame(frame), simulated.frame(0));
        let mut first = 0;
        for (strand, n) in strands.iter().zip(&simulated.counts) {
            for k in 1..*n {
                let [is, should, was] = [all[starts[*strand] + k], some[first + k], rest[first + k]]
                    .map(|p| Vec3::from(p.map(f64::from)));
                let off = (is - should).norm();
                distances.push(off);
                error += off * off;
                displacement += (should - was).norm_squared();
            }
            first += n;
        }
    }
    distances.sort_by(f64::total_cmp);
    let n = distances.len();
    let rank =
        |share: f64| distances.get(((n as f64 * share).ceil() as usize).max(1) - 1).copied().unwrap_or(0.0);
    Ok(FollowError {
        n_strands: strands.len(),
        mean_mm: 1e3 * distances.iter().sum::<f64>() / n.max(1) as f64,
        p95_mm: 1e3 * rank(0.95),
        max_mm: 1e3 * rank(1.0),
        explained: if displacement > 0.0 { 1.0 - f64::sqrt(error / displacement) } else { 1.0 },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_by_hand() {
        let motion = |counts: Vec<usize>, positions_m: Vec<[f32; 3]>| StrandMotion {
            counts,
            times_secs: vec![0.0, 1.0],
            positions_m,
        };
        let still = [[0.0; 3]; 4];
        let followed =
            motion(vec![2, 2], [still, [[0.0; 3], [9.0; 3], [0.0; 3], [0.003, 0.0, 0.0]]].concat());
        let simulated = motion(vec![2], vec![[0.0; 3], [0.0; 3], [0.0; 3], [0.0, 0.004, 0.0]]);
        let error = compare(&followed, &simulated, &[1]).unwrap();
        assert!((error.max_mm - 5.0).abs() < 1e-6 && (error.mean_mm - 2.5).abs() < 1e-6, "{error:?}");
        assert!((error.explained + 0.25).abs() < 1e-6, "5 mm off where 4 mm were moved");
        assert!(compare(&followed, &simulated, &[0, 1]).is_err());
        assert!(compare(&followed, &simulated, &[2]).is_err());
    }
}
