//! What travels along: attachments, and what other programs put into a field file.

use super::{SHARED_CHUNK, Writer};
use crate::format::MAX_CHUNK;
use crate::record::{Channel, Message, Schema};
use crate::{Attachment, EffError};
use mcap::records::{MessageHeader, Metadata};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Write;

impl<W: Write> Writer<W> {
    /// Writes a file into the file.
    ///
    /// # Errors
    /// [`EffError`] if the stream fails or there is one of this name.
    pub fn attachment(&mut self, attachment: &Attachment) -> Result<(), EffError> {
        self.dated_attachment(attachment, [0, 0])
    }

    /// Writes a file into the file, with the times when it was logged and when it was made, ns.
    pub(crate) fn dated_attachment(
        &mut self,
        attachment: &Attachment,
        [log_time, create_time]: [u64; 2],
    ) -> Result<(), EffError> {
        if !self.attachment_names.insert(attachment.name.clone()) {
            let found = format!("{:?} again", attachment.name);
            return Err(EffError::bad("attachment.name", found, "each name once"));
        }
        self.close_chunk()?;
        self.mcap().attach(&mcap::Attachment {
            log_time,
            create_time,
            name: attachment.name.clone(),
            media_type: attachment.media_type.clone(),
            data: Cow::Borrowed(&attachment.bytes),
        })?;
        Ok(())
    }

    /// Declares a channel of another program; gives the id that it has here.
    pub(crate) fn foreign_channel(
        &mut self,
        channel: &Channel<'_>,
        schema: Option<&Schema<'_>>,
    ) -> Result<u16, EffError> {
        let mcap = self.mcap();
        let schema_id = match schema {
            Some(schema) => mcap.add_schema(schema.name, schema.encoding, schema.data)?,
            None => 0,
        };
        let metadata = owned(&channel.metadata);
        Ok(mcap.add_channel(schema_id, channel.topic, channel.message_encoding, &metadata)?)
    }

    /// Writes a message of another program as it was, on a channel that it has here.
    pub(crate) fn foreign_message(&mut self, channel_id: u16, message: &Message<'_>) -> Result<(), EffError> {
        let Message { sequence, log_time, publish_time, data, .. } = *message;
        self.put(&MessageHeader { channel_id, sequence, log_time, publish_time }, data)
    }

    /// Writes metadata of another program.
    pub(crate) fn metadata(&mut self, name: &str, metadata: &BTreeMap<&str, &str>) -> Result<(), EffError> {
        self.close_chunk()?;
        Ok(self.mcap().write_metadata(&Metadata { name: name.to_owned(), metadata: owned(metadata) })?)
    }

    /// Writes a record of another program's own kind.
    pub(crate) fn private_record(&mut self, opcode: u8, body: &[u8]) -> Result<(), EffError> {
        self.close_chunk()?;
        Ok(self.mcap().write_private_record(opcode, body, Default::default())?)
    }

    /// Writes a message, in a chunk of its own if the open one would become too long.
    pub(super) fn put(&mut self, header: &MessageHeader, payload: &[u8]) -> Result<(), EffError> {
        if self.n_open + payload.len() > SHARED_CHUNK {
            self.close_chunk()?;
        }
        if payload.len() as u64 + 1024 > MAX_CHUNK {
            let found = format!("a message of {} bytes", payload.len());
            return Err(EffError::bad(format!("channel {}", header.channel_id), found, "a smaller one"));
        }
        self.n_open += payload.len();
        Ok(self.mcap().write_to_known_channel(header, payload)?)
    }
}

fn owned(map: &BTreeMap<&str, &str>) -> BTreeMap<String, String> {
    map.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect()
}
