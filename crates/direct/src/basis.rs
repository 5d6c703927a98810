//! What is solved for: vectors along some strands' ways at some times, and the layers that they are.

use crate::guess::Guess;
use crate::solve::Drag;
use tousle_core::Vec3;
use tousle_edit::{Way, handles};
use tousle_field::{Ease, FieldLayer, Handle, LayerKey, LayerOrigin};

/// Layers that come and go one after another, each over two spans, so that together they are there all the time.
///
/// A layer rises over one span and falls over the next, by quintic steps that add up to 1: the extra vectors are a
/// curve in time with two continuous derivatives, nothing at the first key and after the last span.
#[derive(Clone, Debug)]
pub(crate) struct Times {
    pub(crate) first_secs: f64,
    /// The span between two layers' peaks, s.
    pub(crate) span_secs: f64,
    pub(crate) n_layers: usize,
}

/// The time between two peaks that is aimed at, s. If it falls, more is solved for and the wind may change faster.
const SPAN_SECS: f64 = 0.1;

/// The most and least spans between the first key and the last.
const SPANS: (f64, f64) = (3.0, 16.0);

/// For at least so long a strand is let go after its last key, s. If it falls, it is let go more suddenly.
const RELEASE_SECS: f64 = 0.3;

impl Times {
    /// Spans for keys after a first one, in order of time. `finer`: how often to halve them.
    pub(crate) fn new(first_secs: f64, keys_secs: &[f64], finer: i32) -> Self {
        let last_secs = keys_secs[keys_secs.len() - 1];
        let starts = std::iter::once(&first_secs).chain(keys_secs);
        let gaps = starts.zip(keys_secs).map(|(a, b)| b - a).filter(|gap| *gap > 1e-9);
        // Between any two keys there are at least two peaks.
        let least = gaps.fold(f64::INFINITY, f64::min);
        let all_secs = last_secs - first_secs;
        let wanted = all_secs / f64::min(SPAN_SECS, 0.5 * least);
        let n = wanted.clamp(SPANS.0, SPANS.1).ceil() * f64::from(1 << finer);
        let span_secs = all_secs / n;
        let release = (RELEASE_SECS / span_secs).ceil().clamp(2.0, 6.0);
        Self { first_secs, span_secs, n_layers: (n + release) as usize - 1 }
    }

    /// When the layer of a number is there, s.
    pub(crate) fn of_layer(&self, layer: usize) -> (f64, f64) {
        let first = self.first_secs + layer as f64 * self.span_secs;
        (first, first + 2.0 * self.span_secs)
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
    /// Its first vector, and how many it has: one for each dragged point of the strand.
    first: usize,
    centers_m: Vec<Vec3>,
    /// For each of its vectors, the share of it that each handle holds.
    shares: Vec<Vec<f64>>,
}

/// A strand that is dragged by some of its points, ascending.
pub(crate) struct Dragged<'a> {
    pub(crate) guess: Guess<'a>,
    pub(crate) points: Vec<usize>,
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
        Ok(Self { times, patches, n })
    }

    /// The layers of some vectors.
    pub(crate) fn layers(&self, drag: &Drag, keys: &[LayerKey], vectors: &[Vec3]) -> Vec<FieldLayer> {
        let layer = |(k, patch): (usize, &Patch)| {
            let (first_secs, last_secs) = self.times.of_layer(patch.time);
            let handle = |(h, center_m): (usize, &Vec3)| Handle {
                center_m: *center_m,
                reach_m: drag.reach_m,
                extra: patch.shares.iter().zip(&vectors[patch.first..]).map(|(s, v)| v * s[h]).sum(),
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

    /// Whether a vector was made for a strand.
    pub(crate) fn is_own(&self, strand: usize, vector: usize) -> bool {
        self.patches[self.layer_of(vector)].strand == strand
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
        Ok(Self { strand, time, first, centers_m, shares })
    }
}

/// How much of a dragged point's vector acts at a point: all at the dragged one, less and less towards the root and to
/// the next dragged ones on either side, all beyond the last.
fn hat(arcs_m: &[f64], dragged: &[usize], peak: usize, point: usize) -> f64 {
    let at = dragged.iter().position(|p| *p == peak).expect("one of the dragged points");
    let before = if at > 0 { dragged[at - 1] } else { 0 };
    let ramp = |from: usize, to: usize| {
        ((arcs_m[point] - arcs_m[from]) / (arcs_m[to] - arcs_m[from]).max(1e-9)).clamp(0.0, 1.0)
    };
    if point <= peak {
        ramp(before, peak)
    } else {
        dragged.get(at + 1).map_or(1.0, |next| 1.0 - ramp(peak, *next))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hats_add_up_to_one_beyond_the_first_dragged_point() {
        let arcs: Vec<f64> = (0..11).map(|k| 0.02 * f64::from(k)).collect();
        let dragged = [4, 7];
        for point in 0..11 {
            let sum: f64 = dragged.iter().map(|p| hat(&arcs, &dragged, *p, point)).sum();
            let expected = f64::min(point as f64 / 4.0, 1.0);
            assert!((sum - expected).abs() < 1e-12, "{point}: {sum}");
        }
    }

    /// Half a second: five spans up to the key, and layers that have gone 0.3 s after it.
    #[test]
    fn layers_are_there_from_the_first_key_until_a_while_after_the_last() {
        let times = Times::new(1.0, &[1.5], 0);
        assert!((times.span_secs - 0.1).abs() < 1e-12);
        assert!((times.last_secs() - 1.8).abs() < 1e-12, "{}", times.last_secs());
        let presence = |secs: f64| -> f64 {
            let ease = Ease { rise: 0.5, fall: 0.5 };
            let share = |k: usize| (secs - times.of_layer(k).0) / (2.0 * times.span_secs);
            (0..times.n_layers).map(share).filter(|x| (0.0..1.0).contains(x)).map(|x| ease.presence(x)).sum()
        };
        for secs in [1.1, 1.234, 1.5, 1.69] {
            assert!((presence(secs) - 1.0).abs() < 1e-12, "{secs}");
        }
    }
}
