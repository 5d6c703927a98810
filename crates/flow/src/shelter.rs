//! What friction takes from the stream round an ellipsoid: a thin slow layer at the surface and a wake behind it.
//!
//! The layer leaves 1 − exp(−d/δ) of the stream at a distance d from the surface. The wake slows the stream by a share A on the
//! axis behind the body, as a bell across it about as wide as the body, rising over its rear half and dying out with the
//! distance as (1 + x/2R)^(−2/3), the law of a round body's far wake (Schlichting, "Boundary-Layer Theory", on wakes). A real
//! head's layer and wake are neither as simple nor steady: what the hair says corrects them.

use crate::exponential::{cbrt, exp};
use tousle_core::Vec3;

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

/// The share of the stream that is left by the layer at the surface: 0 inside, 1 far away.
pub(crate) fn layer(distance_m: f64, layer_m: f64) -> f64 {
    if distance_m <= 0.0 {
        0.0
    } else if distance_m > LAYER_ENDS * layer_m {
        1.0
    } else {
        1.0 - exp(-distance_m / layer_m)
    }
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
        let fade = if behind > 0.0 { cbrt(1.0 + behind) } else { 1.0 };
        let width2 = self.radius_m * self.radius_m * fade * fade;
        if across2 > BELL_ENDS * width2 {
            return 0.0;
        }
        smooth_step(along / self.half_length_m) / (fade * fade) * exp(-across2 / width2)
    }
}

/// 0 below 0, 1 above 1, smooth in between.
fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
