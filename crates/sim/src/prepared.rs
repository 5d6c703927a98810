use crate::touchable::Touchable;
use tousle_rod::{Lock, Rest};

/// A strand as it hangs at rest, ready to be put into a batch.
#[derive(Debug)]
pub(crate) struct Prepared<S> {
    pub lock: Lock,
    pub rest: Rest,
    /// Colliders in reach.
    pub touchable: Vec<Touchable>,
    /// What its method makes of it.
    pub shape: S,
}

impl<S> Prepared<S> {
    /// Deepest that the rest curve lies in the body, m, ≥ 0.
    pub fn deepest_m(&self) -> f64 {
        -self.rest.clearances_m.iter().copied().fold(0.0, f64::min)
    }
}

/// Strands in an order in which neighbors in a batch have as many sticks, and neighbors in the list grow close by.
pub(crate) fn order<S>(prepared: &[Prepared<S>], strands: &[usize]) -> Vec<usize> {
    let mut order = strands.to_vec();
    let cell = |p: &Prepared<S>| {
        let [x, y, z] = [0, 1, 2].map(|axis| ((p.lock.root_m[axis] + 0.5) * 50.0) as i64);
        (x, y, z)
    };
    order.sort_by_cached_key(|s| (prepared[*s].lock.n_sticks(), cell(&prepared[*s])));
    order
}
