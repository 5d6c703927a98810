//! A list of edits to layers.

use crate::solve::{Drag, Solved, solve};
use crate::{DirectError, DirectOptions, DirectReport, EditMethod, Made, Stage};
use tousle_core::StrandMotion;
use tousle_edit::{Action, EditList, change_stack, find_keys, free_id, wind_layer};
use tousle_field::FieldLayer;

/// A stack after some edits, and what became of each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Directed {
    /// The layers that were there, changed as the list says, and those that it adds on top, edit after edit.
    pub stack: Vec<FieldLayer>,
    /// How many of these were there.
    pub n_before: usize,
    /// What each drag became.
    pub report: DirectReport,
}

impl Directed {
    /// The layers that the list added.
    pub fn added(&self) -> &[FieldLayer] {
        &self.stack[self.n_before..]
    }
}

/// Applies a list of edits to a stack of layers.
///
/// In: what is simulated, the layers that are on its field already, the motion of the groom under these, and the
/// edits. Out: the new stack: changes are made first, then winds are put on top, then drags. By
/// [`EditMethod::Physical`] each drag is solved for with all before it in place, to what the list asks of the given
/// motion; by [`EditMethod::Paper`] each is made from the given motion and knows nothing of the others.
///
/// # Errors
/// [`DirectError`] if the motion is not of this groom, an edit names what is not there, or a strand cannot be
/// simulated. A key out of reach is no error but [`Made::unreachable`].
pub fn apply(
    stage: &Stage<'_>,
    layers: &[FieldLayer],
    unedited: &StrandMotion,
    edits: &EditList,
    options: &DirectOptions,
) -> Result<Directed, DirectError> {
    let mut stack = change_stack(layers, &edits.changes)?;
    let n_before = stack.len();
    if options.method == EditMethod::Paper {
        let Stage { field, scene, groom, .. } = stage;
        let made = tousle_edit::make_layers_on(field, &stack, scene, groom, unedited, edits, &options.paper)?;
        stack.extend(made.layers);
        let edits = made.report.edits.into_iter().map(Made::Paper).collect();
        return Ok(Directed { stack, n_before, report: DirectReport { edits } });
    }
    edits.check()?;
    for (k, wind) in edits.winds.iter().enumerate() {
        stack.push(wind_layer(edits, k + 1, new_id(&wind.name, &stack))?);
    }
    let mut report = DirectReport::default();
    for (k, edit) in edits.edits.iter().enumerate() {
        let Action::Drag(asked) = &edit.action else { continue };
        let drag = Drag {
            name: edit.name.clone(),
            edit_id: new_id(&edit.name, &stack),
            muted: edit.muted,
            first_secs: edits.keys_secs(k + 1)?.0,
            keys: find_keys(edits, k + 1, stage.groom, unedited)?,
            reach_m: asked.reach_m,
        };
        let Solved { layers, outcome, .. } = solve(stage, &stack, &drag, None, options)?;
        stack.extend(layers);
        report.edits.push(Made::Physical(outcome));
    }
    Ok(Directed { stack, n_before, report })
}

/// An id for an edit, unlike those of a stack.
fn new_id(name: &str, stack: &[FieldLayer]) -> String {
    let taken: Vec<String> = stack.iter().map(|layer| layer.edit_id().to_owned()).collect();
    free_id(name, &taken)
}
