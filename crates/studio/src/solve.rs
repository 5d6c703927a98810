//! The one place where a wanted edit becomes a layer: what stands behind it can change here and nowhere else.

use tousle_core::{Groom, StrandMotion};
use tousle_edit::{
    Action, ControlPoint, DEFAULT_REACH_M, Drag, Edit, EditError, EditList, EditOptions, EditOutcome,
    KeyTime, Target,
};
use tousle_field::{FieldLayer, FieldSequence, LayerOrigin, Scene};

/// An edit that the stack should have.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// What is asked for.
    pub edit: Edit,
    /// The layer that it replaces; `None` to put a new one on top.
    pub replaces: Option<String>,
}

/// A wanted edit as a layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Solved {
    /// The layer, under its id.
    pub layer: FieldLayer,
    /// What became of what was asked for.
    pub outcome: EditOutcome,
}

/// Makes the layer of a wanted edit.
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
    Ok(Solved { layer, outcome })
}

/// The edit that a layer was made from, to be made again with something changed.
pub fn wanted_again(layer: &FieldLayer) -> Wanted {
    let LayerOrigin::Drag { strand, control_point, target_m, .. } = &layer.origin;
    let drag = Drag {
        strand: strand.clone(),
        control_point: ControlPoint::Index(*control_point as u32),
        target: Target::At(*target_m),
        reach_m: layer.handles.first().map_or(DEFAULT_REACH_M, |handle| handle.reach_m),
    };
    let edit = Edit {
        name: layer.name.clone(),
        first: KeyTime::Secs(layer.first_secs),
        second: KeyTime::Secs(layer.last_secs),
        ease: layer.ease,
        muted: layer.muted,
        action: Action::Drag(drag),
    };
    Wanted { edit, replaces: Some(layer.id.clone()) }
}
