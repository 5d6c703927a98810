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
/// Source: Motion Lab Systems, "The C3D File Format: A Technical User Guide", "Group Format" and "Parameter Format".
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
            Some(text) if self.at <= next || next < start => trimmed_text(text),
            Some(_) => String::new(),
            None => {
                self.at = start;
                String::new()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn content(section: &[u8]) -> Content {
        read(section, 0, Processor::Intel).unwrap().unwrap().content
    }

    #[test]
    fn a_group_and_where_it_ends() {
        // Name of 5 letters, group 1 by its negative, pointer over itself and 1 + 2 letters of description.
        let bytes = [&[5, 0xff][..], b"POINT", &[5, 0, 2], b"3D", &[99]].concat();
        let record = read(&bytes, 0, Processor::Intel).unwrap().unwrap();
        assert_eq!((record.pointer_at, record.pointer, record.end), (7, [5, 0], 12));
        let Content::Group(1, group) = record.content else { panic!("a group") };
        assert_eq!((group.name.as_str(), group.description.as_str(), group.locked), ("POINT", "3D", false));
    }

    #[test]
    fn a_locked_table_of_integers() {
        // Length -4, group 2, a table of 2 by 1 integers: 7 and -1.
        let bytes = [&[0xfc, 2][..], b"USED", &[11, 0, 2, 2, 2, 1, 7, 0, 0xff, 0xff, 0]].concat();
        let Content::Parameter(2, parameter) = content(&bytes) else { panic!("a parameter") };
        assert!(parameter.locked);
        assert_eq!((parameter.dimensions, parameter.value), (vec![2, 1], Value::Integers(vec![7, -1])));
    }

    #[test]
    fn a_missing_length_of_description() {
        // The pointer ends with the value; the next record's name is 9 letters long, which is no description.
        let bytes = [&[1, 1][..], b"X", &[5, 0, 1, 0, 42, 9, 1], b"NEXT NAME"].concat();
        let record = read(&bytes, 0, Processor::Intel).unwrap().unwrap();
        let Content::Parameter(1, parameter) = record.content else { panic!("a parameter") };
        assert_eq!((parameter.value, parameter.description.as_str()), (Value::Bytes(vec![42]), ""));
        assert_eq!(record.values_end, 8);
    }

    #[test]
    fn what_is_no_record() {
        let error = |bytes: &[u8]| read(bytes, 0, Processor::Intel).err();
        assert!(matches!(read(&[0, 1, 2], 0, Processor::Intel), Ok(None)));
        assert_eq!(error(&[]), Some("the section ends without an end mark"));
        assert_eq!(error(&[1, 0, b'X', 0, 0]), Some("a record with group number 0"));
        assert_eq!(error(&[1, 1, 7, 0, 0]), Some("a record whose name is no text"));
        assert_eq!(error(&[1, 1, b'X', 5, 0, 3, 0, 42]), Some("a parameter of unknown type"));
        assert_eq!(error(&[1, 1, b'X', 5, 0, 4, 1, 1, 0, 0, 0]), Some(CUT));
        // A product of dimensions beyond any number asks for no memory.
        let huge = [&[1, 1, b'X', 5, 0, 4, 200][..], &[255; 200]].concat();
        assert_eq!(error(&huge), Some(CUT));
    }
}
