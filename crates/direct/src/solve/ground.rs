//! The strands of a drag as they are without it.

use super::Drag;
use super::peaks::{Peaks, least_peaks};
use crate::basis::{Dragged, Times, steered};
use crate::guess::Guess;
use crate::target::Aim;
use crate::{DirectError, Stage};
use tousle_core::{StrandMotion, Vec3};
use tousle_edit::{FoundKey, StrandPath};
use tousle_field::FieldLayer;
use tousle_sim::Held;

/// What does not change while a hand moves a key: the strands without the drag, and held at its first key.
#[derive(Clone, Debug)]
pub struct Ground {
    layers: Vec<FieldLayer>,
    first_secs: f64,
    pub(super) strands: Vec<Held1>,
}

/// One strand.
#[derive(Clone, Debug)]
pub(super) struct Held1 {
    pub(super) strand_idx: usize,
    pub(super) held: Held,
    /// From the start to the end.
    pub(super) unedited: StrandMotion,
    /// Its own peaks.
    pub(super) peaks: Peaks,
}

impl Ground {
    pub(super) fn new(stage: &Stage<'_>, layers: &[FieldLayer], drag: &Drag) -> Result<Self, DirectError> {
        let strand = |strand_idx: usize| {
            let unedited = stage.simulator.simulate_some(layers, &[strand_idx])?;
            let held = stage.simulator.hold(layers, &[strand_idx], drag.first_secs)?;
            Ok::<_, DirectError>(Held1 { strand_idx, held, peaks: Peaks::of(&unedited), unedited })
        };
        let strands = strand_idxs(drag).into_iter().map(strand).collect::<Result<_, _>>()?;
        Ok(Self { layers: layers.to_vec(), first_secs: drag.first_secs, strands })
    }

    /// Whether this is the ground of a drag under some layers.
    pub(super) fn is_of(&self, layers: &[FieldLayer], drag: &Drag) -> bool {
        self.strands.iter().map(|s| s.strand_idx).eq(strand_idxs(drag))
            && self.first_secs == drag.first_secs
            && self.layers == layers
    }

    /// One of the strands alone.
    pub(super) fn only(&self, strand: usize) -> Self {
        Self { strands: vec![self.strands[strand].clone()], layers: self.layers.clone(), ..*self }
    }

    /// The layers that are there without the drag.
    pub(super) fn layers(&self) -> &[FieldLayer] {
        &self.layers
    }

    /// Which of the strands a key is about.
    pub(super) fn index(&self, key: &FoundKey) -> usize {
        let is_its = |s: &Held1| s.strand_idx == key.strand_idx;
        self.strands.iter().position(is_its).expect("the strand of a key is held")
    }

    /// The points of a key's strand at the key, without the drag, m.
    pub(super) fn points_at(&self, key: &FoundKey) -> Vec<Vec3> {
        StrandPath::new(&self.strands[self.index(key)].unedited, 0).points_at(key.secs)
    }

    /// The strands with the ways along which they are dragged: known ones, or guessed. `is_finer`: to be steered by more
    /// points.
    pub(super) fn dragged<'a>(
        &'a self,
        times: &Times,
        drag: &Drag,
        aims: &[Aim],
        ways: Option<&'a [StrandMotion]>,
        is_finer: bool,
    ) -> Vec<Dragged<'a>> {
        let span = (self.first_secs, times.last_secs());
        let aimed: Vec<FoundKey> = drag
            .keys
            .iter()
            .zip(aims)
            .map(|(key, aim)| FoundKey { target_m: aim.place_m, ..key.clone() })
            .collect();
        let dragged = |(k, strand): (usize, &'a Held1)| {
            let keys: Vec<&FoundKey> =
                aimed.iter().filter(|key| key.strand_idx == strand.strand_idx).collect();
            let mut dragged: Vec<usize> = keys.iter().map(|key| key.control_point).collect();
            dragged.sort_unstable();
            dragged.dedup();
            let guess = match ways {
                Some(ways) => Guess::known(&ways[k], span),
                None => Guess::new(&strand.unedited, &keys, span),
            };
            let mut arcs_m = vec![0.0];
            for pair in StrandPath::new(&strand.unedited, 0).points_at(self.first_secs).windows(2) {
                arcs_m.push(arcs_m[arcs_m.len() - 1] + (pair[1] - pair[0]).norm());
            }
            Dragged { guess, points: steered(&arcs_m, &dragged, is_finer), first_key: dragged[0], arcs_m }
        };
        self.strands.iter().enumerate().map(dragged).collect()
    }

    /// How much more violently strands move than without the drag: the largest ratio of their peaks of acceleration,
    /// and of jerk.
    pub(super) fn ratios(&self, motions: &[StrandMotion]) -> Peaks {
        let ratios =
            self.strands.iter().zip(motions).map(|(s, motion)| Peaks::of(&s.with(motion)).over(s.peaks));
        ratios.fold(Peaks::default(), Peaks::or)
    }

    /// What the keys demand at the least, over the strands' own peaks: see [`least_peaks`]. `tolerance_m`: how far from a
    /// key is near enough.
    pub(super) fn demanded(&self, keys: &[FoundKey], tolerance_m: f64) -> Peaks {
        let demanded = keys.iter().map(|key| {
            let strand = &self.strands[self.index(key)];
            least_peaks(&strand.unedited, strand.held.frame(), key, tolerance_m).over(strand.peaks)
        });
        demanded.fold(Peaks::default(), Peaks::or)
    }
}

impl Held1 {
    /// The whole motion of the strand, replaced from where it is held to its end.
    fn with(&self, later: &StrandMotion) -> StrandMotion {
        let n = self.unedited.counts[0];
        let mut whole = self.unedited.clone();
        let first = self.held.frame() * n;
        whole.positions_m[first..first + later.positions_m.len()].copy_from_slice(&later.positions_m);
        whole
    }
}

fn strand_idxs(drag: &Drag) -> Vec<usize> {
    let mut found: Vec<usize> = drag.keys.iter().map(|key| key.strand_idx).collect();
    found.sort_unstable();
    found.dedup();
    found
}
