//! A field's stack of layers, changed as values.

use crate::{EditError, free_id};
use serde::{Deserialize, Serialize};
use tousle_core::Vec3;
use tousle_field::{FieldLayer, LayerOrigin};

/// A change of an edit that is on a field already. All its layers change together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum StackChange {
    /// It does nothing for now.
    Mute {
        /// The edit's id.
        edit: String,
    },
    /// It is heard again.
    Unmute {
        /// The edit's id.
        edit: String,
    },
    /// It gets another name; its id stays.
    Rename {
        /// The edit's id.
        edit: String,
        /// The name.
        name: String,
    },
    /// It is taken out.
    Remove {
        /// The edit's id.
        edit: String,
    },
    /// It is moved and stretched in time. What was solved for is not solved again.
    Retime {
        /// The edit's id.
        edit: String,
        /// When it should begin, s.
        first_secs: f64,
        /// When it should have ended, s.
        last_secs: f64,
    },
    /// A copy is added that does the same on the other side, left and right exchanged.
    Mirror {
        /// The edit's id.
        edit: String,
    },
}

impl std::fmt::Display for StackChange {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Mute { edit } => write!(f, "muted `{edit}`"),
            Self::Unmute { edit } => write!(f, "`{edit}` is heard again"),
            Self::Rename { edit, name } => write!(f, "renamed `{edit}` to {name:?}"),
            Self::Remove { edit } => write!(f, "removed `{edit}`"),
            Self::Retime { edit, first_secs, last_secs } => {
                write!(f, "moved `{edit}` to {first_secs:.3} to {last_secs:.3} s")
            }
            Self::Mirror { edit } => write!(f, "mirrored `{edit}`"),
        }
    }
}

/// The stack after some changes, one after another.
///
/// # Errors
/// [`EditError::NoLayer`] if no edit has an id, [`EditError::BadChange`] if an edit should end before it begins.
pub fn change_stack(layers: &[FieldLayer], changes: &[StackChange]) -> Result<Vec<FieldLayer>, EditError> {
    changes.iter().try_fold(layers.to_vec(), |layers, change| match change {
        StackChange::Mute { edit } => mute(&layers, edit, true),
        StackChange::Unmute { edit } => mute(&layers, edit, false),
        StackChange::Rename { edit, name } => rename(&layers, edit, name),
        StackChange::Remove { edit } => remove(&layers, edit),
        StackChange::Retime { edit, first_secs, last_secs } => retime(&layers, edit, *first_secs, *last_secs),
        StackChange::Mirror { edit } => mirror(&layers, edit),
    })
}

/// The stack with one edit muted or heard again.
///
/// # Errors
/// [`EditError::NoLayer`] if no edit has this id.
pub fn mute(layers: &[FieldLayer], id: &str, muted: bool) -> Result<Vec<FieldLayer>, EditError> {
    change(layers, id, |layer| layer.muted = muted)
}

/// The stack with another name for one edit; its id stays.
///
/// # Errors
/// [`EditError::NoLayer`] if no edit has this id.
pub fn rename(layers: &[FieldLayer], id: &str, name: &str) -> Result<Vec<FieldLayer>, EditError> {
    change(layers, id, |layer| name.clone_into(&mut layer.name))
}

/// The stack without one of its edits.
///
/// # Errors
/// [`EditError::NoLayer`] if no edit has this id.
pub fn remove(layers: &[FieldLayer], id: &str) -> Result<Vec<FieldLayer>, EditError> {
    find(layers, id)?;
    Ok(layers.iter().filter(|layer| layer.edit_id() != id).cloned().collect())
}

/// The stack with one edit moved and stretched in time. Keys move along; that they are met is not to be expected.
///
/// # Errors
/// [`EditError::NoLayer`] if no edit has this id, [`EditError::BadChange`] if it should end before it begins.
pub fn retime(
    layers: &[FieldLayer],
    id: &str,
    first_secs: f64,
    last_secs: f64,
) -> Result<Vec<FieldLayer>, EditError> {
    let own = find(layers, id)?;
    if !(first_secs.is_finite() && last_secs.is_finite() && last_secs > first_secs) {
        let problem = format!("found an end at {last_secs} s, expected one after the start, {first_secs} s");
        return Err(EditError::BadChange { id: id.to_owned(), problem });
    }
    let start = own.iter().map(|layer| layer.first_secs).fold(f64::INFINITY, f64::min);
    let end = own.iter().map(|layer| layer.last_secs).fold(f64::NEG_INFINITY, f64::max);
    let per = (last_secs - first_secs) / (end - start);
    let moved = |secs: f64| first_secs + (secs - start) * per;
    change(layers, id, |layer| {
        (layer.first_secs, layer.last_secs) = (moved(layer.first_secs), moved(layer.last_secs));
        if let LayerOrigin::Keys { first_secs, keys, .. } = &mut layer.origin {
            *first_secs = moved(*first_secs);
            keys.iter_mut().for_each(|key| key.secs = moved(key.secs));
        }
    })
}

/// The stack with a copy of one edit on top that does the same on the other side, left and right exchanged.
///
/// # Errors
/// [`EditError::NoLayer`] if no edit has this id.
pub fn mirror(layers: &[FieldLayer], id: &str) -> Result<Vec<FieldLayer>, EditError> {
    let own = find(layers, id)?;
    let taken: Vec<String> = layers.iter().map(|layer| layer.edit_id().to_owned()).collect();
    let edit = free_id(&format!("{} mirrored", own[0].name), &taken);
    let other_side = |v: Vec3| Vec3::new(v.x, -v.y, v.z);
    let mirrored = own.iter().enumerate().map(|(k, layer)| {
        let mut copy = (*layer).clone();
        copy.id = if own.len() == 1 { edit.clone() } else { format!("{edit}/{}", k + 1) };
        copy.name = format!("{} mirrored", layer.name);
        for handle in &mut copy.handles {
            (handle.center_m, handle.extra) = (other_side(handle.center_m), other_side(handle.extra));
        }
        // What turns to the left on one side turns to the right on the other.
        copy.reshape = copy.reshape.map(|mut reshape| {
            reshape.turn = -other_side(reshape.turn);
            reshape
        });
        copy.origin = LayerOrigin::Mirrored { edit: edit.clone(), of: id.to_owned() };
        copy
    });
    Ok(layers.iter().cloned().chain(mirrored).collect())
}

fn change(
    layers: &[FieldLayer],
    id: &str,
    change: impl Fn(&mut FieldLayer),
) -> Result<Vec<FieldLayer>, EditError> {
    find(layers, id)?;
    let mut changed = layers.to_vec();
    changed.iter_mut().filter(|layer| layer.edit_id() == id).for_each(change);
    Ok(changed)
}

/// The layers of an edit.
fn find<'a>(layers: &'a [FieldLayer], id: &str) -> Result<Vec<&'a FieldLayer>, EditError> {
    let found: Vec<&FieldLayer> = layers.iter().filter(|layer| layer.edit_id() == id).collect();
    if !found.is_empty() {
        return Ok(found);
    }
    let mut known: Vec<&str> = layers.iter().map(FieldLayer::edit_id).collect();
    known.dedup();
    Err(EditError::NoLayer { id: id.to_owned(), known: known.join(", ") })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::layer;
    use tousle_field::{Handle, Reshape};

    fn stack() -> Vec<FieldLayer> {
        vec![layer("a"), layer("b")]
    }

    #[test]
    fn one_layer_changes_and_the_others_stay() {
        let stack = stack();
        let muted = mute(&stack, "b", true).unwrap();
        assert!(muted[1].muted && muted[0] == stack[0]);
        assert_eq!(mute(&muted, "b", false).unwrap(), stack);
        let renamed = rename(&stack, "a", "lift").unwrap();
        assert_eq!((renamed[0].id.as_str(), renamed[0].name.as_str()), ("a", "lift"));
        assert_eq!(remove(&stack, "a").unwrap(), stack[1..]);
    }

    #[test]
    fn a_layer_that_is_not_there_is_named_with_those_that_are() {
        let error = remove(&stack(), "c").unwrap_err().to_string();
        assert_eq!(error, "found no layer `c`, expected one of: a, b");
        let error = mute(&[], "c", true).unwrap_err().to_string();
        assert_eq!(error, "found no layer `c`, expected one that is on the field, which has no layers");
    }

    /// Layers that were solved for together: 1 to 1.2 s and 1.1 to 1.3 s.
    fn solved() -> Vec<FieldLayer> {
        let layer = |k: u8| FieldLayer {
            id: format!("lift/{}", k + 1),
            name: "lift".into(),
            first_secs: 1.0 + 0.1 * f64::from(k),
            last_secs: 1.2 + 0.1 * f64::from(k),
            handles: vec![Handle { center_m: Vec3::new(0.1, 0.05, 0.0), reach_m: 0.1, extra: Vec3::y() }],
            reshape: Some(Reshape { turn: Vec3::new(1.0, 2.0, 3.0), scale: 0.5 }),
            origin: LayerOrigin::Keys {
                edit: "lift".into(),
                first_secs: 1.0,
                keys: Vec::new(),
                method: "physical".into(),
            },
            ..stack().remove(0)
        };
        vec![layer(0), layer(1)]
    }

    #[test]
    fn all_layers_of_an_edit_change_together() {
        let retimed = retime(&solved(), "lift", 2.0, 2.6).unwrap();
        assert_eq!((retimed[0].first_secs, retimed[0].last_secs), (2.0, 2.4));
        assert!((retimed[1].first_secs - 2.2).abs() < 1e-12 && (retimed[1].last_secs - 2.6).abs() < 1e-12);
        assert!(mute(&solved(), "lift", true).unwrap().iter().all(|layer| layer.muted));
        assert!(remove(&solved(), "lift").unwrap().is_empty());
        assert!(matches!(retime(&solved(), "lift", 2.0, 2.0), Err(EditError::BadChange { .. })));
    }

    /// Left is y. A reflection keeps the turn about the axis that it turns round, and reverses the others.
    #[test]
    fn a_mirrored_edit_does_the_same_on_the_other_side() {
        let changes = [StackChange::Mirror { edit: "lift".into() }];
        let mirrored = change_stack(&solved(), &changes).unwrap();
        assert_eq!(mirrored[..2], solved()[..]);
        let copy = &mirrored[3];
        assert_eq!((copy.id.as_str(), copy.edit_id()), ("lift-mirrored/2", "lift-mirrored"));
        assert_eq!(copy.handles[0].center_m, Vec3::new(0.1, -0.05, 0.0));
        assert_eq!(copy.handles[0].extra, -Vec3::y());
        assert_eq!(copy.reshape.unwrap().turn, Vec3::new(-1.0, 2.0, -3.0));
    }
}
