//! Field files put together byte by byte: what other writers do and the container's own crate does not.

use super::{Piece, Pieces};
use std::collections::BTreeMap;

/// What a writer may do its own way.
#[derive(Clone, Copy, Debug, Default)]
pub struct Habits {
    /// Schemas and channels come before the first chunk, and are not repeated in it.
    pub has_early_schemas: bool,
    /// Each chunk has an index of every channel.
    pub indexes_every_channel: bool,
    /// The summary offsets name kinds of records that are not there.
    pub has_offsets_of_nothing: bool,
}

impl Pieces {
    /// Puts the file together by hand, its chunks unpacked. There are no attachments and no metadata.
    pub fn by_hand(&self, habits: Habits) -> Vec<u8> {
        let mut bytes =
            [&b"\x89MCAP0\r\n"[..], &record(0x01, &[&text(&self.profile), &text("by hand")])].concat();
        let declared = self.declared();
        if habits.has_early_schemas {
            bytes.extend(declared.concat().concat());
        }
        let mut chunk_indexes = Vec::new();
        for (k, chunk) in self.chunks.iter().enumerate() {
            let first =
                if k == 0 && !habits.has_early_schemas { declared.concat().concat() } else { Vec::new() };
            let channels = self.channels.iter().filter(|_| habits.indexes_every_channel);
            let indexed = channels.map(|(id, ..)| (*id, Vec::new())).collect();
            chunk_indexes.push(put_chunk(&mut bytes, first, chunk, indexed));
        }
        let crc = crc32fast::hash(&bytes);
        bytes.extend(record(0x0f, &[&crc.to_le_bytes()]));
        let [schemas, channels] = declared;
        let groups = [
            (0x03, schemas),
            (0x04, channels),
            (0x0b, vec![self.statistics()]),
            (0x08, chunk_indexes),
            (0x0a, Vec::new()),
            (0x0d, Vec::new()),
        ];
        put_summary(&mut bytes, &groups, habits.has_offsets_of_nothing);
        bytes
    }

    /// The records of all schemas, and those of all channels.
    fn declared(&self) -> [Vec<Vec<u8>>; 2] {
        let schemas = self.schemas.iter().map(|(id, name, encoding, data)| {
            let n = (data.len() as u32).to_le_bytes();
            record(0x03, &[&id.to_le_bytes(), &text(name), &text(encoding), &n, data])
        });
        let channels = self.channels.iter().map(|(id, schema, topic, encoding)| {
            let ids = [id.to_le_bytes(), schema.to_le_bytes()].concat();
            record(0x04, &[&ids, &text(topic), &text(encoding), &[0; 4]])
        });
        [schemas.collect(), channels.collect()]
    }

    fn statistics(&self) -> Vec<u8> {
        let messages = || self.chunks.iter().flatten();
        let mut counts: BTreeMap<u16, u64> = BTreeMap::new();
        messages().for_each(|p| *counts.entry(p.channel_id).or_default() += 1);
        let times = times(messages());
        let counts: Vec<u8> =
            counts.iter().flat_map(|(id, n)| [&id.to_le_bytes()[..], &n.to_le_bytes()].concat()).collect();
        let n_schemas = (self.schemas.len() as u16).to_le_bytes();
        let n_channels = (self.channels.len() as u32).to_le_bytes();
        let n_chunks = (self.chunks.len() as u32).to_le_bytes();
        let n_messages = (messages().count() as u64).to_le_bytes();
        let n = (counts.len() as u32).to_le_bytes();
        record(0x0b, &[&n_messages, &n_schemas, &n_channels, &[0; 8], &n_chunks, &times, &n, &counts])
    }
}

/// Puts a chunk there with its indexes; gives its record of the summary.
fn put_chunk(
    bytes: &mut Vec<u8>,
    mut content: Vec<u8>,
    chunk: &[Piece],
    mut indexed: BTreeMap<u16, Vec<u8>>,
) -> Vec<u8> {
    for p in chunk {
        let entry = [p.log_time.to_le_bytes(), (content.len() as u64).to_le_bytes()].concat();
        indexed.entry(p.channel_id).or_default().extend(entry);
        let times = [p.log_time.to_le_bytes(), p.publish_time.to_le_bytes()].concat();
        let ids = [&p.channel_id.to_le_bytes()[..], &p.sequence.to_le_bytes()].concat();
        content.extend(record(0x05, &[&ids, &times, &p.payload]));
    }
    let times = times(chunk.iter());
    let n = (content.len() as u64).to_le_bytes();
    let crc = crc32fast::hash(&content).to_le_bytes();
    let at = (bytes.len() as u64).to_le_bytes();
    let chunk = record(0x06, &[&times, &n, &crc, &text(""), &n, &content]);
    bytes.extend(&chunk);
    let indexes_start = bytes.len();
    let mut offsets = Vec::new();
    for (id, entries) in indexed {
        offsets.extend([&id.to_le_bytes()[..], &(bytes.len() as u64).to_le_bytes()].concat());
        let n = (entries.len() as u32).to_le_bytes();
        bytes.extend(record(0x07, &[&id.to_le_bytes(), &n, &entries]));
    }
    let n_indexes = ((bytes.len() - indexes_start) as u64).to_le_bytes();
    let length = (chunk.len() as u64).to_le_bytes();
    let n_offsets = (offsets.len() as u32).to_le_bytes();
    record(0x08, &[&times, &at, &length, &n_offsets, &offsets, &n_indexes, &text(""), &n, &n])
}

/// Puts groups of records there, their offsets, and the footer.
fn put_summary(bytes: &mut Vec<u8>, groups: &[(u8, Vec<Vec<u8>>)], has_offsets_of_nothing: bool) {
    let start = bytes.len();
    let mut offsets = Vec::new();
    for (opcode, records) in groups {
        let group = records.concat();
        if has_offsets_of_nothing || !group.is_empty() {
            let at = (bytes.len() as u64).to_le_bytes();
            offsets.push(record(0x0e, &[&[*opcode], &at, &(group.len() as u64).to_le_bytes()]));
        }
        bytes.extend(group);
    }
    let offsets_start = bytes.len() as u64;
    bytes.extend(offsets.concat());
    let starts = [(start as u64).to_le_bytes(), offsets_start.to_le_bytes()].concat();
    bytes.extend(record(0x02, &[&starts, &[0; 4]]));
    let crc_start = bytes.len() - 4;
    let crc = crc32fast::hash(&bytes[start..crc_start]);
    bytes.truncate(crc_start);
    bytes.extend(crc.to_le_bytes());
    bytes.extend(b"\x89MCAP0\r\n");
}

/// The first and the last time of some messages.
fn times<'a>(messages: impl Iterator<Item = &'a Piece>) -> Vec<u8> {
    let times: Vec<u64> = messages.map(|p| p.log_time).collect();
    let ends = [times.iter().min(), times.iter().max()];
    ends.iter().flat_map(|time| time.copied().unwrap_or(0).to_le_bytes()).collect()
}

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}

fn record(opcode: u8, parts: &[&[u8]]) -> Vec<u8> {
    let content = parts.concat();
    [&[opcode][..], &(content.len() as u64).to_le_bytes(), &content].concat()
}
