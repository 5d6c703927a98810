//! Whom a strand follows, and how much.

use std::num::NonZeroUsize;

use rayon::prelude::*;

use crate::alike::Place;
use crate::guides::Follower;
use crate::nearest::Nearest;

/// Guides that a strand follows at most. With 4 the followers of 500 guides among 10,000 strands in a gust are 5 %
/// farther off than with 8, with 2 they are 17 %; following takes time in proportion.
const N_FOLLOWED: usize = 8;

/// The least weight of the nearest guide. Above one half, the mean of the directions that guides give a stick can
/// never be nothing, whatever they do: the others together cannot undo the nearest. So a stick between guides that
/// swing apart turns fast at worst, by 1 / (2 · 0.55 − 1) = 10 times what they turn, and never flips. It costs 1 % of
/// the error.
pub(crate) const NEAREST_SHARE: f64 = 0.55;

/// What is taken off each guide's share of all weights. Many of the farther guides have less, and are not followed then:
/// a third fewer are heard on average (4.8 in place of 7.7), for 0.3 % of the error. Taken off and not cut off, it leaves the
/// weights without steps.
const NOT_HEARD: f64 = 0.005;

/// Whom each strand follows. `guides` are indices of strands, rising.
pub(crate) fn followers(places: &[Place], guides: &[usize]) -> Vec<Follower> {
    let tree = Nearest::new(places, guides);
    let and_one_more = NonZeroUsize::MIN.saturating_add(N_FOLLOWED);
    let follower = |(strand, place): (usize, &Place)| match guides.binary_search(&strand) {
        Ok(guide) => Follower::Guide(guide),
        Err(_) => Follower::Mean(weights(&tree.nearest(place, and_one_more))),
    };
    places.par_iter().enumerate().with_min_len(64).map(follower).collect()
}

/// Weights of guides at distances `d`, of which the last is one too many.
///
/// w ∝ ((1 − d/R) / d)², R being the distance of the first guide that is not followed: modified Shepard weights
/// (Franke and Nielson 1980). They are smooth from strand to strand: a guide's weight is nothing where another
/// takes its place. A strand that is a guide's twin follows it alone. Each then loses [`NOT_HEARD`] of them all, and the
/// nearest gets [`NEAREST_SHARE`] at least, the others what is left.
fn weights(nearest: &[(usize, f64)]) -> Vec<(usize, f64)> {
    let (followed, radius) = match nearest.get(N_FOLLOWED) {
        Some((_, radius)) => (&nearest[..N_FOLLOWED], *radius),
        None => (nearest, f64::INFINITY),
    };
    let (first, d_first) = followed[0];
    if d_first == 0.0 || followed.len() == 1 || d_first == radius {
        return vec![(first, 1.0)];
    }
    // Over the first one's distance, so that no square is too large or too small.
    let weight = |d: f64| ((1.0 - d / radius) * d_first / d).powi(2);
    let mut weights: Vec<(usize, f64)> = followed.iter().map(|(guide, d)| (*guide, weight(*d))).collect();
    let not_heard = NOT_HEARD * weights.iter().map(|(_, w)| w).sum::<f64>();
    weights.iter_mut().for_each(|(_, w)| *w -= not_heard);
    weights.retain(|(_, w)| *w > 0.0);
    let others: f64 = weights[1..].iter().map(|(_, w)| w).sum();
    let share = f64::max(weights[0].1 / (weights[0].1 + others), NEAREST_SHARE);
    weights[0].1 = share;
    weights[1..].iter_mut().for_each(|(_, w)| *w *= (1.0 - share) / others);
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(distances: &[f64], expected: &[f64]) {
        let nearest: Vec<(usize, f64)> = distances.iter().copied().enumerate().collect();
        let found: Vec<f64> = weights(&nearest).into_iter().map(|(_, w)| w).collect();
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn weights_by_hand() {
        check(&[0.3], &[1.0]);
        check(&[0.0, 0.1], &[1.0]);
        // Squares of 1/1 and 1/2: 4 to 1; 0.005 of 5 off each.
        check(&[1.0, 2.0], &[3.975 / 4.95, 0.975 / 4.95]);
        // Equally near: the first gets its least share.
        check(&[1.0, 1.0], &[0.55, 0.45]);
        // 400 to 1, which is less than 0.005.
        check(&[1.0, 20.0], &[1.0]);
        // (1 - 1/4)² = 9/16 and ((1 - 1/2)/2)² = 1/16; the others are at the rim. 0.005 of 10 off each.
        check(&[1.0, 2.0, 4.0, 4.0, 4.0, 4.0, 4.0, 4.0, 4.0], &[8.95 / 9.9, 0.95 / 9.9]);
        // All at the rim.
        check(&[1.0; 9], &[1.0]);
    }
}
