//! The one place where a wanted edit becomes layers: what stands behind it can change here and nowhere else.

use tousle_core::{Groom, StrandMotion};
use tousle_edit::{Edit, EditError, EditList, EditOptions, EditOutcome};
use tousle_field::{FieldLayer, FieldSequence, Scene};

/// An edit that the stack should have.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// What is asked for.
    pub edit: Edit,
    /// The edit that it replaces, by its id; `None` to put a new one on top.
    pub replaces: Option<String>,
}

/// A wanted edit as layers.
#[derive(Clone, Debug, PartialEq)]
pub struct Solved {
    /// The edit's id.
    pub id: String,
    /// Its layers.
    pub layers: Vec<FieldLayer>,
    /// What became of what was asked for.
    pub outcome: EditOutcome,
}

/// Makes the layers of a wanted edit.
///
/// In: the field with the other layers of the stack, what it blows around, the groom, and the motion that the groom
/// has in this field.
///
/// # Errors
/// [`EditError`] if the edit names what is not there.
pub fn solve(
    field: &FieldSequence,
    scene: &Scene,
    groom: &Groom,
    motion: &StrandMotion,
    wanted: &Wanted,
) -> Result<Solved, EditError> {
    let list = EditList { edits: vec![wanted.edit.clone()], ..EditList::new() };
    let mut made = tousle_edit::make_layers(field, scene, groom, motion, &list, &EditOptions::default())?;
    let (mut layer, mut outcome) = (made.layers.remove(0), made.report.edits.remove(0));
    if let Some(id) = &wanted.replaces {
        (layer.id, outcome.layer_id) = (id.clone(), id.clone());
    }
    Ok(Solved { id: layer.id.clone(), layers: vec![layer], outcome })
}
