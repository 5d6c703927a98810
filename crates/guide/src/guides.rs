use tousle_core::Groom;

/// Which strands of a groom are guides, and whom each of the others follows.
#[derive(Clone, Debug, PartialEq)]
pub struct Guides {
    pub(crate) strands: Vec<usize>,
    pub(crate) followers: Vec<Follower>,
}

/// Whom a strand follows.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Follower {
    /// It is this guide itself.
    Guide(usize),
    /// Guides (their places in the list) and their weights, which add up to 1, the nearest first.
    Mean(Vec<(usize, f64)>),
}

impl Guides {
    /// The guides' indices in the groom, rising.
    pub fn strands(&self) -> &[usize] {
        &self.strands
    }

    /// How many strands there are, guides included.
    pub fn n_strands(&self) -> usize {
        self.followers.len()
    }

    /// Guides that a strand follows (indices in the groom) and their weights, which add up to 1; the nearest first.
    ///
    /// # Panics
    /// If `strand_idx` is past the end.
    pub fn weights(&self, strand_idx: usize) -> Vec<(usize, f64)> {
        match &self.followers[strand_idx] {
            Follower::Guide(guide) => vec![(self.strands[*guide], 1.0)],
            Follower::Mean(weights) => weights.iter().map(|(guide, w)| (self.strands[*guide], *w)).collect(),
        }
    }

    /// The guides as a groom of their own: what has to be simulated.
    ///
    /// # Panics
    /// If the groom has fewer strands than the one in which the guides were chosen.
    pub fn groom(&self, groom: &Groom) -> Groom {
        part(groom, &self.strands)
    }

    /// At most `n` strands that follow, evenly spread over the groom's order: what is worth simulating to see how
    /// well the others do. Indices in the groom, rising.
    pub fn sample(&self, n: usize) -> Vec<usize> {
        let is_guide = |k: &usize| matches!(self.followers[*k], Follower::Guide(_));
        let following: Vec<usize> = (0..self.followers.len()).filter(|k| !is_guide(k)).collect();
        let n = n.min(following.len());
        // The middle of each of n equal parts.
        (0..n).map(|k| following[(2 * k + 1) * following.len() / (2 * n)]).collect()
    }
}

/// Some strands of a groom as a groom of their own.
pub(crate) fn part(groom: &Groom, strands: &[usize]) -> Groom {
    let strands = strands.iter().map(|k| groom.strands[*k].clone()).collect();
    Groom { strands, assumed: groom.assumed.clone() }
}
