//! A field's stack of layers, changed as values.

use crate::EditError;
use tousle_field::FieldLayer;

/// The stack with one layer muted or heard again.
///
/// # Errors
/// [`EditError::NoLayer`] if no layer has this id.
pub fn mute(layers: &[FieldLayer], id: &str, muted: bool) -> Result<Vec<FieldLayer>, EditError> {
    change(layers, id, |layer| layer.muted = muted)
}

/// The stack with another name for one layer; its id stays.
///
/// # Errors
/// [`EditError::NoLayer`] if no layer has this id.
pub fn rename(layers: &[FieldLayer], id: &str, name: &str) -> Result<Vec<FieldLayer>, EditError> {
    change(layers, id, |layer| name.clone_into(&mut layer.name))
}

/// The stack without one of its layers.
///
/// # Errors
/// [`EditError::NoLayer`] if no layer has this id.
pub fn remove(layers: &[FieldLayer], id: &str) -> Result<Vec<FieldLayer>, EditError> {
    let at = find(layers, id)?;
    let mut left = layers.to_vec();
    left.remove(at);
    Ok(left)
}

fn change(
    layers: &[FieldLayer],
    id: &str,
    change: impl FnOnce(&mut FieldLayer),
) -> Result<Vec<FieldLayer>, EditError> {
    let at = find(layers, id)?;
    let mut changed = layers.to_vec();
    change(&mut changed[at]);
    Ok(changed)
}

fn find(layers: &[FieldLayer], id: &str) -> Result<usize, EditError> {
    layers.iter().position(|layer| layer.id == id).ok_or_else(|| EditError::NoLayer {
        id: id.to_owned(),
        known: layers.iter().map(|layer| layer.id.as_str()).collect::<Vec<_>>().join(", "),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::Vec3;
    use tousle_field::{Ease, LayerOrigin};

    fn stack() -> Vec<FieldLayer> {
        let layer = |id: &str| FieldLayer {
            id: id.into(),
            name: id.to_uppercase(),
            muted: false,
            first_secs: 0.0,
            last_secs: 1.0,
            ease: Ease { rise: 0.5, fall: 0.5 },
            handles: Vec::new(),
            origin: LayerOrigin::Drag {
                strand: "A".into(),
                control_point: 1,
                target_m: Vec3::zeros(),
                method: "paper".into(),
            },
        };
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
    }
}
