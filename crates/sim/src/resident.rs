//! A simulation that stays prepared while the layers on its field change.

use crate::frames::Frames;
use crate::mechanics::Setting;
use crate::paper::Paper;
use crate::physical::Physical;
use crate::ready::{self, Ready, Resident};
use crate::timeline::Runs;
use crate::{FrameSink, Keeper, Method, SimError, SimOptions, SimReport, Simulation, Steps, Traced, check};
use std::sync::Arc;
use tousle_core::{Groom, Progress, StrandMotion};
use tousle_field::{FieldLayer, FieldSequence, Scene};

/// A simulation that is prepared once and run again and again, each time under other layers.
///
/// What is worked out once: that everything can be used, the natural shapes, what each strand can touch, where the
/// field holds no air. A run gives the same bytes as [`crate::simulate`] of a field with these layers, whether all
/// strands are run or some, whether from the start or from where they were held: strands never touch one another.
#[derive(Debug)]
pub struct Simulator<'a> {
    groom: &'a Groom,
    ready: Box<dyn Resident + 'a>,
    times_secs: Vec<f64>,
}

/// Some strands of a [`Simulator`], stopped at a frame: runs that differ only later go on from here.
#[derive(Clone, Debug)]
pub struct Held {
    /// Their indices, ascending.
    strands: Vec<usize>,
    frame: usize,
    state: ready::Held,
}

impl Held {
    /// The strands, by their index in the groom, ascending.
    pub fn strands(&self) -> &[usize] {
        &self.strands
    }

    /// The frame at which they stopped.
    pub fn frame(&self) -> usize {
        self.frame
    }
}

impl<'a> Simulator<'a> {
    /// Prepares a simulation. The field's own layers are left out: every run says which there are.
    ///
    /// # Errors
    /// [`SimError`] if an option, the field, the scene or the groom cannot be used.
    pub fn new(
        field: &'a FieldSequence,
        scene: &'a Scene,
        groom: &'a Groom,
        options: &'a SimOptions,
    ) -> Result<Self, SimError> {
        Self::prepare(Setting { field, scene, groom, whole: None, options })
    }

    /// Prepares a simulation of some strands of a hairstyle, which move as they would if all of it were simulated: how natural
    /// shapes fall and what touches at rest is told from the `whole`.
    ///
    /// # Errors
    /// As [`Simulator::new`].
    pub fn of_part(
        field: &'a FieldSequence,
        scene: &'a Scene,
        part: &'a Groom,
        whole: &'a Groom,
        options: &'a SimOptions,
    ) -> Result<Self, SimError> {
        whole.check()?;
        Self::prepare(Setting { field, scene, groom: part, whole: Some(whole), options })
    }

    fn prepare(setting: Setting<'a>) -> Result<Self, SimError> {
        let Setting { field, scene, groom, options, .. } = setting;
        field.check()?;
        groom.check()?;
        check::check_scene(scene, options)?;
        check::check_options(options)?;
        let ready = match options.method {
            Method::Paper => Ready::<Paper>::resident(setting)?,
            Method::Physical => Ready::<Physical>::resident(setting)?,
        };
        let times_secs = ready.times_secs();
        Ok(Self { groom, ready, times_secs })
    }

    /// Time of every frame of a run, s.
    pub fn times_secs(&self) -> &[f64] {
        &self.times_secs
    }

    /// Runs all strands.
    ///
    /// # Errors
    /// [`SimError::Unstable`] if the layers' wind is too strong for the step of an explicit integrator.
    pub fn simulate(&self, layers: &[FieldLayer], progress: &dyn Progress) -> Result<Simulation, SimError> {
        self.ready.run(layers, None, progress, Runs::Again)
    }

    /// [`Simulator::simulate`] where it is not run again, as [`crate::simulate_kept`]: what other runs would gain by is not
    /// prepared.
    ///
    /// # Errors
    /// As [`Simulator::simulate`], and [`SimError::Keeper`], [`SimError::OtherPart`] where the keeper fails.
    pub fn simulate_once(
        &self,
        layers: &[FieldLayer],
        keeper: Option<&dyn Keeper>,
        progress: &dyn Progress,
    ) -> Result<Simulation, SimError> {
        self.ready.run(layers, keeper, progress, Runs::Once)
    }

    /// [`Simulator::simulate`] into a sink, which takes each frame as soon as it is there: nothing is held but some frames on
    /// their way, so runs may be of any length, and go faster, as memory is used again that the system would else hand out anew.
    ///
    /// # Errors
    /// As [`Simulator::simulate`], after the frames before; [`SimError::Sink`] if the sink takes no more.
    pub fn simulate_into(
        &self,
        layers: &[FieldLayer],
        sink: &mut FrameSink<'_>,
        progress: &dyn Progress,
    ) -> Result<SimReport, SimError> {
        self.ready.run_into(layers, sink, progress, Runs::Again)
    }

    /// [`Simulator::simulate_into`] where it is not run again, as [`Simulator::simulate_once`].
    ///
    /// # Errors
    /// As [`Simulator::simulate_into`].
    pub fn simulate_once_into(
        &self,
        layers: &[FieldLayer],
        sink: &mut FrameSink<'_>,
        progress: &dyn Progress,
    ) -> Result<SimReport, SimError> {
        self.ready.run_into(layers, sink, progress, Runs::Once)
    }

    /// How a run under some layers is cut into steps.
    ///
    /// # Errors
    /// As [`Simulator::simulate`].
    pub fn steps(&self, layers: &[FieldLayer]) -> Result<Steps, SimError> {
        self.ready.steps(layers)
    }

    /// [`Simulator::simulate`] for an editor: a motion that remembers where each strand asked the field.
    ///
    /// # Errors
    /// As [`Simulator::simulate`].
    pub fn trace(&self, layers: &[FieldLayer], progress: &dyn Progress) -> Result<Traced, SimError> {
        if !self.ready.is_local() {
            let motion = Arc::new(self.simulate(layers, progress)?.motion);
            return Ok(Traced { layers: layers.to_vec(), motion, whereabouts: None });
        }
        let all: Vec<usize> = (0..self.groom.strands.len()).collect();
        let (positions_m, whereabouts) = self.ready.trace(layers, &all, progress)?;
        let motion = Arc::new(self.motion(&all, (0, self.times_secs.len() - 1), positions_m));
        Ok(Traced { layers: layers.to_vec(), motion, whereabouts: Some(whereabouts) })
    }

    /// [`Simulator::trace`] under other layers than an earlier one's: only strands that feel the difference are run
    /// ([`Traced::felt_by`]), and the result is the same to the bit.
    ///
    /// # Errors
    /// As [`Simulator::simulate`].
    ///
    /// # Panics
    /// If another simulator traced the strands.
    pub fn retrace(
        &self,
        last: &Traced,
        layers: &[FieldLayer],
        progress: &dyn Progress,
    ) -> Result<Traced, SimError> {
        let strands = last.felt_by(layers);
        let (Some(before), true) = (&last.whereabouts, strands.len() < self.groom.strands.len()) else {
            return self.trace(layers, progress);
        };
        let (mut motion, mut whereabouts) = (last.motion.clone(), before.clone());
        if !strands.is_empty() {
            let (moved, asked) = self.ready.trace(layers, &strands, progress)?;
            let mut frames = Frames::filled(self.groom, motion.positions_m.clone());
            frames
                .put_all(&strands, &moved)
                .expect("all frames of these strands, of which both motions have as many");
            let (counts, times_secs) = (motion.counts.clone(), motion.times_secs.clone());
            motion = Arc::new(StrandMotion { counts, times_secs, positions_m: frames.positions_m });
            whereabouts.put(&strands, &asked);
        }
        Ok(Traced { layers: layers.to_vec(), motion, whereabouts: Some(whereabouts) })
    }

    /// Runs some strands, by their ascending indices: a motion of these alone.
    ///
    /// # Errors
    /// As [`Simulator::simulate`].
    ///
    /// # Panics
    /// If the groom has no such strand.
    pub fn simulate_some(&self, layers: &[FieldLayer], strands: &[usize]) -> Result<StrandMotion, SimError> {
        let positions_m = self.ready.run_some(layers, strands)?;
        Ok(self.motion(strands, (0, self.times_secs.len() - 1), positions_m))
    }

    /// Runs some strands, by their ascending indices, up to the last frame that is not after a time.
    ///
    /// # Errors
    /// As [`Simulator::simulate`].
    ///
    /// # Panics
    /// If the groom has no such strand.
    pub fn hold(&self, layers: &[FieldLayer], strands: &[usize], secs: f64) -> Result<Held, SimError> {
        let frame = self.frame_at(secs);
        let state = self.ready.hold(layers, strands, frame)?;
        Ok(Held { strands: strands.to_vec(), frame, state })
    }

    /// Runs held strands on up to the last frame that is not after a time, and not before the one at which they were held.
    /// The layers may differ from those before in what they do later.
    ///
    /// # Errors
    /// As [`Simulator::simulate`].
    ///
    /// # Panics
    /// If another simulator held the strands.
    pub fn hold_on(&self, held: &Held, layers: &[FieldLayer], secs: f64) -> Result<Held, SimError> {
        let frame = self.frame_at(secs).max(held.frame);
        let state = self.ready.hold_on(&held.state, layers, frame)?;
        Ok(Held { strands: held.strands.clone(), frame, state })
    }

    /// Runs held strands on to the first frame that is not before a time: a motion of these alone, from the frame at
    /// which they were held. The layers may differ from those before in what they do later.
    ///
    /// # Errors
    /// As [`Simulator::simulate`].
    ///
    /// # Panics
    /// If another simulator held the strands.
    pub fn go_on(
        &self,
        held: &Held,
        layers: &[FieldLayer],
        until_secs: f64,
    ) -> Result<StrandMotion, SimError> {
        let frames = (held.frame, self.frame_from(until_secs).max(held.frame));
        let positions_m = self.ready.go_on(&held.state, layers, &held.strands, frames)?;
        Ok(self.motion(&held.strands, frames, positions_m))
    }

    /// How many of [`Simulator::variants`] are stepped side by side: as many cost as much as one.
    pub fn n_at_once(&self) -> usize {
        self.ready.n_at_once()
    }

    /// [`Simulator::go_on`] of one strand for many variants at once: each sees its own layers beside the common ones.
    ///
    /// The variants are stepped side by side, unless each has steps of its own, and cost little more than as many strands.
    ///
    /// # Errors
    /// As [`Simulator::simulate`].
    ///
    /// # Panics
    /// If another simulator held the strand, or it is not one alone.
    pub fn variants(
        &self,
        held: &Held,
        layers: &[FieldLayer],
        variants: &[&[FieldLayer]],
        until_secs: f64,
    ) -> Result<Vec<StrandMotion>, SimError> {
        let [strand] = held.strands[..] else { panic!("{} strands, expected one", held.strands.len()) };
        let frames = (held.frame, self.frame_from(until_secs).max(held.frame));
        let moved = self.ready.variants(&held.state, layers, variants, strand, frames)?;
        Ok(moved.into_iter().map(|positions_m| self.motion(&held.strands, frames, positions_m)).collect())
    }

    /// The last frame that is not after a time; the first if there is none.
    fn frame_at(&self, secs: f64) -> usize {
        self.times_secs.partition_point(|t| *t <= secs).saturating_sub(1)
    }

    /// The first frame that is not before a time; the last if there is none.
    fn frame_from(&self, secs: f64) -> usize {
        self.times_secs.partition_point(|t| *t < secs).min(self.times_secs.len() - 1)
    }

    fn motion(&self, strands: &[usize], frames: (usize, usize), positions_m: Vec<[f32; 3]>) -> StrandMotion {
        StrandMotion {
            counts: strands.iter().map(|s| self.groom.strands[*s].rest_curve_m.len()).collect(),
            times_secs: self.times_secs[frames.0..=frames.1].to_vec(),
            positions_m,
        }
    }
}
