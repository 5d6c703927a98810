use crate::options::n_frames;
use crate::plan::Terms;
use crate::{SimError, SimOptions, TimeMode, TorsoGrip};
use core::ops::Range;
use tousle_core::{Attachment, HeadMotion, Pose, PoseTrack, Vec3};
use tousle_field::{FieldLayer, FieldSequence, Moment, Reading, Sampler, Scene};
use tousle_lanes::{Lane, Matrix, Vector};
use tousle_rod::Surface;

/// When the frames are, into how many steps each is cut, and what the world does in each step.
#[derive(Clone, Debug)]
pub(crate) struct Timeline<'a> {
    field: &'a FieldSequence,
    layers: &'a [FieldLayer],
    scene: &'a Scene,
    head: Head<'a>,
    time: TimeMode,
    torso_grip: TorsoGrip,
    start_secs: f64,
    rate_hz: f64,
    /// Frames of the result, the first at the start.
    pub n_frames: usize,
    /// Steps from one frame to the next.
    pub steps_per_frame: usize,
    /// The terms that the field and the scene ask for.
    pub terms: Terms,
}

/// The head's motion, and the pose in which the torso has its rest place.
#[derive(Clone, Debug)]
struct Head<'a> {
    poses: &'a PoseTrack,
    torso_rest: Pose,
    is_shot: bool,
    is_still: bool,
}

/// What the world does during one step, head axes.
#[derive(Clone, Debug)]
pub(crate) struct StepScene<'a> {
    /// The step, s.
    pub dt_secs: f64,
    /// The field in the middle of the step; `None` where no wind blows.
    pub wind: Option<Moment<'a>>,
    /// Gravity in the middle of the step, m/s².
    pub gravity: Vec3,
    /// The head in the middle of the step; `None` if it never moves.
    pub head: Option<HeadMotion>,
    /// The body's surfaces at the end of the step, in the body's order.
    pub surfaces: Vec<Surface>,
    /// A point of the torso's surface after the step to the same point before it, both in head space; `None` if it
    /// does not move against the head.
    torso_before_from_after: Option<Pose>,
}

/// The strongest that the head does to hair in a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StrongestPull {
    /// Gravity and the acceleration of the head's center, m/s².
    pub acceleration: f64,
    /// What each meter from the center adds, s⁻².
    pub per_meter: f64,
}

/// The most frames, steps a frame, and control points in all frames of a motion that is held: 12 GB.
const MAX_FRAMES: f64 = 1e7;
const MAX_STEPS_PER_FRAME: f64 = 1e6;
const MAX_POSITIONS: f64 = 1e9;

/// A head that ends no farther, m and rad, from where it began goes on when it is played again: what it then moves by in a step is
/// not felt.
const SEAM_M: f64 = 1e-3;
const SEAM_RAD: f64 = 1e-2;

/// How often hair is run through a field.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Runs {
    Once,
    Again,
}

/// More points than this, and a step's field is laid together for the whole grid before they ask.
const TOGETHER_FROM: usize = 6_000;

/// More points that ask for each step of the field than this share of its voxels, and it is laid out before they do.
const LAID_OUT_FROM: f64 = 0.2;

impl StepScene<'_> {
    /// Velocity of the body's surface at points of head space, m/s: the torso moves as the head sees it.
    #[inline(always)]
    pub fn surface_velocity<L: Lane>(&self, on_torso: bool, points_m: Vector<L>) -> Vector<L> {
        let like = points_m.x;
        match &self.torso_before_from_after {
            Some(pose) if on_torso => {
                let turn = Matrix::same(like, pose.rotation.to_rotation_matrix().matrix());
                let before_m = turn.mul_vector(points_m) + Vector::same(like, pose.translation.vector);
                (points_m - before_m) * like.same(1.0 / self.dt_secs)
            }
            _ => Vector::none(like),
        }
    }
}

/// Refuses what gives more frames than there can be: of the rate and the time the one that is not usual.
fn check_frames(
    options: &SimOptions,
    duration_secs: f64,
    can_be: impl Fn(f64) -> bool,
    expected: &'static str,
) -> Result<(), SimError> {
    if can_be(n_frames(duration_secs, options.rate_hz)) {
        return Ok(());
    }
    // A time that nobody gave, or that would do at the usual rate, is not what is wrong.
    let is_rate =
        options.duration_secs.is_none() || can_be(n_frames(duration_secs, SimOptions::default().rate_hz));
    let (option, found) =
        if is_rate { ("rate_hz", options.rate_hz) } else { ("duration_secs", duration_secs) };
    Err(bad_option(option, found, expected))
}

impl<'a> Timeline<'a> {
    /// The timeline of a run without layers and with one step a frame.
    pub fn new(
        field: &'a FieldSequence,
        scene: &'a Scene,
        options: &'a SimOptions,
    ) -> Result<Self, SimError> {
        check_above_zero("rate_hz", options.rate_hz)?;
        let start_secs = options.start_secs.unwrap_or(field.start_secs);
        if !start_secs.is_finite() {
            return Err(bad_option("start_secs", start_secs, "a finite number"));
        }
        let to_the_end = || f64::max(field.end_secs() - start_secs, 0.0);
        let duration_secs = options.duration_secs.unwrap_or_else(to_the_end);
        if !(duration_secs.is_finite() && duration_secs >= 0.0) {
            return Err(bad_option("duration_secs", duration_secs, "0 or a number above"));
        }
        let n_frames = n_frames(duration_secs, options.rate_hz);
        check_frames(options, duration_secs, |n_frames| n_frames <= MAX_FRAMES, "at most 1e7 frames")?;
        let head = Head::new(scene, options);
        Ok(Self {
            field,
            layers: &[],
            scene,
            terms: Terms::new(field, scene, head.is_still),
            head,
            time: options.time,
            torso_grip: options.torso_grip,
            start_secs,
            rate_hz: options.rate_hz,
            n_frames: n_frames as usize,
            steps_per_frame: 1,
        })
    }

    /// Refuses a motion that is too large to be held, of so many control points.
    pub fn check_held(&self, options: &SimOptions, n_points: usize) -> Result<(), SimError> {
        let duration_secs = (self.n_frames - 1) as f64 / self.rate_hz;
        let can_be = |n_frames: f64| n_frames * n_points as f64 <= MAX_POSITIONS;
        check_frames(options, duration_secs, can_be, "at most 1e9 positions of control points in all frames")
    }

    /// The same with layers on the field.
    pub fn with_layers(&self, layers: &'a [FieldLayer]) -> Self {
        Self { layers, terms: self.terms.with_layers(layers), ..self.clone() }
    }

    /// The layers on the field.
    pub fn layers(&self) -> &'a [FieldLayer] {
        self.layers
    }

    /// Cuts the frames into equal steps not longer than the given one, or if nobody gave one, the default.
    pub fn cut(&mut self, given_secs: Option<f64>, default_secs: f64) -> Result<(), SimError> {
        let dt_secs = given_secs.unwrap_or(default_secs);
        check_above_zero("dt_secs", dt_secs)?;
        let steps = (1.0 / (self.rate_hz * dt_secs) - 1e-6).ceil().max(1.0);
        if steps > MAX_STEPS_PER_FRAME {
            let expected = "at most 1e6 steps a frame (an explicit integrator's own limit may ask for more)";
            // Where nobody gave a step it is the frames that are too long.
            let (option, found) = given_secs.map_or(("rate_hz", self.rate_hz), |given| ("dt_secs", given));
            return Err(bad_option(option, found, expected));
        }
        self.steps_per_frame = steps as usize;
        Ok(())
    }

    /// From one frame to the next, s.
    pub fn frame_span_secs(&self) -> f64 {
        1.0 / self.rate_hz
    }

    /// The step, s.
    pub fn dt_secs(&self) -> f64 {
        1.0 / (self.rate_hz * self.steps_per_frame as f64)
    }

    /// Steps in all.
    pub fn n_steps(&self) -> usize {
        (self.n_frames - 1) * self.steps_per_frame
    }

    /// Time of a frame, s on the field's clock.
    pub fn frame_secs(&self, frame: usize) -> f64 {
        self.start_secs + frame as f64 / self.rate_hz
    }

    /// Time at which a step, from 0, begins, s on the field's clock.
    pub fn step_secs(&self, step: usize) -> f64 {
        let (frame, within) = (step / self.steps_per_frame, step % self.steps_per_frame);
        self.frame_secs(frame) + within as f64 * self.dt_secs()
    }

    /// Gravity in head axes in the pose in which the groom hangs still, m/s².
    pub fn gravity_at_rest(&self) -> Vec3 {
        self.scene.rest_pose.rotation.inverse() * self.scene.gravity_world
    }

    /// Angle between gravity as the head feels it at the start and in the rest pose, rad.
    pub fn tilt_at_start(&self) -> f64 {
        let head_from_world = self.head_at(self.start_secs).world_from_head.rotation.inverse();
        (head_from_world * self.scene.gravity_world).angle(&self.gravity_at_rest())
    }

    /// The strongest that gravity and the head do, looked for at every frame.
    pub fn strongest_pull(&self) -> StrongestPull {
        let gravity = self.scene.gravity_world.norm();
        let mut strongest = StrongestPull { acceleration: gravity, per_meter: 0.0 };
        for frame in 0..if self.head.is_still { 0 } else { self.n_frames } {
            let head = self.head_at(self.frame_secs(frame));
            strongest.acceleration = strongest.acceleration.max(gravity + head.acceleration.norm());
            let turning = head.angular_acceleration.norm() + head.angular_velocity.norm_squared();
            strongest.per_meter = strongest.per_meter.max(turning);
        }
        strongest
    }

    /// The head's motion, if it is the shot's own.
    pub fn shot_head(&self) -> Option<&PoseTrack> {
        self.head.is_shot.then_some(self.head.poses)
    }

    /// How the field is best read by some points in every step.
    pub fn reading(&self, n_points: usize, runs: Runs) -> Reading {
        let per_field_step = n_points as f64 / (self.dt_secs() * self.field.rate_hz);
        let few = per_field_step <= LAID_OUT_FROM * self.field.grid.n_voxels() as f64;
        match runs {
            Runs::Once if few => Reading::AsTheyLie,
            _ if n_points > TOGETHER_FROM => Reading::Together,
            _ => Reading::LaidOut,
        }
    }

    /// What the world does in a step, from 0.
    pub fn step_scene<'b>(&self, step: usize, sampler: &'b Sampler<'b>, reading: Reading) -> StepScene<'b> {
        let dt_secs = self.dt_secs();
        let begin = self.step_secs(step);
        let middle = begin + 0.5 * dt_secs;
        let head = self.head_at(middle);
        let torso = self.torso_at(begin + dt_secs);
        let moves = self.terms.head_movement;
        StepScene {
            dt_secs,
            wind: self.wind_secs(middle).map(|secs| sampler.at(secs, reading)),
            gravity: head.world_from_head.rotation.inverse() * self.scene.gravity_world,
            head: moves.then_some(head),
            surfaces: Surface::of_body(&self.scene.body, &torso),
            torso_before_from_after: (moves
                && self.torso_grip == TorsoGrip::Torso
                && !self.is_cut_within(begin, begin + dt_secs))
            .then(|| self.torso_at(begin) * torso.inverse()),
        }
    }

    /// Where the torso is at a time.
    pub fn torso_at(&self, secs: f64) -> Pose {
        self.torso(&self.head_at(secs))
    }

    /// Where the torso is, of a head that is somewhere.
    pub fn torso(&self, head: &HeadMotion) -> Pose {
        self.scene.body.head_from_torso(&head.world_from_head, &self.head.torso_rest)
    }

    pub fn head_at(&self, secs: f64) -> HeadMotion {
        // The shot's own motion has its own end; the capture's is played again with the capture's wind.
        let wraps = self.time == TimeMode::Loop && !self.head.is_shot;
        self.head.poses.motion_at(if wraps { self.wrapped(secs) } else { secs })
    }

    /// Whether the head is, after `from_secs` and no later than `to_secs`, somewhere else at once: at a cut of its own track, and
    /// where the capture's is played again and did not end where it began.
    pub fn is_cut_within(&self, from_secs: f64, to_secs: f64) -> bool {
        let poses = self.head.poses;
        if self.time != TimeMode::Loop || self.head.is_shot {
            return poses.is_cut_within(from_secs, to_secs);
        }
        let (start, end) = (self.field.start_secs, self.field.end_secs());
        let turns = |secs: f64| ((secs - start) / (end - start)).floor();
        if end > start && turns(from_secs) < turns(to_secs) {
            let [first, last] = [start, end].map(|secs| poses.motion_at(secs).world_from_head);
            return (first.translation.vector - last.translation.vector).norm() > SEAM_M
                || first.rotation.angle_to(&last.rotation) > SEAM_RAD;
        }
        poses.is_cut_within(self.wrapped(from_secs), self.wrapped(to_secs))
    }

    /// How a surface moves over the ground at a time: the velocity of its point at the head's center, and what turns
    /// it, head axes.
    pub fn surface_motion(&self, head: &HeadMotion, attachment: Attachment) -> (Vec3, Vec3) {
        match (attachment, self.torso_grip) {
            (Attachment::Head, _) | (Attachment::Torso, TorsoGrip::Head) => {
                (head.velocity, head.angular_velocity)
            }
            // The torso shares the pivot with the head and does not turn.
            (Attachment::Torso, TorsoGrip::Torso) => {
                (head.velocity + head.angular_velocity.cross(&self.scene.body.pivot_m), Vec3::zeros())
            }
        }
    }

    /// Gravity, world axes, m/s².
    pub fn gravity_world(&self) -> Vec3 {
        self.scene.gravity_world
    }

    /// What hair on the torso rubs on.
    pub fn torso_grip(&self) -> TorsoGrip {
        self.torso_grip
    }

    /// What hair can touch.
    pub fn body(&self) -> &'a tousle_core::Body {
        &self.scene.body
    }

    /// The time on the field's clock whose wind blows at a time; `None` where none does.
    pub fn wind_secs(&self, secs: f64) -> Option<f64> {
        let blows = self.terms.wind && (self.time != TimeMode::Once || self.has_wind_at(secs));
        let secs = if self.time == TimeMode::Loop { self.wrapped(secs) } else { secs };
        blows.then_some(secs)
    }

    /// The times on the field's clock between which all wind of some steps blows; all times if the field begins anew in
    /// between.
    pub fn wind_span_secs(&self, steps: &Range<usize>) -> (f64, f64) {
        let (begin, end) = (self.step_secs(steps.start), self.step_secs(steps.end));
        if self.time != TimeMode::Loop {
            return (begin, end);
        }
        let (from, to) = (self.wrapped(begin), self.wrapped(end));
        let is_unbroken = to - from > 0.5 * (end - begin);
        if is_unbroken { (from, to) } else { (f64::NEG_INFINITY, f64::INFINITY) }
    }

    fn has_wind_at(&self, secs: f64) -> bool {
        // A single step stands for all times.
        self.field.steps.len() == 1 || (self.field.start_secs..=self.field.end_secs()).contains(&secs)
    }

    fn wrapped(&self, secs: f64) -> f64 {
        let (start, span) = (self.field.start_secs, self.field.end_secs() - self.field.start_secs);
        if span > 0.0 { start + (secs - start).rem_euclid(span) } else { secs }
    }
}

impl<'a> Head<'a> {
    fn new(scene: &'a Scene, options: &'a SimOptions) -> Self {
        let (poses, torso_rest) = match &options.head {
            // A shot's world is not the capture's: its torso faces where its head faces at first.
            Some(poses) => (poses, poses.poses[0]),
            None => (&scene.poses, scene.rest_pose),
        };
        Self { poses, torso_rest, is_shot: options.head.is_some(), is_still: poses.is_still() }
    }
}

fn check_above_zero(option: &'static str, found: f64) -> Result<(), SimError> {
    if found.is_finite() && found > 0.0 { Ok(()) } else { Err(bad_option(option, found, "a number above 0")) }
}

fn bad_option(option: &'static str, found: f64, expected: &'static str) -> SimError {
    SimError::BadOption { option, found, expected }
}
