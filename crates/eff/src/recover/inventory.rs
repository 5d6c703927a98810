use super::Loss;
use super::foreign::Foreign;
use super::thread::Thread;
use crate::finding::Place as At;
use crate::format::{Stream, topic};
use crate::manifest::Manifest;
use crate::reader::Index;
use crate::record::{self, MAGIC, Message, PREFIX, Record, op};
use crate::scan::chunk::{InChunk, records_in, unpack};
use crate::scan::data::{Data, named_again};
use crate::scan::source::{Next, Source};
use crate::scan::{Findings, Listener, at, broken};
use crate::wire::edits::Edits;
use crate::{Attachment, Code, EffError, Finding, check, decode};
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::io::{Read, Seek, SeekFrom};
use tousle_core::Pose;

/// Where a message is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Where its chunk begins in the file, or itself if it is in none, and the opcode that is there.
    pub record: (u64, u8),
    /// Where it is in the unpacked chunk.
    pub within: u64,
}

/// Everything that is whole in a file. Of what can be there only once, it is the first.
#[derive(Default)]
pub(super) struct Inventory {
    pub manifest: Option<Manifest>,
    pub edits: Option<Edits>,
    pub poses: BTreeMap<u64, Pose>,
    pub samples: BTreeMap<u64, Place>,
    pub steps: BTreeMap<u64, Place>,
    /// Where the attachments are.
    pub attachments: Vec<u64>,
    /// Whether there are channels for viewers.
    pub has_preview: bool,
    /// What other programs have in the file.
    pub foreign: Foreign,
    attachment_names: BTreeSet<String>,
    /// How many messages were found, by channel.
    n_messages: BTreeMap<u16, u64>,
    /// How many messages of a topic have fields that are skipped.
    n_extended: BTreeMap<&'static str, u64>,
    /// How many messages are of channels that nobody knows.
    n_stray: u64,
    /// How many records have no checksum but that of all data.
    n_outside: u64,
    pub losses: Vec<Loss>,
}

impl Inventory {
    /// Goes through a file, whatever state it is in.
    pub fn take<R: Read + Seek>(input: &mut R) -> Result<Self, EffError> {
        let index = index(input)?;
        let thread = Thread::follow(input, index.as_ref())?;
        let mut inventory = Self { losses: thread.loss.into_iter().collect(), ..Self::default() };
        let mut deaf = Deaf;
        let mut data = Data::new(&mut deaf);
        for (opcode, body) in index.iter().flat_map(|index| &index.declarations) {
            data.declaration(*opcode, body, At::default(), &mut Findings::all());
        }
        for record in &thread.records {
            inventory.record(input, *record, index.is_some(), &mut data)?;
        }
        inventory.has_preview = data.has_preview();
        if !thread.is_vouched_for {
            inventory.doubt();
        }
        inventory.foreign.declare(&data, &mut inventory.losses);
        inventory.lose_what_is_left_out(&data);
        inventory.count();
        if let Some(index) = &index {
            inventory.count_by(index, &data);
        }
        Ok(inventory)
    }

    /// Takes a record of the data section in. The summary, if there is one, tells better what was declared, and what a
    /// record was that may not be there.
    fn record<R: Read + Seek>(
        &mut self,
        input: &mut R,
        record: (u64, u8),
        has_summary: bool,
        data: &mut Data<'_>,
    ) -> Result<(), EffError> {
        match record.1 {
            op::SCHEMA | op::CHANNEL if has_summary => {}
            op::SCHEMA | op::CHANNEL | op::MESSAGE => {
                self.n_outside += 1;
                self.content(input, record, data)?;
            }
            op::CHUNK => self.content(input, record, data)?,
            op::ATTACHMENT => self.attachment(input, record.0)?,
            op::METADATA | op::PRIVATE.. => {
                self.n_outside += 1;
                self.foreign_record(input, record)?;
            }
            op::HEADER if record.0 == MAGIC.len() as u64 => {}
            op::MESSAGE_INDEX => {}
            _ if has_summary => {}
            _ => self.lose_stray(record),
        }
        Ok(())
    }

    /// How many steps the samples have.
    pub fn n_samples(&self) -> u64 {
        self.samples.last_key_value().map_or(0, |(last, _)| last + 1)
    }

    /// Takes what is in a chunk, or would be in one.
    fn content<R: Read + Seek>(
        &mut self,
        input: &mut R,
        record: (u64, u8),
        data: &mut Data<'_>,
    ) -> Result<(), EffError> {
        let (offset, opcode) = record;
        let unpacked = match content(input, record) {
            Ok(unpacked) => unpacked,
            Err(error) => {
                return self.lose(format!("the {} at byte {offset}", record::name(opcode)), error);
            }
        };
        for InChunk { offset: within, opcode, body } in records_in(&unpacked).flatten() {
            let Ok(Record::Message(message)) = record::parse(opcode, body) else {
                data.declaration(opcode, body, at(offset), &mut Findings::all());
                continue;
            };
            *self.n_messages.entry(message.channel_id).or_default() += 1;
            match data.stream(message.channel_id) {
                Some(stream) => self.ours(stream, message, Place { record, within }),
                None if data.is_foreign(message.channel_id) => {
                    self.foreign.messages.insert(record);
                }
                None => self.n_stray += u64::from(!data.is_of_preview(message.channel_id)),
            }
        }
        Ok(())
    }

    /// Keeps a message of ours, or says why not.
    fn ours(&mut self, stream: &'static Stream, message: Message<'_>, place: Place) {
        match self.message(stream, message, place) {
            Ok(()) if decode::has_extensions(stream, message.data) => {
                *self.n_extended.entry(stream.topic).or_default() += 1;
            }
            Ok(()) => {}
            Err(finding) => {
                let what = format!("a message of {}", stream.topic);
                self.losses.push(Loss { what, why: finding.to_string() });
            }
        }
    }

    /// Keeps metadata or a private record if it is sound.
    fn foreign_record<R: Read + Seek>(&mut self, input: &mut R, record: (u64, u8)) -> Result<(), EffError> {
        match content(input, record) {
            Ok(_) => {
                self.foreign.records.insert(record);
                Ok(())
            }
            Err(error) => self.lose(format!("the {} at byte {}", record::name(record.1), record.0), error),
        }
    }

    /// Keeps an attachment if it is sound and the first of its name.
    fn attachment<R: Read + Seek>(&mut self, input: &mut R, offset: u64) -> Result<(), EffError> {
        let first_of_name = attachment_at(input, offset).and_then(|(Attachment { name, .. }, _)| {
            let again = self.attachment_names.contains(&name).then(|| named_again(&name, at(offset)));
            again.map_or(Ok(name), |finding| Err(finding.into()))
        });
        match first_of_name {
            Ok(name) => {
                self.attachment_names.insert(name);
                self.attachments.push(offset);
                Ok(())
            }
            Err(error) => self.lose(format!("the attachment at byte {offset}"), error),
        }
    }

    /// Keeps a message if it is sound and the first of its kind and index.
    fn message(&mut self, stream: &Stream, message: Message<'_>, place: Place) -> Result<(), Box<Finding>> {
        let at = At { channel: None, time_ns: Some(message.log_time), offset: Some(place.record.0) };
        if stream.topic == topic::MANIFEST {
            let manifest = decode::manifest(message.data, stream.version, at).map_err(first)?;
            sound(|findings| check::manifest(&manifest, at, findings))?;
            return keep_only(&mut self.manifest, manifest, at);
        }
        let Some(manifest) = &self.manifest else {
            return Err(at.finding(Code::Missing, "message", "no manifest before it", "a sound manifest"));
        };
        if stream.version != manifest.version {
            return Err(at.finding(Code::Channel, "schema_id", stream.version, manifest.version));
        }
        match stream.topic {
            topic::EDITS => {
                let edits = decode::edits(message.data, at).map_err(first)?;
                sound(|findings| check::edits(&edits, &manifest.requires, at, findings))?;
                keep_only(&mut self.edits, edits, at)
            }
            topic::POSE => {
                let (stamp, pose) = decode::pose(message.data, manifest, at)?;
                let secs = manifest.pose.pose_secs(stamp.index);
                sound(|f| check::stamp(stamp, stamp.index, secs, message.log_time, at, f))?;
                keep_first(&mut self.poses, stamp.index, pose, at)
            }
            topic::SAMPLES => {
                let (stamp, _) = decode::samples(message.data, at)?;
                let secs = manifest.samples.map_or(f64::NAN, |s| s.step_secs(stamp.index));
                sound(|f| check::stamp(stamp, stamp.index, secs, message.log_time, at, f))?;
                keep_first(&mut self.samples, stamp.index, place, at)
            }
            _ => {
                let (stamp, _) = decode::step(message.data, manifest, at).map_err(first)?;
                let secs = manifest.field.step_secs(stamp.index);
                sound(|f| check::stamp(stamp, stamp.index, secs, message.log_time, at, f))?;
                keep_first(&mut self.steps, stamp.index, place, at)
            }
        }
    }

    /// Compares what was found with what the manifest announces.
    fn count(&mut self) {
        let Some(manifest) = &self.manifest else { return };
        let samples = manifest.samples.map_or(0, |s| s.n_steps);
        let counts = [
            ("poses", self.poses.len() as u64, Some(manifest.pose.n_poses)),
            ("steps of samples", self.samples.len() as u64, Some(samples)),
            ("steps of the field", self.steps.len() as u64, manifest.field.n_steps),
        ];
        for (what, found, expected) in counts {
            if let Some(expected) = expected.filter(|e| *e > found) {
                let what = format!("{} of {expected} {what}", expected - found);
                self.losses.push(Loss { what, why: format!("{found} are whole") });
            }
        }
    }

    /// Compares what was found with what the summary counts and the manifest does not.
    fn count_by(&mut self, index: &Index, data: &Data<'_>) {
        let n_metadata = self.foreign.n_metadata();
        if n_metadata < index.n_metadata {
            let what = format!("{} of {} metadata records", index.n_metadata - n_metadata, index.n_metadata);
            self.losses.push(Loss { what, why: format!("{n_metadata} are whole") });
        }
        let knows_steps = self.manifest.as_ref().is_some_and(|manifest| manifest.field.n_steps.is_some());
        for (channel_id, expected) in &index.counts {
            let found = self.n_messages.get(channel_id).copied().unwrap_or(0);
            let topic = data.declared(*channel_id).map_or("a channel that is not there", |c| c.topic);
            let is_counted = match topic {
                topic::POSE | topic::SAMPLES | topic::PREVIEW_HEAD | topic::PREVIEW_WIND => true,
                topic::FIELD => knows_steps,
                _ => false,
            };
            if found < *expected && !is_counted {
                let what = format!("{} of {expected} messages of {topic}", expected - found);
                self.losses.push(Loss { what, why: format!("{found} are whole") });
            }
        }
    }

    /// Notes what may be another than it was: the checksum of all data does not hold, and it has no other.
    fn doubt(&mut self) {
        if self.n_outside > 0 {
            let what = format!("{} records outside chunks", self.n_outside);
            let why = "what is whole by itself is kept, but no checksum says that it is what it was".into();
            self.losses.push(Loss { what, why });
        }
        self.foreign.drop_private(&mut self.losses);
    }

    /// Notes what is whole and is not written again.
    fn lose_what_is_left_out(&mut self, data: &Data<'_>) {
        for (topic, n) in std::mem::take(&mut self.n_extended) {
            let what = format!("fields from number 1000 on, in {n} messages of {topic}");
            self.losses.push(Loss { what, why: "fields of the format are written, no others".into() });
        }
        for (id, stream) in data.streams() {
            if data.declared(id).is_some_and(|channel| !channel.metadata.is_empty()) {
                let what = format!("metadata of the channel {}", stream.topic);
                self.losses.push(Loss { what, why: "the channels of the format are written without".into() });
            }
        }
        if self.n_stray > 0 {
            let why = "their channels are not there, or of topics that the format does not have".into();
            self.losses.push(Loss { what: format!("{} messages", self.n_stray), why });
        }
    }

    /// Notes that there is a record where none of its kind may be: it was another one.
    fn lose_stray(&mut self, (offset, opcode): (u64, u8)) {
        let found = record::name(opcode);
        let why = at(offset).finding(Code::RecordOrder, "record", found, "a record of the data section");
        self.losses.push(Loss { what: format!("the record at byte {offset}"), why: why.to_string() });
    }

    /// Notes a loss; a stream that fails is none.
    fn lose(&mut self, what: String, error: EffError) -> Result<(), EffError> {
        match error {
            EffError::Unsound(finding) => {
                self.losses.push(Loss { what, why: finding.to_string() });
                Ok(())
            }
            other => Err(other),
        }
    }
}

/// What a file's end says is where, if it is whole.
fn index<R: Read + Seek>(input: &mut R) -> Result<Option<Index>, EffError> {
    match Index::read_end(input) {
        Ok(index) => Ok(Some(index)),
        Err(EffError::Unsound(_)) => Ok(None),
        Err(other) => Err(other),
    }
}

struct Deaf;

impl Listener for Deaf {}

/// Keeps what can be in a file once, unless it is there already.
fn keep_only<T>(kept: &mut Option<T>, new: T, at: At<'_>) -> Result<(), Box<Finding>> {
    if kept.is_some() {
        return Err(at.finding(Code::Missing, "message", "a second one", "one"));
    }
    *kept = Some(new);
    Ok(())
}

/// Keeps what can be at an index once, unless something is there already.
fn keep_first<T>(kept: &mut BTreeMap<u64, T>, index: u64, new: T, at: At<'_>) -> Result<(), Box<Finding>> {
    match kept.entry(index) {
        Entry::Vacant(free) => {
            free.insert(new);
            Ok(())
        }
        Entry::Occupied(_) => {
            Err(at.finding(Code::Order, "index", format!("{index} again"), "each index once"))
        }
    }
}

/// The first error that a check finds.
fn sound(check: impl FnOnce(&mut Findings)) -> Result<(), Box<Finding>> {
    let mut findings = Findings::first_error();
    check(&mut findings);
    findings.into_first_error().map_or(Ok(()), |finding| Err(Box::new(finding)))
}

pub(super) fn first(findings: Vec<Finding>) -> Box<Finding> {
    let finding = findings.into_iter().next().map(Box::new);
    finding.unwrap_or_else(|| At::default().finding(Code::Record, "message", "something wrong", "nothing"))
}

/// Reads the content of the record at a place, if it is of the kind that it should be.
pub(super) fn record_at<R: Read + Seek>(
    input: &mut R,
    (offset, expected): (u64, u8),
) -> Result<Vec<u8>, EffError> {
    input.seek(SeekFrom::Start(offset))?;
    let mut body = Vec::new();
    let place = at(offset);
    match Source::new(input).next(&mut body)? {
        Next::Record { opcode, .. } if opcode == expected => Ok(body),
        Next::Record { opcode, .. } => {
            let (found, expected) = (record::name(opcode), record::name(expected));
            Err(place.finding(Code::Record, "record", found, expected).into())
        }
        Next::End { found, .. } => {
            let expected = format!("a record of {PREFIX} bytes or more");
            Err(place.finding(Code::Cut, "record", found, expected).into())
        }
    }
}

/// What a record holds.
fn parsed(opcode: u8, body: &[u8], offset: u64) -> Result<Record<'_>, Box<Finding>> {
    record::parse(opcode, body).map_err(|short| broken(at(offset), opcode, body, short))
}

/// The records of the chunk at a place, unpacked, if its checksum holds; of another kind the record itself.
pub(super) fn content<R: Read + Seek>(input: &mut R, record: (u64, u8)) -> Result<Vec<u8>, EffError> {
    let (offset, opcode) = record;
    let body = record_at(input, record)?;
    let Record::Chunk(chunk) = parsed(opcode, &body, offset)? else {
        return Ok([&[opcode][..], &(body.len() as u64).to_le_bytes(), &body].concat());
    };
    let unpacked = unpack(&chunk, at(offset))?;
    sound(|findings| {
        let computed = crc32fast::hash(&unpacked);
        crate::scan::check_crc(Code::ChunkCrc, chunk.uncompressed_crc, computed, at(offset), findings);
    })?;
    Ok(unpacked)
}

/// The attachment at a place, if its checksum holds, and when it was logged and made, ns.
pub(crate) fn attachment_at<R: Read + Seek>(
    input: &mut R,
    offset: u64,
) -> Result<(Attachment, [u64; 2]), EffError> {
    let body = record_at(input, (offset, op::ATTACHMENT))?;
    let Record::Attachment(a) = parsed(op::ATTACHMENT, &body, offset)? else {
        return Err(at(offset).finding(Code::Record, "record", "another", "attachment").into());
    };
    sound(|f| crate::scan::check_crc(Code::AttachmentCrc, a.crc, a.computed_crc, at(offset), f))?;
    let (name, media_type) = (a.name.to_owned(), a.media_type.to_owned());
    Ok((Attachment { name, media_type, bytes: a.data.to_vec() }, [a.log_time, a.create_time]))
}
