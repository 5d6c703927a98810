//! One round: simulate, compare, learn, measure anew.

use crate::compare::{Compared, compare};
use crate::learn::learn;
use crate::stiffness::{ROUGH_RATE_HZ, Sought, Stiffness};
use crate::wig::{capture, simulated, with_scales};
use crate::{Lay, Measured, RefineError};
use tousle_core::{HeadCapture, NoProgress, Track};
use tousle_field::FieldSequence;
use tousle_fit::{Defects, Fit, FitMethod, Scales, Taught, Wig};
use tousle_flow::AirFlow;

/// What stays the same from round to round.
pub(crate) struct Loop<'a> {
    pub(crate) measured: &'a Measured<'a>,
    /// All locks, as taken for likely.
    pub(crate) wig: &'a Wig,
    pub(crate) lay: &'a Lay<'a>,
}

/// A wind, and what the locks were made of when it was measured.
pub(crate) struct Turn {
    pub(crate) fit: Fit,
    /// What all locks are taken for before any is asked by itself.
    pub(crate) likely: Stiffness,
    scales: Vec<Scales>,
}

/// The most modes in which the first wind is measured.
const FIRST_MODES: usize = 60;

impl Loop<'_> {
    /// Whether the locks were seen at rest.
    pub(crate) fn rest_seen(&self) -> bool {
        let Measured { head, session, .. } = self.measured;
        session.still_range(head.first_frame, head.n_frames()).is_some()
    }

    /// The wig in a turn's wind beside the seen one.
    pub(crate) fn compare(&self, turn: &Turn) -> Result<Compared, RefineError> {
        let field = self.lay(&turn.fit)?;
        let groom = with_scales(self.wig, &turn.scales);
        let markers = simulated(self.wig, &groom, &field, self.measured)?;
        Ok(compare(self.measured, markers, field))
    }

    /// Learns from a comparison and measures anew, without the locks that are held out.
    ///
    /// What is learnt from is let go before that: of a long capture it is as large as all that measuring needs.
    pub(crate) fn again(
        &self,
        turn: &Turn,
        compared: Compared,
        held_out: &[usize],
    ) -> Result<Turn, RefineError> {
        let (scales, defects) =
            rayon::join(|| self.learnt(turn, &compared, held_out), || self.defects(turn, &compared));
        let taught = Taught {
            scales: scales?,
            stiffness_spread: turn.likely.spread,
            defects: defects?,
            air: turn.fit.air.as_ref().map(AirFlow::without_covariances),
        };
        drop(compared);
        Ok(Turn { fit: self.measured.fit(&taught, held_out)?, scales: taught.scales, likely: turn.likely })
    }

    /// The wind to begin with, at [`ROUGH_RATE_HZ`] and in [`FIRST_MODES`] at most: what is learnt from it for the next one changes
    /// slowly, and less than the wind itself.
    pub(crate) fn first(&self, sought: &Sought, held_out: &[usize]) -> Result<Turn, RefineError> {
        let mut options = self.measured.options.clone();
        options.rate_hz = options.rate_hz.min(ROUGH_RATE_HZ);
        if let FitMethod::Physical(physical) = &mut options.method {
            physical.max_modes = physical.max_modes.min(FIRST_MODES);
            physical.says_how_sure = false;
        }
        let measured = Measured { options: &options, ..*self.measured };
        Loop { measured: &measured, ..*self }.with_stiffness(
            sought.likely(),
            sought.nearest.as_ref(),
            held_out,
        )
    }

    /// The wind measured with all locks of one wig so stiff, starting from the air of another fit if there is one.
    pub(crate) fn with_stiffness(
        &self,
        likely: Stiffness,
        from: Option<&Fit>,
        held_out: &[usize],
    ) -> Result<Turn, RefineError> {
        let air = from.and_then(|fit| Some(fit.air.as_ref()?.without_covariances()));
        let scales = vec![likely.scales(); self.n_locks()];
        let taught = Taught { scales, stiffness_spread: likely.spread, air, ..Taught::default() };
        Ok(Turn { fit: self.measured.fit(&taught, held_out)?, likely, scales: taught.scales })
    }

    /// Locks of the session.
    fn n_locks(&self) -> usize {
        self.measured.session.strands.len()
    }

    /// What the balance leaves over of the simulated locks, as far as they stand for the seen ones; nothing without air.
    fn defects(&self, turn: &Turn, compared: &Compared) -> Result<Vec<Option<Defects>>, RefineError> {
        let Some(air) = &turn.fit.air else { return Ok(Vec::new()) };
        let Measured { head, session, options, .. } = *self.measured;
        let simulated = capture(head, &compared.markers);
        let mut defects = tousle_fit::defects(&simulated, session, options, &turn.scales, air)?;
        for (strand_idx, defects) in defects.iter_mut().enumerate() {
            let near = |step: usize| compared.nearness(strand_idx, step, options.rate_hz);
            if let Some(defects) = defects {
                defects.fade(near);
            }
        }
        Ok(defects)
    }

    fn learnt(
        &self,
        turn: &Turn,
        compared: &Compared,
        held_out: &[usize],
    ) -> Result<Vec<Scales>, RefineError> {
        let mut now = turn.scales.clone();
        now.resize(self.n_locks(), turn.likely.scales());
        let answer = |change: &(dyn Fn(&Scales) -> Scales + Sync)| -> Result<_, RefineError> {
            let changed: Vec<Scales> = now.iter().map(change).collect();
            let groom = with_scales(self.wig, &changed);
            simulated(self.wig, &groom, &compared.field, self.measured)
        };
        let [times_stiffer, times_wider] = crate::learn::TRIED.map(libm::exp);
        let (stiffer, wider) = rayon::join(
            || answer(&|s| Scales { stiffness: s.stiffness * times_stiffer, ..*s }),
            || answer(&|s| Scales { drag: s.drag * times_wider, ..*s }),
        );
        Ok(learn(self.measured, turn.likely.scales(), &now, compared, [&stiffer?, &wider?], held_out))
    }

    fn lay(&self, fit: &Fit) -> Result<FieldSequence, RefineError> {
        (self.lay)(fit, &self.measured.grid).map_err(RefineError::Lay)
    }
}

impl Measured<'_> {
    /// The wind measured without the locks that are held out.
    pub(crate) fn fit(&self, taught: &Taught, held_out: &[usize]) -> Result<Fit, RefineError> {
        let Measured { head, origins, session, options, .. } = *self;
        let hidden;
        let head = if held_out.is_empty() {
            head
        } else {
            hidden = without(head, held_out);
            &hidden
        };
        Ok(tousle_fit::fit_taught(head, origins, session, options, taught, &NoProgress)?)
    }
}

/// A capture in which some locks were never seen.
fn without(head: &HeadCapture, held_out: &[usize]) -> HeadCapture {
    let mut hidden = head.clone();
    for strand in hidden.strands.iter_mut().filter(|s| held_out.contains(&s.strand_idx)) {
        strand.markers.iter_mut().for_each(|track| *track = Track::missing(track.n_frames()));
    }
    hidden
}
