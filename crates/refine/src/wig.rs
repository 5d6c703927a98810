//! The captured wig as a hairstyle that is simulated.

use crate::{Measured, RefineError};
use tousle_core::{Groom, HeadCapture, NoProgress, Strand, StrandMotion, Vec3};
use tousle_field::FieldSequence;
use tousle_fit::{Scales, Wig};
use tousle_sim::{Method, SimOptions, TimeMode};

/// Every `n`th lock of a wig from the middle of the first `n` on, as indices in the session.
pub(crate) fn every(wig: &Wig, n: usize) -> Vec<usize> {
    wig.strand_idxs.iter().copied().skip(n / 2).step_by(n).collect()
}

/// A wig's groom with other stiffness and drag, by lock of the session.
pub(crate) fn with_scales(wig: &Wig, scales: &[Scales]) -> Groom {
    let strand = |(strand, idx): (&Strand, &usize)| {
        let Scales { stiffness, drag } = scales.get(*idx).copied().unwrap_or_default();
        Strand {
            bending_stiffness_n_m2: strand.bending_stiffness_n_m2 * stiffness,
            lock_width_m: strand.lock_width_m * drag,
            ..strand.clone()
        }
    };
    let strands = wig.groom.strands.iter().zip(&wig.strand_idxs).map(strand).collect();
    Groom { strands, assumed: Vec::new() }
}

/// The markers of a groom of the wig in a field, at the capture's frames; lock after lock of the session.
pub(crate) fn simulated(
    wig: &Wig,
    groom: &Groom,
    field: &FieldSequence,
    measured: &Measured<'_>,
) -> Result<StrandMotion, RefineError> {
    let head = measured.head;
    let options = SimOptions {
        rate_hz: head.rate_hz,
        start_secs: Some(0.0),
        duration_secs: Some((head.n_frames() as f64 - 0.5) / head.rate_hz),
        // A field's last step may lie before the last frame.
        time: TimeMode::Hold,
        ..SimOptions::of(Method::Physical)
    };
    let motion = tousle_sim::simulate(field, measured.scene, groom, &options, &NoProgress)?.motion;
    Ok(wig.markers(&motion, measured.session))
}

/// A capture whose markers are simulated ones.
pub(crate) fn capture(head: &HeadCapture, markers: &StrandMotion) -> HeadCapture {
    let mut simulated = HeadCapture { unlabeled: Vec::new(), ..head.clone() };
    let n_points = markers.n_points();
    let last = markers.times_secs.len() - 1;
    for strand in &mut simulated.strands {
        let first: usize = markers.counts[..strand.strand_idx].iter().sum();
        for (marker, track) in strand.markers.iter_mut().enumerate() {
            let place = |frame: usize| markers.positions_m[frame.min(last) * n_points + first + marker];
            *track =
                (0..head.n_frames()).map(|frame| Some(Vec3::from(place(frame).map(f64::from)))).collect();
        }
    }
    simulated
}
