use crate::PotentialFlow;
use crate::shelter::{Layer, Lee, distance_m, swirls_left};
use nalgebra::{DMatrix, Matrix3, Matrix3x6};
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
    /// Turns the wind far away into that of a frictionless flow.
    pub potential: Matrix3<f64>,
    pub(crate) near: Option<NearHead>,
}

/// Where a point is, seen from the head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NearHead {
    pub(crate) from_center_m: Vec3,
    /// From its surface; 0 inside.
    pub(crate) distance_m: f64,
    /// The share of swirls that it leaves there, whatever blows.
    pub(crate) swirls_left: f64,
}

/// A [`Stream`] at one time, ready to be read at many points.
#[derive(Clone, Debug, PartialEq)]
pub struct StreamNow {
    /// The wind far away, m/s.
    pub(crate) outside: Vec3,
    /// The wakes' strength.
    pub(crate) wake: f64,
    /// The displacement thickness of the layer at the scalp, m.
    pub(crate) layer_m: f64,
    /// The share of the stream that slips past the scalp.
    pub(crate) slip: f64,
    /// The parts of the wind far away.
    pub(crate) parts: Vec<PartNow>,
}

/// A part of the wind far away at one time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PartNow {
    /// As in [`StreamPart`].
    share: Matrix3<f64>,
    /// What it is of the wind far away, m/s.
    pub(crate) wind: Vec3,
    /// What it has behind the head.
    pub(crate) lee: Lee,
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
        let near = |(center, half_axes, _)| {
            let from_center_m = point_m - center;
            let distance_m = distance_m(half_axes, from_center_m);
            NearHead { from_center_m, distance_m, swirls_left: swirls_left(distance_m) }
        };
        StreamAt {
            potential: self.head.map_or_else(Matrix3::identity, |(.., flow)| flow.at(point_m)),
            near: self.head.map(near),
        }
    }

    /// The stream while the wind far away is `outside`, head axes, m/s, blown by `fans` ([`stream_parts`]), behind wakes of
    /// strength `wake` and in a layer of displacement thickness `layer_m`, which leaves the share `slip` at the scalp.
    pub fn now(&self, outside: Vec3, fans: &[Vec3], wake: f64, layer_m: f64, slip: f64) -> StreamNow {
        let parts = self.head.map_or_else(Vec::new, |(_, half_axes_m, _)| {
            let with_lee = |part: StreamPart| PartNow {
                share: part.share,
                wind: part.share * outside,
                lee: Lee::of(half_axes_m, part.direction),
            };
            stream_parts(outside, fans).into_iter().map(with_lee).collect()
        });
        StreamNow { outside, wake, layer_m, slip, parts }
    }
}

/// A part of the wind far away: what blows from one fan. It casts a wake of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StreamPart {
    /// Takes it out of the wind far away. Over all parts these add up to the identity.
    pub share: Matrix3<f64>,
    /// Where it blows, unit length.
    pub direction: Vec3,
}

/// The parts that the wind far away, `outside`, is made of if fans blow in some directions (unit length, or zero for one that
/// is off), all in the same axes.
///
/// Those shares of the fans, none below zero, are taken that come closest to it; what they leave over goes along with them. So a
/// single fan's wind is one part, wherever it turns, and in that of two fans the lee of either is felt. Still air has no part.
pub fn stream_parts(outside: Vec3, fans: &[Vec3]) -> Vec<StreamPart> {
    let Some(direction) = outside.try_normalize(1e-6) else { return Vec::new() };
    let mut blowing: Vec<Vec3> = fans.iter().copied().filter(|fan| fan.norm_squared() > 0.0).collect();
    while blowing.len() > 1 {
        let directions = DMatrix::from_fn(3, blowing.len(), |r, c| blowing[c][r]);
        let gram =
            directions.tr_mul(&directions) + DMatrix::identity(blowing.len(), blowing.len()) * NEARLY_ALIKE;
        let Some(shares) = gram.cholesky().map(|factor| factor.solve(&directions.transpose())) else { break };
        let strengths = &shares * outside;
        if strengths.min() > 0.0 {
            let left_over = DMatrix::identity(3, 3) - &directions * &shares;
            let part = |(k, direction): (usize, &Vec3)| {
                let own = direction * shares.row(k).fixed_columns::<3>(0);
                let share = own + left_over.fixed_view::<3, 3>(0, 0) * (strengths[k] / strengths.sum());
                StreamPart { share, direction: (share * outside).normalize() }
            };
            return blowing.iter().enumerate().map(part).collect();
        }
        blowing.remove(strengths.imin());
    }
    vec![StreamPart { share: Matrix3::identity(), direction }]
}

/// What keeps fans that blow the same way apart: far below the square of a degree.
const NEARLY_ALIKE: f64 = 1e-6;

/// The wind at a point and how it changes with what it hangs on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StreamWind {
    /// The share of swirls that the scalp and the layer at it leave.
    pub swirls_left: f64,
    /// The velocity, m/s.
    pub velocity: Vec3,
    /// Its change with the wind far away.
    pub by_outside: Matrix3<f64>,
    /// Its change with the wake's strength, m/s.
    pub by_wake: Vec3,
    /// Its change with the logarithm of the layer's thickness, m/s.
    pub by_log_layer: Vec3,
    /// Its change with the share that slips past the scalp, m/s.
    pub by_slip: Vec3,
}

impl StreamWind {
    /// Its change with all that it hangs on: a column for each.
    pub(crate) fn change(&self) -> Matrix3x6<f64> {
        let [x, y, z] = [0, 1, 2].map(|c| self.by_outside.column(c).into_owned());
        Matrix3x6::from_columns(&[x, y, z, self.by_wake, self.by_log_layer, self.by_slip])
    }
}

impl StreamAt {
    /// The wind at the point at a time, with its change. That wakes turn with the wind is left out of the derivative.
    pub fn wind(&self, now: &StreamNow) -> StreamWind {
        let Some(near) = self.near else {
            return StreamWind {
                swirls_left: 1.0,
                velocity: self.potential * now.outside,
                by_outside: self.potential,
                by_wake: Vec3::zeros(),
                by_log_layer: Vec3::zeros(),
                by_slip: Vec3::zeros(),
            };
        };
        let layer = Layer::at(near.distance_m, now.layer_m, now.slip);
        // What all wakes of strength 1 take.
        let in_lee: Matrix3<f64> =
            now.parts.iter().map(|part| part.share * part.lee.share(near.from_center_m)).sum();
        let left = self.potential * (Matrix3::identity() - in_lee * now.wake);
        let past = left * now.outside;
        StreamWind {
            swirls_left: near.swirls_left * layer.left,
            velocity: past * layer.left,
            by_outside: left * layer.left,
            by_wake: self.potential * in_lee * now.outside * -layer.left,
            by_log_layer: past * layer.by_log_thickness,
            by_slip: past * layer.by_slip,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Between two fans either has its part; beyond them the nearer one has all, as a single one always has.
    #[test]
    fn a_wind_is_made_of_what_the_fans_blow() {
        let fans = [Vec3::x(), Vec3::y()];
        let outside = Vec3::new(2.0, 1.0, 0.3);
        let parts = stream_parts(outside, &fans);
        assert!((parts[0].share * outside - Vec3::new(2.0, 0.0, 0.2)).norm() < 1e-5, "{parts:?}");
        assert!((parts[1].share * outside - Vec3::new(0.0, 1.0, 0.1)).norm() < 1e-5);
        assert!((parts[0].share + parts[1].share - Matrix3::identity()).norm() < 1e-12);
        let beyond = Vec3::new(2.0, -1.0, 0.0);
        for parts in
            [stream_parts(beyond, &fans), stream_parts(beyond, &fans[..1]), stream_parts(beyond, &[])]
        {
            assert_eq!(parts, vec![StreamPart { share: Matrix3::identity(), direction: beyond.normalize() }]);
        }
        assert_eq!(stream_parts(Vec3::zeros(), &fans), vec![]);
    }
}
