use crate::TorsoGrip;
use crate::report::PlanEntry;
use crate::timeline::Timeline;
use tousle_core::{Body, Quantity};
use tousle_field::{FieldLayer, FieldSequence, Sampler, Scene};

/// Which terms of the equations a run has: decided once, before the first step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Terms {
    /// What the field's vectors are.
    pub quantity: Quantity,
    /// Whether any wind blows, ever.
    pub wind: bool,
    /// Whether there is air that pushes and resists.
    pub air: bool,
    /// Whether the head moves.
    pub head_movement: bool,
}

impl Terms {
    /// Whether anything is to be done for each stick's place in the wind.
    pub fn blows(&self) -> bool {
        self.air || (self.wind && self.quantity == Quantity::ForcePerMass)
    }

    /// The terms that a field, its layers left out, and a scene ask for.
    pub fn new(field: &FieldSequence, scene: &Scene, head_is_still: bool) -> Self {
        Self {
            quantity: field.quantity,
            wind: field.steps.iter().any(|s| s.outside.norm() > 0.0 || s.u.iter().any(|u| *u != 0.0)),
            air: scene.air_density > 0.0,
            head_movement: !head_is_still,
        }
    }

    /// These and what layers ask for.
    pub fn with_layers(self, layers: &[FieldLayer]) -> Self {
        let blows = layers.iter().any(|layer| !layer.muted && !layer.handles.is_empty());
        Self { wind: self.wind || blows, ..self }
    }
}

/// Every term of E1 and E2: what runs, what was left out and why. `n_reaching`: strands that can reach each collider.
pub(crate) fn plan(
    sampler: &Sampler<'_>,
    scene: &Scene,
    timeline: &Timeline<'_>,
    n_reaching: &[usize],
) -> Vec<PlanEntry> {
    let terms = &timeline.terms;
    vec![
        entry("strength", true, "each joint bends towards its natural shape, with internal damping"),
        gravity(timeline),
        wind(sampler, terms),
        air(terms),
        head_movement(timeline, terms),
        entry(
            "spring",
            true,
            "carried along the strand as the pull of what hangs further out; sticks do not stretch",
        ),
        collision(&scene.body, n_reaching),
        friction(&scene.body, timeline, n_reaching),
        edits(timeline.layers()),
    ]
}

fn entry(term: &str, active: bool, why: impl Into<String>) -> PlanEntry {
    PlanEntry { term: term.to_owned(), active, why: why.into() }
}

fn gravity(timeline: &Timeline<'_>) -> PlanEntry {
    let strength = timeline.gravity_at_rest().norm();
    if strength > 0.0 {
        entry("gravity", true, format!("{strength:.3} m/s², turned into head axes by the pose"))
    } else {
        entry("gravity", false, "the scene has none")
    }
}

fn wind(sampler: &Sampler<'_>, terms: &Terms) -> PlanEntry {
    let field = sampler.sequence();
    let blows = |how: &str| {
        let (kept, all) = (sampler.n_kept(), field.grid.n_voxels());
        entry("wind", true, format!("{how}; of {all} voxels the groom can reach {kept}"))
    };
    match terms.quantity {
        _ if !terms.wind => {
            entry("wind", false, format!("every vector of the {} field steps is zero", field.steps.len()))
        }
        Quantity::AirVelocity if !terms.air => entry("wind", false, "the air has no density to push with"),
        Quantity::AirVelocity => blows("air velocity, through the drag law, less the strand's own"),
        Quantity::ForcePerMass => blows("force per mass, as it is"),
    }
}

fn air(terms: &Terms) -> PlanEntry {
    if terms.air {
        entry("air resistance", true, "the drag law's slope, on each joint with everything further out")
    } else {
        entry("air resistance", false, "the air has no density")
    }
}

fn head_movement(timeline: &Timeline<'_>, terms: &Terms) -> PlanEntry {
    let whose =
        if timeline.shot_head().is_some() { "the shot's own poses" } else { "the field file's poses" };
    if terms.head_movement {
        entry("head movement", true, format!("{whose}: linear, angular, centrifugal, Coriolis"))
    } else {
        entry("head movement", false, format!("{whose} never change"))
    }
}

fn collision(body: &Body, n_reaching: &[usize]) -> PlanEntry {
    let reached: Vec<String> = body
        .colliders
        .iter()
        .zip(n_reaching)
        .map(|(collider, n)| format!("{} within reach of {n} strands", collider.name))
        .collect();
    if n_reaching.iter().any(|n| *n > 0) {
        entry("collision", true, reached.join(", "))
    } else if body.colliders.is_empty() {
        entry("collision", false, "the scene has no colliders")
    } else {
        entry("collision", false, "no strand reaches a collider")
    }
}

fn friction(body: &Body, timeline: &Timeline<'_>, n_reaching: &[usize]) -> PlanEntry {
    if body.friction <= 0.0 {
        entry("friction", false, "the body's coefficient is 0")
    } else if n_reaching.iter().all(|n| *n == 0) {
        entry("friction", false, "nothing to rub on")
    } else {
        let grip = match timeline.torso_grip() {
            TorsoGrip::Head => "",
            TorsoGrip::Torso => "; the torso's surface stays with the torso",
        };
        entry("friction", true, format!("Coulomb, coefficient {}{grip}", body.friction))
    }
}

fn edits(layers: &[FieldLayer]) -> PlanEntry {
    let n_muted = layers.iter().filter(|layer| layer.muted).count();
    let n_active = layers.iter().filter(|layer| !layer.does_nothing()).count();
    let idle = match layers.len() - n_active - n_muted {
        0 => String::new(),
        n => format!(", {n} that change nothing"),
    };
    if n_active > 0 {
        entry("edits", true, format!("{n_active} layers, {n_muted} muted{idle}"))
    } else {
        entry("edits", false, format!("the field has no layer that acts ({n_muted} muted{idle})"))
    }
}
