use crate::manifest::Manifest;
use crate::scan::{Findings, Listener, scan};
use crate::{Attachment, EffError};
use serde::Serialize;
use std::io::Read;
use tousle_field::{Field, FieldLayer, VoxelFlag};

/// What is in a field file, and how good it is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inspection {
    /// Always `field`.
    pub kind: &'static str,
    /// Always `eff`.
    pub format: &'static str,
    /// The manifest.
    pub manifest: Manifest,
    /// The field's first and last time, s.
    pub field_span_secs: [f64; 2],
    /// The pose track's first and last time, s.
    pub pose_span_secs: [f64; 2],
    /// What is on each channel.
    pub channels: Vec<ChannelSize>,
    /// Where the vectors come from, and how large they are.
    pub coverage: Coverage,
    /// The edits that the layers are of, in order: name, then id, and whether they are muted.
    pub layers: Vec<String>,
    /// Names and sizes of the attachments.
    pub attachments: Vec<(String, u64)>,
    /// The file's length, bytes.
    pub n_bytes: u64,
}

fn in_words(layer: &FieldLayer) -> String {
    let muted = if layer.muted { ", muted" } else { "" };
    format!("{} ({}){muted}", layer.name, layer.edit_id())
}

/// How much is on a channel.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ChannelSize {
    /// The channel's topic.
    pub topic: String,
    /// Its messages.
    pub n_messages: u64,
    /// Their payloads, unpacked, bytes.
    pub n_bytes: u64,
}

/// Where the vectors of all steps come from, and how large they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Coverage {
    /// Share of voxels, over all steps, in which a marker was.
    pub measured: f64,
    /// Share of voxels between measured ones.
    pub interpolated: f64,
    /// Share of voxels that were taken from outside.
    pub outside: f64,
    /// Share of voxels that were measured in at least one step.
    pub ever_measured: f64,
    /// Mean length of the vectors in measured voxels, in the quantity's unit.
    pub mean_measured_length: f64,
    /// Length of the longest vector, in the quantity's unit.
    pub max_length: f64,
    /// Mean standard deviation over all voxels and steps where it is known, in the quantity's unit.
    pub mean_sd: Option<f64>,
}

/// Says what is in a file.
///
/// # Errors
/// Those of [`crate::read`]: a file that is not sound is not described.
pub fn inspect<R: Read>(input: R) -> Result<Inspection, EffError> {
    let mut tally = Tally::default();
    let mut findings = Findings::first_error();
    let mut counted = Counted { inner: input, n_bytes: 0 };
    scan(&mut counted, &mut tally, &mut findings)?;
    if let Some(finding) = findings.into_first_error() {
        return Err(Box::new(finding).into());
    }
    let Some(manifest) = tally.manifest.take() else {
        return Err(EffError::bad("manifest", "none", "a sound manifest"));
    };
    let n_steps = tally.n_steps;
    let field_span_secs = [manifest.field.start_secs, manifest.field.step_secs(n_steps.saturating_sub(1))];
    let pose_span_secs =
        [manifest.pose.start_secs, manifest.pose.pose_secs(manifest.pose.n_poses.saturating_sub(1))];
    Ok(Inspection {
        kind: "field",
        format: "eff",
        field_span_secs,
        pose_span_secs,
        coverage: tally.coverage(),
        channels: tally.channels,
        layers: tally.layers,
        attachments: tally.attachments,
        n_bytes: counted.n_bytes,
        manifest,
    })
}

/// What is counted on the way.
#[derive(Default)]
struct Tally {
    manifest: Option<Manifest>,
    layers: Vec<String>,
    attachments: Vec<(String, u64)>,
    channels: Vec<ChannelSize>,
    n_steps: u64,
    n_flags: [u64; 3],
    ever_measured: Vec<bool>,
    sum_measured: f64,
    max_length_squared: f64,
    sum_sd: f64,
    n_sd: u64,
}

impl Listener for Tally {
    fn manifest(&mut self, manifest: &Manifest) -> Result<(), EffError> {
        self.manifest = Some(manifest.clone());
        Ok(())
    }

    fn message(&mut self, topic: &'static str, n_bytes: usize) {
        let channel = match self.channels.iter_mut().position(|c| c.topic == topic) {
            Some(k) => &mut self.channels[k],
            None => {
                self.channels.push(ChannelSize { topic: topic.into(), n_messages: 0, n_bytes: 0 });
                let last = self.channels.len() - 1;
                &mut self.channels[last]
            }
        };
        channel.n_messages += 1;
        channel.n_bytes += n_bytes as u64;
    }

    fn edits(&mut self, layers: Vec<FieldLayer>) {
        self.layers = layers.iter().map(in_words).collect();
        self.layers.dedup();
    }

    fn step(&mut self, step: Field) -> Result<(), EffError> {
        self.n_steps += 1;
        self.ever_measured.resize(step.flags.len(), false);
        for (voxel, flag) in step.flags.iter().enumerate() {
            self.n_flags[*flag as usize] += 1;
            let squared = step.vector(voxel).norm_squared();
            self.max_length_squared = self.max_length_squared.max(squared);
            if *flag == VoxelFlag::Measured {
                self.ever_measured[voxel] = true;
                self.sum_measured += squared.sqrt();
            }
        }
        for sd in step.sd.iter().flatten().filter(|sd| sd.is_finite()) {
            self.sum_sd += f64::from(*sd);
            self.n_sd += 1;
        }
        Ok(())
    }

    fn attachment(&mut self, attachment: Attachment) {
        self.attachments.push((attachment.name, attachment.bytes.len() as u64));
    }
}

impl Tally {
    fn coverage(&self) -> Coverage {
        let share = |n: u64, of: u64| if of > 0 { n as f64 / of as f64 } else { 0.0 };
        let [outside, interpolated, measured] = self.n_flags;
        let all = outside + interpolated + measured;
        let ever = self.ever_measured.iter().filter(|m| **m).count() as u64;
        Coverage {
            measured: share(measured, all),
            interpolated: share(interpolated, all),
            outside: share(outside, all),
            ever_measured: share(ever, self.ever_measured.len() as u64),
            mean_measured_length: if measured > 0 { self.sum_measured / measured as f64 } else { 0.0 },
            max_length: self.max_length_squared.sqrt(),
            mean_sd: (self.n_sd > 0).then(|| self.sum_sd / self.n_sd as f64),
        }
    }
}

/// A stream that counts.
struct Counted<R> {
    inner: R,
    n_bytes: u64,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        let n = self.inner.read(bytes)?;
        self.n_bytes += n as u64;
        Ok(n)
    }
}
