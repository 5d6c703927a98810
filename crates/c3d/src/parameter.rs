mod group;

pub use group::Group;
use std::collections::BTreeMap;

/// The parameter section: what a system knows of a trial, by group and name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parameters {
    /// In the order of the file. Parameters whose group is never named stand in a group without a name.
    pub groups: Vec<Group>,
}

/// One named value, or table of values.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Upper case by custom; compared without case.
    pub name: String,
    /// What it is, for people.
    pub description: String,
    /// Whether programs should leave it alone.
    pub locked: bool,
    /// Length along each dimension, the fastest first; empty for a single value.
    pub dimensions: Vec<u8>,
    /// The values, as many as the dimensions say.
    pub value: Value,
}

/// The values of a [`Parameter`], the first dimension running fastest.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Characters, one byte each (Latin-1).
    Text(Vec<u8>),
    /// Bytes.
    Bytes(Vec<u8>),
    /// 16-bit integers. Counts among them are unsigned.
    Integers(Vec<i16>),
    /// 32-bit floats.
    Floats(Vec<f32>),
}

impl Parameters {
    /// The first parameter of this name in a group of this name, case aside.
    pub fn get(&self, group: &str, name: &str) -> Option<&Parameter> {
        self.groups.iter().filter(|g| g.name.eq_ignore_ascii_case(group)).find_map(|g| g.get(name))
    }

    /// The first value of a parameter, as a number.
    pub fn number(&self, group: &str, name: &str) -> Option<f64> {
        self.get(group, name)?.number(0)
    }

    /// The first value of a parameter as a count: integers are unsigned, floats are taken if whole.
    pub fn count(&self, group: &str, name: &str) -> Option<u64> {
        self.get(group, name)?.count()
    }

    /// The texts of a parameter, without blanks and NULs around them; empty if there is none.
    pub fn texts(&self, group: &str, name: &str) -> Vec<String> {
        self.get(group, name).map(Parameter::texts).unwrap_or_default()
    }

    /// The texts of `NAME`, `NAME2`, `NAME3`… after one another: an array ends at 255 entries, and systems with
    /// more go on in the next. 65,535 at most, for the format counts in 16 bits.
    pub fn long_texts(&self, group: &str, name: &str) -> Vec<String> {
        let in_group = self.groups.iter().filter(|g| g.name.eq_ignore_ascii_case(group));
        let mut parts = BTreeMap::new();
        for parameter in in_group.flat_map(|g| &g.parameters) {
            if let Some(part) = part_of(&parameter.name, name) {
                parts.entry(part).or_insert(parameter);
            }
        }
        let in_a_row = (1..).zip(parts).take_while(|(part, (number, _))| part == number);
        in_a_row.flat_map(|(_, (_, parameter))| parameter.texts()).take(0xffff).collect()
    }
}

/// Which part of `NAME`, `NAME2`, `NAME3`… a parameter is.
fn part_of(parameter: &str, name: &str) -> Option<u32> {
    let (stem, part) = parameter.split_at_checked(name.len())?;
    match part {
        _ if !stem.eq_ignore_ascii_case(name) => None,
        "" => Some(1),
        _ if part.starts_with(|c: char| c.is_ascii_digit()) => part.parse().ok().filter(|&n| n > 1),
        _ => None,
    }
}

impl Parameter {
    /// The texts of a character parameter, without blanks and NULs around them, Latin-1 read into UTF-8.
    ///
    /// The first dimension is the length of each; without dimensions or with one it is a single text.
    pub fn texts(&self) -> Vec<String> {
        let Value::Text(bytes) = &self.value else { return Vec::new() };
        let length = match self.dimensions.as_slice() {
            [] | [_] => bytes.len(),
            [length, ..] => usize::from(*length),
        };
        if length == 0 { Vec::new() } else { bytes.chunks(length).map(trimmed_text).collect() }
    }

    /// One value as a number; `None` for text or past the end.
    pub fn number(&self, idx: usize) -> Option<f64> {
        match &self.value {
            Value::Text(_) => None,
            Value::Bytes(bytes) => bytes.get(idx).map(|&b| f64::from(b)),
            Value::Integers(integers) => integers.get(idx).map(|&i| f64::from(i)),
            Value::Floats(floats) => floats.get(idx).map(|&f| f64::from(f)),
        }
    }

    /// The first value as a count: integers are unsigned, floats are taken if whole and not negative.
    pub fn count(&self) -> Option<u64> {
        match &self.value {
            Value::Integers(integers) => integers.first().map(|&i| u64::from(i.cast_unsigned())),
            _ => {
                let number = self.number(0)?;
                (number >= 0.0 && number.fract() == 0.0 && number < 1e15).then_some(number as u64)
            }
        }
    }
}

/// Latin-1 to UTF-8, without blanks and NULs around it.
pub(crate) fn trimmed_text(bytes: &[u8]) -> String {
    let is_blank = |b: &u8| matches!(b, b' ' | 0);
    let start = bytes.iter().position(|b| !is_blank(b)).unwrap_or(bytes.len());
    let end = bytes.iter().rposition(|b| !is_blank(b)).map_or(start, |last| last + 1);
    bytes[start..end].iter().map(|&b| char::from(b)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(name: &str, dimensions: &[u8], text: &str) -> Parameter {
        let value = Value::Text(text.as_bytes().to_vec());
        let dimensions = dimensions.to_vec();
        Parameter { name: name.into(), description: String::new(), locked: false, dimensions, value }
    }

    fn point(parameters: Vec<Parameter>) -> Parameters {
        Parameters { groups: vec![Group { name: "Point".into(), parameters, ..Group::default() }] }
    }

    #[test]
    fn labels_go_on_in_the_next_array() {
        let parameters = point(vec![
            labels("LABELS3", &[2, 1], "EE"),
            labels("LABELS", &[2, 2], "A \0B"),
            labels("LABELS2", &[3, 2], " C DD "),
            labels("LABELS5", &[1, 1], "X"),
            labels("LABELS_OLD", &[1, 1], "Y"),
        ]);
        assert_eq!(parameters.long_texts("POINT", "LABELS"), ["A", "B", "C", "DD", "EE"]);
        assert_eq!(parameters.texts("POINT", "labels2"), ["C", "DD"]);
        assert!(parameters.long_texts("ANALOG", "LABELS").is_empty());
    }

    #[test]
    fn one_dimension_is_one_text() {
        assert_eq!(labels("UNITS", &[4], "mm\0 ").texts(), ["mm"]);
        assert_eq!(labels("UNITS", &[], "m").texts(), ["m"]);
        assert_eq!(labels("LABELS", &[2, 2, 2], "aabbccdd").texts(), ["aa", "bb", "cc", "dd"]);
        assert!(labels("LABELS", &[0, 3], "").texts().is_empty());
        let latin1 = Value::Text(vec![b'M', 0xfc]);
        assert_eq!(Parameter { value: latin1, ..labels("X", &[2], "") }.texts(), ["Mü"]);
    }

    #[test]
    fn counts_are_unsigned_and_whole() {
        let number = |value| Parameter { value, ..labels("FRAMES", &[], "") };
        assert_eq!(number(Value::Integers(vec![-1])).count(), Some(65535));
        assert_eq!(number(Value::Integers(vec![-1])).number(0), Some(-1.0));
        assert_eq!(number(Value::Floats(vec![70000.0])).count(), Some(70000));
        assert_eq!(number(Value::Floats(vec![0.5])).count(), None);
        assert_eq!(number(Value::Floats(vec![f32::NAN])).count(), None);
        assert_eq!(number(Value::Bytes(vec![200])).count(), Some(200));
        assert_eq!(number(Value::Integers(vec![])).count(), None);
    }
}
