use super::chunk::{self, Indexes};
use super::facts::{AttachmentFacts, ChunkFacts};
use super::{Listener, at, check_crc, content::Content};
use crate::finding::Place;
use crate::format::{PROFILE, Stream, is_schema_text, streams, topic};
use crate::preview::{self, PREVIEWS};
use crate::record::{self, Attachment, Channel, Message, PREFIX, Record, Schema, Statistics};
use crate::scan::Findings;
use crate::{Code, EffError, Finding};
use std::collections::{BTreeMap, BTreeSet};

/// The data section: what its records say, and what the summary will have to say about them.
pub(crate) struct Data<'v> {
    content: Content<'v>,
    is_empty: bool,
    /// The records as they are in the file, by id.
    pub schemas: BTreeMap<u16, Vec<u8>>,
    pub channels: BTreeMap<u16, Vec<u8>>,
    /// Which of the format's schemas and channels an id means; `None` for another's.
    known_schemas: BTreeMap<u16, Option<&'static Stream>>,
    schema_names: BTreeMap<u16, String>,
    known_channels: BTreeMap<u16, Option<&'static Stream>>,
    /// Channels of previews.
    previews: BTreeMap<u16, &'static Stream>,
    /// Channels of other programs.
    foreign: BTreeSet<u16>,
    /// What the last chunk's message indexes must be, until they are read.
    pending_indexes: Indexes,
    /// The last chunk could not be read: its message indexes are all that is known of it.
    is_chunk_lost: bool,
    pub chunks: Vec<ChunkFacts>,
    pub attachments: Vec<AttachmentFacts>,
    pub statistics: Statistics,
}

impl<'v> Data<'v> {
    pub fn new(listener: &'v mut dyn Listener) -> Self {
        Self {
            content: Content::new(listener),
            is_empty: true,
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            known_schemas: BTreeMap::new(),
            schema_names: BTreeMap::new(),
            known_channels: BTreeMap::new(),
            previews: BTreeMap::new(),
            foreign: BTreeSet::new(),
            pending_indexes: Indexes::new(),
            is_chunk_lost: false,
            chunks: Vec::new(),
            attachments: Vec::new(),
            statistics: Statistics::default(),
        }
    }

    /// What was declared of a channel, if there is one of this id.
    pub fn declared(&self, channel_id: u16) -> Option<Channel<'_>> {
        match record::parse(record::op::CHANNEL, self.channels.get(&channel_id)?) {
            Ok(Record::Channel(channel)) => Some(channel),
            _ => None,
        }
    }

    /// Whether a channel is one of a preview.
    pub fn is_of_preview(&self, channel_id: u16) -> bool {
        self.previews.contains_key(&channel_id)
    }

    /// Whether a channel is another program's.
    pub fn is_foreign(&self, channel_id: u16) -> bool {
        self.foreign.contains(&channel_id)
    }

    /// The channels of other programs, and their records' contents.
    pub fn foreign_channels(&self) -> impl Iterator<Item = (u16, &[u8])> {
        self.foreign.iter().filter_map(|id| Some((*id, self.channels.get(id)?.as_slice())))
    }

    /// What a channel is to the format; `None` if nothing.
    pub fn stream(&self, channel_id: u16) -> Option<&'static Stream> {
        self.known_channels.get(&channel_id).copied().flatten()
    }

    /// The channels that the format knows.
    pub fn streams(&self) -> impl Iterator<Item = (u16, &'static Stream)> {
        self.known_channels.iter().filter_map(|(id, stream)| Some((*id, (*stream)?)))
    }

    /// Takes one record in. `body` is its content as it is in the file.
    pub fn record(
        &mut self,
        record: Record<'_>,
        opcode: u8,
        body: &[u8],
        offset: u64,
        findings: &mut Findings,
    ) -> Result<(), EffError> {
        let place = at(offset);
        let length = PREFIX + body.len() as u64;
        self.header_comes_first(&record, opcode, place, findings);
        if !matches!(record, Record::MessageIndex { .. }) {
            self.indexes_are_complete(place, findings);
            self.is_chunk_lost = false;
        }
        match record {
            Record::Header { profile } => {
                if profile != PROFILE {
                    findings.push(place.finding(
                        Code::Profile,
                        "header.profile",
                        quoted(profile),
                        quoted(PROFILE),
                    ));
                }
            }
            Record::Schema(schema) => self.schema(schema, body, place, findings),
            Record::Channel(channel) => self.channel(&channel, body, place, findings),
            Record::Message(message) => self.message(message, place, findings)?,
            Record::Chunk(chunk) => {
                self.chunks.push(ChunkFacts {
                    start_time: chunk.start_time,
                    end_time: chunk.end_time,
                    offset,
                    length,
                    message_index_offsets: BTreeMap::new(),
                    message_index_length: 0,
                    compression: chunk.compression.to_owned(),
                    compressed_size: chunk.data.len() as u64,
                    uncompressed_size: chunk.uncompressed_size,
                });
                match chunk::scan(self, &chunk, place, findings)? {
                    Some(indexes) => self.pending_indexes = indexes,
                    None => self.is_chunk_lost = true,
                }
            }
            Record::MessageIndex { channel_id, entries } => {
                self.message_index(channel_id, &entries, offset, length, findings);
            }
            Record::Attachment(attachment) => self.attachment(attachment, offset, length, findings),
            Record::Metadata { .. } => {
                self.statistics.metadata_count += 1;
                findings.push(place.finding(Code::Skipped, "metadata", "a record", "none in a field file"));
            }
            Record::Private => {
                findings.push(place.finding(Code::Skipped, "record", "another application's", "MCAP's own"));
            }
            _ => {
                let expected = "a record of the data section";
                findings.push(place.finding(Code::RecordOrder, "record", record::name(opcode), expected));
            }
        }
        Ok(())
    }

    /// A chunk's record is broken.
    pub fn lose_chunk(&mut self, place: Place<'_>, findings: &mut Findings) {
        self.indexes_are_complete(place, findings);
        self.is_chunk_lost = true;
    }

    /// The data section is over: whatever should have come has come.
    pub fn end(&mut self, place: Place<'_>, findings: &mut Findings) {
        self.indexes_are_complete(place, findings);
        self.statistics.schema_count = self.schemas.len() as u16;
        self.statistics.channel_count = self.channels.len() as u32;
        self.statistics.chunk_count = self.chunks.len() as u32;
        self.statistics.attachment_count = self.attachments.len() as u32;
        self.statistics.message_count = self.statistics.channel_message_counts.values().sum();
        self.content.end(place, findings);
    }

    fn header_comes_first(
        &mut self,
        record: &Record<'_>,
        opcode: u8,
        place: Place<'_>,
        findings: &mut Findings,
    ) {
        if self.is_empty != matches!(record, Record::Header { .. }) {
            let expected = "one header, before all else";
            findings.push(place.finding(Code::RecordOrder, "record", record::name(opcode), expected));
        }
        self.is_empty = false;
    }

    /// Takes a schema or a channel in, by the content of its record.
    pub fn declaration(&mut self, opcode: u8, body: &[u8], place: Place<'_>, findings: &mut Findings) {
        match record::parse(opcode, body) {
            Ok(Record::Schema(schema)) => self.schema(schema, body, place, findings),
            Ok(Record::Channel(channel)) => self.channel(&channel, body, place, findings),
            _ => {}
        }
    }

    pub fn schema(&mut self, schema: Schema<'_>, body: &[u8], place: Place<'_>, findings: &mut Findings) {
        let what = format!("schema {}", schema.id);
        if schema.id == 0 {
            findings.push(place.finding(Code::Schema, &what, "id 0", "an id above 0"));
        }
        if is_redefined(&mut self.schemas, schema.id, body) {
            findings.push(place.finding(
                Code::Schema,
                &what,
                "another schema of this id",
                "the same as before",
            ));
        }
        self.schema_names.insert(schema.id, schema.name.to_owned());
        let known = streams().find(|s| s.schema_name == schema.name);
        self.known_schemas.insert(schema.id, known);
        let Some(known) = known else { return };
        if schema.encoding != known.schema_encoding {
            let (found, expected) = (quoted(schema.encoding), quoted(known.schema_encoding));
            findings.push(place.finding(Code::Schema, format!("{}.encoding", schema.name), found, expected));
        }
        if !is_schema_text(known, schema.data) {
            let expected = "a text that version 1 has or had";
            findings.push(place.finding(Code::SchemaText, schema.name, "another text", expected));
        }
    }

    pub fn channel(&mut self, channel: &Channel<'_>, body: &[u8], place: Place<'_>, findings: &mut Findings) {
        let place = Place { channel: Some(channel.topic), ..place };
        if is_redefined(&mut self.channels, channel.id, body) {
            let what = format!("channel {}", channel.id);
            findings.push(place.finding(
                Code::Channel,
                what,
                "another channel of this id",
                "the same as before",
            ));
        }
        let schema = self.known_schemas.get(&channel.schema_id);
        let schema_name = schema.copied().flatten().map(|s| s.schema_name);
        let of_topic = || streams().filter(|s| s.topic == channel.topic);
        let known = of_topic().find(|s| Some(s.schema_name) == schema_name).or_else(|| of_topic().next());
        let is_second = known.is_some()
            && self
                .known_channels
                .iter()
                .any(|(id, stream)| *id != channel.id && stream.is_some_and(|s| s.topic == channel.topic));
        if is_second {
            findings.push(place.finding(Code::Channel, "topic", "a second channel", "one channel a topic"));
        }
        self.known_channels.insert(channel.id, known);
        if channel.schema_id != 0 && schema.is_none() {
            let expected = "a schema that came before";
            findings.push(place.finding(Code::Channel, "schema_id", channel.schema_id, expected));
        }
        match known {
            Some(stream) => {
                if channel.message_encoding != stream.message_encoding {
                    let (found, expected) =
                        (quoted(channel.message_encoding), quoted(stream.message_encoding));
                    findings.push(place.finding(Code::Channel, "message_encoding", found, expected));
                }
                if schema_name != Some(stream.schema_name) {
                    let found = format!("schema {}", channel.schema_id);
                    findings.push(place.finding(Code::Channel, "schema_id", found, stream.schema_name));
                }
            }
            None if channel.topic.starts_with(topic::OURS) => {
                let expected = format!("a topic of version {}", crate::VERSION);
                findings.push(place.finding(Code::Channel, "topic", quoted(channel.topic), expected));
            }
            None if self.is_preview(channel) => {}
            None => {
                self.foreign.insert(channel.id);
                let expected = format!("topics under {}", topic::OURS);
                findings.push(place.finding(Code::Skipped, "topic", quoted(channel.topic), expected));
            }
        }
    }

    /// Whether there was a channel of a preview.
    pub fn has_preview(&self) -> bool {
        !self.previews.is_empty()
    }

    /// Whether a channel is one of those that previews have, with the schema they have.
    fn is_preview(&mut self, channel: &Channel<'_>) -> bool {
        let stream = PREVIEWS.iter().find(|stream| {
            stream.topic == channel.topic
                && stream.message_encoding == channel.message_encoding
                && self.schema_names.get(&channel.schema_id).is_some_and(|name| name == stream.schema_name)
        });
        self.previews.extend(stream.map(|stream| (channel.id, stream)));
        stream.is_some()
    }

    pub fn message(
        &mut self,
        message: Message<'_>,
        place: Place<'_>,
        findings: &mut Findings,
    ) -> Result<(), EffError> {
        let position = self.count(message.channel_id, message.log_time);
        match self.known_channels.get(&message.channel_id) {
            Some(None) if self.previews.contains_key(&message.channel_id) => {
                let stream = self.previews[&message.channel_id];
                let place = Place { channel: Some(stream.topic), time_ns: Some(message.log_time), ..place };
                self.content.preview(stream.topic, message.data.len());
                preview::check(stream, message, place, findings);
                Ok(())
            }
            Some(Some(stream)) => {
                let place = Place { channel: Some(stream.topic), time_ns: Some(message.log_time), ..place };
                self.content.message(stream, message, position, place, findings)
            }
            Some(None) => Ok(()),
            None => {
                let expected = "a channel that came before";
                findings.push(place.finding(
                    Code::Channel,
                    "message.channel_id",
                    message.channel_id,
                    expected,
                ));
                Ok(())
            }
        }
    }

    fn attachment(&mut self, a: Attachment<'_>, offset: u64, length: u64, findings: &mut Findings) {
        check_crc(Code::AttachmentCrc, a.crc, a.computed_crc, at(offset), findings);
        if self.attachments.iter().any(|other| other.name == a.name) {
            findings.push(named_again(a.name, at(offset)));
        }
        self.attachments.push(AttachmentFacts {
            offset,
            length,
            log_time: a.log_time,
            create_time: a.create_time,
            data_size: a.data.len() as u64,
            name: a.name.to_owned(),
            media_type: a.media_type.to_owned(),
        });
        self.content.attachment(a);
    }

    fn message_index(
        &mut self,
        channel_id: u16,
        entries: &[(u64, u64)],
        offset: u64,
        length: u64,
        findings: &mut Findings,
    ) {
        let follows = self.chunks.last().is_some_and(|chunk| chunk.is_followed_by(offset, channel_id));
        match self.pending_indexes.remove(&channel_id) {
            _ if self.is_chunk_lost => self.count_lost(channel_id, entries),
            Some(expected) if expected == entries => {}
            // Some writers index every channel in every chunk.
            None if entries.is_empty() && follows => {}
            Some(_) => {
                let found = "other times or offsets";
                findings.push(at(offset).finding(
                    Code::MessageIndex,
                    "records",
                    found,
                    "those of the chunk before",
                ));
            }
            None => {
                let expected = "a channel of the chunk before, once";
                findings.push(at(offset).finding(Code::MessageIndex, "channel_id", channel_id, expected));
            }
        }
        if let Some(chunk) = self.chunks.last_mut() {
            chunk.message_index_offsets.insert(channel_id, offset);
            chunk.message_index_length += length;
        }
    }

    /// Counts messages that cannot be read, so that those after them are not taken for out of order.
    fn count_lost(&mut self, channel_id: u16, entries: &[(u64, u64)]) {
        let stream = self.stream(channel_id);
        for (log_time, _) in entries {
            self.count(channel_id, *log_time);
            if let Some(stream) = stream {
                self.content.skip(stream.topic);
            }
        }
    }

    /// Counts a message; gives how many of its channel came before.
    fn count(&mut self, channel_id: u16, log_time: u64) -> u64 {
        let statistics = &mut self.statistics;
        let is_first = statistics.channel_message_counts.is_empty();
        let count = statistics.channel_message_counts.entry(channel_id).or_default();
        *count += 1;
        statistics.start_time = if is_first { log_time } else { statistics.start_time.min(log_time) };
        statistics.end_time = statistics.end_time.max(log_time);
        *count - 1
    }

    fn indexes_are_complete(&mut self, place: Place<'_>, findings: &mut Findings) {
        let missing = std::mem::take(&mut self.pending_indexes);
        if !missing.is_empty() {
            let channels: Vec<u16> = missing.into_keys().collect();
            let expected = format!("indexes of channels {channels:?} too");
            findings.push(place.finding(Code::MessageIndex, "message indexes", "none", expected));
        }
    }
}

/// An attachment has the name of one before it.
pub(crate) fn named_again(name: &str, place: Place<'_>) -> Box<Finding> {
    place.finding(Code::DuplicateId, "attachment.name", quoted(name), "each name once")
}

/// Keeps a record of this id; whether another one was there.
fn is_redefined(records: &mut BTreeMap<u16, Vec<u8>>, id: u16, body: &[u8]) -> bool {
    records.insert(id, body.to_vec()).is_some_and(|before| before != body)
}

/// A text as a message shows it.
pub(crate) fn quoted(text: &str) -> String {
    format!("{text:?}")
}
