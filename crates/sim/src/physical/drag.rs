use super::link::Link;
use crate::lane::{Lane, Symmetric, Vector};

/// The air's push on a stick and its change with the wind.
pub(super) struct Push<L> {
    /// N.
    pub force: Vector<L>,
    /// N·s/m.
    pub slope: Symmetric<L>,
}

/// Taylor's drag on a stick along `direction`, in a wind relative to it (`tousle_rod::DragLaw`, for many strands).
#[inline(always)]
pub(super) fn push<L: Lane>(link: &Link<L>, along: L, direction: Vector<L>, wind: Vector<L>) -> Push<L> {
    let speed_along = wind.dot(direction);
    let across = direction.mul_add(-speed_along, wind);
    let speed2 = across.norm_squared();
    let speed = speed2.sqrt();
    let inertial = link.drag * speed;
    let viscous = link.drag * link.viscous * speed.cbrt();
    let resistance = inertial + viscous;
    let skin = link.drag * along * speed_along.max(-speed_along);
    let force = across.mul_add(resistance, direction * (skin * speed_along));
    // d(K u)/du = K + (u² and u^4/3 rise faster than u by 1 and a third); nothing of it in still air.
    let windward = (inertial + viscous * L::splat(1.0 / 3.0)) / speed2.max(L::splat(1e-12));
    let mut slope = Symmetric::scaled_identity(resistance);
    slope.add_outer(across, windward);
    slope.add_outer(direction, skin + skin - resistance);
    Push { force, slope }
}
