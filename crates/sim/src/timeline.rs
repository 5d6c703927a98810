use crate::{SimError, SimOptions, TimeMode};
use tousle_core::{HeadMotion, Pose, PoseTrack, Vec3};
use tousle_field::{FieldSequence, FieldSlice, Scene};
use tousle_rod::Surface;

/// When the frames are, into how many steps each is cut, and what the world does in each step.
#[derive(Clone, Debug)]
pub(crate) struct Timeline<'a> {
    field: &'a FieldSequence,
    scene: &'a Scene,
    head: Head<'a>,
    time: TimeMode,
    start_secs: f64,
    rate_hz: f64,
    /// Frames of the result, the first at the start.
    pub n_frames: usize,
    /// Steps from one frame to the next.
    pub steps_per_frame: usize,
    /// The step, s.
    pub dt_secs: f64,
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
    pub wind: Option<FieldSlice<'a>>,
    /// Gravity in the middle of the step, m/s².
    pub gravity: Vec3,
    /// The head in the middle of the step; `None` while it never moves.
    pub head: Option<HeadMotion>,
    /// The body's surfaces at the end of the step, in the body's order.
    pub surfaces: Vec<Surface>,
    /// How the torso moves during the step as the head sees it: a point of it after the step to the same point
    /// before it, head space; `None` while the head never moves.
    pub torso_before_from_after: Option<Pose>,
}

/// The most frames, steps a frame and control points in all frames: 12 GB of result.
const MAX_FRAMES: f64 = 1e7;
const MAX_STEPS_PER_FRAME: f64 = 1e6;
const MAX_POSITIONS: f64 = 1e9;

impl<'a> Timeline<'a> {
    /// The timeline of a run over `n_points` control points with steps not longer than `dt_secs`.
    pub fn new(
        field: &'a FieldSequence,
        scene: &'a Scene,
        options: &'a SimOptions,
        dt_secs: f64,
        n_points: usize,
    ) -> Result<Self, SimError> {
        check_number("rate_hz", options.rate_hz, f64::MIN_POSITIVE, "a number above 0")?;
        check_number("dt_secs", dt_secs, f64::MIN_POSITIVE, "a number above 0")?;
        let start_secs = options.start_secs.unwrap_or(field.start_secs);
        check_number("start_secs", start_secs, f64::MIN, "a finite number")?;
        let duration_secs =
            options.duration_secs.unwrap_or_else(|| f64::max(field.end_secs() - start_secs, 0.0));
        check_number("duration_secs", duration_secs, 0.0, "0 or a number above")?;
        // A share of 1e-9 of a frame keeps the last one where the span is a whole number of frames.
        let n_frames = (duration_secs * options.rate_hz * (1.0 + 1e-12) + 1e-9).floor() + 1.0;
        if n_frames > MAX_FRAMES || n_frames * n_points as f64 > MAX_POSITIONS {
            return Err(SimError::BadOption {
                option: "duration_secs",
                found: duration_secs,
                expected: "at most 1e7 frames and 1e9 positions",
            });
        }
        let steps_per_frame = (1.0 / (options.rate_hz * dt_secs) - 1e-9).ceil().max(1.0);
        if steps_per_frame > MAX_STEPS_PER_FRAME {
            return Err(SimError::BadOption {
                option: "dt_secs",
                found: dt_secs,
                expected: "at most 1e6 steps a frame",
            });
        }
        Ok(Self {
            field,
            scene,
            head: Head::new(scene, options),
            time: options.time,
            start_secs,
            rate_hz: options.rate_hz,
            n_frames: n_frames as usize,
            steps_per_frame: steps_per_frame as usize,
            dt_secs: 1.0 / (options.rate_hz * steps_per_frame),
        })
    }

    /// Time of a frame, s on the field's clock.
    pub fn frame_secs(&self, frame: usize) -> f64 {
        self.start_secs + frame as f64 / self.rate_hz
    }

    /// Whether the head never moves in this run.
    pub fn head_is_still(&self) -> bool {
        self.head.is_still
    }

    /// Gravity in head axes in the pose in which the groom hangs still, m/s².
    pub fn gravity_at_rest(&self) -> Vec3 {
        self.scene.rest_pose.rotation.inverse() * self.scene.gravity_world
    }

    /// Angle between gravity as the head feels it at the start and in the rest pose, rad.
    pub fn tilt_at_start(&self) -> f64 {
        let at_start = self.head_at(self.start_secs).world_from_head.rotation.inverse();
        (at_start * self.scene.gravity_world).angle(&self.gravity_at_rest())
    }

    /// What the world does in step `step` (from 0) after frame `frame`.
    pub fn step_scene(&self, frame: usize, step: usize) -> StepScene<'a> {
        let begin = self.frame_secs(frame) + step as f64 * self.dt_secs;
        let middle = begin + 0.5 * self.dt_secs;
        let head = self.head_at(middle);
        let torso = self.torso_at(begin + self.dt_secs);
        StepScene {
            dt_secs: self.dt_secs,
            wind: self.wind_secs(middle).map(|secs| self.field.at(secs)),
            gravity: head.world_from_head.rotation.inverse() * self.scene.gravity_world,
            head: (!self.head.is_still).then_some(head),
            surfaces: Surface::of_body(&self.scene.body, &torso),
            torso_before_from_after: (!self.head.is_still).then(|| self.torso_at(begin) * torso.inverse()),
        }
    }

    fn torso_at(&self, secs: f64) -> Pose {
        let head = self.head_at(secs);
        self.scene.body.head_from_torso(&head.world_from_head, &self.head.torso_rest)
    }

    fn head_at(&self, secs: f64) -> HeadMotion {
        // The shot's own motion has its own end; the capture's is played again with the capture's wind.
        let wraps = self.time == TimeMode::Loop && !self.head.is_shot;
        self.head.poses.motion_at(if wraps { self.wrapped(secs) } else { secs })
    }

    fn wind_secs(&self, secs: f64) -> Option<f64> {
        match self.time {
            TimeMode::Hold => Some(secs),
            TimeMode::Loop => Some(self.wrapped(secs)),
            TimeMode::Once => self.has_wind_at(secs).then_some(secs),
        }
    }

    fn has_wind_at(&self, secs: f64) -> bool {
        // A single step stands for all times.
        self.field.steps.len() == 1 || (self.field.start_secs..=self.field.end_secs()).contains(&secs)
    }

    fn wrapped(&self, secs: f64) -> f64 {
        let span = self.field.end_secs() - self.field.start_secs;
        if span > 0.0 {
            self.field.start_secs + (secs - self.field.start_secs).rem_euclid(span)
        } else {
            secs
        }
    }
}

impl<'a> Head<'a> {
    fn new(scene: &'a Scene, options: &'a SimOptions) -> Self {
        match &options.head {
            // A shot's world is not the capture's: its torso faces where its head faces at first.
            Some(poses) => {
                Self { poses, torso_rest: poses.poses[0], is_shot: true, is_still: poses.is_still() }
            }
            None => {
                let poses = &scene.poses;
                Self { poses, torso_rest: scene.rest_pose, is_shot: false, is_still: poses.is_still() }
            }
        }
    }
}

fn check_number(
    option: &'static str,
    found: f64,
    least: f64,
    expected: &'static str,
) -> Result<(), SimError> {
    if found.is_finite() && found >= least {
        Ok(())
    } else {
        Err(SimError::BadOption { option, found, expected })
    }
}
