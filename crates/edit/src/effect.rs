//! What edits did to a motion.

use crate::EditError;
use crate::path::{StrandPath, check_motion, single};
use core::ops::Range;
use serde::Serialize;
use tousle_core::{Groom, StrandMotion, Vec3};
use tousle_field::{FieldLayer, LayerKey};

/// The motion of a groom under a stack of layers.
#[derive(Clone, Copy, Debug)]
pub struct Under<'a> {
    /// The motion.
    pub motion: &'a StrandMotion,
    /// The layers.
    pub layers: &'a [FieldLayer],
}

/// What a change of the stack did to the motion of a groom.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EditEffects {
    /// One entry an edit that is new or another now, in stack order.
    pub edits: Vec<EditEffect>,
    /// The first frame in which any point differs, s; `None` if the two motions are the same to the bit.
    pub first_change_secs: Option<f64>,
    /// The strand that moved most although it never came within the reach of any handle that is new, gone or another.
    pub most_moved_outside: Option<Moved>,
    /// The same among the strands that stayed [`FAR_M`] or more outside every reach.
    pub most_moved_far: Option<Moved>,
}

/// What the layers of one edit did to the strands it was made on, as far as this groom has them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EditEffect {
    /// The edit's id.
    pub edit_id: String,
    /// Its name.
    pub name: String,
    /// How near it brought what it drags.
    pub keys: Vec<KeyEffect>,
    /// What it did to the strands it drags, each once.
    pub strands: Vec<StrandEffect>,
}

/// How near an edit brought a control point to where it should be.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KeyEffect {
    /// What should be where, and when.
    #[serde(flatten)]
    pub key: LayerKey,
    /// The distance from there, mm.
    pub residual_mm: Change,
}

/// What an edit did to a strand that it drags: the largest of all its points and frames, in head space.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StrandEffect {
    /// The strand's name.
    pub strand: String,
    /// Acceleration, m/s².
    pub peak_acceleration: Change,
    /// Jerk, m/s³.
    pub peak_jerk: Change,
    /// Energy of the whole strand's motion, J.
    pub peak_energy: Change,
}

/// A figure before the edits and after.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Change {
    /// In the motion without the edits.
    pub before: f64,
    /// In the motion with them.
    pub after: f64,
}

/// How far a strand was moved.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Moved {
    /// The strand's name.
    pub strand: String,
    /// The largest distance between the two motions of any of its points, mm.
    pub mm: f64,
    /// When, s.
    pub secs: f64,
}

/// How far an edit's points are from where they should be.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Residual {
    /// The edit's id.
    pub edit_id: String,
    /// The largest distance at any of its keys, mm; `None` if this groom has none of its strands.
    pub mm: Option<f64>,
}

/// Well outside a reach, m: from here on nothing worth seeing should move.
pub const FAR_M: f64 = 0.1;

/// Compares the motions of one groom under two stacks.
///
/// # Errors
/// [`EditError::OtherGroom`] if the motions are not both of this groom and of the same frames.
pub fn measure(before: Under<'_>, after: Under<'_>, groom: &Groom) -> Result<EditEffects, EditError> {
    let only_in = |one: Under<'_>, other: Under<'_>| -> Vec<FieldLayer> {
        one.layers.iter().filter(|layer| !other.layers.contains(layer)).cloned().collect()
    };
    let (gone, new) = (only_in(before, after), only_in(after, before));
    let (before, after) = (before.motion, after.motion);
    check_motion(before, groom)?;
    check_motion(after, groom)?;
    if before.times_secs != after.times_secs {
        let (found, frames, expected) = (after.n_points(), after.times_secs.len(), groom.n_points());
        return Err(EditError::OtherGroom { found, frames, expected });
    }
    let layers = [&gone, &new].map(|layers| Present::of(layers, &before.times_secs));
    let frames = [before, after]
        .map(|motion| motion.positions_m.chunks_exact(motion.n_points().max(1)).collect::<Vec<Frame<'_>>>());
    let owns: Vec<Range<usize>> = (0..groom.strands.len()).map(|strand| before.points_of(strand)).collect();
    let clearance = |own: &Range<usize>| {
        let each = frames.iter().flat_map(|frames| layers.iter().map(|some| clearance_m(frames, own, some)));
        each.fold(f64::INFINITY, f64::min)
    };
    // Clearance, strand, how far it moved and in which frame, of those that stay outside.
    let outside = owns.iter().enumerate().map(|(strand, own)| (clearance(own), strand));
    let outside = outside.filter(|(clear_m, _)| *clear_m >= 0.0);
    let outside: Vec<(f64, usize, (f64, usize))> = outside
        .map(|(clear_m, strand)| (clear_m, strand, moved(&frames[0], &frames[1], &owns[strand])))
        .collect();
    let most_moved = |least_m: f64| {
        let clear = outside.iter().filter(|(clear_m, ..)| *clear_m >= least_m);
        let (_, strand, (mm, frame)) = clear.max_by(|a, b| a.2.0.total_cmp(&b.2.0))?;
        let (strand, secs) = (groom.strands[*strand].name.clone(), before.times_secs[*frame]);
        Some(Moved { strand, mm: *mm, secs })
    };
    Ok(EditEffects {
        edits: by_edit(&new).into_iter().map(|layer| effect(before, after, groom, layer)).collect(),
        first_change_secs: first_change_secs(before, after),
        most_moved_outside: most_moved(0.0),
        most_moved_far: most_moved(FAR_M),
    })
}

/// How far from their targets a motion has the points that some layers' edits drag.
///
/// # Errors
/// [`EditError::OtherGroom`] if the motion is not of this groom.
pub fn residuals(
    motion: &StrandMotion,
    groom: &Groom,
    layers: &[FieldLayer],
) -> Result<Vec<Residual>, EditError> {
    check_motion(motion, groom)?;
    let residual = |layer: &FieldLayer| {
        let keys = layer.keys();
        let found = keys.iter().filter_map(|key| Some(residual_mm(motion, strand_of(groom, key)?, key)));
        Residual { edit_id: layer.edit_id().to_owned(), mm: found.reduce(f64::max) }
    };
    Ok(by_edit(layers).into_iter().map(residual).collect())
}

/// The first layer of each edit.
fn by_edit(layers: &[FieldLayer]) -> Vec<&FieldLayer> {
    let mut first: Vec<&FieldLayer> = Vec::new();
    for layer in layers {
        if first.iter().all(|other| other.edit_id() != layer.edit_id()) {
            first.push(layer);
        }
    }
    first
}

fn effect(before: &StrandMotion, after: &StrandMotion, groom: &Groom, layer: &FieldLayer) -> EditEffect {
    let found = layer.keys().into_iter().filter_map(|key| Some((strand_of(groom, &key)?, key)));
    let found: Vec<(usize, LayerKey)> = found.collect();
    let mut strands: Vec<usize> = found.iter().map(|(strand, _)| *strand).collect();
    strands.sort_unstable();
    strands.dedup();
    let both =
        |figure: &dyn Fn(&StrandMotion) -> f64| Change { before: figure(before), after: figure(after) };
    EditEffect {
        edit_id: layer.edit_id().to_owned(),
        name: layer.name.clone(),
        strands: strands
            .into_iter()
            .map(|strand| StrandEffect {
                strand: groom.strands[strand].name.clone(),
                peak_acceleration: both(&|motion| peak_acceleration(motion, strand)),
                peak_jerk: both(&|motion| peak_jerk(motion, strand)),
                peak_energy: both(&|motion| peak_energy(motion, groom, strand)),
            })
            .collect(),
        keys: found
            .into_iter()
            .map(|(strand, key)| KeyEffect {
                residual_mm: both(&|motion| residual_mm(motion, strand, &key)),
                key,
            })
            .collect(),
    }
}

fn strand_of(groom: &Groom, key: &LayerKey) -> Option<usize> {
    let found = groom.strands.iter().position(|strand| strand.name == key.strand)?;
    (key.control_point < groom.strands[found].rest_curve_m.len()).then_some(found)
}

fn residual_mm(motion: &StrandMotion, strand: usize, key: &LayerKey) -> f64 {
    let points = StrandPath::new(motion, strand).points_at(key.secs);
    (points[key.control_point] - key.target_m).norm() * 1e3
}

/// The largest acceleration of any point of a strand in any frame, head space, m/s²; 0 of too few frames.
pub fn peak_acceleration(motion: &StrandMotion, strand: usize) -> f64 {
    peak(motion, strand, [1.0, -2.0, 1.0, 0.0], 2)
}

/// The largest jerk of any point of a strand in any frame, head space, m/s³; 0 of too few frames.
pub fn peak_jerk(motion: &StrandMotion, strand: usize) -> f64 {
    peak(motion, strand, [-1.0, 3.0, -3.0, 1.0], 3)
}

/// The largest energy of a strand's motion in any frame, J: half the mass of each stick sits at either end.
fn peak_energy(motion: &StrandMotion, groom: &Groom, strand: usize) -> f64 {
    let curve = &groom.strands[strand].rest_curve_m;
    let mut masses_kg = vec![0.0; curve.len()];
    for (k, pair) in curve.windows(2).enumerate() {
        let half = 0.5 * groom.strands[strand].linear_density_kg_per_m * (pair[1] - pair[0]).norm();
        masses_kg[k] += half;
        masses_kg[k + 1] += half;
    }
    let energy = |frame: usize| -> f64 {
        let dt_secs = motion.times_secs[frame + 1] - motion.times_secs[frame];
        let points = motion.strand(frame, strand).iter().zip(motion.strand(frame + 1, strand));
        let speeds2 = points.map(|(a, b)| (single(b) - single(a)).norm_squared() / (dt_secs * dt_secs));
        speeds2.zip(&masses_kg).map(|(speed2, mass_kg)| 0.5 * mass_kg * speed2).sum()
    };
    (0..motion.times_secs.len().saturating_sub(1)).map(energy).fold(0.0, f64::max)
}

/// The largest derivative of an order over all frames and points of a strand, by finite differences of
/// neighboring frames; 0 of too few frames.
fn peak(motion: &StrandMotion, strand: usize, weights: [f64; 4], order: i32) -> f64 {
    let frame_secs = StrandPath::new(motion, strand).frame_secs();
    let reach = order as usize;
    let n = motion.times_secs.len().saturating_sub(reach);
    let mut largest = 0.0;
    for k in 0..n {
        for point in 0..motion.counts[strand] {
            let at = |ahead: usize| single(&motion.strand(k + ahead, strand)[point]);
            let sum: Vec3 = (0..=reach).map(|ahead| at(ahead) * weights[ahead]).sum();
            largest = f64::max(largest, sum.norm());
        }
    }
    if n > 0 { largest / libm::pow(frame_secs, f64::from(order)) } else { 0.0 }
}

fn first_change_secs(before: &StrandMotion, after: &StrandMotion) -> Option<f64> {
    let bits = |frame: &[[f32; 3]]| frame.iter().flatten().map(|c| c.to_bits()).collect::<Vec<_>>();
    let changed = (0..before.times_secs.len()).find(|k| bits(before.frame(*k)) != bits(after.frame(*k)))?;
    Some(before.times_secs[changed])
}

/// The control points of one frame.
type Frame<'a> = &'a [[f32; 3]];

/// A layer, and in which frames it is there.
struct Present<'a> {
    layer: &'a FieldLayer,
    /// Opposite corners of a box that holds all it does, head space, m.
    corners_m: (Vec3, Vec3),
    frames: Vec<usize>,
}

impl<'a> Present<'a> {
    /// Layers that are there in some of a motion's frames.
    fn of(layers: &'a [FieldLayer], times_secs: &[f64]) -> Vec<Self> {
        let present = |layer: &'a FieldLayer| {
            let is_there = |frame: &usize| layer.presence(times_secs[*frame]) > 0.0;
            let frames: Vec<usize> = (0..times_secs.len()).filter(is_there).collect();
            let corners_m = layer.corners_m().filter(|_| !frames.is_empty())?;
            Some(Self { layer, corners_m, frames })
        };
        layers.iter().filter_map(present).collect()
    }
}

/// How far outside every handle's reach a strand stays while the layers are there, m; negative within one.
/// Above [`FAR_M`] it is at least that.
fn clearance_m(frames: &[Frame<'_>], own: &Range<usize>, layers: &[Present<'_>]) -> f64 {
    let mut least = f64::INFINITY;
    for Present { layer, corners_m: (low, high), frames: there } in layers {
        for frame in there {
            for point in frames[*frame][own.clone()].iter().map(single) {
                let outside_box2 = (point - point.sup(low).inf(high)).norm_squared();
                if outside_box2 > FAR_M * FAR_M {
                    least = least.min(outside_box2.sqrt());
                    continue;
                }
                let gaps = layer.handles.iter().map(|h| (point - h.center_m).norm() - h.reach_m);
                least = gaps.fold(least, f64::min);
            }
        }
    }
    least
}

/// How far a point of a strand moved at the most, mm, and in which frame.
fn moved(before: &[Frame<'_>], after: &[Frame<'_>], own: &Range<usize>) -> (f64, usize) {
    let mut most = (0.0, 0);
    for (k, (before, after)) in before.iter().zip(after).enumerate() {
        for (a, b) in before[own.clone()].iter().zip(&after[own.clone()]) {
            let mm = (single(b) - single(a)).norm() * 1e3;
            if mm > most.0 {
                most = (mm, k);
            }
        }
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::Strand;
    use tousle_field::{Ease, Handle, LayerOrigin};

    fn groom() -> Groom {
        let strand = |name: &str, x: f64| Strand {
            name: name.into(),
            rest_curve_m: vec![Vec3::new(x, 0.0, 0.0), Vec3::new(x, 0.0, -0.1)],
            length_m: 0.1,
            linear_density_kg_per_m: 0.001,
            lock_width_m: 0.004,
            bending_stiffness_n_m2: 1e-6,
            internal_damping_secs: 0.01,
            along: tousle_core::Along::default(),
            holds_style: false,
        };
        Groom { strands: vec![strand("A", 0.0), strand("B", 0.1), strand("C", 0.5)], assumed: Vec::new() }
    }

    /// At 10 Hz for 2 s; the tips of `A` and `C` move by what `way` gives for the frame, m along y.
    fn motion(way: impl Fn(usize) -> f32) -> StrandMotion {
        let mut positions_m = Vec::new();
        for k in 0..21 {
            for (s, strand) in groom().strands.iter().enumerate() {
                let y = if s == 1 { 0.0 } else { way(k) / (1 + 9 * s / 2) as f32 };
                let x = strand.rest_curve_m[0].x as f32;
                positions_m.extend([[x, 0.0, 0.0], [x, y, -0.1]]);
            }
        }
        let times_secs = (0..21).map(|k| f64::from(k) / 10.0).collect();
        StrandMotion { counts: vec![2; 3], times_secs, positions_m }
    }

    fn layer() -> FieldLayer {
        FieldLayer {
            id: "lift".into(),
            name: "lift".into(),
            muted: false,
            first_secs: 1.0,
            last_secs: 2.0,
            ease: Ease { rise: 0.5, fall: 0.5 },
            handles: vec![Handle { center_m: Vec3::new(0.0, 0.0, -0.1), reach_m: 0.06, extra: Vec3::y() }],
            reshape: None,
            origin: LayerOrigin::Drag {
                strand: "A".into(),
                control_point: 1,
                target_m: Vec3::new(0.0, 0.03, -0.1),
                method: "paper".into(),
            },
        }
    }

    /// What becomes of a still motion by `way`, and of one stack by another.
    fn compared(way: impl Fn(usize) -> f32, before: &[FieldLayer], after: &[FieldLayer]) -> EditEffects {
        let (still, moved) = (motion(|_| 0.0), motion(way));
        let before = Under { motion: &still, layers: before };
        measure(before, Under { motion: &moved, layers: after }, &groom()).unwrap()
    }

    /// From 1.1 s on the tip is 1, 4, 9, … mm higher: an acceleration of 0.2 m/s², a jerk of 1 m/s³ at the start.
    #[test]
    fn residual_acceleration_and_jerk_by_hand() {
        let way = |k: usize| if k > 10 { ((k - 10) * (k - 10)) as f32 * 1e-3 } else { 0.0 };
        let effects = compared(way, &[], &[layer()]);
        let effect = &effects.edits[0];
        let residual = effect.keys[0].residual_mm;
        assert!(
            (residual.before - 30.0).abs() < 1e-4 && (residual.after - 70.0).abs() < 1e-4,
            "{residual:?}"
        );
        let strand = &effect.strands[0];
        assert!((strand.peak_acceleration.after - 0.2).abs() < 1e-4);
        assert!((strand.peak_jerk.after - 1.0).abs() < 1e-3);
        assert_eq!(strand.peak_jerk.before, 0.0);
        // Half of 0.1 m of 1 g/m at the tip, which goes 19 mm in the last tenth of a second.
        assert!((strand.peak_energy.after - 0.5 * 5e-5 * 0.19 * 0.19).abs() < 1e-9);
        assert_eq!(effects.first_change_secs, Some(1.1));
    }

    #[test]
    fn who_moved_outside_the_reach_is_named() {
        let way = |k: usize| if k > 10 { 0.01 } else { 0.0 };
        let effects = compared(way, &[], &[layer()]);
        // A is within the reach, B stays, C is 0.44 m away and moved by 1 mm all the same.
        let far = effects.most_moved_far.unwrap();
        assert_eq!((far.strand.as_str(), far.secs), ("C", 1.1));
        assert!((far.mm - 1.0).abs() < 1e-4);
        assert_eq!(effects.most_moved_outside.unwrap().strand, "C");
    }

    /// A layer that is muted lets go of what was in its reach.
    #[test]
    fn what_was_in_reach_of_a_layer_that_is_gone_is_not_outside() {
        let way = |k: usize| if k > 10 { 0.01 } else { 0.0 };
        let muted = FieldLayer { muted: true, ..layer() };
        for after in [vec![muted], vec![]] {
            let effects = compared(way, &[layer()], &after);
            assert_eq!(effects.edits.len(), after.len());
            assert_eq!(effects.most_moved_outside.unwrap().strand, "C");
        }
        let same = compared(way, &[layer()], &[layer()]);
        assert!(same.edits.is_empty());
        assert_eq!(same.most_moved_outside.unwrap().strand, "A");
    }

    #[test]
    fn nothing_done_is_no_change() {
        let residual = &residuals(&motion(|_| 0.0), &groom(), &[layer()]).unwrap()[0];
        assert_eq!((residual.edit_id.as_str(), residual.mm.map(f64::round)), ("lift", Some(30.0)));
        let effects = compared(|_| 0.0, &[], &[layer()]);
        assert_eq!(effects.first_change_secs, None);
        let mut elsewhere = layer();
        elsewhere.origin = LayerOrigin::Drag {
            strand: "Z".into(),
            control_point: 1,
            target_m: Vec3::zeros(),
            method: "paper".into(),
        };
        let effects = compared(|_| 0.0, &[], &[elsewhere]);
        assert!(effects.edits[0].keys.is_empty());
    }
}
