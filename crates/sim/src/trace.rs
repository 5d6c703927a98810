//! What a run leaves behind so that the next one need not run every strand again.

use crate::extent::Region;
use core::iter::zip;
use std::sync::Arc;
use tousle_core::{StrandMotion, Vec3};
use tousle_field::FieldLayer;

/// The motion of all strands of a [`Simulator`](crate::Simulator) under some layers, and where each of them asked the field.
///
/// A strand that never asked where a layer is that has come, gone or changed moves under the new layers as it did, to the
/// bit: [`Simulator::retrace`](crate::Simulator::retrace) runs the others alone.
#[derive(Clone, Debug)]
pub struct Traced {
    pub(crate) layers: Vec<FieldLayer>,
    pub(crate) motion: Arc<StrandMotion>,
    /// `None` if a layer can change strands that never come near it.
    pub(crate) whereabouts: Option<Whereabouts>,
}

/// Where some strands asked the field, block of steps by block of steps.
#[derive(Clone, Debug)]
pub(crate) struct Whereabouts {
    /// The times whose wind blows in each block, on the field's clock, s.
    spans_secs: Vec<(f64, f64)>,
    /// Strand after strand, and of each block after block.
    regions: Vec<Region>,
}

impl Traced {
    /// The layers that it was run under.
    pub fn layers(&self) -> &[FieldLayer] {
        &self.layers
    }

    /// The motion.
    pub fn motion(&self) -> &Arc<StrandMotion> {
        &self.motion
    }

    /// The strands that would have to be run again under other layers, ascending.
    pub fn felt_by(&self, layers: &[FieldLayer]) -> Vec<usize> {
        let changed: Vec<Place<'_>> =
            changes(&self.layers, layers).into_iter().filter_map(Place::of).collect();
        let all = 0..self.motion.counts.len();
        match &self.whereabouts {
            _ if changed.is_empty() => Vec::new(),
            None => all.collect(),
            Some(whereabouts) => all.filter(|strand| whereabouts.meet(*strand, &changed)).collect(),
        }
    }
}

impl Whereabouts {
    /// `regions`: strand after strand, and of each one a block.
    pub fn new(spans_secs: Vec<(f64, f64)>, regions: Vec<Region>) -> Self {
        Self { spans_secs, regions }
    }

    /// Puts those of some strands, by their ascending indices, in the place of what was there.
    pub fn put(&mut self, strands: &[usize], others: &Self) {
        let n_blocks = self.spans_secs.len().max(1);
        for (strand, regions) in zip(strands, others.regions.chunks_exact(n_blocks)) {
            self.regions[strand * n_blocks..(strand + 1) * n_blocks].copy_from_slice(regions);
        }
    }

    fn meet(&self, strand: usize, layers: &[Place<'_>]) -> bool {
        let n_blocks = self.spans_secs.len();
        let regions = &self.regions[strand * n_blocks..(strand + 1) * n_blocks];
        layers.iter().any(|layer| {
            zip(&self.spans_secs, regions)
                .any(|(span, region)| layer.is_there(*span) && layer.is_near(region))
        })
    }
}

/// Where a layer acts.
struct Place<'a> {
    layer: &'a FieldLayer,
    corners_m: (Vec3, Vec3),
}

/// What single precision may take away from the distance between a point and a handle, m, and from that between times, s.
const SLACK_M: f64 = 1e-4;
const SLACK_SECS: f64 = 1e-6;

impl<'a> Place<'a> {
    fn of(layer: &'a FieldLayer) -> Option<Self> {
        let (low, high) = layer.corners_m()?;
        let slack_m = Vec3::repeat(SLACK_M);
        Some(Self { layer, corners_m: (low - slack_m, high + slack_m) })
    }

    fn is_there(&self, (from_secs, to_secs): (f64, f64)) -> bool {
        self.layer.first_secs < to_secs + SLACK_SECS && from_secs < self.layer.last_secs + SLACK_SECS
    }

    fn is_near(&self, region: &Region) -> bool {
        let is_near_handle =
            |handle: &tousle_field::Handle| region.is_near(handle.center_m, handle.reach_m + SLACK_M);
        region.meets(self.corners_m) && self.layer.handles.iter().any(is_near_handle)
    }
}

/// The layers of two stacks that are not in both, in an order that both have: all others make the same of a vector that these
/// leave as it is.
fn changes<'a>(before: &'a [FieldLayer], after: &'a [FieldLayer]) -> Vec<&'a FieldLayer> {
    let doing = |stack: &'a [FieldLayer]| stack.iter().filter(|layer| !layer.does_nothing());
    let mut left: Vec<&FieldLayer> = doing(before).collect();
    let mut changed = Vec::new();
    for layer in doing(after) {
        match left.iter().position(|other| other.does_as(layer)) {
            // Those that were before it are gone, or behind it now.
            Some(at) => changed.extend(left.drain(..=at).take(at)),
            None => changed.push(layer),
        }
    }
    changed.extend(left);
    changed
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_bench::worlds::push;
    use tousle_field::{Handle, Reshape};

    fn layer(extra: f64) -> FieldLayer {
        let handle = Handle { center_m: Vec3::zeros(), reach_m: 0.1, extra: Vec3::x() * extra };
        push(handle, (0.0, 1.0))
    }

    /// The vectors of what changes from one stack to another, before and after; each layer stands for its own.
    fn changed(before: &[f64], after: &[f64]) -> Vec<f64> {
        let stack = |extras: &[f64]| extras.iter().map(|extra| layer(*extra)).collect::<Vec<_>>();
        let (before, after) = (stack(before), stack(after));
        changes(&before, &after).iter().map(|layer| layer.handles[0].extra.x).collect()
    }

    #[test]
    fn what_both_stacks_have_in_one_order_is_no_change() {
        assert_eq!(changed(&[1.0, 2.0], &[1.0, 2.0]), [0.0; 0]);
        assert_eq!(changed(&[1.0, 2.0], &[1.0, 3.0, 2.0]), [3.0]);
        assert_eq!(changed(&[1.0, 3.0, 2.0], &[1.0, 2.0]), [3.0]);
        // Where order counts, one of the two has moved.
        assert_eq!(changed(&[1.0, 2.0], &[2.0, 1.0]), [1.0, 1.0]);
        assert_eq!(changed(&[], &[0.0]), [0.0; 0]);
    }

    #[test]
    fn a_name_is_no_change_and_silence_is() {
        let [named, muted, reshaped] = [(); 3].map(|()| layer(1.0));
        let named = FieldLayer { id: "2".into(), name: "gust".into(), ..named };
        let muted = FieldLayer { muted: true, ..muted };
        let calm = Reshape { turn: Vec3::zeros(), scale: 0.0 };
        let reshaped = FieldLayer { reshape: Some(calm), ..reshaped };
        assert!(changes(&[layer(1.0)], &[named]).is_empty());
        assert_eq!(changes(&[layer(1.0)], &[muted]), [&layer(1.0)]);
        assert_eq!(changes(&[layer(1.0)], &[reshaped]).len(), 2);
    }
}
