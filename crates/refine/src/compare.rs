//! Simulated markers beside seen ones.

use crate::Measured;
use crate::report::Round;
use tousle_core::{StrandMotion, Track, Vec3};
use tousle_field::FieldSequence;

/// Simulated markers, and how far the seen ones are from them.
pub(crate) struct Compared {
    /// The simulated markers: lock after lock of the session, at the capture's frames.
    pub(crate) markers: StrandMotion,
    /// The field that they were simulated in.
    pub(crate) field: FieldSequence,
    frame_rate_hz: f64,
    /// By lock of the session: how far its markers went from where they were seen first, root mean square, m.
    went_m: Vec<Option<f64>>,
    /// By lock of the session, marker and frame: seen less simulated, head space, m; `None` where no camera saw it, or before
    /// anything moved.
    off_m: Vec<Vec<Vec<Option<Vec3>>>>,
}

/// Distance, m, at which a lock is half lost: what is true of the simulated one need not be of the seen one.
const LOST_M: f64 = 0.03;

/// Compares from the end of the still interval on.
pub(crate) fn compare(measured: &Measured<'_>, markers: StrandMotion, field: FieldSequence) -> Compared {
    let head = measured.head;
    let still = measured.session.still_range(head.first_frame, head.n_frames());
    let from = still.map_or(0, |(_, last)| last + 1);
    let mut off_m: Vec<Vec<Vec<Option<Vec3>>>> = vec![Vec::new(); measured.session.strands.len()];
    let mut went_m = vec![None; off_m.len()];
    for strand in &head.strands {
        let idx = strand.strand_idx;
        let first: usize = markers.counts[..idx].iter().sum();
        let off = |marker: usize, frame: usize| {
            let seen = measured.origins.is_none_or(|o| o[idx][marker][frame].kind.is_seen());
            let seen = strand.markers[marker].at(frame).filter(|_| seen && frame >= from)?;
            let place = markers.positions_m.get(frame * markers.n_points() + first + marker)?;
            Some(seen - Vec3::from(place.map(f64::from))).filter(|off| off.norm().is_finite())
        };
        off_m[idx] = (0..strand.markers.len())
            .map(|marker| (0..head.n_frames()).map(|frame| off(marker, frame)).collect())
            .collect();
        went_m[idx] = went(&strand.markers, from);
    }
    Compared { markers, field, frame_rate_hz: head.rate_hz, went_m, off_m }
}

/// `None` of nothing.
fn geometric_mean(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let logs: Vec<f64> = numbers.map(libm::log).collect();
    (!logs.is_empty()).then(|| libm::exp(logs.iter().sum::<f64>() / logs.len() as f64))
}

/// How far markers went from where they were seen first from a frame on, root mean square, m.
fn went(markers: &[Track], from: usize) -> Option<f64> {
    let (mut n, mut sum) = (0, 0.0);
    for track in markers {
        let mut seen = (from..track.n_frames()).filter_map(|frame| track.at(frame));
        let Some(first) = seen.next() else { continue };
        for place in seen {
            (n, sum) = (n + 1, sum + (place - first).norm_squared());
        }
    }
    (n > 0).then(|| (sum / f64::from(n)).sqrt())
}

impl Compared {
    /// A lock's markers: by marker and frame.
    pub(crate) fn lock(&self, strand_idx: usize) -> &[Vec<Option<Vec3>>] {
        &self.off_m[strand_idx]
    }

    /// How far the locks are off that are held out, and the others.
    pub(crate) fn round(&self, held_out: &[usize]) -> Round {
        let mean = |is_held_out: bool| {
            let locks = (0..self.off_m.len()).filter(|idx| held_out.contains(idx) == is_held_out);
            geometric_mean(locks.filter_map(|idx| self.rms_m(idx)))
        };
        Round {
            seen_m: mean(false).unwrap_or(f64::INFINITY),
            held_out_m: mean(true),
            share_of_motion: self.share_of_motion(),
        }
    }

    /// How far the locks are off over how far they went: geometric mean over locks. 1 is as good as never moving.
    pub(crate) fn share_of_motion(&self) -> f64 {
        let share = |idx: usize| Some(self.rms_m(idx)? / self.went_m[idx]?.max(1e-5));
        geometric_mean((0..self.off_m.len()).filter_map(share)).unwrap_or(1.0)
    }

    /// Root mean square over a lock's markers and frames; `None` if nothing of it was seen.
    pub(crate) fn rms_m(&self, strand_idx: usize) -> Option<f64> {
        let squares = self.off_m[strand_idx].iter().flatten().flatten().map(Vec3::norm_squared);
        let (n, sum) = squares.fold((0, 0.0), |(n, sum), square| (n + 1, sum + square));
        (n > 0).then(|| f64::max((sum / f64::from(n)).sqrt(), 1e-5))
    }

    /// How far a lock's simulated motion stands for its seen one at a step: 1 where they agree, towards 0 where they are apart.
    pub(crate) fn nearness(&self, strand_idx: usize, step: usize, rate_hz: f64) -> f64 {
        let frame = (step as f64 / rate_hz * self.frame_rate_hz).round() as usize;
        let squares: Vec<f64> = self.off_m[strand_idx]
            .iter()
            .filter_map(|marker| marker.get(frame).copied().flatten())
            .map(|off| off.norm_squared())
            .collect();
        let square = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
        1.0 / (1.0 + square / (LOST_M * LOST_M))
    }
}
