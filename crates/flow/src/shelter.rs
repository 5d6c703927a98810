use tousle_core::Vec3;

/// What friction takes from the stream round an ellipsoid: a thin slow layer at the surface and a wake behind it.
///
/// The layer: 1 − exp(−d/δ) of the stream at a distance d from the surface. The wake: the stream is slowed by a share
/// A on the axis behind the body, as a bell across it about as wide as the body, rising over its rear half and dying
/// out with the distance as (1 + x/2R)^(−2/3), the law of a round body's far wake (Schlichting, "Boundary-Layer
/// Theory", on wakes). A real head's layer and wake are neither as simple nor steady: what the hair says corrects them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shelter {
    /// The ellipsoid's center, head space, m.
    pub center_m: Vec3,
    /// Its half axes, m.
    pub half_axes_m: Vec3,
    /// δ, m.
    pub layer_m: f64,
    /// A, from 0 to 1.
    pub wake: f64,
}

impl Shelter {
    /// The share of the stream that is left by the layer at the surface: 0 inside, 1 far away.
    pub fn layer(&self, point_m: Vec3) -> f64 {
        let scaled = (point_m - self.center_m).component_div(&self.half_axes_m);
        let level = scaled.norm();
        if level <= 1.0 {
            return 0.0;
        }
        let slope = scaled.component_div(&self.half_axes_m).norm() / level;
        1.0 - libm::exp(-(level - 1.0) / (slope * self.layer_m))
    }

    /// The share of the stream that the wake takes where its strength is 1; the direction of the stream has unit length.
    pub fn wake_shape(&self, point_m: Vec3, direction: Vec3) -> f64 {
        let from_center = point_m - self.center_m;
        // Half the body's length along the stream, and its radius across: of the ellipse that it shows the stream.
        let half_length = self.half_axes_m.component_mul(&direction).norm();
        let radius = (self.half_axes_m.iter().product::<f64>() / half_length).sqrt();
        let along = from_center.dot(&direction);
        let across2 = (from_center - direction * along).norm_squared();
        let rise = smooth_step(along / half_length);
        let behind = f64::max(along - half_length, 0.0) / (2.0 * radius);
        let fade = libm::cbrt(1.0 + behind);
        let width2 = radius * radius * fade * fade;
        rise / (fade * fade) * libm::exp(-across2 / width2)
    }

    /// The share of the stream that is left at a point.
    pub fn at(&self, point_m: Vec3, direction: Vec3) -> f64 {
        self.layer(point_m) * (1.0 - self.wake * self.wake_shape(point_m, direction))
    }
}

/// 0 below 0, 1 above 1, smooth in between.
fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
