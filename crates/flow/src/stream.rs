use crate::{PotentialFlow, Shelter};
use nalgebra::Matrix3;
use tousle_core::{Attachment, Body, Shape, Vec3};

/// How the wind far away becomes the wind near a head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stream {
    /// The head's ellipsoid; `None` for a body without one, round which nothing is known to bend.
    head: Option<(Vec3, Vec3, PotentialFlow)>,
}

/// A [`Stream`] at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StreamAt {
    point_m: Vec3,
    /// Turns the wind far away into that of a frictionless flow.
    pub potential: Matrix3<f64>,
    head: Option<(Vec3, Vec3)>,
}

impl Stream {
    /// The stream round the first ellipsoid that the head carries.
    pub fn round(body: &Body) -> Self {
        let head = body.colliders.iter().find_map(|collider| match (&collider.shape, collider.attachment) {
            (Shape::Ellipsoid { center_m, half_axes_m }, Attachment::Head) => {
                Some((*center_m, *half_axes_m, PotentialFlow::round(*center_m, *half_axes_m)))
            }
            _ => None,
        });
        Self { head }
    }

    /// Whether a point lies in the head.
    pub fn is_solid(&self, point_m: Vec3) -> bool {
        self.head
            .is_some_and(|(center, half_axes, _)| (point_m - center).component_div(&half_axes).norm() <= 1.0)
    }

    /// The stream at a point.
    pub fn at(&self, point_m: Vec3) -> StreamAt {
        StreamAt {
            point_m,
            potential: self.head.map_or_else(Matrix3::identity, |(.., flow)| flow.at(point_m)),
            head: self.head.map(|(center, half_axes, _)| (center, half_axes)),
        }
    }
}

/// The wind at a point and how it changes with what it hangs on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StreamWind {
    /// The share that the layer at the scalp leaves.
    pub layer: f64,
    /// The velocity, m/s.
    pub velocity: Vec3,
    /// Its change with the wind far away.
    pub by_outside: Matrix3<f64>,
    /// Its change with the wake's strength, m/s.
    pub by_wake: Vec3,
    /// Its change with the logarithm of the layer's thickness, m/s.
    pub by_log_layer: Vec3,
}

impl StreamAt {
    /// The wind at the point if that far away is `outside`, m/s, behind a wake of strength `wake` and in a layer `layer_m`
    /// thick. That the wake turns with the wind is left out of the derivative.
    pub fn wind(&self, outside: Vec3, wake: f64, layer_m: f64) -> StreamWind {
        let free = self.potential * outside;
        let Some((center_m, half_axes_m)) = self.head else {
            return StreamWind {
                layer: 1.0,
                velocity: free,
                by_outside: self.potential,
                by_wake: Vec3::zeros(),
                by_log_layer: Vec3::zeros(),
            };
        };
        let shelter = Shelter { center_m, half_axes_m, layer_m, wake };
        let layer = shelter.layer(self.point_m);
        let direction = outside.try_normalize(1e-6);
        let shape = direction.map_or(0.0, |direction| shelter.wake_shape(self.point_m, direction));
        let left = 1.0 - wake * shape;
        // 1 − e^(−x) changes with ln δ as −x e^(−x).
        let fade = f64::max(1.0 - layer, 1e-300);
        let by_log_layer = fade * libm::log(fade);
        StreamWind {
            layer,
            velocity: free * (layer * left),
            by_outside: self.potential * (layer * left),
            by_wake: free * (-layer * shape),
            by_log_layer: free * (by_log_layer * left),
        }
    }
}
