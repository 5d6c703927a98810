//! What other programs put into a field file: topics that are not ours, metadata, private records. It is copied.

use super::Loss;
use super::inventory::{content, record_at};
use crate::record::{self, Channel, Record, Schema, op};
use crate::scan::chunk::{InChunk, records_in};
use crate::scan::data::Data;
use crate::{EffError, Writer};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{Read, Seek, Write};

/// Where it is.
#[derive(Default)]
pub(super) struct Foreign {
    /// The chunks that hold messages, and messages outside chunks: offset and opcode.
    pub messages: BTreeSet<(u64, u8)>,
    /// Metadata and private records: offset and opcode.
    pub records: BTreeSet<(u64, u8)>,
    /// The contents of the records of channels and their schemas.
    channels: BTreeMap<u16, Vec<u8>>,
    schemas: BTreeMap<u16, Vec<u8>>,
}

impl Foreign {
    /// Takes in what was declared.
    pub fn declare(&mut self, data: &Data<'_>, losses: &mut Vec<Loss>) {
        self.channels = data.foreign_channels().map(|(id, body)| (id, body.to_vec())).collect();
        self.schemas = data.schemas.clone();
        for body in self.channels.values() {
            if let Some(Channel { topic, schema_id, .. }) = channel(body)
                && schema_id != 0
                && !self.schemas.contains_key(&schema_id)
            {
                losses.push(Loss { what: format!("the schema of {topic}"), why: "no record of it".into() });
            }
        }
    }

    /// How many records are metadata.
    pub fn n_metadata(&self) -> u64 {
        self.records.iter().filter(|(_, opcode)| *opcode == op::METADATA).count() as u64
    }

    /// Without a checksum nothing tells a private record from garbage.
    pub fn drop_private(&mut self, losses: &mut Vec<Loss>) {
        let private = self.records.iter().filter(|(_, opcode)| *opcode >= op::PRIVATE).count();
        self.records.retain(|(_, opcode)| *opcode < op::PRIVATE);
        if private > 0 {
            let why = "nothing but the checksum of all data says that they are some".into();
            losses.push(Loss { what: format!("{private} private records"), why });
        }
    }

    /// Writes all of it.
    pub fn copy<R: Read + Seek, W: Write>(
        &self,
        input: &mut R,
        writer: &mut Writer<W>,
    ) -> Result<(), EffError> {
        let channel_ids = self.copy_channels(writer)?;
        for place in &self.messages {
            let unpacked = content(input, *place)?;
            for InChunk { opcode, body, .. } in records_in(&unpacked).flatten() {
                if let Ok(Record::Message(message)) = record::parse(opcode, body)
                    && let Some(channel_id) = channel_ids.get(&message.channel_id)
                {
                    writer.foreign_message(*channel_id, &message)?;
                }
            }
        }
        for place in &self.records {
            let body = record_at(input, *place)?;
            match record::parse(place.1, &body) {
                Ok(Record::Metadata { name, metadata }) => writer.metadata(name, &metadata)?,
                _ => writer.private_record(place.1, &body)?,
            }
        }
        Ok(())
    }

    /// Declares the channels; gives the ids that they have in the new file.
    fn copy_channels<W: Write>(&self, writer: &mut Writer<W>) -> Result<BTreeMap<u16, u16>, EffError> {
        let mut ids = BTreeMap::new();
        for (id, body) in &self.channels {
            if let Some(channel) = channel(body) {
                let schema = self.schemas.get(&channel.schema_id).and_then(|body| schema(body));
                ids.insert(*id, writer.foreign_channel(&channel, schema.as_ref())?);
            }
        }
        Ok(ids)
    }
}

fn channel(body: &[u8]) -> Option<Channel<'_>> {
    match record::parse(op::CHANNEL, body) {
        Ok(Record::Channel(channel)) => Some(channel),
        _ => None,
    }
}

fn schema(body: &[u8]) -> Option<Schema<'_>> {
    match record::parse(op::SCHEMA, body) {
        Ok(Record::Schema(schema)) => Some(schema),
        _ => None,
    }
}
