use super::data::Data;
use super::facts::{AttachmentFacts, ChunkFacts};
use super::{Findings, at};
use crate::Code;
use crate::finding::Place;
use crate::record::{self, PREFIX, Record, Statistics, op};
use std::collections::BTreeMap;

/// The summary section: what a file says about itself, so that a reader need not read all of it.
pub(crate) struct Summary {
    start: u64,
    pub schemas: BTreeMap<u16, Vec<u8>>,
    pub channels: BTreeMap<u16, Vec<u8>>,
    pub statistics: Option<Statistics>,
    pub chunks: Vec<ChunkFacts>,
    pub attachments: Vec<AttachmentFacts>,
    n_metadata: u32,
    /// Opcode, start and length of each run of records of one kind.
    groups: Vec<(u8, u64, u64)>,
    /// The same, as the summary offset records say it.
    offsets: Vec<(u8, u64, u64)>,
    offsets_start: Option<u64>,
}

impl Summary {
    pub fn new(start: u64) -> Self {
        Self {
            start,
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            statistics: None,
            chunks: Vec::new(),
            attachments: Vec::new(),
            n_metadata: 0,
            groups: Vec::new(),
            offsets: Vec::new(),
            offsets_start: None,
        }
    }

    /// Takes one record in.
    pub fn record(
        &mut self,
        record: &Record<'_>,
        opcode: u8,
        body: &[u8],
        offset: u64,
        findings: &mut Findings,
    ) {
        if let Record::SummaryOffset { group_opcode, group_start, group_length } = record {
            self.offsets_start.get_or_insert(offset);
            // Some writers say of each kind that may be there where it is, of those that are not there too.
            if *group_length > 0 {
                self.offsets.push((*group_opcode, *group_start, *group_length));
            }
            return;
        }
        self.extend_group(opcode, offset, PREFIX + body.len() as u64);
        match record {
            Record::Schema(schema) => drop(self.schemas.insert(schema.id, body.to_vec())),
            Record::Channel(channel) => drop(self.channels.insert(channel.id, body.to_vec())),
            Record::Statistics(statistics) => self.statistics = Some(statistics.clone()),
            Record::ChunkIndex(index) => self.chunks.push(index.into()),
            Record::AttachmentIndex(index) => self.attachments.push(index.into()),
            Record::MetadataIndex { .. } => self.n_metadata += 1,
            Record::Private => {}
            _ => {
                let expected = "a record of the summary section";
                findings.push(at(offset).finding(
                    Code::RecordOrder,
                    "record",
                    record::name(opcode),
                    expected,
                ));
            }
        }
    }

    fn extend_group(&mut self, opcode: u8, offset: u64, length: u64) {
        match self.groups.last_mut() {
            Some(group) if group.0 == opcode => group.2 += length,
            _ => self.groups.push((opcode, offset, length)),
        }
    }

    /// The footer was read: compares what the summary says with what the data are.
    pub fn end(
        self,
        data: &Data<'_>,
        start: u64,
        offsets_start: u64,
        place: Place<'_>,
        findings: &mut Findings,
    ) {
        let mut compare = |what: &str, is_same: bool, found: String, expected: String| {
            if !is_same {
                findings.push(place.finding(Code::Summary, what, found, expected));
            }
        };
        let n = |n: usize, what: &str| format!("{n} {what}");
        compare("footer.summary_start", start == self.start, start.to_string(), self.start.to_string());
        let expected_offsets = self.offsets_start.unwrap_or(0);
        compare(
            "footer.summary_offset_start",
            offsets_start == expected_offsets,
            offsets_start.to_string(),
            expected_offsets.to_string(),
        );
        compare(
            "schemas",
            self.schemas == data.schemas,
            n(self.schemas.len(), "schemas, or others"),
            n(data.schemas.len(), "schemas, those of the data"),
        );
        compare(
            "channels",
            self.channels == data.channels,
            n(self.channels.len(), "channels, or others"),
            n(data.channels.len(), "channels, those of the data"),
        );
        compare(
            "statistics",
            self.statistics.as_ref() == Some(&data.statistics),
            self.statistics.as_ref().map_or_else(|| "none".into(), |s| format!("{s:?}")),
            format!("{:?}", data.statistics),
        );
        compare_list("chunk indexes", &self.chunks, &data.chunks, &mut compare);
        compare_list("attachment indexes", &self.attachments, &data.attachments, &mut compare);
        compare(
            "metadata indexes",
            self.n_metadata == data.statistics.metadata_count,
            self.n_metadata.to_string(),
            data.statistics.metadata_count.to_string(),
        );
        let is_mcap = |group: &&(u8, u64, u64)| group.0 < op::PRIVATE;
        let groups: Vec<_> = self.groups.iter().filter(is_mcap).copied().collect();
        compare_list("summary offsets", &self.offsets, &groups, &mut compare);
    }
}

/// Names the first entry that differs.
fn compare_list<T: PartialEq + std::fmt::Debug>(
    what: &str,
    found: &[T],
    expected: &[T],
    compare: &mut impl FnMut(&str, bool, String, String),
) {
    let n = found.len();
    compare(what, n == expected.len(), format!("{n} records"), format!("{}", expected.len()));
    if let Some(k) = found.iter().zip(expected).position(|(a, b)| a != b) {
        compare(&format!("{what}[{k}]"), false, format!("{:?}", found[k]), format!("{:?}", expected[k]));
    }
}
