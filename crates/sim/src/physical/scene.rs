use super::contact::MovingSurface;
use crate::timeline::Timeline;
use nalgebra::UnitQuaternion;
use tousle_core::{Attachment, HeadMotion, Vec3};
use tousle_field::{Moment, Reading, Sampler};
use tousle_rod::Surface;

/// What the world does at one time, head axes.
#[derive(Clone, Debug)]
pub(crate) struct Now<'a> {
    /// The time, s.
    pub secs: f64,
    /// The field; `None` where no wind blows.
    pub wind: Option<Moment<'a>>,
    /// Gravity, m/s².
    pub gravity: Vec3,
    /// The body's surfaces, in the body's order.
    pub surfaces: Vec<MovingSurface>,
    /// The head's motion; `None` if it never moves.
    pub head: Option<HeadMotion>,
    /// Whether nothing can move that is at rest: no wind blows anywhere, and the head never moves.
    pub is_still: bool,
}

/// Where what stands still over the ground goes in head space during a step in which the head moves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Carry {
    pub turn: UnitQuaternion<f64>,
    pub shift: Vec3,
    /// Whether the head went where nothing that moves could follow, and takes its hair along.
    pub is_cut: bool,
}

/// A head that goes faster than this, m/s, or turns faster, rad/s, has not moved: the shot was cut there.
const CUT_SPEED: f64 = 50.0;
const CUT_TURN: f64 = 100.0;

impl<'a> Now<'a> {
    /// The world at a time.
    pub fn new(timeline: &Timeline<'_>, sampler: &'a Sampler<'a>, secs: f64, reading: Reading) -> Self {
        let motion = timeline.head_at(secs);
        let head = timeline.terms.head_movement.then_some(motion);
        let body = timeline.body();
        let torso = timeline.torso(&motion);
        let moving = |(surface, collider): (Surface, &tousle_core::Collider)| {
            let (velocity, angular_velocity) = head
                .as_ref()
                .map_or_else(Default::default, |head| timeline.surface_motion(head, collider.attachment));
            let is_heads = head.is_none() || collider.attachment == Attachment::Head;
            MovingSurface { surface, velocity, angular_velocity, is_heads }
        };
        let wind = timeline.wind_secs(secs).map(|secs| sampler.at(secs, reading));
        Self {
            secs,
            is_still: head.is_none() && wind.as_ref().is_none_or(Moment::is_still),
            wind,
            gravity: motion.world_from_head.rotation.inverse() * timeline.gravity_world(),
            surfaces: Surface::of_body(body, &torso).into_iter().zip(&body.colliders).map(moving).collect(),
            head,
        }
    }
}

impl Carry {
    /// What a step from some time to now does to what stands still over the ground; `None` if the head never moves.
    pub fn new(timeline: &Timeline<'_>, before_secs: f64, now: &Now<'_>) -> Option<Self> {
        let after = now.head.as_ref()?.world_from_head;
        let before = timeline.head_at(before_secs).world_from_head;
        let relative = after.inverse() * before;
        let dt_secs = now.secs - before_secs;
        let way = (after.translation.vector - before.translation.vector).norm();
        let is_cut = way > CUT_SPEED * dt_secs || relative.rotation.angle() > CUT_TURN * dt_secs;
        Some(Self { turn: relative.rotation, shift: relative.translation.vector, is_cut })
    }
}
