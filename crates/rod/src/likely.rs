use crate::contact::Surface;
use crate::lock::Lock;
use crate::natural::{Fall, Natural};
use crate::touching::nearest_place;
use rayon::prelude::*;
use tousle_core::{Body, Pose, Vec3};

/// What a joint does against a turn of its stick about the stick itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Twist {
    /// Nothing: the lock is free to roll, and the moment about a stick goes nowhere.
    Free,
    /// It holds the moment as it does across the stick: an elastic rod.
    Held,
}

/// What of a lock lies on a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bears {
    /// Its points.
    Points,
    /// Its sticks, wherever along them they come nearest; but for the first, which grows out of the body.
    Sticks,
}

/// How near to a body hair comes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// What is at rest so near to a surface, counted from the center line, may be borne by it, m.
    pub within_m: f64,
    /// How near a center line may come that is not borne at rest, m.
    pub radius_m: f64,
}

impl Touch {
    /// How many times as far out from the median as the nearest are inwards what lies on a body may be. Gaps of curves that
    /// a simulation left vary by a tenth, those of control points cut from them by a third: if it is below 1, locks that lie
    /// on the body are taken to hold all their weight, and coil when anything shakes them; above 3, locks that hover are
    /// taken to lie on it.
    const SPREADS: f64 = 2.0;

    /// The least that it may be off, as a share of the radius: a body sinks in, and its shapes stand for one.
    const LEAST_SPREAD: f64 = 0.1;

    /// Judged by a lock's width alone.
    pub fn by_width(lock: &Lock) -> Self {
        Self { within_m: lock.width_m, radius_m: 0.5 * lock.width_m }
    }

    /// Judged by how near the locks of a hairstyle come to the body at rest: those that lie on it show how thick hair
    /// is to a surface, whatever it is to the wind. `None` where no lock comes near, or where they lie inside.
    ///
    /// The radius is the median gap of the locks that come near, and what lies on the body spreads about it on the far side as
    /// on the near one, where none hovers: the gap that a twentieth of the locks fall short of tells how far. `gaps_m` has
    /// each lock's least gap, where it is within the lock's width.
    fn by_rest(gaps_m: &[Option<f64>]) -> Option<Self> {
        let mut nearest: Vec<f64> = gaps_m.iter().copied().flatten().collect();
        nearest.sort_unstable_by(f64::total_cmp);
        let (low_m, radius_m) = (*nearest.get(nearest.len() / 20)?, *nearest.get(nearest.len() / 2)?);
        let spread_m = f64::max(Self::SPREADS * (radius_m - low_m), Self::LEAST_SPREAD * radius_m);
        (low_m > 0.0).then_some(Self { within_m: radius_m + spread_m, radius_m })
    }
}

/// The least gap of a lock beyond its first stick, if it comes within so much of a surface.
fn nearest_gap(lock: &Lock, surfaces: &[Surface], within_m: f64) -> Option<f64> {
    let points_m = lock.rest_points();
    let gaps = surfaces.iter().flat_map(|surface| {
        let near = |stick| nearest_place(surface, &points_m, stick, within_m);
        (1..lock.n_sticks()).filter_map(near).map(|place| place.gap.distance_m)
    });
    gaps.reduce(f64::min)
}

/// What the locks of a hairstyle tell of one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// How near they come to the body; `None` where none comes near.
    touch: Option<Touch>,
    /// How their natural shapes fall; `None` where too few hang free to tell.
    fall: Option<Fall>,
}

impl Style {
    /// Judged by the locks that hang still under a gravity in head axes, m/s². Only those are asked how
    /// natural shapes fall whose own stiffness `is_known`.
    pub fn of(locks: &[Lock], is_known: impl Fn(usize) -> bool + Sync, gravity: Vec3, body: &Body) -> Self {
        let surfaces = Surface::of_body(body, &Pose::identity());
        let gap_m = |lock: &Lock| nearest_gap(lock, &surfaces, lock.width_m);
        let gaps_m: Vec<Option<f64>> = locks.par_iter().map(gap_m).collect();
        let touch = Touch::by_rest(&gaps_m);
        let is_free = |lock: &Lock, gap_m: Option<f64>| {
            let within_m = touch.map_or(lock.width_m, |touch| touch.within_m);
            let gap_m = if within_m > lock.width_m { nearest_gap(lock, &surfaces, within_m) } else { gap_m };
            gap_m.is_none_or(|gap_m| gap_m > within_m)
        };
        let free = locks.par_iter().zip(&gaps_m).enumerate();
        let free = free.filter(|(i, (lock, gap_m))| is_known(*i) && is_free(lock, **gap_m));
        Self { touch, fall: Fall::of(free.map(|(_, (lock, _))| lock), gravity) }
    }

    /// What is likely of one of its locks, held by joints that resist twist, on a body that rubs: for measuring and
    /// for simulating alike.
    pub fn likely(&self, lock: &Lock, body: &Body) -> Likely {
        Likely {
            twist: Twist::Held,
            bears: Bears::Sticks,
            touch: self.touch.unwrap_or_else(|| Touch::by_width(lock)),
            friction: body.friction,
            natural: self.fall.map_or(Natural::HALF_STRAIGHT, Natural::Falling),
        }
    }
}

/// What is taken to be likely of a lock that hangs still, where its rest curve leaves it open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Likely {
    /// What its joints do against twist.
    pub twist: Twist,
    /// What of it may be borne.
    pub bears: Bears,
    /// How near it must be to the body to be borne.
    pub touch: Touch,
    /// Coulomb's coefficient up to which the body holds it along its surface, ≥ 0.
    pub friction: f64,
    /// What shape it would have without load.
    pub natural: Natural,
}

impl Likely {
    /// A lock whose joints hold as little as can be, on a smooth body that bears its points, near by its own width.
    pub fn smooth(lock: &Lock, twist: Twist) -> Self {
        Self {
            twist,
            bears: Bears::Points,
            touch: Touch::by_width(lock),
            friction: 0.0,
            natural: Natural::Straight(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn touch(gaps_mm: &[f64]) -> Option<Touch> {
        Touch::by_rest(&gaps_mm.iter().map(|mm| Some(mm * 1e-3)).collect::<Vec<_>>())
    }

    /// Where hair lies on the body at one distance, what hovers a little farther out does not; where gaps vary, as those of
    /// control points that cut corners do, locks on the far side lie on it as well.
    #[test]
    fn what_touches_is_told_by_how_gaps_spread() {
        let tight = touch(&[2.3, 2.38, 2.4, 2.41, 2.42, 2.44, 2.45, 2.46, 3.4]).unwrap();
        assert!((tight.radius_m - 2.42e-3).abs() < 1e-9, "{tight:?}");
        assert!((2.46e-3..3.0e-3).contains(&tight.within_m), "{tight:?}");
        let wide = touch(&[1.2, 1.6, 1.8, 1.9, 2.0, 2.1, 2.3, 2.6, 2.9]).unwrap();
        assert!((2.9e-3..4.0e-3).contains(&wide.within_m), "{wide:?}");
        assert_eq!(touch(&[2.0, 2.0, 2.0]).map(|touch| touch.within_m > 2.1e-3), Some(true));
    }

    /// Curves that run into the body do not tell how thick hair is.
    #[test]
    fn curves_inside_the_body_tell_nothing() {
        assert_eq!(touch(&[-1.0, 0.5, 2.0, 2.4]), None);
        assert_eq!(touch(&[]), None);
    }
}
