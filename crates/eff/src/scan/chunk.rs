use super::{Findings, check_crc, data::Data};
use crate::finding::Place;
use crate::format::MAX_CHUNK;
use crate::record::{self, Chunk, PREFIX, Record};
use crate::{Code, EffError, Finding};
use std::cell::RefCell;
use std::collections::BTreeMap;
use zstd::bulk::Decompressor;

/// Where each channel's messages are: log time and offset within the unpacked chunk.
pub(crate) type Indexes = BTreeMap<u16, Vec<(u64, u64)>>;

/// Scans the records in a chunk; gives what its message indexes must say, or `None` if it cannot be read.
pub(super) fn scan(
    data: &mut Data<'_>,
    chunk: &Chunk<'_>,
    place: Place<'_>,
    findings: &mut Findings,
) -> Result<Option<Indexes>, EffError> {
    let n_before = findings.n_errors();
    let unpacked = match unpack(chunk, place) {
        Ok(unpacked) => {
            check_crc(Code::ChunkCrc, chunk.uncompressed_crc, crc32fast::hash(&unpacked), place, findings);
            unpacked
        }
        Err(finding) => {
            findings.push(finding);
            Vec::new()
        }
    };
    if findings.n_errors() > n_before {
        // What is in it is noise; findings about it would hide the one that matters.
        return Ok(None);
    }
    let mut indexes = Indexes::new();
    for record in records_in(&unpacked) {
        if findings.is_enough() {
            break;
        }
        let Ok(InChunk { offset, opcode, body }) = record else {
            findings.push(place.finding(Code::Record, "record in chunk", "a part", "a whole record"));
            break;
        };
        match record::parse(opcode, body) {
            Ok(Record::Schema(schema)) => data.schema(schema, body, place, findings),
            Ok(Record::Channel(channel)) => data.channel(&channel, body, place, findings),
            Ok(Record::Message(message)) => {
                indexes.entry(message.channel_id).or_default().push((message.log_time, offset));
                data.message(message, place, findings)?;
            }
            Ok(_) => {
                let expected = "a schema, a channel or a message";
                findings.push(place.finding(
                    Code::RecordOrder,
                    "record in chunk",
                    record::name(opcode),
                    expected,
                ));
            }
            Err(short) => findings.push(super::broken(place, opcode, body, short)),
        }
    }
    check_times(chunk, &indexes, place, findings);
    Ok(Some(indexes))
}

/// A record in an unpacked chunk.
pub(crate) struct InChunk<'a> {
    /// Where it begins in the unpacked chunk.
    pub offset: u64,
    pub opcode: u8,
    pub body: &'a [u8],
}

/// The records in an unpacked chunk; an error if the last is not whole.
pub(crate) fn records_in(unpacked: &[u8]) -> impl Iterator<Item = Result<InChunk<'_>, ()>> {
    let mut left = unpacked;
    std::iter::from_fn(move || {
        if left.is_empty() {
            return None;
        }
        let offset = (unpacked.len() - left.len()) as u64;
        let record = take_record(&mut left).map(|(opcode, body)| InChunk { offset, opcode, body });
        if record.is_none() {
            left = &[];
        }
        Some(record.ok_or(()))
    })
}

/// Takes a record off the bytes.
fn take_record<'a>(bytes: &mut &'a [u8]) -> Option<(u8, &'a [u8])> {
    let (prefix, rest) = bytes.split_first_chunk::<{ PREFIX as usize }>()?;
    let [opcode, length @ ..] = *prefix;
    let length = usize::try_from(u64::from_le_bytes(length)).ok()?;
    let (body, rest) = rest.split_at_checked(length)?;
    *bytes = rest;
    Some((opcode, body))
}

/// The records of a chunk, unpacked.
pub(crate) fn unpack(chunk: &Chunk<'_>, place: Place<'_>) -> Result<Vec<u8>, Box<Finding>> {
    let size = chunk.uncompressed_size;
    if size > MAX_CHUNK {
        return Err(place.finding(
            Code::Compression,
            "chunk.uncompressed_size",
            size,
            format!("at most {MAX_CHUNK}"),
        ));
    }
    let mut records = Vec::new();
    match chunk.compression {
        "" => records.extend_from_slice(chunk.data),
        "zstd" => {
            let unpacked = unpack_zstd(chunk.data, size as usize, &mut records);
            if let Err(error) = unpacked {
                let expected = format!("a zstd frame of {size} bytes");
                return Err(place.finding(Code::Compression, "chunk.records", error, expected));
            }
        }
        other => {
            let expected = "\"zstd\" or \"\"";
            return Err(place.finding(
                Code::Compression,
                "chunk.compression",
                format!("{other:?}"),
                expected,
            ));
        }
    }
    if records.len() as u64 != size {
        let found = format!("{} bytes", records.len());
        return Err(place.finding(Code::Compression, "chunk.records", found, size));
    }
    Ok(records)
}

thread_local! {
    /// What unpacking needs; making it anew for each chunk would take a tenth of the time.
    static ZSTD: RefCell<std::io::Result<Decompressor<'static>>> = RefCell::new(Decompressor::new());
}

/// Unpacks zstd frames that hold up to `size` bytes, at once rather than as a stream, which copies all once more.
fn unpack_zstd(frames: &[u8], size: usize, records: &mut Vec<u8>) -> std::io::Result<()> {
    // A small chunk may say that it is large. Where memory is short that is an error; where it is not, what nothing is
    // written to costs nothing.
    records.try_reserve_exact(size)?;
    ZSTD.with_borrow_mut(|zstd| match zstd {
        Ok(zstd) => zstd.decompress_to_buffer(frames, records).map(|_| ()),
        Err(error) => Err(std::io::Error::new(error.kind(), error.to_string())),
    })
}

fn check_times(chunk: &Chunk<'_>, indexes: &Indexes, place: Place<'_>, findings: &mut Findings) {
    let times = || indexes.values().flatten().map(|(time, _)| *time);
    let expected = (times().min().unwrap_or(0), times().max().unwrap_or(0));
    if (chunk.start_time, chunk.end_time) != expected {
        let found = format!("{} to {} ns", chunk.start_time, chunk.end_time);
        let expected = format!("{} to {} ns", expected.0, expected.1);
        findings.push(place.finding(Code::ChunkTimes, "chunk times", found, expected));
    }
}
