//! Every byte of a file, once, in order: what is wrong is reported, what is right is handed on.
//!
//! [`validate`](crate::validate), [`read`](crate::read) and [`inspect`](crate::inspect) are this scan with
//! different listeners, so what one accepts none of the others refuses.

pub(crate) mod chunk;
mod content;
pub(crate) mod data;
pub(crate) mod facts;
mod findings;
pub(crate) mod source;
pub(crate) mod summary;

use crate::finding::Place;
use crate::manifest::Manifest;
use crate::record::{self, MAGIC, Record, Short};
use crate::{Attachment, Code, EffError, Finding};
use data::Data;
pub(crate) use findings::Findings;
use source::{Next, Source};
use std::io::Read;
use summary::Summary;
use tousle_core::{Pose, WindSample};
use tousle_field::{Field, FieldLayer};

/// Someone who takes what a scan finds sound. Steps, poses, samples and edits come after the manifest.
pub(crate) trait Listener {
    /// The manifest; comes once, before anything else.
    fn manifest(&mut self, _manifest: &Manifest) -> Result<(), EffError> {
        Ok(())
    }
    /// A message came, with a payload of this many bytes, sound or not.
    fn message(&mut self, _topic: &'static str, _n_bytes: usize) {}
    /// All edits.
    fn edits(&mut self, _layers: Vec<FieldLayer>) {}
    /// The next pose.
    fn pose(&mut self, _pose: Pose) {}
    /// The samples of the next step.
    fn samples(&mut self, _samples: Vec<WindSample>) {}
    /// The next step of the field.
    fn step(&mut self, _step: Field) -> Result<(), EffError> {
        Ok(())
    }
    /// The next attachment.
    fn attachment(&mut self, _attachment: Attachment) {}
}

/// Scans a file to its end, or until `findings` are enough.
pub(crate) fn scan<R: Read>(
    input: R,
    listener: &mut dyn Listener,
    findings: &mut Findings,
) -> Result<(), EffError> {
    let mut source = Source::new(input);
    let mut data = Data::new(listener);
    if magic(&mut source, findings)?
        && data_section(&mut source, &mut data, findings)?
        && summary_section(&mut source, &data, findings)?
    {
        end(&mut source, findings)?;
    }
    Ok(())
}

/// Whether the file begins as it should.
pub(crate) fn magic<R: Read>(source: &mut Source<R>, findings: &mut Findings) -> Result<bool, EffError> {
    let mut first = [0; 8];
    let n = source.fill(&mut first)?;
    if first == MAGIC {
        return Ok(true);
    }
    let place = at(0);
    let expected = "the magic of MCAP version 0";
    findings.push(if n < first.len() && MAGIC.starts_with(&first[..n]) {
        place.finding(Code::Cut, "file", format!("{n} bytes"), expected)
    } else {
        place.finding(Code::Magic, "first 8 bytes", first[..n].escape_ascii(), expected)
    });
    Ok(false)
}

/// Reads records up to the end of the data section; `false` if there is none or enough was found.
fn data_section<R: Read>(
    source: &mut Source<R>,
    data: &mut Data<'_>,
    findings: &mut Findings,
) -> Result<bool, EffError> {
    let mut body = Vec::new();
    while !findings.is_enough() {
        let (opcode, offset) = match source.next(&mut body)? {
            Next::Record { opcode, offset } => (opcode, offset),
            Next::End { offset, found } => {
                findings.push(at(offset).finding(Code::Cut, "record", found, "records up to a data end"));
                return Ok(false);
            }
        };
        match record::parse(opcode, &body) {
            Ok(Record::DataEnd { data_section_crc }) => {
                check_crc(Code::DataCrc, data_section_crc, source.crc_before(), at(offset), findings);
                data.end(at(offset), findings);
                return Ok(!findings.is_enough());
            }
            Ok(record) => data.record(record, opcode, &body, offset, findings)?,
            Err(short) => {
                findings.push(broken(at(offset), opcode, &body, short));
                if opcode == record::op::CHUNK {
                    data.lose_chunk(at(offset), findings);
                }
            }
        }
    }
    Ok(false)
}

/// Reads records up to the footer; `false` if there is none or enough was found.
fn summary_section<R: Read>(
    source: &mut Source<R>,
    data: &Data<'_>,
    findings: &mut Findings,
) -> Result<bool, EffError> {
    source.restart_crc();
    let mut summary = Summary::new(source.offset());
    let mut body = Vec::new();
    while !findings.is_enough() {
        let (opcode, offset) = match source.next(&mut body)? {
            Next::Record { opcode, offset } => (opcode, offset),
            Next::End { offset, found } => {
                findings.push(at(offset).finding(Code::Cut, "record", found, "records up to a footer"));
                return Ok(false);
            }
        };
        match record::parse(opcode, &body) {
            Ok(Record::Footer { summary_start, summary_offset_start, summary_crc }) => {
                let computed = source.crc_through(opcode, &body, body.len() - 4);
                check_crc(Code::SummaryCrc, summary_crc, computed, at(offset), findings);
                summary.end(data, summary_start, summary_offset_start, at(offset), findings);
                return Ok(!findings.is_enough());
            }
            Ok(record) => summary.record(&record, opcode, &body, offset, findings),
            Err(short) => findings.push(broken(at(offset), opcode, &body, short)),
        }
    }
    Ok(false)
}

/// Checks that the file ends as it should.
fn end<R: Read>(source: &mut Source<R>, findings: &mut Findings) -> Result<(), EffError> {
    let offset = source.offset();
    let mut last = [0; 8];
    let n = source.fill(&mut last)?;
    let expected = "the magic of MCAP version 0";
    if n < last.len() {
        findings.push(at(offset).finding(Code::Cut, "last 8 bytes", format!("{n} bytes"), expected));
    } else if last != MAGIC {
        findings.push(at(offset).finding(Code::Magic, "last 8 bytes", last.escape_ascii(), expected));
    } else if source.fill(&mut [0])? > 0 {
        findings.push(at(offset + 8).finding(Code::Trailing, "file", "more bytes", "the end of the file"));
    }
    Ok(())
}

/// A place in the file and in no channel.
pub(crate) fn at(offset: u64) -> Place<'static> {
    Place { offset: Some(offset), ..Place::default() }
}

/// A checksum of 0 means "not computed" to MCAP; a field file always has them.
pub(crate) fn check_crc(code: Code, found: u32, computed: u32, place: Place<'_>, findings: &mut Findings) {
    if found != computed {
        let found = if found == 0 { "none".to_owned() } else { format!("{found:08x}") };
        findings.push(place.finding(code, "crc", found, format!("{computed:08x}")));
    }
}

/// A record that its content does not fit.
pub(crate) fn broken(place: Place<'_>, opcode: u8, body: &[u8], short: Short) -> Box<Finding> {
    let what = format!("{}.{}", record::name(opcode), short.field);
    place.finding(Code::Record, what, format!("a record of {} bytes", body.len()), short.expected)
}
