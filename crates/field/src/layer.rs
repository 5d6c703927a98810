use nalgebra::Rotation3;
use serde::{Deserialize, Serialize};
use tousle_core::Vec3;

/// An edit of the field: an extra vector near some handles during a span of time.
///
/// Layers are stored beside the voxels and added when the field is sampled, so an edit can be muted, changed or
/// taken out for ever after, and a hairstyle that was not there when it was made inherits it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldLayer {
    /// Unique in a field's stack.
    pub id: String,
    /// A name for people.
    pub name: String,
    /// A muted layer is kept and does nothing.
    #[serde(default)]
    pub muted: bool,
    /// The layer begins at this time, s; before it the field is untouched.
    pub first_secs: f64,
    /// The layer has ended at this time, s.
    pub last_secs: f64,
    /// How the layer comes and goes within its span.
    pub ease: Ease,
    /// Where it acts. Where handles overlap their vectors are averaged, not piled up.
    pub handles: Vec<Handle>,
    /// What it does to the vectors that are there, before the handles' own are added; `None`: nothing.
    #[serde(default)]
    pub reshape: Option<Reshape>,
    /// What it was made from, for an editor to take up again; sampling never looks at it.
    pub origin: LayerOrigin,
}

/// One place where a [`FieldLayer`] acts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Handle {
    /// The center, head space, m.
    pub center_m: Vec3,
    /// Distance from the center at which the weight has fallen to 0, m, > 0.
    pub reach_m: f64,
    /// What is added at the center when the layer is fully there, head axes, in the field's quantity.
    pub extra: Vec3,
}

/// What a layer does to the vectors that are there, where and when it is fully there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reshape {
    /// They are turned about this axis by its length, rad, head axes.
    pub turn: Vec3,
    /// They are made so many times as long, ≥ 0: 0 is a calm.
    pub scale: f64,
}

/// How a layer comes and goes: the share of its span in which it rises from 0 to 1, and falls to 0 again.
///
/// Both sides are smooth (quintic), so that no force ever jumps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ease {
    /// Share of the span in which it rises, 0 to 1.
    pub rise: f64,
    /// Share of the span in which it falls, 0 to 1 less `rise`.
    pub fall: f64,
}

/// What a layer was made from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum LayerOrigin {
    /// A strand's control point was dragged to a target at a key frame.
    Drag {
        /// The strand's name in the groom it was dragged in.
        strand: String,
        /// The control point, from the root.
        control_point: usize,
        /// Where it should be at the end of the span, head space, m.
        target_m: Vec3,
        /// Which method made the handles: `paper` (E4) or another by name.
        method: String,
    },
    /// One of the layers that were solved for together, so that control points meet keys.
    Keys {
        /// The edit that they are all of, unique in a field's stack among edits.
        edit: String,
        /// Before this time the edit does nothing, s.
        first_secs: f64,
        /// What should be where, and when.
        keys: Vec<LayerKey>,
        /// Which method solved for them.
        method: String,
    },
    /// The wind was changed at some places.
    Wind {
        /// How: `gust`, `calm`, `strength`, `turn`, or another by name.
        action: String,
    },
    /// Another edit, mirrored from left to right.
    Mirrored {
        /// The edit that this layer is of, as in [`LayerOrigin::Keys`].
        edit: String,
        /// The edit that was mirrored.
        of: String,
    },
}

/// Where a control point should be at a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LayerKey {
    /// The strand's name in the groom it was dragged in.
    pub strand: String,
    /// The control point, from the root.
    pub control_point: usize,
    /// When, s.
    pub secs: f64,
    /// Where, head space, m.
    pub target_m: Vec3,
}

impl FieldLayer {
    /// The edit that the layer is of: itself, or what it has in common with others.
    pub fn edit_id(&self) -> &str {
        match &self.origin {
            LayerOrigin::Keys { edit, .. } | LayerOrigin::Mirrored { edit, .. } => edit,
            LayerOrigin::Drag { .. } | LayerOrigin::Wind { .. } => &self.id,
        }
    }

    /// What the edit wants where, and when.
    pub fn keys(&self) -> Vec<LayerKey> {
        match &self.origin {
            LayerOrigin::Keys { keys, .. } => keys.clone(),
            LayerOrigin::Drag { strand, control_point, target_m, .. } => vec![LayerKey {
                strand: strand.clone(),
                control_point: *control_point,
                secs: self.last_secs,
                target_m: *target_m,
            }],
            LayerOrigin::Wind { .. } | LayerOrigin::Mirrored { .. } => Vec::new(),
        }
    }

    /// Whether the layer leaves every vector as it is, wherever and whenever.
    pub fn does_nothing(&self) -> bool {
        let adds = self.handles.iter().any(|handle| handle.extra != Vec3::zeros());
        self.muted || self.handles.is_empty() || (self.reshape.is_none() && !adds)
    }

    /// Whether the two make the same of every vector, by what they are made of.
    pub fn does_as(&self, other: &Self) -> bool {
        self.acts_with(other) && self.handles == other.handles
    }

    /// Whether the two act at the same places and times, and differ in their handles' vectors if in anything.
    pub(crate) fn acts_with(&self, other: &Self) -> bool {
        let place = |handle: &Handle| (handle.center_m, handle.reach_m);
        let span = |layer: &Self| (layer.first_secs, layer.last_secs, layer.ease, layer.muted);
        span(self) == span(other)
            && self.reshape == other.reshape
            && self.handles.iter().map(place).eq(other.handles.iter().map(place))
    }

    /// How much of the layer is there at a time: 0 outside the span and at its ends, 1 in between.
    pub fn presence(&self, time_secs: f64) -> f64 {
        let span = self.last_secs - self.first_secs;
        if self.muted || !(time_secs > self.first_secs && time_secs < self.last_secs) {
            return 0.0;
        }
        self.ease.presence((time_secs - self.first_secs) / span)
    }

    /// Opposite corners of the box that holds every handle's reach, head space, m; `None` of a layer without handles.
    pub fn corners_m(&self) -> Option<(Vec3, Vec3)> {
        let boxes = self.handles.iter().map(|h| {
            let reach = Vec3::repeat(h.reach_m);
            (h.center_m - reach, h.center_m + reach)
        });
        boxes.reduce(|a, b| (a.0.inf(&b.0), a.1.sup(&b.1)))
    }

    /// What the layer makes of a vector at a point, head space, m, when so much of it is there
    /// ([`FieldLayer::presence`]).
    pub fn apply(&self, point_m: Vec3, presence: f64, vector: Vec3) -> Vec3 {
        let (extra, weights) = self.gather(point_m);
        let weight = f64::min(weights, 1.0) * presence;
        match &self.reshape {
            Some(reshape) if weight > 0.0 => reshape.apply(weight, vector) + extra * presence,
            _ => vector + extra * presence,
        }
    }

    /// What the layer adds at a point, head space, m, when it is fully there. Times [`FieldLayer::presence`].
    ///
    /// The weighted mean of the handles' vectors where their weights add up to more than 1, their weighted sum
    /// where they do not: one handle gives its own vector at its center, many close together do not pile up.
    pub fn extra_at(&self, point_m: Vec3) -> Vec3 {
        self.gather(point_m).0
    }

    /// [`FieldLayer::extra_at`], and the sum of the handles' weights.
    fn gather(&self, point_m: Vec3) -> (Vec3, f64) {
        let mut sum = Vec3::zeros();
        let mut weights = 0.0;
        for handle in &self.handles {
            let weight = handle.weight(point_m);
            if weight > 0.0 {
                sum += handle.extra * weight;
                weights += weight;
            }
        }
        (sum / f64::max(weights, 1.0), weights)
    }
}

impl Reshape {
    /// What becomes of a vector where the layer has this weight, 0 to 1: turned and stretched by so much of the way,
    /// so that a turn keeps its length everywhere.
    pub fn apply(&self, weight: f64, vector: Vec3) -> Vec3 {
        let turned = Rotation3::new(self.turn * weight) * vector;
        turned * (1.0 + (self.scale - 1.0) * weight)
    }
}

impl Ease {
    /// How much of the layer is there at a share of its span between 0 and 1.
    pub fn presence(&self, share: f64) -> f64 {
        let rise = if self.rise > 0.0 { smooth_step(share / self.rise) } else { 1.0 };
        let fall = if self.fall > 0.0 { smooth_step((1.0 - share) / self.fall) } else { 1.0 };
        rise * fall
    }
}

impl Handle {
    /// 1 at the center, falling smoothly (twice differentiable) to 0 at the reach and staying there.
    ///
    /// The paper's exp(l²/(l−p)²) grows without bound where a weight of 1 is meant and tends to 1 where 0 is
    /// (`docs/equations.md`, E4). This is Wendland's compact function of the same intent (Wendland 1995, φ3,1).
    pub fn weight(&self, point_m: Vec3) -> f64 {
        // Most handles of a long way are out of reach: they cost neither root nor quotient.
        let away2_m2 = (point_m - self.center_m).norm_squared();
        if away2_m2 >= self.reach_m * self.reach_m {
            return 0.0;
        }
        let share = away2_m2.sqrt() / self.reach_m;
        let left = 1.0 - share;
        let left2 = left * left;
        left2 * left2 * (4.0 * share + 1.0)
    }
}

/// 0 below 0, 1 above 1, the quintic 6x⁵ − 15x⁴ + 10x³ between: value, slope and bend meet at both ends.
fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (x * (6.0 * x - 15.0) + 10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(handles: Vec<Handle>) -> FieldLayer {
        FieldLayer {
            id: "1".into(),
            name: "lift".into(),
            muted: false,
            first_secs: 1.0,
            last_secs: 2.0,
            ease: Ease { rise: 0.5, fall: 0.25 },
            handles,
            reshape: None,
            origin: LayerOrigin::Drag {
                strand: "S01".into(),
                control_point: 3,
                target_m: Vec3::zeros(),
                method: "paper".into(),
            },
        }
    }

    #[test]
    fn a_layer_is_nothing_before_its_first_key_and_comes_without_a_jump() {
        let layer = layer(Vec::new());
        assert_eq!(layer.presence(1.0), 0.0);
        assert!(layer.presence(1.001) < 1e-7);
        assert_eq!(layer.presence(1.5), 1.0);
        assert_eq!(layer.presence(1.75), 1.0);
        assert!(layer.presence(1.999) < 1e-6);
        assert_eq!(layer.presence(2.0), 0.0);
        assert_eq!(FieldLayer { muted: true, ..layer }.presence(1.5), 0.0);
    }

    /// A quarter turn to the left of half the strength: at the center, half of the way by halves, nothing at the reach.
    #[test]
    fn a_layer_turns_and_weakens_the_wind_that_is_there() {
        let handle = Handle { center_m: Vec3::zeros(), reach_m: 0.1, extra: Vec3::zeros() };
        let reshape = Reshape { turn: Vec3::z() * core::f64::consts::FRAC_PI_2, scale: 0.5 };
        let layer = FieldLayer { reshape: Some(reshape), ..layer(vec![handle]) };
        let at = |x: f64, presence: f64| layer.apply(Vec3::x() * x, presence, Vec3::x() * 4.0);
        assert!((at(0.0, 1.0) - Vec3::y() * 2.0).norm() < 1e-12);
        assert!((at(0.0, 0.5) - Vec3::new(1.0, 1.0, 0.0).normalize() * 3.0).norm() < 1e-12);
        assert_eq!(at(0.1, 1.0), Vec3::x() * 4.0);
    }

    #[test]
    fn a_layer_that_does_nothing_says_so() {
        let handle = Handle { center_m: Vec3::zeros(), reach_m: 0.1, extra: Vec3::x() };
        let calm = Some(Reshape { turn: Vec3::zeros(), scale: 0.0 });
        let idle = Handle { extra: Vec3::zeros(), ..handle };
        assert!(!layer(vec![idle, handle]).does_nothing());
        assert!(layer(vec![idle]).does_nothing() && layer(Vec::new()).does_nothing());
        assert!(!FieldLayer { reshape: calm, ..layer(vec![idle]) }.does_nothing());
        assert!(FieldLayer { muted: true, ..layer(vec![handle]) }.does_nothing());
    }

    #[test]
    fn handles_do_not_pile_up() {
        let handle = Handle { center_m: Vec3::zeros(), reach_m: 0.1, extra: Vec3::x() };
        assert_eq!(layer(vec![handle]).extra_at(Vec3::zeros()), Vec3::x());
        assert_eq!(layer(vec![handle; 5]).extra_at(Vec3::zeros()), Vec3::x());
        assert_eq!(layer(vec![handle; 5]).extra_at(Vec3::new(0.1, 0.0, 0.0)), Vec3::zeros());
    }
}
