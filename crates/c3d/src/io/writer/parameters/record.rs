use crate::{Group, Parameter, Processor, Value, WriteError};

/// Appends the record that names a group.
pub(super) fn push_group(
    bytes: &mut Vec<u8>,
    group_id: i8,
    group: &Group,
    processor: Processor,
) -> Result<(), WriteError> {
    push(
        bytes,
        Head { name: &group.name, locked: group.locked, id: -group_id },
        &[],
        &group.description,
        processor,
    )
}

/// Appends the record of a parameter.
pub(super) fn push_parameter(
    bytes: &mut Vec<u8>,
    group_id: i8,
    group: &Group,
    parameter: &Parameter,
    processor: Processor,
) -> Result<(), WriteError> {
    let name = || format!("{}:{}", group.name, parameter.name);
    let expected = parameter.dimensions.iter().fold(1_usize, |n, &d| n.saturating_mul(usize::from(d)));
    let (kind, found, values) = coded(&parameter.value, processor);
    if found != expected {
        return Err(WriteError::Shape { name: name(), found, expected });
    }
    if let Value::Floats(floats) = &parameter.value
        && let Some(&value) = floats.iter().find(|f| !f.is_nan() && !processor.holds(**f))
    {
        return Err(WriteError::Number { name: name(), value });
    }
    let n_dimensions = u8::try_from(parameter.dimensions.len()).map_err(|_| WriteError::TooLarge {
        what: "the dimensions of a parameter",
        found: parameter.dimensions.len() as u64,
        limit: 255,
    })?;
    let mut body = vec![kind.cast_unsigned(), n_dimensions];
    body.extend(&parameter.dimensions);
    body.extend(values);
    let head = Head { name: &parameter.name, locked: parameter.locked, id: group_id };
    push(bytes, head, &body, &parameter.description, processor)
}

/// Latin-1 letters of a text.
///
/// # Errors
/// If a letter is not in Latin-1.
pub(super) fn latin1(text: &str) -> Result<Vec<u8>, WriteError> {
    let letters: Result<_, _> = text.chars().map(u8::try_from).collect();
    letters.map_err(|_| WriteError::Text { text: text.into(), reason: "it has letters outside Latin-1" })
}

/// How a record starts.
#[derive(Clone, Copy)]
struct Head<'a> {
    name: &'a str,
    locked: bool,
    /// Negative for a group.
    id: i8,
}

fn push(
    bytes: &mut Vec<u8>,
    head: Head<'_>,
    body: &[u8],
    description: &str,
    processor: Processor,
) -> Result<(), WriteError> {
    let name = latin1(head.name)?;
    let is_name =
        name.iter().all(|b| matches!(b, 0x20..=0x7e | 0xa0..)) && !name.is_empty() && name.len() <= 127;
    if !is_name {
        let reason = "a name has 1 to 127 letters, none of control";
        return Err(WriteError::Text { text: head.name.into(), reason });
    }
    let description = latin1(description)?;
    let n_letters = u8::try_from(description.len()).map_err(|_| WriteError::TooLarge {
        what: "a description",
        found: description.len() as u64,
        limit: 255,
    })?;
    // The pointer counts from its own place to the record's end.
    let length = 2 + body.len() + 1 + description.len();
    let pointer = u16::try_from(length).map_err(|_| WriteError::TooLarge {
        what: "a parameter",
        found: length as u64,
        limit: 0xffff,
    })?;
    let name_length = name.len() as i8;
    bytes.push(if head.locked { -name_length } else { name_length }.cast_unsigned());
    bytes.push(head.id.cast_unsigned());
    bytes.extend(name);
    bytes.extend(processor.write_u16(pointer));
    bytes.extend(body);
    bytes.push(n_letters);
    bytes.extend(description);
    Ok(())
}

/// Type number, count and bytes of values.
fn coded(value: &Value, processor: Processor) -> (i8, usize, Vec<u8>) {
    match value {
        Value::Text(letters) => (-1, letters.len(), letters.clone()),
        Value::Bytes(bytes) => (1, bytes.len(), bytes.clone()),
        Value::Integers(integers) => {
            let words = integers.iter().flat_map(|i| processor.write_u16(i.cast_unsigned()));
            (2, integers.len(), words.collect())
        }
        Value::Floats(floats) => {
            (4, floats.len(), floats.iter().flat_map(|&f| processor.write_f32(f)).collect())
        }
    }
}
