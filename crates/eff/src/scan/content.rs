use super::{Findings, Listener};
use crate::finding::Place;
use crate::format::{Stream, topic};
use crate::manifest::Manifest;
use crate::record::{self, Message};
use crate::{Attachment, Code, EffError, check, decode};
use std::collections::BTreeSet;
use tousle_core::WindSample;
use tousle_field::VoxelFlag;

/// The messages: decoded, checked on their own and against each other, handed on.
pub(super) struct Content<'v> {
    listener: &'v mut dyn Listener,
    manifest: Option<Manifest>,
    /// That there is none, or none that is sound, was said.
    misses_manifest: bool,
    n_edits: u64,
    n_poses: u64,
    n_samples: u64,
    n_steps: u64,
    /// The voxels that held samples at the field's steps, to compare with the flags. They come long before the
    /// flags do, so they are kept small.
    sampled: Vec<Box<[u32]>>,
}

impl<'v> Content<'v> {
    pub fn new(listener: &'v mut dyn Listener) -> Self {
        Self {
            listener,
            manifest: None,
            misses_manifest: false,
            n_edits: 0,
            n_poses: 0,
            n_samples: 0,
            n_steps: 0,
            sampled: Vec::new(),
        }
    }

    /// Takes the `position`th message of a channel in.
    pub fn message(
        &mut self,
        stream: &Stream,
        message: Message<'_>,
        position: u64,
        place: Place<'_>,
        findings: &mut Findings,
    ) -> Result<(), EffError> {
        self.listener.message(stream.topic, message.data.len());
        if u64::from(message.sequence) != position & u64::from(u32::MAX) {
            findings.push(place.finding(Code::Order, "message.sequence", message.sequence, position));
        }
        if message.publish_time != message.log_time {
            let expected = format!("the log time, {}", message.log_time);
            findings.push(place.finding(Code::Order, "message.publish_time", message.publish_time, expected));
        }
        if stream.topic == topic::MANIFEST {
            return self.manifest(message, stream.version, place, findings);
        }
        let Some(manifest) = self.manifest.take() else {
            // Without a sound manifest no message can be checked; saying so once suffices.
            if !std::mem::replace(&mut self.misses_manifest, true) {
                let found = "no manifest before it";
                findings.push(place.finding(Code::Missing, "message", found, "a manifest first"));
            }
            return Ok(());
        };
        if stream.version != manifest.version && position == 0 {
            let found = format!("messages of version {}", stream.version);
            let expected = format!("version {}, the manifest's", manifest.version);
            findings.push(place.finding(Code::Channel, "schema_id", found, expected));
        }
        let outcome = match stream.topic {
            topic::EDITS => self.edits(&manifest, message, place, findings),
            topic::POSE => self.pose(&manifest, message, place, findings),
            topic::SAMPLES => self.samples(&manifest, message, place, findings),
            _ => self.step(&manifest, message, place, findings),
        };
        self.manifest = Some(manifest);
        outcome
    }

    fn manifest(
        &mut self,
        message: Message<'_>,
        version: u32,
        place: Place<'_>,
        findings: &mut Findings,
    ) -> Result<(), EffError> {
        if self.manifest.is_some() {
            findings.push(place.finding(Code::Missing, "message", "a second manifest", "one"));
            return Ok(());
        }
        let manifest = match decode::manifest(message.data, version, place) {
            Ok(manifest) => manifest,
            Err(found) => {
                self.misses_manifest = true;
                found.into_iter().for_each(|f| findings.push(f));
                return Ok(());
            }
        };
        let n_before = findings.n_errors();
        check::manifest(&manifest, place, findings);
        if findings.n_errors() == n_before {
            self.listener.manifest(&manifest)?;
            self.manifest = Some(manifest);
        } else {
            self.misses_manifest = true;
        }
        Ok(())
    }

    fn edits(
        &mut self,
        manifest: &Manifest,
        message: Message<'_>,
        place: Place<'_>,
        findings: &mut Findings,
    ) -> Result<(), EffError> {
        self.n_edits += 1;
        if self.n_edits > 1 {
            findings.push(place.finding(Code::Missing, "message", "a second one", "one message of edits"));
            return Ok(());
        }
        match decode::edits(message.data, place) {
            Ok(edits) => {
                check::edits(&edits, &manifest.requires, place, findings);
                self.listener.edits(edits.layers.into_iter().map(Into::into).collect());
            }
            Err(found) => found.into_iter().for_each(|f| findings.push(f)),
        }
        Ok(())
    }

    fn pose(
        &mut self,
        manifest: &Manifest,
        message: Message<'_>,
        place: Place<'_>,
        findings: &mut Findings,
    ) -> Result<(), EffError> {
        let k = self.n_poses;
        self.n_poses += 1;
        match decode::pose(message.data, manifest, place) {
            Ok((stamp, pose)) => {
                check::stamp(stamp, k, manifest.pose.pose_secs(k), message.log_time, place, findings);
                self.listener.pose(pose);
            }
            Err(finding) => findings.push(finding),
        }
        Ok(())
    }

    fn samples(
        &mut self,
        manifest: &Manifest,
        message: Message<'_>,
        place: Place<'_>,
        findings: &mut Findings,
    ) -> Result<(), EffError> {
        let k = self.n_samples;
        self.n_samples += 1;
        let Some(info) = &manifest.samples else {
            if k == 0 {
                findings.push(place.finding(
                    Code::Count,
                    "message",
                    "samples",
                    "none, as the manifest states",
                ));
            }
            return Ok(());
        };
        match decode::samples(message.data, place) {
            Ok((stamp, samples)) => {
                check::stamp(stamp, k, info.step_secs(k), message.log_time, place, findings);
                if info.rate_hz == manifest.field.rate_hz && manifest.field.start_secs == 0.0 {
                    self.sampled.push(voxels_of(&samples, manifest));
                }
                self.listener.samples(samples);
            }
            Err(finding) => findings.push(finding),
        }
        Ok(())
    }

    fn step(
        &mut self,
        manifest: &Manifest,
        message: Message<'_>,
        place: Place<'_>,
        findings: &mut Findings,
    ) -> Result<(), EffError> {
        let k = self.n_steps;
        self.n_steps += 1;
        let (stamp, step) = match decode::step(message.data, manifest, place) {
            Ok(step) => step,
            Err(found) => {
                found.into_iter().for_each(|f| findings.push(f));
                return Ok(());
            }
        };
        check::stamp(stamp, k, manifest.field.step_secs(k), message.log_time, place, findings);
        if let Some(voxels) = self.sampled.get(k as usize) {
            let flag = |voxel: u32| step.flags[voxel as usize];
            let unflagged: Vec<u32> =
                voxels.iter().copied().filter(|v| flag(*v) != VoxelFlag::Measured).collect();
            if let Some(&first) = unflagged.first() {
                let what = format!("flags[{first}]");
                let found = format!("{:?} where a sample is ({} such voxels)", flag(first), unflagged.len());
                findings.push(place.finding(Code::FlagSamples, what, found, "measured"));
            }
        }
        self.listener.step(step)
    }

    /// A message of a preview came.
    pub fn preview(&mut self, topic: &'static str, n_bytes: usize) {
        self.listener.message(topic, n_bytes);
    }

    /// A message of a topic is there but cannot be read.
    pub fn skip(&mut self, topic: &str) {
        match topic {
            topic::MANIFEST => self.misses_manifest = true,
            topic::EDITS => self.n_edits += 1,
            topic::POSE => self.n_poses += 1,
            topic::SAMPLES => self.n_samples += 1,
            _ => self.n_steps += 1,
        }
    }

    pub fn attachment(&mut self, a: record::Attachment<'_>) {
        self.listener.attachment(Attachment {
            name: a.name.to_owned(),
            media_type: a.media_type.to_owned(),
            bytes: a.data.to_vec(),
        });
    }

    /// No message follows: there must have been as many as the manifest states.
    pub fn end(&mut self, place: Place<'_>, findings: &mut Findings) {
        let Some(manifest) = &self.manifest else {
            if !self.misses_manifest {
                findings.push(place.finding(Code::Missing, "manifest", "none", "one"));
            }
            return;
        };
        let counts = [
            (topic::POSE, self.n_poses, manifest.pose.n_poses),
            (topic::SAMPLES, self.n_samples, manifest.samples.as_ref().map_or(0, |s| s.n_steps)),
            (topic::FIELD, self.n_steps, manifest.field.n_steps.unwrap_or(self.n_steps.max(1))),
        ];
        for (topic, found, expected) in counts {
            if found != expected {
                let place = Place { channel: Some(topic), ..place };
                findings.push(place.finding(Code::Count, "messages", found, expected));
            }
        }
    }
}

/// The voxels that hold samples, each once.
fn voxels_of(samples: &[WindSample], manifest: &Manifest) -> Box<[u32]> {
    let grid = manifest.field.grid.spec();
    let voxels: BTreeSet<u32> =
        samples.iter().filter_map(|s| grid.voxel_at(s.position_m)).map(|v| grid.flat(v) as u32).collect();
    voxels.into_iter().collect()
}
