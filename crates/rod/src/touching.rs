use crate::contact::{Gap, Surface};
use crate::likely::{Bears, Likely};
use crate::lock::Lock;
use crate::turn::any_perpendicular;
use tousle_core::Vec3;

/// Contacts a lock may have before every second, third … is left out of the search for what bears it.
const MAX_PLACES: usize = 64;

/// How much of Coulomb's limit friction holds of hair at rest, at most. At 1 whatever it bears along a surface would slide as
/// soon as it is pushed on a little less, and in air of 1 µm/s soft locks slid off the head within seconds; if it falls, hair
/// that leans on a slope has to be held by its joints. From 0.8 to 0.95 scores in the true wind are alike.
const HELD_SHARE: f64 = 0.9;

/// Where a stick may touch a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    pub stick: usize,
    /// How far along the stick, 0 to 1.
    pub share: f64,
    pub gap: Gap,
}

/// A way in which a lock may be borne: by 1 N outwards, and what friction adds to it along the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    pub collider: usize,
    pub place: Place,
    pub along: Vec3,
}

impl Candidate {
    /// The force on the ends of its stick that does the same as this one: the stick whose far end it is, and its share.
    pub fn on_ends(&self) -> impl Iterator<Item = (usize, f64)> {
        let Place { stick, share, .. } = self.place;
        let near = stick.checked_sub(1).map(|before| (before, 1.0 - share));
        near.into_iter().chain([(stick, share)]).filter(|(_, share)| *share > 0.0)
    }

    /// The force, N.
    pub fn force(&self) -> Vec3 {
        self.place.gap.normal + self.along
    }
}

/// All ways in which a body may bear a lock at rest. With friction, each place may be borne in four ways: the edges of a
/// pyramid well within Coulomb's cone.
pub(crate) fn candidates(lock: &Lock, surfaces: &[Surface], likely: &Likely) -> Vec<Candidate> {
    let points_m = lock.rest_points();
    let within_m = likely.touch.within_m;
    let place = |surface: &Surface, stick: usize| match likely.bears {
        Bears::Points => {
            surface.gap_within(points_m[stick + 1], within_m).map(|gap| Place { stick, share: 1.0, gap })
        }
        Bears::Sticks if stick == 0 => None,
        Bears::Sticks => nearest_place(surface, &points_m, stick, within_m),
    };
    let places: Vec<(usize, Place)> = surfaces
        .iter()
        .enumerate()
        .flat_map(|(collider, surface)| {
            (0..lock.n_sticks()).filter_map(move |stick| Some((collider, place(surface, stick)?)))
        })
        .collect();
    let stride = places.len().div_ceil(MAX_PLACES).max(1);
    let ways = |(collider, place): (usize, Place)| {
        let limit = likely.friction * HELD_SHARE;
        let across = across(place.gap.normal, lock.rest_directions[place.stick]) * limit;
        let beside = across.cross(&place.gap.normal);
        let edges = if likely.friction > 0.0 { vec![across, -across, beside, -beside] } else { vec![across] };
        edges.into_iter().map(move |along| Candidate { collider, place, along })
    };
    places.into_iter().step_by(stride).flat_map(ways).collect()
}

/// Where a stick of a lock at rest comes nearest to a surface, if that is within `within_m`.
///
/// Along a stick that is short against a body the gap is a parabola, which both ends and the middle tell.
pub(crate) fn nearest_place(
    surface: &Surface,
    points_m: &[Vec3],
    stick: usize,
    within_m: f64,
) -> Option<Place> {
    let (from, to) = (points_m[stick], points_m[stick + 1]);
    let length_m = (to - from).norm();
    // A gap changes by no more than the way that is gone.
    let near = surface.gap_within(0.5 * (from + to), within_m + 0.5 * length_m)?;
    let [start, middle, end] = [surface.gap(from).distance_m, near.distance_m, surface.gap(to).distance_m];
    let (slope, bend) = (0.5 * (end - start), end + start - 2.0 * middle);
    let lowest = if start < end { 0.0 } else { 1.0 };
    let share = if bend > 0.0 { (0.5 - 0.5 * slope / bend).clamp(0.0, 1.0) } else { lowest };
    let gap = surface.gap(from + (to - from) * share);
    (gap.distance_m <= within_m).then_some(Place { stick, share, gap })
}

/// A unit vector along a surface, across the stick that lies on it.
fn across(normal: Vec3, direction: Vec3) -> Vec3 {
    let across = direction.cross(&normal);
    if across.norm() > 1e-3 { across.normalize() } else { any_perpendicular(normal) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::Shape;

    /// Along a stick that lies over a ball, the place nearest to it is found, and none where it is too far.
    #[test]
    fn a_stick_touches_between_its_points() {
        let ball = Surface::new(&Shape::Capsule { a_m: Vec3::zeros(), b_m: Vec3::zeros(), radius_m: 0.1 });
        for nearest in [0.0, 0.3, 0.5, 0.9] {
            let start = Vec3::new(-nearest * 0.02, 0.0, 0.102);
            let points = [start, start + Vec3::x() * 0.02];
            let place = nearest_place(&ball, &points, 0, 0.003).unwrap();
            assert!((place.share - nearest).abs() < 0.01, "{nearest}: {place:?}");
            assert!((place.gap.distance_m - 0.002).abs() < 1e-6);
            assert!(nearest_place(&ball, &points, 0, 0.0019).is_none());
        }
    }
}
