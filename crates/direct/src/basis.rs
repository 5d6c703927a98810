//! What is solved for: vectors along some strands' ways at some times, and the layers that they are.

use crate::guess::Guess;
use crate::solve::Drag;
use tousle_core::Vec3;
use tousle_edit::{Way, handles};
use tousle_field::{Ease, FieldLayer, Handle, LayerKey, LayerOrigin};

/// Layers that come and go one after another, a span apart, each over four, so that two of them are there in all.
///
/// A layer rises over two spans and falls over the next two, by quintic steps that add up to 1: every other layer gives a
/// curve in time with two continuous derivatives, nothing at the first key and after the last span. Such a curve stands
/// still at each of its vectors and hurries between; the mean of the two, a span apart, goes on evenly.
#[derive(Clone, Debug)]
pub(crate) struct Times {
    pub(crate) first_secs: f64,
    /// The span between two layers' beginnings, s.
    pub(crate) span_secs: f64,
    pub(crate) n_layers: usize,
}

/// The time between two beginnings that is aimed at, s. If it falls, more is solved for and the wind may change faster.
const SPAN_SECS: f64 = 0.1;

/// The least and most spans between the first key and the last.
const SPANS: (f64, f64) = (4.0, 16.0);

/// How many spans a layer is there.
const SPANS_OF_LAYER: usize = 4;

/// How many layers are there in all at any time.
const LAYERS_AT_ONCE: f64 = 2.0;

/// For so long a strand is let go after its last key, s. If it falls, it is let go more suddenly.
const RELEASE_SECS: f64 = 0.5;

/// The least and most spans of that.
const RELEASE_SPANS: (f64, f64) = (4.0, 8.0);

impl Times {
    /// Spans for keys after a first one, in order of time.
    pub(crate) fn new(first_secs: f64, keys_secs: &[f64]) -> Self {
        let last_secs = keys_secs[keys_secs.len() - 1];
        let starts = std::iter::once(&first_secs).chain(keys_secs);
        let gaps = starts.zip(keys_secs).map(|(a, b)| b - a).filter(|gap| *gap > 1e-9);
        // Between any two keys at least two layers begin.
        let least = gaps.fold(f64::INFINITY, f64::min);
        let all_secs = last_secs - first_secs;
        let wanted = all_secs / f64::min(SPAN_SECS, 0.5 * least);
        let n = wanted.clamp(SPANS.0, SPANS.1).ceil();
        let span_secs = all_secs / n;
        let release = (RELEASE_SECS / span_secs).ceil().clamp(RELEASE_SPANS.0, RELEASE_SPANS.1);
        Self { first_secs, span_secs, n_layers: (n + release) as usize + 1 - SPANS_OF_LAYER }
    }

    /// When the layer of a number is there, s.
    pub(crate) fn of_layer(&self, layer: usize) -> (f64, f64) {
        let first = self.first_secs + layer as f64 * self.span_secs;
        (first, first + SPANS_OF_LAYER as f64 * self.span_secs)
    }

    /// When the last layer has gone, s.
    pub(crate) fn last_secs(&self) -> f64 {
        self.of_layer(self.n_layers - 1).1
    }
}

/// The layers, but for how strong each is.
#[derive(Clone, Debug)]
pub(crate) struct Basis {
    pub(crate) times: Times,
    /// Strand after strand, in order of time.
    patches: Vec<Patch>,
    /// The steered points of each strand.
    points: Vec<Vec<usize>>,
    /// How many vectors are solved for.
    pub(crate) n: usize,
}

/// One layer.
#[derive(Clone, Debug)]
struct Patch {
    /// Which of the strands it is for.
    strand: usize,
    /// Which of the times.
    time: usize,
    /// Its first vector; it has one for each steered point of the strand.
    first: usize,
    centers_m: Vec<Vec3>,
    /// How far from the root each of its vectors acts, as a share of the way to the first dragged point and at most 1.
    outward: Vec<f64>,
    /// For each of its vectors, the share of it that each handle holds.
    shares: Vec<Vec<f64>>,
}

/// A strand that is dragged.
pub(crate) struct Dragged<'a> {
    pub(crate) guess: Guess<'a>,
    /// The points that have vectors of their own, ascending ([`steered`]).
    pub(crate) points: Vec<usize>,
    /// The first dragged point.
    pub(crate) first_key: usize,
    /// Distance of each control point from the root along the strand, m.
    pub(crate) arcs_m: Vec<f64>,
}

/// How many vectors a handle has room for.
const AXES: usize = 3;

impl Basis {
    /// Layers along the ways of some strands.
    pub(crate) fn new(times: Times, strands: &[Dragged<'_>], reach_m: f64) -> Result<Self, String> {
        let mut patches = Vec::new();
        let mut n = 0;
        for (strand, dragged) in strands.iter().enumerate() {
            for time in 0..times.n_layers {
                let patch = Patch::new((strand, time, n), dragged, times.of_layer(time), reach_m)?;
                n += patch.shares.len();
                patches.push(patch);
            }
        }
        let points = strands.iter().map(|dragged| dragged.points.clone()).collect();
        Ok(Self { times, patches, points, n })
    }

    /// The layers of some strands, each strand's made alone for the same times.
    ///
    /// # Panics
    /// If there is none.
    pub(crate) fn joined(alone: impl IntoIterator<Item = Self>) -> Self {
        let joined = alone.into_iter().reduce(|mut joined, next| {
            let moved = |patch: Patch| Patch {
                strand: patch.strand + joined.points.len(),
                first: patch.first + joined.n,
                ..patch
            };
            joined.patches.extend(next.patches.into_iter().map(moved));
            joined.points.extend(next.points);
            joined.n += next.n;
            joined
        });
        joined.expect("a strand")
    }

    /// The layers of some vectors.
    pub(crate) fn layers(&self, drag: &Drag, keys: &[LayerKey], vectors: &[Vec3]) -> Vec<FieldLayer> {
        let layer = |(k, patch): (usize, &Patch)| {
            let (first_secs, last_secs) = self.times.of_layer(patch.time);
            let handle = |(h, center_m): (usize, &Vec3)| Handle {
                center_m: *center_m,
                reach_m: drag.reach_m,
                extra: patch.shares.iter().zip(&vectors[patch.first..]).map(|(s, v)| v * s[h]).sum::<Vec3>()
                    / LAYERS_AT_ONCE,
            };
            FieldLayer {
                id: format!("{}/{}", drag.edit_id, k + 1),
                name: drag.name.clone(),
                muted: drag.muted,
                first_secs,
                last_secs,
                ease: Ease { rise: 0.5, fall: 0.5 },
                handles: patch.centers_m.iter().enumerate().map(handle).collect(),
                reshape: None,
                origin: LayerOrigin::Keys {
                    edit: drag.edit_id.clone(),
                    first_secs: drag.first_secs,
                    keys: keys.to_vec(),
                    method: "physical".to_owned(),
                },
            }
        };
        self.patches.iter().enumerate().map(layer).collect()
    }

    /// The chains of vectors that follow one another in time, which should change smoothly.
    pub(crate) fn chains(&self) -> Vec<Vec<usize>> {
        let mut chains: Vec<Vec<usize>> = Vec::new();
        for patch in &self.patches {
            for k in 0..patch.shares.len() {
                let at = self.patches.iter().filter(|p| p.strand < patch.strand && p.time == 0);
                let chain = at.map(|p| p.shares.len()).sum::<usize>() + k;
                if chain == chains.len() {
                    chains.push(Vec::new());
                }
                chains[chain].push(patch.first + k);
            }
        }
        chains
    }

    /// The vectors of a strand: their numbers, when each acts most, s, and how far from the root it acts, as a share of
    /// the way to the first dragged point and at most 1.
    pub(crate) fn of_strand(&self, strand: usize) -> impl Iterator<Item = (usize, f64, f64)> + '_ {
        let own = self.patches.iter().filter(move |patch| patch.strand == strand);
        own.flat_map(|patch| {
            let (first_secs, last_secs) = self.times.of_layer(patch.time);
            let peak_secs = 0.5 * (first_secs + last_secs);
            patch.outward.iter().enumerate().map(move |(k, share)| (patch.first + k, peak_secs, *share))
        })
    }

    /// The steered points of a strand.
    pub(crate) fn points(&self, strand: usize) -> &[usize] {
        &self.points[strand]
    }

    /// Whether a vector was made for a strand.
    pub(crate) fn is_own(&self, strand: usize, vector: usize) -> bool {
        self.patches[self.layer_of(vector)].strand == strand
    }

    /// When the layer that a vector is in begins, s.
    pub(crate) fn first_secs(&self, vector: usize) -> f64 {
        self.times.of_layer(self.patches[self.layer_of(vector)].time).0
    }

    /// Which of the layers a vector is in.
    pub(crate) fn layer_of(&self, vector: usize) -> usize {
        self.patches.partition_point(|patch| patch.first <= vector) - 1
    }
}

impl Patch {
    fn new(
        (strand, time, first): (usize, usize, usize),
        dragged: &Dragged<'_>,
        (first_secs, last_secs): (f64, f64),
        reach_m: f64,
    ) -> Result<Self, String> {
        // Frames of a usual rate: a point moves less than a reach from one to the next.
        let n_instants = ((last_secs - first_secs) * 60.0).ceil().max(2.0) as usize;
        let instants = (0..=n_instants).map(|k| {
            let share = k as f64 / n_instants as f64;
            dragged.guess.points_at(first_secs + (last_secs - first_secs) * share)
        });
        let instants: Vec<Vec<Vec3>> = instants.collect();
        let outermost = *dragged.points.last().expect("a strand is dragged by a point");
        let mut centers_m = Vec::new();
        let mut shares = Vec::new();
        for points in dragged.points.chunks(AXES) {
            let way = |point: usize| Way {
                places_m: instants.iter().map(|places| places[point]).collect(),
                extra: Vec3::from_fn(|axis, _| {
                    points.get(axis).map_or(0.0, |p| hat(&dragged.arcs_m, &dragged.points, *p, point))
                }),
            };
            let ways: Vec<Way> = (0..dragged.arcs_m.len()).map(way).collect();
            let found = handles(&ways, outermost, reach_m)?;
            centers_m = found.iter().map(|h| h.center_m).collect();
            shares.extend((0..points.len()).map(|axis| found.iter().map(|h| h.extra[axis]).collect()));
        }
        let whole_m = dragged.arcs_m[dragged.first_key];
        let outward = dragged.points.iter().map(|p| (dragged.arcs_m[*p] / whole_m).min(1.0)).collect();
        Ok(Self { strand, time, first, centers_m, outward, shares })
    }
}

/// How much of the strand must lie beyond the last dragged point for the tip to be steered too, as a share of the way to
/// that point.
const LOOSE_END: f64 = 0.15;

/// The points of a strand that have vectors of their own: those that are dragged, ascending; one halfway from the root or
/// from the last of them to each, without which a strand is not bent but flung where its ends must come nearer; and the
/// tip, if much lies beyond the last of them. `is_finer`: two on each way, and one on that to the tip.
pub(crate) fn steered(arcs_m: &[f64], dragged: &[usize], is_finer: bool) -> Vec<usize> {
    let pieces = if is_finer { 3 } else { 2 };
    let between = |from: usize, to: usize, share: f64| {
        let arc_m = arcs_m[from] + (arcs_m[to] - arcs_m[from]) * share;
        arcs_m.partition_point(|arc| *arc < arc_m - 1e-9)
    };
    let (mut points, mut from) = (Vec::new(), 0);
    for to in dragged {
        points.extend((1..pieces).map(|k| between(from, *to, f64::from(k) / f64::from(pieces))));
        points.push(*to);
        from = *to;
    }
    let tip = arcs_m.len() - 1;
    if arcs_m[tip] - arcs_m[from] > LOOSE_END * arcs_m[from] {
        points.extend(is_finer.then(|| between(from, tip, 0.5)));
        points.push(tip);
    }
    points.retain(|point| *point > 0);
    points.dedup();
    points
}

/// How much of a steered point's vector acts at a point: all at the steered one, less and less towards the root and to
/// the next steered ones on either side, all beyond the last.
fn hat(arcs_m: &[f64], steered: &[usize], peak: usize, point: usize) -> f64 {
    let at = steered.iter().position(|p| *p == peak).expect("one of the steered points");
    let before = if at > 0 { steered[at - 1] } else { 0 };
    let ramp = |from: usize, to: usize| {
        ((arcs_m[point] - arcs_m[from]) / (arcs_m[to] - arcs_m[from]).max(1e-9)).clamp(0.0, 1.0)
    };
    if point <= peak {
        ramp(before, peak)
    } else {
        steered.get(at + 1).map_or(1.0, |next| 1.0 - ramp(peak, *next))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hats_add_up_to_one_beyond_the_first_steered_point() {
        let arcs: Vec<f64> = (0..11).map(|k| 0.02 * f64::from(k)).collect();
        let dragged = [4, 7];
        for point in 0..11 {
            let sum: f64 = dragged.iter().map(|p| hat(&arcs, &dragged, *p, point)).sum();
            let expected = f64::min(point as f64 / 4.0, 1.0);
            assert!((sum - expected).abs() < 1e-12, "{point}: {sum}");
        }
    }

    #[test]
    fn a_strand_is_steered_halfway_and_at_a_loose_end() {
        let arcs: Vec<f64> = (0..11).map(|k| 0.02 * f64::from(k)).collect();
        assert_eq!(steered(&arcs, &[10], false), [5, 10]);
        assert_eq!(steered(&arcs, &[4, 8], false), [2, 4, 6, 8, 10]);
        assert_eq!(steered(&arcs, &[1], false), [1, 10]);
        assert_eq!(steered(&arcs, &[6], true), [2, 4, 6, 8, 10]);
    }

    /// Half a second: five spans up to the key, and layers that have gone half a second after it.
    #[test]
    fn layers_are_there_from_the_first_key_until_a_while_after_the_last() {
        let times = Times::new(1.0, &[1.5]);
        assert!((times.span_secs - 0.1).abs() < 1e-12);
        assert!((times.last_secs() - 2.0).abs() < 1e-12, "{}", times.last_secs());
        let presence = |secs: f64| -> f64 {
            let ease = Ease { rise: 0.5, fall: 0.5 };
            let share = |k: usize| (secs - times.of_layer(k).0) / (4.0 * times.span_secs);
            (0..times.n_layers).map(share).filter(|x| (0.0..1.0).contains(x)).map(|x| ease.presence(x)).sum()
        };
        for secs in [1.3, 1.434, 1.5, 1.69] {
            assert!((presence(secs) - LAYERS_AT_ONCE).abs() < 1e-12, "{secs}");
        }
    }
}
