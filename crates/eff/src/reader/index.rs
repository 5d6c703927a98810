use super::fail;
use crate::Code;
use crate::EffError;
use crate::finding::Place;
use crate::format::PROFILE;
use crate::manifest::Manifest;
use crate::record::{self, FOOTER, MAGIC, PREFIX, Record};
use crate::scan::data::{Data, quoted};
use crate::scan::facts::ChunkFacts;
use crate::scan::source::{Next, Source};
use crate::scan::summary::Summary;
use crate::scan::{Findings, Listener, at, broken, check_crc, magic};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{Read, Seek, SeekFrom};

/// Where everything is in a file, as its summary says.
#[derive(Debug)]
pub(crate) struct Index {
    /// The version of all channels.
    pub version: u32,
    channels: BTreeMap<&'static str, u16>,
    n_messages: u64,
    /// How many records are metadata.
    pub n_metadata: u64,
    /// How many messages a channel has.
    pub counts: BTreeMap<u16, u64>,
    /// In the file's order; a message outside chunks is one by itself.
    chunks: Vec<ChunkFacts>,
    /// Which chunks hold messages of a channel, in the file's order.
    by_channel: BTreeMap<u16, Vec<usize>>,
    /// The records of schemas and channels, by opcode and content.
    pub declarations: Vec<(u8, Vec<u8>)>,
    /// Where the attachments are.
    pub attachments: Vec<u64>,
    /// Whether there are channels for viewers.
    pub has_preview: bool,
}

/// The footer and the magic after it.
const TAIL: u64 = FOOTER + MAGIC.len() as u64;

impl Index {
    /// The channel of a topic, if the file has one.
    pub fn channel(&self, topic: &str) -> Option<u16> {
        self.channels.get(topic).copied()
    }

    /// How many messages a topic has.
    pub fn count(&self, topic: &str) -> u64 {
        self.channel(topic).and_then(|id| self.counts.get(&id).copied()).unwrap_or(0)
    }

    /// Where all chunks and attachments begin, and which of the two it is.
    pub fn records(&self) -> BTreeSet<(u64, u8)> {
        let chunks = self.chunks.iter().map(|chunk| (chunk.offset, record::op::CHUNK));
        chunks.chain(self.attachments.iter().map(|offset| (*offset, record::op::ATTACHMENT))).collect()
    }

    /// The chunks that hold messages of a channel at times from `first` to `last`, in the file's order.
    ///
    /// A channel's messages come in the order of their times: nothing before a chunk that ends too early and nothing
    /// after one that begins too late is looked at. What other channels have in a chunk may make it longer.
    pub fn chunks_within(&self, channel_id: u16, first: u64, last: u64) -> impl Iterator<Item = &ChunkFacts> {
        let chunks = self.by_channel.get(&channel_id).map_or(&[][..], Vec::as_slice);
        let start = chunks.partition_point(|k| self.chunks[*k].end_time < first);
        let chunks = chunks[start..].iter().map(|k| &self.chunks[*k]);
        chunks.take_while(move |chunk| chunk.start_time <= last).filter(move |chunk| first <= chunk.end_time)
    }

    /// Reads a file's ends: its header, its footer and the summary before it. If messages are outside chunks all of it
    /// is read, as no index says where they are.
    pub fn read<R: Read + Seek>(input: &mut R) -> Result<Self, EffError> {
        input.seek(SeekFrom::Start(0))?;
        check_header(input)?;
        let mut index = Self::read_end(input)?;
        let counts = index.chunks.iter().flat_map(ChunkFacts::message_counts);
        if counts.fold(0, |sum: u64, (_, n)| sum.saturating_add(n)) < index.n_messages {
            let known: BTreeSet<u16> = index.channels.values().copied().collect();
            index.chunks.extend(messages_outside_chunks(input, &known)?);
            index.chunks.sort_by_key(|chunk| chunk.offset);
            index.by_channel = by_channel(&index.chunks);
        }
        Ok(index)
    }

    /// Reads a file's end: its footer and the summary before it.
    pub fn read_end<R: Read + Seek>(input: &mut R) -> Result<Self, EffError> {
        let length = input.seek(SeekFrom::End(0))?;
        let summary_start = read_footer(input, length)?;
        let summary = read_summary(input, summary_start, length)?;
        let schemas = summary.schemas.into_values().map(|body| (record::op::SCHEMA, body));
        let channels = summary.channels.into_values().map(|body| (record::op::CHANNEL, body));
        let declarations: Vec<_> = schemas.chain(channels).collect();
        let Channels { version, by_topic, has_preview } = check_channels(&declarations)?;
        let Some(statistics) = summary.statistics else {
            return Err(at(summary_start).finding(Code::Summary, "statistics", "none", "one record").into());
        };
        if let Some(chunk) = summary.chunks.iter().find(|c| c.offset.saturating_add(c.length) > length) {
            let found = format!("a chunk at {} of {} bytes", chunk.offset, chunk.length);
            let expected = format!("chunks within the file's {length} bytes");
            return Err(at(summary_start).finding(Code::Summary, "chunk index", found, expected).into());
        }
        Ok(Self {
            version,
            channels: by_topic,
            n_messages: statistics.message_count,
            n_metadata: statistics.metadata_count.into(),
            counts: statistics.channel_message_counts,
            by_channel: by_channel(&summary.chunks),
            chunks: summary.chunks,
            declarations,
            attachments: summary.attachments.iter().map(|a| a.offset).collect(),
            has_preview,
        })
    }
}

/// Which chunks hold messages of a channel: some writers index all channels in each.
fn by_channel(chunks: &[ChunkFacts]) -> BTreeMap<u16, Vec<usize>> {
    let mut by_channel: BTreeMap<u16, Vec<usize>> = BTreeMap::new();
    for (k, chunk) in chunks.iter().enumerate() {
        for (channel_id, _) in chunk.message_counts().filter(|(_, n)| *n > 0) {
            by_channel.entry(channel_id).or_default().push(k);
        }
    }
    by_channel
}

/// The messages of some channels that are outside chunks. No checksum but the data section's is of them.
fn messages_outside_chunks<R: Read + Seek>(
    input: &mut R,
    channel_ids: &BTreeSet<u16>,
) -> Result<Vec<ChunkFacts>, EffError> {
    input.seek(SeekFrom::Start(0))?;
    let mut source = Source::new(input);
    source.fill(&mut [0; MAGIC.len()])?;
    let mut messages = Vec::new();
    let mut body = Vec::new();
    loop {
        let (opcode, offset) = match source.next(&mut body)? {
            Next::Record { opcode, offset } => (opcode, offset),
            Next::End { offset, found } => {
                return Err(at(offset)
                    .finding(Code::Cut, "record", found, "records up to a data end")
                    .into());
            }
        };
        match record::parse(opcode, &body).map_err(|short| broken(at(offset), opcode, &body, short))? {
            Record::Message(message) if channel_ids.contains(&message.channel_id) => {
                messages.push(ChunkFacts::of_message(offset, PREFIX + body.len() as u64, &message));
            }
            Record::DataEnd { data_section_crc } => {
                let mut findings = Findings::first_error();
                check_crc(Code::DataCrc, data_section_crc, source.crc_before(), at(offset), &mut findings);
                return fail(findings).map(|()| messages);
            }
            _ => {}
        }
    }
}

fn check_header<R: Read>(input: &mut R) -> Result<(), EffError> {
    let mut source = Source::new(input);
    let mut findings = Findings::first_error();
    magic(&mut source, &mut findings)?;
    fail(findings)?;
    let mut body = Vec::new();
    let next = source.next(&mut body)?;
    let header = record::parse(record::op::HEADER, &body);
    let (Next::Record { opcode: record::op::HEADER, .. }, Ok(Record::Header { profile })) = (next, header)
    else {
        return Err(at(8).finding(Code::RecordOrder, "record", "none", "a header, before all else").into());
    };
    if profile == PROFILE {
        Ok(())
    } else {
        Err(at(8).finding(Code::Profile, "header.profile", quoted(profile), quoted(PROFILE)).into())
    }
}

/// Where the summary begins.
fn read_footer<R: Read + Seek>(input: &mut R, length: u64) -> Result<u64, EffError> {
    let place = at(length.saturating_sub(TAIL));
    let cut = |found: String| place.finding(Code::Cut, "file", found, "a footer and the magic at its end");
    if length < TAIL + MAGIC.len() as u64 {
        return Err(cut(format!("{length} bytes")).into());
    }
    input.seek(SeekFrom::Start(length - TAIL))?;
    let mut tail = [0; TAIL as usize];
    input.read_exact(&mut tail)?;
    let (footer, magic) = tail.split_at(FOOTER as usize);
    if magic != MAGIC {
        return Err(cut(format!("an end in {}", magic.escape_ascii())).into());
    }
    let body = &footer[PREFIX as usize..];
    match record::parse(footer[0], body) {
        Ok(Record::Footer { summary_start, .. }) if (8..=length - TAIL).contains(&summary_start) => {
            Ok(summary_start)
        }
        Ok(Record::Footer { summary_start, .. }) => {
            let expected = "a place in the file";
            Err(place.finding(Code::Summary, "footer.summary_start", summary_start, expected).into())
        }
        _ => Err(place.finding(Code::RecordOrder, "record", record::name(footer[0]), "a footer").into()),
    }
}

fn read_summary<R: Read + Seek>(input: &mut R, start: u64, length: u64) -> Result<Summary, EffError> {
    input.seek(SeekFrom::Start(start))?;
    let mut source = Source::new(input.by_ref().take(length - start));
    let mut summary = Summary::new(start);
    let mut body = Vec::new();
    let mut findings = Findings::first_error();
    loop {
        let (opcode, offset) = match source.next(&mut body)? {
            Next::Record { opcode, offset } => (opcode, start + offset),
            Next::End { offset, found } => {
                return Err(at(start + offset)
                    .finding(Code::Cut, "record", found, "records up to a footer")
                    .into());
            }
        };
        match record::parse(opcode, &body).map_err(|short| broken(at(offset), opcode, &body, short))? {
            Record::Footer { summary_crc, .. } => {
                let computed = source.crc_through(opcode, &body, body.len() - 4);
                check_crc(Code::SummaryCrc, summary_crc, computed, at(offset), &mut findings);
                fail(findings)?;
                return Ok(summary);
            }
            record => summary.record(&record, opcode, &body, offset, &mut findings),
        }
    }
}

/// The channels that a file has.
struct Channels {
    /// The version of all of them.
    version: u32,
    by_topic: BTreeMap<&'static str, u16>,
    has_preview: bool,
}

/// The channels of the format, each as its version has it.
fn check_channels(declarations: &[(u8, Vec<u8>)]) -> Result<Channels, EffError> {
    struct Deaf;
    impl Listener for Deaf {
        fn manifest(&mut self, _manifest: &Manifest) -> Result<(), EffError> {
            Ok(())
        }
    }
    let mut deaf = Deaf;
    let mut data = Data::new(&mut deaf);
    let mut findings = Findings::first_error();
    for (opcode, body) in declarations {
        data.declaration(*opcode, body, Place::default(), &mut findings);
    }
    fail(findings)?;
    let versions: BTreeSet<u32> = data.streams().map(|(_, stream)| stream.version).collect();
    let (Some(version), true) = (versions.first(), versions.len() <= 1) else {
        let found = format!("channels of versions {versions:?}");
        return Err(Place::default()
            .finding(Code::Channel, "schema_id", found, "channels of one version")
            .into());
    };
    let by_topic = data.streams().map(|(id, stream)| (stream.topic, id)).collect();
    Ok(Channels { version: *version, by_topic, has_preview: data.has_preview() })
}
