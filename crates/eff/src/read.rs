use crate::manifest::Manifest;
use crate::scan::{Findings, Listener, scan};
use crate::{Attachment, Eff, EffError};
use std::io::Read;
use tousle_core::{Pose, PoseTrack, WindSample, WindSamples};
use tousle_field::{Field, FieldLayer, FieldSequence};

/// How a field file is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ReadOptions {
    /// The most memory the field's steps may take, bytes. A file of a few kilobytes can unpack to gigabytes of
    /// still air; this says when that is no longer meant.
    pub max_memory: u64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self { max_memory: 8 << 30 }
    }
}

/// Reads a whole field file from a stream.
///
/// Every byte is checked on the way: what this accepts, [`crate::validate`] has no error for.
///
/// # Errors
/// [`EffError::Unsound`] with the first thing that is wrong, [`EffError::Io`] if the stream fails,
/// [`EffError::TooLarge`] if the steps take more than `options` allow.
pub fn read<R: Read>(input: R, options: &ReadOptions) -> Result<Eff, EffError> {
    let mut gathered = Gathered { max_memory: options.max_memory, ..Gathered::default() };
    let mut findings = Findings::first_error();
    scan(input, &mut gathered, &mut findings)?;
    match findings.into_first_error() {
        Some(finding) => Err(Box::new(finding).into()),
        None => gathered.into_eff(),
    }
}

/// Everything that a scan hands on.
#[derive(Default)]
struct Gathered {
    manifest: Option<Manifest>,
    layers: Vec<FieldLayer>,
    poses: Vec<Pose>,
    samples: Vec<Vec<WindSample>>,
    steps: Vec<Field>,
    attachments: Vec<Attachment>,
    max_memory: u64,
    memory: u64,
}

impl Listener for Gathered {
    fn manifest(&mut self, manifest: &Manifest) -> Result<(), EffError> {
        self.manifest = Some(manifest.clone());
        Ok(())
    }

    fn edits(&mut self, layers: Vec<FieldLayer>) {
        self.layers = layers;
    }

    fn pose(&mut self, pose: Pose) {
        self.poses.push(pose);
    }

    fn samples(&mut self, samples: Vec<WindSample>) {
        self.samples.push(samples);
    }

    fn step(&mut self, step: Field) -> Result<(), EffError> {
        let floats = step.u.len() + step.sd.as_ref().map_or(0, Vec::len);
        self.memory += (4 * floats + step.flags.len()) as u64;
        if self.memory > self.max_memory {
            return Err(EffError::TooLarge { needed: self.memory, allowed: self.max_memory });
        }
        self.steps.push(step);
        Ok(())
    }

    fn attachment(&mut self, attachment: Attachment) {
        self.attachments.push(attachment);
    }
}

impl Gathered {
    /// The file, of a scan that found no error.
    fn into_eff(self) -> Result<Eff, EffError> {
        let Some(manifest) = self.manifest else {
            return Err(EffError::bad("manifest", "none", "a sound manifest"));
        };
        let field = FieldSequence {
            grid: manifest.field.grid.spec(),
            quantity: manifest.field.quantity.into(),
            start_secs: manifest.field.start_secs,
            rate_hz: manifest.field.rate_hz,
            steps: self.steps,
            layers: self.layers,
        };
        let poses = PoseTrack {
            start_secs: manifest.pose.start_secs,
            rate_hz: manifest.pose.rate_hz,
            poses: self.poses,
        };
        let samples = manifest.samples.map(|info| WindSamples {
            quantity: info.quantity.into(),
            rate_hz: info.rate_hz,
            steps: self.samples,
        });
        Ok(Eff {
            name: manifest.name,
            method: manifest.method,
            generator: manifest.generator,
            field,
            scene: manifest.scene.with_poses(poses),
            samples,
            attachments: self.attachments,
        })
    }
}
