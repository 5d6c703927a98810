//! What a run takes for granted.

use crate::timeline::Timeline;
use tousle_core::{Assumption, Groom};

/// Says so where frames lie outside the span of the shot's head.
fn held_head(timeline: &Timeline<'_>) -> Option<Assumption> {
    let poses = timeline.shot_head()?;
    let from = poses.start_secs;
    let to = from + (poses.poses.len() - 1) as f64 / poses.rate_hz;
    let [first, last] = [timeline.frame_secs(0), timeline.frame_secs(timeline.n_frames - 1)];
    let apart = 1.0 / poses.rate_hz;
    (first < from - apart || last > to + apart).then(|| Assumption {
        what: "head before and after its motion".to_owned(),
        value: "held still in its first and last pose".to_owned(),
        why: format!("found poses from {from:.3} to {to:.3} s for frames from {first:.3} to {last:.3} s"),
    })
}

/// What the groom's reader assumed, and what this run did.
pub(crate) fn assumptions(
    groom: &Groom,
    timeline: &Timeline<'_>,
    deepest_m: impl Iterator<Item = f64>,
) -> Vec<Assumption> {
    let mut assumed = groom.assumed.clone();
    if timeline.shot_head().is_some() {
        assumed.push(Assumption {
            what: "torso".to_owned(),
            value: "faces where the head faces in the shot's first pose".to_owned(),
            why: "a pose track says nothing of the shoulders".to_owned(),
        });
    }
    assumed.extend(held_head(timeline));
    let tilt = timeline.tilt_at_start();
    if tilt > 1e-3 {
        assumed.push(Assumption {
            what: "start".to_owned(),
            value: format!("from the rest curves, with the head tilted by {:.1}°", tilt.to_degrees()),
            why: "the groom says how it hangs in the rest pose only; it settles in the first second"
                .to_owned(),
        });
    }
    let inside: Vec<f64> = deepest_m.filter(|deepest| *deepest > 0.0).collect();
    let deepest_mm = 1e3 * inside.iter().copied().fold(0.0, f64::max);
    if deepest_mm > 0.0 {
        let n = inside.len();
        assumed.push(Assumption {
            what: format!("collision of {n} strands"),
            value: format!("allowed as deep as they rest, up to {deepest_mm:.1} mm"),
            why: "their rest curves lie inside the body, and pushing them out would make them jump"
                .to_owned(),
        });
    }
    assumed
}
