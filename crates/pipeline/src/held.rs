//! What a session says, held against what is seen once the head is known.
//!
//! Hair bends and does not stretch: from its root to a marker on it no lock is seen to be longer than it is, and one with markers
//! down to its tip not much shorter. Limits are wide enough for hands that measure to a centimeter and for hair that is not straight
//! between two markers; what lies beyond them is another unit, another lock, or a slip of the pen.

use nalgebra::{ComplexField, RealField};
use std::ops::RangeInclusive;
use tousle_core::{
    Attachment, Collider, Fan, FrameSpan, HeadCapture, Pose, Session, Shape, StrandSpec, Track, Vec3,
    median_high,
};
use tousle_head::{Located, MarkerReport};

/// How much longer than the hair the way along the markers may seem: a tape is laid along hair with an error of some percent, and
/// two places on it are off by a centimeter together.
const MOST_SEEN: f64 = 1.25;
const MEASURING_SLACK_M: f64 = 0.01;

/// How short the way along the markers may be for hair of 1: between two markers half a circle is 0.64 of its arc. A single marker
/// halfway down a lock, taken for its tip as nobody measured where it is, is told too.
const LEAST_SEEN: f64 = 0.6;

/// Beyond this ratio nothing fits: the lock is another one, or its lengths are in another unit.
const MOST_RATIO: f64 = 4.0;

/// How far down a lock its last marker sits, at least: what hangs below is not seen to move, and is made up.
const LEAST_REACH: f64 = 0.5;

/// A root farther than this from all head markers and from the head's center is not on a head, m.
const FARTHEST_ROOT_M: f64 = 0.3;

/// How far from the head's center roots may lie, as a share of the way to its surface: on a wig's cap they are a tenth farther out, and
/// hands measure heads to a tenth. Full axes given for half axes make it 0.5.
const ROOTS_ON_HEAD: RangeInclusive<f64> = 0.75..=1.35;

/// Beyond these shares the head or its roots are in another unit.
const ROOTS_NEAR_HEAD: RangeInclusive<f64> = 0.5..=2.0;

/// How far a head marker's still mean may be from the session's place before someone should look, m: ten times what hands measure wrong.
const MOST_CORRECTION_M: f64 = 0.02;

/// The most that a marker may move in the still frames before a warning, rms, m: ten times the cameras' noise.
const STILL_M: f64 = 3e-3;

/// How far the two directions that a session gives for one fan may be apart, rad: a fan's azimuth is set by eye.
const MOST_FAN_ANGLE: f64 = 20.0 * std::f64::consts::PI / 180.0;

/// Warnings of all that can be used and does not fit; the error is a list of the locks of which nothing fits, or the head if its roots are
/// nowhere near it.
pub(crate) fn hold_against(session: &Session, located: &Located) -> Result<Vec<String>, String> {
    let mut warnings = head_markers(&located.report.markers);
    warnings.extend(head_collider(session)?);
    warnings.extend(locks(session, &located.head)?);
    let still = session.still_range(located.head.first_frame, located.head.n_frames());
    warnings.extend(still.and_then(|still| moves_at_rest(&located.head, still)));
    if still.is_some() || !located.report.pose_track.moves {
        warnings.extend(fans(session, &located.tracked.rest_pose));
    }
    Ok(warnings)
}

fn head_markers(markers: &[MarkerReport]) -> Vec<String> {
    let far = markers.iter().filter(|m| m.correction_m > MOST_CORRECTION_M);
    far.map(|m| {
        format!(
            "head marker {}: found it {:.0} mm from its place in the session while all stood still, expected a few mm: what was seen is \
             believed, if the label is right",
            m.label,
            m.correction_m * 1e3
        )
    })
    .collect()
}

/// Whether hair moves in the still frames, in words: wind cannot be told from a wrong rest.
fn moves_at_rest(head: &HeadCapture, (first, last): (usize, usize)) -> Option<String> {
    let moves_m = |track: &Track| {
        let seen: Vec<Vec3> = (first..=last).filter_map(|frame| track.at(frame)).collect();
        let mean = seen.iter().sum::<Vec3>() / seen.len().max(1) as f64;
        let squares: f64 = seen.iter().map(|p| (p - mean).norm_squared()).sum();
        (!seen.is_empty()).then(|| (squares / seen.len() as f64).sqrt())
    };
    let tracks = head.strands.iter().flat_map(|strand| &strand.markers);
    let moves_m = median_high(tracks.filter_map(moves_m).collect())?;
    let span = FrameSpan::of(head.first_frame, &(first..last + 1));
    (moves_m > STILL_M).then(|| {
        format!(
            "found locks that move by {:.1} mm (rms, the median marker) in the still frames {} to {}, expected hair that hangs still",
            moves_m * 1e3,
            span.first_frame,
            span.last_frame
        )
    })
}

/// Whether roots lie on the head that hair can touch, in words; an error if they are not even near it.
fn head_collider(session: &Session) -> Result<Option<String>, String> {
    let ellipsoid = |c: &Collider| match c.shape {
        Shape::Ellipsoid { center_m, half_axes_m } if c.attachment == Attachment::Head => {
            Some((center_m, half_axes_m))
        }
        _ => None,
    };
    let Some((center_m, half_axes_m)) = session.body.colliders.iter().find_map(ellipsoid) else {
        return Ok(None);
    };
    let share = |s: &StrandSpec| (s.root_m - center_m).component_div(&half_axes_m).norm();
    let Some(share) = median_high(session.strands.iter().map(share).collect()) else { return Ok(None) };
    let is_assumed = session.assumed.iter().any(|assumed| assumed.what == "colliders");
    let head = if is_assumed {
        "an adult's head, as the session has no `colliders`"
    } else {
        "`colliders.head_ellipsoid_half_axes_mm`"
    };
    let words = format!(
        "{head}: found roots (`root_mm`) at {share:.2} of the way from its center to its surface (the median), expected them on it"
    );
    match share {
        share if ROOTS_ON_HEAD.contains(&share) => Ok(None),
        share if ROOTS_NEAR_HEAD.contains(&share) => Ok(Some(words)),
        _ => Err(words),
    }
}

/// A lock's way from its root along the markers that are seen, and what the session says of it.
#[derive(Clone, Copy)]
struct Way<'a> {
    last_marker: &'a str,
    /// As it is seen in most frames, m.
    seen_m: f64,
    /// As it is seen where it is shortest, m: hair never stretches, and labels that were exchanged for a while make it seem so.
    least_seen_m: f64,
    /// As the session has it, m.
    hair_m: f64,
    /// The first stretch between neighbors that is seen to be longer than its hair: to which marker, seen and said, m.
    stretched: Option<(&'a str, f64, f64)>,
}

/// How badly a way fits.
enum Misfit {
    /// The lock is far longer than its hair: a label on something else, or another unit.
    FarTooLong,
    /// The lock is far shorter than its hair.
    FarTooShort,
    /// It can be used.
    Odd,
}

fn locks(session: &Session, head: &HeadCapture) -> Result<Vec<String>, String> {
    let mut warnings = Vec::new();
    let (mut n_ways, mut too_long, mut too_short) = (0, Vec::new(), Vec::new());
    for tracks in &head.strands {
        let spec = &session.strands[tracks.strand_idx];
        warnings.extend(reach(spec));
        if let Some(far) = far_root(spec, session) {
            warnings.push(far);
            continue;
        }
        let Some(way) = way(spec, &tracks.markers) else { continue };
        n_ways += 1;
        match misfit(spec, &way) {
            Some((Misfit::FarTooLong, words)) => too_long.push(words),
            Some((Misfit::FarTooShort, words)) => too_short.push(words),
            Some((Misfit::Odd, words)) => warnings.push(words),
            None => {}
        }
    }
    // One lock that is seen to be far too long can be a label on something else; if most are, it is the session.
    if !too_short.is_empty() || 2 * too_long.len() > n_ways {
        too_short.append(&mut too_long);
        return Err(several(&too_short));
    }
    warnings.append(&mut too_long);
    Ok(warnings)
}

/// Whether the markers of a lock end far above its tip, in words.
fn reach(spec: &StrandSpec) -> Option<String> {
    let last_m = spec.markers.last()?.distance_from_root_m?;
    (last_m < LEAST_REACH * spec.length_m).then(|| {
        format!(
            "lock {}: found its last marker {:.0} mm down a lock of {:.0} mm (`length_mm`), expected markers to near the tip",
            spec.name,
            last_m * 1e3,
            spec.length_m * 1e3
        )
    })
}

/// Whether a root is far from all that is known to be on the head, in words.
fn far_root(spec: &StrandSpec, session: &Session) -> Option<String> {
    let on_head = session.head_markers.iter().map(|m| m.position_m).chain([Vec3::zeros()]);
    let far_m = on_head.map(|p| (p - spec.root_m).norm()).fold(f64::INFINITY, f64::min);
    let name = &spec.name;
    (far_m > FARTHEST_ROOT_M).then(|| {
        format!("lock {name}: found its root (`root_mm`) {far_m:.2} m from the head's markers and center, expected it on the scalp")
    })
}

/// Whether a way is seen that the session's lock cannot have, in words.
fn misfit(spec: &StrandSpec, way: &Way<'_>) -> Option<(Misfit, String)> {
    let Way { last_marker, seen_m, least_seen_m, hair_m, stretched } = *way;
    let is_measured = spec.markers.iter().any(|m| m.distance_from_root_m.is_some());
    let field = if is_measured { "marker_distance_from_root_mm" } else { "length_mm" };
    let name = &spec.name;
    let found = |seen_m: f64| {
        format!(
            "lock {name}: found {:.0} mm from its root along its markers to {last_marker}, expected {:.0} mm (`{field}`)",
            seen_m * 1e3,
            hair_m * 1e3
        )
    };
    // Hands are off by as much on a short lock as on a long one.
    if hair_m > MOST_RATIO * seen_m + MEASURING_SLACK_M {
        return Some((Misfit::FarTooShort, found(seen_m)));
    }
    if least_seen_m > MOST_RATIO * hair_m + MEASURING_SLACK_M {
        return Some((Misfit::FarTooLong, found(least_seen_m)));
    }
    if seen_m + MEASURING_SLACK_M < LEAST_SEEN * hair_m {
        return Some((Misfit::Odd, found(seen_m)));
    }
    if least_seen_m > MOST_SEEN * hair_m + MEASURING_SLACK_M {
        return Some((Misfit::Odd, found(least_seen_m)));
    }
    let (marker, seen_m, hair_m) = stretched?;
    let words = format!(
        "lock {name}: found marker {marker} {:.0} mm from what is before it, expected at most the {:.0} mm of hair between them \
         (`{field}`)",
        seen_m * 1e3,
        hair_m * 1e3
    );
    Some((Misfit::Odd, words))
}

/// The first few of many, and how many more.
fn several(found: &[String]) -> String {
    const MOST: usize = 3;
    let shown = found.iter().take(MOST).cloned().collect::<Vec<_>>().join("; ");
    match found.len().checked_sub(MOST) {
        Some(more @ 1..) => format!("{shown}; and {more} locks more"),
        _ => shown,
    }
}

/// The distances from the root to the first marker that was seen for a while, and from each to the next. `None` if none was.
fn way<'a>(spec: &'a StrandSpec, tracks: &[Track]) -> Option<Way<'a>> {
    let place_m = |idx: usize| spec.marker_distance_m(idx);
    let mut way: Option<Way<'_>> = None;
    let mut before: Option<usize> = None;
    for (idx, track) in tracks.iter().enumerate() {
        let from = |frame: usize| before.map_or(Some(spec.root_m), |b| tracks[b].at(frame));
        let seen = (0..track.n_frames()).filter_map(|f| Some((track.at(f)? - from(f)?).norm()));
        let Some([least_m, step_m]) = tenth_and_half(seen.collect()) else { continue };
        let label = &*spec.markers[idx].label;
        let step_hair_m = place_m(idx) - before.map_or(0.0, place_m);
        let is_measured = spec.markers[idx].distance_from_root_m.is_some();
        let is_stretched = is_measured && least_m > MOST_SEEN * step_hair_m + MEASURING_SLACK_M;
        let stretched = is_stretched.then_some((label, least_m, step_hair_m));
        let so_far = way.take();
        way = Some(Way {
            last_marker: label,
            seen_m: so_far.as_ref().map_or(0.0, |w| w.seen_m) + step_m,
            least_seen_m: so_far.as_ref().map_or(0.0, |w| w.least_seen_m) + least_m,
            hair_m: place_m(idx),
            stretched: so_far.and_then(|w| w.stretched).or(stretched),
        });
        before = Some(idx);
    }
    way
}

/// What a tenth of the values is below, and what half of them is; `None` of so few that one wrong label could be all of them.
fn tenth_and_half(mut values: Vec<f64>) -> Option<[f64; 2]> {
    const LEAST: usize = 10;
    values.sort_by(f64::total_cmp);
    (values.len() >= LEAST).then(|| [values[values.len() / 10], values[values.len() / 2]])
}

/// Fans whose two directions are far apart.
fn fans(session: &Session, rest_pose: &Pose) -> Vec<String> {
    let contradiction = |(idx, fan): (usize, &Fan)| {
        let in_world = rest_pose.rotation.inverse() * fan.blows_towards_world?;
        let apart = in_world.angle(&fan.blows_towards_head());
        if apart <= MOST_FAN_ANGLE {
            return None;
        }
        let degrees = |rad: f64| rad.to_degrees().round() as i64;
        let from = -in_world;
        let azimuth = degrees(RealField::atan2(from.y, from.x));
        let elevation = degrees(ComplexField::asin(from.z.clamp(-1.0, 1.0)));
        let believed = if fan.to_azimuth_rad.is_some() { "from_azimuth_deg" } else { "blows_towards_world" };
        Some(format!(
            "fans[{idx}]: found wind from azimuth {azimuth}° and elevation {elevation}° of the head at rest by `blows_towards_world`, and \
             from {}° and {}° by `from_azimuth_deg` and `from_elevation_deg`, expected the same ({}° apart): `{believed}` is believed",
            degrees(fan.from_azimuth_rad),
            degrees(fan.from_elevation_rad),
            degrees(apart),
        ))
    };
    session.fans.iter().enumerate().filter_map(contradiction).collect()
}
