//! Where strands ask the field.

use crate::frames::single;
use tousle_core::Vec3;
use tousle_lanes::{Lane, Vector};

/// A box for each strand of a batch, around all points at which it asked the field in some steps, head space, m.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent<L> {
    low: Vector<L>,
    high: Vector<L>,
}

/// The box of one strand, by its lower and its upper corner, head space, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Region {
    low_m: [f32; 3],
    high_m: [f32; 3],
}

impl<L: Lane> Extent<L> {
    /// Around nothing yet.
    pub fn nothing() -> Self {
        let far = Vector::splat(Vec3::repeat(f64::INFINITY));
        Self { low: far, high: -far }
    }

    /// Goes around the middles of sticks too. `ends`: their far ends, from the root.
    #[inline(always)]
    pub fn take_in(&mut self, root: Vector<L>, ends: impl Iterator<Item = Vector<L>>) {
        let half = root.x.same(0.5);
        let mut before = root;
        for end in ends {
            let middle = (before + end) * half;
            self.low = self.low.min(middle);
            self.high = self.high.max(middle);
            before = end;
        }
    }

    /// The box of one strand.
    pub fn of(&self, lane: usize) -> Region {
        Region { low_m: single(self.low.get(lane)), high_m: single(self.high.get(lane)) }
    }
}

impl Region {
    /// Whether any of its points may be within `reach_m` of a place.
    pub fn is_near(&self, place_m: Vec3, reach_m: f64) -> bool {
        let (low, high) = (self.low_m.map(f64::from), self.high_m.map(f64::from));
        let beyond = |axis: usize| f64::max(low[axis] - place_m[axis], place_m[axis] - high[axis]).max(0.0);
        let beyond2 = (0..3).map(|axis| beyond(axis) * beyond(axis)).sum::<f64>();
        beyond2 <= reach_m * reach_m
    }

    /// Whether it may have a point in common with a box.
    pub fn meets(&self, (low_m, high_m): (Vec3, Vec3)) -> bool {
        (0..3).all(|axis| {
            f64::from(self.low_m[axis]) <= high_m[axis] && low_m[axis] <= f64::from(self.high_m[axis])
        })
    }
}
