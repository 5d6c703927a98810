//! Edits to layers.

use crate::air::extra_winds;
use crate::chain::{drag, reach_m};
use crate::e4::{Pull, Way, handles, n_instants, of_edit, progress};
use crate::path::check_motion;
use crate::resolve::{Resolved, resolve};
use crate::{
    Action, Edit, EditError, EditList, EditOptions, EditOutcome, EditReport, Target, Unreachable,
    change_stack, wind_layer,
};
use tousle_core::{Groom, Quantity, StrandMotion, Vec3};
use tousle_field::{FieldLayer, FieldSequence, LayerOrigin, Scene};
use tousle_rod::Surface;

/// The method's name in layers and reports.
pub const METHOD: &str = "paper";

/// A field with the layers of some edits on top of those it had.
#[derive(Clone, Debug, PartialEq)]
pub struct Edited {
    /// The field; its voxels are untouched.
    pub sequence: FieldSequence,
    /// What each edit became.
    pub report: EditReport,
}

/// Layers and what they were made from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layers {
    /// One layer an edit, in the list's order.
    pub layers: Vec<FieldLayer>,
    /// What each edit became.
    pub report: EditReport,
}

/// Puts edits on a field as layers.
///
/// In: the field and its scene, a groom, and the motion that this groom has in this field. Out: the same field,
/// its stack changed as the list says, with one layer a wind and a drag on top; simulate again to see what became of it. Before an edit's first
/// key and after its second the field is unchanged to the bit. Edits of one list are all made from the given
/// motion and know nothing of each other. To correct an edit once more, as the paper does until the animator is
/// content, give the field and the motion with it: the new layer adds what is still missing.
/// Source: Kazama et al. 2008, section 4, E4 (`docs/equations.md`).
///
/// # Errors
/// [`EditError`] if the field cannot be sampled, the motion is not of this groom, or an edit names what is not
/// there. A target out of reach is no error but [`EditOutcome::unreachable`].
pub fn apply(
    mut field: FieldSequence,
    scene: &Scene,
    groom: &Groom,
    motion: &StrandMotion,
    edits: &EditList,
    options: &EditOptions,
) -> Result<Edited, EditError> {
    field.check()?;
    field.layers = change_stack(&field.layers, &edits.changes)?;
    let Layers { layers, report } = make_layers(&field, scene, groom, motion, edits, options)?;
    field.layers.extend(layers);
    Ok(Edited { sequence: field, report })
}

/// The layers that [`apply`] would add, alone, the list's changes of the stack left out: for an editor that holds the
/// field already.
///
/// Takes the field for one that passes [`FieldSequence::check`]: to look at every voxel for every drag would cost
/// more than all the rest.
///
/// # Errors
/// As [`apply`], but for the field.
///
/// # Panics
/// If the field does not pass [`FieldSequence::check`].
pub fn make_layers(
    field: &FieldSequence,
    scene: &Scene,
    groom: &Groom,
    motion: &StrandMotion,
    edits: &EditList,
    options: &EditOptions,
) -> Result<Layers, EditError> {
    make_layers_on(field, &field.layers, scene, groom, motion, edits, options)
}

/// [`make_layers`] on top of other layers than the field's own.
///
/// # Errors
/// As [`make_layers`].
///
/// # Panics
/// As [`make_layers`].
pub fn make_layers_on(
    field: &FieldSequence,
    layers: &[FieldLayer],
    scene: &Scene,
    groom: &Groom,
    motion: &StrandMotion,
    edits: &EditList,
    options: &EditOptions,
) -> Result<Layers, EditError> {
    edits.check()?;
    check_motion(motion, groom)?;
    let mut taken: Vec<String> = layers.iter().map(|layer| layer.edit_id().to_owned()).collect();
    let mut made = Layers::default();
    let mut id_of = |name: &str| {
        taken.push(free_id(name, &taken));
        taken[taken.len() - 1].clone()
    };
    for (k, edit) in edits.winds.iter().enumerate() {
        made.layers.push(wind_layer(edits, k + 1, id_of(&edit.name))?);
    }
    for (k, edit) in edits.edits.iter().enumerate() {
        let Action::Drag(asked) = &edit.action;
        if !asked.also.is_empty() {
            let problem = format!("found {} keys, expected one: E4 knows no more", asked.also.len() + 1);
            return Err(of_edit(k + 1, &edit.name)(problem));
        }
        let resolved = resolve(edits, k + 1, asked, groom, motion)?;
        let (layer, outcome) =
            drag_layer((field, layers), scene, &resolved, edit, id_of(&edit.name), options)?;
        made.layers.push(layer);
        made.report.edits.push(outcome);
    }
    Ok(made)
}

fn drag_layer(
    (field, layers): (&FieldSequence, &[FieldLayer]),
    scene: &Scene,
    resolved: &Resolved<'_>,
    edit: &Edit,
    id: String,
    options: &EditOptions,
) -> Result<(FieldLayer, EditOutcome), EditError> {
    let Resolved { dragged, first_secs, second_secs, ref unedited_m, .. } = *resolved;
    let bad = of_edit(resolved.number, &edit.name);
    if unedited_m.iter().any(|p| !p.iter().all(|c| c.is_finite())) {
        return Err(EditError::BadMotion { strand: resolved.strand.name.clone(), secs: second_secs });
    }
    if field.quantity == Quantity::AirVelocity && scene.air_density <= 0.0 {
        return Err(bad(format!(
            "found a scene with an air density of {} kg/m³, expected air: no wind pulls hair without it",
            scene.air_density
        )));
    }
    let target_m = match resolved.drag.target {
        Target::At(at) => at,
        Target::Offset(offset) => unedited_m[dragged] + offset,
    };
    let moved = drag(unedited_m, dragged, target_m);
    let pull = Pull {
        span_secs: second_secs - first_secs,
        ease: edit.ease,
        span: options.span,
        gravity: scene.gravity_world.norm(),
    };
    let accelerations: Vec<Vec3> = lengths_along(unedited_m)
        .zip(unedited_m.iter().zip(&moved.points_m))
        .map(|(length_m, (from, to))| pull.acceleration(*from, *to, length_m))
        .collect();
    let (extras, along_lock) = match field.quantity {
        Quantity::ForcePerMass => (accelerations.clone(), 0.0),
        Quantity::AirVelocity => extra_winds(field, layers, scene, resolved, edit.ease, &accelerations),
    };
    let ways = ways(resolved, edit, &moved.points_m, &extras);
    let handles = handles(&ways, dragged, resolved.drag.reach_m).map_err(&bad)?;
    let outcome = EditOutcome {
        name: edit.name.clone(),
        layer_id: id.clone(),
        muted: edit.muted,
        strand: resolved.strand.name.clone(),
        control_point: dragged,
        first_secs,
        second_secs,
        unedited_m: unedited_m[dragged],
        target_m,
        asked_mm: (target_m - unedited_m[dragged]).norm() * 1e3,
        unreachable: out_of_reach(scene, unedited_m, dragged, target_m, second_secs),
        acceleration: accelerations[dragged],
        along_lock,
        extra: extras[dragged],
        n_handles: handles.len(),
    };
    let layer = FieldLayer {
        id,
        name: edit.name.clone(),
        muted: edit.muted,
        first_secs,
        last_secs: second_secs,
        ease: edit.ease,
        handles,
        reshape: None,
        origin: LayerOrigin::Drag {
            strand: resolved.strand.name.clone(),
            control_point: dragged,
            target_m,
            method: METHOD.to_owned(),
        },
    };
    Ok((layer, outcome))
}

/// Where the control points go between the keys: their unedited way, and more and more of what is added to it.
///
/// A strand feels a layer only near its handles, so these lie along the way and not at its end alone.
fn ways(resolved: &Resolved<'_>, edit: &Edit, moved_m: &[Vec3], extras: &[Vec3]) -> Vec<Way> {
    let Resolved { path, first_secs, second_secs, unedited_m, .. } = resolved;
    let longest_m = longest_way_m(resolved, moved_m);
    let n = n_instants(longest_m, resolved.drag.reach_m);
    let shares = progress(edit.ease, n);
    let mut ways: Vec<Way> =
        extras.iter().map(|extra| Way { places_m: Vec::with_capacity(n + 1), extra: *extra }).collect();
    for (k, share) in shares.iter().enumerate() {
        let time_secs = first_secs + (second_secs - first_secs) * k as f64 / n as f64;
        for (j, place) in path.points_at(time_secs).into_iter().enumerate() {
            ways[j].places_m.push(place + (moved_m[j] - unedited_m[j]) * *share);
        }
    }
    ways
}

/// A bound of how far any control point goes between the keys: frame by frame unedited, and what is added.
fn longest_way_m(resolved: &Resolved<'_>, moved_m: &[Vec3]) -> f64 {
    let Resolved { path, first_secs, second_secs, unedited_m, .. } = resolved;
    let frame_secs = path.frame_secs().max((second_secs - first_secs) / 1024.0);
    let n = ((second_secs - first_secs) / frame_secs).ceil() as usize;
    let mut lengths: Vec<f64> = unedited_m.iter().zip(moved_m).map(|(from, to)| (to - from).norm()).collect();
    let mut before = path.points_at(*first_secs);
    for k in 1..=n {
        let after = path.points_at(first_secs + (second_secs - first_secs) * k as f64 / n as f64);
        for (j, length) in lengths.iter_mut().enumerate() {
            *length += (after[j] - before[j]).norm();
        }
        before = after;
    }
    lengths.into_iter().fold(0.0, f64::max)
}

/// The length of a chain from its root to each of its points, m.
fn lengths_along(points_m: &[Vec3]) -> impl Iterator<Item = f64> + '_ {
    let mut length_m = 0.0;
    std::iter::once(0.0).chain(points_m.windows(2).map(move |pair| {
        length_m += (pair[1] - pair[0]).norm();
        length_m
    }))
}

/// Why a strand's control point cannot be at a target at a time, if the lock's length or the body is in the way.
///
/// `points_m`: the strand's control points, head space, for the lengths between them.
pub fn out_of_reach(
    scene: &Scene,
    points_m: &[Vec3],
    dragged: usize,
    target_m: Vec3,
    secs: f64,
) -> Option<Unreachable> {
    let lengths: Vec<f64> = points_m.windows(2).take(dragged).map(|p| (p[1] - p[0]).norm()).collect();
    let (nearest, farthest) = reach_m(&lengths);
    let distance = (target_m - points_m[0]).norm();
    // Positions of a motion are single-precision numbers.
    let slack = 1e-6 * farthest;
    if distance > farthest + slack {
        return Some(Unreachable::TooFar { by_mm: (distance - farthest) * 1e3 });
    }
    if distance < nearest - slack {
        return Some(Unreachable::TooNear { by_mm: (nearest - distance) * 1e3 });
    }
    let pose = scene.poses.motion_at(secs).world_from_head;
    let head_from_torso = scene.body.head_from_torso(&pose, &scene.rest_pose);
    let surfaces = Surface::of_body(&scene.body, &head_from_torso);
    let depths = surfaces.iter().map(|s| -s.gap(target_m).distance_m).zip(&scene.body.colliders);
    let (deepest, collider) = depths.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let by_mm = deepest * 1e3;
    (deepest > slack).then(|| Unreachable::InsideBody { collider: collider.name.clone(), by_mm })
}

/// An id made of a name, unlike those that are taken: `lift-the-fringe`, then `lift-the-fringe-2`.
pub fn free_id(name: &str, taken: &[String]) -> String {
    let words = name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    let slug = words.map(str::to_lowercase).collect::<Vec<_>>().join("-");
    let slug = if slug.is_empty() { "edit".to_owned() } else { slug };
    let numbered = (2..).map(|n: u64| format!("{slug}-{n}"));
    let mut ids = std::iter::once(slug.clone()).chain(numbered);
    ids.find(|id| !taken.contains(id)).unwrap_or(slug)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::{Attachment, Body, Collider, Pose, PoseTrack, Shape};

    #[test]
    fn ids_are_made_of_names_and_never_twice_the_same() {
        let taken = ["lift-the-fringe".to_owned(), "lift-the-fringe-2".to_owned()];
        assert_eq!(free_id("Lift the fringe!", &taken), "lift-the-fringe-3");
        assert_eq!(free_id("…", &taken), "edit");
    }

    #[test]
    fn what_is_out_of_reach_is_told_by_how_much() {
        let scene = Scene {
            poses: PoseTrack::still(Pose::identity()),
            rest_pose: Pose::identity(),
            gravity_world: Vec3::zeros(),
            air_density: 1.2,
            body: Body {
                colliders: vec![Collider {
                    name: "neck".into(),
                    shape: Shape::Capsule { a_m: Vec3::y() * 0.1, b_m: Vec3::y() * 0.2, radius_m: 0.06 },
                    attachment: Attachment::Head,
                }],
                ..Body::none()
            },
        };
        let points = [Vec3::zeros(), Vec3::new(0.0, 0.0, -0.08), Vec3::new(0.0, 0.0, -0.11)];
        for (target, expected) in [
            (Vec3::new(0.15, 0.0, 0.0), Some("40.0 mm farther from the root than the lock is long")),
            (Vec3::new(0.02, 0.0, 0.0), Some("30.0 mm nearer to the root than the lock can fold")),
            (Vec3::new(0.0, 0.08, 0.0), Some("40.0 mm inside the neck")),
            (Vec3::new(0.06, 0.0, 0.0), None),
        ] {
            let found = out_of_reach(&scene, &points, 2, target, 0.0).map(|why| why.to_string());
            assert_eq!(found.as_deref(), expected);
        }
    }
}
