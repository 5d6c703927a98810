use serde::Serialize;
use std::fmt;

/// Something wrong with a file: where, what was found, what was expected.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// What kind of wrong; `docs/eff.md` explains each.
    pub code: Code,
    /// Whether the file can be trusted all the same.
    pub severity: Severity,
    /// The channel, if it is in one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<String>,
    /// The message's time, ns, if it is in a message.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_ns: Option<u64>,
    /// Where the record (or the chunk around it) begins in the file, bytes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub offset: Option<u64>,
    /// What it is about: a record's field, a path into a message.
    pub what: String,
    /// What is there.
    pub found: String,
    /// What should be there.
    pub expected: String,
}

/// How bad a [`Finding`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Odd, but every number in the file means what it says.
    Warning,
    /// The file is not sound; a reader refuses it.
    Error,
}

/// Where a finding is, gathered on the way to it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Place<'a> {
    pub channel: Option<&'a str>,
    pub time_ns: Option<u64>,
    pub offset: Option<u64>,
}

impl Place<'_> {
    /// An error here.
    pub fn finding(
        self,
        code: Code,
        what: impl Into<String>,
        found: impl fmt::Display,
        expected: impl fmt::Display,
    ) -> Box<Finding> {
        Box::new(Finding {
            code,
            severity: code.severity(),
            channel: self.channel.map(str::to_owned),
            time_ns: self.time_ns,
            offset: self.offset,
            what: what.into(),
            found: found.to_string(),
            expected: expected.to_string(),
        })
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.code)?;
        if let Some(channel) = &self.channel {
            write!(f, "{channel}, ")?;
        }
        if let Some(time_ns) = self.time_ns {
            write!(f, "time {time_ns} ns, ")?;
        }
        if let Some(offset) = self.offset {
            write!(f, "byte {offset}, ")?;
        }
        write!(f, "{}: found {}, expected {}", self.what, self.found, self.expected)
    }
}

macro_rules! codes {
    ($($(#[doc = $doc:literal])+ $name:ident = $text:literal, $severity:ident;)+) => {
        /// What kind of [`Finding`].
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[non_exhaustive]
        pub enum Code { $($(#[doc = $doc])+ $name,)+ }

        impl Code {
            /// Every code there is.
            pub const ALL: &[Self] = &[$(Self::$name,)+];

            /// The code's name in reports and in `docs/eff.md`.
            pub fn name(self) -> &'static str {
                match self { $(Self::$name => $text,)+ }
            }

            /// How bad a finding of this kind is.
            #[allow(clippy::match_same_arms)]
            pub fn severity(self) -> Severity {
                match self { $(Self::$name => Severity::$severity,)+ }
            }
        }
    };
}

codes! {
    /// The file does not begin as an MCAP file does.
    Magic = "magic", Error;
    /// The header's profile is another's.
    Profile = "profile", Error;
    /// The file ends too early: it was cut, or its writer was.
    Cut = "cut", Error;
    /// Something follows the end.
    Trailing = "trailing", Error;
    /// A record's content does not fit its length or its kind.
    Record = "record", Error;
    /// A record is where none of its kind may be.
    RecordOrder = "record-order", Error;
    /// The checksum of the data section does not hold, or there is none.
    DataCrc = "data-crc", Error;
    /// The checksum of the summary section does not hold, or there is none.
    SummaryCrc = "summary-crc", Error;
    /// A chunk's checksum does not hold, or there is none.
    ChunkCrc = "chunk-crc", Error;
    /// An attachment's checksum does not hold, or there is none.
    AttachmentCrc = "attachment-crc", Error;
    /// A chunk cannot be unpacked, or not to the size it states.
    Compression = "compression", Error;
    /// A chunk states other times than its messages have.
    ChunkTimes = "chunk-times", Error;
    /// A message index points elsewhere than at its messages.
    MessageIndex = "message-index", Error;
    /// The summary says otherwise than the data.
    Summary = "summary", Error;
    /// A schema is not the one that version 1 has.
    Schema = "schema", Error;
    /// A schema has the right name and another text; its messages are checked all the same.
    SchemaText = "schema-text", Warning;
    /// A channel is not as version 1 has it, or a topic under `/eff/` is unknown.
    Channel = "channel", Error;
    /// Messages are out of order: their times, their sequence numbers or their indexes.
    Order = "order", Error;
    /// A message of the wrong kind comes first, twice, or not at all.
    Missing = "missing", Error;
    /// The manifest's version is newer than this reader, or not its schema's.
    Version = "version", Error;
    /// The manifest asks for a feature that this reader does not know.
    Requires = "requires", Error;
    /// A JSON payload is no JSON.
    Json = "json", Error;
    /// A JSON payload does not satisfy its schema.
    JsonSchema = "json-schema", Error;
    /// A protobuf payload cannot be decoded.
    Protobuf = "protobuf", Error;
    /// A protobuf payload has fields that version 1 does not have.
    UnknownField = "unknown-field", Error;
    /// A value is outside what it can be.
    Value = "value", Error;
    /// A number is NaN or infinite.
    NotFinite = "not-finite", Error;
    /// An array does not fit the grid, or its packing.
    Size = "size", Error;
    /// An array's encoding is unknown, not the manifest's, or breaks its error bound.
    Encoding = "encoding", Error;
    /// A voxel's flag means nothing.
    Flag = "flag", Error;
    /// A message's time is not its step's time.
    Time = "time", Error;
    /// There are more or fewer messages than the manifest states.
    Count = "count", Error;
    /// A rotation is no unit quaternion.
    Rotation = "rotation", Error;
    /// A covariance is no covariance.
    Covariance = "covariance", Error;
    /// Two layers share an id.
    DuplicateId = "duplicate-id", Error;
    /// A marker was in a voxel that is not flagged as measured.
    FlagSamples = "flag-samples", Warning;
    /// A preview is not what viewers expect, or does not belong to the field.
    Preview = "preview", Warning;
    /// Something that readers skip: a topic outside `/eff/`, a record of another application.
    Skipped = "skipped", Warning;
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Serialize for Code {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table in the specification names every code, with its severity, and no other.
    #[test]
    fn every_code_is_explained() {
        let spec = include_str!("../../../docs/eff.md");
        let table = spec.split("## Findings").nth(1).unwrap();
        let rows: Vec<_> = table.lines().filter(|line| line.starts_with("| `")).collect();
        assert_eq!(rows.len(), Code::ALL.len());
        for (row, code) in rows.into_iter().zip(Code::ALL) {
            let severity = if code.severity() == Severity::Error { "error" } else { "warning" };
            assert!(row.starts_with(&format!("| `{code}` | {severity} | ")), "{code}: {row}");
        }
    }
}
