use rayon::prelude::*;
use tousle_core::Groom;

use crate::alike::{Place, places, squared_distance};
use crate::nearest::Nearest;
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
///
/// Each strand belongs to the chosen one that lies nearest. A new one is nearer only to strands whose own lies less than twice
/// as far from it as from them (the triangle's inequality), so few are asked.
fn far_apart(places: &[Place], n: usize) -> Vec<usize> {
    let middle = nearest_to(places, 0..places.len(), &mean(places, 0..places.len()));
    let of_middle = (0..places.len())
        .map(|k| Member { strand: k, squared: squared_distance(&places[k], &places[middle]) });
    let mut parts = vec![Part::new(middle, of_middle.collect())];
    while parts.len() < n.min(places.len()) {
        let Some(farthest) = parts.iter().filter_map(|part| part.farthest).reduce(farther) else { break };
        if farthest.squared == 0.0 {
            break;
        }
        let new = &places[farthest.strand];
        let mut nearer = Vec::new();
        for part in &mut parts {
            let between = squared_distance(new, &places[part.chosen]);
            if part.farthest.is_some_and(|member| between < 4.0 * member.squared) {
                part.give_up(between, places, new, &mut nearer);
            }
        }
        parts.push(Part::new(farthest.strand, nearer));
    }
    parts.into_iter().map(|part| part.chosen).collect()
}

/// A strand, and how far it lies from the chosen one that lies nearest, squared.
#[derive(Clone, Copy)]
struct Member {
    strand: usize,
    squared: f64,
}

/// The one farther off; of equals the one whose strand comes first.
fn farther(a: Member, b: Member) -> Member {
    if a.squared.total_cmp(&b.squared).then(b.strand.cmp(&a.strand)).is_ge() { a } else { b }
}

/// A chosen strand and all that lie nearer to it than to another.
struct Part {
    chosen: usize,
    members: Vec<Member>,
    farthest: Option<Member>,
}

impl Part {
    fn new(chosen: usize, members: Vec<Member>) -> Self {
        let farthest = members.iter().copied().reduce(farther);
        Self { chosen, members, farthest }
    }

    /// Gives those up that lie nearer to a new place, which is `between` (squared) from the chosen strand's.
    fn give_up(&mut self, between: f64, places: &[Place], new: &Place, nearer: &mut Vec<Member>) {
        let before = nearer.len();
        self.members.retain(|member| {
            if between >= 4.0 * member.squared {
                return true;
            }
            let squared = squared_distance(&places[member.strand], new);
            let stays = squared >= member.squared;
            if !stays {
                nearer.push(Member { squared, ..*member });
            }
            stays
        });
        if nearer.len() > before {
            self.farthest = self.members.iter().copied().reduce(farther);
        }
    }
}

/// For each guide the strand in the middle of those that have no other guide nearer.
fn in_the_middle(places: &[Place], guides: &[usize]) -> Vec<usize> {
    let tree = Nearest::new(places, guides);
    let of_strand: Vec<usize> = places.par_iter().with_min_len(64).map(|place| tree.first(place)).collect();
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
