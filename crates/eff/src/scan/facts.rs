use crate::record::{AttachmentIndex, ChunkIndex, Message, PREFIX};
use std::collections::BTreeMap;

/// What a chunk index says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ChunkFacts {
    pub start_time: u64,
    pub end_time: u64,
    pub offset: u64,
    pub length: u64,
    pub message_index_offsets: BTreeMap<u16, u64>,
    pub message_index_length: u64,
    pub compression: String,
    pub compressed_size: u64,
    pub uncompressed_size: u64,
}

/// A message index without messages: its prefix, a channel, the length of an empty list.
const EMPTY_INDEX: u64 = PREFIX + 6;

/// What a message takes in a message index: its time and where it is.
const INDEX_ENTRY: u64 = 16;

impl ChunkFacts {
    /// A message outside chunks, as if it were one by itself.
    pub fn of_message(offset: u64, length: u64, message: &Message<'_>) -> Self {
        Self {
            start_time: message.log_time,
            end_time: message.log_time,
            offset,
            length,
            message_index_offsets: BTreeMap::from([(message.channel_id, offset + length)]),
            message_index_length: EMPTY_INDEX + INDEX_ENTRY,
            compression: String::new(),
            compressed_size: length,
            uncompressed_size: length,
        }
    }

    /// The channels that are indexed, and how many messages each has.
    ///
    /// The indexes follow the chunk one after the other: each ends where the next begins.
    pub fn message_counts(&self) -> impl Iterator<Item = (u16, u64)> {
        let mut starts: Vec<_> = self.message_index_offsets.iter().map(|(id, at)| (*at, *id)).collect();
        starts.sort_unstable();
        let last_end = self.offset.saturating_add(self.length).saturating_add(self.message_index_length);
        let ends: Vec<_> = starts.iter().skip(1).map(|(at, _)| *at).chain([last_end]).collect();
        let count = |(at, id): (u64, u16), end: u64| {
            (id, end.saturating_sub(at).saturating_sub(EMPTY_INDEX) / INDEX_ENTRY)
        };
        starts.into_iter().zip(ends).map(move |(start, end)| count(start, end))
    }

    /// Whether an index record at a place would be the next one of the chunk, and its channel's first.
    pub fn is_followed_by(&self, index_offset: u64, channel_id: u16) -> bool {
        self.offset + self.length + self.message_index_length == index_offset
            && !self.message_index_offsets.contains_key(&channel_id)
    }
}

/// What an attachment index says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct AttachmentFacts {
    pub offset: u64,
    pub length: u64,
    pub log_time: u64,
    pub create_time: u64,
    pub data_size: u64,
    pub name: String,
    pub media_type: String,
}

impl From<&ChunkIndex<'_>> for ChunkFacts {
    fn from(index: &ChunkIndex<'_>) -> Self {
        Self {
            start_time: index.start_time,
            end_time: index.end_time,
            offset: index.offset,
            length: index.length,
            message_index_offsets: index.message_index_offsets.clone(),
            message_index_length: index.message_index_length,
            compression: index.compression.to_owned(),
            compressed_size: index.compressed_size,
            uncompressed_size: index.uncompressed_size,
        }
    }
}

impl From<&AttachmentIndex<'_>> for AttachmentFacts {
    fn from(index: &AttachmentIndex<'_>) -> Self {
        Self {
            offset: index.offset,
            length: index.length,
            log_time: index.log_time,
            create_time: index.create_time,
            data_size: index.data_size,
            name: index.name.to_owned(),
            media_type: index.media_type.to_owned(),
        }
    }
}
