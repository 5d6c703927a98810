use super::contact::MovingSurface;
use crate::timeline::Timeline;
use tousle_core::{Attachment, HeadMotion, Pose, Vec3};
use tousle_field::{Moment, Reading, Sampler};
use tousle_rod::Surface;

/// What the world does at one time, head axes.
#[derive(Clone, Debug)]
pub(crate) struct Now<'a> {
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

/// Where what stands still over the ground has come to in head space at the end of a step in which the head moves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Carry {
    /// Since the step's begin, and since that of the step before.
    pub from: Pose,
    pub from_before: Pose,
}

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
            let own_from_head = (!is_heads).then(|| torso.inverse());
            MovingSurface { surface, velocity, angular_velocity, own_from_head }
        };
        let wind = timeline.wind_secs(secs).map(|secs| sampler.at(secs, reading));
        Self {
            is_still: head.is_none() && wind.as_ref().is_none_or(Moment::is_still),
            wind,
            gravity: motion.world_from_head.rotation.inverse() * timeline.gravity_world(),
            surfaces: Surface::of_body(body, &torso).into_iter().zip(&body.colliders).map(moving).collect(),
            head,
        }
    }

    /// Neither the head nor a surface has a velocity.
    fn stand_still(&mut self) {
        self.head = self.head.map(|head| HeadMotion::still(head.world_from_head));
        for surface in &mut self.surfaces {
            (surface.velocity, surface.angular_velocity) = Default::default();
        }
    }
}

/// What the world does at the end of a step, and what it does on the way there: nothing if the head never moves. The times:
/// when the step before began, when this one begins, and when it ends.
///
/// At a cut the hair goes along, with the shape and the velocities it had, as the head sees them, and nothing else feels
/// that the head moves.
pub(crate) fn at_end_of_step<'a>(
    timeline: &Timeline<'_>,
    sampler: &'a Sampler<'a>,
    reading: Reading,
    [before_secs, begin_secs, end_secs]: [f64; 3],
) -> (Now<'a>, Option<Carry>) {
    let mut now = Now::new(timeline, sampler, end_secs, reading);
    let Some(head) = now.head else { return (now, None) };
    let [before, begin] = [before_secs, begin_secs].map(|secs| timeline.head_at(secs).world_from_head);
    let stood_before = if timeline.is_cut_within(before_secs, begin_secs) { begin } else { before };
    let end = if timeline.is_cut_within(begin_secs, end_secs) {
        now.stand_still();
        begin
    } else {
        head.world_from_head
    };
    let head_from_world = end.inverse();
    let carry = Carry { from: head_from_world * begin, from_before: head_from_world * stood_before };
    (now, Some(carry))
}
