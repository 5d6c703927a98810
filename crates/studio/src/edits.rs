//! The stack as a person sees it: edits, each made of one layer or several. Only here is it asked what layers are of.

use crate::instant;
use crate::solve::{Asked, Wanted};
use tousle_core::{Groom, StrandMotion, Vec3};
use tousle_edit::{Action, ControlPoint, DEFAULT_REACH_M, Drag, Edit, Key, KeyTime, Target, WindEdit};
use tousle_field::{Ease, FieldLayer, LayerOrigin};

/// One edit of a stack.
#[derive(Clone, Debug, PartialEq)]
pub struct StackedEdit {
    /// Its id, unique in the stack.
    pub id: String,
    /// Its name.
    pub name: String,
    /// Whether it does nothing for now.
    pub muted: bool,
    /// From when to when it changes anything, s.
    pub span_secs: [f64; 2],
    /// How much of it is there, at even times of its span, 0 to 1.
    pub presence: Vec<f64>,
    /// How it comes and goes.
    pub ease: Ease,
    /// How far from its handles it has faded to nothing, m.
    pub reach_m: f64,
    /// How it changes the wind at some place; `None` for a pull.
    pub wind: Option<WindEdit>,
    /// What it pulls; `None` for an edit of the wind itself.
    pub pull: Option<Pull>,
    /// What else it pulls: `tousle edit` can ask for several points at once.
    pub also: Vec<Pull>,
    /// Which method made it.
    pub method: String,
}

/// What an edit pulls, and where to.
#[derive(Clone, Debug, PartialEq)]
pub struct Pull {
    /// The strand's name.
    pub strand: String,
    /// Its control point, from the root.
    pub point: usize,
    /// When it should be at the target, s.
    pub secs: f64,
    /// Where it should be, head space, m.
    pub target_m: Vec3,
}

/// In how many even times a span is cut to show how an edit comes and goes.
const N_TIMES: usize = 24;

/// All edits of a stack, bottom first.
pub fn edits(stack: &[FieldLayer]) -> Vec<StackedEdit> {
    let mut ids: Vec<&str> = Vec::new();
    for layer in stack {
        if !ids.contains(&layer.edit_id()) {
            ids.push(layer.edit_id());
        }
    }
    ids.into_iter().filter_map(|id| edit(stack, id)).collect()
}

/// The edit of a stack with this id.
pub fn edit(stack: &[FieldLayer], id: &str) -> Option<StackedEdit> {
    let layers: Vec<&FieldLayer> = stack.iter().filter(|layer| layer.edit_id() == id).collect();
    let first = *layers.first()?;
    let asked_first = match &first.origin {
        LayerOrigin::Keys { first_secs, .. } => *first_secs,
        _ => f64::INFINITY,
    };
    let span_secs = [
        layers.iter().map(|layer| layer.first_secs).fold(asked_first, f64::min),
        layers.iter().map(|layer| layer.last_secs).fold(f64::NEG_INFINITY, f64::max),
    ];
    let method = match &first.origin {
        LayerOrigin::Drag { method, .. } | LayerOrigin::Keys { method, .. } => method.clone(),
        LayerOrigin::Wind { action } => action.clone(),
        LayerOrigin::Mirrored { of, .. } => format!("{of} mirrored"),
    };
    let mut pulls = first.keys().into_iter().map(|key| Pull {
        strand: key.strand,
        point: key.control_point,
        secs: key.secs,
        target_m: key.target_m,
    });
    Some(StackedEdit {
        id: id.to_owned(),
        name: first.name.clone(),
        muted: first.muted,
        span_secs,
        presence: presence(&layers, span_secs),
        ease: first.ease,
        reach_m: first.handles.first().map_or(DEFAULT_REACH_M, |handle| handle.reach_m),
        wind: WindEdit::of_layer(first),
        pull: pulls.next(),
        also: pulls.collect(),
        method,
    })
}

/// How much of some layers is there, muted or not.
fn presence(layers: &[&FieldLayer], [first, last]: [f64; 2]) -> Vec<f64> {
    let at = |k: usize| {
        let secs = first + (last - first) * k as f64 / N_TIMES as f64;
        let shares = layers.iter().map(|l| (l.ease, (secs - l.first_secs) / (l.last_secs - l.first_secs)));
        let there = shares.filter(|(_, share)| (0.0..=1.0).contains(share));
        there.map(|(ease, share)| ease.presence(share)).fold(0.0, f64::max)
    };
    (0..=N_TIMES).map(at).collect()
}

/// A stack without one of its edits.
pub fn without(stack: &[FieldLayer], id: &str) -> Vec<FieldLayer> {
    stack.iter().filter(|layer| layer.edit_id() != id).cloned().collect()
}

/// A stack with an edit's layers in the place of another edit's, or on top if there is no such.
pub fn put(stack: &[FieldLayer], replaces: Option<&str>, layers: Vec<FieldLayer>) -> Vec<FieldLayer> {
    let place = replaces.and_then(|id| stack.iter().position(|layer| layer.edit_id() == id));
    let mut others = replaces.map_or_else(|| stack.to_vec(), |id| without(stack, id));
    let place = place.unwrap_or(others.len());
    others.splice(place..place, layers);
    others
}

impl Pull {
    /// The pull as an edit asks for it.
    fn key(&self) -> Key {
        Key {
            strand: self.strand.clone(),
            control_point: ControlPoint::Index(self.point as u32),
            time: KeyTime::Secs(self.secs),
            target: Target::At(self.target_m),
        }
    }
}

impl StackedEdit {
    /// What it was made from, to be made again with something changed; `None` where nobody can tell, as of mirrored ones.
    pub fn wanted_again(&self) -> Option<Wanted> {
        let asked = match &self.wind {
            Some(wind) => Asked::Wind(wind.clone()),
            None => Asked::Pull(self.pulled_again()?),
        };
        Some(Wanted { asked, replaces: Some(self.id.clone()) })
    }

    fn pulled_again(&self) -> Option<Edit> {
        let Pull { strand, point, secs, target_m } = self.pull.clone()?;
        let drag = Drag {
            strand,
            control_point: ControlPoint::Index(point as u32),
            target: Target::At(target_m),
            reach_m: self.reach_m,
            also: self.also.iter().map(Pull::key).collect(),
        };
        Some(Edit {
            name: self.name.clone(),
            first: KeyTime::Secs(self.span_secs[0]),
            second: KeyTime::Secs(secs),
            ease: self.ease,
            muted: self.muted,
            action: Action::Drag(drag),
        })
    }

    /// The index of the strand that it pulls, if this groom has it.
    pub fn strand_idx(&self, groom: &Groom) -> Option<usize> {
        let pull = self.pull.as_ref()?;
        let found = groom.strands.iter().position(|strand| strand.name == pull.strand)?;
        (pull.point < groom.strands[found].rest_curve_m.len()).then_some(found)
    }

    /// Where a motion has the pulled point at a time, head space, m.
    pub fn point_at(&self, motion: &StrandMotion, groom: &Groom, secs: f64) -> Option<Vec3> {
        let (strand_idx, pull) = (self.strand_idx(groom)?, self.pull.as_ref()?);
        let first: usize = motion.counts[..strand_idx].iter().sum();
        instant::points_at(motion, secs).get(first + pull.point).copied().map(instant::single)
    }

    /// How far from its target a motion has the pulled point at the key, mm.
    pub fn residual_mm(&self, motion: &StrandMotion, groom: &Groom) -> Option<f64> {
        let pull = self.pull.as_ref()?;
        Some((self.point_at(motion, groom, pull.secs)? - pull.target_m).norm() * 1e3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    #[test]
    fn an_edit_is_replaced_in_its_place() {
        let stack = ["a", "b", "c"].map(testing::layer);
        let new = vec![testing::layer("d"), testing::layer("e")];
        let ids = |stack: &[FieldLayer]| stack.iter().map(|l| l.id.clone()).collect::<Vec<_>>().concat();
        assert_eq!(ids(&put(&stack, Some("b"), new.clone())), "adec");
        assert_eq!(ids(&put(&stack, None, new.clone())), "abcde");
        assert_eq!(ids(&put(&stack, Some("z"), new)), "abcde");
        assert_eq!(ids(&without(&stack, "a")), "bc");
    }

    #[test]
    fn an_edit_says_what_it_pulls_and_how_far_it_is_off() {
        let (stack, groom) = ([testing::layer("lift")], testing::groom());
        let [edit] = &edits(&stack)[..] else { panic!("one edit") };
        assert_eq!((edit.span_secs, edit.strand_idx(&groom)), ([0.2, 0.8], Some(0)));
        assert_eq!((edit.presence[0], edit.presence[24]), (0.0, 0.0));
        assert!((edit.presence[12] - 1.0).abs() < 1e-12);
        let rest = groom.strands.iter().flat_map(|s| &s.rest_curve_m).map(|p| p.map(|c| c as f32).into());
        let motion =
            StrandMotion { counts: groom.counts(), times_secs: vec![0.0], positions_m: rest.collect() };
        // From (0.1, 0, -0.1) to (0.13, 0, -0.09).
        assert!((edit.residual_mm(&motion, &groom).unwrap() - 1000f64.sqrt()).abs() < 1e-3);
        let again = edit.wanted_again().unwrap();
        assert_eq!((again.asked.span_secs(), again.replaces.as_deref()), ([0.2, 0.8], Some("lift")));
    }
}
