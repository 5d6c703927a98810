mod index;
mod part;

use crate::decode::Stamp;
use crate::finding::Place;
use crate::format::{time_ns, topic};
use crate::manifest::Manifest;
use crate::record::{self, Message, Record};
use crate::recover::attachment_at;
use crate::scan::chunk::{InChunk, records_in, unpack};
use crate::scan::facts::ChunkFacts;
use crate::scan::{Findings, at, broken, check_crc};
use crate::wire::proto::FieldStep;
use crate::{Attachment, Code, EffError, check, decode};
pub(crate) use index::Index;
pub use part::Part;
use prost::bytes::Bytes;
use std::io::{Read, Seek, SeekFrom};
use tousle_core::{Pose, PoseTrack, WindSample};
use tousle_field::{Field, FieldLayer, Scene};

/// Reads single steps of a field file, holding one of them at a time.
///
/// It finds its way by the summary at the file's end and reads nothing that it was not asked for; what it reads
/// it checks as [`crate::read()`] does, by the checksums of the summary and of each chunk. A file with messages outside
/// chunks is gone through once as it is opened: these are in no index, and only the checksum of all data is of them.
#[derive(Debug)]
pub struct Reader<R> {
    input: R,
    index: Index,
    manifest: Manifest,
    layers: Vec<FieldLayer>,
}

impl<R: Read + Seek> Reader<R> {
    /// Opens a field file: reads its summary, its manifest and its edits.
    ///
    /// # Errors
    /// [`EffError::Unsound`] if the file was cut or one of the three is not sound, [`EffError::Io`] if the
    /// stream fails.
    pub fn open(mut input: R) -> Result<Self, EffError> {
        let index = Index::read(&mut input)?;
        let mut manifest = None;
        each_message(&mut input, &index, topic::MANIFEST, &mut |message, place| {
            let mut findings = Findings::first_error();
            let found = decode::manifest(message.data, index.version, place).map_err(first)?;
            check::manifest(&found, place, &mut findings);
            manifest.get_or_insert(found);
            fail(findings)
        })?;
        let Some(manifest) = manifest else {
            let place = Place { channel: Some(topic::MANIFEST), ..Place::default() };
            return Err(place.finding(Code::Missing, "manifest", "none", "a sound manifest").into());
        };
        let mut layers = Vec::new();
        each_message(&mut input, &index, topic::EDITS, &mut |message, place| {
            let mut findings = Findings::first_error();
            let edits = decode::edits(message.data, place).map_err(first)?;
            check::edits(&edits, &manifest.requires, place, &mut findings);
            layers = edits.layers.into_iter().map(Into::into).collect();
            fail(findings)
        })?;
        let reader = Self { input, index, manifest, layers };
        reader.check_count(topic::FIELD, reader.manifest.field.n_steps.unwrap_or(reader.n_steps().max(1)))?;
        reader.check_count(topic::POSE, reader.manifest.pose.n_poses)?;
        reader.check_count(topic::SAMPLES, reader.manifest.samples.map_or(0, |s| s.n_steps))?;
        Ok(reader)
    }

    /// The manifest.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The edits, in order.
    pub fn layers(&self) -> &[FieldLayer] {
        &self.layers
    }

    /// Whether the file has channels for viewers.
    pub(crate) fn has_preview(&self) -> bool {
        self.index.has_preview
    }

    /// How many steps the field has.
    pub fn n_steps(&self) -> u64 {
        self.index.count(topic::FIELD)
    }

    /// Reads one step; `None` past the end.
    ///
    /// # Errors
    /// [`EffError::Unsound`] if the step is not sound, [`EffError::Io`] if the stream fails.
    pub fn step(&mut self, k: u64) -> Result<Option<Field>, EffError> {
        if k >= self.n_steps() {
            return Ok(None);
        }
        let chunks = self.load_step(k)?;
        self.unpacker().step(k, &chunks).map(Some)
    }

    /// Reads one step and leaves its arrays packed.
    pub(crate) fn packed_step(&mut self, k: u64) -> Result<FieldStep, EffError> {
        let chunks = self.load_step(k)?;
        self.unpacker().packed_step(k, &chunks)
    }

    /// Reads the chunks that may hold a step, as they lie in the file.
    fn load_step(&mut self, k: u64) -> Result<Vec<Packed>, EffError> {
        let Some(channel_id) = self.index.channel(topic::FIELD) else { return Ok(Vec::new()) };
        let (first, last) = near(self.manifest.field.step_secs(k));
        self.index.chunks_within(channel_id, first, last).map(|facts| load(&mut self.input, facts)).collect()
    }

    fn unpacker(&self) -> Unpacker<'_> {
        let channel_id = self.index.channel(topic::FIELD);
        Unpacker { manifest: &self.manifest, channel_id, leaves_deviations: false }
    }

    /// Reads all attachments.
    ///
    /// # Errors
    /// [`EffError::Unsound`] if one is not sound, [`EffError::Io`] if the stream fails.
    pub fn attachments(&mut self) -> Result<Vec<Attachment>, EffError> {
        let attachments = self.index.attachments.iter();
        attachments.map(|offset| Ok(attachment_at(&mut self.input, *offset)?.0)).collect()
    }

    /// Reads all poses.
    ///
    /// # Errors
    /// [`EffError::Unsound`] if one is not sound, [`EffError::Io`] if the stream fails.
    pub fn poses(&mut self) -> Result<Vec<Pose>, EffError> {
        let mut poses = Vec::new();
        let manifest = &self.manifest;
        let info = manifest.pose;
        each_message(&mut self.input, &self.index, topic::POSE, &mut |message, place| {
            let k = poses.len() as u64;
            let (stamp, pose) = decode::pose(message.data, manifest, place)?;
            let mut findings = Findings::first_error();
            check::stamp(stamp, k, info.pose_secs(k), message.log_time, place, &mut findings);
            poses.push(pose);
            fail(findings)
        })?;
        Ok(poses)
    }

    /// Reads all that a simulator needs besides the wind.
    ///
    /// # Errors
    /// As [`Reader::poses`].
    pub fn scene(&mut self) -> Result<Scene, EffError> {
        let poses = PoseTrack {
            start_secs: self.manifest.pose.start_secs,
            rate_hz: self.manifest.pose.rate_hz,
            poses: self.poses()?,
        };
        Ok(self.manifest.scene.clone().with_poses(poses))
    }

    /// Reads the samples of all steps; empty if the file has none.
    ///
    /// # Errors
    /// [`EffError::Unsound`] if one is not sound, [`EffError::Io`] if the stream fails.
    pub fn samples(&mut self) -> Result<Vec<Vec<WindSample>>, EffError> {
        let mut steps = Vec::new();
        let Some(info) = self.manifest.samples else { return Ok(steps) };
        each_message(&mut self.input, &self.index, topic::SAMPLES, &mut |message, place| {
            let k = steps.len() as u64;
            let (stamp, samples) = decode::samples(message.data, place)?;
            let mut findings = Findings::first_error();
            check::stamp(stamp, k, info.step_secs(k), message.log_time, place, &mut findings);
            steps.push(samples);
            fail(findings)
        })?;
        Ok(steps)
    }

    fn check_count(&self, topic: &'static str, expected: u64) -> Result<(), EffError> {
        let found = self.index.count(topic);
        let place = Place { channel: Some(topic), ..Place::default() };
        if found == expected {
            Ok(())
        } else {
            Err(place.finding(Code::Count, "messages", found, expected).into())
        }
    }
}

/// Makes steps of chunks, with nothing of the stream: several can be made side by side.
#[derive(Clone, Copy)]
struct Unpacker<'a> {
    manifest: &'a Manifest,
    /// The channel of the field, if the file has one.
    channel_id: Option<u16>,
    /// Whether standard deviations are left packed and dropped.
    leaves_deviations: bool,
}

impl Unpacker<'_> {
    /// A step from the chunks that may hold it.
    fn step(self, k: u64, chunks: &[Packed]) -> Result<Field, EffError> {
        let mut packed = self.packed_step(k, chunks)?;
        packed.sd = packed.sd.filter(|_| !self.leaves_deviations);
        let place = Place { channel: Some(topic::FIELD), time_ns: Some(packed.time_ns), offset: None };
        decode::unpack_step(packed, &self.manifest.field, place).map_err(first)
    }

    /// The same, its arrays left packed.
    fn packed_step(self, k: u64, chunks: &[Packed]) -> Result<FieldStep, EffError> {
        let secs = self.manifest.field.step_secs(k);
        let mut step = None;
        for chunk in chunks {
            let unpacked = chunk.unpack()?;
            let channel = (self.channel_id.unwrap_or_default(), topic::FIELD);
            for message in chunk.messages(&unpacked, channel, near(secs)) {
                let (message, place) = message?;
                let packed = decode::packed_step(unpacked.slice_ref(message.data), self.manifest, place)?;
                let stamp = Stamp { index: packed.index, time_ns: packed.time_ns };
                let mut findings = Findings::first_error();
                check::stamp(stamp, k, secs, message.log_time, place, &mut findings);
                step = Some(packed);
                fail(findings)?;
            }
        }
        step.ok_or_else(|| {
            let place = Place { channel: Some(topic::FIELD), time_ns: time_ns(secs), offset: None };
            place.finding(Code::Count, format!("step {k}"), "none at its time", "one").into()
        })
    }
}

/// From when to when the message of a time is looked for, ns: another program may round a half nanosecond the other way.
fn near(secs: f64) -> (u64, u64) {
    let time = time_ns(secs).unwrap_or(u64::MAX);
    (time.saturating_sub(1), time.saturating_add(1))
}

/// What is done with a message.
type Take<'a> = &'a mut dyn FnMut(Message<'_>, Place<'_>) -> Result<(), EffError>;

/// Passes all messages of a topic on, in order.
fn each_message<R: Read + Seek>(
    input: &mut R,
    index: &Index,
    topic: &'static str,
    take: Take<'_>,
) -> Result<(), EffError> {
    let Some(channel_id) = index.channel(topic) else { return Ok(()) };
    for facts in index.chunks_within(channel_id, 0, u64::MAX) {
        let chunk = load(input, facts)?;
        let unpacked = chunk.unpack()?;
        for message in chunk.messages(&unpacked, (channel_id, topic), (0, u64::MAX)) {
            let (message, place) = message?;
            take(message, place)?;
        }
    }
    Ok(())
}

/// A chunk's record as it lies in the file, or a message's outside chunks, and what is known of it.
struct Packed {
    facts: ChunkFacts,
    bytes: Bytes,
}

/// Reads a chunk where its index says it is.
fn load<R: Read + Seek>(input: &mut R, facts: &ChunkFacts) -> Result<Packed, EffError> {
    input.seek(SeekFrom::Start(facts.offset))?;
    // The index was found to lie within the file.
    let mut bytes = Vec::with_capacity(facts.length as usize);
    input.by_ref().take(facts.length).read_to_end(&mut bytes)?;
    Ok(Packed { facts: facts.clone(), bytes: bytes.into() })
}

impl Packed {
    /// The messages of a channel at times from `first` to `last`, ns, among its unpacked records.
    fn messages<'a>(
        &self,
        unpacked: &'a [u8],
        (channel_id, topic): (u16, &'static str),
        (first, last): (u64, u64),
    ) -> impl Iterator<Item = Result<(Message<'a>, Place<'static>), EffError>> {
        let place = Place { channel: Some(topic), ..at(self.facts.offset) };
        let wanted = move |message: &Message<'_>| {
            message.channel_id == channel_id && (first..=last).contains(&message.log_time)
        };
        records_in(unpacked).filter_map(move |record| {
            let Ok(InChunk { opcode, body, .. }) = record else {
                let finding = place.finding(Code::Record, "record in chunk", "a part", "a whole record");
                return Some(Err(finding.into()));
            };
            match record::parse(opcode, body) {
                Ok(Record::Message(message)) if wanted(&message) => {
                    let time_ns = Some(message.log_time);
                    Some(Ok((message, Place { time_ns, ..place })))
                }
                Ok(_) => None,
                Err(short) => Some(Err(broken(place, opcode, body, short).into())),
            }
        })
    }

    /// Its records.
    fn unpack(&self) -> Result<Bytes, EffError> {
        let Self { facts, bytes } = self;
        let place = at(facts.offset);
        let stray = || place.finding(Code::Summary, "chunk index", "an index of something else", "a chunk's");
        let Some((prefix, body)) = bytes.split_first_chunk::<{ record::PREFIX as usize }>() else {
            return Err(stray().into());
        };
        let chunk = match record::parse(prefix[0], body) {
            Ok(Record::Chunk(chunk)) => chunk,
            Ok(Record::Message(message))
                if *facts == ChunkFacts::of_message(facts.offset, bytes.len() as u64, &message) =>
            {
                return Ok(bytes.clone());
            }
            _ => return Err(stray().into()),
        };
        let found = (chunk.start_time, chunk.end_time, chunk.uncompressed_size, chunk.data.len() as u64);
        let expected = (facts.start_time, facts.end_time, facts.uncompressed_size, facts.compressed_size);
        if found != expected || prefix[1..] != (body.len() as u64).to_le_bytes() {
            return Err(stray().into());
        }
        let unpacked = unpack(&chunk, place)?;
        let mut findings = Findings::first_error();
        check_crc(Code::ChunkCrc, chunk.uncompressed_crc, crc32fast::hash(&unpacked), place, &mut findings);
        fail(findings)?;
        Ok(unpacked.into())
    }
}

/// The first error as an error.
fn fail(findings: Findings) -> Result<(), EffError> {
    findings.into_first_error().map_or(Ok(()), |finding| Err(Box::new(finding).into()))
}

/// The first of several findings; whoever gives a list of errors has at least one.
pub(crate) fn first(findings: Vec<crate::Finding>) -> EffError {
    let finding = findings.into_iter().next();
    finding.map_or_else(|| EffError::bad("message", "something wrong", "nothing"), |f| Box::new(f).into())
}
