//! MCAP records, as <https://mcap.dev/spec> (version 0) lays them out.
//!
//! The crate that writes our files can read them too, but it tells neither where a record lies nor which of its
//! fields is wrong, and it takes a count at its word before it has seen the bytes. Parsing is the small half of
//! the work: every record is a few numbers and strings, and here each is bounded by the bytes that are there.

mod cursor;

use cursor::Cursor;
pub(crate) use cursor::Short;
use std::collections::BTreeMap;

/// The first and the last eight bytes of a file.
pub(crate) const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

/// Opcode and length before every record's content.
pub(crate) const PREFIX: u64 = 9;

/// The length of the footer with its prefix.
pub(crate) const FOOTER: u64 = PREFIX + 20;

/// Opcodes.
pub(crate) mod op {
    pub(crate) const HEADER: u8 = 0x01;
    pub(crate) const FOOTER: u8 = 0x02;
    pub(crate) const SCHEMA: u8 = 0x03;
    pub(crate) const CHANNEL: u8 = 0x04;
    pub(crate) const MESSAGE: u8 = 0x05;
    pub(crate) const CHUNK: u8 = 0x06;
    pub(crate) const MESSAGE_INDEX: u8 = 0x07;
    pub(crate) const CHUNK_INDEX: u8 = 0x08;
    pub(crate) const ATTACHMENT: u8 = 0x09;
    pub(crate) const ATTACHMENT_INDEX: u8 = 0x0a;
    pub(crate) const STATISTICS: u8 = 0x0b;
    pub(crate) const METADATA: u8 = 0x0c;
    pub(crate) const METADATA_INDEX: u8 = 0x0d;
    pub(crate) const SUMMARY_OFFSET: u8 = 0x0e;
    pub(crate) const DATA_END: u8 = 0x0f;
    /// From here on records are other applications'.
    pub(crate) const PRIVATE: u8 = 0x80;
}

/// What a record is called.
pub(crate) fn name(opcode: u8) -> &'static str {
    match opcode {
        op::HEADER => "header",
        op::FOOTER => "footer",
        op::SCHEMA => "schema",
        op::CHANNEL => "channel",
        op::MESSAGE => "message",
        op::CHUNK => "chunk",
        op::MESSAGE_INDEX => "message index",
        op::CHUNK_INDEX => "chunk index",
        op::ATTACHMENT => "attachment",
        op::ATTACHMENT_INDEX => "attachment index",
        op::STATISTICS => "statistics",
        op::METADATA => "metadata",
        op::METADATA_INDEX => "metadata index",
        op::SUMMARY_OFFSET => "summary offset",
        op::DATA_END => "data end",
        op::PRIVATE.. => "private record",
        _ => "unknown record",
    }
}

/// A record's content.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Record<'a> {
    Header { profile: &'a str },
    Footer { summary_start: u64, summary_offset_start: u64, summary_crc: u32 },
    Schema(Schema<'a>),
    Channel(Channel<'a>),
    Message(Message<'a>),
    Chunk(Chunk<'a>),
    MessageIndex { channel_id: u16, entries: Vec<(u64, u64)> },
    ChunkIndex(ChunkIndex<'a>),
    Attachment(Attachment<'a>),
    AttachmentIndex(AttachmentIndex<'a>),
    Statistics(Statistics),
    Metadata { name: &'a str, metadata: BTreeMap<&'a str, &'a str> },
    MetadataIndex { name: &'a str },
    SummaryOffset { group_opcode: u8, group_start: u64, group_length: u64 },
    DataEnd { data_section_crc: u32 },
    Private,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Schema<'a> {
    pub id: u16,
    pub name: &'a str,
    pub encoding: &'a str,
    pub data: &'a [u8],
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Channel<'a> {
    pub id: u16,
    pub schema_id: u16,
    pub topic: &'a str,
    pub message_encoding: &'a str,
    pub metadata: BTreeMap<&'a str, &'a str>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Message<'a> {
    pub channel_id: u16,
    pub sequence: u32,
    pub log_time: u64,
    pub publish_time: u64,
    pub data: &'a [u8],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Chunk<'a> {
    pub start_time: u64,
    pub end_time: u64,
    pub uncompressed_size: u64,
    pub uncompressed_crc: u32,
    pub compression: &'a str,
    pub data: &'a [u8],
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ChunkIndex<'a> {
    pub start_time: u64,
    pub end_time: u64,
    pub offset: u64,
    pub length: u64,
    pub message_index_offsets: BTreeMap<u16, u64>,
    pub message_index_length: u64,
    pub compression: &'a str,
    pub compressed_size: u64,
    pub uncompressed_size: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Attachment<'a> {
    pub log_time: u64,
    pub create_time: u64,
    pub name: &'a str,
    pub media_type: &'a str,
    pub data: &'a [u8],
    pub crc: u32,
    /// What the checksum should be.
    pub computed_crc: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct AttachmentIndex<'a> {
    pub offset: u64,
    pub length: u64,
    pub log_time: u64,
    pub create_time: u64,
    pub data_size: u64,
    pub name: &'a str,
    pub media_type: &'a str,
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Statistics {
    pub message_count: u64,
    pub schema_count: u16,
    pub channel_count: u32,
    pub attachment_count: u32,
    pub metadata_count: u32,
    pub chunk_count: u32,
    pub start_time: u64,
    pub end_time: u64,
    pub channel_message_counts: BTreeMap<u16, u64>,
}

/// Reads a record's content.
///
/// # Errors
/// [`Short`] if it is shorter than its fields, a text is not UTF-8, or bytes are left over.
pub(crate) fn parse(opcode: u8, body: &[u8]) -> Result<Record<'_>, Short> {
    let mut c = Cursor::new(body);
    let record = match opcode {
        op::HEADER => {
            let profile = c.text("profile")?;
            c.text("library")?;
            Record::Header { profile }
        }
        op::FOOTER => Record::Footer {
            summary_start: c.u64("summary_start")?,
            summary_offset_start: c.u64("summary_offset_start")?,
            summary_crc: c.u32("summary_crc")?,
        },
        op::SCHEMA => schema(&mut c)?,
        op::CHANNEL => channel(&mut c)?,
        op::MESSAGE => message(&mut c)?,
        op::CHUNK => chunk(&mut c)?,
        op::MESSAGE_INDEX => Record::MessageIndex {
            channel_id: c.u16("channel_id")?,
            entries: c.list("records", |c| Ok((c.u64("log_time")?, c.u64("offset")?)))?,
        },
        op::CHUNK_INDEX => chunk_index(&mut c)?,
        op::ATTACHMENT => attachment(&mut c)?,
        op::ATTACHMENT_INDEX => attachment_index(&mut c)?,
        op::STATISTICS => statistics(&mut c)?,
        op::METADATA => {
            let name = c.text("name")?;
            let metadata = c.map("metadata", |c| c.text("key"), |c| c.text("value"))?;
            Record::Metadata { name, metadata }
        }
        op::METADATA_INDEX => {
            c.u64("offset")?;
            c.u64("length")?;
            Record::MetadataIndex { name: c.text("name")? }
        }
        op::SUMMARY_OFFSET => Record::SummaryOffset {
            group_opcode: c.u8("group_opcode")?,
            group_start: c.u64("group_start")?,
            group_length: c.u64("group_length")?,
        },
        op::DATA_END => Record::DataEnd { data_section_crc: c.u32("data_section_crc")? },
        op::PRIVATE.. => {
            c.rest();
            Record::Private
        }
        _ => return Err(Short { field: "opcode", expected: "an opcode of MCAP version 0" }),
    };
    c.end()?;
    Ok(record)
}

fn schema<'a>(c: &mut Cursor<'a>) -> Result<Record<'a>, Short> {
    Ok(Record::Schema(Schema {
        id: c.u16("id")?,
        name: c.text("name")?,
        encoding: c.text("encoding")?,
        data: c.bytes32("data")?,
    }))
}

fn channel<'a>(c: &mut Cursor<'a>) -> Result<Record<'a>, Short> {
    Ok(Record::Channel(Channel {
        id: c.u16("id")?,
        schema_id: c.u16("schema_id")?,
        topic: c.text("topic")?,
        message_encoding: c.text("message_encoding")?,
        metadata: c.map("metadata", |c| c.text("key"), |c| c.text("value"))?,
    }))
}

fn message<'a>(c: &mut Cursor<'a>) -> Result<Record<'a>, Short> {
    Ok(Record::Message(Message {
        channel_id: c.u16("channel_id")?,
        sequence: c.u32("sequence")?,
        log_time: c.u64("log_time")?,
        publish_time: c.u64("publish_time")?,
        data: c.rest(),
    }))
}

fn chunk<'a>(c: &mut Cursor<'a>) -> Result<Record<'a>, Short> {
    Ok(Record::Chunk(Chunk {
        start_time: c.u64("message_start_time")?,
        end_time: c.u64("message_end_time")?,
        uncompressed_size: c.u64("uncompressed_size")?,
        uncompressed_crc: c.u32("uncompressed_crc")?,
        compression: c.text("compression")?,
        data: c.bytes64("records")?,
    }))
}

fn chunk_index<'a>(c: &mut Cursor<'a>) -> Result<Record<'a>, Short> {
    Ok(Record::ChunkIndex(ChunkIndex {
        start_time: c.u64("message_start_time")?,
        end_time: c.u64("message_end_time")?,
        offset: c.u64("chunk_start_offset")?,
        length: c.u64("chunk_length")?,
        message_index_offsets: c.map(
            "message_index_offsets",
            |c| c.u16("channel_id"),
            |c| c.u64("offset"),
        )?,
        message_index_length: c.u64("message_index_length")?,
        compression: c.text("compression")?,
        compressed_size: c.u64("compressed_size")?,
        uncompressed_size: c.u64("uncompressed_size")?,
    }))
}

fn attachment<'a>(c: &mut Cursor<'a>) -> Result<Record<'a>, Short> {
    let whole = c.left();
    let log_time = c.u64("log_time")?;
    let create_time = c.u64("create_time")?;
    let name = c.text("name")?;
    let media_type = c.text("media_type")?;
    let data = c.bytes64("data")?;
    let computed_crc = crc32fast::hash(&whole[..whole.len() - c.left().len()]);
    let crc = c.u32("crc")?;
    Ok(Record::Attachment(Attachment { log_time, create_time, name, media_type, data, crc, computed_crc }))
}

fn attachment_index<'a>(c: &mut Cursor<'a>) -> Result<Record<'a>, Short> {
    Ok(Record::AttachmentIndex(AttachmentIndex {
        offset: c.u64("offset")?,
        length: c.u64("length")?,
        log_time: c.u64("log_time")?,
        create_time: c.u64("create_time")?,
        data_size: c.u64("data_size")?,
        name: c.text("name")?,
        media_type: c.text("media_type")?,
    }))
}

fn statistics<'a>(c: &mut Cursor<'a>) -> Result<Record<'a>, Short> {
    Ok(Record::Statistics(Statistics {
        message_count: c.u64("message_count")?,
        schema_count: c.u16("schema_count")?,
        channel_count: c.u32("channel_count")?,
        attachment_count: c.u32("attachment_count")?,
        metadata_count: c.u32("metadata_count")?,
        chunk_count: c.u32("chunk_count")?,
        start_time: c.u64("message_start_time")?,
        end_time: c.u64("message_end_time")?,
        channel_message_counts: c.map(
            "channel_message_counts",
            |c| c.u16("channel_id"),
            |c| c.u64("count"),
        )?,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_by_hand() {
        let body = b"\x0a\0\0\0tousle.eff\x01\0\0\0x";
        assert_eq!(parse(op::HEADER, body), Ok(Record::Header { profile: "tousle.eff" }));
        for cut in 0..body.len() {
            assert!(parse(op::HEADER, &body[..cut]).is_err(), "{cut}");
        }
        let error = parse(op::HEADER, b"\x0a\0\0\0tousle.eff\0\0\0\0more").unwrap_err();
        assert_eq!(error.expected, "no more bytes");
    }

    #[test]
    fn an_attachment_without_room_for_its_checksum_is_no_panic() {
        let mut body = vec![0; 16];
        body.extend([0; 4]);
        body.extend([0; 4]);
        body.extend([0; 8]);
        assert_eq!(parse(op::ATTACHMENT, &body).unwrap_err().field, "crc");
    }

    #[test]
    fn a_map_with_a_key_twice_is_refused() {
        let mut body = vec![1, 0, 1, 0];
        body.extend([0; 8]);
        body.extend(20u32.to_le_bytes());
        for _ in 0..2 {
            body.extend(b"\x01\0\0\0k\x01\0\0\0v");
        }
        assert_eq!(parse(op::CHANNEL, &body).unwrap_err().expected, "each key once");
    }
}
