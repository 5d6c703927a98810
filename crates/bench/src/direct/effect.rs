use crate::{Cell, Cost};
use tousle_direct::SolvedOutcome;
use tousle_edit::{Change, EditEffects, StrandEffect};

/// What a drag did to the strands, whatever keys it has.
#[derive(Clone, Debug, PartialEq)]
pub struct DragEffect {
    /// Whether the motion before the first key is the same to the bit.
    pub same_before: bool,
    /// Peaks of acceleration over those of the unedited motion, the largest of the dragged strands.
    pub acceleration_ratio: f64,
    /// The same of jerk.
    pub jerk_ratio: f64,
    /// Whether the keys ask for more than the usual.
    pub demanded: bool,
    /// The longest extra vector; 0 where the method does not say.
    pub strongest: f64,
    /// How far strands moved that stayed 10 cm outside the reach, mm.
    pub far_mm: f64,
    /// What it cost to make.
    pub cost: Cost,
}

impl DragEffect {
    /// What edits did of which the first begins at a time, s; `outcome`: what its solver says of it.
    pub(super) fn new(
        effects: &EditEffects,
        first_secs: f64,
        outcome: Option<&SolvedOutcome>,
        cost: Cost,
    ) -> Self {
        let strands = &effects.edits[0].strands;
        Self {
            same_before: effects.first_change_secs.is_none_or(|secs| secs > first_secs),
            acceleration_ratio: largest(strands, |strand| strand.peak_acceleration),
            jerk_ratio: largest(strands, |strand| strand.peak_jerk),
            demanded: outcome.is_some_and(|outcome| outcome.peaks_demanded),
            strongest: outcome.map_or(0.0, |outcome| outcome.strongest),
            far_mm: effects.most_moved_far.as_ref().map_or(0.0, |moved| moved.mm),
            cost,
        }
    }

    /// Whether a strand moves more violently than it may.
    pub fn is_violent(&self) -> bool {
        f64::max(self.acceleration_ratio, self.jerk_ratio) > 1.5
    }

    /// The columns of [`DragEffect::cells`].
    pub(super) const COLUMNS: [&str; 5] =
        ["acceleration ratio", "jerk ratio", "demanded", "strongest m/s", "10 cm off mm"];

    pub(super) fn cells(&self) -> [Cell; 5] {
        [
            Cell::number(self.acceleration_ratio, 2),
            Cell::number(self.jerk_ratio, 2),
            Cell::text(if self.demanded { "yes" } else { "" }),
            Cell::number(self.strongest, 1),
            Cell::number(self.far_mm, 3),
        ]
    }

    /// The columns of [`DragEffect::summary`].
    pub(super) const SUMMARY: [&str; 6] = [
        "same before",
        "acceleration ratio, worst",
        "jerk ratio, worst",
        "over 1.5",
        "and not demanded",
        "10 cm off, most mm",
    ];

    /// What many drags did.
    pub(super) fn summary(effects: &[&Self]) -> [Cell; 6] {
        let count = |is_so: &dyn Fn(&Self) -> bool| {
            Cell::number(effects.iter().filter(|effect| is_so(effect)).count() as f64, 0)
        };
        let worst = |value: &dyn Fn(&Self) -> f64, decimals| {
            Cell::maybe(effects.iter().map(|effect| value(effect)).max_by(f64::total_cmp), decimals)
        };
        [
            count(&|effect| effect.same_before),
            worst(&|effect| effect.acceleration_ratio, 2),
            worst(&|effect| effect.jerk_ratio, 2),
            count(&Self::is_violent),
            count(&|effect| effect.is_violent() && !effect.demanded),
            worst(&|effect| effect.far_mm, 3),
        ]
    }
}

/// The largest of some strands' peaks over those of the unedited motion.
fn largest(strands: &[StrandEffect], peak: impl Fn(&StrandEffect) -> Change) -> f64 {
    strands.iter().map(peak).map(|change| change.after / change.before.max(1e-9)).fold(0.0, f64::max)
}
