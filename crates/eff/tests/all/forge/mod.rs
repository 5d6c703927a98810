//! Field files taken apart, changed, and put together again by the container's own crate, with every checksum
//! right, so that exactly one thing is wrong with them.

pub mod by_hand;

use mcap::records::{MessageHeader, Metadata};
use protox::prost_reflect::prost::Message as _;
use protox::prost_reflect::{DescriptorPool, DynamicMessage, Value};
use std::collections::BTreeMap;
use std::io::Cursor;

/// A file in pieces.
#[derive(Clone, Debug)]
pub struct Pieces {
    pub profile: String,
    /// Id, name, encoding, text.
    pub schemas: Vec<(u16, String, String, Vec<u8>)>,
    /// Id, schema, topic, message encoding.
    pub channels: Vec<(u16, u16, String, String)>,
    /// The chunks, each with its messages.
    pub chunks: Vec<Vec<Piece>>,
    /// Name, media type, content; they come after the poses.
    pub attachments: Vec<(String, String, Vec<u8>)>,
    pub metadata: Vec<String>,
    pub options: mcap::WriteOptions,
}

/// A message.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    pub channel_id: u16,
    pub sequence: u32,
    pub log_time: u64,
    pub publish_time: u64,
    pub payload: Vec<u8>,
}

pub const MANIFEST: u16 = 1;
pub const EDITS: u16 = 2;
pub const POSE: u16 = 3;
pub const SAMPLES: u16 = 4;
pub const FIELD: u16 = 5;
pub const PREVIEW_HEAD: u16 = 6;
pub const PREVIEW_WIND: u16 = 7;

/// Takes a file of ours apart.
pub fn pieces(bytes: &[u8]) -> Pieces {
    let summary = mcap::Summary::read(bytes).unwrap().unwrap();
    let mut schemas: Vec<_> = summary.schemas.values().collect();
    schemas.sort_by_key(|s| s.id);
    let mut channels: Vec<_> = summary.channels.values().collect();
    channels.sort_by_key(|c| c.id);
    let mut chunks: Vec<Vec<Piece>> = Vec::new();
    for message in mcap::MessageStream::new(bytes).unwrap() {
        let message = message.unwrap();
        let piece = Piece {
            channel_id: message.channel.id,
            sequence: message.sequence,
            log_time: message.log_time,
            publish_time: message.publish_time,
            payload: message.data.to_vec(),
        };
        let kind = |p: &Piece| if p.channel_id == EDITS { MANIFEST } else { p.channel_id };
        match chunks.last_mut() {
            Some(chunk) if kind(&chunk[0]) == kind(&piece) && kind(&piece) != FIELD => chunk.push(piece),
            _ => chunks.push(vec![piece]),
        }
    }
    let attachments = summary.attachment_indexes.iter().map(|index| {
        let a = mcap::read::attachment(bytes, index).unwrap();
        (a.name, a.media_type, a.data.to_vec())
    });
    Pieces {
        profile: "tousle.eff".into(),
        schemas: schemas
            .into_iter()
            .map(|s| (s.id, s.name.clone(), s.encoding.clone(), s.data.to_vec()))
            .collect(),
        channels: channels
            .into_iter()
            .map(|c| {
                (c.id, c.schema.as_ref().map_or(0, |s| s.id), c.topic.clone(), c.message_encoding.clone())
            })
            .collect(),
        chunks,
        attachments: attachments.collect(),
        metadata: Vec::new(),
        options: mcap::WriteOptions::new().compression_threads(0).compression_level(1).chunk_size(None),
    }
}

impl Pieces {
    /// Puts the file together.
    pub fn forge(&self) -> Vec<u8> {
        let mut out = Vec::new();
        let options = self.options.clone().profile(&self.profile).library("forge");
        let mut writer = options.create(Cursor::new(&mut out)).unwrap();
        for (id, name, encoding, text) in &self.schemas {
            writer.add_schema_with_id(*id, name, encoding, text).unwrap();
        }
        for (id, schema, topic, encoding) in &self.channels {
            writer.add_channel_with_id(*id, *schema, topic, encoding, &BTreeMap::new()).unwrap();
        }
        for (k, chunk) in self.chunks.iter().enumerate() {
            for p in chunk {
                let header = MessageHeader {
                    channel_id: p.channel_id,
                    sequence: p.sequence,
                    log_time: p.log_time,
                    publish_time: p.publish_time,
                };
                writer.write_to_known_channel(&header, &p.payload).unwrap();
            }
            writer.flush().unwrap();
            if k == 1 {
                for (name, media_type, data) in &self.attachments {
                    let (name, media_type) = (name.clone(), media_type.clone());
                    let data = data.into();
                    writer
                        .attach(&mcap::Attachment { log_time: 0, create_time: 0, name, media_type, data })
                        .unwrap();
                }
                for name in &self.metadata {
                    writer
                        .write_metadata(&Metadata { name: name.clone(), metadata: BTreeMap::new() })
                        .unwrap();
                }
            }
        }
        writer.finish().unwrap();
        drop(writer);
        out
    }

    /// The `k`th message of a channel.
    pub fn message(&mut self, channel_id: u16, k: usize) -> &mut Piece {
        self.chunks.iter_mut().flatten().filter(|p| p.channel_id == channel_id).nth(k).unwrap()
    }

    /// Changes the JSON of a channel's message.
    pub fn json(&mut self, channel_id: u16, change: impl FnOnce(&mut serde_json::Value)) {
        let piece = self.message(channel_id, 0);
        let mut value = serde_json::from_slice(&piece.payload).unwrap();
        change(&mut value);
        piece.payload = serde_json::to_vec(&value).unwrap();
    }

    /// Sets a member of the manifest, by its JSON pointer; `null` takes away what is there.
    pub fn manifest(&mut self, pointer: &str, new: impl Into<serde_json::Value>) {
        self.json(MANIFEST, |manifest| *manifest.pointer_mut(pointer).unwrap() = new.into());
    }

    /// Changes the protobuf of a channel's `k`th message.
    pub fn proto(&mut self, channel_id: u16, k: usize, change: impl FnOnce(&mut DynamicMessage)) {
        let name = match channel_id {
            POSE => "PoseStep",
            SAMPLES => "SampleStep",
            _ => "FieldStep",
        };
        let pool =
            DescriptorPool::decode(&include_bytes!("../../../../../schemas/eff.v1.binpb")[..]).unwrap();
        let descriptor = pool.get_message_by_name(&format!("tousle.eff.v1.{name}")).unwrap();
        let piece = self.message(channel_id, k);
        let mut message = DynamicMessage::decode(descriptor, &piece.payload[..]).unwrap();
        change(&mut message);
        piece.payload = message.encode_to_vec();
    }
}

/// Sets a field within a message, by a path with dots.
pub fn set(message: &mut DynamicMessage, path: &str, value: impl Into<Value>) {
    match path.split_once('.') {
        Some((first, rest)) => {
            set(message.get_field_by_name_mut(first).unwrap().as_message_mut().unwrap(), rest, value);
        }
        None => message.set_field_by_name(path, value.into()),
    }
}

/// The bytes of a field within a message, by a path with dots.
pub fn bytes(message: &DynamicMessage, path: &str) -> Vec<u8> {
    match path.split_once('.') {
        Some((first, rest)) => bytes(message.get_field_by_name(first).unwrap().as_message().unwrap(), rest),
        None => message.get_field_by_name(path).unwrap().as_bytes().unwrap().to_vec(),
    }
}

/// Puts a float into an array of byte planes.
pub fn put_float(message: &mut DynamicMessage, path: &str, k: usize, float: f32) {
    let mut data = bytes(message, &format!("{path}.data"));
    let n = data.len() / 4;
    for (plane, byte) in float.to_le_bytes().into_iter().enumerate() {
        data[plane * n + k] = byte;
    }
    set(message, &format!("{path}.data"), Value::Bytes(data.into()));
}

/// Where a record begins, its opcode, and the length of its content.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct At {
    pub offset: usize,
    pub opcode: u8,
    pub length: usize,
}

impl At {
    pub fn content(self) -> usize {
        self.offset + 9
    }

    pub fn end(self) -> usize {
        self.content() + self.length
    }
}

/// The records of a file, in order, to the footer.
pub fn records(bytes: &[u8]) -> Vec<At> {
    let mut records: Vec<At> = Vec::new();
    while records.last().is_none_or(|at| at.opcode != 0x02) {
        let offset = records.last().map_or(8, |at| at.end());
        let length = u64::from_le_bytes(bytes[offset + 1..offset + 9].try_into().unwrap()) as usize;
        records.push(At { offset, opcode: bytes[offset], length });
    }
    records
}

/// The `k`th record of a kind.
pub fn record(bytes: &[u8], opcode: u8, k: usize) -> At {
    records(bytes).into_iter().filter(|at| at.opcode == opcode).nth(k).unwrap()
}

/// Makes the checksums of the two sections right again.
pub fn refit(bytes: &mut [u8]) {
    let data_end = record(bytes, 0x0f, 0);
    let crc = crc32fast::hash(&bytes[..data_end.offset]);
    bytes[data_end.content()..data_end.end()].copy_from_slice(&crc.to_le_bytes());
    let footer = record(bytes, 0x02, 0);
    let crc = crc32fast::hash(&bytes[data_end.end()..footer.end() - 4]);
    bytes[footer.end() - 4..footer.end()].copy_from_slice(&crc.to_le_bytes());
}

/// Changes some bytes of a record's content, and makes the sections' checksums right again.
pub fn patch(bytes: &mut [u8], at: At, within: usize, new: &[u8]) {
    bytes[at.content() + within..][..new.len()].copy_from_slice(new);
    refit(bytes);
}
