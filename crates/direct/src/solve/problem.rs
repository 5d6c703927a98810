//! What is made least, and how it changes with the vectors.

use super::Drag;
use super::ground::{Ground, Held1};
use crate::basis::Basis;
use crate::{DirectError, DirectOptions, Stage};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use tousle_core::{StrandMotion, Vec3};
use tousle_edit::{FoundKey, StrandPath};
use tousle_field::{FieldLayer, LayerKey};

/// The squares that are made least: how far the strands are from their keys, how they are shaken, how the vectors change.
#[derive(Clone)]
pub(super) struct Problem<'a> {
    stage: &'a Stage<'a>,
    ground: &'a Ground,
    drag: &'a Drag,
    keys: &'a [LayerKey],
    aims: Vec<Vec3>,
    basis: Basis,
    chains: Vec<Vec<usize>>,
    scales: Scales,
    limit: f64,
}

/// What counts as one.
#[derive(Clone, Copy, Debug)]
struct Scales {
    /// Distance from a key, m.
    miss_m: f64,
    /// Acceleration of a dragged point more than without the drag, m/s²; of the mean square over frames.
    shake: f64,
    /// Change of a vector from that of its neighbors in time.
    change: f64,
    /// Length of a vector.
    length: f64,
    /// How much a vector is changed to see what comes of it.
    nudge: f64,
}

/// What some vectors do.
#[derive(Clone, Debug)]
pub(super) struct Run {
    /// Of each strand, from where it is held.
    pub(super) motions: Vec<StrandMotion>,
    /// What is squared and added up.
    pub(super) rows: DVector<f64>,
    misses_m: Vec<Vec3>,
}

impl Run {
    pub(super) fn cost(&self) -> f64 {
        self.rows.norm_squared()
    }

    /// The largest distance from an aim, m.
    pub(super) fn miss_m(&self) -> f64 {
        self.misses_m.iter().map(Vec3::norm).fold(0.0, f64::max)
    }

    /// Where a key's point is at the key, m.
    pub(super) fn place(&self, ground: &Ground, key: &FoundKey) -> Vec3 {
        StrandPath::new(&self.motions[ground.index(key)], 0).points_at(key.secs)[key.control_point]
    }
}

/// A distance of one tolerance from a key counts as so much as the whole of what makes an answer smooth.
const KEYS_FIRST: f64 = 30.0;

/// Strands are watched for so long after their layers have gone, s.
const WATCHED_SECS: f64 = 0.25;

impl<'a> Problem<'a> {
    pub(super) fn new(
        stage: &'a Stage<'a>,
        ground: &'a Ground,
        drag: &'a Drag,
        keys: &'a [LayerKey],
        aims: Vec<Vec3>,
        basis: Basis,
        options: &DirectOptions,
    ) -> Self {
        // What a drag of this length in this time takes on the smoothest way.
        let takes = |key: &FoundKey| {
            let secs = key.secs - drag.first_secs;
            6.0 * (key.target_m - key.unedited_m).norm().max(1e-3) / (secs * secs)
        };
        let scales = Scales {
            miss_m: options.tolerance_m / KEYS_FIRST,
            shake: drag.keys.iter().map(takes).fold(0.0, f64::max),
            change: options.limit / 20.0,
            length: options.limit / 5.0,
            nudge: options.limit / 500.0,
        };
        let chains = basis.chains();
        Self { stage, ground, drag, keys, aims, basis, chains, scales, limit: options.limit }
    }

    /// The same with more weight on a smooth motion than usual, by so many times.
    pub(super) fn with_smoothness(mut self, times: f64) -> Self {
        self.scales.shake /= times.sqrt();
        self
    }

    /// How many vectors are solved for.
    pub(super) fn n(&self) -> usize {
        self.basis.n
    }

    /// When the last layer has gone, s.
    pub(super) fn last_secs(&self) -> f64 {
        self.basis.times.last_secs()
    }

    pub(super) fn layers(&self, vectors: &[Vec3]) -> Vec<FieldLayer> {
        let mut layers = self.basis.layers(self.drag, self.keys, vectors);
        layers.iter_mut().for_each(|layer| layer.muted = false);
        layers
    }

    /// Vectors moved by a share of a step, none of them longer than it may be.
    pub(super) fn moved(&self, vectors: &[Vec3], step: &DVector<f64>, share: f64) -> Vec<Vec3> {
        let moved = |(k, v): (usize, &Vec3)| {
            let to = v + Vec3::from_fn(|axis, _| step[3 * k + axis]) * share;
            to.cap_magnitude(self.limit)
        };
        vectors.iter().enumerate().map(moved).collect()
    }

    /// What each of some choices of vectors does, all side by side.
    pub(super) fn run(&self, tried: &[Vec<Vec3>]) -> Result<Vec<Run>, DirectError> {
        let sets: Vec<Vec<FieldLayer>> = tried.iter().map(|vectors| self.layers(vectors)).collect();
        let sets: Vec<&[FieldLayer]> = sets.iter().map(Vec::as_slice).collect();
        let by_strand: Vec<Vec<StrandMotion>> =
            (0..self.ground.strands.len()).map(|s| self.move_strand(s, &sets)).collect::<Result<_, _>>()?;
        let run = |(k, vectors): (usize, &Vec<Vec3>)| {
            let motions: Vec<StrandMotion> = by_strand.iter().map(|of| of[k].clone()).collect();
            let misses_m: Vec<Vec3> = (0..self.aims.len())
                .map(|key| self.miss(&motions[self.ground.index(&self.drag.keys[key])], key))
                .collect();
            let strands = motions.iter().enumerate().flat_map(|(s, motion)| self.rows_of_strand(s, motion));
            let rows: Vec<f64> = strands.chain(self.rows_of_vectors(vectors)).collect();
            Run { rows: DVector::from_vec(rows), misses_m, motions }
        };
        Ok(tried.iter().enumerate().map(run).collect())
    }

    /// How much more violently the strands move under some vectors than without, to the end of their motion.
    pub(super) fn ratios(&self, vectors: &[Vec3]) -> Result<[f64; 2], DirectError> {
        let layers = [self.ground.layers(), &self.layers(vectors)].concat();
        let to_the_end = |s: &Held1| self.stage.simulator.go_on(&s.held, &layers, f64::INFINITY);
        let motions = self.ground.strands.iter().map(to_the_end).collect::<Result<Vec<_>, _>>()?;
        Ok(self.ground.ratios(&motions))
    }

    /// How the rows change with each component of each vector.
    pub(super) fn jacobian(&self, vectors: &[Vec3], run: &Run) -> Result<DMatrix<f64>, DirectError> {
        let nudge = self.scales.nudge;
        let nudged = |k: usize| {
            let mut nudged = vectors.to_vec();
            nudged[k / 3][k % 3] += nudge;
            nudged
        };
        let all: Vec<Vec<Vec3>> = (0..3 * self.n()).map(nudged).collect();
        let sets: Vec<Vec<FieldLayer>> = all.par_iter().map(|vectors| self.layers(vectors)).collect();
        let mut jacobian = DMatrix::zeros(run.rows.len(), all.len());
        let mut first = 0;
        for (s, motion) in run.motions.iter().enumerate() {
            let felt: Vec<usize> =
                (0..all.len()).filter(|k| self.feels(motion, s, k / 3, &sets[*k])).collect();
            let some: Vec<&[FieldLayer]> = felt.iter().map(|k| sets[*k].as_slice()).collect();
            let before = self.rows_of_strand(s, motion);
            for (k, moved) in felt.iter().zip(self.move_strand(s, &some)?) {
                for (row, (after, before)) in self.rows_of_strand(s, &moved).iter().zip(&before).enumerate() {
                    jacobian[(first + row, *k)] = (after - before) / nudge;
                }
            }
            first += before.len();
        }
        let before = self.rows_of_vectors(vectors);
        for (k, vectors) in all.iter().enumerate() {
            for (row, (after, before)) in self.rows_of_vectors(vectors).iter().zip(&before).enumerate() {
                jacobian[(first + row, k)] = (after - before) / nudge;
            }
        }
        Ok(jacobian)
    }

    /// Whether a strand may feel a vector: its own, or one near which it comes.
    fn feels(&self, motion: &StrandMotion, strand: usize, vector: usize, layers: &[FieldLayer]) -> bool {
        if self.ground.strands.len() == 1 || self.basis.is_own(strand, vector) {
            return true;
        }
        let corners = layers[self.basis.layer_of(vector)].corners_m();
        let points = motion.positions_m.iter().map(|p| Vec3::from(p.map(f64::from)));
        corners.is_some_and(|(low, high)| points.into_iter().any(|p| low <= p && p <= high))
    }

    fn move_strand(&self, strand: usize, sets: &[&[FieldLayer]]) -> Result<Vec<StrandMotion>, DirectError> {
        let until = self.last_secs() + WATCHED_SECS;
        let held = &self.ground.strands[strand].held;
        Ok(self.stage.simulator.variants(held, self.ground.layers(), sets, until)?)
    }

    /// From an aim to where the point is, m.
    fn miss(&self, motion: &StrandMotion, key: usize) -> Vec3 {
        let found = &self.drag.keys[key];
        StrandPath::new(motion, 0).points_at(found.secs)[found.control_point] - self.aims[key]
    }

    /// What a strand adds to the rows: its distance from its keys, and how much it is shaken.
    fn rows_of_strand(&self, strand: usize, motion: &StrandMotion) -> Vec<f64> {
        let of = &self.ground.strands[strand];
        let keys = (0..self.aims.len()).filter(|k| self.drag.keys[*k].strand_idx == of.strand_idx);
        let mut rows = Vec::new();
        let mut points: Vec<usize> = Vec::new();
        for key in keys {
            rows.extend((self.miss(motion, key) / self.scales.miss_m).iter());
            points.push(self.drag.keys[key].control_point);
        }
        points.sort_unstable();
        points.dedup();
        let (n_frames, first) = (motion.times_secs.len(), of.held.frame());
        if n_frames < 3 {
            return rows;
        }
        let dt_secs = motion.times_secs[1] - motion.times_secs[0];
        let mean = 1.0 / ((n_frames * points.len()) as f64).sqrt();
        let per = mean / (dt_secs * dt_secs * self.scales.shake);
        for point in points {
            let added = |frame: usize| {
                let [with, without] =
                    [motion.strand(frame, 0)[point], of.unedited.strand(first + frame, 0)[point]];
                Vec3::from_fn(|axis, _| f64::from(with[axis]) - f64::from(without[axis]))
            };
            let added: Vec<Vec3> = (0..n_frames).map(added).collect();
            rows.extend(added.windows(3).flat_map(|a| <[f64; 3]>::from((a[0] - a[1] * 2.0 + a[2]) * per)));
        }
        rows
    }

    /// What the vectors add to the rows: how long they are, and how they change in time.
    fn rows_of_vectors(&self, vectors: &[Vec3]) -> Vec<f64> {
        let mean = 1.0 / (self.n() as f64).sqrt();
        let mut rows = Vec::new();
        for chain in &self.chains {
            // Before the first and after the last there is nothing.
            let at = |k: usize| {
                let inside = k.checked_sub(1).and_then(|k| chain.get(k));
                inside.map_or_else(Vec3::zeros, |v| vectors[*v])
            };
            for k in 1..=chain.len() {
                let bend = at(k - 1) - at(k) * 2.0 + at(k + 1);
                rows.extend((bend * (mean / self.scales.change)).iter());
                rows.extend((at(k) * (mean / self.scales.length)).iter());
            }
        }
        rows
    }
}
