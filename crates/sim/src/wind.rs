//! Asking the field, the same way for every method.

use tousle_field::{Moment, SAMPLED_AT_ONCE};

/// Components of some points or vectors, row after row of x, y and z.
type Rows = [[f32; SAMPLED_AT_ONCE]; 3];

/// [`Moment::sample_many`], compiled for the widest registers of the machine it runs on; once, whatever lanes ask.
#[inline(never)]
pub(crate) fn sample(moment: &Moment<'_>, points_m: &Rows) -> Rows {
    pulp::Arch::new().dispatch(Sample { moment, points_m })
}

struct Sample<'a, 'b> {
    moment: &'a Moment<'b>,
    points_m: &'a Rows,
}

impl pulp::NullaryFnOnce for Sample<'_, '_> {
    type Output = Rows;

    #[inline(always)]
    fn call(self) -> Rows {
        self.moment.sample_many(self.points_m)
    }
}
