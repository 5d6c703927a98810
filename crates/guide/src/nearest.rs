//! The guides that are most like a strand, without asking each of them.

use std::num::NonZeroUsize;

use kiddo::{ImmutableKdTree, SquaredEuclidean};

use crate::alike::{N, Place, squared_distance};

/// Guides in a tree of their places: few of the 22 numbers of a place vary by themselves, so it leaves out most.
pub(crate) struct Nearest<'a> {
    tree: ImmutableKdTree<f64, N>,
    places: &'a [Place],
    guides: &'a [usize],
}

impl<'a> Nearest<'a> {
    /// `guides` are indices into `places`, at least one.
    pub(crate) fn new(places: &'a [Place], guides: &'a [usize]) -> Self {
        let of_guides: Vec<Place> = guides.iter().map(|guide| places[*guide]).collect();
        let tree = ImmutableKdTree::new_from_slice(&of_guides).expect("fewer guides than 32 bits count");
        Self { tree, places, guides }
    }

    /// At most `n` guides (their places in the list) with their distances, the nearest first, of equals the first.
    pub(crate) fn nearest(&self, place: &Place, n: NonZeroUsize) -> Vec<(usize, f64)> {
        let n = n.min(NonZeroUsize::new(self.guides.len()).unwrap_or(n));
        let found = self.tree.query(place).nearest_n::<SquaredEuclidean<f64>>(n).execute();
        let distance = |guide: usize| squared_distance(place, &self.places[self.guides[guide]]).sqrt();
        let mut nearest: Vec<(usize, f64)> =
            found.iter().map(|f| (f.item as usize, distance(f.item as usize))).collect();
        nearest.sort_unstable_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        nearest
    }

    /// The nearest guide (its place in the list).
    pub(crate) fn first(&self, place: &Place) -> usize {
        self.tree.query(place).nearest_one::<SquaredEuclidean<f64>>().execute().item as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half of the numbers are the same for all, as those of flat or even grooms are; some guides are twins.
    #[test]
    fn a_tree_finds_what_asking_all_finds() {
        let digit = |k: usize| libm::sin(12.9898 * k as f64 + 1.0) * 43_758.547 % 1.0;
        let place = |k: usize| -> Place {
            std::array::from_fn(|axis| if axis % 2 == 0 { digit(N * (k % 700) + axis) } else { 0.25 })
        };
        let places: Vec<Place> = (0..900).map(place).collect();
        let guides: Vec<usize> = (0..900).filter(|k| k % 3 == 0).collect();
        let found = Nearest::new(&places, &guides);
        for place in &places {
            let mut all: Vec<(usize, f64)> = guides
                .iter()
                .enumerate()
                .map(|(k, guide)| (k, squared_distance(place, &places[*guide]).sqrt()))
                .collect();
            all.sort_by(|a, b| a.1.total_cmp(&b.1));
            let nearest = found.nearest(place, NonZeroUsize::new(9).unwrap_or(NonZeroUsize::MIN));
            let distances = |of: &[(usize, f64)]| of.iter().map(|(_, d)| *d).collect::<Vec<_>>();
            assert_eq!(distances(&nearest), distances(&all[..9]));
            assert_eq!(squared_distance(place, &places[guides[found.first(place)]]).sqrt(), all[0].1);
        }
    }
}
