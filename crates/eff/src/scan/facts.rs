use crate::record::{AttachmentIndex, ChunkIndex};
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
