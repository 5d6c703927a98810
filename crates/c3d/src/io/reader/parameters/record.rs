use crate::Processor;
use crate::parameter::{Group, Parameter, Value, trimmed_text};

/// A group or a parameter, and where it ends.
pub(super) struct Record {
    pub content: Content,
    /// Place of the pointer to the next record; the pointer counts from here.
    pub pointer_at: usize,
    /// The pointer as it stands there.
    pub pointer: [u8; 2],
    /// Where values end and the description starts.
    pub values_end: usize,
    /// Where all contents end.
    pub end: usize,
}

pub(super) enum Content {
    /// The name of the group with this id.
    Group(u8, Group),
    /// A parameter of the group with this id.
    Parameter(u8, Parameter),
}

impl Content {
    pub fn name(&self) -> &str {
        match self {
            Self::Group(_, group) => &group.name,
            Self::Parameter(_, parameter) => &parameter.name,
        }
    }
}

/// Reads the record at `at`; `None` where the section ends, marked by a name of no letters.
///
/// # Errors
/// What is wrong, if no record can be there.
pub(super) fn read(section: &[u8], at: usize, processor: Processor) -> Result<Option<Record>, &'static str> {
    let mut bytes = Bytes { section, at };
    let Some(length) = bytes.byte() else { return Err("the section ends without an end mark") };
    if length == 0 {
        return Ok(None);
    }
    let group_id = bytes.byte().ok_or(CUT)?.cast_signed();
    if group_id == 0 {
        return Err("a record with group number 0");
    }
    // A negative length says that the record is locked.
    let length = length.cast_signed();
    let name = bytes.take(usize::from(length.unsigned_abs())).ok_or(CUT)?;
    if !name.iter().all(|&b| is_in_name(b)) {
        return Err("a record whose name is no text");
    }
    let (name, locked) = (trimmed_text(name), length < 0);
    let pointer_at = bytes.at;
    let pointer = bytes.array().ok_or(CUT)?;
    let end = pointer_at + usize::from(processor.read_u16(pointer));
    let id = group_id.unsigned_abs();
    let values = if group_id < 0 { None } else { Some(read_value(&mut bytes, processor)?) };
    let values_end = bytes.at;
    let description = bytes.description(end);
    let content = match values {
        None => Content::Group(id, Group { name, description, locked, parameters: Vec::new() }),
        Some((dimensions, value)) => {
            Content::Parameter(id, Parameter { name, description, locked, dimensions, value })
        }
    };
    Ok(Some(Record { content, pointer_at, pointer, values_end, end: bytes.at }))
}

const CUT: &str = "a record that is cut off";

/// Names are ASCII by the rules; letters of Latin-1 occur. Control characters mean that this is no name.
fn is_in_name(b: u8) -> bool {
    matches!(b, 0x20..=0x7e | 0xa0..)
}

fn read_value(bytes: &mut Bytes<'_>, processor: Processor) -> Result<(Vec<u8>, Value), &'static str> {
    let kind = bytes.byte().ok_or(CUT)?.cast_signed();
    let n_dimensions = bytes.byte().ok_or(CUT)?;
    let dimensions = bytes.take(usize::from(n_dimensions)).ok_or(CUT)?.to_vec();
    // The product can overflow; what is there bounds it anyway.
    let n_values = dimensions.iter().fold(1_usize, |n, &d| n.saturating_mul(usize::from(d)));
    let mut values = |width: usize| bytes.take(n_values.saturating_mul(width)).ok_or(CUT);
    let value = match kind {
        -1 => Value::Text(values(1)?.to_vec()),
        1 => Value::Bytes(values(1)?.to_vec()),
        2 => Value::Integers(arrays(values(2)?).map(|b| processor.read_i16(b)).collect()),
        4 => Value::Floats(arrays(values(4)?).map(|b| processor.read_f32(b)).collect()),
        _ => return Err("a parameter of unknown type"),
    };
    Ok((dimensions, value))
}

fn arrays<const N: usize>(bytes: &[u8]) -> impl Iterator<Item = [u8; N]> + '_ {
    bytes.as_chunks().0.iter().copied()
}

/// A place in the section.
struct Bytes<'a> {
    section: &'a [u8],
    at: usize,
}

impl<'a> Bytes<'a> {
    fn take(&mut self, n: usize) -> Option<&'a [u8]> {
        let bytes = self.section.get(self.at..self.at.checked_add(n)?)?;
        self.at += n;
        Some(bytes)
    }

    fn byte(&mut self) -> Option<u8> {
        self.take(1).map(|b| b[0])
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    /// A length and as many letters; empty where it would run past the next record, for then it is not there.
    fn description(&mut self, next: usize) -> String {
        let start = self.at;
        let text = self.byte().and_then(|length| self.take(usize::from(length)));
        match text {
            Some(text) if self.at <= next || next <= start => trimmed_text(text),
            Some(_) => String::new(),
            None => {
                self.at = start;
                String::new()
            }
        }
    }
}
