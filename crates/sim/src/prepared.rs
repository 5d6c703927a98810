use crate::touchable::Touchable;
use tousle_core::Vec3;
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

/// Strands in an order in which neighbors in a batch have as many sticks, and neighbors in the list grow close by: in a dense
/// hairstyle a batch then asks few voxels.
pub(crate) fn order<S>(prepared: &[Prepared<S>], strands: &[usize]) -> Vec<usize> {
    let mut order = strands.to_vec();
    order.sort_by_cached_key(|s| (prepared[*s].lock.n_sticks(), along_z(prepared[*s].lock.root_m)));
    order
}

/// Where a place is along Z-shaped curves through cubes of 1 mm (Morton 1966, "A computer oriented geodetic data base").
fn along_z(place_m: Vec3) -> u64 {
    let millimeters = place_m.map(|c| ((c + 1.0) * 1e3).clamp(0.0, 2047.0) as u64);
    (0..11)
        .map(|bit| (0..3).map(|axis| (millimeters[axis] >> bit & 1) << (3 * bit + axis)).sum::<u64>())
        .sum()
}
