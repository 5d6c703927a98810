//! What MCAP itself would, or would not, complain about.

use super::{Case, forged, patched, sound};
use crate::forge::by_hand::Habits;
use crate::forge::{FIELD, MANIFEST, POSE, patch, pieces, record, refit};

const HEADER: u8 = 0x01;
const CHUNK: u8 = 0x06;
const MESSAGE_INDEX: u8 = 0x07;
const CHUNK_INDEX: u8 = 0x08;
const ATTACHMENT: u8 = 0x09;
const ATTACHMENT_INDEX: u8 = 0x0a;
const STATISTICS: u8 = 0x0b;
const METADATA: u8 = 0x0c;
const SUMMARY_OFFSET: u8 = 0x0e;
const DATA_END: u8 = 0x0f;
const FOOTER: u8 = 0x02;

pub fn cases() -> Vec<Case> {
    let mut cases = ends();
    cases.extend(checksums());
    cases.extend(chunks());
    cases.extend(summary());
    cases.extend(channels());
    cases.extend(order());
    cases
}

fn ends() -> Vec<Case> {
    vec![
        patched("empty", "no byte at all", &["cut"], Vec::clear),
        patched("magic-first", "the first byte is another", &["magic"], |b| b[0] = b'X'),
        patched("magic-version", "MCAP version 1", &["magic"], |b| b[5] = b'1'),
        patched("magic-last", "the last byte is another", &["magic"], |b| *b.last_mut().unwrap() = 0),
        forged("profile", "the profile of a robot", &["profile"], |p| p.profile = "ros2".into()),
        patched("cut-in-chunk", "ends within the chunk of a step", &["cut"], |b| {
            let chunk = record(b, CHUNK, 3);
            b.truncate(chunk.content() + chunk.length / 2);
        }),
        patched("cut-in-prefix", "ends within a record's length", &["cut"], |b| {
            let chunk = record(b, CHUNK, 3);
            b.truncate(chunk.offset + 4);
        }),
        patched("cut-between-records", "ends before a message index", &["cut"], |b| {
            let index = record(b, MESSAGE_INDEX, 4);
            b.truncate(index.offset);
        }),
        patched("cut-in-summary", "ends within the summary", &["cut"], |b| {
            let index = record(b, CHUNK_INDEX, 2);
            b.truncate(index.offset);
        }),
        patched("cut-last-byte", "the last byte is missing", &["cut"], |b| b.truncate(b.len() - 1)),
        patched("trailing", "a byte too many", &["trailing"], |b| b.push(0)),
    ]
}

fn checksums() -> Vec<Case> {
    vec![
        patched("data-crc", "a letter of the header's library changed", &["data-crc"], |b| {
            let header = record(b, HEADER, 0);
            b[header.end() - 1] ^= 1;
        }),
        patched("data-crc-none", "no checksum of the data", &["data-crc"], |b| {
            let end = record(b, DATA_END, 0);
            b[end.content()..end.end()].fill(0);
        }),
        patched("summary-crc", "the summary's checksum is another", &["summary-crc"], |b| {
            let footer = record(b, FOOTER, 0);
            b[footer.end() - 1] ^= 1;
        }),
        patched("summary-crc-none", "no checksum of the summary", &["summary-crc"], |b| {
            let footer = record(b, FOOTER, 0);
            b[footer.end() - 4..footer.end()].fill(0);
        }),
        patched("chunk-crc", "a chunk's checksum is another", &["chunk-crc"], |b| {
            let chunk = record(b, CHUNK, 3);
            let new = [b[chunk.content() + 24] ^ 1];
            patch(b, chunk, 24, &new);
        }),
        patched("chunk-crc-none", "no checksum of a chunk", &["chunk-crc"], |b| {
            let chunk = record(b, CHUNK, 3);
            patch(b, chunk, 24, &[0; 4]);
        }),
        patched("attachment-crc", "a letter of the attachment changed", &["attachment-crc"], |b| {
            let attachment = record(b, ATTACHMENT, 0);
            let new = [b[attachment.end() - 6] ^ 1];
            patch(b, attachment, attachment.length - 6, &new);
        }),
        patched("attachment-crc-none", "no checksum of the attachment", &["attachment-crc"], |b| {
            let attachment = record(b, ATTACHMENT, 0);
            patch(b, attachment, attachment.length - 4, &[0; 4]);
        }),
    ]
}

fn chunks() -> Vec<Case> {
    vec![
        patched("compression-name", "a chunk packed by lz5", &["compression", "summary"], |b| {
            let chunk = record(b, CHUNK, 3);
            patch(b, chunk, 32, b"lz5\0");
        }),
        patched("compression-broken", "a chunk that zstd cannot unpack", &["compression"], |b| {
            let chunk = record(b, CHUNK, 3);
            // After the 8 + 8 + 8 + 4 + (4 + 4) + 8 bytes before them, the packed records.
            patch(b, chunk, 44, &[0; 4]);
        }),
        patched(
            "compression-size",
            "a chunk that unpacks to less than it says",
            &["compression", "summary"],
            |b| {
                let chunk = record(b, CHUNK, 3);
                let new = [b[chunk.content() + 16] + 1];
                patch(b, chunk, 16, &new);
            },
        ),
        patched("chunk-huge", "a chunk that says it unpacks to 4 GB", &["compression", "summary"], |b| {
            let chunk = record(b, CHUNK, 3);
            patch(b, chunk, 20, &[1]);
        }),
        patched("chunk-times", "a chunk that says it ends later", &["chunk-times", "summary"], |b| {
            let chunk = record(b, CHUNK, 4);
            let new = [b[chunk.content() + 8] + 1];
            patch(b, chunk, 8, &new);
        }),
        patched(
            "record-short",
            "a chunk record too short for its fields",
            &["record", "summary", "summary", "summary"],
            |b| {
                let chunk = record(b, CHUNK, 3);
                patch(b, chunk, 36, &[0xff; 8]);
            },
        ),
        patched(
            "record-opcode",
            "an opcode that MCAP does not have",
            &["record", "summary", "summary"],
            |b| {
                let index = record(b, ATTACHMENT, 0);
                b[index.offset] = 0x70;
                refit(b);
            },
        ),
        patched("message-index", "a message index that points elsewhere", &["message-index"], |b| {
            let index = record(b, MESSAGE_INDEX, 4);
            let new = [b[index.end() - 8] ^ 1];
            patch(b, index, index.length - 8, &new);
        }),
        Case {
            name: "message-index-twice",
            what: "two message indexes of a channel, the second empty",
            findings: &["message-index", "summary"],
            make: Box::new(|| {
                let habits = Habits { indexes_every_channel: true, ..Habits::default() };
                let mut bytes = pieces(&sound()).by_hand(habits);
                let index_of_poses = record(&bytes, MESSAGE_INDEX, 2);
                patch(&mut bytes, index_of_poses, 0, &MANIFEST.to_le_bytes());
                bytes
            }),
        },
        patched(
            "message-index-none",
            "a chunk without message index",
            &["message-index", "skipped", "summary"],
            |b| {
                let index = record(b, MESSAGE_INDEX, 4);
                // Another application's record instead.
                b[index.offset] = 0x80;
                refit(b);
            },
        ),
    ]
}

fn summary() -> Vec<Case> {
    vec![
        patched("summary-statistics", "one message more in the statistics", &["summary"], |b| {
            let statistics = record(b, STATISTICS, 0);
            let new = [b[statistics.content()] + 1];
            patch(b, statistics, 0, &new);
        }),
        patched("summary-chunk-index", "a chunk index that points elsewhere", &["summary"], |b| {
            let index = record(b, CHUNK_INDEX, 3);
            let new = [b[index.content() + 16] ^ 1];
            patch(b, index, 16, &new);
        }),
        patched("summary-attachment-index", "an attachment index that points elsewhere", &["summary"], |b| {
            let index = record(b, ATTACHMENT_INDEX, 0);
            let new = [b[index.content()] ^ 1];
            patch(b, index, 0, &new);
        }),
        patched("summary-offset", "a summary offset that points elsewhere", &["summary"], |b| {
            let offset = record(b, SUMMARY_OFFSET, 0);
            let new = [b[offset.content() + 1] ^ 1];
            patch(b, offset, 1, &new);
        }),
        patched("summary-start", "a footer that points elsewhere", &["summary"], |b| {
            let footer = record(b, FOOTER, 0);
            let new = [b[footer.content()] ^ 1];
            patch(b, footer, 0, &new);
        }),
        forged("summary-no-schemas", "schemas are not repeated", &["summary"], |p| {
            p.options = p.options.clone().repeat_schemas(false);
        }),
        forged("summary-no-channels", "channels are not repeated", &["summary"], |p| {
            p.options = p.options.clone().repeat_channels(false);
        }),
        forged("summary-no-indexes", "no chunk indexes", &["summary"], |p| {
            p.options = p.options.clone().emit_chunk_indexes(false);
        }),
        Case {
            name: "two-headers",
            what: "a second header",
            findings: &["record-order", "summary", "summary"],
            make: Box::new(|| {
                let mut pieces = pieces(&sound());
                pieces.metadata.push("tousle.eff".into());
                let mut bytes = pieces.forge();
                // A metadata record without entries reads as a header without library.
                let metadata = record(&bytes, METADATA, 0);
                bytes[metadata.offset] = HEADER;
                refit(&mut bytes);
                bytes
            }),
        },
        patched(
            "no-header",
            "another application's record instead of a header",
            &["record-order", "skipped"],
            |b| {
                let header = record(b, HEADER, 0);
                b[header.offset] = 0x80;
                refit(b);
            },
        ),
    ]
}

fn channels() -> Vec<Case> {
    vec![
        forged("schema-encoding", "a JSON schema that says it is protobuf", &["schema"], |p| {
            p.schemas[0].2 = "protobuf".into();
        }),
        forged("channel-encoding", "JSON on a protobuf channel", &["channel"], |p| {
            p.channels[2].3 = "json".into();
        }),
        forged("channel-schema", "poses described as steps", &["channel"], |p| p.channels[2].1 = FIELD),
        forged("channel-unknown", "a topic of ours that version 1 does not have", &["channel"], |p| {
            p.channels.push((9, 0, "/eff/temperature".into(), "json".into()));
        }),
        forged("channel-twice", "two channels of one topic", &["channel"], |p| {
            p.channels.push((9, POSE, "/eff/pose".into(), "protobuf".into()));
        }),
    ]
}

fn order() -> Vec<Case> {
    vec![
        forged("sequence", "a sequence number is left out", &["order"], |p| p.message(POSE, 2).sequence = 3),
        forged("publish-time", "published later than logged", &["order"], |p| {
            p.message(POSE, 2).publish_time += 1;
        }),
        forged("manifest-none", "no manifest", &["missing"], |p| {
            p.chunks[0].retain(|piece| piece.channel_id != MANIFEST);
        }),
        forged("manifest-late", "edits come before the manifest", &["missing"], |p| p.chunks[0].swap(0, 1)),
        forged("manifest-twice", "two manifests", &["missing"], |p| {
            let mut again = p.chunks[0][0].clone();
            again.sequence = 1;
            p.chunks.push(vec![again]);
        }),
        forged("edits-twice", "two messages of edits", &["missing"], |p| {
            let mut again = p.chunks[0][1].clone();
            again.sequence = 1;
            p.chunks.push(vec![again]);
        }),
    ]
}
