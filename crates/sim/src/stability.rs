//! How long a step an explicit integrator stands.

use crate::timeline::Timeline;
use crate::{Integrator, Precision, SimError, SimOptions};
use tousle_core::{Assumption, Groom, Vec3};
use tousle_field::{FieldLayer, FieldSequence};

/// The longest step for a groom, and what sets it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limit {
    /// The longest step, s.
    pub dt_secs: f64,
    /// Index of the strand.
    pub strand_idx: usize,
    /// Index of the control point at the far end of the joint's stick, where one joint sets it.
    pub point: Option<usize>,
    /// A strand that bending does not keep from cracking like a whip; for such hair the limit is a hope.
    pub limp_idx: Option<usize>,
}

impl Limit {
    /// The limit of both.
    pub fn and(self, other: Self) -> Self {
        let tighter = if other.dt_secs < self.dt_secs { other } else { self };
        Self { limp_idx: self.limp_idx.or(other.limp_idx), ..tighter }
    }

    /// Cuts a timeline's frames into steps as long as it allows, or as are asked for.
    pub fn cut(
        &self,
        timeline: &mut Timeline<'_>,
        groom: &Groom,
        options: &SimOptions,
    ) -> Result<(), SimError> {
        let default_secs = f64::min(SimOptions::DEFAULT_DT_SECS, self.dt_secs);
        timeline.cut(options.dt_secs, default_secs)?;
        if timeline.dt_secs() > self.dt_secs {
            return Err(SimError::Unstable {
                integrator: options.integrator().name(),
                dt_secs: timeline.dt_secs(),
                limit_secs: self.dt_secs,
                strand: groom.strands[self.strand_idx].name.clone(),
                point: self.point,
            });
        }
        Ok(())
    }

    /// What is assumed of hair that may crack like a whip.
    pub fn hope(&self, integrator: Integrator, groom: &Groom, dt_secs: f64) -> Option<Assumption> {
        let strand = &groom.strands[self.limp_idx?].name;
        Some(Assumption {
            what: format!("stability of {}", integrator.name()),
            value: format!("steps of {dt_secs:.3e} s hold"),
            why: format!(
                "{strand} is limp: when it cracks like a whip no explicit step is sure to be short enough"
            ),
        })
    }
}

/// Refuses steps that are too short for the digits that are computed with.
pub(crate) fn check_digits(
    precision: Precision,
    dt_secs: f64,
    shortest_single_secs: f64,
) -> Result<(), SimError> {
    // A frame's share may be shorter by a rounding.
    let is_too_short = dt_secs < shortest_single_secs * (1.0 - 1e-9);
    if precision == Precision::Single && is_too_short {
        return Err(SimError::TooShort { dt_secs, limit_secs: shortest_single_secs });
    }
    Ok(())
}

/// An integrator's limit for a groom, for the report.
pub(crate) fn in_words(limit: Option<&Limit>, groom: &Groom) -> String {
    let Some(limit) = limit else { return "none: no step is too long or too stiff".to_owned() };
    let point = limit.point.map(|point| format!(", control point {point}")).unwrap_or_default();
    format!("{:.3e} s, set by strand {}{point}", limit.dt_secs, groom.strands[limit.strand_idx].name)
}

/// The longest vector of a field under some layers, which are laid one on the other: each makes what is below it longer, if it
/// does not make it shorter, and adds its own.
pub(crate) fn strongest_vector(field: &FieldSequence, layers: &[FieldLayer]) -> f64 {
    let step = |step: &tousle_field::Field| {
        (0..step.flags.len()).map(|voxel| step.vector(voxel).norm()).fold(step.outside.norm(), f64::max)
    };
    let under = |strongest: f64, layer: &FieldLayer| {
        let extra = layer.handles.iter().map(|h| Vec3::norm(&h.extra)).fold(0.0, f64::max);
        strongest * layer.reshape.map_or(1.0, |reshape| f64::max(reshape.scale, 1.0)) + extra
    };
    let strongest = field.steps.iter().map(step).fold(0.0, f64::max);
    layers.iter().filter(|layer| !layer.does_nothing()).fold(strongest, under)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_bench::worlds::{gusts, push};
    use tousle_field::{Handle, Reshape};

    /// A layer that makes the wind five times as strong, one that adds 2 m/s to that, and one that is muted.
    #[test]
    fn layers_make_the_strongest_vector_longer() {
        let field = gusts();
        let layer = |reshape, extra| {
            let handle = Handle { center_m: Vec3::zeros(), reach_m: 0.1, extra };
            FieldLayer { reshape, ..push(handle, (0.0, 1.0)) }
        };
        let scaled = layer(Some(Reshape { turn: Vec3::zeros(), scale: 5.0 }), Vec3::zeros());
        let calmed = layer(Some(Reshape { turn: Vec3::zeros(), scale: 0.0 }), Vec3::zeros());
        let added = layer(None, Vec3::new(0.0, 2.0, 0.0));
        let alone = strongest_vector(&field, &[]);
        let is = |layers: &[FieldLayer], expected: f64| {
            assert!((strongest_vector(&field, layers) - expected).abs() < 1e-12);
        };
        is(&[scaled.clone(), added.clone()], 5.0 * alone + 2.0);
        is(&[added.clone(), scaled], 5.0 * (alone + 2.0));
        is(&[calmed], alone);
        is(&[FieldLayer { muted: true, ..added }], alone);
    }
}
