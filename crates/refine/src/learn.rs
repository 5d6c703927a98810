//! What the locks are made of, from how their simulated motion answers to it.

use crate::Measured;
use crate::compare::Compared;
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};
use tousle_core::{StrandMotion, Vec3};
use tousle_fit::Scales;

/// By how much the logarithms of stiffness and drag are changed to see what it does.
pub(crate) const TRIED: [f64; 2] = [0.3, 0.1];

/// How far the logarithm of the wig's stiffness may be from the one that was sought (`stiffness`): as far as captures of known
/// stiffness are off.
const COMMON_STIFFNESS: f64 = 0.15;

/// How far a lock's may be from the wig's: as many hairs as weigh so much, more or less held together.
const OWN_STIFFNESS: f64 = 0.2;

/// How far the logarithm of a lock's drag may be from that of its width, measured to a few per cent.
const OWN_DRAG: f64 = 0.05;

/// How long a difference of seen and simulated motion lasts, s: neighboring frames say the same.
const LASTS_SECS: f64 = 0.5;

/// The longest step of a logarithm.
const LONGEST_STEP: f64 = 0.4;

/// One step of Gauss and Newton's method towards the stiffness and drag with which the simulated markers would be where they were
/// seen. In: what the locks are taken for now, by lock of the session; the seen markers beside the simulated ones; the markers
/// when all locks are stiffer, and when all are wider, by [`TRIED`].
///
/// Locks that are held out are not asked: they take the wig's common stiffness. `likely`: what all locks are taken for before
/// any is asked.
pub(crate) fn learn(
    measured: &Measured<'_>,
    likely: Scales,
    now: &[Scales],
    compared: &Compared,
    changed: [&StrandMotion; 2],
    held_out: &[usize],
) -> Vec<Scales> {
    let n = now.len();
    // Logarithms of what they are over what is likely: stiffness of all locks, then drag of all.
    let log = |i: usize| {
        if i < n { now[i].stiffness / likely.stiffness } else { now[i - n].drag / likely.drag }
    };
    let logs = DVector::from_fn(2 * n, |i, _| libm::log(log(i)));
    let mut information = prior(n);
    let mut pull = &information * -&logs;
    for idx in (0..n).filter(|idx| !held_out.contains(idx)) {
        let Some((gram, right)) = said(measured, idx, compared, changed) else { continue };
        for (a, at) in [idx, n + idx].into_iter().enumerate() {
            pull[at] += right[a];
            for (b, other) in [idx, n + idx].into_iter().enumerate() {
                information[(at, other)] += gram[(a, b)];
            }
        }
    }
    let Some(factor) = information.cholesky() else { return now.to_vec() };
    let step = factor.solve(&pull).map(|s| s.clamp(-LONGEST_STEP, LONGEST_STEP));
    (0..n)
        .map(|i| Scales {
            stiffness: likely.stiffness * libm::exp(logs[i] + step[i]),
            drag: likely.drag * libm::exp(logs[n + i] + step[n + i]),
        })
        .collect()
}

/// The precision of all logarithms before any lock is asked: locks of one wig are alike in stiffness.
fn prior(n: usize) -> DMatrix<f64> {
    let (common, own) = (COMMON_STIFFNESS * COMMON_STIFFNESS, OWN_STIFFNESS * OWN_STIFFNESS);
    // The inverse of own² I + common² 1 1ᵀ, after Sherman and Morrison.
    let shared = common / (own * (own + n as f64 * common));
    DMatrix::from_fn(2 * n, 2 * n, |r, c| match (r == c, r < n && c < n) {
        (true, true) => 1.0 / own - shared,
        (false, true) => -shared,
        (true, false) => 1.0 / (OWN_DRAG * OWN_DRAG),
        (false, false) => 0.0,
    })
}

/// What one lock says: least squares over its markers and frames, of differences that last and go together along the lock.
fn said(
    measured: &Measured<'_>,
    idx: usize,
    compared: &Compared,
    changed: [&StrandMotion; 2],
) -> Option<(Matrix2<f64>, Vector2<f64>)> {
    let rms_m = compared.rms_m(idx)?;
    let base = &compared.markers;
    let (n_points, first) = (base.n_points(), base.counts[..idx].iter().sum::<usize>());
    let markers = compared.lock(idx);
    let count_as_one = LASTS_SECS * measured.head.rate_hz * markers.len() as f64;
    let (mut gram, mut right) = (Matrix2::zeros(), Vector2::zeros());
    for (marker, frames) in markers.iter().enumerate() {
        for (frame, off) in frames.iter().enumerate() {
            let Some(off) = off else { continue };
            let at = frame * n_points + first + marker;
            let place = |motion: &StrandMotion| Vec3::from(motion.positions_m[at].map(f64::from));
            let by = [0, 1].map(|k| (place(changed[k]) - place(base)) / TRIED[k]);
            // Where a lock is lost, or falls to the other side when it is changed, nothing is linear.
            let apart =
                off.norm_squared() + (by[0] * TRIED[0]).norm_squared() + (by[1] * TRIED[1]).norm_squared();
            let weight = 1.0 / (1.0 + apart / (4.0 * rms_m * rms_m)) / (rms_m * rms_m * count_as_one);
            for a in 0..2 {
                right[a] += by[a].dot(off) * weight;
                for b in 0..2 {
                    gram[(a, b)] += by[a].dot(&by[b]) * weight;
                }
            }
        }
    }
    Some((gram, right))
}
