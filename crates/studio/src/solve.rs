//! The one place where a wanted edit becomes layers: what stands behind it can change here and nowhere else.

use tousle_core::StrandMotion;
use tousle_direct::{DirectError, DirectOptions, Drag, EditMethod, Made, SolvedOutcome, Stage};
use tousle_edit::{
    Action, DEFAULT_REACH_M, Edit, EditList, KeyTime, WindEdit, find_keys, free_id, make_layers_on,
    wind_layer,
};
use tousle_field::{Ease, FieldLayer};

/// An edit that the stack should have.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// What is asked for.
    pub asked: Asked,
    /// The edit that it replaces, by its id; `None` to put a new one on top.
    pub replaces: Option<String>,
}

/// What can be asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum Asked {
    /// A strand is pulled.
    Pull(Edit),
    /// The wind is changed at some place.
    Wind(WindEdit),
}

/// A wanted edit as layers.
#[derive(Clone, Debug, PartialEq)]
pub struct Solved {
    /// The edit's id.
    pub id: String,
    /// Its layers.
    pub layers: Vec<FieldLayer>,
    /// What became of a pull.
    pub outcome: Option<Made>,
}

impl Asked {
    /// The edit's name.
    pub fn name(&self) -> &str {
        match self {
            Self::Pull(edit) => &edit.name,
            Self::Wind(edit) => &edit.name,
        }
    }

    /// Its first and last key, s; here they are never frames of a list.
    pub fn span_secs(&self) -> [f64; 2] {
        let keys = match self {
            Self::Pull(edit) => [edit.first, edit.second],
            Self::Wind(edit) => [edit.first, edit.last],
        };
        keys.map(|key| key.secs(None).unwrap_or_default())
    }

    /// Gives it other keys, s.
    pub fn set_span_secs(&mut self, keys_secs: [f64; 2]) {
        let keys = keys_secs.map(KeyTime::Secs);
        match self {
            Self::Pull(edit) => [edit.first, edit.second] = keys,
            Self::Wind(edit) => [edit.first, edit.last] = keys,
        }
    }

    /// How far from its place it has faded to nothing, m.
    pub fn reach_m(&mut self) -> Option<&mut f64> {
        match self {
            Self::Pull(Edit { action: Action::Drag(drag), .. }) => Some(&mut drag.reach_m),
            Self::Pull(_) => None,
            Self::Wind(edit) => Some(&mut edit.reach_m),
        }
    }

    /// How it comes and goes.
    pub fn ease(&mut self) -> &mut Ease {
        match self {
            Self::Pull(edit) => &mut edit.ease,
            Self::Wind(edit) => &mut edit.ease,
        }
    }
}

/// Makes the layers of a wanted edit. A pull is solved for in a field of wind, and made by the paper's E4 in one of
/// forces.
///
/// In: what is simulated, the other layers of the stack, the motion that the groom has under them, and the edit.
/// `warm`: the last answer, from which a drag that goes on begins, and which is replaced by the new one.
///
/// # Errors
/// [`DirectError`] if the edit names what is not there or cannot be simulated.
pub fn solve(
    stage: &Stage<'_>,
    others: &[FieldLayer],
    motion: &StrandMotion,
    wanted: &Wanted,
    warm: &mut Option<tousle_direct::Solved>,
) -> Result<Solved, DirectError> {
    let taken: Vec<String> = others.iter().map(|layer| layer.edit_id().to_owned()).collect();
    let id = wanted.replaces.clone().unwrap_or_else(|| free_id(wanted.asked.name(), &taken));
    match &wanted.asked {
        Asked::Wind(edit) => {
            let list = EditList { winds: vec![edit.clone()], ..EditList::new() };
            let layers = vec![wind_layer(&list, 1, id.clone())?];
            Ok(Solved { id, layers, outcome: None })
        }
        Asked::Pull(edit) => pull(stage, others, motion, edit, id, warm),
    }
}

/// The layers of a pull.
fn pull(
    stage: &Stage<'_>,
    others: &[FieldLayer],
    motion: &StrandMotion,
    edit: &Edit,
    id: String,
    warm: &mut Option<tousle_direct::Solved>,
) -> Result<Solved, DirectError> {
    let list = EditList { edits: vec![edit.clone()], ..EditList::new() };
    let options = DirectOptions::for_quantity(stage.field.quantity);
    if options.method == EditMethod::Paper {
        let Stage { field, scene, groom, .. } = stage;
        let mut made = make_layers_on(field, others, scene, groom, motion, &list, &options.paper)?;
        made.layers.iter_mut().for_each(|layer| layer.id.clone_from(&id));
        // One edit was asked for, so there is one outcome.
        let outcome = Made::Paper(made.report.edits.remove(0));
        return Ok(Solved { id, layers: made.layers, outcome: Some(outcome) });
    }
    list.check()?;
    let reach_m = match &edit.action {
        Action::Drag(asked) => asked.reach_m,
        _ => DEFAULT_REACH_M,
    };
    let keys = find_keys(&list, 1, stage.groom, motion)?;
    let drag = Drag {
        name: edit.name.clone(),
        edit_id: id.clone(),
        muted: edit.muted,
        first_secs: edit.first.secs(None).unwrap_or_default(),
        keys,
        reach_m,
    };
    let before = warm.as_ref().filter(|before| is_same_drag(before, &drag, stage));
    let solved = tousle_direct::solve(stage, others, &drag, before, &options)?;
    let (layers, outcome) = (solved.layers.clone(), Made::Physical(solved.outcome.clone()));
    *warm = Some(solved);
    Ok(Solved { id, layers, outcome: Some(outcome) })
}

/// Whether an answer is of the same points at the same times, and only the targets may differ.
fn is_same_drag(before: &tousle_direct::Solved, drag: &Drag, stage: &Stage<'_>) -> bool {
    let SolvedOutcome { first_secs, keys, .. } = &before.outcome;
    *first_secs == drag.first_secs
        && keys.len() == drag.keys.len()
        && keys.iter().zip(&drag.keys).all(|(a, b)| {
            a.key.strand == stage.groom.strands[b.strand_idx].name
                && a.key.control_point == b.control_point
                && a.key.secs == b.secs
        })
}
