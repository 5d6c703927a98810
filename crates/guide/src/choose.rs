use rayon::prelude::*;
use tousle_core::Groom;

use crate::alike::{Place, places, squared_distance};
use crate::weights::followers;
use crate::{GuideError, Guides};

/// Rounds in which guides move to the middle of those who follow them. More than this change a guide or two.
const MAX_ROUNDS: usize = 8;

/// Chooses at most `n` guides among a groom's strands, and whom each of the others follows.
///
/// Strands are taken for places in a space in which those lie together whose roots, rest shapes and weight for
/// their width are alike. The first guide is the strand in the middle; each further one is the one that lies
/// farthest from all guides so far (Gonzalez 1985), so that every shape and every part of the scalp has one near;
/// then, a few times, each guide gives way to the strand in the middle of those nearest to it (Lloyd 1982 with
/// medoids), so that where hair is dense there are more. There are fewer than `n` guides only if fewer strands
/// differ. Nothing is drawn by lot: the same groom gives the same guides, in whatever order its strands are, except
/// where two are equally good.
///
/// # Errors
/// [`GuideError::NoGuides`] if `n` is 0, [`GuideError::Groom`] if the groom cannot be simulated.
pub fn choose(groom: &Groom, n: usize) -> Result<Guides, GuideError> {
    groom.check()?;
    if n == 0 {
        return Err(GuideError::NoGuides);
    }
    let places = places(groom);
    let mut strands = far_apart(&places, n);
    for _ in 0..MAX_ROUNDS {
        let settled = in_the_middle(&places, &strands);
        if settled == strands {
            break;
        }
        strands = settled;
    }
    strands.sort_unstable();
    strands.dedup();
    let followers = followers(&places, &strands);
    Ok(Guides { strands, followers })
}

/// Strands that lie as far apart as can be, from the middle outwards.
fn far_apart(places: &[Place], n: usize) -> Vec<usize> {
    let mut chosen = vec![nearest_to(places, 0..places.len(), &mean(places, 0..places.len()))];
    let mut squared: Vec<f64> = vec![f64::INFINITY; places.len()];
    while chosen.len() < n.min(places.len()) {
        let last = &places[chosen[chosen.len() - 1]];
        squared
            .par_iter_mut()
            .zip(places)
            .with_min_len(1024)
            .for_each(|(d, place)| *d = d.min(squared_distance(place, last)));
        let (farthest, distance) = squared
            .iter()
            .enumerate()
            .fold((0, 0.0), |best, (k, d)| if *d > best.1 { (k, *d) } else { best });
        if distance == 0.0 {
            break;
        }
        chosen.push(farthest);
    }
    chosen
}

/// For each guide the strand in the middle of those that have no other guide nearer.
fn in_the_middle(places: &[Place], guides: &[usize]) -> Vec<usize> {
    let nearest_guide = |place: &Place| {
        let distances = guides.iter().map(|g| squared_distance(place, &places[*g]));
        first_smallest(distances).unwrap_or(0)
    };
    let of_strand: Vec<usize> = places.par_iter().with_min_len(64).map(nearest_guide).collect();
    let mut parts = vec![Vec::new(); guides.len()];
    for (strand, guide) in of_strand.into_iter().enumerate() {
        parts[guide].push(strand);
    }
    let middle = |(part, guide): (Vec<usize>, &usize)| {
        if part.is_empty() {
            return *guide;
        }
        nearest_to(places, part.iter().copied(), &mean(places, part.iter().copied()))
    };
    parts.into_par_iter().zip(guides).map(middle).collect()
}

fn mean(places: &[Place], strands: impl ExactSizeIterator<Item = usize>) -> Place {
    let n = strands.len() as f64;
    let mut sum = places[0].map(|_| 0.0);
    for strand in strands {
        sum.iter_mut().zip(&places[strand]).for_each(|(sum, x)| *sum += x);
    }
    sum.map(|x| x / n)
}

/// The strand nearest to a place, the first of equals.
fn nearest_to(places: &[Place], strands: impl Iterator<Item = usize> + Clone, place: &Place) -> usize {
    let distances = strands.clone().map(|k| squared_distance(&places[k], place));
    let index = first_smallest(distances).unwrap_or(0);
    strands.into_iter().nth(index).unwrap_or(0)
}

fn first_smallest(values: impl Iterator<Item = f64>) -> Option<usize> {
    values.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
}
