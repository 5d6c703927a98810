//! What friction takes from the stream round an ellipsoid: a thin slow layer at the surface and a wake behind it.
//!
//! The layer leaves 1 − (1 − s) exp(−(1 − s) d/δ) of the stream at a distance d from the surface, past which the share s slips: air
//! stands still at skin, but hair, and a head that is not quite its ellipsoid, hide where that is. δ is the displacement thickness: so
//! far the stream would have to be moved off for as much of it to be missing, whatever slips. The wake slows the stream by a share A on the
//! axis behind the body, as a bell across it about as wide as the body, rising over its rear half and dying out with the
//! distance as (1 + x/2R)^(−2/3), the law of a round body's far wake (Schlichting, "Boundary-Layer Theory", on wakes). A real
//! head's layer and wake are neither as simple nor steady: what the hair says corrects them.

use crate::during::Row;
use crate::exponential::exp;
use tousle_core::Vec3;
use tousle_lanes::{Lane, Vector, fade};

/// The distance of a point from an ellipsoid's surface, to first order, m; not above 0 inside.
pub(crate) fn distance_m(half_axes_m: Vec3, from_center_m: Vec3) -> f64 {
    let scaled = from_center_m.component_div(&half_axes_m);
    let level = scaled.norm();
    if level <= 1.0 {
        return 0.0;
    }
    let slope = scaled.component_div(&half_axes_m).norm() / level;
    (level - 1.0) / slope
}

/// The layer is over where it takes less than e⁻²⁵ of the stream.
const LAYER_ENDS: f64 = 25.0;

/// A layer's share of the stream at a distance: what is left of it, and how that changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Layer {
    /// 1 far away.
    pub(crate) left: f64,
    /// With the logarithm of the layer's displacement thickness.
    pub(crate) by_log_thickness: f64,
    /// With the share that slips past the surface.
    pub(crate) by_slip: f64,
}

impl Layer {
    /// `thickness_m`: the displacement thickness.
    pub(crate) fn at(distance_m: f64, thickness_m: f64, slip: f64) -> Self {
        let taken = 1.0 - slip;
        let deep = taken * distance_m / thickness_m;
        let fades = if deep > LAYER_ENDS { 0.0 } else { exp(-deep) };
        Self {
            left: 1.0 - taken * fades,
            // (1 − s) e^(−x), x = (1 − s) d/δ.
            by_log_thickness: -taken * fades * deep,
            by_slip: fades * (1.0 - deep),
        }
    }
}

/// How far from a head it holds swirls back, m.
///
/// The air next to a wall cannot go through it: across the wall swirls fade within about their own size, along it within a layer that
/// is much thinner (Hunt and Graham, "Free-stream turbulence near plane boundaries", *Journal of Fluid Mechanics* 84, 1978). This
/// stands for both; half of it or twice as much finds a wind that is as good.
const HOLDS_BACK_M: f64 = 0.02;

/// The share of swirls that a head leaves at a distance from it.
pub(crate) fn swirls_left(distance_m: f64) -> f64 {
    1.0 - exp(-f64::min(distance_m / HOLDS_BACK_M, LAYER_ENDS))
}

/// The lee of an ellipsoid in a stream of one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lee {
    /// Where the stream goes, unit length.
    direction: Vec3,
    /// Half the body's length along the stream, m.
    half_length_m: f64,
    /// Radius of the ellipse that it shows the stream, m.
    radius_m: f64,
}

/// Bells are over where they are below e⁻⁴⁰.
const BELL_ENDS: f64 = 40.0;

impl Lee {
    pub(crate) fn of(half_axes_m: Vec3, direction: Vec3) -> Self {
        let half_length_m = half_axes_m.component_mul(&direction).norm();
        let radius_m = (half_axes_m.iter().product::<f64>() / half_length_m).sqrt();
        Self { direction, half_length_m, radius_m }
    }

    /// The share of the stream that the wake takes where its strength is 1.
    pub(crate) fn share(&self, from_center_m: Vec3) -> f64 {
        let along = from_center_m.dot(&self.direction);
        if along <= 0.0 {
            return 0.0;
        }
        let across2 = (from_center_m - self.direction * along).norm_squared();
        let behind = f64::max(along - self.half_length_m, 0.0) / (2.0 * self.radius_m);
        let fade = if behind > 0.0 { libm::cbrt(1.0 + behind) } else { 1.0 };
        let width2 = self.radius_m * self.radius_m * fade * fade;
        if across2 > BELL_ENDS * width2 {
            return 0.0;
        }
        smooth_step(along / self.half_length_m) / (fade * fade) * exp(-across2 / width2)
    }
}

/// Lees of several steps: of numbers side by side, or rows of them.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LeeLanes<T> {
    direction: [T; 3],
    half_length_m: T,
    /// One over the half length, over the square of the radius, and over twice it.
    per_half_length: T,
    per_radius2: T,
    per_width: T,
}

impl LeeLanes<Row> {
    /// That of each step; `None` where there is none, which shelters nothing.
    pub(crate) fn of<'a>(lee: impl Fn(usize) -> Option<&'a Lee>) -> Self {
        let row = |number: &dyn Fn(&Lee) -> f64| -> Row {
            core::array::from_fn(|step| lee(step).map_or(0.0, |lee| number(lee) as f32))
        };
        Self {
            direction: [0, 1, 2].map(|axis| row(&|lee| lee.direction[axis])),
            half_length_m: row(&|lee| lee.half_length_m),
            per_half_length: row(&|lee| 1.0 / lee.half_length_m),
            per_radius2: row(&|lee| 1.0 / (lee.radius_m * lee.radius_m)),
            per_width: row(&|lee| 0.5 / lee.radius_m),
        }
    }

    /// Some of the steps' side by side, beside a number that there is.
    pub(crate) fn lanes<L: Lane>(&self, like: L, from: usize) -> LeeLanes<L> {
        let lanes = |row: &Row| like.of_single(&row[from..from + L::N]);
        LeeLanes {
            direction: [0, 1, 2].map(|axis| lanes(&self.direction[axis])),
            half_length_m: lanes(&self.half_length_m),
            per_half_length: lanes(&self.per_half_length),
            per_radius2: lanes(&self.per_radius2),
            per_width: lanes(&self.per_width),
        }
    }
}

impl<L: Lane> LeeLanes<L> {
    /// As [`Lee::share`]; `None` if all are 0.
    #[inline(always)]
    pub(crate) fn share(&self, from_center: Vector<L>) -> Option<L> {
        let [x, y, z] = self.direction;
        let direction = Vector::new(x, y, z);
        let along = from_center.dot(direction);
        let [none, one] = [0.0, 1.0].map(|number| along.same(number));
        if !along.any_above(none) {
            return None;
        }
        let across2 = direction.mul_add(-along, from_center).norm_squared();
        let behind = (along - self.half_length_m).max(none) * self.per_width;
        let fades = (one + behind).cbrt();
        let per_fades2 = one / (fades * fades);
        let bell = one + fade(across2 * self.per_radius2 * per_fades2);
        let rises = (along * self.per_half_length).min(one);
        let rises = rises * rises * (along.same(3.0) - rises - rises);
        Some(along.above(none, rises * per_fades2 * bell, none))
    }
}

/// 0 below 0, 1 above 1, smooth in between.
fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At a head there are no swirls; two decimeters off it holds none back.
    #[test]
    fn a_head_holds_swirls_back() {
        assert!(swirls_left(0.0) == 0.0 && swirls_left(0.2) > 0.9999);
        assert!((swirls_left(HOLDS_BACK_M) - 0.632).abs() < 1e-3);
        assert!(swirls_left(1e9) > 0.9999);
    }

    /// Whatever slips, as much of the stream is missing as over the displacement thickness; and it changes as it says.
    #[test]
    fn a_layer_takes_its_displacement_thickness() {
        const SLICE_M: f64 = 1e-5;
        for slip in [0.0, 0.3, 0.8] {
            let left = |k: usize| Layer::at((k as f64 + 0.5) * SLICE_M, 0.006, slip).left;
            let missing_m: f64 = (0..50_000).map(|k| (1.0 - left(k)) * SLICE_M).sum();
            assert!((missing_m - 0.006).abs() < 1e-6, "{missing_m} at {slip}");
            assert!((Layer::at(0.0, 0.006, slip).left - slip).abs() < 1e-15);
            for distance_m in [0.0, 0.002, 0.01, 0.05] {
                let layer = Layer::at(distance_m, 0.006, slip);
                let by = |log: f64, slip_by: f64| {
                    Layer::at(distance_m, 0.006 * libm::exp(log), slip + slip_by).left - layer.left
                };
                assert!((by(1e-6, 0.0) / 1e-6 - layer.by_log_thickness).abs() < 1e-5);
                assert!((by(0.0, 1e-6) / 1e-6 - layer.by_slip).abs() < 1e-5);
            }
        }
    }
}
