//! What is made least, and how it changes with the vectors.

use super::Drag;
use super::ground::{Ground, Held1};
use super::peaks::Peaks;
use crate::basis::Basis;
use crate::target::Aim;
use crate::{DirectError, DirectOptions, Stage};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use tousle_core::{StrandMotion, Vec3};
use tousle_edit::{FoundKey, StrandPath};
use tousle_field::{FieldLayer, LayerKey};

/// The squares that are made least: how far the strands are from their keys, how they are shaken, how the vectors change.
#[derive(Clone)]
pub(super) struct Problem<'a> {
    pub(super) stage: &'a Stage<'a>,
    pub(super) ground: &'a Ground,
    pub(super) drag: &'a Drag,
    keys: &'a [LayerKey],
    pub(super) aims: Vec<Aim>,
    pub(super) basis: Basis,
    chains: Vec<Vec<usize>>,
    scales: Scales,
    /// The longest vector.
    pub(super) limit: f64,
    /// How often the unedited peaks may be reached.
    peak_ratio: f64,
    /// For how long the strands are watched after the last layer has gone, s.
    watched_secs: f64,
}

/// What a row is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum About {
    /// How far a point is from where it is aimed at, in tolerances.
    Key,
    /// A peak that is more than it may be, as a share of what it may be.
    Peak,
    /// How much a strand is shaken, and how the vectors change.
    Change,
}

/// What rows count.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weights {
    /// A tolerance's distance from a key.
    pub(super) keys: f64,
    /// A peak twice what it may be.
    pub(super) peaks: f64,
}

/// What counts as one.
#[derive(Clone, Copy, Debug)]
struct Scales {
    /// Distance from a key that is near enough, m.
    tolerance_m: f64,
    /// What the smoothest way takes: the acceleration counts as one of a steered point, more than without the drag and of
    /// the mean square over frames.
    smooth: Peaks,
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
    /// What is weighed, squared and added up.
    pub(super) rows: DVector<f64>,
    abouts: Vec<About>,
    /// The largest distance from an aim, in tolerances.
    pub(super) miss: f64,
}

impl Run {
    /// What each row counts.
    pub(super) fn weights(&self, weights: Weights) -> DVector<f64> {
        let weight = |about: &About| match about {
            About::Key => weights.keys,
            About::Peak => weights.peaks,
            About::Change => 1.0,
        };
        DVector::from_iterator(self.abouts.len(), self.abouts.iter().map(weight))
    }

    /// Whether the strands come near enough to where they are aimed at.
    pub(super) fn is_met(&self) -> bool {
        self.miss <= 1.0
    }

    /// Where a key's point is at the key, m.
    pub(super) fn place(&self, ground: &Ground, key: &FoundKey) -> Vec3 {
        StrandPath::new(&self.motions[ground.index(key)], 0).points_at(key.secs)[key.control_point]
    }
}

/// Where a target is out of reach, so many tolerances from the nearest place in reach will do: the last of it takes a wind
/// without end, or drags the lock over the body.
const NEAR_A_TARGET_OUT_OF_REACH: f64 = 10.0;

/// How many nudges make the longest vector. If it rises, the curve of what a vector does is felt less, and more what a
/// step of the simulation leaves unsettled.
const NUDGES: f64 = 200.0;

/// Peaks begin to count at this share of what they may be: what is pushed down here comes up elsewhere.
const CALM_FROM: f64 = 0.85;

/// Strands are watched for so long after their layers have gone, s; and where they met their keys too violently, so that
/// hair that was caught on the body and slips much later is seen too.
pub(super) const WATCHED_SECS: f64 = 0.25;
pub(super) const WATCHED_LONGER_SECS: f64 = 2.0;

impl<'a> Problem<'a> {
    pub(super) fn new(
        stage: &'a Stage<'a>,
        ground: &'a Ground,
        drag: &'a Drag,
        keys: &'a [LayerKey],
        aims: Vec<Aim>,
        basis: Basis,
        options: &DirectOptions,
    ) -> Self {
        let smooth = drag.keys.iter().map(|key| Peaks::smooth(key, drag.first_secs));
        let smooth = smooth.fold(Peaks::default(), Peaks::or);
        let scales = Scales {
            tolerance_m: options.tolerance_m,
            smooth,
            change: options.limit / 40.0,
            length: options.limit / 30.0,
            nudge: options.limit / NUDGES,
        };
        let chains = basis.chains();
        let (limit, peak_ratio) = (options.limit, options.peak_ratio);
        let watched_secs = WATCHED_SECS;
        Self { stage, ground, drag, keys, aims, basis, chains, scales, limit, peak_ratio, watched_secs }
    }

    /// The same, the strands being watched for so long.
    pub(super) fn watched_for(self, watched_secs: f64) -> Self {
        Self { watched_secs, ..self }
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

    /// Vectors moved by a step, none of them longer than it may be.
    pub(super) fn moved(&self, vectors: &[Vec3], step: &DVector<f64>) -> Vec<Vec3> {
        let moved = |(k, v): (usize, &Vec3)| {
            (v + Vec3::from_fn(|axis, _| step[3 * k + axis])).cap_magnitude(self.limit)
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
            let misses = (0..self.aims.len())
                .map(|key| self.miss(&motions[self.ground.index(&self.drag.keys[key])], key).norm());
            let miss = misses.fold(0.0, f64::max);
            let strands = motions.iter().enumerate().flat_map(|(s, motion)| self.rows_of_strand(s, motion));
            let (abouts, rows): (Vec<About>, Vec<f64>) = strands.chain(self.rows_of_vectors(vectors)).unzip();
            Run { rows: DVector::from_vec(rows), abouts, miss, motions }
        };
        Ok(tried.iter().enumerate().map(run).collect())
    }

    /// How much more violently the strands move under some vectors than without, to the end of their motion.
    pub(super) fn ratios(&self, vectors: &[Vec3]) -> Result<Peaks, DirectError> {
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
            let before = self.rows_of_strand(s, motion);
            for (k, moved) in self.move_nudged(s, motion, vectors, &felt, &sets)? {
                for (row, ((_, after), (_, before))) in
                    self.rows_of_strand(s, &moved).iter().zip(&before).enumerate()
                {
                    jacobian[(first + row, k)] = (after - before) / nudge;
                }
            }
            first += before.len();
        }
        let before = self.rows_of_vectors(vectors);
        for (k, vectors) in all.iter().enumerate() {
            for (row, ((_, after), (_, before))) in
                self.rows_of_vectors(vectors).iter().zip(&before).enumerate()
            {
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
        let held = &self.ground.strands[strand].held;
        Ok(self.stage.simulator.variants(held, self.ground.layers(), sets, self.until_secs())?)
    }

    /// What a strand does for some nudges of the vectors. Until the first layer that one of these nudges comes, it moves as
    /// without: as many as are stepped side by side go on from there.
    fn move_nudged(
        &self,
        strand: usize,
        motion: &StrandMotion,
        vectors: &[Vec3],
        nudges: &[usize],
        sets: &[Vec<FieldLayer>],
    ) -> Result<Vec<(usize, StrandMotion)>, DirectError> {
        let simulator = self.stage.simulator;
        let layers = [self.ground.layers(), &self.layers(vectors)].concat();
        let first_secs = |nudge: &usize| self.basis.first_secs(nudge / 3);
        let mut nudges = nudges.to_vec();
        nudges.sort_by(|a, b| first_secs(a).total_cmp(&first_secs(b)));
        let mut held = self.ground.strands[strand].held.clone();
        let first = held.frame();
        let mut together = Vec::new();
        for nudges in nudges.chunks(simulator.n_at_once()) {
            held = simulator.hold_on(&held, &layers, first_secs(&nudges[0]))?;
            together.push((held.clone(), nudges));
        }
        let until = self.until_secs();
        let moved = together.into_par_iter().map(|(held, nudges)| {
            let some: Vec<&[FieldLayer]> = nudges.iter().map(|k| sets[*k].as_slice()).collect();
            let later = simulator.variants(&held, self.ground.layers(), &some, until)?;
            let same = (held.frame() - first) * motion.n_points();
            let whole = |later: StrandMotion| StrandMotion {
                times_secs: motion.times_secs.clone(),
                positions_m: [&motion.positions_m[..same], &later.positions_m].concat(),
                counts: later.counts,
            };
            Ok(nudges.iter().copied().zip(later.into_iter().map(whole)).collect::<Vec<_>>())
        });
        Ok(moved.collect::<Result<Vec<_>, DirectError>>()?.concat())
    }

    /// Until when strands are watched, s.
    fn until_secs(&self) -> f64 {
        self.last_secs() + self.watched_secs
    }

    /// From an aim to where the point is, in tolerances.
    fn miss(&self, motion: &StrandMotion, key: usize) -> Vec3 {
        let (found, aim) = (&self.drag.keys[key], &self.aims[key]);
        let off_m = StrandPath::new(motion, 0).points_at(found.secs)[found.control_point] - aim.place_m;
        let near_enough = if aim.why.is_some() { NEAR_A_TARGET_OUT_OF_REACH } else { 1.0 };
        off_m / (near_enough * self.scales.tolerance_m)
    }

    /// What a strand adds to the rows: its distance from its keys, how much it is shaken, and where it is too violently.
    fn rows_of_strand(&self, strand: usize, motion: &StrandMotion) -> Vec<(About, f64)> {
        let of = &self.ground.strands[strand];
        let keys = (0..self.aims.len()).filter(|k| self.drag.keys[*k].strand_idx == of.strand_idx);
        let mut rows = Vec::new();
        for key in keys {
            rows.extend(self.miss(motion, key).iter().map(|off| (About::Key, *off)));
        }
        let (n_frames, first) = (motion.times_secs.len(), of.held.frame());
        if n_frames < 3 {
            return rows;
        }
        let dt_secs = motion.times_secs[1] - motion.times_secs[0];
        let place = |point: usize, frame: usize| {
            let at =
                if frame < first { &of.unedited.strand(frame, 0) } else { &motion.strand(frame - first, 0) };
            Vec3::from(at[point].map(f64::from))
        };
        let points = self.basis.points(strand);
        let per = 1.0
            / (dt_secs
                * dt_secs
                * self.scales.smooth.acceleration
                * ((n_frames * points.len()) as f64).sqrt());
        for point in points {
            let added = |frame: usize| {
                let without = of.unedited.strand(first + frame, 0)[*point].map(f64::from);
                place(*point, first + frame) - Vec3::from(without)
            };
            let added: Vec<Vec3> = (0..n_frames).map(added).collect();
            let bends = added.windows(3).map(|a| (a[0] - a[1] * 2.0 + a[2]) * per);
            rows.extend(bends.flat_map(changes));
        }
        // What a smooth way to the keys takes is never too much: a strand that hangs still may be moved.
        let most = of.peaks.times(self.peak_ratio * CALM_FROM).or(self.scales.smooth);
        let beyond = |vector: Vec3, most: f64| (About::Peak, (vector.norm() / most - 1.0).max(0.0));
        let (acceleration, jerk) = (most.acceleration * dt_secs.powi(2), most.jerk * dt_secs.powi(3));
        for point in 1..motion.counts[0] {
            let way: Vec<Vec3> =
                (first.saturating_sub(3)..first + n_frames).map(|frame| place(point, frame)).collect();
            rows.extend(way.windows(3).map(|x| beyond(x[0] - x[1] * 2.0 + x[2], acceleration)));
            rows.extend(way.windows(4).map(|x| beyond(x[3] - x[0] + (x[1] - x[2]) * 3.0, jerk)));
        }
        rows
    }

    /// What the vectors add to the rows: how long they are, and how they change in time.
    fn rows_of_vectors(&self, vectors: &[Vec3]) -> Vec<(About, f64)> {
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
                rows.extend(changes(bend * (mean / self.scales.change)));
                rows.extend(changes(at(k) * (mean / self.scales.length)));
            }
        }
        rows
    }
}

/// A vector's components as rows.
fn changes(vector: Vec3) -> [(About, f64); 3] {
    <[f64; 3]>::from(vector).map(|component| (About::Change, component))
}
