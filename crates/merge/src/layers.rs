//! The edits of several fields in one stack.

use crate::Input;
use std::collections::BTreeMap;
use tousle_field::{FieldLayer, LayerOrigin};

/// An edit of an input.
struct Edit {
    /// Its layers as the input has them, but on the common clock.
    layers: Vec<FieldLayer>,
    /// Its id in the merged field.
    id: String,
}

/// The edits of all inputs on the common clock, and what a user should know of them.
///
/// An edit that several inputs have, the same in every layer, is there once. One that differs from all before it and has
/// an id of theirs gets one of its own, so that it can still be named.
pub(crate) fn join(inputs: &[Input<'_>]) -> (Vec<FieldLayer>, Vec<String>) {
    let mut all: Vec<FieldLayer> = Vec::new();
    let mut warnings = Vec::new();
    let mut edits: Vec<Edit> = Vec::new();
    for input in inputs {
        let own: Vec<FieldLayer> =
            input.layers.iter().map(|layer| on_common_clock(layer, input.offset_secs)).collect();
        let mut new = Vec::new();
        let mut ids = BTreeMap::new();
        for layers in by_edit(&own) {
            let id = layers[0].edit_id().to_owned();
            if let Some(same) = edits.iter().find(|edit| edit.layers == layers) {
                ids.insert(id, same.id.clone());
                continue;
            }
            let free = free_id(&layers, &all, &own);
            if free != id {
                warnings.push(format!(
                    "the edit `{id}` of {} is not the one of that name in a field before it: it is `{free}` now, and both act",
                    input.name
                ));
            }
            ids.insert(id, free.clone());
            new.push(Edit { layers, id: free });
        }
        let is_new = |layer: &FieldLayer| new.iter().any(|edit| edit.layers.contains(layer));
        all.extend(own.iter().filter(|layer| is_new(layer)).map(|layer| renamed(layer, &ids)));
        edits.extend(new);
    }
    (all, warnings)
}

fn on_common_clock(layer: &FieldLayer, offset_secs: f64) -> FieldLayer {
    let mut layer = layer.clone();
    layer.first_secs += offset_secs;
    layer.last_secs += offset_secs;
    if let LayerOrigin::Keys { first_secs, keys, .. } = &mut layer.origin {
        *first_secs += offset_secs;
        keys.iter_mut().for_each(|key| key.secs += offset_secs);
    }
    layer
}

/// The layers of each edit, edits in the order of their first layers.
fn by_edit(layers: &[FieldLayer]) -> Vec<Vec<FieldLayer>> {
    let mut edits: Vec<Vec<FieldLayer>> = Vec::new();
    for layer in layers {
        match edits.iter_mut().find(|edit| edit[0].edit_id() == layer.edit_id()) {
            Some(edit) => edit.push(layer.clone()),
            None => edits.push(vec![layer.clone()]),
        }
    }
    edits
}

/// The id of an edit if neither it nor its layers' are taken; otherwise one that no layer's id begins with, be it of the
/// merged field so far or of the edit's own.
fn free_id(layers: &[FieldLayer], all: &[FieldLayer], own: &[FieldLayer]) -> String {
    let id = layers[0].edit_id();
    let clashes = |other: &FieldLayer| other.edit_id() == id || layers.iter().any(|l| l.id == other.id);
    let mut free = id.to_owned();
    if all.iter().any(clashes) {
        let begins = |free: &str| {
            let of = |layer: &FieldLayer| layer.id.starts_with(free) || layer.edit_id().starts_with(free);
            all.iter().chain(own).any(of)
        };
        let mut n = 2;
        while begins(&free) {
            free = format!("{id}-{n}");
            n += 1;
        }
    }
    free
}

/// A layer whose edit, and the one it mirrors, are called as in the merged field.
fn renamed(layer: &FieldLayer, ids: &BTreeMap<String, String>) -> FieldLayer {
    let mut layer = layer.clone();
    let was = layer.edit_id().to_owned();
    let id = &ids[&was];
    if *id != was {
        layer.id = match layer.id.strip_prefix(&was) {
            Some(rest) => format!("{id}{rest}"),
            None => format!("{id}/{}", layer.id),
        };
    }
    match &mut layer.origin {
        LayerOrigin::Keys { edit, .. } => edit.clone_from(id),
        LayerOrigin::Mirrored { edit, of } => {
            edit.clone_from(id);
            if let Some(id) = ids.get(of) {
                of.clone_from(id);
            }
        }
        LayerOrigin::Drag { .. } | LayerOrigin::Wind { .. } => {}
    }
    layer
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{input, scene};
    use tousle_core::Vec3;
    use tousle_field::{Ease, LayerKey};

    /// A layer with this id of an edit with this id, in which the tip of a lock is at 0.1 s where it should be.
    fn layer(id: &str, edit: &str, strand: &str) -> FieldLayer {
        let key = LayerKey { strand: strand.into(), control_point: 3, secs: 0.1, target_m: Vec3::zeros() };
        FieldLayer {
            id: id.into(),
            name: "lift".into(),
            muted: false,
            first_secs: 0.0,
            last_secs: 0.1,
            ease: Ease { rise: 0.5, fall: 0.5 },
            handles: Vec::new(),
            reshape: None,
            origin: LayerOrigin::Keys {
                edit: edit.into(),
                first_secs: 0.0,
                keys: vec![key],
                method: "physical".into(),
            },
        }
    }

    fn lift(strand: &str) -> Vec<FieldLayer> {
        vec![layer("lift/1", "lift", strand), layer("lift/2", "lift", strand)]
    }

    fn mirrored() -> FieldLayer {
        let origin = LayerOrigin::Mirrored { edit: "lift-mirrored".into(), of: "lift".into() };
        FieldLayer { origin, ..layer("lift-mirrored", "", "A") }
    }

    fn joined(stacks: &[&[FieldLayer]]) -> (Vec<FieldLayer>, Vec<String>) {
        let scene = scene();
        let of = |layers| Input { layers, ..input("field", &scene) };
        join(&stacks.iter().copied().map(of).collect::<Vec<_>>())
    }

    fn ids(layers: &[FieldLayer]) -> Vec<(&str, &str)> {
        layers.iter().map(|layer| (layer.id.as_str(), layer.edit_id())).collect()
    }

    #[test]
    fn the_same_edit_is_there_once() {
        let stack = [lift("A"), vec![mirrored()]].concat();
        assert_eq!(joined(&[&stack, &stack]), (stack, Vec::new()));
    }

    /// All layers of an edit get the new id, and so does what was mirrored from it. A field that has the renamed edit
    /// again adds nothing.
    #[test]
    fn other_edits_of_one_id_stay_edits_of_their_own() {
        let other = [lift("B"), vec![mirrored()]].concat();
        let (all, warnings) = joined(&[&lift("A"), &other, &other]);
        let expected = [
            ("lift/1", "lift"),
            ("lift/2", "lift"),
            ("lift-2/1", "lift-2"),
            ("lift-2/2", "lift-2"),
            ("lift-mirrored", "lift-mirrored"),
        ];
        assert_eq!(ids(&all), expected);
        assert!(matches!(&all[4].origin, LayerOrigin::Mirrored { of, .. } if of == "lift-2"), "{:?}", all[4]);
        assert_eq!(
            warnings,
            [
                "the edit `lift` of field is not the one of that name in a field before it: it is `lift-2` now, \
              and both act"
            ]
        );
    }

    #[test]
    fn a_new_id_is_nobodys() {
        let taken = [lift("B"), vec![layer("lift-2", "lift-2", "A"), layer("alone", "lift-3", "A")]].concat();
        let (all, _) = joined(&[&lift("A"), &taken, &[layer("alone", "other", "A")]]);
        let expected = ["lift/1", "lift/2", "lift-4/1", "lift-4/2", "lift-2", "alone", "other-2/alone"];
        assert_eq!(all.iter().map(|layer| layer.id.as_str()).collect::<Vec<_>>(), expected);
    }

    /// Keys are at times, too.
    #[test]
    fn edits_come_onto_the_common_clock() {
        let (scene, layers) = (scene(), lift("A"));
        let (all, _) = join(&[Input { layers: &layers, offset_secs: 2.0, ..input("field", &scene) }]);
        assert_eq!((all[0].first_secs, all[0].last_secs), (2.0, 2.1));
        let LayerOrigin::Keys { first_secs, keys, .. } = &all[0].origin else { panic!("{:?}", all[0]) };
        assert_eq!((*first_secs, keys[0].secs), (2.0, 2.1));
    }
}
