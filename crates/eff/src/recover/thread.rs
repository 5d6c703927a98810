//! From record to record through a file that may be damaged.

use super::Loss;
use crate::EffError;
use crate::reader::Index;
use crate::record::{MAGIC, op};
use crate::scan::source::{Next, Source};
use std::collections::BTreeSet;
use std::io::{Read, Seek, SeekFrom};

/// What a data end holds: a checksum, and nothing else.
const DATA_END_BYTES: usize = 4;

/// Where the records of the data section begin, and of what kind they are.
pub(super) struct Thread {
    /// Offset and opcode: those that were found and those that the summary names, whatever is there now.
    pub records: BTreeSet<(u64, u8)>,
    /// Whether the data section's checksum holds; of what is outside chunks there is no other.
    pub is_vouched_for: bool,
    /// What is beyond the last record.
    pub loss: Option<Loss>,
}

impl Thread {
    /// Finds the records of the data section one after the other.
    ///
    /// Where a record's length is damaged, or another one's opcode says that the data end, that thread is lost; if
    /// the file's end is whole, its indexes take it up again.
    pub fn follow<R: Read + Seek>(input: &mut R, index: Option<&Index>) -> Result<Self, EffError> {
        let length = input.seek(SeekFrom::End(0))?;
        let records = index.map(Index::records).unwrap_or_default();
        let mut thread = Self { records, is_vouched_for: false, loss: None };
        let mut next = Some(0);
        while let Some(start) = next {
            let Some(lost) = thread.stretch(input, start)? else { return Ok(thread) };
            next = thread.records.range((lost + 1, 0)..).next().map(|(offset, _)| *offset);
            // Who has the indexes knows what is missing.
            thread.loss = index.is_none().then(|| beyond(lost, length));
        }
        Ok(thread)
    }

    /// Takes records in, from a place on or from the file's start, up to the data's end; gives where there is none
    /// before that.
    fn stretch<R: Read + Seek>(&mut self, input: &mut R, start: u64) -> std::io::Result<Option<u64>> {
        input.seek(SeekFrom::Start(start))?;
        let mut source = Source::new(input);
        if start == 0 {
            source.fill(&mut [0; MAGIC.len()])?;
        }
        let mut body = Vec::new();
        loop {
            match source.next(&mut body)? {
                Next::Record { opcode: op::DATA_END, .. } if body.len() == DATA_END_BYTES => {
                    self.is_vouched_for = start == 0 && body == source.crc_before().to_le_bytes();
                    return Ok(None);
                }
                Next::Record { opcode: opcode @ (op::HEADER..op::DATA_END | op::PRIVATE..), offset } => {
                    self.records.insert((start + offset, opcode));
                }
                Next::Record { offset, .. } | Next::End { offset, .. } => return Ok(Some(start + offset)),
            }
        }
    }
}

/// What is lost where no record is whole from a place on.
fn beyond(offset: u64, length: u64) -> Loss {
    let lost = length.saturating_sub(offset);
    if lost > 0 {
        let what = format!("the last {lost} bytes of the file, from byte {offset}");
        Loss { what, why: "no whole record".into() }
    } else {
        let what = format!("what should follow byte {length}");
        Loss { what, why: "the file was cut between two records".into() }
    }
}
