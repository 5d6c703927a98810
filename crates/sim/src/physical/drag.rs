use super::link::Link;
use tousle_lanes::{Lane, Symmetric, Vector};

/// The air's push on a stick and its change with the wind.
pub(super) struct Push<L> {
    /// N.
    pub force: Vector<L>,
    /// N·s/m.
    pub slope: Symmetric<L>,
}

impl<L: Lane> Push<L> {
    /// No air.
    #[inline(always)]
    pub fn none(like: L) -> Self {
        Self { force: Vector::none(like), slope: Symmetric::none(like) }
    }
}

/// The square of a speed that is none, m²/s².
pub(crate) const STILL2: f64 = 1e-24;

/// Taylor's drag on a stick along `direction`, in a wind relative to it (`tousle_rod::DragLaw`, for many strands).
#[inline(always)]
pub(super) fn push<L: Lane>(link: &Link<L>, along: L, direction: Vector<L>, wind: Vector<L>) -> Push<L> {
    let speed_along = wind.dot(direction);
    let across = direction.mul_add(-speed_along, wind);
    // Below a speed that nothing feels, that speed: its powers are finite, and what they multiply is next to nothing.
    let speed2 = across.norm_squared().max(along.same(STILL2));
    let per_third = speed2.per_sixth_root();
    let per_two_thirds = per_third * per_third;
    let per_speed = per_two_thirds * per_third;
    let speed = speed2 * per_speed;
    let inertial = link.drag * speed;
    let viscous = link.drag * link.viscous * speed * per_two_thirds;
    let resistance = inertial + viscous;
    let skin = link.drag * along * speed_along.max(-speed_along);
    let force = across.mul_add(resistance, direction * (skin * speed_along));
    // d(K u)/du = K + (u² and u^4/3 rise faster than u by 1 and a third).
    let windward = viscous.mul_add(along.same(1.0 / 3.0), inertial) * per_speed * per_speed;
    let mut slope = Symmetric::scaled_identity(resistance);
    slope.add_outer(across, windward);
    slope.add_outer(direction, skin + skin - resistance);
    Push { force, slope }
}
